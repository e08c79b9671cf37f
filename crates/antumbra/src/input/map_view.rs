//! A projection and the planes of its frustum.

use crate::gpu_struct;
use glam::{Mat4, Vec4};

gpu_struct! {
    /// A frustum that casters are drawn into.
    pub(crate) struct MapView {
        clip_from_world: Mat4,
        /// Inward planes (normal, distance): a point is inside where all are >= 0.
        planes_ws: [Vec4; 6],
    }
}

impl MapView {
    /// The frustum of a projection with reversed or forward depth; the planes follow from the rows of the matrix.
    pub fn new(clip_from_world: Mat4) -> MapView {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| clip_from_world.row(i));
        MapView { clip_from_world, planes_ws: [w + x, w - x, w + y, w - y, z, w - z] }
    }
}
