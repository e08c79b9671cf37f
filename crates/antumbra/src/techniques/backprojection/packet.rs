//! Baoguang Yang, Jieqing Feng, Gaël Guennebaud, Xinguo Liu, 2009: Packet-based hierarchal soft shadow mapping,
//! <https://doi.org/10.1111/j.1467-8659.2009.01489.x>.
//!
//! Back-projection by packets: 64 neighbouring pixels share the walk through the upper levels of the pyramid.

use super::{Backprojection, BackprojectionSettings, Spacing};
use crate::error::{Error, SpecError};
use crate::gpu::device::Gpu;
use crate::technique::{Description, TechniqueFactory};
use serde_json::{Map, Value};

/// [`Backprojection`] by packets of 64 neighbouring pixels.
pub struct Packet;

impl TechniqueFactory for Packet {
    type Settings = BackprojectionSettings;
    type Technique = Backprojection;
    const DESCRIPTION: Description = Description {
        name: "packet",
        title: "Layered back-projection by packets",
        source: "Yang 2009",
        summary: "backprojection by packets of 64 pixels that share the upper levels of the pyramid; speed depends on the adapter",
    };

    fn defaults(given: &Map<String, Value>) -> BackprojectionSettings {
        BackprojectionSettings { spacing: Spacing::S1, ..BackprojectionSettings::suited_to(given) }
    }

    fn make(gpu: &Gpu, settings: BackprojectionSettings) -> Result<Backprojection, Error> {
        if settings.spacing != Spacing::S1 {
            return Err(Error::Spec(SpecError::Value {
                technique: Self::DESCRIPTION.name.to_owned(),
                key: "spacing".to_owned(),
                value: settings.spacing.pixels().to_string(),
                expected: "a packet consists of adjacent pixels: leave it at 1, or use `backprojection`".to_owned(),
            }));
        }
        Backprojection::new(gpu, settings, true)
    }
}
