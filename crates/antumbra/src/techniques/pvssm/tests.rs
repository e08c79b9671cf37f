//! The technique's parts against twins on the CPU, and what must hold whatever the tiles are.

mod conservative;
mod plans;
mod prediction;
mod seams;

use crate::scene::SceneRenderer;
use crate::testing::{Random, computed, gpu, submit};
use crate::techniques::spec::Spec;
use crate::technique::Technique;
use antumbra_scene::{Scene, builtin};
use pollster::block_on;

/// A built-in scene with its geometry buffer drawn.
fn drawn(scene: &Scene, size: [u32; 2]) -> SceneRenderer {
    let renderer = SceneRenderer::new(gpu(), scene, size).unwrap_or_else(|e| panic!("{e}"));
    submit(|recorder| renderer.record_geometry(recorder));
    renderer
}

fn scene(spec: &str) -> Scene {
    builtin::build(spec).unwrap_or_else(|e| panic!("{e}"))
}

fn technique(spec: &str) -> Box<dyn Technique> {
    spec.parse::<Spec>().unwrap_or_else(|e| panic!("{e}")).make(gpu()).unwrap_or_else(|e| panic!("{spec}: {e}"))
}

/// What a technique makes of a drawn scene.
fn shadowed(renderer: &SceneRenderer, technique: &mut dyn Technique) -> Vec<f32> {
    let [width, height] = renderer.frame.size;
    renderer.write_visibility(gpu(), &vec![-7.0; (width * height) as usize]);
    submit(|recorder| renderer.record_shadow(technique, recorder));
    block_on(renderer.read_visibility(gpu())).unwrap_or_else(|e| panic!("{e}"))
}

/// A figure of the last frame.
fn figure(technique: &dyn Technique, name: &str) -> f64 {
    let figures = block_on(technique.stats(gpu())).unwrap_or_else(|e| panic!("{e}"));
    figures.iter().find(|(n, _)| *n == name).unwrap_or_else(|| panic!("no figure {name}")).1
}
