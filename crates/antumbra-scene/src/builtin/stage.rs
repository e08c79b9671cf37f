//! A scene under construction.

use super::maths::Frame;
use super::shapes::MeshBuilder;
use crate::{Camera, Instance, Material, Mesh, RectLight, Scene};
use glam::{Affine3A, Vec2, Vec3};

/// Collects materials, meshes and instances.
#[derive(Default)]
pub(super) struct Stage {
    materials: Vec<Material>,
    meshes: Vec<Mesh>,
    instances: Vec<Instance>,
}

impl Stage {
    /// Adds an opaque material of a linear colour.
    pub fn color(&mut self, r: f32, g: f32, b: f32) -> usize {
        self.material(Material::of_color(r, g, b))
    }

    pub fn material(&mut self, material: Material) -> usize {
        self.materials.push(material);
        self.materials.len() - 1
    }

    /// Adds a mesh that nothing shows yet.
    pub fn mesh(&mut self, name: &str, material: usize, build: impl FnOnce(&mut MeshBuilder)) -> usize {
        let mut builder = MeshBuilder::new();
        build(&mut builder);
        self.meshes.push(builder.finish(name, material));
        self.meshes.len() - 1
    }

    /// Shows a mesh at a place.
    pub fn place(&mut self, mesh: usize, frame: Frame) {
        self.instances.push(Instance { mesh, world_from_object: frame.affine(), receiver_only: false });
    }

    /// Adds a mesh whose vertices are in world space.
    pub fn solid(&mut self, name: &str, material: usize, build: impl FnOnce(&mut MeshBuilder)) {
        let mesh = self.mesh(name, material, build);
        self.place(mesh, Frame::IDENTITY);
    }

    /// A flat square ground at y = 0: being flat and under everything, it takes shadows and casts none.
    pub fn ground(&mut self, edge: f32, material: usize) {
        let half = 0.5 * edge;
        let mesh = self.mesh("ground", material, |m| {
            m.sheet(1, 1, |x, z| Vec3::new(edge * x as f32 - half, 0.0, half - edge * z as f32));
        });
        self.instances.push(Instance { mesh, world_from_object: Affine3A::IDENTITY, receiver_only: true });
    }

    pub fn triangle_count(&self) -> usize {
        self.instances.iter().map(|i| self.meshes[i.mesh].triangle_count()).sum()
    }

    pub fn finish(self, camera: Camera, light: RectLight) -> Scene {
        let Stage { materials, meshes, instances } = self;
        Scene { name: String::new(), meshes, materials, instances, camera, light, size: None }
    }
}

/// A camera that stands upright.
pub(super) fn camera(eye: [f32; 3], target: [f32; 3], fov_y_deg: f32, near: f32, far: f32) -> Camera {
    Camera { eye: eye.into(), target: target.into(), up: Vec3::Y, fov_y_deg, near, far }
}

/// A light whose first edge is level; one that faces straight down has its edges along x and z.
pub(super) fn light(center: [f32; 3], target: [f32; 3], width: f32, height: f32) -> RectLight {
    let (center, target) = (Vec3::from(center), Vec3::from(target));
    let down = (target - center).normalize().y < -0.999;
    let up = if down { Vec3::NEG_Z } else { Vec3::Y };
    RectLight { center, target, up, size: Vec2::new(width, height), shadow_fov_deg: None }
}
