//! Variance soft shadow mapping [Yang et al. 2010]: blockers' distance and visible part from the same two moments.

use super::summed::{Plan, Soft, SoftUniform, Summed};
use crate::passes::maps::moments::{DepthWarp, TexelFormat};
use crate::passes::maps::summed_area::{Sums, TableShape};
use crate::technique::Description;
use crate::technique::settings::Kind;

crate::settings! {
    /// Settings of [`Vssm`].
    pub struct VssmSettings {
        /// Shadow map, texels per side; its tables take 64 bytes per texel.
        map: u32 = 1024, Kind::Integer { min: 16, max: 16384 };
        /// Sums of 32 bits, of 32 bits less their mean, or of 64 bits.
        format: Sums = Sums::Fixed, Kind::Choice { options: Sums::OPTIONS };
        /// Parts per side that a window is divided into, each judged at the receiver's plane there; 1 is none.
        divisions: u32 = 4, Kind::Integer { min: 1, max: 16 };
    }
}

/// Soft shadow of an area light by the variance of depth.
pub type Vssm = Summed<VarianceSoft>;

/// Values that [`Vssm`] stores and reads.
pub struct VarianceSoft;

impl Soft for VarianceSoft {
    type Settings = VssmSettings;
    const DESCRIPTION: Description = Description {
        name: "vssm",
        title: "Variance soft shadow mapping",
        source: "Yang et al. 2010",
        summary: "blockers' distance and visible part from two moments over boxes of any width",
    };
    const WARP: &'static str = "techniques::moments::savsm::warp";
    const SOFT: &'static str = "techniques::moments::vssm::soft";

    fn plan(settings: &VssmSettings) -> Plan {
        Plan {
            table: TableShape { size: settings.map, layers: 2, sums: settings.format },
            warp: DepthWarp { rounding: TexelFormat::Rg32Float.rounding(), ..Default::default() },
            soft: SoftUniform { search: 0.0, divisions: settings.divisions as i32 },
        }
    }
}
