//! Exponential variance shadow maps [Lauritzen, McCool 2008]: variance shadow maps of a warped depth.

use super::prefiltered::{Prefilter, Prefiltered, Stored};
use crate::passes::maps::moments::{DepthWarp, TexelFormat};
use crate::technique::Description;
use crate::technique::settings::Kind;
use glam::Vec2;

crate::choices! {
    /// How the moments of one or of both warps are stored.
    pub enum EvsmFormat {
        /// Two 32-bit numbers, of the positive warp.
        Rg32Float = "rg32float",
        /// Four 32-bit numbers, of both warps.
        Rgba32Float = "rgba32float",
        /// Two 16-bit numbers, of the positive warp.
        Rg16Float = "rg16float",
        /// Four 16-bit numbers, of both warps.
        Rgba16Float = "rgba16float",
    }
}

crate::prefilter_settings! {
    /// Settings of [`Evsm`].
    pub struct EvsmSettings {
        /// Two numbers per texel (the positive warp) or four (the negative one too), of 32 or 16 bits.
        format: EvsmFormat = EvsmFormat::Rgba32Float, Kind::Choice { options: EvsmFormat::OPTIONS };
        /// Exponent of the warp over the range of depths; formats of 16 bits take no more than 9.
        exponent: f32 = 40.0, Kind::Number { min: 1.0, max: 80.0 };
        /// Against light bleeding: this part of the bound becomes 0 and the rest is stretched; widens shadows.
        bleeding: f32 = 0.0, Kind::Number { min: 0.0, max: 0.95 };
    }
}

/// The square of the warp over depths from -1/2 to 1/2 goes from e^-c to e^c: numbers of 16 bits hold 6e-5 to 65504.
const MOST_IN_16_BITS: f32 = 9.0;

/// Shadow of the light's centre, prefiltered, with less light bleeding than variance alone.
pub type Evsm = Prefiltered<ExponentialVariance>;

/// Values that [`Evsm`] stores.
pub struct ExponentialVariance;

impl Prefilter for ExponentialVariance {
    type Settings = EvsmSettings;
    const DESCRIPTION: Description = Description {
        name: "evsm",
        title: "Exponential variance shadow maps",
        source: "Lauritzen, McCool 2008",
        summary: "variance of exponentially warped depth; light bleeds only from occluder to close occluder",
    };
    const WARP: &'static str = "techniques::moments::evsm::warp";

    fn stored(settings: &EvsmSettings) -> Stored {
        let (format, narrow, both) = match settings.format {
            EvsmFormat::Rg32Float => (TexelFormat::Rg32Float, false, false),
            EvsmFormat::Rgba32Float => (TexelFormat::Rgba32Float, false, true),
            EvsmFormat::Rg16Float => (TexelFormat::Rg16Float, true, false),
            EvsmFormat::Rgba16Float => (TexelFormat::Rgba16Float, true, true),
        };
        let exponent = if narrow { settings.exponent.min(MOST_IN_16_BITS) } else { settings.exponent };
        let warp = DepthWarp {
            rounding: format.rounding(),
            exponents: Vec2::new(exponent, if both { exponent } else { 0.0 }),
            bleeding: settings.bleeding,
            ..Default::default()
        };
        Stored { format, portable: "rgba32float", layers: 1, warp }
    }
}
