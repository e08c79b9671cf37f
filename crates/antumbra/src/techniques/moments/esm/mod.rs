//! Exponential shadow maps [Annen 2008, Salvi 2008]: one number per texel.

use super::prefiltered::{Prefilter, Prefiltered, Stored};
use crate::passes::maps::moments::{DepthWarp, TexelFormat};
use crate::technique::Description;
use crate::technique::settings::Kind;
use glam::Vec2;

crate::choices! {
    /// How the exponential is stored.
    pub enum EsmFormat {
        /// A 32-bit number.
        R32Float = "r32float",
        /// A 16-bit number.
        R16Float = "r16float",
    }
}

crate::prefilter_settings! {
    /// Settings of [`Esm`].
    pub struct EsmSettings {
        /// A 32-bit number per texel, or one of 16 bits.
        format: EsmFormat = EsmFormat::R32Float, Kind::Choice { options: EsmFormat::OPTIONS };
        /// Exponent over the range of depths; 16 bits take no more than 20.
        exponent: f32 = 80.0, Kind::Number { min: 1.0, max: 160.0 };
    }
}

/// Depths from -1/2 to 1/2 give e^-c/2 to e^c/2: numbers of 16 bits hold 6e-5 to 65504.
const MOST_IN_16_BITS: f32 = 20.0;

/// Shadow of the light's centre, prefiltered, by one number per texel.
pub type Esm = Prefiltered<Exponential>;

/// Values that [`Esm`] stores.
pub struct Exponential;

impl Prefilter for Exponential {
    type Settings = EsmSettings;
    const DESCRIPTION: Description = Description {
        name: "esm",
        title: "Exponential shadow maps",
        source: "Annen 2008, Salvi 2008",
        summary: "one exponential of depth, prefiltered; light bleeds where an occluder is close",
    };
    const WARP: &'static str = "techniques::moments::esm::warp";

    fn stored(settings: &EsmSettings) -> Stored {
        let (format, exponent) = match settings.format {
            EsmFormat::R32Float => (TexelFormat::R32Float, settings.exponent),
            EsmFormat::R16Float => (TexelFormat::R16Float, settings.exponent.min(MOST_IN_16_BITS)),
        };
        let exponents = Vec2::new(exponent, 0.0);
        let warp = DepthWarp { rounding: format.rounding(), exponents, ..Default::default() };
        Stored { format, portable: "r32float", layers: 1, warp }
    }
}
