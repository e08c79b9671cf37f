//! The traits of a technique.

pub mod settings;

use crate::error::{Error, SpecError};
use crate::gpu::device::Gpu;
use crate::gpu::limits::Needs;
use crate::gpu::recorder::Recorder;
use crate::input::frame::BoundFrame;
use serde_json::{Map, Value};
use settings::{Setting, Settings};
use std::pin::Pin;

/// Fills a frame's visibility. It may be made on one thread and recorded on another.
pub trait Technique: wgpu::WasmNotSend {
    /// Records all passes. Resources are asked for from the recorder, which keeps them from frame to frame.
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error>;

    /// Counts of the last frame that are neither time nor memory, such as the number of maps. Waits for the GPU: for
    /// tests and reports.
    fn stats<'a>(&'a self, _gpu: &'a Gpu) -> StatsFuture<'a> {
        Box::pin(std::future::ready(Ok(Vec::new())))
    }
}

/// Names and values of [`Technique::stats`].
pub type StatsFuture<'a> = Pin<Box<dyn Future<Output = Result<Vec<(&'static str, f64)>, Error>> + 'a>>;

/// Makes a technique from its settings.
pub type MakeTechnique = fn(&Gpu, Value) -> Result<Box<dyn Technique>, Error>;

/// An entry of the list of techniques.
#[derive(Clone, Copy)]
pub struct TechniqueInfo {
    /// Name on the command line.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// Where it comes from: authors, year, section.
    pub source: &'static str,
    /// One sentence: method and use.
    pub summary: &'static str,
    /// Its settings.
    pub settings: &'static [Setting],
    /// Its defaults where these settings are given: a preset among them changes others.
    pub defaults: fn(&Map<String, Value>) -> Value,
    /// Limited resources of its most demanding shader.
    pub needs: Needs,
    /// Makes one from all its settings.
    pub make: MakeTechnique,
}

impl TechniqueInfo {
    /// Refuses an adapter that cannot run it as it comes, with the error that it would meet there, before anything is
    /// compiled.
    pub fn check(&self, gpu: &Gpu) -> Result<(), Error> {
        self.needs.check(self.name, &gpu.device.limits())?;
        let map = (self.defaults)(&Map::new())["map"].as_u64().and_then(|map| u32::try_from(map).ok());
        map.map_or(Ok(()), |map| gpu.check_size("shadow map", map, map))
    }
}

/// Makes a technique from typed settings: the line that a technique adds to the list is `entry::<Its>()`.
pub trait TechniqueFactory: 'static {
    /// Its settings.
    type Settings: Settings;
    /// The technique that it makes.
    type Technique: Technique + 'static;
    /// Name on the command line, title, source, and one sentence.
    const DESCRIPTION: Description;
    /// The resources of its most demanding shader, if they are more than every WebGPU device gives.
    const NEEDS: Needs = Needs::CORE;

    /// Its defaults where these settings are given. Techniques with presets start from the preset that is given.
    fn defaults(_given: &Map<String, Value>) -> Self::Settings {
        Self::Settings::default()
    }

    /// Makes one; compiles its pipelines.
    fn make(gpu: &Gpu, settings: Self::Settings) -> Result<Self::Technique, Error>;
}

/// The description of a technique for lists and documents.
pub struct Description {
    /// Name on the command line.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// Authors and year.
    pub source: &'static str,
    /// Method and use, in one sentence.
    pub summary: &'static str,
}

/// The list entry of a technique.
pub(crate) const fn entry<T: TechniqueFactory>() -> TechniqueInfo {
    TechniqueInfo {
        name: T::DESCRIPTION.name,
        title: T::DESCRIPTION.title,
        source: T::DESCRIPTION.source,
        summary: T::DESCRIPTION.summary,
        settings: T::Settings::FIELDS,
        needs: T::NEEDS,
        defaults: |given| serde_json::to_value(T::defaults(given)).expect("settings are plain data"),
        make: |gpu, value| {
            let settings = serde_json::from_value(value).map_err(|e| SpecError::Value {
                technique: T::DESCRIPTION.name.to_owned(),
                key: "settings".to_owned(),
                value: String::new(),
                expected: e.to_string(),
            })?;
            Ok(Box::new(T::make(gpu, settings)?))
        },
    }
}
