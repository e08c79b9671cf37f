//! Table 1: milliseconds stage by stage.

use super::super::kit::{Group, Part, Run, Shown, Table, Trial};
use super::{Job, Scale, read};
use crate::error::CliError;
use crate::report::text;

/// A stage of the table, the passes that make it up here, and the paper's milliseconds on its two scenes.
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

pub fn jobs(scale: Scale) -> Result<Vec<Job>, CliError> {
    let job = |name: &str, scene| -> Result<Job, CliError> {
        let maps = format!("pvssm:map={},tile={}", scale.map(1024), scale.map(4096));
        let specs = read(vec![maps.clone(), maps + ",decision=wait"])?;
        Ok(Job { name: name.to_owned(), scene, size: scale.size, specs, pictures: false })
    };
    // Its figure 1 is a power plant of two million triangles, its figure 8 has one and a half.
    Ok(vec![job("table 1, pipes", scale.pipes(2.0e6)?)?, job("table 1, forest", scale.forest(1.5e6)?)?])
}

fn of_stage(run: &Run, stage: &Stage) -> Option<f64> {
    let passes = run.cost.passes.iter().filter(|p| stage.passes.contains(&p.name.as_str()));
    passes.map(|p| p.ms).sum()
}

pub fn part(trials: &[Trial]) -> Part {
    let group = |(trial, place): (&Trial, usize)| {
        let paper_total: f64 = STAGES.iter().map(|s| s.paper[place]).sum();
        let times = |run: &Run| STAGES.iter().map(|s| of_stage(run, s).unwrap_or(f64::NAN)).collect::<Vec<_>>();
        let all: Vec<Vec<f64>> = trial.runs.iter().map(times).collect();
        let shares = |times: &[f64], i: usize| text::percent_of(times[i], times.iter().sum());
        let rows = STAGES.iter().enumerate().map(|(i, stage)| {
            let mut row = vec![stage.name.to_owned()];
            for times in &all {
                row.extend([text::ms(times[i]), shares(times, i)]);
            }
            row.extend([text::ms(stage.paper[place]), text::percent_of(stage.paper[place], paper_total)]);
            row
        });
        let mut rows: Vec<Vec<String>> = rows.collect();
        let mut tiles = vec!["number of tiles".to_owned()];
        for run in &trial.runs {
            tiles.extend([run.count("tiles"), String::new()]);
        }
        tiles.extend([["9", "3"][place].to_owned(), String::new()]);
        rows.push(tiles);
        Group { title: trial.heading(), rows }
    };
    let heads = vec![
        ("stage", "What the time goes to"),
        ("ms", "Milliseconds, the GPU decides"),
        ("share", "Of all stages"),
        ("ms, waiting", "Milliseconds of the GPU, the CPU decides as in the paper"),
        ("share", "Of all stages"),
        ("paper's ms", "GeForce GTX 280, 1024 x 1024"),
        ("share", "Of all stages"),
    ];
    let groups = trials.iter().zip(0..2).map(group).collect();
    Part {
        title: "Table 1: stage by stage".into(),
        text:
            "The geometry buffer is the host's. The paper draws a low-resolution map of 1024 texels a side and tiles \
               of up to 4096; so does this table at its size."
                .into(),
        shown: vec![Shown::Table(Table { heads, groups })],
    }
}
