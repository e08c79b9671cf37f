//! Who casts on whom, for techniques that part a scene into occluders and receivers.

use crate::input::casters::Role;
use crate::input::light_grid::{Cells, clipped, each_triangle, plane_of};
use antumbra_scene::{Scene, slices::at_once};
use glam::{Vec2, Vec3};

/// An occluder must be nearer to the light than what it is above by this part of its distance.
const SEPARATION: f32 = 1e-4;

/// Tangents beyond this are not looked at: 160 degrees.
const MAX_TAN: f32 = 5.67;

/// The role of each instance: what says that it only receives does; the ground and all else that is above no surface of
/// another instance, seen from the light's centre, is [`Role::Ground`]; the rest casts.
pub fn roles(scene: &Scene) -> Vec<Role> {
    at_once(roles_with_pauses(scene, &mut async || ()))
}

/// The same with a pause after every few thousand triangles.
pub(crate) async fn roles_with_pauses(scene: &Scene, pause: &mut impl AsyncFnMut()) -> Vec<Role> {
    let deepest = TwoDeepest::of(scene, pause).await;
    let mut casts = vec![false; scene.instances.len()];
    let look = |corners: [Vec3; 3], instance: usize| {
        casts[instance] = casts[instance] || deepest.is_above_another(corners, instance);
    };
    each_triangle(scene, look, pause).await;
    let role = |(instance, casts): (&antumbra_scene::Instance, bool)| match (instance.receiver_only, casts) {
        (true, _) => Role::Receiver,
        (false, false) => Role::Ground,
        (false, true) => Role::Caster,
    };
    scene.instances.iter().zip(casts).map(role).collect()
}

/// A surface in a cell: its plane, and whose it is.
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
    cells: Cells,
    surfaces: Vec<[Surface; 2]>,
}

impl TwoDeepest {
    async fn of(scene: &Scene, pause: &mut impl AsyncFnMut()) -> TwoDeepest {
        let (mut low, mut high) = (Vec2::splat(MAX_TAN), Vec2::splat(-MAX_TAN));
        let widen = |corners: [Vec3; 3], _| {
            for c in corners.iter().filter(|c| c.z > 0.0) {
                let t = (c.truncate() / c.z).clamp(Vec2::splat(-MAX_TAN), Vec2::splat(MAX_TAN));
                (low, high) = (low.min(t), high.max(t));
            }
        };
        each_triangle(scene, widen, pause).await;
        let nothing = Surface { plane: Vec3::new(0.0, 0.0, f32::INFINITY), instance: usize::MAX };
        let mut two = TwoDeepest { cells: Cells::over(low, high.max(low)), surfaces: vec![[nothing; 2]; Cells::COUNT] };
        each_triangle(scene, |corners, instance| two.add(corners, instance), pause).await;
        two
    }

    fn add(&mut self, corners: [Vec3; 3], instance: usize) {
        let Some(plane) = plane_of(&corners) else { return };
        let (cells, new) = (self.cells, Surface { plane, instance });
        cells.for_each(&clipped(&corners, &cells.rim()), |cell, t| {
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
        let polygon = clipped(&corners, &self.cells.rim());
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
