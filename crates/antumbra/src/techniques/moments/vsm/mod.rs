//! Variance shadow maps [Donnelly, Lauritzen 2006]: mean and mean square of the depths in per texel, which can be
//! filtered.

use super::prefiltered::{Prefilter, Prefiltered, Stored};
use crate::passes::maps::moments::{DepthWarp, TexelFormat};
use crate::technique::Description;
use crate::technique::settings::Kind;

crate::choices! {
    /// How the two moments are stored.
    pub enum VsmFormat {
        /// Two 32-bit numbers.
        Rg32Float = "rg32float",
        /// Two 16-bit numbers, whose rounding shows.
        Rg16Float = "rg16float",
        /// Two 32-bit numbers, each over two 16-bit channels.
        Split = "split",
    }
}

crate::prefilter_settings! {
    /// Settings of [`Vsm`].
    pub struct VsmSettings {
        /// Two 32-bit numbers per texel, two of 16 bits, or two of 32 bits over four channels of 16.
        format: VsmFormat = VsmFormat::Rg32Float, Kind::Choice { options: VsmFormat::OPTIONS };
        /// Against light bleeding: this part of the bound becomes 0 and the rest is stretched; widens shadows.
        bleeding: f32 = 0.0, Kind::Number { min: 0.0, max: 0.95 };
    }
}

/// Shadow of the light's centre, prefiltered.
pub type Vsm = Prefiltered<Variance>;

/// Values that [`Vsm`] stores.
pub struct Variance;

impl Prefilter for Variance {
    type Settings = VsmSettings;
    const DESCRIPTION: Description = Description {
        name: "vsm",
        title: "Variance shadow maps",
        source: "Donnelly, Lauritzen 2006",
        summary: "mean and variance of depth, prefiltered; light bleeds where shadows overlap",
    };
    const WARP: &'static str = "techniques::moments::vsm::warp";

    fn stored(settings: &VsmSettings) -> Stored {
        let format = match settings.format {
            VsmFormat::Rg32Float => TexelFormat::Rg32Float,
            VsmFormat::Rg16Float => TexelFormat::Rg16Float,
            VsmFormat::Split => TexelFormat::Split,
        };
        let warp = DepthWarp { rounding: format.rounding(), bleeding: settings.bleeding, ..Default::default() };
        Stored { format, portable: "rg32float", layers: 1, warp }
    }
}
