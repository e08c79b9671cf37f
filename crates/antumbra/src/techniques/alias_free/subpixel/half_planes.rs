//! The table of half-planes: for each line through a pixel the samples on its side [Pan 2009, section 3.4; Eisemann, Décoret
//! 2007].

use super::pattern::Pattern;
use crate::gpu::device::Gpu;
use crate::gpu::texture::{Texture, TextureDescription};
use glam::{DVec2, DVec3};

/// Number of directions in a half turn, and of distances.
pub const STEPS: u32 = 256;

/// The samples of a pixel, a bit each, as the shader packs them.
pub type Samples = u128;

/// All samples of a pattern.
pub fn all(pattern: &Pattern) -> Samples {
    Samples::MAX >> (Samples::BITS as usize - pattern.samples().len())
}

/// The samples s with h.x s.x + h.y s.y + h.z >= 0, exactly.
pub fn exact(pattern: &Pattern, h: DVec3) -> Samples {
    let inside = |s: &DVec2| h.truncate().dot(*s) + h.z >= 0.0;
    pattern.samples().iter().enumerate().fold(0, |bits, (i, s)| bits | Samples::from(inside(s)) << i)
}

/// The half-plane in the middle of an entry of the table. A line is h / (|h.x| + |h.y|) with h.x >= 0: columns are h.y from
/// -1 to 1, rows h.z from -1/2 to 1/2, beyond which no line crosses the pixel. Half-planes with h.x < 0 are the complements,
/// so that the two sides of a line leave no gap.
pub fn entry(column: u32, row: u32) -> DVec3 {
    let at = |k: u32| (f64::from(k) + 0.5) / f64::from(STEPS);
    let y = 2.0 * at(column) - 1.0;
    DVec3::new(1.0 - y.abs(), y, at(row) - 0.5)
}

/// The table of a pattern: `STEPS` x `STEPS` texels of one word per 32 samples.
pub fn table(gpu: &Gpu, pattern: &Pattern) -> Texture {
    let words = pattern.words();
    let format = match words {
        1 => wgpu::TextureFormat::R32Uint,
        2 => wgpu::TextureFormat::Rg32Uint,
        _ => wgpu::TextureFormat::Rgba32Uint,
    };
    let texels = (0..STEPS).flat_map(|row| (0..STEPS).map(move |column| (column, row)));
    let bits: Vec<u32> = texels
        .flat_map(|(column, row)| {
            let samples = exact(pattern, entry(column, row));
            (0..words).map(move |w| (samples >> (32 * w)) as u32)
        })
        .collect();
    let description = TextureDescription::new([STEPS; 2], format, "samples on the side of each line");
    let texture = Texture::new(gpu, "table of half-planes", description.usage(wgpu::TextureUsages::COPY_DST));
    let row = STEPS * words as u32 * 4;
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let size = texture.texture.size();
    gpu.queue.write_texture(texture.texture.as_image_copy(), bytemuck::cast_slice(&bits), layout, size);
    texture
}
