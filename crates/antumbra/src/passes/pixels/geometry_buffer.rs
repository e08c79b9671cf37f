//! The geometry buffer of a deferred renderer, for programs that have none.

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::RenderTarget;
use crate::gpu::recorder::{Recorder, color_target, depth_target};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::input::casters::{CLUSTER_TRIANGLES, Casters};
use crate::input::frame::View;
use crate::{bindings, gpu_struct};
use glam::{Mat4, Vec3};

gpu_struct! {
    /// The image's camera.
    pub(crate) struct ViewUniform {
        clip_from_world: Mat4,
        eye_ws: Vec3,
    }
}

/// Depth, geometric normal and base colour of the nearest surface of every pixel.
pub struct GeometryBuffer {
    /// Reversed `Depth32Float`; 0 where there is nothing.
    pub depth: Texture,
    /// `Rgba32Float`, world space, turned to the camera. Full precision: the receiver's plane is extended over the
    /// whole penumbra, where an error of the normal becomes acne.
    pub normal: Texture,
    /// `Rgba16Float`, linear; alpha 0 where there is nothing.
    pub color: Texture,
}

impl ViewUniform {
    /// Of a view.
    pub(crate) fn of(view: &View) -> ViewUniform {
        ViewUniform { clip_from_world: view.clip_from_world(), eye_ws: view.eye() }
    }
}

impl GeometryBuffer {
    /// Textures of an image's size.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Result<GeometryBuffer, Error> {
        gpu.check_size("image", size[0], size[1])?;
        Ok(GeometryBuffer::of(size, |label, description| Texture::new(gpu, label, description)))
    }

    /// Textures from the recorder's pool.
    pub(crate) fn pooled(recorder: &mut Recorder, size: [u32; 2]) -> GeometryBuffer {
        GeometryBuffer::of(size, |label, description| recorder.texture(label, description))
    }

    fn of(size: [u32; 2], mut make: impl FnMut(&'static str, TextureDescription) -> Texture) -> GeometryBuffer {
        let mut texture = |label, format| {
            let target = TextureDescription::new(size, format, label).usage(wgpu::TextureUsages::RENDER_ATTACHMENT);
            make(label, target)
        };
        GeometryBuffer {
            depth: texture("depth", wgpu::TextureFormat::Depth32Float),
            normal: texture("normal", wgpu::TextureFormat::Rgba32Float),
            color: texture("base colour", wgpu::TextureFormat::Rgba16Float),
        }
    }

    /// Draws everything, receivers and casters, in a fixed order: of coplanar surfaces the same one wins every time.
    pub fn record(&self, recorder: &mut Recorder, casters: &Casters, view: &View) -> Result<(), Error> {
        self.record_as(recorder, "geometry buffer", casters, view)
    }

    /// The same under another label.
    pub(crate) fn record_as(
        &self,
        recorder: &mut Recorder,
        label: &'static str,
        casters: &Casters,
        view: &View,
    ) -> Result<(), Error> {
        let view = recorder.uniform("view", &ViewUniform::of(view));
        let target = RenderTarget {
            colors: vec![self.normal.texture.format(), self.color.texture.format()],
            depth: Some(wgpu::CompareFunction::Greater),
            ..RenderTarget::default()
        };
        let key = ShaderKey::new("passes::pixels::geometry_buffer");
        let plain = recorder.gpu.render_pipeline(&key, &target)?;
        let textured = recorder.gpu.render_pipeline(&key.feature("textured", true), &target)?;
        let colors = [&self.normal, &self.color].map(|t| color_target(&t.view, wgpu::Color::TRANSPARENT));
        recorder.render(label, &colors, depth_target(&self.depth.view, Some(0.0)), 1, |draw| {
            for batch in casters.batches.iter().filter(|b| b.cluster_count > 0) {
                let pipeline = if batch.textured { &textured } else { &plain };
                draw.bind(pipeline, &[bindings! { image_view: &view }, &batch.bindings(casters)])?;
                draw.pass.draw(0..3 * CLUSTER_TRIANGLES, 0..batch.cluster_count);
            }
            Ok(())
        })
    }

    /// GPU memory, in bytes.
    pub fn bytes(&self) -> u64 {
        self.depth.bytes() + self.normal.bytes() + self.color.bytes()
    }
}
