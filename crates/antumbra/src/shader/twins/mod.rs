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
use crate::shader::ShaderKey;
use crate::testing::{Random, computed, gpu};

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
    evaluate_on(key, ("f32", text), input, stride, outputs, &[])
}

/// [`evaluate`] of a text in a shader that has more structs, features or bindings, and writes words of the named kind.
pub(crate) fn evaluate_on<T: bytemuck::Pod>(
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
    let words: Vec<T> = computed(&key, input, more, count as u32, (count * outputs * 4) as u64);
    words.chunks_exact(outputs).take(count).map(<[T]>::to_vec).collect()
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
