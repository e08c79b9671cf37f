//! Settings of this technique.

use crate::error::SpecError;
use crate::technique::settings::Kind;
use crate::techniques::light_sampling::uniform::{Evaluate, Weights};

crate::choices! {
    /// Criterion for splitting a cell of the light.
    pub enum Criterion {
        /// Somewhere on the screen the visibility may change by more than `tolerance`.
        Local = "local",
        /// Enough pixels see depths in opposite maps that differ by `gamma` metres [eq. 3 and 4].
        Absolute = "absolute",
        /// Enough pixels see depths in opposite maps that differ by the part `gamma` [eq. 7 and 4].
        Relative = "relative",
    }
}

crate::choices! {
    /// Information of a map about the light around its sample.
    pub enum Filter {
        /// The part of the sample's cell of the light that is seen, by back-projection of the map.
        Cell = "cell",
        /// Whether the sample is seen, filtered over a few texels [section 3.4.3].
        Pcf = "pcf",
    }
}

crate::choices! {
    /// Where depths are compared.
    pub enum Space {
        /// At the pixels of the image: invisible surfaces need no maps.
        Camera = "camera",
        /// At the surfaces nearest to the light's centre: a steady number of maps, whatever the camera does [section
        /// 4.1].
        Light = "light",
    }
}

crate::settings! {
    /// Settings of [`AdaptiveSampling`](super::AdaptiveSampling).
    pub struct AdaptiveSamplingSettings {
        /// Shadow maps, texels per side.
        map: u32 = 512, Kind::Integer { min: 16, max: 16384 };
        /// Information of a map about the light around its sample: its cell (smooth with few maps), or the sample alone (pcf).
        filter: Filter = Filter::Cell, Kind::Choice { options: Filter::OPTIONS };
        /// Reads per side for a cell, for filter=cell; twice as many for steady=true, where edges move.
        taps: u32 = 8, Kind::Integer { min: 1, max: 64 };
        /// Width of the filter on each map in texels per side, for filter=pcf and for comparisons; 1 is a single lookup.
        pcf: u32 = 2, Kind::Integer { min: 1, max: 33 };
        /// Compared values: visibility where it differs most (local), or depth over the image (absolute, relative).
        criterion: Criterion = Criterion::Local, Kind::Choice { options: Criterion::OPTIONS };
        /// Change of the visibility of a tile of the screen that is worth a split, for criterion=local; 0 splits all.
        tolerance: f32 = 0.07, Kind::Number { min: 0.0, max: 1.0 };
        /// Share of differing pixels, in units of a map's texels, that is worth a split (eq. 4); 0 splits all.
        epsilon: f32 = 0.01, Kind::Number { min: 0.0, max: 1000.0 };
        /// Difference of depths that makes a pixel differ: metres (absolute) or a part of the depth (relative).
        gamma: f32 = 0.02, Kind::Number { min: 0.0, max: 1.0e6 };
        /// Finest subdivision; rectangles stop at 5, which are 33 x 33 maps.
        depth: u32 = 4, Kind::Integer { min: 0, max: 7 };
        /// Most maps per frame; the most urgent splits come first.
        maps: u32 = 128, Kind::Integer { min: 4, max: 1089 };
        /// Where depths are compared: at the camera's pixels, or at the surfaces nearest to the light's centre.
        space: Space = Space::Camera, Kind::Choice { options: Space::OPTIONS };
        /// Weights of samples: the area around them, or less the finer they were refined (eq. 5 and 6).
        weights: Weights = Weights::Area, Kind::Choice { options: Weights::OPTIONS };
        /// All maps in one array, or few at a time: drawn twice, or once with equal weights (weights=paper, section 4.1).
        evaluation: Evaluate = Evaluate::Array, Kind::Choice { options: Evaluate::OPTIONS };
        /// For animation: the tree is carried over from frame to frame and changes little by little.
        steady: bool = false, Kind::Toggle;
    }
}

impl AdaptiveSamplingSettings {
    /// True if the weights are known when maps are added up one by one: those of a steady tree are, and those of a tree
    /// whose maps are drawn once to build it and once more to add them up. The paper draws once and weights all samples
    /// equally.
    pub(super) fn knows_weights(&self) -> bool {
        self.steady || self.weights == Weights::Area
    }

    /// Refuses contradictory settings.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        if self.space == Space::Light && self.criterion == Criterion::Local {
            return Err(SpecError::Value {
                technique: "adaptive-sampling".to_owned(),
                key: "space".to_owned(),
                value: "light".to_owned(),
                expected: "the local criterion compares what pixels see; set criterion=relative or criterion=absolute"
                    .to_owned(),
            });
        }
        if self.evaluation == Evaluate::Accumulate && self.filter == Filter::Cell && !self.knows_weights() {
            return Err(SpecError::Value {
                technique: "adaptive-sampling".to_owned(),
                key: "weights".to_owned(),
                value: "paper".to_owned(),
                expected:
                    "cells of the light are not known while the tree still grows; set filter=pcf, or weights=area"
                        .to_owned(),
            });
        }
        Ok(())
    }
}
