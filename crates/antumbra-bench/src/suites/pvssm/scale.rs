//! Sizes of scenes and maps for an image that is smaller than the paper's.

use crate::Error;
use crate::kit::Runner;
use antumbra_scene::{Scene, builtin};

/// Images that a software adapter draws in reasonable time; the paper's are 1024 a side.
const SIZE: [u32; 2] = [384, 384];
const PAPER_SIDE: f64 = 1024.0;

/// The paper's numbers of triangles and texels per pixel, for an image of this size. Sides of maps are powers of two.
#[derive(Clone, Copy)]
pub struct Scale {
    pub size: [u32; 2],
    /// Pixels over the paper's; at most 1.
    pub pixels: f64,
}

impl Scale {
    /// For the runner's image size.
    pub fn of(runner: &Runner) -> Scale {
        let size = runner.size(SIZE);
        let pixels = f64::from(size[0]) * f64::from(size[1]) / (PAPER_SIDE * PAPER_SIDE);
        Scale { size, pixels: pixels.min(1.0) }
    }

    /// Side of a map, from the paper's.
    pub fn map(&self, paper: u32) -> u32 {
        ((f64::from(paper) * self.pixels.sqrt()).round() as u32).next_power_of_two()
    }

    /// A forest with about the paper's number of triangles per pixel.
    pub fn forest(&self, triangles: f64) -> Result<Scene, Error> {
        let trees = (triangles * self.pixels / 9194.0).round().clamp(1.0, 540.0);
        Ok(builtin::build(&format!("forest:trees={trees}"))?)
    }

    /// The same of pipes, at least 300 000 triangles.
    pub fn pipes(&self, triangles: f64) -> Result<Scene, Error> {
        let count = (triangles * self.pixels).round().clamp(300_000.0, 10_000_000.0);
        Ok(builtin::build(&format!("pipes:triangles={count}"))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smaller_pictures_see_smaller_scenes_and_maps() {
        let paper = Scale { size: [1024; 2], pixels: 1.0 };
        let small = Scale { size: [256; 2], pixels: 1.0 / 16.0 };
        assert_eq!([paper.map(4096), small.map(4096)], [4096, 1024]);
        let trees = |scale: Scale| scale.forest(782_000.0).unwrap().name;
        assert_eq!([trees(paper), trees(small)].map(|n| n.contains("trees=85")), [true, false]);
    }
}
