//! What is known before any tile is drawn: a low-resolution map that misses no caster, the pixels that may lie in
//! penumbra, and the kernel of each [Shen 2011, section 5.2, steps 2 and 3].

use super::plan::Plan;
use super::{PvssmSettings, PvssmUniform};
use crate::input::frame::FrameUniform;
use crate::passes::pixels::classify::{Listing, PenumbraList};
use crate::passes::maps::depth_map::DepthMap;
use crate::passes::maps::depth_pyramid::DepthPyramid;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::storage_buffer;
use crate::gpu::shader::ShaderKey;
use crate::technique::{InnerContent, InnerPicture, Memory};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::bindings;

/// Label of the low-resolution map's pass.
const MAP: &str = "low-resolution map";
/// Label of the pass that makes the kernel shape buffer.
const KERNELS: &str = "kernel shapes";
/// Bytes of a kernel; see `kernel.wesl`.
const KERNEL_BYTES: u64 = 16;

/// The low-resolution map and what follows from it.
pub(crate) struct Analysis {
    map: DepthMap,
    pyramid: DepthPyramid,
    /// The pixels that have kernels.
    pub list: PenumbraList,
    /// The kernel of each listed pixel.
    pub kernels: wgpu::Buffer,
}

impl Analysis {
    /// Makes it in `slot` unless one of this size for these casters and pictures is there.
    pub fn ensure<'a>(
        slot: &'a mut Option<Analysis>,
        gpu: &Gpu,
        frame: &Frame,
        settings: &PvssmSettings,
    ) -> Result<&'a Analysis, Error> {
        let size = frame.size;
        if !slot.as_ref().is_some_and(|a| a.map.fits(settings.map, &frame.casters) && a.list.size() == size) {
            let pixels = u64::from(size[0]) * u64::from(size[1]);
            *slot = Some(Analysis {
                map: DepthMap::new(gpu, settings.map, &frame.casters)?,
                pyramid: DepthPyramid::new(gpu, settings.map),
                list: PenumbraList::new(gpu, size),
                kernels: storage_buffer(gpu, "kernels", pixels * KERNEL_BYTES),
            });
        }
        Ok(slot.as_ref().expect("just made"))
    }

    /// Draws the map and the pyramid over it.
    pub fn low_resolution_map(&self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        self.map.record_touched(recorder, frame, MAP)?;
        self.pyramid.record(recorder, &self.map, frame.frustum.near)
    }

    /// Lists the pixels that may lie in penumbra. The map shows casters larger than they are, so that what is lit by it
    /// surely is, and nothing is surely dark.
    pub fn list_pixels(&self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        let listing = Listing { trust_dark: false, footprints: true };
        self.list.record(recorder, frame, &self.map, &self.pyramid, listing)
    }

    /// Finds the kernel of each listed pixel; what has no occluder is lit and has none.
    pub fn shape_kernels(&self, frame: &Frame, recorder: &mut Recorder, plan: &Plan) -> Result<(), Error> {
        let key = ShaderKey::new("techniques::pvssm::kernels");
        let key = key;
        let pipeline = recorder.gpu.compute_pipeline(&key, "shape_kernels")?;
        let set = frame.bindings(bindings! {
            depth_map: &self.map.texture,
            pyramid_bounds: &self.pyramid.bounds,
            pyramid_layers: &self.pyramid.layers,
            penumbra_pixels: &self.list.buffer,
            penumbra_tiles: &self.list.tiles,
            pvssm: &plan.uniform,
            made_kernels: &self.kernels,
        });
        recorder.compute(KERNELS, &pipeline, &set, Work::Indirect(&self.list.tiles, 0));
        Ok(())
    }

    /// For looking at.
    pub fn inner_pictures(&self) -> Vec<InnerPicture> {
        let help = "half widths of each pixel's kernel over the map as tangents: along x, its skew along y, along y; \
                    penumbrae are as wide";
        let kernels = InnerPicture {
            name: KERNELS,
            help,
            content: InnerContent::Numbers {
                numbers: self.kernels.clone(),
                stride: 4,
                channels: 3,
                size: self.list.size(),
                list: Some(self.list.buffer.clone()),
            },
        };
        let bounds_and_layers = self.pyramid.inner_pictures();
        [InnerPicture { name: MAP, ..self.map.inner_picture() }]
            .into_iter()
            .chain(bounds_and_layers)
            .chain([kernels])
            .collect()
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Vec<Memory> {
        let map = self.map.memory_of(MAP);
        let rest = [self.pyramid.memory(), self.list.memory(), Memory::new(KERNELS, self.kernels.size())];
        map.into_iter().chain(rest).collect()
    }
}
