//! Settings of `subpixel`.

use super::pattern::{Arrangement, MOST_SAMPLES, Pattern};
use crate::error::Error;
use crate::technique::settings::Kind;

crate::choices! {
    /// Weights of the samples of a pixel.
    pub enum Filter {
        /// Equal.
        Box = "box",
        /// A Gaussian around the pixel's middle, over the neighbours too.
        Gaussian = "gaussian",
    }
}

crate::settings! {
    /// Settings of [`Subpixel`](super::Subpixel).
    pub struct SubpixelSettings {
        /// Shadow map and silhouette mask map, texels per side; they group the work and decide pixels that no silhouette crosses.
        map: u32 = 512, Kind::Integer { min: 16, max: 4096 };
        /// Samples per pixel; 8, 16, 32, 64 and 128 use all bits of their masks.
        samples: u32 = 32, Kind::Integer { min: 1, max: MOST_SAMPLES as u32 };
        /// Positions of the samples; one is always in the pixel's middle.
        pattern: Arrangement = Arrangement::Rotated, Kind::Choice { options: Arrangement::OPTIONS };
        /// A custom pattern in place of `samples` and `pattern`: fractions of a pixel, one of them 0.5 0.5.
        points: Vec<[f32; 2]> = Vec::new(), Kind::Points { max: MOST_SAMPLES as u32 };
        /// Weights of the samples.
        filter: Filter = Filter::Box, Kind::Choice { options: Filter::OPTIONS };
        /// Leaves out samples where another triangle lies in front of the pixel's facet.
        validity: bool = true, Kind::Toggle;
        /// Leaves out silhouettes that lie behind the shadow map all around.
        hide: bool = true, Kind::Toggle;
        /// Memory for lists, MiB; an image that needs more is processed in strips.
        budget: u32 = 256, Kind::Integer { min: 1, max: 4096 };
        /// Counts silhouettes, pixels and tests for reports; takes time.
        statistics: bool = false, Kind::Toggle;
    }
}

impl SubpixelSettings {
    /// The samples of a pixel.
    pub fn pattern(&self) -> Result<Pattern, Error> {
        match &self.points[..] {
            [] => Ok(Pattern::arranged(self.pattern, self.samples)),
            points => Pattern::of_points(points),
        }
    }
}
