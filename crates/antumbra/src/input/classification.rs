//! Classification of instances into occluders and receivers, for techniques that need it.

use super::casters::Role;
use super::light_grid::{LightGrid, Stages, clipped, plane_of};
use antumbra_scene::Scene;
use glam::{Vec2, Vec3};

/// An occluder is nearer to the light than the surface below it by at least this fraction of its distance.
const SEPARATION: f32 = 1e-4;

/// Largest tangent that is considered: 160 degrees.
const MAX_TAN: f32 = 5.67;

/// The role of each instance: receivers that the scene names; [`Role::Ground`] for the ground and other instances that
/// are above no surface of another instance, seen from the light's centre; casters.
pub fn roles(scene: &Scene) -> Vec<Role> {
    let mut classification = Classification::new(scene);
    classification.by_ref().for_each(drop);
    classification.finish()
}

/// [`roles`] piece by piece, for programs with one thread: an iterator whose every step takes some milliseconds.
pub struct Classification<'a> {
    scene: &'a Scene,
    stages: Stages<'a>,
    /// Range of the tangents of all surfaces.
    range: [Vec2; 2],
    deepest: Option<TwoDeepest>,
    casts: Vec<bool>,
}

impl<'a> Classification<'a> {
    /// Begins to classify.
    pub fn new(scene: &'a Scene) -> Classification<'a> {
        let range = [Vec2::splat(MAX_TAN), Vec2::splat(-MAX_TAN)];
        let casts = vec![false; scene.instances.len()];
        Classification { scene, stages: Stages::new(scene, 3), range, deepest: None, casts }
    }

    /// The roles, once the iterator has ended.
    pub fn finish(self) -> Vec<Role> {
        let role = |(instance, casts): (&antumbra_scene::Instance, bool)| match (instance.receiver_only, casts) {
            (true, _) => Role::Receiver,
            (false, false) => Role::Ground,
            (false, true) => Role::Caster,
        };
        self.scene.instances.iter().zip(self.casts).map(role).collect()
    }
}

impl Iterator for Classification<'_> {
    type Item = ();

    fn next(&mut self) -> Option<()> {
        let (stage, run) = self.stages.next()?;
        let mut triangles = run.in_light_space();
        match stage {
            0 => {
                let [low, high] = &mut self.range;
                for c in triangles.flatten().filter(|c| c.z > 0.0) {
                    let t = (c.truncate() / c.z).clamp(Vec2::splat(-MAX_TAN), Vec2::splat(MAX_TAN));
                    (*low, *high) = (low.min(t), high.max(t));
                }
            }
            1 => {
                let [low, high] = self.range;
                let deepest = self.deepest.get_or_insert_with(|| TwoDeepest::over(low, high.max(low)));
                triangles.for_each(|corners| deepest.add(corners, run.instance));
            }
            _ => {
                let casts = &mut self.casts[run.instance];
                let deepest = self.deepest.as_ref()?;
                *casts = *casts || triangles.any(|corners| deepest.is_above_another(corners, run.instance));
            }
        }
        Some(())
    }
}

/// A surface in a cell: its plane and its instance.
#[derive(Clone, Copy)]
struct Surface {
    plane: Vec3,
    instance: usize,
}

impl Surface {
    /// Inverse distance at a tangent.
    fn q(&self, t: Vec2) -> f32 {
        self.plane.dot(t.extend(1.0))
    }
}

/// For each cell of the map the surface that is farthest from the light, and the farthest of any other instance.
struct TwoDeepest {
    cells: LightGrid,
    surfaces: Vec<[Surface; 2]>,
}

impl TwoDeepest {
    fn over(low: Vec2, high: Vec2) -> TwoDeepest {
        let nothing = Surface { plane: Vec3::new(0.0, 0.0, f32::INFINITY), instance: usize::MAX };
        TwoDeepest { cells: LightGrid::over(low, high), surfaces: vec![[nothing; 2]; LightGrid::COUNT] }
    }

    fn add(&mut self, corners: [Vec3; 3], instance: usize) {
        let Some(plane) = plane_of(&corners) else { return };
        let (cells, new) = (self.cells, Surface { plane, instance });
        cells.for_each(&clipped(&corners, &cells.border()), |cell, t| {
            let [first, second] = &mut self.surfaces[cell];
            if first.instance == instance {
                *first = if new.q(t) < first.q(t) { new } else { *first };
            } else if new.q(t) < first.q(t) {
                (*first, *second) = (new, *first);
            } else if new.q(t) < second.q(t) {
                *second = new;
            }
        });
    }

    /// True if a corner, or the middle of a cell that it covers, has a surface of another instance behind it.
    fn is_above_another(&self, corners: [Vec3; 3], instance: usize) -> bool {
        let is_above = |cell: usize, t: Vec2, q: f32| {
            let [first, second] = &self.surfaces[cell];
            let other = if first.instance == instance { second } else { first }.q(t);
            other.is_finite() && q > other.max(0.0) * (1.0 + SEPARATION)
        };
        let polygon = clipped(&corners, &self.cells.border());
        let mut above = polygon.iter().any(|c| {
            let t = c.truncate() / c.z;
            self.cells.around(t, 0).any(|cell| is_above(cell, t, 1.0 / c.z))
        });
        if let Some(plane) = plane_of(&corners).filter(|_| !above) {
            self.cells.for_each(&polygon, |cell, t| above = above || is_above(cell, t, plane.dot(t.extend(1.0))));
        }
        above
    }
}
