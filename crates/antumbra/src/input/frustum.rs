//! The frustum of a shadow map from the light's centre, fitted to the casters of visible shadows.
//!
//! All is measured in the map's own coordinates, tangents xy / z and inverse distance 1 / z, in which planes are
//! affine.

use super::light_grid::{LightGrid, Stages, clipped, plane_of};
use crate::input::frame::View;
use crate::input::map_view::MapView;
use antumbra_scene::{Aabb, RectLight, Scene};
use glam::{Vec2, Vec3, Vec4};

/// A symmetric frustum from the light's centre along its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowFrustum {
    /// Half the opening along the light's edges, as tangents.
    pub tan_half: Vec2,
    /// Casters nearer to the light's plane than this are not seen, metres.
    pub near: f32,
    /// Distance from the light's plane of the nearest and of the farthest surface that takes shadows, metres. Maps from
    /// other points of the light are made as much wider as these are apart; a receiver outside of its map counts as
    /// lit.
    pub receivers: [f32; 2],
    /// Distance from the light's plane of the nearest surface that casts, metres; surfaces that are nearer count as
    /// there for techniques that store depth as a part of a range.
    pub nearest_caster: f32,
}

/// Half the widest frustum that is fitted, as a tangent: 160 degrees.
const MAX_TAN: f32 = 5.67;

/// How much longer than wide a texel may be: techniques read square windows of texels, so resolution lost on the longer
/// side is lost on both.
const MAX_ELONGATION: f32 = 4.0;

/// Casters and receivers nearer to the light than this part of the farthest distance do not widen a frustum.
const NEAREST: f32 = 0.02;

/// A caster must be nearer to the light than the deepest surface behind it by this part of its distance.
const SEPARATION: f32 = 2e-3;

impl ShadowFrustum {
    /// A square frustum of an opening in degrees.
    pub fn of_degrees(fov_deg: f32, near: f32, receivers: [f32; 2]) -> ShadowFrustum {
        let tan_half = Vec2::splat((0.5 * fov_deg).to_radians().tan());
        ShadowFrustum { tan_half, near, receivers, nearest_caster: receivers[0] }
    }

    /// The smallest frustum around a box, for hosts that know nothing closer. The light's own setting counts if it has
    /// one.
    pub fn around(light: &RectLight, bounds: &Aabb) -> ShadowFrustum {
        let corners = bounds.corners().map(|c| light.light_from_world(c));
        let far = corners.iter().fold(0.0f32, |m, c| m.max(c.z));
        let nearest = far * NEAREST;
        let low = corners.iter().fold(far, |m, c| m.min(c.z)).max(nearest);
        let receivers = [low.max(1e-6), far.max(1e-6)];
        if let Some(degrees) = light.shadow_fov_deg {
            return ShadowFrustum::of_degrees(degrees, near_of(far), receivers);
        }
        let tan = corners.iter().fold(Vec2::splat(1e-3), |m, c| m.max(c.truncate().abs() / c.z.max(nearest)));
        ShadowFrustum {
            tan_half: tan.min(Vec2::splat(MAX_TAN)) * 1.01,
            near: near_of(far),
            receivers,
            nearest_caster: receivers[0],
        }
    }

    /// The frustum that holds all casters of shadows on surfaces that a view sees, and these shadows. Surfaces with
    /// nothing behind them (the ground, as a rule) cast on nothing, so they do not widen it. Reads every triangle: a
    /// few hundred milliseconds for millions of them, once for a scene whose light and view do not change.
    pub fn fit(scene: &Scene, view: &View) -> ShadowFrustum {
        let mut fit = FrustumFit::new(scene, view);
        fit.by_ref().for_each(drop);
        fit.finish()
    }
}

/// [`ShadowFrustum::fit`] piece by piece, for programs with one thread: an iterator whose every step takes some
/// milliseconds.
pub struct FrustumFit<'a> {
    scene: &'a Scene,
    view_planes: [Vec4; 6],
    stages: Stages<'a>,
    seen: Seen,
    deepest: Option<DeepestSurface>,
    /// Half the frustum that holds the casters so far.
    casting: Vec2,
}

impl<'a> FrustumFit<'a> {
    /// Begins to fit.
    pub fn new(scene: &'a Scene, view: &View) -> FrustumFit<'a> {
        // The light's own setting leaves nothing to fit.
        let count = if scene.light.shadow_fov_deg.is_some() { 0 } else { 3 };
        FrustumFit {
            scene,
            view_planes: MapView::new(view.clip_from_world()).planes_ws,
            stages: Stages::new(scene, count),
            seen: Seen::EMPTY,
            deepest: None,
            casting: Vec2::ZERO,
        }
    }

    /// The frustum, once the iterator has ended.
    pub fn finish(self) -> ShadowFrustum {
        let around = ShadowFrustum::around(&self.scene.light, &self.scene.bounds());
        let Some(deepest) = self.deepest else { return around };
        let (seen, half_light) = (self.seen, self.scene.light.size * 0.5);
        // Receivers beyond the reach of casters are lit, casters beyond that of receivers are of no use.
        let tan = self.casting.min(seen.reach(half_light, deepest.nearest_q));
        if tan.max_element() <= 0.0 {
            return around;
        }
        let tan = tan.max(Vec2::splat(tan.max_element() / MAX_ELONGATION));
        // Surfaces nearer to the light than every caster take no shadow.
        let near_q = seen.near_q.min(deepest.nearest_q).max(seen.far_q);
        let [low, high] = around.receivers;
        ShadowFrustum {
            tan_half: (tan * 1.01).clamp(Vec2::splat(1e-3), Vec2::splat(MAX_TAN)),
            near: around.near,
            receivers: [(1.0 / near_q).clamp(low, high), (1.0 / seen.far_q).clamp(low, high)],
            nearest_caster: (1.0 / deepest.nearest_q).clamp(low, high),
        }
    }
}

impl Iterator for FrustumFit<'_> {
    type Item = ();

    fn next(&mut self) -> Option<()> {
        let (stage, run) = self.stages.next()?;
        if stage > 0 && self.seen.is_empty() {
            return None;
        }
        let receiver_only = self.scene.instances[run.instance].receiver_only;
        let half_light = self.scene.light.size * 0.5;
        match stage {
            0 => run.in_world().for_each(|corners| self.seen.add(corners, &self.view_planes, &self.scene.light)),
            1 => {
                let deepest = self.deepest.get_or_insert_with(|| DeepestSurface::over(&self.seen));
                run.in_light_space().for_each(|corners| deepest.add(corners, receiver_only));
            }
            _ if receiver_only => {}
            _ => {
                let Some(deepest) = &self.deepest else { return None };
                let reach = run.in_light_space().map(|corners| deepest.reach_of_caster(corners, half_light));
                self.casting = reach.fold(self.casting, Vec2::max);
            }
        }
        Some(())
    }
}

/// A near plane that cuts nothing off: inverse distances are stored as floating-point numbers, so it may be close.
fn near_of(far: f32) -> f32 {
    (far * 1e-4).max(1e-6)
}

/// The part of the map that visible surfaces take.
#[derive(Clone, Copy, Debug)]
struct Seen {
    low: Vec2,
    high: Vec2,
    /// Inverse distance of the farthest, and of the nearest.
    far_q: f32,
    near_q: f32,
}

impl Seen {
    const EMPTY: Seen = Seen { low: Vec2::INFINITY, high: Vec2::NEG_INFINITY, far_q: f32::INFINITY, near_q: 0.0 };

    /// Adds the part of a triangle that lies within the view's frustum.
    fn add(&mut self, corners: [Vec3; 3], view_planes: &[Vec4], light: &RectLight) {
        for p in clipped(&corners, view_planes) {
            let l = light.light_from_world(p);
            if l.z > 0.0 {
                let t = (l.truncate() / l.z).clamp(Vec2::splat(-MAX_TAN), Vec2::splat(MAX_TAN));
                self.low = self.low.min(t);
                self.high = self.high.max(t);
                self.far_q = self.far_q.min(1.0 / l.z);
                self.near_q = self.near_q.max(1.0 / l.z);
            }
        }
    }

    fn is_empty(&self) -> bool {
        self.low.x > self.high.x
    }

    /// Half the frustum that holds all that can hide any of the light from them, casters being as near as `nearest_q`.
    fn reach(&self, half_light: Vec2, nearest_q: f32) -> Vec2 {
        self.low.abs().max(self.high.abs()) + half_light * (nearest_q - self.far_q).max(0.0)
    }
}

/// The surface that is farthest from the light, for each cell of the map: nearer surfaces cast on it.
struct DeepestSurface {
    cells: LightGrid,
    /// Inverse distance as an affine function of the tangent: (x, y, constant); infinite where there is nothing.
    planes: Vec<Vec3>,
    /// Of the nearest surface of all.
    nearest_q: f32,
}

impl DeepestSurface {
    fn over(seen: &Seen) -> DeepestSurface {
        let nothing = Vec3::new(0.0, 0.0, f32::INFINITY);
        // Shadows reach visible surfaces from casters that project a little beside them.
        let cells = LightGrid::over(seen.low, seen.high);
        DeepestSurface { cells, planes: vec![nothing; LightGrid::COUNT], nearest_q: 0.0 }
    }

    fn add(&mut self, corners: [Vec3; 3], receiver_only: bool) {
        let Some(plane) = plane_of(&corners) else { return };
        let polygon = clipped(&corners, &self.cells.border());
        if !receiver_only {
            self.nearest_q = polygon.iter().fold(self.nearest_q, |q, c| q.max(1.0 / c.z));
        }
        let mut planes = std::mem::take(&mut self.planes);
        self.cells.for_each(&polygon, |cell, t| {
            if plane.dot(t.extend(1.0)) < planes[cell].dot(t.extend(1.0)) {
                planes[cell] = plane;
            }
        });
        self.planes = planes;
    }

    /// Half the frustum that holds a caster and the shadow that it casts on the deepest surface; 0 if it casts on
    /// nothing that the grid covers.
    fn reach_of_caster(&self, corners: [Vec3; 3], half_light: Vec2) -> Vec2 {
        let mut reach = Vec2::ZERO;
        let mut cast = |t: Vec2, q: f32, behind: f32| {
            if behind.is_finite() && q > behind * (1.0 + SEPARATION) {
                reach = reach.max(t.abs() + half_light * (q - behind));
            }
        };
        let polygon = clipped(&corners, &self.cells.border());
        for c in &polygon {
            let t = c.truncate() / c.z;
            cast(t, 1.0 / c.z, self.deepest_q(t));
        }
        // A large triangle may cast with its middle where its corners hang over nothing.
        if let Some(plane) = plane_of(&corners) {
            self.cells
                .for_each(&polygon, |cell, t| cast(t, plane.dot(t.extend(1.0)), self.planes[cell].dot(t.extend(1.0))));
        }
        reach
    }

    /// Inverse distance of the deepest surface at a tangent, the smallest of the cells around it: a surface beyond the
    /// edge of a cell casts on its neighbours.
    fn deepest_q(&self, t: Vec2) -> f32 {
        let of_cell = |cell: usize| self.planes[cell].dot(t.extend(1.0));
        self.cells.around(t, 1).map(of_cell).filter(|q| *q > 0.0).fold(f32::INFINITY, f32::min)
    }
}
