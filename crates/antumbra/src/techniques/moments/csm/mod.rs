//! Convolution shadow maps [Annen 2007]: the depth comparison as a Fourier series, whose terms can be filtered.

use super::prefiltered::{Prefilter, Prefiltered, Stored};
use crate::passes::maps::moments::{DepthWarp, TexelFormat, fourier};
use crate::technique::Description;
use crate::technique::settings::Kind;

crate::choices! {
    /// How sines and cosines are stored.
    pub enum CsmFormat {
        /// 16-bit numbers.
        Rgba16Float = "rgba16float",
        /// 8-bit fractions from -1 to 1, as in the paper.
        Rgba8Snorm = "rgba8snorm",
        /// 32-bit numbers.
        Rgba32Float = "rgba32float",
    }
}

crate::prefilter_settings! {
    /// Settings of [`Csm`].
    pub struct CsmSettings {
        /// Sines and cosines in 16 bits, in 8 as in the paper, or in 32.
        format: CsmFormat = CsmFormat::Rgba16Float, Kind::Choice { options: CsmFormat::OPTIONS };
        /// Terms of the series, two of which make a layer of the map.
        terms: u32 = 8, Kind::Integer { min: 1, max: 16 };
    }
}

/// Shadow of the light's centre, prefiltered, whatever the number of surfaces.
pub type Csm = Prefiltered<Convolution>;

/// Values that [`Csm`] stores.
pub struct Convolution;

impl Prefilter for Convolution {
    type Settings = CsmSettings;
    const DESCRIPTION: Description = Description {
        name: "csm",
        title: "Convolution shadow maps",
        source: "Annen 2007",
        summary: "the comparison as a Fourier series, prefiltered; contact shadows fade",
    };
    const WARP: &'static str = "techniques::moments::csm::warp";

    fn stored(settings: &CsmSettings) -> Stored {
        let format = match settings.format {
            CsmFormat::Rgba16Float => TexelFormat::Rgba16Float,
            CsmFormat::Rgba8Snorm => TexelFormat::Rgba8Snorm,
            CsmFormat::Rgba32Float => TexelFormat::Rgba32Float,
        };
        let ripple = fourier::ripple(settings.terms, format.rounding());
        let warp = DepthWarp { rounding: format.rounding(), terms: settings.terms, ripple, ..Default::default() };
        Stored { format, portable: "rgba16float", layers: settings.terms.div_ceil(2), warp }
    }
}
