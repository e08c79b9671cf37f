//! `antumbra render`: one technique, its picture, its visibility, its cost.

use crate::cli::RenderArgs;
use crate::error::CliError;
use crate::measure::{self, Cost};
use crate::output::{self, Outputs};
use crate::progress::{self, Progress};
use crate::setup;
use antumbra::Gpu;
use antumbra_scene::Scene;
use pollster::block_on;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Renders and writes what was asked for.
pub fn run(args: &RenderArgs) -> Result<(), CliError> {
    let visibility_path = args.visibility.as_ref().map(|v| v.path.as_path());
    output::check_files([args.output.as_deref(), visibility_path, args.stats.as_deref()].into_iter().flatten())?;
    let (scene, size) = setup::scene(&args.scene)?;
    let gpu = setup::gpu(&args.gpu, size)?;
    let renderer = setup::renderer(&gpu, &scene, size)?;

    let progress = Progress::new("Rendering");
    let mut technique = block_on(gpu.checked(|| args.technique.0.make(&gpu)))?;
    let cost = measure::measure(&gpu, &renderer, &mut *technique, args.gpu.frames, |done| progress.set(done))?;
    drop(progress);

    let mut outputs = Outputs::default();
    if let Some(path) = &args.output {
        outputs.stage(path, output::encode_rgb(size, &setup::picture(&gpu, &renderer)?))?;
    }
    if let Some(file) = &args.visibility {
        let values = setup::visibility(&gpu, &renderer)?;
        outputs.stage(&file.path, output::encode_values(file.format, size, &values))?;
    }
    if let Some(path) = &args.stats {
        let figures = block_on(technique.figures(&gpu))?;
        stage_stats(&mut outputs, path, &Stats::new(args, &gpu, &scene, size, (&cost, figures)))?;
    }
    progress::check_cancelled()?;
    outputs.commit()
}

fn stage_stats(outputs: &mut Outputs, path: &Path, stats: &Stats) -> Result<(), CliError> {
    let json = serde_json::to_vec_pretty(stats).map_err(Into::into);
    outputs.stage(path, json.map(|json| [json, b"\n".to_vec()].concat()))
}

/// The file of `--stats`.
#[derive(Serialize)]
struct Stats<'a> {
    adapter: &'a str,
    technique: &'a str,
    settings: &'a serde_json::Value,
    scene: &'a str,
    width: u32,
    height: u32,
    triangles: usize,
    frames: u32,
    /// What the last frame did, such as the number of maps.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    figures: BTreeMap<&'static str, f64>,
    #[serde(flatten)]
    cost: &'a Cost,
}

impl<'a> Stats<'a> {
    fn new(
        args: &'a RenderArgs,
        gpu: &'a Gpu,
        scene: &'a Scene,
        size: [u32; 2],
        (cost, figures): (&'a Cost, Vec<(&'static str, f64)>),
    ) -> Self {
        let spec = &args.technique.0;
        Stats {
            adapter: &gpu.info.name,
            technique: spec.technique.name,
            settings: &spec.settings,
            scene: &args.scene.scene,
            width: size[0],
            height: size[1],
            triangles: scene.triangle_count(),
            frames: args.gpu.frames,
            figures: figures.into_iter().collect(),
            cost,
        }
    }
}
