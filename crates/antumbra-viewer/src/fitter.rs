//! Fitting of the shadow frustum: at once for small scenes, in the background for large ones.

use crate::job::{Job, Slice};
use antumbra::input::frustum::FrustumFit;
use antumbra::{RectLight, ShadowFrustum, View};
use antumbra_scene::{Instance, Scene};

/// Largest number of triangles that is fitted within a frame.
const AT_ONCE: usize = 60_000;

/// Inputs of a fit; the number is the pose.
pub type Fit = (View, RectLight, u64);

/// The last frustum, and a copy of the scene for the job.
pub struct Fitter {
    triangles: usize,
    scene: Option<Box<Scene>>,
    fitted: Option<(Fit, ShadowFrustum)>,
    job: Option<Job<(Box<Scene>, Fit, ShadowFrustum)>>,
}

impl Fitter {
    /// A fitter for this scene.
    pub fn new(scene: &Scene) -> Fitter {
        let copy = Some(Box::new(scene.clone()));
        Fitter { triangles: scene.triangle_count(), scene: copy, fitted: None, job: None }
    }

    /// The frustum for `what` and the current instances; none while the job runs.
    pub fn fit(
        &mut self,
        what: Fit,
        instances: &[Instance],
        wake: impl Fn() + Send + 'static,
    ) -> Option<ShadowFrustum> {
        if let Some(Ok((scene, fit, frustum))) = self.job.as_ref().and_then(Job::poll) {
            (self.scene, self.fitted, self.job) = (Some(scene), Some((fit, frustum)), None);
        }
        if let Some((fit, frustum)) = &self.fitted
            && *fit == what
        {
            return Some(*frustum);
        }
        // None while a job has it: the next starts after that one.
        let mut scene = self.scene.take()?;
        scene.light = what.1;
        scene.instances.clone_from_slice(instances);
        if self.triangles <= AT_ONCE {
            let frustum = ShadowFrustum::fit(&scene, &what.0);
            (self.scene, self.fitted) = (Some(scene), Some((what, frustum)));
            return Some(frustum);
        }
        self.job = Some(Job::start("Fitting the shadow map", wake, move |_| async move {
            let mut fit = FrustumFit::new(&scene, &what.0);
            Slice::default().run(&mut fit, || true).await;
            let frustum = fit.finish();
            (scene, what, frustum)
        }));
        None
    }
}
