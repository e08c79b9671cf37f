//! Table 1: milliseconds by stage.

use super::scale::Scale;
use crate::Error;
use crate::kit::{Experiment, Run, Section, Trial};
use crate::page::text;
use crate::table::{Column, Table, column};
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

/// The paper's number of tiles on its two scenes.
const TILES: [&str; 2] = ["9", "3"];

pub fn experiments(scale: Scale) -> Result<Vec<Experiment>, Error> {
    let maps = format!("pvssm:map={},tile={}", scale.map(1024), scale.map(4096));
    let specs = [maps.clone(), maps + ",decision=wait"];
    let experiment = |name: &str, scene: Scene| Experiment::new(name, scene, scale.size, &specs);
    // The paper's figure 1 is a power plant of two million triangles, its figure 8 has one and a half.
    Ok(vec![experiment("table 1, pipes", scale.pipes(2.0e6)?)?, experiment("table 1, forest", scale.forest(1.5e6)?)?])
}

/// A row: a stage, or the number of tiles.
struct Row<'a> {
    trial: &'a Trial,
    /// The paper's scene.
    place: usize,
    stage: Option<&'static Stage>,
}

impl Row<'_> {
    fn name(&self) -> String {
        self.stage.map_or("number of tiles", |stage| stage.name).to_owned()
    }

    /// A value of the row's stage, or a text for the number of tiles.
    fn stage(&self, value: impl Fn(&Stage) -> String, tiles: impl Fn() -> String) -> String {
        self.stage.map_or_else(tiles, value)
    }

    fn run(&self, run: usize) -> &Run {
        &self.trial.runs[run]
    }

    /// Milliseconds or tiles of a run.
    fn measured(&self, run: usize) -> String {
        self.stage(|stage| text::ms(ms(self.run(run), stage)), || self.run(run).count("tiles"))
    }

    /// Share of a stage in a run.
    fn share(&self, run: usize) -> String {
        self.stage(|stage| share(stage, |s| ms(self.run(run), s)), String::new)
    }
}

/// Milliseconds of a stage; not a number where the adapter has no timestamps.
fn ms(run: &Run, stage: &Stage) -> f64 {
    let passes = run.cost.passes.iter().filter(|p| stage.passes.contains(&p.name.as_str()));
    passes.map(|p| p.ms).sum::<Option<f64>>().unwrap_or(f64::NAN)
}

fn share(stage: &Stage, ms: impl Fn(&Stage) -> f64) -> String {
    text::percent_of(ms(stage), STAGES.iter().map(&ms).sum())
}

fn columns<'a>() -> [Column<Row<'a>>; 7] {
    let all = "Of all stages";
    [
        column("stage", "Stage of a frame", "", |row: &Row| row.name()),
        column("ms", "The GPU decides", "ms", |row: &Row| row.measured(0)),
        column("share", all, "", |row: &Row| row.share(0)),
        column("ms, waiting", "GPU time; the CPU decides as in the paper", "ms", |row: &Row| row.measured(1)),
        column("share", all, "", |row: &Row| row.share(1)),
        column("paper's ms", "GeForce GTX 280, 1024 x 1024", "ms", |row: &Row| {
            row.stage(|stage| text::ms(stage.paper[row.place]), || TILES[row.place].to_owned())
        }),
        column("share", all, "", |row: &Row| row.stage(|s| share(s, |s| s.paper[row.place]), String::new)),
    ]
}

pub fn section(trials: &[Trial]) -> Section {
    let groups = trials.iter().zip(0..2).map(|(trial, place)| {
        let stages = STAGES.iter().map(Some).chain([None]);
        (trial.heading(), stages.map(move |stage| Row { trial, place, stage }))
    });
    Section::new(
        "Table 1: stage by stage",
        "The geometry buffer is the host's. The paper draws a low-resolution map of 1024 texels a side and tiles of up \
         to 4096; this table does the same at its size.",
        vec![Table::grouped(&columns(), groups).into()],
    )
}
