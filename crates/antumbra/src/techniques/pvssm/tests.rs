//! The technique's parts against twins on the CPU, and what must hold whatever the tiles are.

mod conservative;
mod plans;
mod prediction;
mod seams;

use crate::scene::SceneRenderer;
use crate::{AdapterChoice, Error, Gpu, Recorder, Spec, Technique};
use antumbra_scene::{Scene, builtin};
use pollster::block_on;
use std::sync::OnceLock;

/// The device that all tests share. A machine without an adapter fails the test.
fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| {
        block_on(Gpu::new(&AdapterChoice::Best)).unwrap_or_else(|e| {
            panic!("{e}\nThis test needs a GPU or a software one: `cargo xtask test` installs one.")
        })
    })
}

/// Reproducible numbers in [0, 1).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let x = (self.0 ^ (self.0 >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (x >> 40) as f32 / (1u64 << 24) as f32
    }

    fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }
}

/// Records and submits, with every validation error returned.
fn submit(record: impl FnOnce(&mut Recorder) -> Result<(), Error>) {
    let gpu = gpu();
    let result = block_on(gpu.checked(|| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        record(&mut Recorder::new(gpu, &mut encoder))?;
        gpu.queue.submit([encoder.finish()]);
        gpu.wait()
    }));
    result.unwrap_or_else(|e| panic!("{e}"));
}

/// A built-in scene with its geometry buffer drawn.
fn drawn(scene: &Scene, size: [u32; 2]) -> SceneRenderer {
    let renderer = SceneRenderer::new(gpu(), scene, size).unwrap_or_else(|e| panic!("{e}"));
    submit(|recorder| renderer.record_geometry(recorder));
    renderer
}

fn scene(spec: &str) -> Scene {
    builtin::build(spec).unwrap_or_else(|e| panic!("{e}"))
}

fn technique(spec: &str) -> Box<dyn Technique> {
    spec.parse::<Spec>().unwrap_or_else(|e| panic!("{e}")).make(gpu()).unwrap_or_else(|e| panic!("{spec}: {e}"))
}

/// What a technique makes of a drawn scene.
fn shadowed(renderer: &SceneRenderer, technique: &mut dyn Technique) -> Vec<f32> {
    let [width, height] = renderer.frame.geometry.size;
    renderer.write_visibility(gpu(), &vec![-7.0; (width * height) as usize]);
    submit(|recorder| renderer.record_shadow(technique, recorder));
    block_on(renderer.read_visibility(gpu())).unwrap_or_else(|e| panic!("{e}"))
}

/// A figure of the last frame.
fn figure(technique: &dyn Technique, name: &str) -> f64 {
    let figures = block_on(technique.figures(gpu())).unwrap_or_else(|e| panic!("{e}"));
    figures.iter().find(|(n, _)| *n == name).unwrap_or_else(|| panic!("no figure {name}")).1
}
