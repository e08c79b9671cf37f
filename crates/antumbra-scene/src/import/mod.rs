//! Importers: bytes to [`Model`]. Files that a file refers to are asked for by name, so nothing here needs a disk.

// The modules that importers share have parts that only some of them use.
#[cfg_attr(not(all(feature = "gltf", feature = "obj", feature = "scene-file")), allow(dead_code))]
pub(crate) mod far;
#[cfg(feature = "gltf")]
pub mod gltf;
#[cfg(feature = "obj")]
pub mod obj;
#[cfg(feature = "ply")]
pub mod ply;
#[cfg(any(feature = "obj", feature = "ply"))]
mod polygon;
#[cfg_attr(not(all(feature = "gltf", feature = "obj", feature = "scene-file")), allow(dead_code))]
pub(crate) mod text;
#[cfg(any(feature = "gltf", feature = "obj"))]
mod texture_file;
#[cfg_attr(not(all(feature = "gltf", feature = "obj", feature = "scene-file")), allow(dead_code))]
mod warnings;

use crate::{Aabb, Camera, Instance, Material, Mesh, RectLight, SceneError};
use glam::DVec3;

/// Gives the bytes of a file that the imported file refers to, by the name it uses.
pub type ReadFile<'a> = dyn FnMut(&str) -> std::io::Result<Vec<u8>> + 'a;

/// Coordinates beyond this, in metres, leave single precision no range for the squares and products of rendering.
const FARTHEST: f32 = 1e9;

/// What an importer finds in a file: at least one triangle, maybe a camera, maybe a light.
/// [`Model::into_scene`] fills in what is missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// For messages and reports.
    pub name: String,
    /// Triangle meshes in object space.
    pub meshes: Vec<Mesh>,
    /// Materials of the meshes.
    pub materials: Vec<Material>,
    /// Where the model's origin lies in the file's coordinates: 0, unless the model lies so far from there that single
    /// precision would lose its shape. Instances, camera and light are relative to it.
    pub origin: DVec3,
    /// Where the meshes stand.
    pub instances: Vec<Instance>,
    /// The file's camera. An infinite `far` is still to be fitted to the scene.
    pub camera: Option<Camera>,
    /// The file's light.
    pub light: Option<RectLight>,
}

impl Model {
    /// World-space box around everything.
    pub fn bounds(&self) -> Aabb {
        self.world_points().fold(Aabb::EMPTY, |b, p| Aabb { min: b.min.min(p), max: b.max.max(p) })
    }

    /// World-space corners of every triangle.
    pub(crate) fn world_points(&self) -> impl Iterator<Item = glam::Vec3> {
        self.instances.iter().flat_map(|i| {
            let mesh = &self.meshes[i.mesh];
            mesh.indices.iter().map(|&k| i.world_from_object.transform_point3(mesh.positions[k as usize]))
        })
    }

    /// Refuses a model that has no triangles or that cannot be rendered in single precision.
    pub(crate) fn checked(self, file: &str) -> Result<Model, SceneError> {
        if self.instances.iter().all(|i| self.meshes[i.mesh].indices.is_empty()) {
            let advice = "export it with its faces".to_string();
            return Err(SceneError::NoTriangles { file: file.to_string(), advice });
        }
        for instance in &self.instances {
            let mesh = &self.meshes[instance.mesh];
            for &k in &mesh.indices {
                let p = instance.world_from_object.transform_point3(mesh.positions[k as usize]);
                let fits = p.is_finite() && p.abs().max_element() <= FARTHEST;
                if !fits {
                    return Err(SceneError::TooFar {
                        file: file.to_string(),
                        mesh: mesh.name.clone(),
                        vertex: k as usize,
                        position: p.to_array(),
                    });
                }
            }
        }
        Ok(self)
    }

    /// A model whose meshes stand where their vertices are.
    #[cfg(any(feature = "obj", feature = "ply"))]
    pub(crate) fn of_meshes(name: &str, meshes: Vec<Mesh>, materials: Vec<Material>, origin: DVec3) -> Model {
        let instances = (0..meshes.len())
            .map(|mesh| Instance { mesh, world_from_object: glam::Affine3A::IDENTITY, receiver_only: false })
            .collect();
        Model { name: name.to_string(), meshes, materials, instances, origin, ..Model::default() }
    }

    /// Takes in another model's meshes and materials and returns its instances, renumbered and in the coordinates of
    /// its file.
    #[cfg(feature = "scene-file")]
    pub(crate) fn absorb(&mut self, other: Model) -> Vec<far::Placed> {
        let (mesh_base, material_base) = (self.meshes.len(), self.materials.len());
        self.materials.extend(other.materials);
        self.meshes.extend(other.meshes.into_iter().map(|m| Mesh { material: m.material + material_base, ..m }));
        let file_from_model = glam::DAffine3::from_translation(other.origin);
        let placed = |i: &Instance| far::Placed {
            mesh: i.mesh + mesh_base,
            world_from_object: file_from_model * i.world_from_object.as_daffine3(),
            receiver_only: i.receiver_only,
        };
        other.instances.iter().map(placed).collect()
    }
}
