//! The picture, for looking at: Lambert's law with the visible part of the light, a little sky, and tone mapping.

use crate::frame::FrameUniform;
use crate::passes::geometry_buffer::GeometryBuffer;
use crate::recorder::{Recorder, Work};
use crate::resource::Texture;
use crate::shader::ShaderKey;
use crate::{Error, Frame, Gpu, bindings};

/// Shades a geometry buffer.
pub struct Picture {
    /// `Rgba8Unorm` with sRGB values.
    pub texture: Texture,
}

impl Picture {
    /// A picture of `size` pixels.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Picture {
        let usage =
            wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        Picture { texture: Texture::new(gpu, "picture", size, 1, wgpu::TextureFormat::Rgba8Unorm, usage) }
    }

    /// Shades with the frame's visibility.
    pub fn record(&self, recorder: &mut Recorder, frame: &Frame, geometry: &GeometryBuffer) -> Result<(), Error> {
        let key = ShaderKey::new("passes::picture").with::<FrameUniform>();
        let pipeline = recorder.gpu.compute_pipeline(&key, "shade")?;
        let set = frame.bindings(bindings! {
            base_color: &geometry.color,
            picture: &self.texture,
        });
        let [width, height] = frame.geometry.size;
        recorder.compute("picture", &pipeline, &set, Work::Threads([width, height, 1]));
        Ok(())
    }
}
