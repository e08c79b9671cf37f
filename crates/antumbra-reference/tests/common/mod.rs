//! Small scenes for the tests.
#![allow(dead_code, reason = "every test file uses another part")]

use antumbra_reference::{Reference, Settings, trace};
use antumbra_scene::{Camera, Instance, Material, Mesh, RectLight, Scene};
use glam::{Affine3A, Vec2, Vec3};
use std::sync::atomic::AtomicBool;

pub fn mesh(positions: Vec<Vec3>, indices: Vec<u32>) -> Mesh {
    Mesh { positions, indices, ..Mesh::default() }
}

/// A horizontal rectangle around `center`.
pub fn quad(center: Vec3, half: Vec2) -> Mesh {
    let at = |x: f32, z: f32| center + Vec3::new(x * half.x, 0.0, z * half.y);
    mesh(vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)], vec![0, 1, 2, 0, 2, 3])
}

/// A unit icosphere around `center`, outward winding.
pub fn icosphere(subdivisions: u32, center: Vec3) -> Mesh {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let mut positions: Vec<Vec3> = [
        (-1.0, g, 0.0),
        (1.0, g, 0.0),
        (-1.0, -g, 0.0),
        (1.0, -g, 0.0),
        (0.0, -1.0, g),
        (0.0, 1.0, g),
        (0.0, -1.0, -g),
        (0.0, 1.0, -g),
        (g, 0.0, -1.0),
        (g, 0.0, 1.0),
        (-g, 0.0, -1.0),
        (-g, 0.0, 1.0),
    ]
    .map(|(x, y, z)| Vec3::new(x, y, z).normalize())
    .to_vec();
    let mut indices: Vec<u32> = vec![
        0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3, 9, 4, 3,
        4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9, 4, 9, 5, 2, 4, 11, 6, 2, 10, 8, 6, 7, 9, 8, 1,
    ];
    for _ in 0..subdivisions {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push(((positions[a as usize] + positions[b as usize]) / 2.0).normalize());
                positions.len() as u32 - 1
            })
        };
        let split = |t: &[u32]| {
            let (a, b, c) = (t[0], t[1], t[2]);
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca]
        };
        indices = indices.chunks(3).flat_map(split).collect();
    }
    mesh(positions.iter().map(|p| *p + center).collect(), indices)
}

pub fn light_above(height: f32, size: Vec2) -> RectLight {
    RectLight { center: Vec3::Y * height, target: Vec3::ZERO, up: -Vec3::Z, size, shadow_fov_deg: None }
}

pub fn camera(eye: Vec3, target: Vec3) -> Camera {
    Camera { eye, target, up: Vec3::Y, fov_y_deg: 60.0, near: 0.1, far: 1e6 }
}

/// Every mesh once, where it is, of the default material.
pub fn scene(meshes: Vec<Mesh>, camera: Camera, light: RectLight) -> Scene {
    let instances = (0..meshes.len())
        .map(|mesh| Instance { mesh, world_from_object: Affine3A::IDENTITY, receiver_only: false })
        .collect();
    let materials = vec![Material::default()];
    Scene { name: "test".into(), meshes, materials, instances, camera, light, size: None }
}

pub fn traced(scene: &Scene, settings: &Settings) -> Reference {
    trace(scene, settings, &|_| (), &AtomicBool::new(false)).unwrap()
}

/// Reproducible numbers in [0, 1).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    pub fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let x = (self.0 ^ (self.0 >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (x >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In [-1, 1)³.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}
