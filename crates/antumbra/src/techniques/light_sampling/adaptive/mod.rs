//! Shadow maps where the light needs them [Schwärzler 2009]: begin with the corners of the light, split the cells of a
//! quadtree whose corners see different shadows, weigh what was found. Every decision is made on the GPU, so no frame
//! waits for a count to come back.

mod rounds;
mod settings;
pub(crate) mod state;

pub use settings::{AdaptiveSamplingSettings, Criterion, Filter, Space};

use crate::input::frame::FrameUniform;
use crate::passes::maps::light_maps::{Drawn, Entry, LightMaps, LightSample, LightSamples, MapSlot, MapStage};
use crate::passes::pixels::classify::{Listing, PenumbraList};
use crate::passes::maps::depth_map::DepthMap;
use crate::passes::maps::depth_pyramid::DepthPyramid;
use crate::gpu::pipeline::ComputePipeline;
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::ShaderKey;
use crate::technique::{TechniqueAbout, TechniqueFactory, StatsFuture, InnerPicture, Memory, Technique};
use crate::techniques::light_sampling::uniform::Evaluate;
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use rounds::{Rounds, Sum};
use state::{AdaptiveUniform, PlanUniform, Shape, State};
use std::sync::Arc;

/// Texels a side of the map whose surfaces are compared in the light's space.
const LIGHT_VIEW: u32 = 256;

/// Shadow of a rectangular or linear light by as many shadow maps as its penumbrae need.
pub struct AdaptiveSampling {
    settings: AdaptiveSamplingSettings,
    pipelines: Pipelines,
    state: Option<State>,
    samples: Option<LightSamples>,
    maps: Option<LightMaps>,
    /// What the light's centre sees, where comparisons are made in its space.
    light_view: Option<DepthMap>,
    /// The pixels whose visibility is not known at a glance.
    penumbra: Penumbra,
    /// What the maps were drawn for.
    drawn: Option<Drawn>,
}

/// Tells lit pixels from the others by one map of the light's centre.
#[derive(Default)]
struct Penumbra {
    map: Option<DepthMap>,
    pyramid: Option<DepthPyramid>,
    list: Option<PenumbraList>,
}

impl Penumbra {
    fn record(&mut self, recorder: &mut Recorder, frame: &Frame, size: u32) -> Result<&PenumbraList, Error> {
        let map = DepthMap::of_light(&mut self.map, recorder, frame, size)?;
        let pyramid = DepthPyramid::ensure(&mut self.pyramid, recorder.gpu, size);
        let list = PenumbraList::ensure(&mut self.list, recorder.gpu, frame.size);
        pyramid.record(recorder, map, frame.frustum.near)?;
        list.record(recorder, frame, map, pyramid, Listing::default())?;
        Ok(list)
    }

    fn inner_pictures(&self) -> impl Iterator<Item = InnerPicture> {
        let map = self.map.iter().map(DepthMap::inner_picture);
        let pyramid = self.pyramid.iter().flat_map(DepthPyramid::inner_pictures);
        map.chain(pyramid).chain(self.list.iter().map(PenumbraList::inner_picture))
    }

    fn memory(&self) -> impl Iterator<Item = Memory> {
        let map = self.map.iter().flat_map(DepthMap::memory);
        let pyramid = self.pyramid.iter().map(DepthPyramid::memory);
        map.chain(pyramid).chain(self.list.iter().map(PenumbraList::memory))
    }
}

struct Pipelines {
    plan: Arc<ComputePipeline>,
    reproject: Arc<ComputePipeline>,
    compare: Arc<ComputePipeline>,
    steady: Arc<ComputePipeline>,
    weigh: Arc<ComputePipeline>,
    accumulate: Arc<ComputePipeline>,
    /// None if single samples are added up.
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
    const ABOUT: TechniqueAbout = TechniqueAbout {
        name: "adaptive-sampling",
        title: "Adaptive light-source sampling",
        source: "Schwärzler 2009",
        summary: "shadow maps from as many points of the light as its penumbrae need on the screen",
    };

    fn make(gpu: &Gpu, settings: AdaptiveSamplingSettings) -> Result<Self, Error> {
        settings.check()?;
        Ok(AdaptiveSampling {
            pipelines: Pipelines::new(gpu, &settings)?,
            settings,
            state: None,
            samples: None,
            maps: None,
            light_view: None,
            penumbra: Penumbra::default(),
            drawn: None,
        })
    }
}

impl Technique for AdaptiveSampling {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        let Prepared { maps_rest, is_new } = self.prepare(frame, recorder)?;
        let rounds = Rounds {
            frame,
            pipelines: &self.pipelines,
            state: self.state.as_ref().expect("prepared"),
            samples: self.samples.as_ref().expect("prepared"),
            maps: self.maps.as_ref().expect("prepared"),
            light_view: self.light_view.as_ref(),
        };
        let (steady, weighted) = (self.settings.steady, self.settings.knows_weights());
        let list = match self.settings.filter {
            Filter::Cell => Some(self.penumbra.record(recorder, frame, self.settings.map)?),
            Filter::Pcf => None,
        };
        let at_once = (self.settings.evaluation == Evaluate::Accumulate).then_some(Sum { list });
        if is_new || !steady {
            rounds.refine(recorder, maps_rest, at_once.filter(|_| !weighted))?;
        }
        if steady {
            rounds.change(recorder, maps_rest && !is_new, is_new, at_once)?;
        } else {
            rounds.weigh(recorder, true);
        }
        match (at_once, list) {
            (Some(sum), _) => {
                if weighted && !steady {
                    rounds.accumulate_again(recorder, sum)?;
                }
                rounds.finish_sum(recorder, sum);
            }
            (None, Some(list)) => rounds.evaluate_cells(recorder, list),
            (None, None) => rounds.evaluate(recorder),
        }
        Ok(())
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        let maps = self.maps.iter().map(LightMaps::inner_picture);
        maps.chain(self.light_view.iter().map(DepthMap::inner_picture)).chain(self.penumbra.inner_pictures()).collect()
    }

    fn memory(&self) -> Vec<Memory> {
        let maps = self.maps.iter().flat_map(LightMaps::memory);
        let view = self.light_view.iter().flat_map(DepthMap::memory);
        maps.chain(view).chain(self.penumbra.memory()).chain(self.state.iter().flat_map(State::memory)).collect()
    }

    fn stats<'a>(&'a self, gpu: &'a Gpu) -> StatsFuture<'a> {
        Box::pin(async move {
            match &self.state {
                Some(state) => state.stats(gpu).await,
                None => Ok(Vec::new()),
            }
        })
    }
}

/// What is left of the frame before.
struct Prepared {
    /// True if its maps may still be used.
    maps_rest: bool,
    /// True if there is no tree.
    is_new: bool,
}

impl AdaptiveSampling {
    /// Makes what the frame needs, and draws what the light's centre sees if comparisons are made there.
    fn prepare(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<Prepared, Error> {
        let (gpu, settings) = (recorder.gpu, &self.settings);
        let shape = Shape::of_settings(frame.light.size, settings);
        let capacity = State::capacity(gpu, settings, shape);
        let layers = State::layers(gpu, settings, capacity);
        let same_maps = self.maps.as_ref().is_some_and(|m| m.fits(gpu, settings.map, layers, &frame.casters));
        let maps = LightMaps::ensure(&mut self.maps, gpu, settings.map, layers, &frame.casters)?;
        let picture = frame.size;
        let same_state = self.state.as_ref().is_some_and(|s| {
            (s.shape, s.picture, s.capacity, s.light_size) == (shape, picture, capacity, frame.light.size)
        });
        if !(same_maps && same_state) {
            self.state = Some(State::new(gpu, settings, shape, (picture, frame.light.size), maps)?);
        }
        let places = &self.state.as_ref().expect("just made").places;
        LightSamples::ensure(&mut self.samples, gpu, frame, places);
        if settings.space == Space::Light {
            DepthMap::of_light(&mut self.light_view, recorder, frame, LIGHT_VIEW)?;
        }
        let now = Drawn::of(frame);
        let rest = same_maps && same_state && frame.static_casters && settings.evaluation == Evaluate::Array;
        let rest = rest && self.drawn.as_ref().is_some_and(|d| d.is(&now));
        self.drawn = Some(now);
        Ok(Prepared { maps_rest: rest, is_new: !(same_maps && same_state) })
    }
}

#[cfg(test)]
mod tests;
