//! `antumbra render`: one technique's image, visibility and cost.

use crate::cli::RenderArgs;
use crate::error::CliError;
use crate::output::{self, Outputs, ValuesFile};
use crate::progress::Terminal;
use crate::setup;
use antumbra_bench::Monitor;
use antumbra_bench::measure::{Cost, LoadedScene};
use serde::Serialize;
use std::collections::BTreeMap;

/// Renders and writes the files of the command line.
pub fn run(args: &RenderArgs) -> Result<(), CliError> {
    let visibility = args.visibility.as_ref().map(|v| &v.file);
    output::check_files([args.output.as_ref(), visibility, args.stats.as_ref()].into_iter().flatten())?;
    let (scene, size) = setup::scene(&args.scene)?;
    let gpu = setup::gpu(&args.gpu, size)?;
    let loaded = LoadedScene::new(&gpu, &Terminal, &scene, size)?;
    let spec = &args.technique.0;
    let rendered = loaded.render(spec, args.gpu.frames, Terminal.task("Rendering"))?;

    let mut outputs = Outputs::default();
    if let Some(file) = &args.output {
        outputs.stage(file, output::encode_rgb(size, &loaded.image()?.data))?;
    }
    if let Some(ValuesFile { file, format }) = &args.visibility {
        outputs.stage(file, output::encode_values(*format, size, &rendered.visibility))?;
    }
    if let Some(file) = &args.stats {
        let stats = Stats {
            adapter: &gpu.info.name,
            technique: spec.technique.name,
            settings: &spec.settings,
            scene: &args.scene.scene.to_string_lossy(),
            width: size[0],
            height: size[1],
            triangles: scene.triangle_count(),
            frames: args.gpu.frames,
            stats: &rendered.stats,
            cost: &rendered.cost,
        };
        let json = serde_json::to_vec_pretty(&stats).map_err(Into::into);
        outputs.stage(file, json.map(|json| [json, b"\n".to_vec()].concat()))?;
    }
    Terminal.check()?;
    outputs.commit()
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
    /// Statistics of the last frame, such as the number of maps.
    #[serde(rename = "figures", skip_serializing_if = "BTreeMap::is_empty")]
    stats: &'a BTreeMap<&'static str, f64>,
    #[serde(flatten)]
    cost: &'a Cost,
}
