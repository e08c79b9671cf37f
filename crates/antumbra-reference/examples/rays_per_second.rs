//! How fast shadow rays are traced on one thread:
//!
//!     cargo run --release -p antumbra-reference --example rays_per_second -- MESH.obj [SEGMENTS]
//!
//! The mesh is scaled to a height of 1.5 m and stands on a plane under a light of 1 m × 1 m. SEGMENTS is a file to
//! compare tracers on the same rays: six little-endian floats a segment, from and to, in metres of that scene. Without
//! a mesh a grid of bumps is taken.

use antumbra_reference::{Settings, Tracer, View};
use antumbra_scene::{Camera, Instance, Material, Mesh, RectLight, Scene};
use glam::{Affine3A, Vec2, Vec3};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mesh = match arguments.next() {
        Some(path) => read_obj(&std::fs::read_to_string(path)?)?,
        None => bumps(256),
    };
    let scene = on_a_plane(mesh);
    let start = Instant::now();
    let tracer = Tracer::new(&scene);
    println!("{} triangles, built in {:.2} s", tracer.triangle_count(), start.elapsed().as_secs_f64());

    let settings = Settings::of_size(128, 128);
    let view = View::new(&tracer, &scene.camera, &scene.light, &settings);
    let start = Instant::now();
    let rays: u64 = view.rows(0..settings.height).iter().map(|p| u64::from(p.rays)).sum();
    report("picture of 128 × 128 pixels", rays, start);

    if let Some(path) = arguments.next() {
        let bytes = std::fs::read(path)?;
        let floats: Vec<f32> = bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
        let segments: Vec<[Vec3; 2]> =
            floats.as_chunks::<6>().0.iter().map(|s| [Vec3::from_slice(&s[..3]), Vec3::from_slice(&s[3..])]).collect();
        let start = Instant::now();
        let hidden = tracer.occluded_all(&segments).iter().filter(|h| **h).count();
        report("segments", segments.len() as u64, start);
        println!("{hidden} of them hidden");
    }
    Ok(())
}

fn report(what: &str, rays: u64, start: Instant) {
    let seconds = start.elapsed().as_secs_f64();
    println!("{what}: {rays} shadow rays in {seconds:.2} s, {:.2} million a second", rays as f64 / seconds / 1e6);
}

/// Vertices and faces of an OBJ file, polygons as fans.
fn read_obj(text: &str) -> Result<Mesh, Box<dyn std::error::Error>> {
    let mut mesh = Mesh::default();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let p: Vec<f32> = words.take(3).map(str::parse).collect::<Result<_, _>>()?;
                mesh.positions.push(Vec3::from_slice(&p));
            }
            Some("f") => {
                let corner = |w: &str| w.split('/').next().unwrap_or_default().parse::<u32>();
                let corners: Vec<u32> = words.map(corner).collect::<Result<_, _>>()?;
                for k in 2..corners.len() {
                    mesh.indices.extend([corners[0] - 1, corners[k - 1] - 1, corners[k] - 1]);
                }
            }
            _ => {}
        }
    }
    Ok(mesh)
}

fn bumps(n: u32) -> Mesh {
    let at = |i: u32| std::f32::consts::TAU * 4.0 * i as f32 / n as f32;
    let point = |i: u32, j: u32| Vec3::new(at(i), at(i).sin() * at(j).cos(), at(j));
    let positions = (0..=n).flat_map(|j| (0..=n).map(move |i| point(i, j))).collect();
    let cells = (0..n).flat_map(|j| (0..n).map(move |i| j * (n + 1) + i));
    let indices = cells.flat_map(|k| [k, k + 1, k + n + 2, k, k + n + 2, k + n + 1]).collect();
    Mesh { positions, indices, ..Mesh::default() }
}

fn on_a_plane(mut mesh: Mesh) -> Scene {
    let bounds = mesh.bounds();
    let foot = bounds.center().with_y(bounds.min.y);
    let scale = 1.5 / bounds.size().y;
    mesh.positions.iter_mut().for_each(|p| *p = (*p - foot) * scale);
    let corners = [(-10.0, -10.0), (10.0, -10.0), (10.0, 10.0), (-10.0, 10.0)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let plane = Mesh { positions: corners.to_vec(), indices: vec![0, 1, 2, 0, 2, 3], ..Mesh::default() };
    let instance = |mesh| Instance { mesh, world_from_object: Affine3A::IDENTITY, receiver_only: false };
    Scene {
        name: "a mesh on a plane".into(),
        meshes: vec![plane, mesh],
        materials: vec![Material::default()],
        instances: vec![instance(0), instance(1)],
        camera: Camera {
            eye: Vec3::new(2.6, 2.6, 3.6),
            target: Vec3::Y * 0.7,
            up: Vec3::Y,
            fov_y_deg: 45.0,
            near: 0.1,
            far: 100.0,
        },
        light: RectLight {
            center: Vec3::new(1.5, 6.0, 1.0),
            target: Vec3::Y * 0.5,
            up: -Vec3::Z,
            size: Vec2::ONE,
            shadow_fov_deg: None,
        },
        size: None,
    }
}
