//! Michael Schwärzler, 2009: Accurate soft shadows in real-time applications, TU Wien,
//! <https://www.cg.tuwien.ac.at/research/publications/2009/SCHWAERZLER-2009-ASS/>.
//!
//! Shadow maps where the light needs them: begin with the corners of the light, split the cells of a quadtree whose
//! corners see different shadows, and weight the samples. Every decision is made on the GPU, so no frame waits for a
//! readback.

mod rounds;
mod settings;
pub(crate) mod state;
#[cfg(test)]
mod tests;

pub use settings::{AdaptiveSamplingSettings, Criterion, Filter, Space};

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::Texture;
use crate::input::frame::{BoundFrame, MapInput};
use crate::passes::maps::depth_map::DepthMap;
use crate::passes::maps::depth_pyramid::DepthPyramid;
use crate::passes::maps::light_maps::LightMaps;
use crate::passes::pixels::classify::{Listing, PenumbraList};
use crate::technique::{Description, StatsFuture, Technique, TechniqueFactory};
use crate::techniques::light_sampling::uniform::Evaluate;
use rounds::{Rounds, Sum};
use state::{Tree, TreeKey, TreePlan};
use std::sync::Arc;

/// Texels per side of the map whose surfaces are compared in the light's space.
const LIGHT_VIEW: u32 = 256;
const VISIBILITY_SUM: &str = "visibility sum";

/// Shadow of a rectangular or linear light by as many shadow maps as its penumbrae need.
pub struct AdaptiveSampling {
    settings: AdaptiveSamplingSettings,
    pipelines: Pipelines,
    plan: Option<TreePlan>,
    /// The last frame's tree, maps and their input.
    last: Option<(wgpu::Buffer, Texture, MapInput)>,
}

struct Pipelines {
    plan: Arc<ComputePipeline>,
    reproject: Arc<ComputePipeline>,
    compare: Arc<ComputePipeline>,
    steady: Arc<ComputePipeline>,
    weigh: Arc<ComputePipeline>,
    accumulate: Arc<ComputePipeline>,
    /// None where single samples are added up.
    accumulate_cells: Option<Arc<ComputePipeline>>,
    finish_sum: Arc<ComputePipeline>,
    evaluate_cells: Arc<ComputePipeline>,
}

impl Pipelines {
    fn new(gpu: &Gpu, settings: &AdaptiveSamplingSettings) -> Result<Pipelines, Error> {
        let key = |module| {
            ShaderKey::new(module)
                .feature("local", settings.criterion == Criterion::Local)
                .feature("relative", settings.criterion == Criterion::Relative)
                .feature("of_light", settings.space == Space::Light)
                .feature("weighted", settings.knows_weights())
                .feature("cell", settings.filter == Filter::Cell)
                .feature("chunked", settings.evaluation == Evaluate::Accumulate)
        };
        let pipeline = |module, entry| gpu.compute_pipeline(&key(module), entry);
        Ok(Pipelines {
            plan: pipeline("techniques::light_sampling::adaptive::plan", "plan")?,
            reproject: pipeline("techniques::light_sampling::adaptive::reproject", "reproject")?,
            compare: pipeline("techniques::light_sampling::adaptive::compare", "compare")?,
            steady: pipeline("techniques::light_sampling::adaptive::steady", "steady")?,
            weigh: pipeline("techniques::light_sampling::adaptive::weigh", "weigh")?,
            accumulate: pipeline("techniques::light_sampling::adaptive::accumulate", "accumulate")?,
            accumulate_cells: match settings.filter == Filter::Cell && settings.knows_weights() {
                true => Some(pipeline("techniques::light_sampling::adaptive::accumulate", "accumulate_cells")?),
                false => None,
            },
            finish_sum: pipeline("techniques::light_sampling::adaptive::accumulate", "finish_sum")?,
            evaluate_cells: pipeline("techniques::light_sampling::adaptive::evaluate_cells", "evaluate_cells")?,
        })
    }
}

impl TechniqueFactory for AdaptiveSampling {
    type Settings = AdaptiveSamplingSettings;
    type Technique = AdaptiveSampling;
    const DESCRIPTION: Description = Description {
        name: "adaptive-sampling",
        title: "Adaptive light-source sampling",
        source: "Schwärzler 2009",
        summary: "shadow maps from as many points of the light as its penumbrae need on the screen",
    };

    fn make(gpu: &Gpu, settings: AdaptiveSamplingSettings) -> Result<AdaptiveSampling, Error> {
        settings.check()?;
        Ok(AdaptiveSampling { pipelines: Pipelines::new(gpu, &settings)?, settings, plan: None, last: None })
    }
}

impl Technique for AdaptiveSampling {
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        let Prepared { tree, maps, maps_valid, is_new } = self.prepare(frame, recorder)?;
        let settings = &self.settings;
        let light_view = match settings.space {
            Space::Light => Some(DepthMap::of_light(recorder, frame, LIGHT_VIEW)?.texture),
            Space::Camera => None,
        };
        let list = match settings.filter {
            Filter::Cell => Some(penumbra_list(recorder, frame, settings.map)?),
            Filter::Pcf => None,
        };
        let rounds = Rounds {
            frame,
            pipelines: &self.pipelines,
            plan: self.plan.as_ref().expect("prepared"),
            tree: &tree,
            maps: &maps,
            light_view: light_view.as_ref(),
        };
        let (steady, weighted) = (settings.steady, settings.knows_weights());
        let at_once = (settings.evaluation == Evaluate::Accumulate).then_some(Sum { list: list.as_ref() });
        if is_new || !steady {
            rounds.refine(recorder, maps_valid, at_once.filter(|_| !weighted))?;
        }
        if steady {
            rounds.change(recorder, maps_valid && !is_new, is_new, at_once)?;
        } else {
            rounds.weigh(recorder, true)?;
        }
        match (at_once, &list) {
            (Some(sum), _) => {
                if weighted && !steady {
                    rounds.accumulate_again(recorder, sum)?;
                }
                rounds.finish_sum(recorder, sum)
            }
            (None, Some(list)) => rounds.evaluate_cells(recorder, list),
            (None, None) => rounds.evaluate(recorder),
        }
    }

    fn stats<'a>(&'a self, gpu: &'a Gpu) -> StatsFuture<'a> {
        Box::pin(async move {
            match &self.last {
                Some((tree, ..)) => state::stats(gpu, tree).await,
                None => Ok(Vec::new()),
            }
        })
    }
}

/// The resources of a frame, and their relation to those of the last one.
struct Prepared {
    tree: Tree,
    maps: LightMaps,
    /// True if the maps of the last frame are still valid.
    maps_valid: bool,
    /// True if there is no tree of the last frame.
    is_new: bool,
}

impl AdaptiveSampling {
    fn prepare(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<Prepared, Error> {
        let settings = &self.settings;
        if self.plan.as_ref().is_none_or(|plan| plan.key != TreeKey::of(frame)) {
            (self.plan, self.last) = (None, None);
        }
        let plan = match &mut self.plan {
            Some(plan) => plan,
            none => none.insert(TreePlan::new(recorder.gpu, settings, frame)?),
        };
        let maps = LightMaps::new(recorder, frame, settings.map, plan.layers, &plan.points)?;
        let tree = plan.tree(recorder);
        let input = MapInput::of(frame);
        let last = self.last.as_ref().filter(|(known, texture, _)| *known == tree.tree && *texture == maps.texture);
        let same_input = last.is_some_and(|(_, _, known)| *known == input);
        let (is_new, kept) = (last.is_none(), settings.evaluation == Evaluate::Array);
        if is_new {
            tree.reset(recorder);
        }
        self.last = Some((tree.tree.clone(), maps.texture.clone(), input));
        Ok(Prepared { tree, maps, maps_valid: frame.static_casters && kept && same_input, is_new })
    }
}

/// The pixels in penumbra by one map from the light's centre. It holds every texel that a caster touches: a wall that
/// the centre sees edge-on hides much of the light from other points.
fn penumbra_list(recorder: &mut Recorder, frame: &BoundFrame, size: u32) -> Result<PenumbraList, Error> {
    let map = DepthMap::record_touched(recorder, frame, "penumbra map", size)?;
    let pyramid = DepthPyramid::record(recorder, &map, frame.frustum.near)?;
    PenumbraList::record(recorder, frame, &map, &pyramid, Listing::default())
}
