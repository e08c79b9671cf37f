//! A scene on the GPU.

use crate::fitter::Fitter;
use crate::render_targets::RenderTargets;
use antumbra::input::casters::Role;
use antumbra::passes::pixels::shading::shade;
use antumbra::scene::{Arranged, Placed};
use antumbra::{Casters, Error, Gpu, RectLight, ShadowFrustum, Shadows, View};
use antumbra_scene::{Aabb, Instance, Scene};
use glam::{Affine3A, Quat, Vec3};
use std::sync::Arc;

/// A scene with its triangles on the GPU.
pub struct LoadedScene {
    /// The scene as opened.
    pub scene: Arc<Scene>,
    /// Instances at their current transforms.
    pub instances: Vec<Instance>,
    /// Number of the pose; it changes whenever instances move.
    pub pose: u64,
    /// Bounding box in the first pose.
    pub bounds: Aabb,
    /// Number of triangles over all instances.
    pub triangles: usize,
    placed: Placed,
    casters: Arc<Casters>,
    angle: f32,
    fitter: Fitter,
}

impl LoadedScene {
    /// Uploads a scene and compiles shared pipelines. Slow: call it from a job.
    pub fn new(gpu: &Gpu, scene: Arc<Scene>, arranged: Arranged, pose: u64) -> Result<LoadedScene, Error> {
        let placed = Placed::upload_arranged(gpu, &scene, arranged)?;
        let casters = Arc::new(placed.casters.clone());
        let loaded = LoadedScene {
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
        let small = RenderTargets::new(gpu, &loaded.scene, loaded.casters(), [8, 8])?;
        let half = &small.halves[0];
        gpu.submit(|recorder| {
            small.geometry.record(recorder, &loaded.casters, &half.frame.view)?;
            let frame = half.frame.bind(recorder)?;
            shade(recorder, &frame, &small.geometry, &half.image)
        })?;
        Ok(loaded)
    }

    /// Makes a technique and compiles its pipelines. Slow: call it from a job.
    pub async fn technique(
        gpu: &Gpu,
        scene: &Scene,
        casters: Arc<Casters>,
        spec: &antumbra::Spec,
    ) -> Result<Shadows, Error> {
        LoadedScene::compile(gpu, scene, casters, spec, false).await?;
        gpu.checked(|| Shadows::from_spec(gpu, spec)).await
    }

    /// Compiles all that a technique will need, with debug capture or without. Takes a while: not for the thread that
    /// draws.
    pub async fn compile(
        gpu: &Gpu,
        scene: &Scene,
        casters: Arc<Casters>,
        spec: &antumbra::Spec,
        captured: bool,
    ) -> Result<(), Error> {
        gpu.checked(|| {
            let small = RenderTargets::new(gpu, scene, casters, [8, 8])?;
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            // A technique of its own: it takes maps for valid that are recorded here and never drawn.
            let mut technique = Shadows::from_spec(gpu, spec)?;
            technique.set_debug_capture(captured);
            technique.record(gpu, &mut encoder, &small.halves[0].frame)
        })
        .await
    }

    /// The shadow casters.
    pub fn casters(&self) -> Arc<Casters> {
        self.casters.clone()
    }

    /// True if the scene has occluders that can be moved.
    pub fn has_occluders(&self) -> bool {
        self.placed.roles.contains(&Role::Caster)
    }

    /// Turns all occluders about the vertical axis through their centre, radians from the first pose.
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

    /// The scene in its current pose, for tracing.
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
