//! Table 2: frames a second and memory under a small and under a large light; figure 13.

use super::super::kit::{Group, Part, Ratio, Run, Shown, Table, Trial};
use super::{Job, Scale, read};
use crate::error::CliError;
use crate::report::text;

/// The paper's light is 10 or 80 units wide.
const SMALL: f32 = 10.0 / 80.0;
const NAMES: [&str; 2] = ["table 2, small light", "table 2, large light"];
/// Passes whose memory is that of shadow maps and what is made of them, as the paper counts it; lists of pixels are not.
const PIXELS: [&str; 5] = ["pixel classification", "kernel shapes", "filter", "tile culling", "cluster culling"];

/// A row: what it is called, its frames a second in the paper under the two lights, its megabytes there.
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

/// The technique with maps of the paper's sizes; tiles of half of the paper's side, which is a quarter of its memory.
fn adaptive(scale: Scale) -> String {
    format!("pvssm:map={},tile={}", scale.map(1024), scale.map(2048))
}

fn specs(scale: Scale) -> [String; 6] {
    let map = scale.map(4096);
    [
        adaptive(scale),
        format!("smooth-pcss:map={map}"),
        // As many nodes as texels fit the window: the pyramid is not used.
        format!("smooth-pcss:map={map},search=128,filter=128"),
        format!("cssm:map={map}"),
        format!("packet:map={map}"),
        format!("uniform-sampling:samples=64,map={map},evaluation=accumulate"),
    ]
}

pub fn jobs(scale: Scale) -> Result<Vec<Job>, CliError> {
    let job = |(name, part): (&str, f32)| {
        let mut scene = scale.forest(782_000.0)?;
        scene.light.size *= part;
        let specs = read(specs(scale).to_vec())?;
        Ok(Job { name: name.to_owned(), scene, size: scale.size, specs, pictures: true })
    };
    NAMES.into_iter().zip([SMALL, 1.0]).map(job).collect()
}

fn of_maps(run: &Run) -> u64 {
    let passes = run.cost.passes.iter().filter(|p| !p.host && !PIXELS.contains(&p.name.as_str()));
    passes.map(|p| p.bytes).sum()
}

pub fn part(trials: &[Trial], first: usize) -> Part {
    let group = |(trial, light): (&Trial, usize)| {
        let rows = trial.runs.iter().zip(&ROWS).map(|(run, row)| {
            let adaptive = trial.runs[ADAPTIVE].speed_over(run);
            let paper =
                |f: &dyn Fn([f64; 2], f64) -> String| row.paper.map_or("–".to_owned(), |(fps, mb)| f(fps, mb));
            let of_paper = ROWS[ADAPTIVE].paper.map_or(f64::NAN, |(fps, _)| fps[light]);
            vec![
                row.name.to_owned(),
                run.spec.clone(),
                run.ms(),
                text::ratio(adaptive),
                paper(&|fps, _| text::ratio(of_paper / fps[light])),
                text::figure(run.figures.average_error),
                text::megabytes(of_maps(run)),
                text::megabytes(run.cost.total_bytes),
                paper(&|_, mb| format!("{mb}")),
            ]
        });
        Group { title: trial.heading(), rows: rows.collect() }
    };
    let heads = vec![
        ("row", "The paper's row"),
        ("technique", "Name and settings"),
        ("ms", "Milliseconds of the shadow"),
        ("adaptive", "Times as fast as this the adaptive way is"),
        ("paper", "The same in the paper"),
        ("error", "Average error over shadow and penumbra"),
        ("maps MB", "GPU memory of maps and what is made of them, without lists of pixels"),
        ("MB", "All GPU memory that it owns"),
        ("paper's MB", "Memory of maps in the paper"),
    ];
    let table = Shown::Table(Table { heads, groups: trials.iter().zip(0..).map(group).collect() });
    let pictures = (0..trials.len()).map(|i| Shown::Runs(first + i));
    Part {
        title: "Table 2 and figure 13: a small and a large light".into(),
        text: "A forest; the paper's has 782 000 triangles and a light of 10 or 80 units. The truth beside the pictures \
               is what the paper's figure 13 has 1024 maps for. The paper's fixed map is averaged and filtered texel by \
               texel; with the depth pyramid of this program a fixed map is much quicker than that."
            .into(),
        shown: std::iter::once(table).chain(pictures).collect(),
    }
}

pub fn ratios(trials: &[Trial]) -> Vec<Ratio> {
    let of = |trial: &Trial, light: usize, base: usize, what: &'static str, paper: f64| {
        let (run, base) = (&trial.runs[ADAPTIVE], &trial.runs[base]);
        let ours = run.speed_over(base);
        let trial = NAMES[light].to_owned();
        Ratio { what, trial, spec: run.spec.clone(), base: base.spec.clone(), paper: Some(paper), ours }
    };
    let both = |(trial, light): (&Trial, usize)| {
        let fps = |row: usize| ROWS[row].paper.expect("a row of the paper").0[light];
        [
            of(trial, light, BRUTE, "speed of adaptive over fixed, texel by texel", fps(ADAPTIVE) / fps(BRUTE)),
            of(trial, light, FIXED, "speed of adaptive over fixed, by a pyramid", fps(ADAPTIVE) / fps(BRUTE)),
            of(trial, light, AVERAGE, "speed of adaptive over 64 hard maps", fps(ADAPTIVE) / fps(AVERAGE)),
        ]
    };
    trials.iter().zip(0..).flat_map(both).collect()
}

pub fn lead(trials: &[Trial]) -> String {
    let Some(large) = trials.get(1) else { return String::new() };
    let adaptive = &large.runs[ADAPTIVE];
    let over = |row: usize| text::ratio(adaptive.speed_over(&large.runs[row]));
    format!(
        "Under a large light the adaptive way is {} times as fast as a fixed map that is read texel by texel (paper: 3.0), \
         {} times as fast as one with a pyramid, and {} times as fast as 64 hard maps (paper: 35), with {} MB of maps \
         (paper: 68). ",
        over(BRUTE),
        over(FIXED),
        over(AVERAGE),
        text::megabytes(of_maps(adaptive)),
    )
}
