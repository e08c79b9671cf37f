//! Decisions in double precision where single precision cannot tell.

use crate::geometry::Triangle;
use glam::{DVec3, Vec3};

/// A ray's own axis order and shear: it runs along +z of the sheared space [Woop 2013, section 3].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    pub x: f32,
    pub y: f32,
}

/// Is the ray inside of the triangle's three edges, from either side? Both neighbours of an edge get consistent
/// answers: vertices are sheared in single precision, and of the rounded points the edge function's sign is exact,
/// because products of single-precision numbers are exact in double precision [Woop 2013, section 3.3].
pub(crate) fn is_inside<const Z: usize>(triangle: &Triangle, origin: Vec3, shear: Shear) -> bool {
    let (kx, ky) = ((Z + 1) % 3, (Z + 2) % 3);
    let [a, b, c] = triangle.vertices.map(|v| {
        let (x, y, z) = (v[kx] - origin[kx], v[ky] - origin[ky], v[Z] - origin[Z]);
        (f64::from(x - shear.x * z), f64::from(y - shear.y * z))
    });
    let u = c.0 * b.1 - c.1 * b.0;
    let v = a.0 * c.1 - a.1 * c.0;
    let w = b.0 * a.1 - b.1 * a.0;
    let crosses = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
    !crosses && u + v + w != 0.0
}

/// Distance along `direction`, in its length, at which a ray that is inside of the edges meets the plane. Kept to the
/// triangle's extent along the axis `Z`, on which a grazing ray's meeting with the plane can lie far away.
#[inline(always)]
pub(crate) fn distance<const Z: usize>(triangle: &Triangle, origin: Vec3, direction: Vec3) -> f64 {
    let normal = triangle.double_area_normal();
    let (o, d) = (origin.as_dvec3(), direction.as_dvec3());
    let t = normal.dot(triangle.vertices[0].as_dvec3() - o) / normal.dot(d);
    let [a, b, c] = triangle.vertices.map(|v| (f64::from(v[Z]) - o[Z]) / d[Z]);
    let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
    // `max` and `min` turn the NaN of a ray within the plane into an end of the extent.
    t.max(lo).min(hi)
}

/// Barycentric coordinates of the point of the triangle's plane nearest to `p`.
pub(crate) fn barycentric(triangle: &Triangle, p: DVec3) -> DVec3 {
    let n = triangle.double_area_normal();
    let [a, b, c] = triangle.vertices.map(|v| v.as_dvec3());
    let w = DVec3::new((c - b).cross(p - b).dot(n), (a - c).cross(p - c).dot(n), (b - a).cross(p - a).dot(n));
    w / n.length_squared()
}
