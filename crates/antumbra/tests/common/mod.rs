//! One device for all tests of a binary, pictures, truths and small meshes.
#![allow(dead_code, reason = "every test file uses another part")]

pub mod closed_form;

use antumbra::scene::SceneRenderer;
use antumbra::{AdapterChoice, Error, Gpu, Shadows, Spec};
use antumbra_metrics::{Image, Metrics, metrics};
use antumbra_reference::{Reference, Settings, trace};
use antumbra_scene::{Camera, Instance, Material, Mesh, RectLight, Scene};
use glam::{Affine3A, Vec2, Vec3};
use pollster::block_on;
use std::sync::{OnceLock, atomic::AtomicBool};

/// The device that all tests share, and with it the pipelines. A machine without an adapter fails the test: a picture
/// that nobody drew is no picture that was found right.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| {
        block_on(Gpu::new(&AdapterChoice::Best)).unwrap_or_else(|e| {
            panic!("{e}\nThis test needs a GPU or a software one: `cargo xtask test` installs one.")
        })
    })
}

/// The SPEC of a technique with small and few maps, if it has them.
pub fn quick(info: &antumbra::TechniqueInfo) -> String {
    let small = [("map", 256), ("samples", 6), ("maps", 9)];
    let its = small.iter().filter(|(key, _)| info.settings.iter().any(|s| s.key == *key));
    let values: Vec<String> = its.map(|(key, value)| format!("{key}={value}")).collect();
    format!("{}:{}", info.name, values.join(","))
}

/// A technique from its SPEC.
pub fn technique(spec: &str) -> Shadows {
    let parsed = spec.parse::<Spec>().unwrap_or_else(|e| panic!("{e}"));
    Shadows::from_spec(gpu(), &parsed).unwrap_or_else(|e| panic!("{spec}: {e}"))
}

/// A scene with its geometry buffer drawn.
pub fn drawn(scene: &Scene, size: [u32; 2]) -> SceneRenderer {
    let renderer = SceneRenderer::new(gpu(), scene, size).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    submit(|encoder| renderer.record_geometry(gpu(), encoder, None)).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    renderer
}

/// Records and submits, with every validation error returned.
pub fn submit(record: impl FnOnce(&mut wgpu::CommandEncoder) -> Result<(), Error>) -> Result<(), Error> {
    let gpu = gpu();
    block_on(gpu.checked(|| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        record(&mut encoder)?;
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }))
}

/// The visibility of a drawn scene by a technique. The texture is overwritten before, so that a pixel that nobody
/// writes is seen.
pub fn shadowed(renderer: &SceneRenderer, shadows: &mut Shadows) -> Result<Vec<f32>, Error> {
    let [width, height] = renderer.frame.size;
    renderer.write_visibility(gpu(), &vec![-7.0; (width * height) as usize]);
    submit(|encoder| shadows.record(gpu(), encoder, &renderer.frame))?;
    block_on(renderer.read_visibility(gpu()))
}

/// Visibility of a scene by a technique.
pub fn visibility(scene: &Scene, spec: &str, size: [u32; 2]) -> Vec<f32> {
    shadowed(&drawn(scene, size), &mut technique(spec)).unwrap_or_else(|e| panic!("{} by {spec}: {e}", scene.name))
}

/// The truth at the middle of every pixel, which is where techniques look.
pub fn truth(scene: &Scene, size: [u32; 2], light_samples: u32) -> Reference {
    let settings = Settings { light_samples, pixel_samples: 1, ..Settings::of_size(size[0], size[1]) };
    trace(scene, &settings, &|_| (), &AtomicBool::new(false)).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// How far a visibility is from the truth.
pub fn compared(visibility: &[f32], truth: &Reference) -> Metrics {
    let image = |data| Image::new(truth.width, truth.height, data).expect("of the truth's size");
    metrics(image(visibility), image(&truth.visibility), &truth.valid).unwrap_or_else(|e| panic!("{e}"))
}

/// A built-in scene.
pub fn builtin(spec: &str) -> Scene {
    antumbra_scene::builtin::build(spec).unwrap_or_else(|e| panic!("{e}"))
}

/// Every mesh once, where it is, of the default material. The first is the ground, which casts nothing.
pub fn scene(meshes: Vec<Mesh>, camera: Camera, light: RectLight) -> Scene {
    let instances = (0..meshes.len())
        .map(|mesh| Instance { mesh, world_from_object: Affine3A::IDENTITY, receiver_only: mesh == 0 })
        .collect();
    Scene { name: "test".into(), meshes, materials: vec![Material::default()], instances, camera, light, size: None }
}

/// A camera that looks from `eye` to `target`.
pub fn camera(eye: [f32; 3], target: [f32; 3], fov_y_deg: f32) -> Camera {
    let (eye, target) = (Vec3::from(eye), Vec3::from(target));
    let up = if (target - eye).normalize().y < -0.999 { Vec3::NEG_Z } else { Vec3::Y };
    Camera { eye, target, up, fov_y_deg, near: 0.05, far: 100.0 }
}

/// A square light over `target` or aside of it.
pub fn light(center: [f32; 3], target: [f32; 3], edge: f32) -> RectLight {
    let (center, target) = (Vec3::from(center), Vec3::from(target));
    let up = if (target - center).normalize().y < -0.999 { Vec3::NEG_Z } else { Vec3::Y };
    RectLight { center, target, up, size: Vec2::splat(edge), shadow_fov_deg: None }
}

/// A horizontal rectangle around `center`.
pub fn quad(center: [f32; 3], half: [f32; 2]) -> Mesh {
    let at = |x: f32, z: f32| Vec3::from(center) + Vec3::new(x * half[0], 0.0, z * half[1]);
    let positions = vec![at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)];
    Mesh { positions, indices: vec![0, 1, 2, 0, 2, 3], ..Mesh::default() }
}

/// The ground.
pub fn ground(half: f32) -> Mesh {
    quad([0.0; 3], [half; 2])
}

/// A closed box.
pub fn cuboid(min: [f32; 3], max: [f32; 3]) -> Mesh {
    let positions = antumbra::Aabb { min: min.into(), max: max.into() }.corners().to_vec();
    // Corner i has bit 0 for x, 1 for y, 2 for z.
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let indices = faces.iter().flat_map(|f| [f[0], f[1], f[2], f[0], f[2], f[3]]).collect();
    Mesh { positions, indices, ..Mesh::default() }
}

/// A closed, bumpy ball: an icosphere whose vertices are moved along their normals.
pub fn bumpy_ball(center: [f32; 3], radius: f32, subdivisions: u32) -> Mesh {
    let (mut positions, mut indices) = icosahedron();
    for _ in 0..subdivisions {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push(((positions[a as usize] + positions[b as usize]) / 2.0).normalize());
                positions.len() as u32 - 1
            })
        };
        let split = |t: &[u32]| {
            let (ab, bc, ca) = (middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0]));
            [t[0], ab, ca, t[1], bc, ab, t[2], ca, bc, ab, bc, ca]
        };
        indices = indices.chunks_exact(3).flat_map(split).collect();
    }
    let bump =
        |p: Vec3| 1.0 + 0.22 * (3.1 * p.x).sin() * (2.3 * p.y + 1.0).cos() + 0.05 * (11.0 * p.z + 4.0 * p.x).sin();
    let positions = positions.iter().map(|p| Vec3::from(center) + *p * radius * bump(*p)).collect();
    Mesh { positions, indices, ..Mesh::default() }
}

fn icosahedron() -> (Vec<Vec3>, Vec<u32>) {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let mut positions = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        positions.push(Vec3::new(a, b, 0.0).normalize());
    }
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        positions.push(Vec3::new(0.0, a, b).normalize());
    }
    for (a, b) in [(g, -1.0), (g, 1.0), (-g, -1.0), (-g, 1.0)] {
        positions.push(Vec3::new(a, 0.0, b).normalize());
    }
    let indices = vec![
        0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3, 9, 4, 3,
        4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9, 4, 9, 5, 2, 4, 11, 6, 2, 10, 8, 6, 7, 9, 8, 1,
    ];
    (positions, indices)
}
