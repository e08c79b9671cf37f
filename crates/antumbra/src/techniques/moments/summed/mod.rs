//! The skeleton of soft shadows by means over boxes: a summed-area table of what is stored of the depth map, and for each
//! pixel in penumbra the boxes that the light makes in it. A technique says what is stored, in a module `warp.wesl`, and how
//! the visible part is read from means, in a module `soft.wesl`; the penumbra follows from the light's size alone.

use crate::input::frame::FrameUniform;
use crate::passes::pixels::classify::{Listing, PenumbraList};
use crate::passes::maps::depth_pyramid::DepthPyramid;
use crate::passes::maps::light_depth::LightDepth;
use crate::passes::maps::moments::{DepthWarp, Nearest};
use crate::passes::pixels::penumbra_widths::PenumbraWidths;
use crate::passes::maps::summed_area::{SummedArea, Sums, TableShape};
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::uniform;
use crate::technique::settings::Settings;
use crate::gpu::shader::{HostStruct, ShaderKey};
use crate::technique::{TechniqueAbout, TechniqueFactory, InnerPicture, Memory, Technique};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use std::{marker::PhantomData, sync::Arc};

/// What distinguishes one technique from another.
pub trait Soft: 'static {
    /// Its settings.
    type Settings: Settings;
    /// What it says of itself.
    const ABOUT: TechniqueAbout;
    /// Path below `src` of the module that says what is stored.
    const WARP: &'static str;
    /// Path below `src` of the module that reads the visible part.
    const SOFT: &'static str;

    /// What these settings ask for.
    fn plan(settings: &Self::Settings) -> Plan;
}

/// What settings ask for.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// The table.
    pub table: TableShape,
    /// The numbers that the warp takes, without the range of depths.
    pub warp: DepthWarp,
    /// The numbers that the module `soft` takes.
    pub soft: SoftUniform,
}

gpu_struct! {
    /// How boxes are read; see `shaders/light_window.wesl`.
    #[derive(Default)]
    pub struct SoftUniform {
        /// Widest blocker search, nodes of the depth pyramid a side.
        search: f32,
        /// Parts of a window a side.
        divisions: i32,
    }
}

/// A technique that reads boxes of a summed-area table.
pub struct Summed<S: Soft> {
    plan: Plan,
    soften: Arc<ComputePipeline>,
    is_looked_at: bool,
    warp: wgpu::Buffer,
    soft: wgpu::Buffer,
    depth: Option<LightDepth>,
    pyramid: Option<DepthPyramid>,
    list: Option<PenumbraList>,
    table: Option<SummedArea>,
    widths: Option<PenumbraWidths>,
    technique: PhantomData<fn() -> S>,
}

impl<S: Soft> TechniqueFactory for Summed<S> {
    type Settings = S::Settings;
    const ABOUT: TechniqueAbout = S::ABOUT;

    fn make(gpu: &Gpu, settings: S::Settings) -> Result<Self, Error> {
        let plan = S::plan(&settings);
        Ok(Summed {
            soften: gpu.compute_pipeline(&soften_key::<S>(&plan), "soften")?,
            is_looked_at: false,
            warp: uniform(gpu, "depth warp", &plan.warp),
            soft: uniform(gpu, "soft", &plan.soft),
            plan,
            depth: None,
            pyramid: None,
            list: None,
            table: None,
            widths: None,
            technique: PhantomData,
        })
    }
}

/// The lookup.
fn soften_key<S: Soft>(plan: &Plan) -> ShaderKey {
    ShaderKey::new("techniques::moments::summed::soften")
        .part("soft", S::SOFT)
        .feature("fixed", plan.table.sums == Sums::Fixed)
}

impl<S: Soft> Technique for Summed<S> {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        let (gpu, size) = (recorder.gpu, self.plan.table.size);
        if !self.depth.as_ref().is_some_and(|d| d.fits(&frame.casters)) {
            self.depth = Some(LightDepth::new(gpu, size, 1, &frame.casters)?);
        }
        let depth = self.depth.as_ref().expect("just made");
        let map = &depth.casters;
        let pyramid = DepthPyramid::ensure(&mut self.pyramid, gpu, size);
        let list = PenumbraList::ensure(&mut self.list, gpu, frame.size);
        let table = SummedArea::ensure(&mut self.table, gpu, self.plan.table)?;
        gpu.queue.write_buffer(&self.warp, 0, &self.plan.warp.over(frame, Nearest::Caster).uniform_bytes());
        depth.record(recorder, frame)?;
        pyramid.record(recorder, map, frame.frustum.near)?;
        list.record(recorder, frame, map, pyramid, Listing { trust_dark: true, ..Listing::default() })?;
        table.record(recorder, depth, S::WARP, &self.warp)?;
        let widths = PenumbraWidths::ensure(&mut self.widths, gpu, list, self.is_looked_at);
        let mut set = frame.bindings(bindings! {
            depth_map: &map.texture,
            pyramid_bounds: &pyramid.bounds,
            pyramid_layers: &pyramid.layers,
            penumbra_pixels: &list.buffer,
            warp: &self.warp,
            soft: &self.soft,
            summed_table: &table.texture,
            table_means: &table.means,
        });
        let mut soften = self.soften.clone();
        if let Some(widths) = widths {
            set.extend_from_slice(bindings! { penumbra_widths: &widths.buffer });
            soften = gpu.compute_pipeline(&soften_key::<S>(&self.plan).feature("widths", true), "soften")?;
        }
        recorder.compute("soft lookup", &soften, &set, Work::Indirect(&list.buffer, 0));
        Ok(())
    }

    fn look_inside(&mut self, looked_at: bool) {
        self.is_looked_at = looked_at;
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        let map = self.depth.iter().map(|d| d.casters.inner_picture());
        map.chain(self.pyramid.iter().flat_map(DepthPyramid::inner_pictures))
            .chain(self.table.iter().map(SummedArea::inner_picture))
            .chain(self.list.iter().map(PenumbraList::inner_picture))
            .chain(self.list.iter().zip(&self.widths).map(|(list, widths)| widths.inner_picture(list)))
            .collect()
    }

    fn memory(&self) -> Vec<Memory> {
        let map = self.depth.iter().flat_map(LightDepth::memory);
        let pyramid = self.pyramid.iter().map(DepthPyramid::memory);
        let list = self.list.iter().map(PenumbraList::memory);
        let widths = self.widths.iter().map(PenumbraWidths::memory);
        map.chain(pyramid).chain(list).chain(self.table.iter().map(SummedArea::memory)).chain(widths).collect()
    }
}
