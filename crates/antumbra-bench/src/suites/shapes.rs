//! Meshes and instances for scenes that suites build.

use antumbra_scene::{Instance, Mesh};
use glam::{Affine3A, Vec3};

/// A horizontal rectangle around `center`; `half` is half its size along x and z.
pub fn rectangle(center: Vec3, half: [f32; 2]) -> Mesh {
    let corner = |[x, z]: [f32; 2]| center + Vec3::new(x * half[0], 0.0, z * half[1]);
    let positions = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(corner).to_vec();
    Mesh { positions, indices: vec![0, 1, 2, 0, 2, 3], ..Mesh::default() }
}

/// An instance of a mesh without a transform.
pub fn instance(mesh: usize, receiver_only: bool) -> Instance {
    Instance { mesh, world_from_object: Affine3A::IDENTITY, receiver_only }
}
