//! The input of the prediction: a conservative low-resolution map, the pixels that may lie in penumbra, and the kernel
//! of each [Shen 2011, section 5.2, steps 2 and 3].

use super::PvssmSettings;
use crate::binding_array;
use crate::bindings;
use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::debug_view::DebugLayout;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::maps::depth_map::DepthMap;
use crate::passes::maps::depth_pyramid::DepthPyramid;
use crate::passes::pixels::classify::{Listing, PenumbraList};

/// Bytes of a kernel; see `kernel.wesl`.
const KERNEL_BYTES: u64 = 16;

/// The listed pixels and their kernels.
pub(crate) struct Analysis {
    pub list: PenumbraList,
    kernels: wgpu::Buffer,
}

impl Analysis {
    /// Draws the map, lists the pixels and finds their kernels. Pixels without an occluder are lit and have none.
    pub fn record(
        recorder: &mut Recorder,
        frame: &BoundFrame,
        settings: &PvssmSettings,
        uniform: &wgpu::Buffer,
    ) -> Result<Analysis, Error> {
        let map = DepthMap::record_touched(recorder, frame, "low-resolution map", settings.map)?;
        let pyramid = DepthPyramid::record(recorder, &map, frame.frustum.near)?;
        // Casters are larger in the map than they are: pixels that are lit by it are lit, none is certain to be dark.
        let listing = Listing { trust_dark: false, footprints: true };
        let list = PenumbraList::record(recorder, frame, &map, &pyramid, listing)?;
        let help = "half widths of each pixel's kernel over the map as tangents: along x, its skew along y, along y; \
                    penumbrae are as wide";
        let [width, height] = list.size;
        let layout = DebugLayout::Numbers { stride: 4, channels: 3, size: list.size, list: Some(list.buffer.clone()) };
        let kernels = BufferDescription::new(u64::from(width) * u64::from(height) * KERNEL_BYTES).debug(help, layout);
        let kernels = recorder.buffer("kernel shapes", kernels);
        let pipeline = recorder.gpu.compute_pipeline(&ShaderKey::new("techniques::pvssm::kernels"), "shape_kernels")?;
        let own = bindings! {
            depth_map: &map.texture,
            pyramid_bounds: &pyramid.bounds,
            pyramid_layers: &pyramid.layers,
            penumbra_pixels: &list.buffer,
            penumbra_tiles: &list.tiles,
            pvssm: uniform,
            made_kernels: &kernels,
        };
        let work = Work::Indirect(&list.tiles, 0);
        recorder.compute("kernel shapes", &pipeline, &[&frame.bindings(), own], work)?;
        Ok(Analysis { list, kernels })
    }

    /// The list and the kernels, for shaders that read them.
    pub fn bindings(&self) -> [Binding<'_>; 3] {
        binding_array! {
            penumbra_pixels: &self.list.buffer,
            penumbra_tiles: &self.list.tiles,
            kernels: &self.kernels,
        }
    }
}
