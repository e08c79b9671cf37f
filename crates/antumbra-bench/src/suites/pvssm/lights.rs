//! Table 2: frames per second and memory under a small and under a large light; figure 13.

use super::scale::Scale;
use crate::Error;
use crate::kit::{Content, Experiment, Ratio, Run, Section, Trial, columns};
use crate::page::text;
use crate::table::{Table, column};

/// The paper's light is 10 or 80 units wide.
const SMALL: f32 = 10.0 / 80.0;
const NAMES: [&str; 2] = ["table 2, small light", "table 2, large light"];
/// Passes whose memory the paper does not count: lists of pixels. It counts shadow maps and their derivatives.
const PIXELS: [&str; 5] = ["pixel classification", "kernel shapes", "filter", "tile culling", "cluster culling"];

/// A row of the table: name, the paper's frames per second under the two lights, and its megabytes.
struct Row {
    name: &'static str,
    paper: Option<([f64; 2], f64)>,
}

const ADAPTIVE: usize = 0;
const FIXED: usize = 1;
const BRUTE: usize = 2;
const AVERAGE: usize = 5;
const ROWS: [Row; 6] = [
    Row { name: "adaptive", paper: Some(([12.33, 21.62], 68.0)) },
    Row { name: "fixed, by a pyramid", paper: None },
    Row { name: "fixed, texel by texel", paper: Some(([16.82, 7.30], 64.0)) },
    Row { name: "Annen 2008", paper: Some(([5.10, 5.08], 1088.0)) },
    Row { name: "Yang 2009", paper: Some(([4.77, 1.08], 832.0)) },
    Row { name: "64 hard maps", paper: Some(([0.60, 0.61], 64.0)) },
];

/// Maps of the paper's sizes; tiles of half the paper's side, a quarter of its memory.
fn adaptive(scale: Scale) -> String {
    format!("pvssm:map={},tile={}", scale.map(1024), scale.map(2048))
}

fn specs(scale: Scale) -> [String; 6] {
    let map = scale.map(4096);
    [
        adaptive(scale),
        format!("smooth-pcss:map={map}"),
        // 128 nodes per side cover the window at the finest level, so that the pyramid is not used.
        format!("smooth-pcss:map={map},search=128,filter=128"),
        format!("cssm:map={map}"),
        format!("packet:map={map}"),
        format!("uniform-sampling:samples=64,map={map},evaluation=accumulate"),
    ]
}

pub fn experiments(scale: Scale) -> Result<Vec<Experiment>, Error> {
    let experiment = |(name, part): (&str, f32)| {
        let mut scene = scale.forest(782_000.0)?;
        scene.light.size *= part;
        Ok(Experiment::new(name, scene, scale.size, specs(scale))?.with_images())
    };
    NAMES.into_iter().zip([SMALL, 1.0]).map(experiment).collect()
}

/// Memory of maps, bytes.
fn of_maps(run: &Run) -> u64 {
    let passes = run.cost.passes.iter().filter(|p| !p.host && !PIXELS.contains(&p.name.as_str()));
    passes.map(|p| p.bytes).sum()
}

pub fn section(trials: &[Trial]) -> Section {
    /// Trial, run, the paper's row, and the index of the light.
    type Line<'a> = (&'a Trial, &'a Run, (&'static Row, usize));
    let fps = |row: &Row, light: usize| row.paper.map(|(fps, _)| fps[light]);
    let columns = [
        column("row", "The paper's row", "", |(_, _, (row, _)): &Line| row.name.to_owned()),
        columns::technique(),
        columns::ms(),
        column("adaptive", "Speed of the adaptive maps over this", "", |(trial, run, _): &Line| {
            text::ratio(trial.runs[ADAPTIVE].speed_over(run))
        }),
        column("paper", "The same in the paper", "", move |(_, _, (row, light)): &Line| {
            text::or_dash(fps(&ROWS[ADAPTIVE], *light).zip(fps(row, *light)).map(|(a, b)| text::ratio(a / b)))
        }),
        columns::error(),
        column(
            "maps MB",
            "GPU memory of maps and their derivatives, without lists of pixels",
            "10⁶ bytes",
            |l: &Line| text::megabytes(of_maps(l.1)),
        ),
        columns::megabytes(),
        column("paper's MB", "Memory of maps in the paper", "10⁶ bytes", |(_, _, (row, _)): &Line| {
            text::or_dash(row.paper.map(|(_, mb)| mb.to_string()))
        }),
    ];
    let groups = trials.iter().enumerate().map(|(light, trial)| {
        (trial.heading(), trial.runs.iter().zip(&ROWS).map(move |(run, row)| (trial, run, (row, light))))
    });
    let mut contents: Vec<Content> = vec![Table::grouped(&columns, groups).into()];
    contents.extend(trials.iter().map(Content::renders));
    Section::new(
        "Table 2 and figure 13: a small and a large light",
        "A forest; the paper's has 782 000 triangles and a light of 10 or 80 units. The reference beside the images takes \
         the place of the 1024 maps of the paper's figure 13. The paper averages and filters its fixed map texel by \
         texel; the depth pyramid of this program makes a fixed map much faster.",
        contents,
    )
}

pub fn ratios(trials: &[Trial]) -> Vec<Ratio> {
    let fps = |row: usize, light: usize| ROWS[row].paper.expect("a row of the paper").0[light];
    let bases = [
        (BRUTE, BRUTE, "speed of adaptive over fixed, texel by texel"),
        (FIXED, BRUTE, "speed of adaptive over fixed, by a pyramid"),
        (AVERAGE, AVERAGE, "speed of adaptive over 64 hard maps"),
    ];
    let of = |(light, trial)| {
        bases.map(|(base, row, what)| {
            let paper = fps(ADAPTIVE, light) / fps(row, light);
            Ratio::speed(what, trial, &trial.runs[ADAPTIVE], &trial.runs[base], Some(paper))
        })
    };
    trials.iter().enumerate().flat_map(of).collect()
}

pub fn lead(trials: &[Trial]) -> String {
    let Some(large) = trials.get(1) else { return String::new() };
    let adaptive = &large.runs[ADAPTIVE];
    let over = |row: usize| text::ratio(adaptive.speed_over(&large.runs[row]));
    format!(
        "Under a large light the adaptive maps are {} times as fast as a fixed map that is read texel by texel (paper: \
         3.0), {} times as fast as one with a pyramid, and {} times as fast as 64 hard maps (paper: 35), with {} MB of \
         maps (paper: 68). ",
        over(BRUTE),
        over(FIXED),
        over(AVERAGE),
        text::megabytes(of_maps(adaptive)),
    )
}
