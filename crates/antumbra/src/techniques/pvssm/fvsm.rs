//! Markus Giegl, Michael Wimmer, 2007: Fitted virtual shadow maps, <https://doi.org/10.1145/1268517.1268545>.
//!
//! Hard shadows with one texel per pixel, antialiased: kernels are the pixels' footprints.

use super::{Pvssm, PvssmSettings, Rho};
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::limits::Needs;
use crate::technique::{Description, TechniqueFactory};
use serde_json::{Map, Value};

/// [`Pvssm`] of a point at the light's centre.
pub struct Fvsm;

impl TechniqueFactory for Fvsm {
    type Settings = PvssmSettings;
    type Technique = Pvssm;
    const DESCRIPTION: Description = Description {
        name: "fvsm",
        title: "Fitted virtual shadow maps",
        source: "Giegl 2007",
        summary: "hard shadows with one texel per pixel, for scenes of any size; antialiased over the pixel's footprint",
    };
    const NEEDS: Needs = Pvssm::NEEDS;

    fn defaults(_given: &Map<String, Value>) -> PvssmSettings {
        PvssmSettings { rho: Rho::Fitted, ..PvssmSettings::default() }
    }

    fn make(gpu: &Gpu, settings: PvssmSettings) -> Result<Pvssm, Error> {
        Pvssm::new(gpu, Self::DESCRIPTION.name, settings, true)
    }
}
