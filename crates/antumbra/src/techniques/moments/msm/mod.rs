//! Moment shadow maps [Peters, Klein 2015]: four moments of depth, and the sharpest bound that they allow.

use super::prefiltered::{Prefilter, Prefiltered, Stored};
use crate::passes::maps::moments::{DepthWarp, TexelFormat};
use crate::technique::Description;
use crate::technique::settings::Kind;

crate::choices! {
    /// How the four moments are stored.
    pub enum MsmFormat {
        /// Four 32-bit numbers.
        Rgba32Float = "rgba32float",
        /// Four 16-bit fractions, in a basis that loses little by rounding.
        Rgba16Unorm = "rgba16unorm",
    }
}

crate::prefilter_settings! {
    /// Settings of [`Msm`].
    pub struct MsmSettings {
        /// Four 32-bit numbers per texel, or four 16-bit fractions in a basis that loses little by rounding.
        format: MsmFormat = MsmFormat::Rgba32Float, Kind::Choice { options: MsmFormat::OPTIONS };
        /// Against light bleeding: this part of the bound becomes 0 and the rest is stretched; widens shadows.
        bleeding: f32 = 0.0, Kind::Number { min: 0.0, max: 0.95 };
    }
}

/// Shadow of the light's centre, prefiltered, that keeps two surfaces apart.
pub type Msm = Prefiltered<Moments>;

/// Values that [`Msm`] stores.
pub struct Moments;

impl Prefilter for Moments {
    type Settings = MsmSettings;
    const DESCRIPTION: Description = Description {
        name: "msm",
        title: "Moment shadow maps",
        source: "Peters, Klein 2015",
        summary: "four moments of depth, prefiltered; light bleeds where three surfaces overlap",
    };
    const WARP: &'static str = "techniques::moments::msm::warp";

    fn stored(settings: &MsmSettings) -> Stored {
        // How far the moments are moved: the values of the paper's section 4.3 for each precision.
        let (format, rounding, terms) = match settings.format {
            MsmFormat::Rgba32Float => (TexelFormat::Rgba32Float, 3e-7, 0),
            MsmFormat::Rgba16Unorm => (TexelFormat::Rgba16Unorm, 6e-5, 1),
        };
        let warp = DepthWarp { rounding, terms, bleeding: settings.bleeding, ..Default::default() };
        Stored { format, portable: "rgba32float", layers: 1, warp }
    }
}
