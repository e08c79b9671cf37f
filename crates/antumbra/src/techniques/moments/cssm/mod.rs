//! Convolution soft shadow maps [Annen 2008]: blockers' distance and visible part from Fourier series over boxes.

use super::summed::{Plan, Soft, SoftUniform, Summed};
use crate::passes::maps::moments::{DepthWarp, TexelFormat, fourier};
use crate::passes::maps::summed_area::{Sums, TableShape};
use crate::technique::Description;
use crate::technique::settings::Kind;

crate::settings! {
    /// Settings of [`Cssm`].
    pub struct CssmSettings {
        /// Shadow map, texels per side; its tables take 32 bytes per texel for each term.
        map: u32 = 512, Kind::Integer { min: 16, max: 8192 };
        /// Terms of the series.
        terms: u32 = 8, Kind::Integer { min: 1, max: 16 };
    }
}

/// Soft shadow of an area light by the comparison's Fourier series.
pub type Cssm = Summed<ConvolutionSoft>;

/// Values that [`Cssm`] stores and reads.
pub struct ConvolutionSoft;

impl Soft for ConvolutionSoft {
    type Settings = CssmSettings;
    const DESCRIPTION: Description = Description {
        name: "cssm",
        title: "Convolution soft shadow maps",
        source: "Annen 2008",
        summary: "the comparison as a Fourier series over boxes of any width; contact shadows fade",
    };
    const WARP: &'static str = "techniques::moments::cssm::warp";
    const SOFT: &'static str = "techniques::moments::cssm::soft";

    fn plan(settings: &CssmSettings) -> Plan {
        let rounding = TexelFormat::Rgba32Float.rounding();
        let ripple = fourier::ripple(settings.terms, rounding);
        Plan {
            // Sines and cosines of two terms a layer, the same times depth, and depth.
            table: TableShape { size: settings.map, layers: 2 * settings.terms.div_ceil(2) + 1, sums: Sums::Offset },
            warp: DepthWarp { rounding, terms: settings.terms, ripple, ..Default::default() },
            soft: SoftUniform::default(),
        }
    }
}
