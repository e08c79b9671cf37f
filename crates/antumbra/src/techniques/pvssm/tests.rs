//! Parts of the technique against twins on the CPU, and invariants of every plan.

mod conservative;
mod plans;
mod prediction;
mod seams;

use crate::scene::SceneRenderer;
use crate::shadows::Shadows;
use crate::techniques::spec::Spec;
use crate::testing::{Random, computed, gpu, submit};
use antumbra_scene::{Scene, builtin};
use pollster::block_on;

/// A built-in scene with its geometry buffer drawn.
fn drawn(scene: &Scene, size: [u32; 2]) -> SceneRenderer {
    let renderer = SceneRenderer::new(gpu(), scene, size).unwrap_or_else(|e| panic!("{e}"));
    submit(|recorder| renderer.record_geometry(gpu(), recorder.encoder(), None));
    renderer
}

fn scene(spec: &str) -> Scene {
    builtin::build(spec).unwrap_or_else(|e| panic!("{e}"))
}

fn technique(spec: &str) -> Shadows {
    let parsed: Spec = spec.parse().unwrap_or_else(|e| panic!("{e}"));
    Shadows::from_spec(gpu(), &parsed).unwrap_or_else(|e| panic!("{spec}: {e}"))
}

/// The visibility of a drawn scene.
fn shadowed(renderer: &SceneRenderer, shadows: &mut Shadows) -> Vec<f32> {
    let [width, height] = renderer.frame.size;
    renderer.write_visibility(gpu(), &vec![-7.0; (width * height) as usize]);
    submit(|recorder| shadows.record(gpu(), recorder.encoder(), &renderer.frame));
    block_on(renderer.read_visibility(gpu())).unwrap_or_else(|e| panic!("{e}"))
}

/// A count of the last frame.
fn stat(shadows: &Shadows, name: &str) -> f64 {
    let stats = block_on(shadows.stats(gpu())).unwrap_or_else(|e| panic!("{e}"));
    stats.iter().find(|(n, _)| *n == name).unwrap_or_else(|| panic!("no count of {name}")).1
}
