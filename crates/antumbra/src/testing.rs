//! Helpers of the tests inside the library.

use crate::bindings;
use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::device::{AdapterChoice, Gpu};
use crate::gpu::readback::read_buffer;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{Resources, buffer_of, storage_buffer};
use crate::gpu::shader::ShaderKey;
use crate::scene::SceneRenderer;
use pollster::block_on;
use std::sync::OnceLock;

/// The device that all tests share. A machine without an adapter fails the test.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| {
        block_on(Gpu::new(&AdapterChoice::Best)).unwrap_or_else(|e| {
            panic!("{e}\nThis test needs a GPU or a software one: `cargo xtask test` installs one.")
        })
    })
}

/// Records and submits, with every validation error returned.
pub fn submit(record: impl FnOnce(&mut Recorder) -> Result<(), Error>) {
    submit_with(&mut Resources::default(), record);
}

/// The same with resources of earlier frames.
pub fn submit_with(resources: &mut Resources, record: impl FnOnce(&mut Recorder) -> Result<(), Error>) {
    let gpu = gpu();
    let result = block_on(gpu.checked(|| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        record(&mut Recorder::new(gpu, &mut encoder, resources))?;
        gpu.queue.submit([encoder.finish()]);
        gpu.wait()
    }));
    result.unwrap_or_else(|e| panic!("{e}"));
}

/// Runs `fn each` of a shader with so many threads on numbers (`input`), and reads the bytes that it writes (`output`).
pub fn computed<T: bytemuck::Pod>(
    key: &ShaderKey,
    input: &[f32],
    more: &[Binding],
    threads: u32,
    bytes: u64,
) -> Vec<T> {
    let pipeline = gpu().compute_pipeline(key, "each").unwrap_or_else(|e| panic!("{e}"));
    let source = buffer_of(gpu(), "input", bytemuck::cast_slice(input), wgpu::BufferUsages::STORAGE);
    let target = storage_buffer(gpu(), "output", bytes);
    submit(|recorder| {
        let own = bindings! { input: &source, output: &target };
        recorder.compute("twin", &pipeline, &[own, more], Work::Threads([threads, 1, 1]))
    });
    bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu(), &target)).unwrap_or_else(|e| panic!("{e}")))
}

/// Runs an entry point of a kernel at each pixel of a scene's frame and reads the numbers that it writes (`output`).
pub fn at_pixels(
    renderer: &SceneRenderer,
    kernel: &str,
    entry: &'static str,
    more: &[Binding],
    bytes: u64,
) -> Vec<f32> {
    let gpu = gpu();
    let pipeline = gpu.compute_pipeline(&ShaderKey::of_source(kernel), entry).unwrap_or_else(|e| panic!("{e}"));
    let output = storage_buffer(gpu, "output", bytes);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    renderer.record_geometry(gpu, &mut encoder, None).expect("draws");
    let mut resources = Resources::default();
    let mut recorder = Recorder::new(gpu, &mut encoder, &mut resources);
    let frame = renderer.frame.bind(&mut recorder).unwrap_or_else(|e| panic!("{e}"));
    let set = [&frame.bindings()[..], bindings! { output: &output }, more];
    recorder.compute("pixels", &pipeline, &set, Work::Pixels(frame.size)).unwrap_or_else(|e| panic!("{e}"));
    drop(recorder);
    gpu.queue.submit([encoder.finish()]);
    bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu, &output)).expect("reads"))
}

/// Reproducible numbers in [0, 1).
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let x = (self.0 ^ (self.0 >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (x >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In [low, high).
    pub fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// From 10^low to 10^high, every decade as often as any other.
    pub fn decades(&mut self, low: f32, high: f32) -> f32 {
        10f32.powf(self.within(low, high))
    }

    /// Uniform over all directions.
    pub fn direction(&mut self) -> glam::Vec3 {
        let (z, turn) = (self.within(-1.0, 1.0), self.within(0.0, std::f32::consts::TAU));
        let r = (1.0 - z * z).sqrt();
        glam::Vec3::new(r * turn.cos(), r * turn.sin(), z)
    }
}

/// Runs `fn evaluate(at: u32, to: u32)` of a WESL text for every input of `stride` numbers: it reads `input[at]` and
/// on, writes `output[to]` and on.
pub fn evaluate(text: &str, input: &[f32], stride: usize, outputs: usize) -> Vec<Vec<f32>> {
    evaluate_variant(text, &[], input, stride, outputs)
}

/// [`evaluate`] with features on.
pub fn evaluate_variant(
    text: &str,
    features: &[&'static str],
    input: &[f32],
    stride: usize,
    outputs: usize,
) -> Vec<Vec<f32>> {
    let key = ShaderKey { features: features.iter().copied().collect(), ..ShaderKey::default() };
    evaluate_on(key, ("f32", text), input, stride, outputs, &[])
}

/// [`evaluate`] of a text in a shader that has more features or bindings, and writes words of the named kind.
pub fn evaluate_on<T: bytemuck::Pod>(
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
var<storage, read> input: array<f32>;
var<storage, read_write> output: array<{kind}>;
@compute @workgroup_size(64) fn each(@builtin(global_invocation_id) id: vec3<u32>) {{
    if id.x < {count}u {{ evaluate(id.x * {stride}u, id.x * {outputs}u); }}
}}"
    );
    let ShaderKey { features, parts, target, .. } = key;
    let key = ShaderKey { features, parts, target, ..ShaderKey::of_source(&kernel) };
    let words: Vec<T> = computed(&key, input, more, count as u32, (count * outputs * 4) as u64);
    words.chunks_exact(outputs).take(count).map(<[T]>::to_vec).collect()
}

/// The largest error and what made it, for a message.
#[derive(Debug, Default)]
#[expect(dead_code, reason = "the input is for people")]
pub struct Worst {
    pub error: f64,
    pub input: String,
}

impl Worst {
    pub fn see(&mut self, error: f64, input: impl FnOnce() -> String) {
        // Not a number is the worst of all.
        if error > self.error || error.is_nan() {
            *self = Worst { error: if error.is_nan() { f64::INFINITY } else { error }, input: input() };
        }
    }
}
