//! Techniques by name: `name:key=value,key=value`.

use super::TECHNIQUES;
use crate::error::{Error, SpecError};
use crate::gpu::device::Gpu;
use crate::technique::settings::{nearest, parse_values};
use crate::technique::{Technique, TechniqueInfo};
use serde_json::{Map, Value};

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
