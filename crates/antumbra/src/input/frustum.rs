//! The frustum of a shadow map from the light's centre, fitted to the casters of visible shadows.
//!
//! All is measured in the map's own coordinates, tangents xy / z and inverse distance 1 / z, in which planes are
//! affine.

use super::light_grid::{LightGrid, Stages, clipped, plane_of, window};
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

/// Distance of the nearest surface that counts, as a part of the farthest, where nothing nearer is known.
const NEAREST: f32 = 1e-3;
/// The same of receivers around the light.
const NEAREST_RECEIVER: f32 = 0.02;

/// A caster must be nearer to the light than the deepest surface behind it by this part of its distance.
const SEPARATION: f32 = 2e-3;

impl ShadowFrustum {
    /// A square frustum of an opening in degrees.
    pub fn of_degrees(fov_deg: f32, near: f32, receivers: [f32; 2]) -> ShadowFrustum {
        ShadowFrustum { tan_half: tan_half_of(fov_deg), near, receivers, nearest_caster: receivers[0] }
    }

    /// The smallest frustum around a box, for hosts that know nothing closer. The light's own setting counts if it has
    /// one.
    pub fn around(light: &RectLight, bounds: &Aabb) -> ShadowFrustum {
        let nothing = Aabb::of_points([light.center, light.target]);
        let bounds = if bounds.is_empty() { &nothing } else { bounds };
        let extent = Extent::of_box(light, bounds);
        let far = if extent.far > 0.0 { extent.far } else { 1.0 };
        // A light inside of the box may have casters anywhere around it. Receivers are rarely as near, and maps from
        // other points of the light are wider for them.
        let inside = bounds.contains(light.center);
        let [nearest, receiver] = [NEAREST, NEAREST_RECEIVER].map(|part| match inside {
            true => part * far,
            false => extent.near.clamp(NEAREST * far, far),
        });
        ShadowFrustum {
            tan_half: match light.shadow_fov_deg {
                Some(degrees) => tan_half_of(degrees),
                None => (extent.tan * 1.01).clamp(Vec2::splat(1e-3), Vec2::splat(MAX_TAN)),
            },
            near: near_of(nearest, far),
            receivers: [receiver, far],
            nearest_caster: nearest,
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
    casting: Casting,
    /// Surfaces that are seen within the frustum.
    within: Seen,
}

/// The casters of shadows on what is seen.
#[derive(Clone, Copy, Default)]
struct Casting {
    /// Half the frustum that holds them and their shadows.
    reach: Vec2,
    /// Inverse distance of the nearest.
    nearest_q: f32,
}

impl<'a> FrustumFit<'a> {
    /// Begins to fit.
    pub fn new(scene: &'a Scene, view: &View) -> FrustumFit<'a> {
        FrustumFit {
            scene,
            view_planes: MapView::new(view.clip_from_world()).planes_ws,
            stages: Stages::new(scene, 4),
            seen: Seen::EMPTY,
            deepest: None,
            casting: Casting::default(),
            within: Seen::EMPTY,
        }
    }

    /// Half the frustum, once all casters are known: the light's own, or the fitted one; none if nothing casts on what
    /// is seen.
    fn tan_half(&self) -> Option<Vec2> {
        if let Some(degrees) = self.scene.light.shadow_fov_deg {
            return Some(tan_half_of(degrees));
        }
        let half_light = self.scene.light.size * 0.5;
        // Receivers beyond the reach of casters are lit, casters beyond that of receivers are of no use.
        let nearest_q = self.deepest.as_ref()?.nearest_q;
        let tan = self.casting.reach.min(self.seen.reach(half_light, nearest_q));
        let widest = tan.max_element();
        (widest > 0.0).then(|| {
            (tan.max(Vec2::splat(widest / MAX_ELONGATION)) * 1.01).clamp(Vec2::splat(1e-3), Vec2::splat(MAX_TAN))
        })
    }

    /// The frustum, once the iterator has ended.
    pub fn finish(self) -> ShadowFrustum {
        let around = ShadowFrustum::around(&self.scene.light, &self.scene.bounds());
        let Some(tan_half) = self.tan_half().filter(|_| !self.seen.is_empty()) else { return around };
        let (within, nearest_q) = (self.within, self.casting.nearest_q);
        let far = 1.0 / if within.is_empty() { self.seen.far_q } else { within.far_q };
        // Surfaces nearer to the light than every caster take no shadow.
        let near = 1.0 / within.near_q.min(nearest_q).max(1.0 / far);
        let (near, nearest_caster) = (near.max(NEAREST * far), (1.0 / nearest_q).min(far));
        let depth_near = near_of(nearest_caster, around.receivers[1]);
        ShadowFrustum { tan_half, near: depth_near, receivers: [near, far], nearest_caster }
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
        let light = &self.scene.light;
        match stage {
            0 => run.in_world().for_each(|corners| self.seen.add(&clipped(&corners, &self.view_planes), light, None)),
            1 => {
                let deepest = self.deepest.get_or_insert_with(|| DeepestSurface::over(&self.seen));
                run.in_light_space().for_each(|corners| deepest.add(corners, receiver_only));
            }
            2 if receiver_only => {}
            2 => {
                let Some(deepest) = &self.deepest else { return None };
                run.in_light_space().for_each(|corners| deepest.cast(corners, light.size * 0.5, &mut self.casting));
            }
            _ => {
                let tan = self.tan_half()?;
                for corners in run.in_world() {
                    self.within.add(&clipped(&corners, &self.view_planes), light, Some(tan));
                }
            }
        }
        Some(())
    }
}

fn tan_half_of(fov_deg: f32) -> Vec2 {
    Vec2::splat((0.5 * fov_deg).to_radians().tan())
}

/// A near plane before the nearest caster: inverse distances are stored as floating-point numbers, so it may be close.
fn near_of(nearest_caster: f32, far: f32) -> f32 {
    (0.5 * nearest_caster).min(1e-4 * far).max(1e-9 * far)
}

/// What a box takes of the widest frustum.
struct Extent {
    /// Largest |tangent|.
    tan: Vec2,
    near: f32,
    far: f32,
}

impl Extent {
    fn of_box(light: &RectLight, bounds: &Aabb) -> Extent {
        let corners = bounds.corners().map(|c| light.light_from_world(c));
        let far = corners.iter().fold(0.0f32, |m, c| m.max(c.z));
        let frustum = window(Vec2::splat(-MAX_TAN), Vec2::splat(MAX_TAN), NEAREST * far);
        let mut extent = Extent { tan: Vec2::ZERO, near: f32::INFINITY, far };
        // Corner i has bit 0 for x, 1 for y, 2 for z.
        for [a, b, c, d] in [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]] {
            for triangle in [[a, b, c], [a, c, d]] {
                for p in clipped(&triangle.map(|i: usize| corners[i]), &frustum) {
                    extent.tan = extent.tan.max((p.truncate() / p.z).abs());
                    extent.near = extent.near.min(p.z);
                }
            }
        }
        extent
    }
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

    /// Adds a polygon in world space, or the part of it that lies within a frustum from the light.
    fn add(&mut self, polygon: &[Vec3], light: &RectLight, tan_half: Option<Vec2>) {
        let mut in_light: Vec<Vec3> = polygon.iter().map(|p| light.light_from_world(*p)).collect();
        if let Some(tan) = tan_half {
            in_light = clipped(&in_light, &window(-tan, tan, f32::MIN_POSITIVE));
        }
        // What lies at the light's horizon receives next to nothing: it does not coarsen the grid.
        for l in in_light.iter().filter(|l| l.z > 0.0) {
            let t = (l.truncate() / l.z).clamp(Vec2::splat(-MAX_TAN), Vec2::splat(MAX_TAN));
            self.low = self.low.min(t);
            self.high = self.high.max(t);
            self.far_q = self.far_q.min(1.0 / l.z);
            self.near_q = self.near_q.max(1.0 / l.z);
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
    /// Of the nearest caster of all.
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

    /// Adds a caster and the shadow that it casts on the deepest surface, if it casts on anything that the grid covers.
    fn cast(&self, corners: [Vec3; 3], half_light: Vec2, casting: &mut Casting) {
        let mut cast = |t: Vec2, q: f32, behind: f32| {
            if behind.is_finite() && q > behind * (1.0 + SEPARATION) {
                casting.reach = casting.reach.max(t.abs() + half_light * (q - behind));
                casting.nearest_q = casting.nearest_q.max(q);
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
    }

    /// Inverse distance of the deepest surface at a tangent, the smallest of the cells around it: a surface beyond the
    /// edge of a cell casts on its neighbours.
    fn deepest_q(&self, t: Vec2) -> f32 {
        let of_cell = |cell: usize| self.planes[cell].dot(t.extend(1.0));
        self.cells.around(t, 1).map(of_cell).filter(|q| *q > 0.0).fold(f32::INFINITY, f32::min)
    }
}
