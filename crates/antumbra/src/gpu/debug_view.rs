//! Debug views: the textures and lists that a technique works with, and how a viewer shows them.

/// A texture or list of a technique, for a viewer's menu.
#[derive(Clone, Debug)]
pub struct DebugView {
    /// The label that the resource was asked for with.
    pub name: &'static str,
    /// Meaning and unit of its values.
    pub help: &'static str,
    /// The values.
    pub content: DebugContent,
}

/// Where the values of a [`DebugView`] lie, and how they are laid out.
#[derive(Clone, Debug)]
pub enum DebugContent {
    /// Float, unsigned or depth texels, any layers and levels.
    Texture(wgpu::Texture),
    /// Points of the light as fractions of its edges from its centre, each in [-1/2, 1/2]².
    LightPoints(Vec<glam::Vec2>),
    /// A buffer of this layout.
    Buffer(wgpu::Buffer, DebugLayout),
}

/// The layout of a buffer's values.
#[derive(Clone, Debug)]
pub enum DebugLayout {
    /// Listed pixels, as in `shaders/penumbra_list.wesl`.
    Pixels {
        /// Size of the image, pixels.
        size: [u32; 2],
    },
    /// 32-bit floats, those of a position one after the other.
    Numbers {
        /// Numbers of a position.
        stride: u32,
        /// Numbers that are shown, from the first on.
        channels: u32,
        /// Positions along x and y.
        size: [u32; 2],
        /// The listed positions, in this order, as in `shaders/penumbra_list.wesl`. None: all, row by row.
        list: Option<wgpu::Buffer>,
    },
    /// A bit for each texel of a square, rows of whole 32-bit words; see `passes/triangles/silhouette`.
    Mask {
        /// Texels per side.
        side: u32,
    },
    /// The end of each texel's list in a square map; see `shaders/texel_lists.wesl`.
    ListLengths {
        /// Texels per side.
        side: u32,
    },
}
