//! The textures that the viewer draws into.

use crate::loaded_scene::LoadedScene;
use crate::show::{Show, Shown};
use antumbra::gpu::recorder::Recorder;
use antumbra::gpu::resources::Resources;
use antumbra::gpu::texture::{Texture, TextureDescription};
use antumbra::passes::pixels::geometry_buffer::GeometryBuffer;
use antumbra::passes::pixels::shading::{image_texture, shade};
use antumbra::{Casters, Error, Frame, FrameDescriptor, Gpu, RectLight, ShadowFrustum, Shadows, Timer, View};
use antumbra_scene::Scene;
use std::sync::Arc;

/// Textures of one size: shared ones and those of each half.
pub struct RenderTargets {
    /// Pixels.
    pub size: [u32; 2],
    /// Geometry buffer.
    pub geometry: GeometryBuffer,
    /// Left and right.
    pub halves: [Half; 2],
    /// `R32Float`: the truth; negative where errors are not measured.
    pub truth: Texture,
    resources: Resources,
}

/// The targets of a half.
pub struct Half {
    /// Input of its technique.
    pub frame: Frame,
    /// `R32Float`: output of its technique.
    pub visibility: Texture,
    /// The image that is shown.
    pub image: Texture,
    resources: Resources,
}

const VALUES: wgpu::TextureUsages =
    wgpu::TextureUsages::STORAGE_BINDING.union(wgpu::TextureUsages::COPY_SRC).union(wgpu::TextureUsages::COPY_DST);

impl RenderTargets {
    /// Targets of `size` pixels whose content is undefined.
    pub fn new(gpu: &Gpu, scene: &Scene, casters: Arc<Casters>, size: [u32; 2]) -> Result<RenderTargets, Error> {
        let geometry = GeometryBuffer::new(gpu, size)?;
        let values = |label| {
            let description = TextureDescription::new(size, wgpu::TextureFormat::R32Float, label);
            Texture::new(gpu, label, description.usage(VALUES))
        };
        let view = View::of_camera(&scene.camera, size);
        let half = |label| {
            let visibility = values(label);
            let descriptor = FrameDescriptor {
                view,
                light: scene.light,
                casters: &casters,
                depth: &geometry.depth.view,
                normals: &geometry.normal.view,
                visibility: &visibility.view,
            };
            let frame = Frame::new(gpu, &descriptor)?;
            Ok::<_, Error>(Half { frame, visibility, image: image_texture(gpu, size), resources: Resources::default() })
        };
        let halves = [half("visibility, left")?, half("visibility, right")?];
        Ok(RenderTargets { size, halves, truth: values("truth"), geometry, resources: Resources::default() })
    }

    /// Moves camera, light and occluders.
    pub fn update(&mut self, loaded: &LoadedScene, view: View, light: RectLight, frustum: ShadowFrustum) {
        for half in &mut self.halves {
            half.frame.casters = loaded.casters();
            half.frame.update(view, light, frustum);
        }
    }

    /// Draws the surfaces that both halves show.
    pub fn record_geometry(&mut self, gpu: &Gpu, casters: &Casters, view: &View) -> Result<(), Error> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.geometry.record(&mut Recorder::new(gpu, &mut encoder, &mut self.resources), casters, view)?;
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// GPU memory of the geometry buffer, bytes.
    pub fn bytes(&self) -> u64 {
        self.geometry.bytes()
    }

    /// Marks the whole truth as not measured.
    pub fn forget_truth(&self, gpu: &Gpu) {
        let nothing = vec![-2.0; self.size[0] as usize * self.size[1] as usize];
        write(gpu, &self.truth, &nothing);
    }

    /// Uploads the truth, negative where errors are not measured.
    pub fn write_truth(&self, gpu: &Gpu, image: &crate::truth::TracedImage) {
        let values = image.visibility.iter().zip(&image.valid);
        let marked: Vec<f32> = values.map(|(v, valid)| if *valid { *v } else { -1.0 - *v }).collect();
        write(gpu, &self.truth, &marked);
    }
}

impl Half {
    /// Replaces the visibility, by the truth for example.
    pub fn write_visibility(&self, gpu: &Gpu, values: &[f32]) {
        write(gpu, &self.visibility, values);
    }

    /// Records and submits the technique, if any, and the displayed image.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        timer: &mut Timer,
        shadows: Option<&mut Shadows>,
        geometry: &GeometryBuffer,
        shown: (&Shown, Show, &Texture),
    ) -> Result<(), Error> {
        if let Some(shadows) = shadows {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            shadows.record_timed(gpu, &mut encoder, &self.frame, Some(timer))?;
            timer.submit(gpu, encoder)?;
        }
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let (pass, show, truth) = shown;
        match show {
            Show::Image => {
                let mut recorder = Recorder::new(gpu, &mut encoder, &mut self.resources);
                let frame = self.frame.bind(&mut recorder)?;
                shade(&mut recorder, &frame, geometry, &self.image)?;
            }
            _ => pass.record(gpu, &mut encoder, show, &self.visibility, truth, &self.image),
        }
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }
}

fn write(gpu: &Gpu, texture: &Texture, values: &[f32]) {
    let t = &texture.texture;
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(t.width() * 4), rows_per_image: None };
    gpu.queue.write_texture(t.as_image_copy(), bytemuck::cast_slice(values), layout, t.size());
}
