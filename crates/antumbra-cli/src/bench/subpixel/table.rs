//! Table 1, and what the samples of a pixel cost.

use super::super::kit::{Group, Lab, Part, Ratio, Run, Shown, Table, Trial};
use super::{Job, SIZE, read, with_point_light};
use crate::error::CliError;
use crate::report::text;
use antumbra_scene::{Scene, builtin};

/// A row of the paper, and a scene of its class.
struct Row {
    name: &'static str,
    class: &'static str,
    scene: &'static str,
    samples: u32,
    triangles: u64,
    texels: u64,
    pixels: u64,
    evaluations: u64,
    /// Silhouette mask, pairs, shadow.
    ms: [f64; 3],
    fps: f64,
}

const fn row(
    [name, class, scene]: [&'static str; 3],
    samples: u32,
    [triangles, texels, pixels, evaluations]: [u64; 4],
    ms: [f64; 3],
    fps: f64,
) -> Row {
    Row { name, class, scene, samples, triangles, texels, pixels, evaluations, ms, fps }
}

const ROWS: [Row; 7] = [
    row(["Windmill", "lattice", "windmill"], 32, [40712, 9365, 36113, 1295363], [2.3, 6.5, 13.2], 41.0),
    row(["Bunny", "round", "spheres:segments=64"], 32, [69473, 3254, 18523, 609901], [2.1, 6.3, 6.8], 61.0),
    row(["Pterosaur", "one smooth body", "disk"], 32, [10000, 1828, 12991, 329740], [1.6, 4.7, 4.3], 80.0),
    row(["Cage", "wires", "cage"], 128, [59780, 37646, 53576, 2915995], [4.2, 10.0, 18.9], 28.0),
    row(["Bicycle", "thin parts", "fence"], 32, [30922, 4277, 40954, 2996154], [2.1, 6.6, 15.3], 47.0),
    row(["Horse", "bodies that hide each other", "layers"], 32, [77500, 4317, 26202, 2138740], [2.3, 6.5, 17.3], 32.0),
    row(["Plant", "leaves", "plant"], 32, [20926, 15263, 59692, 1446287], [2.1, 6.2, 10.8], 50.0),
];

/// Passes of the three stages.
const STAGES: [&[&str]; 3] = [
    &["cluster culling", "depth map", "silhouette mask"],
    &[
        "facets",
        "lists of receivers",
        "light triangles",
        "triangle-block pairs",
        "triangle-texel pairs",
        "order of pairs",
    ],
    &["shadow tests", "visibility"],
];

pub const EXACT: &str = "alias-free";

pub fn spec(samples: u32) -> String {
    format!("subpixel:samples={samples}")
}

fn counted(samples: u32) -> String {
    format!("subpixel:samples={samples},statistics=true")
}

fn specs(samples: u32) -> Vec<String> {
    vec![EXACT.to_owned(), spec(32), spec(128), counted(samples)]
}

/// Names of the trials, with the SPECs of each.
#[cfg(test)]
pub fn names() -> Vec<(String, Vec<String>)> {
    ROWS.iter().map(|r| (r.name.to_owned(), specs(r.samples))).collect()
}

pub fn jobs(lab: &Lab) -> Result<Vec<Job>, CliError> {
    let job = |name: &str, scene: Scene, samples: u32| -> Result<Job, CliError> {
        let (scene, size) = (with_point_light(scene), lab.size(SIZE));
        Ok(Job { name: name.to_owned(), scene, size, specs: read(&specs(samples))?, frames: lab.args.gpu.frames })
    };
    let own = ROWS.iter().map(|r| job(r.name, builtin::build(r.scene)?, r.samples));
    let further = lab.scenes.iter().map(|scene| job(&scene.name, scene.clone(), 32));
    own.chain(further).collect()
}

fn row_of(trial: &Trial) -> Option<&'static Row> {
    ROWS.iter().find(|r| r.name == trial.name)
}

fn samples_of(trial: &Trial) -> u32 {
    row_of(trial).map_or(32, |r| r.samples)
}

/// Milliseconds of a stage by the passes' timestamps.
fn stage(run: &Run, passes: &[&str]) -> f64 {
    run.cost.passes.iter().filter(|p| !p.host && passes.contains(&p.name.as_str())).filter_map(|p| p.ms).sum()
}

const HEADS: [(&str, &str); 11] = [
    ("scene", "Ours, and the paper's of the same class"),
    ("samples", "Samples a pixel"),
    ("triangles", "Triangles"),
    ("texels", "Silhouette texels of the 512 x 512 map"),
    ("pixels", "Silhouette pixels"),
    ("tests", "Visibility evaluations: tests of a triangle against a pixel"),
    ("mask", "Milliseconds of the depth map and the silhouette mask, by timestamps"),
    ("pairs", "Milliseconds of facets, lists and pairs, by timestamps"),
    ("shadow", "Milliseconds of the tests and the filter, by timestamps"),
    ("ms", "Milliseconds of the shadow in all; the paper's from its frames per second, the whole picture"),
    ("÷ exact", "Over alias-free at one sample"),
];

/// Table 1.
pub fn part(trials: &[Trial]) -> Part {
    let group = |trial: &Trial| {
        let samples = samples_of(trial);
        let mut rows = Vec::new();
        if let (Some(run), Some(counts)) = (trial.run(&spec(samples)), trial.run(&counted(samples))) {
            let ms = STAGES.map(|passes| text::ms(stage(run, passes)));
            let over = trial.run(EXACT).map_or(f64::NAN, |exact| run.cost.total_ms / exact.cost.total_ms);
            let count = |of| counts.count(of);
            rows.push(
                [trial.scene.clone(), samples.to_string(), text::count(trial.triangles as u64)]
                    .into_iter()
                    .chain(["silhouette texels", "silhouette pixels", "visibility evaluations"].map(count))
                    .chain(ms)
                    .chain([run.ms(), text::ratio(over)])
                    .collect(),
            );
        }
        if let Some(r) = row_of(trial) {
            let paper = format!("{} (paper)", r.name);
            rows.push(
                [paper, r.samples.to_string()]
                    .into_iter()
                    .chain([r.triangles, r.texels, r.pixels, r.evaluations].map(text::count))
                    .chain(r.ms.map(text::ms))
                    .chain([text::ms(1000.0 / r.fps), "–".to_owned()])
                    .collect(),
            );
        }
        let class = row_of(trial).map_or("further", |r| r.class);
        Group { title: format!("{class}: {}", trial.drawn()), rows }
    };
    Part {
        title: "Seven scenes (table 1)".into(),
        text: "Maps of 512 x 512 texels, the paper's pictures of 800 x 600 pixels unless --size says otherwise; a point \
               light. The paper's milliseconds are those of a GeForce GTX 280. Counts come from a frame that is not timed."
            .into(),
        shown: vec![
            Shown::Pictures((0..trials.len()).collect()),
            Shown::Table(Table { heads: HEADS.to_vec(), groups: trials.iter().map(group).collect() }),
        ],
    }
}

/// What samples cost: both sides of each ratio from one trial.
pub fn ratios(trials: &[Trial], curves: &[Trial]) -> Vec<Ratio> {
    let of = |trial: &Trial, what, spec: String, base: String, paper| -> Option<Ratio> {
        let ours = trial.run(&spec)?.cost.total_ms / trial.run(&base)?.cost.total_ms;
        Some(Ratio { what, trial: trial.name.clone(), spec, base, paper, ours })
    };
    // The paper's figure 1 is the windmill.
    let paper = |trial: &Trial| (trial.name == "Windmill").then_some(49.0 / 41.0);
    let each = trials.iter().flat_map(|trial| {
        [
            of(trial, "32 samples over alias-free at one", spec(32), EXACT.to_owned(), paper(trial)),
            of(trial, "128 samples over 32", spec(128), spec(32), None),
        ]
    });
    let brute = curves.iter().map(|trial| {
        of(trial, "supersampled alias-free over 32 samples", format!("{EXACT}:samples=32"), spec(32), Some(10.0))
    });
    each.chain(brute).flatten().collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The ratios as a table, with what was aimed at.
pub fn costs(trials: &[Trial], curves: &[Trial]) -> Part {
    let ratios = ratios(trials, curves);
    let aims = [
        ("32 samples over alias-free at one", "1.25 at most (1.1)", "1.20 on the windmill"),
        ("128 samples over 32", "1.5 at most (1.3)", "about 1.4 (figure 10)"),
        ("supersampled alias-free over 32 samples", "10 at least (20)", "an order of magnitude"),
    ];
    let rows = aims.map(|(what, aim, paper)| {
        let ours: Vec<f64> = ratios.iter().filter(|r| r.what == what).map(|r| r.ours).collect();
        let ends = |pick: fn(f64, f64) -> f64| ours.iter().copied().reduce(pick).unwrap_or(f64::NAN);
        let shown = [ends(f64::min), median(ours.clone()), ends(f64::max)].map(text::ratio);
        [what.to_owned()].into_iter().chain(shown).chain([paper.to_owned(), aim.to_owned()]).collect()
    });
    let heads = vec![
        ("ratio", "Milliseconds over milliseconds, next to one another in one run"),
        ("least", "Over the scenes"),
        ("median", "Over the scenes"),
        ("largest", "Over the scenes"),
        ("paper", "What the paper says"),
        ("aim", "What the project asks for, and aims at"),
    ];
    let groups = vec![Group { title: format!("{} scenes", trials.len()), rows: rows.to_vec() }];
    Part {
        title: "What samples cost".into(),
        text: "The paper: 49 frames a second for alias-free shadow maps at one sample, 41 at 32 samples.".into(),
        shown: vec![Shown::Table(Table { heads, groups })],
    }
}

pub fn lead(trials: &[Trial], curves: &[Trial]) -> String {
    let ratios = ratios(trials, curves);
    let of = |what: &str| median(ratios.iter().filter(|r| r.what == what).map(|r| r.ours).collect());
    format!(
        "32 samples take {} times as long as alias-free at one (paper: 1.20), 128 samples {} times as long as 32, \
         supersampled alias-free at 32 {} times as long as subpixel (paper: an order of magnitude); medians over scenes.",
        text::ratio(of("32 samples over alias-free at one")),
        text::ratio(of("128 samples over 32")),
        text::ratio(of("supersampled alias-free over 32 samples")),
    )
}
