//! What can be set.

use crate::technique::settings::Kind;
use serde_json::{Map, Value};

crate::choices! {
    /// How the parts of the light that patches hide are put together.
    pub enum Join {
        /// Each point of the light is hidden once, however many patches cover it.
        Union = "union",
        /// Areas are added up, and what overlaps on the light is counted twice [Guennebaud 2006].
        Sum = "sum",
    }
}

crate::choices! {
    /// Points of the light that are told apart, a bit each.
    pub enum Bits {
        /// 64.
        B64 = "64",
        /// 128.
        B128 = "128",
        /// 256.
        B256 = "256",
        /// 512.
        B512 = "512",
        /// 1024.
        B1024 = "1024",
    }
}

crate::choices! {
    /// Pixels from one to the next.
    pub enum Spacing {
        /// 1.
        S1 = "1",
        /// 2.
        S2 = "2",
        /// 4.
        S4 = "4",
        /// 8.
        S8 = "8",
    }
}

crate::choices! {
    /// Settings that go well together, found by `antumbra bench backprojection`.
    pub enum Quality {
        /// As quick as percentage-closer soft shadows.
        Fast = "fast",
        /// Little error for little time.
        Balanced = "balanced",
        /// Hardly any error.
        Best = "best",
    }
}

crate::settings! {
    /// Settings of [`Backprojection`](super::Backprojection) and [`Packet`](crate::techniques::backprojection::packet::Packet).
    pub struct BackprojectionSettings {
        /// Where the other settings start from.
        quality: Quality = Quality::Balanced, Kind::Choice { options: Quality::OPTIONS };
        /// Shadow map, texels a side.
        map: u32 = 1536, Kind::Integer { min: 16, max: 16384 };
        /// Layers behind each other that each texel of the map keeps: a surface each, or all between two.
        layers: u32 = 2, Kind::Integer { min: 1, max: 4 };
        /// Surfaces are one layer if the light moves them by fewer texels than this against each other. 0 keeps each apart.
        apart: f32 = 8.0, Kind::Number { min: 0.0, max: 1000.0 };
        /// Patches a side that the light is resolved into at least.
        window: f32 = 4.0, Kind::Number { min: 1.0, max: 256.0 };
        /// Pixels between those that are looked at first; the others follow where these do not tell them. 1 looks at all.
        spacing: Spacing = Spacing::S2, Kind::Choice { options: Spacing::OPTIONS };
        /// Points of the light for join=union.
        bits: Bits = Bits::B256, Kind::Choice { options: Bits::OPTIONS };
        /// How the parts of the light that patches hide are put together.
        join: Join = Join::Union, Kind::Choice { options: Join::OPTIONS };
        /// Patches are as steep as their surface, so that neighbours meet; false leaves them flat, with gaps.
        gaps_filled: bool = true, Kind::Toggle;
    }
}

impl BackprojectionSettings {
    /// The settings of a quality.
    pub fn of_quality(quality: Quality) -> BackprojectionSettings {
        let balanced = BackprojectionSettings { quality, ..Default::default() };
        match quality {
            Quality::Fast => BackprojectionSettings { map: 512, window: 2.0, ..balanced },
            Quality::Balanced => balanced,
            Quality::Best => BackprojectionSettings {
                map: 2048,
                layers: 4,
                apart: 4.0,
                window: 16.0,
                spacing: Spacing::S1,
                bits: Bits::B1024,
                ..balanced
            },
        }
    }

    /// The settings of the quality that is among `given`.
    pub(crate) fn suited_to(given: &Map<String, Value>) -> BackprojectionSettings {
        let quality = given.get("quality").and_then(|q| serde_json::from_value(q.clone()).ok());
        quality.map_or_else(Default::default, BackprojectionSettings::of_quality)
    }
}

impl Spacing {
    pub(crate) fn pixels(self) -> u32 {
        match self {
            Spacing::S1 => 1,
            Spacing::S2 => 2,
            Spacing::S4 => 4,
            Spacing::S8 => 8,
        }
    }
}

impl Bits {
    /// The feature of `mask.wesl` that stands for it; 256 is what it has without one.
    pub(crate) fn feature(self) -> &'static str {
        match self {
            Bits::B64 => "bits64",
            Bits::B128 => "bits128",
            Bits::B256 => "bits256",
            Bits::B512 => "bits512",
            Bits::B1024 => "bits1024",
        }
    }
}
