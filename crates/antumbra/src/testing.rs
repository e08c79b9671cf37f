//! What the tests inside the library share.

use crate::pipeline::Binding;
use crate::recorder::Work;
use crate::resource::{buffer_of, read_buffer, storage_buffer};
use crate::shader::ShaderKey;
use crate::{AdapterChoice, Error, Gpu, Recorder, bindings};
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
    let gpu = gpu();
    let result = block_on(gpu.checked(|| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        record(&mut Recorder::new(gpu, &mut encoder))?;
        gpu.queue.submit([encoder.finish()]);
        gpu.wait()
    }));
    result.unwrap_or_else(|e| panic!("{e}"));
}

/// Runs `fn each`, which a key's text has, with so many threads on numbers (`input`, storage, binding 30), and reads the
/// bytes that it writes (`output`, storage, binding 31).
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
    let mut set = more.to_vec();
    set.extend_from_slice(bindings! { input: &source, output: &target });
    submit(|recorder| {
        recorder.compute("twin", &pipeline, &set, Work::Threads([threads, 1, 1]));
        Ok(())
    });
    bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu(), &target)).unwrap_or_else(|e| panic!("{e}")))
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
