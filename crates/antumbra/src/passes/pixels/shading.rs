//! The shaded image, for people: Lambert's law with the visible part of the light, a little sky, and tone mapping.

use crate::bindings;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::input::frame::BoundFrame;
use crate::passes::pixels::geometry_buffer::GeometryBuffer;

/// A texture for [`shade`]: `Rgba8Unorm` with sRGB values.
pub fn image_texture(gpu: &Gpu, size: [u32; 2]) -> Texture {
    Texture::new(gpu, "image", TextureDescription::new(size, wgpu::TextureFormat::Rgba8Unorm, "sRGB colour"))
}

/// Shades a geometry buffer with the frame's visibility.
pub fn shade(
    recorder: &mut Recorder,
    frame: &BoundFrame,
    geometry: &GeometryBuffer,
    image: &Texture,
) -> Result<(), Error> {
    let pipeline = recorder.gpu.compute_pipeline(&ShaderKey::new("passes::pixels::shading"), "shade")?;
    let own = bindings! { base_color: &geometry.color, image: image };
    recorder.compute("image", &pipeline, &[&frame.bindings(), own], Work::Pixels(frame.size))
}
