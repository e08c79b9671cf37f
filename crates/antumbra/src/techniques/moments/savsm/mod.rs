//! Summed-area variance shadow maps [Lauritzen 2007]: percentage-closer blocker search, then the variance of depth over
//! the box that the light makes at the blockers' distance.

use super::summed::{Plan, Soft, SoftUniform, Summed};
use crate::passes::maps::moments::{DepthWarp, TexelFormat};
use crate::passes::maps::summed_area::{Sums, TableShape};
use crate::technique::Description;
use crate::technique::settings::Kind;

crate::settings! {
    /// Settings of [`Savsm`].
    pub struct SavsmSettings {
        /// Shadow map, texels per side; its tables take 64 bytes per texel.
        map: u32 = 1024, Kind::Integer { min: 16, max: 16384 };
        /// Sums of 32 bits, of 32 bits less their mean, or of 64 bits.
        format: Sums = Sums::Fixed, Kind::Choice { options: Sums::OPTIONS };
        /// Widest blocker search, in nodes of the depth pyramid per side.
        search: u32 = 16, Kind::Integer { min: 2, max: 256 };
    }
}

/// Soft shadow of an area light by the variance of depth.
pub type Savsm = Summed<SummedVariance>;

/// Values that [`Savsm`] stores and reads.
pub struct SummedVariance;

impl Soft for SummedVariance {
    type Settings = SavsmSettings;
    const DESCRIPTION: Description = Description {
        name: "savsm",
        title: "Summed-area variance shadow maps",
        source: "Lauritzen 2007",
        summary: "blockers searched as by pcss; then a box of any width by four corners of a table",
    };
    const WARP: &'static str = "techniques::moments::savsm::warp";
    const SOFT: &'static str = "techniques::moments::savsm::soft";

    fn plan(settings: &SavsmSettings) -> Plan {
        Plan {
            table: TableShape { size: settings.map, layers: 2, sums: settings.format },
            warp: DepthWarp { rounding: TexelFormat::Rg32Float.rounding(), ..Default::default() },
            soft: SoftUniform { search: settings.search as f32, divisions: 1 },
        }
    }
}
