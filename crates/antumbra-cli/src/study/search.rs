//! The search for the coarsest map that nobody can tell from a fine one, with FLIP in place of the people.

use super::disk::Disk;
use crate::error::CliError;
use crate::{measure, progress, setup};
use antumbra::scene::SceneRenderer;
use antumbra::{Error, Gpu, Spec};
use antumbra_metrics::{Image, figures};
use glam::Vec2;

/// Whether casters rest or move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// One picture: what differs from the fine map's.
    Still,
    /// A film: also what changes from frame to frame otherwise than in the fine map's.
    Moving,
}

/// Directions in which the disk is moved from the map's grid, in its filter's width: texels lie differently in each.
const PLACES: [Vec2; 3] = [Vec2::new(0.11, 0.05), Vec2::new(-0.17, 0.09), Vec2::new(0.04, -0.13)];
/// Frames of the film.
const FRAMES: usize = 4;
/// How far the shadow moves in a frame of the film: pixels, and the filter's width.
const STEP: (f32, f32) = (0.3, 0.03);
/// The finest map that the others are held against: texels a pixel of the picture's side, and texels a side at most.
const FINE: (u32, u32) = (8, 8192);
/// Maps smaller than this are not made.
const SMALLEST: u32 = 16;

/// A disk in several places: how the shadow looks by a fine map, and where.
pub struct Screening<'a> {
    gpu: &'a Gpu,
    disk: Disk,
    motion: Motion,
    shots: Vec<Shot>,
}

struct Shot {
    renderer: SceneRenderer,
    around_edge: Vec<bool>,
    fine: Vec<f32>,
}

/// What was found for one width of the penumbra.
#[derive(Clone, Copy, Debug)]
pub struct Needed {
    /// Texels in the filter's width.
    pub texels: f64,
    /// FLIP's mean over the penumbra with that many.
    pub flip: f64,
    /// True if even the finest map of the search was told from the fine one, or the coarsest was not.
    pub at_the_end: bool,
}

impl Screening<'_> {
    /// Draws the fine pictures.
    pub fn new(gpu: &Gpu, disk: Disk, motion: Motion) -> Result<Screening<'_>, CliError> {
        let places = match motion {
            Motion::Still => PLACES.map(|p| p * disk.penumbra).to_vec(),
            Motion::Moving => (0..FRAMES)
                .map(|i| {
                    PLACES[0] * disk.penumbra + i as f32 * (STEP.0 + STEP.1 * disk.penumbra) * Vec2::new(0.87, 0.5)
                })
                .collect(),
        };
        let shot = |moved: Vec2| {
            let renderer = setup::renderer(gpu, &disk.scene(moved), [disk.side; 2])?;
            let fine = drawn(gpu, &renderer, (FINE.0 * disk.side).min(FINE.1))?;
            Ok(Shot { renderer, around_edge: disk.around_edge(moved), fine })
        };
        let shots = places.into_iter().map(shot).collect::<Result<_, CliError>>()?;
        Ok(Screening { gpu, disk, motion, shots })
    }

    /// What a viewer notices of a map: FLIP, the mean over the penumbra. Of single pictures their mean; of a film the
    /// most that a frame shows or that changes from one frame to the next.
    fn noticed(&self, map: u32) -> Result<f64, CliError> {
        progress::check_cancelled()?;
        let coarse: Vec<_> = self.shots.iter().map(|s| drawn(self.gpu, &s.renderer, map)).collect::<Result<_, _>>()?;
        let differs: Vec<f64> =
            self.shots.iter().zip(&coarse).map(|(shot, seen)| self.flip(seen, &shot.fine, &shot.around_edge)).collect();
        if self.motion == Motion::Still {
            return Ok(differs.iter().sum::<f64>() / differs.len() as f64);
        }
        // The next frame as it would be if the error stayed what it was: what differs from that flickers.
        let flickers = self.shots.windows(2).zip(coarse.windows(2)).map(|(shots, seen)| {
            let steady = |i: usize| (shots[1].fine[i] + seen[0][i] - shots[0].fine[i]).clamp(0.0, 1.0);
            let steady: Vec<f32> = (0..seen[0].len()).map(steady).collect();
            self.flip(&seen[1], &steady, &shots[1].around_edge)
        });
        Ok(flickers.chain(differs).fold(0.0, f64::max))
    }

    fn flip(&self, seen: &[f32], fine: &[f32], valid: &[bool]) -> f64 {
        let image = |data| Image::new(self.disk.side, self.disk.side, data).expect("of the picture's size");
        figures(image(seen), image(fine), valid).expect("the penumbra is in the picture").flip
    }

    /// The paper's search: halves the range of 1 to twice as many texels as pixels until it is a hundredth wide.
    pub fn search(&self, threshold: f64) -> Result<Needed, CliError> {
        let map_of = |texels: f64| self.disk.map(texels).max(SMALLEST);
        let (mut low, mut high) = (1.0, 2.0 * f64::from(self.disk.penumbra));
        let mut flip = self.noticed(map_of(high))?;
        if flip > threshold {
            return Ok(Needed { texels: high, flip, at_the_end: true });
        }
        while map_of(high) > map_of(low) + 1 && high - low > 0.01 * high {
            let middle = 0.5 * (low + high);
            let seen = self.noticed(map_of(middle))?;
            if seen > threshold {
                low = middle;
            } else {
                (high, flip) = (middle, seen);
            }
        }
        let map = map_of(high);
        Ok(Needed { texels: self.disk.texels(map), flip, at_the_end: map == SMALLEST })
    }
}

/// The picture by a map of so many texels a side, every one of which is read.
fn drawn(gpu: &Gpu, renderer: &SceneRenderer, map: u32) -> Result<Vec<f32>, CliError> {
    let spec: Spec = format!("smooth-pcss:map={map},filter=64").parse().map_err(Error::from)?;
    Ok(measure::draw(gpu, renderer, &spec, 0, |_| ())?.visibility)
}
