//! Pixel classification: lit, umbra and turned-away pixels are answered at once, penumbra pixels are listed.

use crate::bindings;
use crate::error::Error;
use crate::gpu::debug_view::DebugLayout;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::maps::depth_map::DepthMap;
use crate::passes::maps::depth_pyramid::DepthPyramid;

/// The pixels in penumbra, for an indirect dispatch of 64 threads per workgroup; see `shaders/penumbra_list.wesl`.
pub struct PenumbraList {
    /// Indirect arguments, the count, then the pixels.
    pub buffer: wgpu::Buffer,
    /// Indirect arguments, the count, then for each tile of 8 x 8 pixels that has some the first and their number.
    pub tiles: wgpu::Buffer,
    /// Pixels of the image along x and y.
    pub size: [u32; 2],
}

/// Pixels that are listed besides those in penumbra.
#[derive(Clone, Copy, Debug, Default)]
pub struct Listing {
    /// A pixel of which the light's centre sees nothing may be lit from the light's border, through a gap that the
    /// centre does not see. Techniques that see from the centre alone trust the map that it is dark; others get such
    /// pixels listed.
    pub trust_dark: bool,
    /// For techniques that filter over the pixel's footprint on the map: occluders of the footprint count too.
    pub footprints: bool,
}

impl PenumbraList {
    /// Empty lists with capacity for every pixel, for a pass of the caller.
    pub(crate) fn empty(recorder: &mut Recorder, size: [u32; 2]) -> PenumbraList {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let tiles = u64::from(size[0].div_ceil(8)) * u64::from(size[1].div_ceil(8));
        let list = |entries: u64| BufferDescription::new(16 + 8 * entries).cleared_head(16);
        let help = "pixels that are filtered; all others are known to be lit or dark";
        PenumbraList {
            buffer: recorder.buffer("penumbra list", list(pixels).debug(help, DebugLayout::Pixels { size })),
            tiles: recorder.buffer("penumbra tiles", list(tiles)),
            size,
        }
    }

    /// Writes the visibility of known pixels and lists the others, whose visibility is -1 until the technique writes
    /// it. A pixel that is lit by the map is lit.
    pub fn record(
        recorder: &mut Recorder,
        frame: &BoundFrame,
        map: &DepthMap,
        pyramid: &DepthPyramid,
        listing: Listing,
    ) -> Result<PenumbraList, Error> {
        let key = ShaderKey::new("passes::pixels::classify")
            .feature("trust_dark", listing.trust_dark)
            .feature("footprints", listing.footprints);
        let classify = recorder.gpu.compute_pipeline(&key, "classify_pixels")?;
        let finish = recorder.gpu.compute_pipeline(&key, "finish")?;
        let list = PenumbraList::empty(recorder, frame.size);
        let own = bindings! {
            depth_map: &map.texture,
            pyramid_bounds: &pyramid.bounds,
            penumbra: &list.buffer,
            tiles: &list.tiles,
        };
        let set: [&[_]; 2] = [&frame.bindings(), own];
        recorder.compute("pixel classification", &classify, &set, Work::Pixels(frame.size))?;
        recorder.compute("pixel classification", &finish, &set, Work::Groups([1, 1, 1]))?;
        Ok(list)
    }
}
