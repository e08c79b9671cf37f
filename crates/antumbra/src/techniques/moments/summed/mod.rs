//! Soft shadows by means over boxes: a summed-area table of values stored of the depth map, and for each pixel in
//! penumbra the boxes that the light covers in it. A technique defines the stored values in a module `warp.wesl` and
//! reads the visible fraction from means in a module `soft.wesl`; the penumbra follows from the light's size alone.

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::uniform;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::maps::depth_pyramid::DepthPyramid;
use crate::passes::maps::light_depth::LightDepth;
use crate::passes::maps::moments::{DepthWarp, Nearest};
use crate::passes::maps::summed_area::{SummedArea, Sums, TableShape};
use crate::passes::pixels::classify::{Listing, PenumbraList};
use crate::passes::pixels::penumbra_widths::penumbra_widths;
use crate::technique::settings::Settings;
use crate::technique::{Description, Technique, TechniqueFactory};
use crate::{bindings, gpu_struct};
use std::{marker::PhantomData, sync::Arc};

/// The differences between these techniques.
pub trait Soft: 'static {
    /// Its settings.
    type Settings: Settings;
    /// Its description.
    const DESCRIPTION: Description;
    /// Path below `src` of the module of stored values.
    const WARP: &'static str;
    /// Path below `src` of the module that reads the visible part.
    const SOFT: &'static str;

    /// The plan of these settings.
    fn plan(settings: &Self::Settings) -> Plan;
}

/// Table and numbers of a technique's settings.
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
    /// Reading of boxes; see `shaders/light_window.wesl`.
    #[derive(Default)]
    pub struct SoftUniform {
        /// Widest blocker search, nodes of the depth pyramid per side.
        search: f32,
        /// Parts of a window per side.
        divisions: i32,
    }
}

/// A technique that reads boxes of a summed-area table.
pub struct Summed<S: Soft> {
    plan: Plan,
    soften: Arc<ComputePipeline>,
    soft: wgpu::Buffer,
    technique: PhantomData<fn() -> S>,
}

impl<S: Soft> TechniqueFactory for Summed<S> {
    type Settings = S::Settings;
    type Technique = Summed<S>;
    const DESCRIPTION: Description = S::DESCRIPTION;

    fn make(gpu: &Gpu, settings: S::Settings) -> Result<Summed<S>, Error> {
        let plan = S::plan(&settings);
        Ok(Summed {
            soften: gpu.compute_pipeline(&soften_key::<S>(&plan), "soften")?,
            soft: uniform(gpu, "soft", &plan.soft),
            plan,
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
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        let depth = LightDepth::record(recorder, frame, self.plan.table.size, 1)?;
        let map = &depth.casters;
        let pyramid = DepthPyramid::record(recorder, map, frame.frustum.near)?;
        let listing = Listing { trust_dark: true, ..Listing::default() };
        let list = PenumbraList::record(recorder, frame, map, &pyramid, listing)?;
        let warp = recorder.uniform("depth warp", &self.plan.warp.over(frame, Nearest::Caster));
        let table = SummedArea::record(recorder, self.plan.table, &depth, S::WARP, &warp)?;
        let own = bindings! {
            depth_map: &map.texture,
            pyramid_bounds: &pyramid.bounds,
            pyramid_layers: &pyramid.layers,
            penumbra_pixels: &list.buffer,
            warp: &warp,
            soft: &self.soft,
            summed_table: &table.texture,
            table_means: &table.means,
        };
        let (label, work) = ("soft lookup", Work::Indirect(&list.buffer, 0));
        let Some(widths) = penumbra_widths(recorder, &list) else {
            return recorder.compute(label, &self.soften, &[&frame.bindings(), own], work);
        };
        let key = soften_key::<S>(&self.plan).feature("widths", true);
        let soften = recorder.gpu.compute_pipeline(&key, "soften")?;
        recorder.compute(label, &soften, &[&frame.bindings(), own, bindings! { penumbra_widths: &widths }], work)
    }
}
