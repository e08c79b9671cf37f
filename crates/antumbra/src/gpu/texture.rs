//! Textures with their views, and the description that one is asked for with.

use super::device::Gpu;
use std::ops::Deref;
use std::sync::{Arc, Mutex};
use wgpu::{TextureFormat, TextureUsages, TextureViewDimension};

/// Size, format, usage and help text of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureDescription {
    /// Texels along x and y.
    pub size: [u32; 2],
    /// Layers; its view is an array if this is given, even of a single layer.
    pub layers: Option<u32>,
    /// Mip levels.
    pub mips: u32,
    /// Samples per texel, 1 or 4.
    pub samples: u32,
    /// Format of a texel.
    pub format: TextureFormat,
    /// Uses besides sampling.
    pub usage: TextureUsages,
    /// Meaning and unit of its values, for debug views.
    pub help: &'static str,
}

impl TextureDescription {
    /// One layer, one level. Depth formats are render targets, colour formats storage textures; both can be sampled and
    /// copied from.
    pub const fn new(size: [u32; 2], format: TextureFormat, help: &'static str) -> Self {
        let target = match format {
            TextureFormat::Depth32Float => TextureUsages::RENDER_ATTACHMENT,
            _ => TextureUsages::STORAGE_BINDING,
        };
        let usage = target.union(TextureUsages::TEXTURE_BINDING).union(TextureUsages::COPY_SRC);
        TextureDescription { size, layers: None, mips: 1, samples: 1, format, usage, help }
    }

    /// An array of this many layers.
    pub const fn layers(self, layers: u32) -> Self {
        TextureDescription { layers: Some(layers), ..self }
    }

    /// This many mip levels.
    pub const fn mips(self, mips: u32) -> Self {
        TextureDescription { mips, ..self }
    }

    /// 1 or 4 samples per texel. Multisampled textures cannot be copied from.
    pub fn samples(self, samples: u32) -> Self {
        let usage = if samples > 1 { self.usage - TextureUsages::COPY_SRC } else { self.usage };
        TextureDescription { samples, usage, ..self }
    }

    /// These uses and sampling.
    pub const fn usage(self, usage: TextureUsages) -> Self {
        TextureDescription { usage: usage.union(TextureUsages::TEXTURE_BINDING), ..self }
    }
}

/// A texture with its views. Clones share it.
#[derive(Clone, Debug)]
pub struct Texture(Arc<Views>);

/// The inside of a [`Texture`].
#[derive(Debug)]
pub struct Views {
    /// The texture.
    pub texture: wgpu::Texture,
    /// All layers and levels.
    pub view: wgpu::TextureView,
    parts: Mutex<Vec<(ViewKey, wgpu::TextureView)>>,
}

impl Deref for Texture {
    type Target = Views;

    fn deref(&self) -> &Views {
        &self.0
    }
}

impl PartialEq for Texture {
    fn eq(&self, other: &Texture) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// The part of a texture that a view shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ViewKey {
    dimension: TextureViewDimension,
    first_layer: u32,
    layers: Option<u32>,
    level: Option<u32>,
}

impl Texture {
    /// Makes a texture; [`Recorder::texture`](super::recorder::Recorder::texture) keeps one from frame to frame.
    pub fn new(gpu: &Gpu, label: &str, description: TextureDescription) -> Texture {
        let TextureDescription { size, layers, mips, samples, format, usage, .. } = description;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: layers.unwrap_or(1) },
            mip_level_count: mips,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        });
        let dimension = layers.map(|_| TextureViewDimension::D2Array);
        let view = texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() });
        Texture(Arc::new(Views { texture, view, parts: Mutex::default() }))
    }

    /// A view of `count` layers from `first` on: an array if there are several.
    pub fn layers(&self, first: u32, count: u32) -> wgpu::TextureView {
        let dimension = if count == 1 { TextureViewDimension::D2 } else { TextureViewDimension::D2Array };
        self.part(ViewKey { dimension, first_layer: first, layers: Some(count), level: None })
    }

    /// A view of one mip level.
    pub fn mip(&self, level: u32) -> wgpu::TextureView {
        let dimension = TextureViewDimension::D2;
        self.part(ViewKey { dimension, first_layer: 0, layers: None, level: Some(level) })
    }

    /// A view of one mip level of one layer, for render passes.
    pub fn layer_mip(&self, layer: u32, level: u32) -> wgpu::TextureView {
        let dimension = TextureViewDimension::D2;
        self.part(ViewKey { dimension, first_layer: layer, layers: Some(1), level: Some(level) })
    }

    /// An array view of one mip level of all layers.
    pub fn array_mip(&self, level: u32) -> wgpu::TextureView {
        let dimension = TextureViewDimension::D2Array;
        self.part(ViewKey { dimension, first_layer: 0, layers: None, level: Some(level) })
    }

    fn part(&self, key: ViewKey) -> wgpu::TextureView {
        let mut parts = self.parts.lock().expect("nothing panics under the lock");
        if let Some((_, view)) = parts.iter().find(|(known, _)| *known == key) {
            return view.clone();
        }
        let view = self.texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(key.dimension),
            base_array_layer: key.first_layer,
            array_layer_count: key.layers,
            base_mip_level: key.level.unwrap_or(0),
            mip_level_count: key.level.map(|_| 1),
            ..Default::default()
        });
        parts.push((key, view.clone()));
        view
    }

    /// Texels along x and y of the first level.
    pub fn size(&self) -> [u32; 2] {
        [self.texture.width(), self.texture.height()]
    }

    /// GPU memory of all levels and layers, in bytes.
    pub fn bytes(&self) -> u64 {
        let t = &self.texture;
        let texel = u64::from(t.format().block_copy_size(None).unwrap_or(4));
        (0..t.mip_level_count())
            .map(|m| u64::from((t.width() >> m).max(1)) * u64::from((t.height() >> m).max(1)))
            .sum::<u64>()
            * texel
            * u64::from(t.depth_or_array_layers())
            * u64::from(t.sample_count())
    }
}
