//! A camera, a light and a ground for scenes that come without.

use crate::import::Model;
use crate::{Aabb, Camera, Instance, Material, Mesh, RectLight, Scene};
use glam::{Affine3A, Vec2, Vec3};

const FOV_Y_DEG: f32 = 35.0;
/// Three-quarter view: degrees from the +Z axis towards +X, and above the horizon.
const YAW_DEG: f32 = 35.0;
const PITCH_DEG: f32 = 25.0;
/// Fraction of the image's height and width that the model may fill: its shadow needs space.
const FILLED: f32 = 0.6;
/// Offset of the model to the left, as a fraction of half the image's width: its shadow falls to the right.
const LEFT_OF_MIDDLE: f32 = 0.1;
/// Where the light stands, seen from the model: degrees to the left of the camera and above the horizon.
const LIGHT_AZIMUTH_DEG: f32 = 75.0;
const LIGHT_ELEVATION_DEG: f32 = 50.0;
/// Distance of the light in radii of the model, and its edge as a part of that distance: far enough for a sharp shadow
/// where things touch, large enough for a soft one behind the model's top.
const LIGHT_DISTANCE: f32 = 4.0;
const LIGHT_EDGE: f32 = 1.0 / 8.0;
/// Aspect ratio of the widest image that the ground fills.
const WIDEST: f32 = 2.0;
/// Vertices by which a large model is framed, at most.
const SAMPLES: usize = 200_000;

impl Model {
    /// A whole scene. Missing camera, light and ground are chosen from the model: a camera that sees it in
    /// three-quarter view, a light from above and from the camera's left, and for a model with neither camera nor light
    /// a ground to stand on, which takes shadows and casts none.
    ///
    /// The scene's origin is the model's: see [`Model::origin`].
    pub fn into_scene(self) -> Scene {
        self.warn_of_distance(&self.name);
        let bare = self.camera.is_none() && self.light.is_none();
        self.framed(bare)
    }

    /// A whole scene, on a ground or as it is.
    pub(crate) fn framed(mut self, on_ground: bool) -> Scene {
        let points = self.points_of_interest();
        let bounds = Aabb::of_points(points.iter().copied());
        let mut camera = self.camera.unwrap_or_else(|| camera_for(&points, &bounds));
        let light = self.light.unwrap_or_else(|| light_for(&bounds, &camera));
        if on_ground {
            self.add_ground(&bounds, &camera);
        }
        fit_depth(&mut camera, &self.bounds(), &bounds);
        let Model { name, meshes, materials, instances, .. } = self;
        Scene { name, meshes, materials, instances, camera, light, size: None }
    }

    /// Where the shadow casters are; everything if nothing casts.
    fn points_of_interest(&self) -> Vec<Vec3> {
        let casts = self.instances.iter().any(|i| !i.receiver_only && !self.meshes[i.mesh].indices.is_empty());
        let chosen = || self.instances.iter().filter(move |i| !(casts && i.receiver_only));
        let total: usize = chosen().map(|i| self.meshes[i.mesh].indices.len()).sum();
        let step = total / SAMPLES + 1;
        let corners = chosen().flat_map(|i| {
            let mesh = &self.meshes[i.mesh];
            let world = move |&k: &u32| i.world_from_object.transform_point3(mesh.positions[k as usize]);
            mesh.indices.iter().map(world)
        });
        corners.step_by(step).collect()
    }

    fn add_ground(&mut self, bounds: &Aabb, camera: &Camera) {
        let middle = bounds.center();
        // A flat model at the height of the ground would z-fight with it.
        let radius = radius_of(bounds);
        let flat = bounds.size().y < 1e-3 * radius;
        let y = bounds.min.y - if flat { 0.01 * radius } else { 0.0 };
        let half = ground_reach(camera, y).unwrap_or(20.0 * radius);
        let corner = |x: f32, z: f32| Vec3::new(middle.x + x * half, y, middle.z + z * half);
        self.materials.push(ground_material());
        self.meshes.push(Mesh {
            name: "ground".to_string(),
            positions: vec![corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)],
            uvs: Vec::new(),
            indices: vec![0, 1, 2, 0, 2, 3],
            material: self.materials.len() - 1,
        });
        let mesh = self.meshes.len() - 1;
        self.instances.push(Instance { mesh, world_from_object: Affine3A::IDENTITY, receiver_only: true });
    }
}

/// A little darker and cooler than a model without material.
pub(crate) fn ground_material() -> Material {
    Material::of_color(0.55, 0.57, 0.60)
}

/// An up direction that is not parallel to `forward`.
pub(crate) fn up_for(forward: Vec3) -> Vec3 {
    if forward.normalize().y.abs() > 0.999 { Vec3::NEG_Z } else { Vec3::Y }
}

/// Half the diagonal, and never so small that distances to the middle vanish in rounding.
fn radius_of(bounds: &Aabb) -> f32 {
    let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
    (0.5 * bounds.size().length()).max(1e-5 * reach).max(1e-6)
}

/// A camera at the front, right and above, from which the points fill the wanted fraction of the image.
fn camera_for(points: &[Vec3], bounds: &Aabb) -> Camera {
    let (yaw, pitch) = (YAW_DEG.to_radians(), PITCH_DEG.to_radians());
    let backward = Vec3::new(yaw.sin() * pitch.cos(), pitch.sin(), yaw.cos() * pitch.cos());
    let right = Vec3::Y.cross(backward).normalize();
    let up = backward.cross(right);
    let radius = radius_of(bounds);
    let tangent = (0.5 * FOV_Y_DEG).to_radians().tan();
    let (mut target, mut distance) = (bounds.center(), 4.0 * radius);
    // Perspective makes the extent depend on the distance in no simple way, but repeating converges at once.
    for _ in 0..10 {
        let project = |&p: &Vec3| {
            let q = p - target;
            Vec2::new(q.dot(right), q.dot(up)) / (distance - q.dot(backward)).max(1e-3 * distance)
        };
        let (low, high) = points
            .iter()
            .map(project)
            .fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let middle = 0.5 * (low + high) * distance;
        target += right * middle.x + up * middle.y;
        let filled = 0.5 * (high - low).max_element() / tangent;
        distance = (distance * filled / FILLED).max(1.5 * radius);
    }
    target += right * (LEFT_OF_MIDDLE * tangent * distance);
    let eye = target + backward * distance;
    Camera { eye, target, up: Vec3::Y, fov_y_deg: FOV_Y_DEG, near: 0.0, far: f32::INFINITY }
}

/// Above, to the camera's left and a little in front of the middle.
fn light_for(bounds: &Aabb, camera: &Camera) -> RectLight {
    let (right, ..) = camera.basis();
    let level = |v: Vec3| Vec3::new(v.x, 0.0, v.z).try_normalize();
    let right = level(right).unwrap_or(Vec3::X);
    let toward_camera = right.cross(Vec3::Y);
    let (azimuth, elevation) = (LIGHT_AZIMUTH_DEG.to_radians(), LIGHT_ELEVATION_DEG.to_radians());
    let level_direction = toward_camera * azimuth.cos() - right * azimuth.sin();
    let direction = level_direction * elevation.cos() + Vec3::Y * elevation.sin();
    let (target, distance) = (bounds.center(), LIGHT_DISTANCE * radius_of(bounds));
    RectLight {
        center: target + direction * distance,
        target,
        up: Vec3::Y,
        size: Vec2::splat(LIGHT_EDGE * distance),
        shadow_fov_deg: None,
    }
}

/// Distance from the centre at which the widest image sees the ground; `None` if the horizon is in it.
fn ground_reach(camera: &Camera, y: f32) -> Option<f32> {
    let (right, up, forward) = camera.basis();
    let tangent = (0.5 * camera.fov_y_deg).to_radians().tan();
    let ray = forward + up * tangent + right * (WIDEST * tangent);
    let level = Vec2::new(ray.x, ray.z).length();
    (ray.y < 0.0).then(|| (camera.eye.y - y) / -ray.y * level + camera.eye.distance(camera.target))
}

/// Near and far planes where they are not given: a `near` of 0, an infinite `far`.
fn fit_depth(camera: &mut Camera, everything: &Aabb, casters: &Aabb) {
    let (.., forward) = camera.basis();
    let depths = |b: &Aabb| b.corners().map(|c| (c - camera.eye).dot(forward));
    let farthest = depths(everything).into_iter().fold(0.0, f32::max);
    let nearest = depths(casters).into_iter().fold(f32::INFINITY, f32::min);
    let distance = camera.eye.distance(camera.target);
    if camera.near <= 0.0 {
        // The ground in front of the model is nearer than the model. Reversed depth may begin close to the eye without
        // loss, so a far horizon does not move the near plane.
        camera.near = (0.5 * nearest).min(0.1 * distance).max(1e-4 * distance);
    }
    if camera.far.is_infinite() {
        camera.far = (1.01 * farthest).max(2.0 * camera.near);
    }
}
