//! A scene on the GPU, and the pictures of the two halves of the screen.

use crate::fitter::Fitter;
use crate::show::{Show, Shown};
use antumbra::gpu::recorder::Recorder;
use antumbra::gpu::resources::Resources;
use antumbra::gpu::texture::{Texture, TextureDescription};
use antumbra::gpu::timer::PassTime;
use antumbra::input::casters::Role;
use antumbra::passes::pixels::geometry_buffer::GeometryBuffer;
use antumbra::passes::pixels::shading::{image_texture, shade};
use antumbra::scene::{Arranged, Placed};
use antumbra::{Casters, Error, Frame, FrameDescriptor, Gpu, RectLight, ShadowFrustum, Shadows, Timer, View};
use antumbra_scene::{Aabb, Instance, Scene};
use glam::{Affine3A, Quat, Vec3};
use std::sync::Arc;

/// A scene that is open.
pub struct Stage {
    /// As it was opened.
    pub scene: Arc<Scene>,
    /// Where everything stands now.
    pub instances: Vec<Instance>,
    /// Changes with the pose.
    pub pose: u64,
    /// Box around everything, where it stood at first.
    pub bounds: Aabb,
    /// Triangles over all instances.
    pub triangles: usize,
    placed: Placed,
    casters: Arc<Casters>,
    angle: f32,
    fitter: Fitter,
}

impl Stage {
    /// Uploads a scene and compiles what every picture needs. Takes a while: not for the thread that draws.
    pub fn new(gpu: &Gpu, scene: Arc<Scene>, arranged: Arranged, pose: u64) -> Result<Stage, Error> {
        let placed = Placed::upload_arranged(gpu, &scene, arranged)?;
        let casters = Arc::new(placed.casters.clone());
        let stage = Stage {
            bounds: scene.bounds(),
            triangles: scene.triangle_count(),
            instances: scene.instances.clone(),
            fitter: Fitter::new(&scene),
            scene,
            pose,
            placed,
            casters,
            angle: 0.0,
        };
        let small = Canvas::new(gpu, &stage, [8, 8])?;
        let half = &small.halves[0];
        gpu.submit(|recorder| {
            small.geometry.record(recorder, &stage.casters, &half.frame.view)?;
            shade(recorder, &half.frame, &small.geometry, &half.image)
        })?;
        Ok(stage)
    }

    /// Makes a technique and compiles all that it will need. Takes a while: not for the thread that draws.
    pub async fn technique(
        gpu: &Gpu,
        scene: &Scene,
        casters: Arc<Casters>,
        spec: &antumbra::Spec,
    ) -> Result<Shadows, Error> {
        Stage::compile(gpu, scene, casters, spec, false).await?;
        gpu.checked(|| Shadows::from_spec(gpu, spec)).await
    }

    /// Compiles all that a technique will need, where somebody looks inside or not. Takes a while: not for the thread that
    /// draws.
    pub async fn compile(
        gpu: &Gpu,
        scene: &Scene,
        casters: Arc<Casters>,
        spec: &antumbra::Spec,
        captured: bool,
    ) -> Result<(), Error> {
        gpu.checked(|| {
            let small = Canvas::of(gpu, scene, casters, [8, 8])?;
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            // One that is thrown away: it believes in maps that were recorded and never drawn.
            let mut technique = Shadows::from_spec(gpu, spec)?;
            technique.set_debug_capture(captured);
            technique.record(gpu, &mut encoder, &small.halves[0].frame)
        })
        .await
    }

    /// What techniques are given.
    pub fn casters(&self) -> Arc<Casters> {
        self.casters.clone()
    }

    /// True if something can be moved.
    pub fn has_occluders(&self) -> bool {
        self.placed.roles.contains(&Role::Caster)
    }

    /// Turns all occluders about the vertical line through their middle, in radians from where they stood at first.
    pub fn turn_occluders(&mut self, gpu: &Gpu, angle: f32, pose: u64) {
        if angle == self.angle || !self.has_occluders() {
            return;
        }
        let mut instances = self.scene.instances.clone();
        let middle = self.placed.casters.occluder_bounds().center();
        let turn = Affine3A::from_translation(middle)
            * Affine3A::from_quat(Quat::from_axis_angle(Vec3::Y, angle))
            * Affine3A::from_translation(-middle);
        let occluders = instances.iter_mut().zip(&self.placed.roles).filter(|(_, role)| **role == Role::Caster);
        for (instance, _) in occluders {
            instance.world_from_object = turn * instance.world_from_object;
        }
        self.casters = Arc::new(self.placed.moved(gpu, &instances));
        (self.instances, self.pose, self.angle) = (instances, pose, angle);
    }

    /// The scene with everything where it stands now, for tracing.
    pub fn posed(&self) -> Arc<Scene> {
        if self.angle == 0.0 {
            return self.scene.clone();
        }
        Arc::new(Scene { instances: self.instances.clone(), ..Scene::clone(&self.scene) })
    }

    /// What shadow maps look at. Of a large scene it is a wide one until it could be fitted in the background: then
    /// `wake` is called.
    pub fn frustum(&mut self, view: View, light: RectLight, wake: impl Fn() + Send + 'static) -> ShadowFrustum {
        let fitted = self.fitter.fit((view, light, self.pose), &self.instances, wake);
        fitted.unwrap_or_else(|| ShadowFrustum::around(&light, &self.casters.bounds()))
    }
}

/// Textures of one size: what both halves share and what each has.
pub struct Canvas {
    /// Pixels.
    pub size: [u32; 2],
    /// Surfaces, the host's part.
    pub geometry: GeometryBuffer,
    /// Left and right.
    pub halves: [Half; 2],
    /// `R32Float`: the truth as far as it is known; under 0 where errors are not measured.
    pub truth: Texture,
    resources: Resources,
}

/// One picture.
pub struct Half {
    /// What its technique is given.
    pub frame: Frame,
    /// `R32Float`: what its technique fills.
    pub visibility: Texture,
    /// The image that is shown.
    pub image: Texture,
    resources: Resources,
}

const VALUES: wgpu::TextureUsages =
    wgpu::TextureUsages::STORAGE_BINDING.union(wgpu::TextureUsages::COPY_SRC).union(wgpu::TextureUsages::COPY_DST);

impl Canvas {
    /// Empty pictures.
    pub fn new(gpu: &Gpu, stage: &Stage, size: [u32; 2]) -> Result<Canvas, Error> {
        Canvas::of(gpu, &stage.scene, stage.casters(), size)
    }

    fn of(gpu: &Gpu, scene: &Scene, casters: Arc<Casters>, size: [u32; 2]) -> Result<Canvas, Error> {
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
        Ok(Canvas { size, halves, truth: values("truth"), geometry, resources: Resources::default() })
    }

    /// Moves camera, light and occluders.
    pub fn update(&mut self, gpu: &Gpu, stage: &Stage, view: View, light: RectLight, frustum: ShadowFrustum) {
        for half in &mut self.halves {
            half.frame.casters = stage.casters();
            half.frame.update(gpu, view, light, frustum);
        }
    }

    /// Draws the surfaces that both halves show.
    pub fn record_geometry(&mut self, gpu: &Gpu, casters: &Casters, view: &View) -> Result<(), Error> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.geometry.record(&mut Recorder::new(gpu, &mut encoder, &mut self.resources), casters, view)?;
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// GPU memory of the host's part, in bytes.
    pub fn bytes(&self) -> u64 {
        self.geometry.bytes()
    }

    /// Nothing is known of the truth any more.
    pub fn forget_truth(&self, gpu: &Gpu) {
        let nothing = vec![-2.0; self.size[0] as usize * self.size[1] as usize];
        write(gpu, &self.truth, &nothing);
    }

    /// Uploads the truth: values under 0 where errors are not measured.
    pub fn write_truth(&self, gpu: &Gpu, picture: &crate::truth::Picture) {
        let values = picture.visibility.iter().zip(&picture.valid);
        let marked: Vec<f32> = values.map(|(v, valid)| if *valid { *v } else { -1.0 - *v }).collect();
        write(gpu, &self.truth, &marked);
    }
}

impl Half {
    /// Takes the truth for its visibility.
    pub fn write_visibility(&self, gpu: &Gpu, values: &[f32]) {
        write(gpu, &self.visibility, values);
    }

    /// Records the technique, if it has one, and what is shown of it; submits both.
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
            Show::Picture => {
                let mut recorder = Recorder::new(gpu, &mut encoder, &mut self.resources);
                shade(&mut recorder, &self.frame, geometry, &self.image)?;
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

/// The milliseconds of all passes; none where one has none.
pub fn total(times: &[PassTime]) -> Option<f64> {
    times.iter().map(|(_, ms)| *ms).sum()
}
