//! A fixed number of shadow maps over the light [Heckbert, Herf 1997; Schwärzler 2009, section 3.2]: the brute force
//! that tends to the truth as the maps get more and finer.

mod pattern;

pub use pattern::{Pattern, Sample, Weights, samples};

use crate::passes::maps::light_maps::{Drawn, Entry, Evaluation, LightMaps, LightSamples, MapSlot, MapStage};
use crate::gpu::recorder::Recorder;
use crate::gpu::resources::{UniformArray, storage_bytes, storage_of};
use crate::technique::{TechniqueAbout, TechniqueFactory, StatsFuture, InnerPicture, Memory, Technique};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::technique::settings::Kind;
use glam::Vec2;

crate::choices! {
    /// How the maps are added up.
    pub enum Evaluate {
        /// All maps lie in one texture array and are read in one pass [section 3.4.2]; in several where the device has no
        /// room for all.
        Array = "array",
        /// Each map is drawn into the same texture and added to the sum at once, in constant memory [section 3.4.1].
        Accumulate = "accumulate",
    }
}

crate::settings! {
    /// Settings of [`UniformSampling`].
    pub struct UniformSamplingSettings {
        /// Shadow maps, texels a side.
        map: u32 = 512, Kind::Integer { min: 16, max: 16384 };
        /// Number of shadow maps; 1 is the light's centre.
        samples: u32 = 64, Kind::Integer { min: 1, max: 4096 };
        /// How the samples lie on the light: an even sequence, one in each cell of a grid, or a grid from rim to rim.
        pattern: Pattern = Pattern::LowDiscrepancy, Kind::Choice { options: Pattern::OPTIONS };
        /// What the samples of a regular grid count: the area around them, or all the same as in the paper.
        weights: Weights = Weights::Area, Kind::Choice { options: Weights::OPTIONS };
        /// Width of the filter on each map in texels a side; 1 is a single lookup.
        pcf: u32 = 2, Kind::Integer { min: 1, max: 33 };
        /// All maps in one array, or one after the other through the same texture.
        evaluation: Evaluate = Evaluate::Array, Kind::Choice { options: Evaluate::OPTIONS };
    }
}

/// The stage of every map: all are drawn in one round.
const STAGE: u32 = 0;

/// Shadow of a rectangular or linear light by as many shadow maps as asked for.
pub struct UniformSampling {
    settings: UniformSamplingSettings,
    plan: Option<Plan>,
    samples: Option<LightSamples>,
    maps: Option<LightMaps>,
    /// A round of drawing for each part of the maps that is in memory at once.
    stages: Option<UniformArray<MapStage>>,
    /// What the maps were drawn for, if they still hold it.
    drawn: Option<Drawn>,
    /// Maps that the last frame drew.
    drawn_count: usize,
}

/// What depends on the light's size alone, and on how many maps there is room for.
struct Plan {
    light_size: Vec2,
    /// Maps that are in memory at once.
    part: u32,
    places: Vec<Vec2>,
    entries: wgpu::Buffer,
    slots: wgpu::Buffer,
    evaluation: Evaluation,
}

impl Plan {
    fn new(gpu: &Gpu, settings: &UniformSamplingSettings, light_size: Vec2) -> Result<Plan, Error> {
        let list = samples(settings.pattern, settings.weights, settings.samples, light_size)?;
        let count = list.len() as u32;
        let part = match settings.evaluation {
            Evaluate::Array => count.min(LightMaps::most(gpu, settings.map)),
            Evaluate::Accumulate => 1,
        };
        let entries: Vec<Entry> = list
            .iter()
            .enumerate()
            .map(|(i, s)| Entry {
                sample: i as u32,
                layer: i as u32 % part,
                weight: s.weight,
                reach_low: Vec2::ZERO,
                reach_high: Vec2::ZERO,
            })
            .collect();
        let slots: Vec<MapSlot> = (0..count).map(|sample| MapSlot { sample, stage: STAGE }).collect();
        let bytes = [&count.to_le_bytes()[..], &[0; 4], &storage_bytes(&entries)].concat();
        Ok(Plan {
            light_size,
            part,
            places: list.iter().map(|s| s.place).collect(),
            entries: crate::gpu::resources::buffer_of(gpu, "light samples", &bytes, wgpu::BufferUsages::STORAGE),
            slots: storage_of(gpu, "map slots", &slots),
            evaluation: Evaluation::new(gpu, settings.pcf, count, part)?,
        })
    }
}

impl Plan {
    /// How many times maps are drawn and added up.
    fn parts(&self) -> u32 {
        (self.places.len() as u32).div_ceil(self.part)
    }
}

impl TechniqueFactory for UniformSampling {
    type Settings = UniformSamplingSettings;
    const ABOUT: TechniqueAbout = TechniqueAbout {
        name: "uniform-sampling",
        title: "Light-source sampling",
        source: "Heckbert, Herf 1997; Schwärzler 2009, section 3.2",
        summary: "a fixed number of shadow maps over the light; tends to the truth, at a price for each map",
    };

    fn make(_gpu: &Gpu, settings: UniformSamplingSettings) -> Result<Self, Error> {
        Ok(UniformSampling {
            settings,
            plan: None,
            samples: None,
            maps: None,
            stages: None,
            drawn: None,
            drawn_count: 0,
        })
    }
}

impl Technique for UniformSampling {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        let gpu = recorder.gpu;
        if self.plan.as_ref().is_none_or(|p| p.light_size != frame.light.size) {
            self.plan = Some(Plan::new(gpu, &self.settings, frame.light.size)?);
            self.stages = None;
        }
        let plan = self.plan.as_ref().expect("just made");
        let (count, parts) = (plan.places.len() as u32, plan.parts());
        let samples = LightSamples::ensure(&mut self.samples, gpu, frame, &plan.places);
        let had_maps = self.maps.as_ref().is_some_and(|m| m.fits(gpu, self.settings.map, plan.part, &frame.casters));
        let maps = LightMaps::ensure(&mut self.maps, gpu, self.settings.map, plan.part, &frame.casters)?;
        let is_new = !had_maps || self.stages.is_none();
        if is_new {
            let stage = |p: u32| maps.stage(STAGE, p * plan.part, 0..plan.part.min(count - p * plan.part));
            self.stages = Some(UniformArray::new(gpu, "map stages", &(0..parts).map(stage).collect::<Vec<_>>()));
        }
        let stages = self.stages.as_ref().expect("just made");
        let now = Drawn::of(frame);
        let are_same = !is_new && self.drawn.as_ref().is_some_and(|d| d.is(&now));
        let still_there = frame.static_casters && parts == 1 && are_same;
        for part in 0..parts {
            if !still_there {
                maps.record(recorder, &frame.casters, samples, &plan.slots, stages, part)?;
            }
            plan.evaluation.record(recorder, frame, samples, maps, &plan.entries, part);
        }
        self.drawn_count = if still_there { 0 } else { plan.places.len() };
        self.drawn = Some(now);
        Ok(())
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        let maps = self.maps.iter().map(LightMaps::inner_picture);
        maps.chain(self.plan.iter().map(|p| InnerPicture::of_light_points(&p.places))).collect()
    }

    fn memory(&self) -> Vec<Memory> {
        self.maps.iter().flat_map(LightMaps::memory).collect()
    }

    fn stats<'a>(&'a self, _gpu: &'a Gpu) -> StatsFuture<'a> {
        let maps = self.plan.as_ref().map_or(0, |p| p.places.len());
        Box::pin(std::future::ready(Ok(vec![("maps", maps as f64), ("maps drawn", self.drawn_count as f64)])))
    }
}
