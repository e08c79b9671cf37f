//! The scenes of the curves: an occluder between the ground and a light that faces it. The unit of length is the width
//! of the paper's scene.

use crate::Error;
use crate::suites::shapes::{instance, rectangle};
use antumbra_scene::{Aabb, Camera, Instance, Material, Mesh, RectLight, Scene, builtin};
use glam::{Affine3A, Vec2, Vec3};

/// Height of the light above the ground.
pub const LIGHT_HEIGHT: f32 = 0.75;
/// Extent of an occluder along its longest axis.
const OCCLUDER: f32 = 0.2;
/// Default height of a flat occluder above the ground; other occluders stand on it.
const SQUARE_HEIGHT: f32 = 0.3;

/// An occluder of any size; [`Occluder::scene`] scales it to `OCCLUDER`.
#[derive(Clone)]
pub struct Occluder {
    pub name: String,
    meshes: Vec<Mesh>,
    /// Instances of `meshes` in world space, not yet scaled.
    parts: Vec<Instance>,
    bounds: Aabb,
    pub is_flat: bool,
}

/// Position of the occluder and size of the light.
#[derive(Clone, Copy)]
pub struct Placement {
    /// Edge length of the light.
    pub light: f32,
    /// Offset along x from the point under the light's centre.
    pub offset: f32,
    /// Height of the occluder's lowest point above the ground; `None` is the default height.
    pub bottom: Option<f32>,
}

impl Default for Placement {
    fn default() -> Placement {
        Placement { light: 0.1, offset: 0.0, bottom: None }
    }
}

impl Occluder {
    /// A square parallel to the light.
    pub fn square() -> Occluder {
        let mesh = rectangle(Vec3::ZERO, [0.5; 2]);
        Occluder::of("square", vec![mesh], vec![instance(0, false)])
    }

    /// All casters of a scene.
    pub fn of_scene(name: &str, scene: &Scene) -> Occluder {
        let parts = scene.instances.iter().filter(|i| !i.receiver_only).cloned().collect();
        let meshes = scene.meshes.iter().map(|m| Mesh { material: 0, uvs: Vec::new(), ..m.clone() }).collect();
        Occluder::of(name, meshes, parts)
    }

    /// A built-in scene's occluder.
    pub fn of_builtin(name: &str, spec: &str) -> Result<Occluder, Error> {
        Ok(Occluder::of_scene(name, &builtin::build(spec)?))
    }

    fn of(name: &str, meshes: Vec<Mesh>, parts: Vec<Instance>) -> Occluder {
        let points = parts.iter().flat_map(|p| {
            let mesh = &meshes[p.mesh];
            mesh.indices.iter().map(move |&k| p.world_from_object.transform_point3(mesh.positions[k as usize]))
        });
        let bounds = Aabb::of_points(points);
        Occluder { name: name.to_owned(), is_flat: bounds.size().y == 0.0, meshes, parts, bounds }
    }

    fn scale(&self) -> f32 {
        OCCLUDER / self.bounds.size().max_element()
    }

    /// Vertical extent of the scaled occluder.
    pub fn height(&self) -> f32 {
        self.bounds.size().y * self.scale()
    }

    /// A scene with one occluder.
    pub fn scene(&self, place: Placement) -> Scene {
        let bottom = place.bottom.unwrap_or(if self.is_flat { SQUARE_HEIGHT } else { 0.0 });
        self.scene_of(&[Vec3::new(place.offset, bottom, 0.0)], place.light)
    }

    /// A scene with `count` copies of the occluder in rows on the ground.
    pub fn copies(&self, count: u32, light: f32) -> Scene {
        let side = (count as f32).sqrt().ceil() as u32;
        let place = |i: u32| {
            let (x, z) = ((i % side) as f32, (i / side) as f32);
            let middle = 0.5 * (side - 1) as f32;
            Vec3::new((x - middle) * 1.1 * OCCLUDER, 0.0, (z - middle) * 1.1 * OCCLUDER)
        };
        self.scene_of(&(0..count).map(place).collect::<Vec<_>>(), light)
    }

    fn scene_of(&self, places: &[Vec3], light: f32) -> Scene {
        let ground = rectangle(Vec3::ZERO, [3.0; 2]);
        let middle = self.bounds.center().with_y(self.bounds.min.y);
        let placed = places.iter().flat_map(|at| {
            let to = Affine3A::from_translation(*at)
                * Affine3A::from_scale(Vec3::splat(self.scale()))
                * Affine3A::from_translation(-middle);
            self.parts.iter().map(move |p| Instance {
                mesh: p.mesh + 1,
                world_from_object: to * p.world_from_object,
                ..*p
            })
        });
        let reach = places.iter().fold(0.0f32, |m, p| m.max(p.x.abs()).max(p.z.abs()));
        Scene {
            name: self.name.clone(),
            meshes: std::iter::once(ground).chain(self.meshes.iter().cloned()).collect(),
            materials: vec![Material::default()],
            instances: std::iter::once(instance(0, true)).chain(placed).collect(),
            camera: Camera {
                eye: Vec3::new(0.25, 1.0, 1.0) * (1.0 + reach),
                target: Vec3::ZERO,
                up: Vec3::Y,
                fov_y_deg: 45.0,
                near: 0.01,
                far: 20.0,
            },
            light: RectLight {
                center: Vec3::new(0.0, LIGHT_HEIGHT, 0.0),
                target: Vec3::ZERO,
                up: Vec3::NEG_Z,
                size: Vec2::splat(light),
                shadow_fov_deg: None,
            },
            size: None,
        }
    }
}
