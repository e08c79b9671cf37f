//! What a technique is, and the one list of techniques.

use crate::settings::{Setting, Settings, SpecError, nearest, parse_values};
use crate::{Error, Frame, Gpu, recorder::Recorder, techniques::TECHNIQUES};
use serde_json::{Map, Value};
use std::pin::Pin;

/// Fills a frame's visibility.
pub trait Technique {
    /// Records all passes. Textures are made at the first call and again when sizes change.
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error>;

    /// GPU memory that it owns, by the label of the pass that fills it.
    fn memory(&self) -> Vec<Memory>;

    /// What the last frame did, in figures that are neither time nor memory, such as the number of maps. Waits for the
    /// GPU: for tests and reports.
    fn figures<'a>(&'a self, _gpu: &'a Gpu) -> FiguresFuture<'a> {
        Box::pin(std::future::ready(Ok(Vec::new())))
    }
}

/// Names and values of [`Technique::figures`].
pub type FiguresFuture<'a> = Pin<Box<dyn Future<Output = Result<Vec<(&'static str, f64)>, Error>> + 'a>>;

/// GPU memory of one pass.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Memory {
    /// Label of the pass.
    pub pass: &'static str,
    /// Bytes.
    pub bytes: u64,
}

impl Memory {
    /// `bytes` that belong to `pass`.
    pub fn new(pass: &'static str, bytes: u64) -> Memory {
        Memory { pass, bytes }
    }
}

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
    /// One sentence: what it does and what it is good for.
    pub summary: &'static str,
    /// Its settings.
    pub settings: &'static [Setting],
    /// Its defaults where these settings are given: a preset among them changes others.
    pub defaults: fn(&Map<String, Value>) -> Value,
    /// Makes one from all its settings.
    pub make: MakeTechnique,
}

/// A technique with its settings, as on the command line: `name:key=value,key=value`.
#[derive(Clone)]
pub struct Spec {
    /// The technique.
    pub technique: &'static TechniqueInfo,
    /// All settings, defaults filled in.
    pub settings: Value,
    /// As it was given.
    pub text: String,
}

impl std::str::FromStr for Spec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Spec, SpecError> {
        let (name, values) = text.split_once(':').unwrap_or((text, ""));
        let technique = find(name)?;
        let given = parse_values(technique.name, technique.settings, values)?;
        let mut settings = (technique.defaults)(&given);
        settings.as_object_mut().unwrap_or(&mut Map::new()).extend(given);
        Ok(Spec { technique, settings, text: text.to_owned() })
    }
}

impl Spec {
    /// Makes the technique.
    pub fn make(&self, gpu: &Gpu) -> Result<Box<dyn Technique>, Error> {
        (self.technique.make)(gpu, self.settings.clone())
    }
}

/// The technique of this name.
pub fn find(name: &str) -> Result<&'static TechniqueInfo, SpecError> {
    TECHNIQUES.iter().find(|t| t.name == name).ok_or_else(|| SpecError::UnknownTechnique {
        asked: name.to_owned(),
        nearest: nearest(name, TECHNIQUES.iter().map(|t| t.name)),
    })
}

/// A technique that is made from its settings: the line that a technique adds to the list is `entry::<Its>()`.
pub trait Describe: Technique + Sized + 'static {
    /// Its settings.
    type Settings: Settings;
    /// Name on the command line, name for people, source, and what it does in one sentence.
    const ABOUT: About;

    /// Its defaults where these settings are given. Techniques with presets start from the preset that is given.
    fn defaults(_given: &Map<String, Value>) -> Self::Settings {
        Self::Settings::default()
    }

    /// Makes one; compiles its pipelines.
    fn make(gpu: &Gpu, settings: Self::Settings) -> Result<Self, Error>;
}

/// What a technique says of itself.
pub struct About {
    /// Name on the command line.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// What it does and what it is good for.
    pub summary: &'static str,
}

/// The list entry of a technique.
pub(crate) const fn entry<T: Describe>() -> TechniqueInfo {
    TechniqueInfo {
        name: T::ABOUT.name,
        title: T::ABOUT.title,
        source: T::ABOUT.source,
        summary: T::ABOUT.summary,
        settings: T::Settings::FIELDS,
        defaults: |given| serde_json::to_value(T::defaults(given)).expect("settings are plain data"),
        make: |gpu, value| {
            let settings = serde_json::from_value(value).map_err(|e| SpecError::Value {
                technique: T::ABOUT.name.to_owned(),
                key: "settings".to_owned(),
                value: String::new(),
                expected: e.to_string(),
            })?;
            Ok(Box::new(T::make(gpu, settings)?))
        },
    }
}
