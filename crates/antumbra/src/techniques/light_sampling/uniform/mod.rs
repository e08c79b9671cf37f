//! Paul Heckbert, Michael Herf, 1997: Simulating soft shadows with graphics hardware, CMU-CS-97-104.
//!
//! A fixed number of shadow maps over the light, also section 3.2 of [Schwärzler 2009]: the brute force that tends to
//! the truth as the maps get more and finer.

mod pattern;

pub use pattern::{Pattern, Sample, Weights, samples};

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::recorder::Recorder;
use crate::gpu::resources::storage_bytes;
use crate::gpu::texture::Texture;
use crate::input::frame::{BoundFrame, MapInput};
use crate::passes::maps::light_maps::draw::Layers;
use crate::passes::maps::light_maps::{Entry, Evaluation, LightMaps, MapSlot, entry_list};
use crate::technique::settings::Kind;
use crate::technique::{Description, StatsFuture, Technique, TechniqueFactory};
use glam::Vec2;

crate::choices! {
    /// How the maps are added up.
    pub enum Evaluate {
        /// All maps lie in one texture array and are read in one pass [section 3.4.2]; in several if the device's
        /// limits require it.
        Array = "array",
        /// Each map is drawn into the same texture and added to the sum at once, in constant memory [section 3.4.1].
        Accumulate = "accumulate",
    }
}

crate::settings! {
    /// Settings of [`UniformSampling`].
    pub struct UniformSamplingSettings {
        /// Shadow maps, texels per side.
        map: u32 = 512, Kind::Integer { min: 16, max: 16384 };
        /// Number of shadow maps; 1 is the light's centre.
        samples: u32 = 64, Kind::Integer { min: 1, max: 4096 };
        /// Distribution of the samples: an even sequence, one in each cell of a grid, or a grid from border to border.
        pattern: Pattern = Pattern::LowDiscrepancy, Kind::Choice { options: Pattern::OPTIONS };
        /// Weights on a regular grid: the area around each sample, or equal as in the paper.
        weights: Weights = Weights::Area, Kind::Choice { options: Weights::OPTIONS };
        /// Width of the filter on each map in texels per side; 1 is a single lookup.
        pcf: u32 = 2, Kind::Integer { min: 1, max: 33 };
        /// All maps in one array, or in sequence through the same texture.
        evaluation: Evaluate = Evaluate::Array, Kind::Choice { options: Evaluate::OPTIONS };
    }
}

/// The stage of every map: all are drawn in one round.
const STAGE: u32 = 0;

/// Shadow of a rectangular or linear light by a fixed number of shadow maps.
pub struct UniformSampling {
    settings: UniformSamplingSettings,
    plan: Option<Plan>,
    /// The maps of the last frame and their input.
    drawn: Option<(Texture, MapInput)>,
    /// Number of maps that the last frame drew.
    drawn_count: usize,
}

/// The samples of a light of one size, in parts that fit the layers of the array.
struct Plan {
    light_size: Vec2,
    /// Maps in memory at a time.
    part: u32,
    samples: Vec<Sample>,
    points: Vec<Vec2>,
    evaluation: Evaluation,
}

impl Plan {
    fn new(gpu: &Gpu, settings: &UniformSamplingSettings, light_size: Vec2) -> Result<Plan, Error> {
        let samples = samples(settings.pattern, settings.weights, settings.samples, light_size)?;
        let count = samples.len() as u32;
        let part = match settings.evaluation {
            Evaluate::Array => count.min(LightMaps::most(gpu, settings.map)),
            Evaluate::Accumulate => 1,
        };
        let evaluation = Evaluation::new(gpu, settings.pcf, count, part)?;
        let points = samples.iter().map(|s| s.place).collect();
        Ok(Plan { light_size, part, samples, points, evaluation })
    }

    /// Number of times that maps are drawn and added up.
    fn parts(&self) -> u32 {
        self.count().div_ceil(self.part)
    }

    fn count(&self) -> u32 {
        self.samples.len() as u32
    }

    /// The list of samples with their layers and weights.
    fn entries(&self) -> Vec<u8> {
        let entry = |(i, s): (usize, &Sample)| Entry {
            sample: i as u32,
            layer: i as u32 % self.part,
            weight: s.weight,
            reach_low: Vec2::ZERO,
            reach_high: Vec2::ZERO,
        };
        entry_list(&self.samples.iter().enumerate().map(entry).collect::<Vec<_>>())
    }

    fn slots(&self) -> Vec<u8> {
        storage_bytes(&(0..self.count()).map(|sample| MapSlot { sample, stage: STAGE }).collect::<Vec<_>>())
    }
}

impl TechniqueFactory for UniformSampling {
    type Settings = UniformSamplingSettings;
    type Technique = UniformSampling;
    const DESCRIPTION: Description = Description {
        name: "uniform-sampling",
        title: "Light-source sampling",
        source: "Heckbert, Herf 1997; Schwärzler 2009, section 3.2",
        summary: "a fixed number of shadow maps over the light; tends to the truth, at a price for each map",
    };

    fn make(_gpu: &Gpu, settings: UniformSamplingSettings) -> Result<UniformSampling, Error> {
        Ok(UniformSampling { settings, plan: None, drawn: None, drawn_count: 0 })
    }
}

impl Technique for UniformSampling {
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        if self.plan.as_ref().is_none_or(|p| p.light_size != frame.light.size) {
            self.plan = None;
        }
        let plan = match &mut self.plan {
            Some(plan) => plan,
            none => none.insert(Plan::new(recorder.gpu, &self.settings, frame.light.size)?),
        };
        let (count, parts) = (plan.count(), plan.parts());
        let layers = Layers::new(recorder.gpu, plan.part, &frame.casters);
        let maps = LightMaps::new(recorder, frame, self.settings.map, layers, &plan.points)?;
        let key: [f32; 2] = plan.light_size.into();
        let entries = recorder.buffer_of_key("sample weights", bytemuck::bytes_of(&key), || plan.entries());
        let slots = recorder.buffer_of_key("map slots", bytemuck::bytes_of(&key), || plan.slots());
        let input = MapInput::of(frame);
        let same = |(texture, known): &(Texture, MapInput)| *texture == maps.texture && *known == input;
        let still_valid = frame.static_casters && parts == 1 && self.drawn.as_ref().is_some_and(same);
        for part in 0..parts {
            if !still_valid {
                let first = part * plan.part;
                let stage = layers.stage(STAGE, first, 0..plan.part.min(count - first));
                let uniform = recorder.uniform("map stage", &stage);
                maps.record(recorder, &frame.casters, &slots, &stage, &uniform.as_entire_binding())?;
            }
            plan.evaluation.record(recorder, frame, &maps, &entries, part)?;
        }
        self.drawn_count = if still_valid { 0 } else { plan.samples.len() };
        self.drawn = Some((maps.texture, input));
        Ok(())
    }

    fn stats<'a>(&'a self, _gpu: &'a Gpu) -> StatsFuture<'a> {
        let maps = self.plan.as_ref().map_or(0, |p| p.samples.len());
        Box::pin(std::future::ready(Ok(vec![("maps", maps as f64), ("maps drawn", self.drawn_count as f64)])))
    }
}
