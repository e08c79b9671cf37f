//! Table 1: milliseconds by stage.

use super::scale::Scale;
use crate::Error;
use crate::kit::{Experiment, Run, Section, Trial};
use crate::page::text;
use crate::table::{Table, column};
use antumbra_scene::Scene;

/// A stage of the table, its passes here, and the paper's milliseconds on its two scenes.
struct Stage {
    name: &'static str,
    passes: &'static [&'static str],
    paper: [f64; 2],
}

const STAGES: [Stage; 6] = [
    Stage { name: "geometry buffer", passes: &["geometry buffer"], paper: [9.0, 49.0] },
    Stage {
        name: "low-resolution map",
        passes: &["cluster culling", "low-resolution map", "depth pyramid"],
        paper: [15.0, 53.0],
    },
    Stage { name: "average depth", passes: &["pixel classification", "kernel shapes"], paper: [4.5, 9.0] },
    Stage { name: "grid and tiling", passes: &["tile grid", "tile decision", "pixel bins"], paper: [10.5, 10.5] },
    Stage { name: "tiles", passes: &["tile culling", "tiles", "tile pyramid"], paper: [55.8, 91.0] },
    Stage { name: "filter", passes: &["filter"], paper: [82.5, 2.4] },
];

pub fn experiments(scale: Scale) -> Result<Vec<Experiment>, Error> {
    let maps = format!("pvssm:map={},tile={}", scale.map(1024), scale.map(4096));
    let specs = [maps.clone(), maps + ",decision=wait"];
    let experiment = |name: &str, scene: Scene| Experiment::new(name, scene, scale.size, &specs);
    // The paper's figure 1 is a power plant of two million triangles, its figure 8 has one and a half.
    Ok(vec![experiment("table 1, pipes", scale.pipes(2.0e6)?)?, experiment("table 1, forest", scale.forest(1.5e6)?)?])
}

/// A row: a stage, or the number of tiles. The three entries: the GPU decides, the CPU decides, the paper.
struct Row {
    name: &'static str,
    values: [String; 3],
    shares: [String; 3],
}

/// The rows of a scene; `place` is its index among the paper's.
fn rows(trial: &Trial, place: usize) -> Vec<Row> {
    // Milliseconds of the stages; not a number where the adapter has no timestamps.
    let ms = |run: &Run| {
        STAGES.each_ref().map(|stage| {
            let passes = run.cost.passes.iter().filter(|p| stage.passes.contains(&p.name.as_str()));
            passes.map(|p| p.ms).sum::<Option<f64>>().unwrap_or(f64::NAN)
        })
    };
    let [waitless, waiting] = [&trial.runs[0], &trial.runs[1]];
    let all = [ms(waitless), ms(waiting), STAGES.each_ref().map(|stage| stage.paper[place])];
    let stages = STAGES.iter().enumerate().map(|(i, stage)| Row {
        name: stage.name,
        values: all.each_ref().map(|times| text::ms(times[i])),
        shares: all.each_ref().map(|times| text::percent_of(times[i], times.iter().sum())),
    });
    let tiles = [waitless.count("tiles"), waiting.count("tiles"), ["9", "3"][place].to_owned()];
    stages.chain([Row { name: "number of tiles", values: tiles, shares: Default::default() }]).collect()
}

pub fn section(trials: &[Trial]) -> Section {
    let share = |i: usize| column("share", "Of all stages", "", move |row: &Row| row.shares[i].clone());
    let columns = [
        column("stage", "Stage of a frame", "", |row: &Row| row.name.to_owned()),
        column("ms", "GPU time; the GPU decides", "ms", |row: &Row| row.values[0].clone()),
        share(0),
        column("ms, waiting", "GPU time; the CPU decides as in the paper", "ms", |row: &Row| row.values[1].clone()),
        share(1),
        column("paper's ms", "GeForce GTX 280, 1024 x 1024", "ms", |row: &Row| row.values[2].clone()),
        share(2),
    ];
    let groups = trials.iter().zip(0..2).map(|(trial, place)| (trial.heading(), rows(trial, place)));
    Section::new(
        "Table 1: stage by stage",
        "The geometry buffer is the host's. The paper draws a low-resolution map of 1024 texels per side and tiles of up \
         to 4096; this table does the same at its size.",
        vec![Table::grouped(&columns, groups).into()],
    )
}
