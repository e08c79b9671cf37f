//! The shaded image, for people: Lambert's law with the visible part of the light, a little sky, and tone mapping.

use crate::bindings;
use crate::error::Error;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::input::frame::Frame;
use crate::passes::pixels::geometry_buffer::GeometryBuffer;

/// Shades a geometry buffer with the frame's visibility: `Rgba8Unorm` with sRGB values.
pub fn shade(recorder: &mut Recorder, frame: &Frame, geometry: &GeometryBuffer) -> Result<Texture, Error> {
    let pipeline = recorder.gpu.compute_pipeline(&ShaderKey::new("passes::pixels::picture"), "shade")?;
    let description = TextureDescription::new(frame.size, wgpu::TextureFormat::Rgba8Unorm, "sRGB colour");
    let image = recorder.texture("image", description);
    let own = bindings! { base_color: &geometry.color, picture: &image };
    recorder.compute("image", &pipeline, &[&frame.bindings(), own], Work::Pixels(frame.size))?;
    Ok(image)
}
