//! Polygons to triangles.

use glam::Vec3;

/// Splits polygons into triangles; keeps its buffers from one polygon to the next.
pub(super) struct Triangulator {
    earcut: earcut::Earcut<f32>,
    spatial: Vec<[f32; 3]>,
    flat: Vec<[f32; 2]>,
    triangles: Vec<u32>,
}

impl Triangulator {
    pub fn new() -> Triangulator {
        Triangulator { earcut: earcut::Earcut::new(), spatial: Vec::new(), flat: Vec::new(), triangles: Vec::new() }
    }

    /// Calls `emit` with three corners, numbers below `count`, for each triangle of a polygon whose corners are at
    /// `point(0) .. point(count - 1)`. Concave polygons are cut by ears. A polygon that ears cannot cut (it crosses
    /// itself or lies on a line) becomes a fan.
    pub fn split(&mut self, count: usize, point: impl Fn(usize) -> Vec3, mut emit: impl FnMut([usize; 3])) {
        if count < 3 {
            return;
        }
        let fan = count == 3 || is_convex(count, &point);
        if fan || !self.cut_ears(count, &point) {
            (1..count - 1).for_each(|i| emit([0, i, i + 1]));
        } else {
            self.triangles.chunks_exact(3).for_each(|t| emit([t[0] as usize, t[1] as usize, t[2] as usize]));
        }
    }

    fn cut_ears(&mut self, count: usize, point: &impl Fn(usize) -> Vec3) -> bool {
        // Differences to the first corner, so that a polygon far from the origin keeps its shape when squared.
        let origin = point(0);
        self.spatial.clear();
        self.spatial.extend((0..count).map(|i| (point(i) - origin).to_array()));
        let largest = self.spatial.iter().flatten().fold(0.0f32, |m, x| m.max(x.abs()));
        if !(largest > 0.0 && largest.is_finite()) {
            return false;
        }
        self.spatial.iter_mut().flatten().for_each(|x| *x /= largest);
        if !earcut::utils3d::project3d_to_2d(&self.spatial, count, &mut self.flat) {
            return false;
        }
        self.earcut.earcut(self.flat.iter().copied(), &[] as &[u32], &mut self.triangles);
        self.triangles.len() == 3 * (count - 2)
    }
}

/// True if a fan around the first corner folds nowhere: all corners turn the same way as the polygon as a whole, and
/// so do the fan's triangles.
fn is_convex(count: usize, point: &impl Fn(usize) -> Vec3) -> bool {
    let origin = point(0);
    let fan = |i: usize| (point(i) - origin).cross(point(i + 1) - origin);
    let normal: Vec3 = (1..count - 1).map(fan).sum();
    let corner = |i: usize| {
        let (a, b, c) = (point(i), point((i + 1) % count), point((i + 2) % count));
        (b - a).cross(c - b)
    };
    (1..count - 1).all(|i| fan(i).dot(normal) > 0.0) && (0..count).all(|i| corner(i).dot(normal) >= 0.0)
}
