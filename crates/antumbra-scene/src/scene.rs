//! A scene: meshes, materials, camera, light.

use crate::{Aabb, Camera, Material, Mesh, RectLight};
use glam::Affine3A;

/// A mesh placed in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// Object to world; may mirror.
    pub world_from_object: Affine3A,
    /// True if it takes shadows and casts none.
    pub receiver_only: bool,
}

/// A whole scene, ready to be drawn or traced.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// For messages and reports: a file's stem or `builtin:NAME`.
    pub name: String,
    /// Triangle meshes in object space.
    pub meshes: Vec<Mesh>,
    /// Materials of the meshes.
    pub materials: Vec<Material>,
    /// Where the meshes stand.
    pub instances: Vec<Instance>,
    /// Where it is seen from.
    pub camera: Camera,
    /// The light.
    pub light: RectLight,
    /// Image size in pixels, if the file asks for one.
    pub size: Option<(u32, u32)>,
}

impl Scene {
    /// Triangles over all instances.
    pub fn triangle_count(&self) -> usize {
        self.instances.iter().map(|i| self.meshes[i.mesh].triangle_count()).sum()
    }

    /// World-space box around everything that `filter` accepts.
    pub fn bounds_of(&self, filter: impl Fn(&Instance) -> bool) -> Aabb {
        self.instances.iter().filter(|i| filter(i)).fold(Aabb::EMPTY, |b, i| {
            let m = &self.meshes[i.mesh];
            b.union(&Aabb::of_points(
                m.indices.iter().map(|&k| i.world_from_object.transform_point3(m.positions[k as usize])),
            ))
        })
    }

    /// World-space box around everything.
    pub fn bounds(&self) -> Aabb {
        self.bounds_of(|_| true)
    }
}
