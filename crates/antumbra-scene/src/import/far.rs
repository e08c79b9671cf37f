//! Models far from the origin, such as georeferenced ones: how many digits single precision leaves them, and moving
//! them to a local origin in double precision.

use super::Model;
use super::warnings::Warnings;
use crate::Instance;
use glam::{Affine3A, DAffine3, DVec3, Vec3};

/// Rounding to single precision moves a coordinate by up to this part of it.
const ROUNDING: f64 = 1.0 / (1u32 << 24) as f64;

/// A model with fewer digits is moved: its vertices would be off by more than 1/10 000 of its diagonal.
const DIGITS_TO_STAY: f64 = 4.0;

/// A mesh with fewer digits is named in a warning. Small parts of a large scene have a digit less than the whole.
const DIGITS_TO_WARN: f64 = 3.0;

/// Digits of a coordinate, counted from the model's diagonal down, that are right in single precision.
fn digits_left(farthest: f64, diagonal: f64) -> f64 {
    (diagonal / (farthest * ROUNDING)).log10()
}

/// A box in double precision.
#[derive(Clone, Copy)]
pub(crate) struct Extent {
    min: DVec3,
    max: DVec3,
}

impl Extent {
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Extent {
        let empty = Extent { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };
        points.into_iter().fold(empty, |e, p| Extent { min: e.min.min(p), max: e.max.max(p) })
    }

    /// The point to move to the origin. It is 0 along an axis on which the box is near enough, so that a model which
    /// stands on the ground still does, and elsewhere a round number.
    pub fn local_origin(&self) -> DVec3 {
        let diagonal = (self.max - self.min).length();
        if !(diagonal > 0.0 && diagonal.is_finite()) {
            return DVec3::ZERO;
        }
        let unit = diagonal.log2().floor().exp2();
        let along = |low: f64, high: f64| {
            let is_far = digits_left(low.abs().max(high.abs()), diagonal) < DIGITS_TO_STAY;
            if is_far { (0.5 * (low + high) / unit).round() * unit } else { 0.0 }
        };
        let (a, b) = (self.min, self.max);
        DVec3::new(along(a.x, b.x), along(a.y, b.y), along(a.z, b.z))
    }
}

/// An instance whose place is not yet rounded to single precision.
pub(crate) struct Placed {
    pub mesh: usize,
    pub world_from_object: DAffine3,
    pub receiver_only: bool,
}

impl Model {
    /// Sets the instances, and moves all to a local origin where they lie far from the world's.
    pub(crate) fn place(&mut self, placed: &[Placed]) {
        // The corners of the meshes' boxes tell well enough how far the scene is from the origin.
        let boxes: Vec<_> = self.meshes.iter().map(|m| m.bounds()).collect();
        let shown = placed.iter().filter(|p| !boxes[p.mesh].is_empty());
        let corners = |p: &Placed| boxes[p.mesh].corners().map(|c| p.world_from_object.transform_point3(c.as_dvec3()));
        let extent = Extent::of(shown.flat_map(corners));
        self.origin = extent.local_origin();
        let instance = |p: &Placed| Instance {
            mesh: p.mesh,
            world_from_object: self.local(&p.world_from_object),
            receiver_only: p.receiver_only,
        };
        self.instances = placed.iter().map(instance).collect();
    }

    /// A point of the world, relative to the model's origin.
    pub(crate) fn local_point(&self, point: DVec3) -> Vec3 {
        (point - self.origin).as_vec3()
    }

    /// A transform to the world as one to the model's origin.
    pub(crate) fn local(&self, world_from_any: &DAffine3) -> Affine3A {
        let moved = DAffine3 { translation: world_from_any.translation - self.origin, ..*world_from_any };
        moved.as_affine3a()
    }

    /// Says that the model was moved, or how few digits it has left.
    pub(crate) fn warn_of_distance(&self, file: &str) {
        if self.origin != DVec3::ZERO {
            let [x, y, z] = (DVec3::ZERO - self.origin).to_array();
            tracing::warn!(
                "{file}: it lies so far from the origin that single precision would lose its shape; all of it is moved \
                 by ({x}, {y}, {z}) metres"
            );
        }
        let warnings = Warnings::new(file);
        let digits = self.instances.iter().map(|i| (i, self.digits(i)));
        let few: Vec<_> = digits.filter(|(_, digits)| *digits < DIGITS_TO_WARN).collect();
        let Some((worst, digits)) = few.iter().min_by(|a, b| a.1.total_cmp(&b.1)) else { return };
        warnings.add_many(
            few.len(),
            format!("mesh {:?}", self.meshes[worst.mesh].name),
            format!(
                "it is far from the origin for its size, single precision leaves {:.1} digits of its shape; \
                 move the scene closer to the origin",
                digits.max(0.0)
            ),
        );
    }

    /// Digits that are left of an instance's shape; infinitely many where it has none.
    fn digits(&self, instance: &Instance) -> f64 {
        let (mesh, place) = (&self.meshes[instance.mesh], instance.world_from_object.as_daffine3());
        let world = |&k: &u32| place.transform_point3(mesh.positions[k as usize].as_dvec3());
        let Extent { min, max } = Extent::of(mesh.indices.iter().map(world));
        let (farthest, diagonal) = (min.abs().max(max.abs()).max_element(), (max - min).length());
        if diagonal > 0.0 { digits_left(farthest, diagonal) } else { f64::INFINITY }
    }
}
