//! Measuring techniques on one scene for a comparison.

use super::model::{Comparison, Entry, Reference};
use crate::measure::{LoadedScene, Rendered};
use crate::truth::{Truth, TruthSettings};
use crate::{Error, Monitor};
use antumbra::{Gpu, Spec};
use antumbra_scene::Scene;

/// Renders the scene, which is called `name`, with every technique and compares the results with the reference. The
/// median time of `frames` frames counts; `command` is the command line for the report.
pub fn compare(
    (gpu, monitor): (&Gpu, &dyn Monitor),
    (name, scene, [width, height]): (&str, &Scene, [u32; 2]),
    specs: &[&Spec],
    frames: u32,
    truth_settings: &TruthSettings,
    command: String,
) -> Result<Comparison, Error> {
    let loaded = LoadedScene::new(gpu, monitor, scene, [width, height])?;
    // Techniques first: their errors appear before the long tracing.
    let rendered = loaded.render_all("Rendering", specs, frames)?;
    let truth = Truth::of(scene, [width, height], truth_settings, monitor)?;
    let entry = |(spec, rendered)| judged(spec, rendered, &loaded, &truth);
    let entries = specs.iter().copied().zip(rendered).map(entry).collect::<Result<_, _>>()?;
    Ok(Comparison {
        scene: name.to_owned(),
        triangles: scene.triangle_count() as u64,
        width,
        height,
        adapter: gpu.info.name.clone(),
        software: gpu.is_software(),
        command,
        truth: Reference {
            image: loaded.shaded(&truth.reference.visibility)?,
            light_samples: truth_settings.light_samples,
            pixel_samples: truth_settings.pixel_samples,
            seconds: truth.seconds,
            error_estimate: truth.reference.rms_error(),
            summary: truth.summary(),
            visibility: truth.reference.visibility,
        },
        entries,
    })
}

fn judged(spec: &Spec, rendered: Rendered, scene: &LoadedScene, truth: &Truth) -> Result<Entry, Error> {
    let Rendered { cost, visibility, .. } = rendered;
    Ok(Entry {
        technique: spec.technique.name.to_owned(),
        title: spec.technique.title.to_owned(),
        source: spec.technique.source.to_owned(),
        spec: spec.text.clone(),
        settings: spec.settings.clone(),
        metrics: truth.metrics(&spec.text, &visibility)?,
        grazing: truth.grazing_metrics(&spec.text, &visibility)?,
        heat_map: truth.heat_map(&spec.text, &visibility)?,
        cost,
        image: scene.shaded(&visibility)?,
        visibility,
    })
}
