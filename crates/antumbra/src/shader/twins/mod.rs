//! Shader functions that carry a formula, held against twins in double precision over random inputs.
//!
//! A kernel for a test is written where the test is: `package::host` is the module that a key's `structs` text makes, so
//! nothing of it is in the library.

mod footprint;
mod frame;
mod horizon;
mod layers;
mod light_lattice;
mod mask;
mod moments;
mod patches;
mod penumbra;
mod ray_to_center;
mod smooth_kernel;
mod summed_area;

use crate::pipeline::Binding;
use crate::recorder::Work;
use crate::resource::{buffer_of, read_buffer, storage_buffer};
use crate::shader::ShaderKey;
use crate::{AdapterChoice, Gpu, Recorder, bindings};
use pollster::block_on;
use std::sync::OnceLock;

/// The device that all tests share. A machine without an adapter fails the test.
pub(crate) fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| {
        block_on(Gpu::new(&AdapterChoice::Best)).unwrap_or_else(|e| {
            panic!("{e}\nThis test needs a GPU or a software one: `cargo xtask test` installs one.")
        })
    })
}

/// Runs `fn evaluate(at: u32, to: u32)` of a WESL text for every input of `stride` numbers: it reads `input[at]` and on,
/// writes `output[to]` and on.
fn evaluate(text: &str, input: &[f32], stride: usize, outputs: usize) -> Vec<Vec<f32>> {
    evaluate_variant(text, &[], input, stride, outputs)
}

/// [`evaluate`] with features on.
fn evaluate_variant(
    text: &str,
    features: &[&'static str],
    input: &[f32],
    stride: usize,
    outputs: usize,
) -> Vec<Vec<f32>> {
    let key = ShaderKey { features: features.to_vec(), ..ShaderKey::new("host") };
    evaluate_on(gpu(), key, ("f32", text), input, stride, outputs, &[])
}

/// [`evaluate`] of a text in a shader that has more structs, features or bindings, and writes words of the named kind.
pub(crate) fn evaluate_on<T: bytemuck::Pod>(
    gpu: &Gpu,
    key: ShaderKey,
    (kind, text): (&str, &str),
    input: &[f32],
    stride: usize,
    outputs: usize,
    more: &[Binding],
) -> Vec<Vec<T>> {
    let count = input.len() / stride;
    let kernel = format!(
        "{text}
        @group(0) @binding(30) var<storage, read> input: array<f32>;
        @group(0) @binding(31) var<storage, read_write> output: array<{kind}>;
        @compute @workgroup_size(64) fn each(@builtin(global_invocation_id) id: vec3<u32>) {{
            if id.x < {count}u {{ evaluate(id.x * {stride}u, id.x * {outputs}u); }}
        }}
        {}",
        key.structs
    );
    let key = ShaderKey { structs: kernel, ..key };
    let pipeline = gpu.compute_pipeline(&key, "each").unwrap_or_else(|e| panic!("{e}"));
    let source = buffer_of(gpu, "input", bytemuck::cast_slice(input), wgpu::BufferUsages::STORAGE);
    let target = storage_buffer(gpu, "output", (count * outputs * 4) as u64);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let set = [bindings! { input: &source, output: &target }, more].concat();
    Recorder::new(gpu, &mut encoder).compute("twin", &pipeline, &set, Work::Threads([count as u32, 1, 1]));
    gpu.queue.submit([encoder.finish()]);
    let words: Vec<T> = bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu, &target)).expect("reads"));
    words.chunks_exact(outputs).take(count).map(<[T]>::to_vec).collect()
}

/// Reproducible numbers in [0, 1).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let x = (self.0 ^ (self.0 >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (x >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In [low, high).
    fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// From 10^low to 10^high, every decade as often as any other.
    fn decades(&mut self, low: f32, high: f32) -> f32 {
        10f32.powf(self.within(low, high))
    }

    /// Uniform over all directions.
    fn direction(&mut self) -> glam::Vec3 {
        let (z, turn) = (self.within(-1.0, 1.0), self.within(0.0, std::f32::consts::TAU));
        let r = (1.0 - z * z).sqrt();
        glam::Vec3::new(r * turn.cos(), r * turn.sin(), z)
    }
}

/// The largest error and what made it, for a message.
#[derive(Debug, Default)]
#[expect(dead_code, reason = "the input is for people")]
struct Worst {
    error: f64,
    input: String,
}

impl Worst {
    fn see(&mut self, error: f64, input: impl FnOnce() -> String) {
        // Not a number is the worst of all.
        if error > self.error || error.is_nan() {
            *self = Worst { error: if error.is_nan() { f64::INFINITY } else { error }, input: input() };
        }
    }
}
