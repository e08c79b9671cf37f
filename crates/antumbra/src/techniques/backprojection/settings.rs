//! Settings of the family.

use crate::technique::settings::Kind;
use serde_json::{Map, Value};

crate::choices! {
    /// How the areas that patches hide on the light are combined.
    pub enum Join {
        /// A sample point of the light is hidden once, by any number of patches.
        Union = "union",
        /// Areas are added; overlaps on the light count twice [Guennebaud 2006].
        Sum = "sum",
    }
}

crate::choices! {
    /// Number of sample points on the light, a bit each.
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
    /// Distance between pixels of a grid.
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
    /// Presets, found by `antumbra bench backprojection`.
    pub enum Quality {
        /// About as fast as percentage-closer soft shadows.
        Fast = "fast",
        /// Small error in moderate time.
        Balanced = "balanced",
        /// Smallest error.
        Best = "best",
    }
}

crate::settings! {
    /// Settings of [`Backprojection`](super::Backprojection) and [`Packet`](super::packet::Packet).
    pub struct BackprojectionSettings {
        /// Preset: the defaults of the other settings.
        quality: Quality = Quality::Balanced, Kind::Choice { options: Quality::OPTIONS };
        /// Shadow map, texels per side.
        map: u32 = 1536, Kind::Integer { min: 16, max: 16384 };
        /// Depth layers per texel of the map: a surface each, or all surfaces between two depths.
        layers: u32 = 2, Kind::Integer { min: 1, max: 4 };
        /// Merge surfaces whose parallax over the light is below this many texels into one layer. 0 merges none.
        apart: f32 = 8.0, Kind::Number { min: 0.0, max: 1000.0 };
        /// Resolution of the light: at least this many patches per side.
        window: f32 = 4.0, Kind::Number { min: 1.0, max: 256.0 };
        /// Spacing of the pixels that are shaded first; the others are interpolated, or shaded where that is not safe. 1 shades all.
        spacing: Spacing = Spacing::S2, Kind::Choice { options: Spacing::OPTIONS };
        /// Sample points on the light for join=union.
        bits: Bits = Bits::B256, Kind::Choice { options: Bits::OPTIONS };
        /// How the areas that patches hide on the light are combined: each sample point once, or areas added.
        join: Join = Join::Union, Kind::Choice { options: Join::OPTIONS };
        /// Patches follow the slope of their surface, so that neighbours meet; false: flat patches with gaps between them.
        gaps_filled: bool = true, Kind::Toggle;
    }
}

impl BackprojectionSettings {
    /// The settings of a preset.
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

    /// The settings of the preset among `given`, or the defaults.
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
    /// The feature of `mask.wesl`.
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
