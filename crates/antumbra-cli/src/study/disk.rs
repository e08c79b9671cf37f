//! What people were shown: the shadow of a disk on a parallel plane, seen from the light, with a penumbra of so many pixels
//! [Shen 2011, section 5.1].

use antumbra_scene::{Camera, Instance, Material, Mesh, RectLight, Scene};
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::TAU;

/// The map is so much wider than the picture.
const MAP_OVER_PICTURE: f32 = 2.0;
/// Metres from the light to the ground, and to the disk.
const GROUND: f32 = 10.0;
const DISK: f32 = 5.0;
/// Half the opening of the camera, as a tangent.
const TAN_HALF: f32 = 0.5;
/// Corners of the disk.
const CORNERS: u32 = 512;

/// A penumbra to look at.
#[derive(Clone, Copy, Debug)]
pub struct Disk {
    /// Width of the filter on the ground, with the pixel's own window, in pixels.
    pub penumbra: f32,
    /// Pixels of the picture a side.
    pub side: u32,
}

impl Disk {
    /// A picture that is wide enough for the penumbra.
    pub fn of_penumbra(penumbra: u32) -> Disk {
        Disk { penumbra: penumbra as f32, side: (2 * penumbra).max(128) }
    }

    /// Radius of the shadow of the light's centre, in pixels.
    fn radius(&self) -> f32 {
        self.side as f32 / 4.0
    }

    /// Texels of a map a side for so many texels in the filter's width.
    pub fn map(&self, texels: f64) -> u32 {
        (texels * f64::from(MAP_OVER_PICTURE) * f64::from(self.side) / f64::from(self.penumbra)).round() as u32
    }

    /// Texels in the filter's width, of a map of so many texels a side.
    pub fn texels(&self, map: u32) -> f64 {
        f64::from(map) * f64::from(self.penumbra) / (f64::from(MAP_OVER_PICTURE) * f64::from(self.side))
    }

    /// The scene, its shadow moved by so many pixels. The camera is at the light's centre; its near plane lies between the
    /// disk and the ground, so that only the ground is seen.
    pub fn scene(&self, moved: Vec2) -> Scene {
        let pixel = 2.0 * TAN_HALF / self.side as f32;
        // The filter is that of the light and of the pixel: the squares of their widths add.
        let width = (self.penumbra * self.penumbra - 1.0).max(0.0).sqrt() * pixel;
        let light = RectLight {
            center: Vec3::new(0.0, GROUND, 0.0),
            target: Vec3::ZERO,
            up: Vec3::NEG_Z,
            size: Vec2::splat(width / (1.0 / DISK - 1.0 / GROUND)),
            shadow_fov_deg: Some(2.0 * (MAP_OVER_PICTURE * TAN_HALF).atan().to_degrees()),
        };
        let camera = Camera {
            eye: light.center,
            target: Vec3::ZERO,
            up: Vec3::NEG_Z,
            fov_y_deg: 2.0 * TAN_HALF.atan().to_degrees(),
            near: 0.5 * (DISK + GROUND),
            far: 2.0 * GROUND,
        };
        let middle = Vec3::new(moved.x, 0.0, moved.y) * pixel * DISK + Vec3::Y * (GROUND - DISK);
        let meshes = vec![ground(), disk(middle, self.radius() * pixel * DISK)];
        let instances = (0..meshes.len())
            .map(|mesh| Instance { mesh, world_from_object: Affine3A::IDENTITY, receiver_only: mesh == 0 })
            .collect();
        Scene {
            name: "disk".into(),
            meshes,
            materials: vec![Material::default()],
            instances,
            camera,
            light,
            size: None,
        }
    }

    /// The pixels that the moved penumbra covers, and two more each side.
    pub fn around_edge(&self, moved: Vec2) -> Vec<bool> {
        let middle = Vec2::splat(0.5 * self.side as f32) + moved;
        let at = |i: u32| Vec2::new((i % self.side) as f32, (i / self.side) as f32) + 0.5;
        let off = |i: u32| (at(i).distance(middle) - self.radius()).abs();
        // A square's diagonal is 1.42 times its edge.
        (0..self.side * self.side).map(|i| off(i) <= 0.71 * self.penumbra + 2.0).collect()
    }
}

fn ground() -> Mesh {
    let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z) * 4.0 * GROUND;
    let positions = vec![corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)];
    Mesh { positions, indices: vec![0, 1, 2, 0, 2, 3], ..Mesh::default() }
}

fn disk(middle: Vec3, radius: f32) -> Mesh {
    let corner = |i: u32| {
        let turn = TAU * i as f32 / CORNERS as f32;
        middle + radius * Vec3::new(turn.cos(), 0.0, turn.sin())
    };
    let positions = std::iter::once(middle).chain((0..CORNERS).map(corner)).collect();
    let indices = (0..CORNERS).flat_map(|i| [0, 1 + (i + 1) % CORNERS, 1 + i]).collect();
    Mesh { positions, indices, ..Mesh::default() }
}
