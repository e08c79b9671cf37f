//! The geometry buffer: what a deferred renderer has anyway, for hosts that have none (and for the command line).

use crate::casters::{BatchLayout, CLUSTER_TRIANGLES, Casters};
use crate::frame::View;
use crate::pipeline::RenderTarget;
use crate::recorder::{Recorder, color_target, depth_target};
use crate::resource::{Texture, uniform};
use crate::shader::{HostStruct, ShaderKey};
use crate::{Error, Gpu, bindings, gpu_struct};
use glam::{Mat4, Vec3};

gpu_struct! {
    /// The picture's camera.
    pub(crate) struct ViewUniform {
        clip_from_world: Mat4,
        eye_ws: Vec3,
    }
}

/// Depth, geometric normal and base colour of the nearest surface of every pixel.
pub struct GeometryBuffer {
    /// Reversed `Depth32Float`; 0 where there is nothing.
    pub depth: Texture,
    /// `Rgba32Float`, world space, turned to the camera. Full precision: the receiver's plane is followed over the
    /// whole penumbra, and what a normal is wrong by is acne there.
    pub normal: Texture,
    /// `Rgba16Float`, linear; alpha 0 where there is nothing.
    pub color: Texture,
    view: wgpu::Buffer,
}

impl ViewUniform {
    /// Of a view.
    pub(crate) fn of(view: &View) -> ViewUniform {
        ViewUniform { clip_from_world: view.clip_from_world(), eye_ws: view.eye() }
    }
}

impl GeometryBuffer {
    /// Textures of a picture's size.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Result<GeometryBuffer, Error> {
        gpu.check_size("picture", size[0], size[1])?;
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = |label, format| Texture::new(gpu, label, size, 1, format, usage);
        Ok(GeometryBuffer {
            depth: texture("depth", wgpu::TextureFormat::Depth32Float),
            normal: texture("normal", wgpu::TextureFormat::Rgba32Float),
            color: texture("base colour", wgpu::TextureFormat::Rgba16Float),
            view: uniform(gpu, "view", &ViewUniform { clip_from_world: Mat4::IDENTITY, eye_ws: Vec3::ZERO }),
        })
    }

    /// Draws everything, receivers and casters, in a fixed order: coplanar surfaces fall out the same every time.
    pub fn record(&self, recorder: &mut Recorder, casters: &Casters, view: &View) -> Result<(), Error> {
        recorder.gpu.queue.write_buffer(&self.view, 0, &ViewUniform::of(view).uniform_bytes());
        self.draw(recorder, "geometry buffer", casters, &self.view)
    }

    /// The same by a view that is on the GPU.
    pub(crate) fn draw(
        &self,
        recorder: &mut Recorder,
        label: &str,
        casters: &Casters,
        view: &wgpu::Buffer,
    ) -> Result<(), Error> {
        let target = RenderTarget {
            colors: vec![self.normal.texture.format(), self.color.texture.format()],
            depth: Some(wgpu::CompareFunction::Greater),
            ..RenderTarget::default()
        };
        let key = ShaderKey::new("passes::geometry_buffer").with::<ViewUniform>().with::<BatchLayout>();
        let plain = recorder.gpu.render_pipeline(&key, &target)?;
        let textured = recorder.gpu.render_pipeline(&key.feature("textured", true), &target)?;
        let colors = [
            color_target(&self.normal.view, wgpu::Color::TRANSPARENT),
            color_target(&self.color.view, wgpu::Color::TRANSPARENT),
        ];
        recorder.render_pass(label, &colors, Some(depth_target(&self.depth.view)), |gpu, pass| {
            for batch in casters.batches.iter().filter(|b| b.item_count > 0) {
                let pipeline = if batch.textured { &textured } else { &plain };
                pass.set_pipeline(&pipeline.pipeline);
                let set = bindings! { picture_view: view };
                pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, set), &[]);
                pass.set_bind_group(1, &pipeline.bind_group(gpu, 1, &batch.bindings(casters)), &[]);
                pass.draw(0..3 * CLUSTER_TRIANGLES, 0..batch.item_count);
            }
        });
        Ok(())
    }

    /// GPU memory, in bytes.
    pub fn bytes(&self) -> u64 {
        self.depth.bytes() + self.normal.bytes() + self.color.bytes()
    }
}
