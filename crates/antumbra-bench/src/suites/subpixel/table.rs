//! Table 1, and the cost of a pixel's samples.

use crate::Error;
use crate::kit::{Content, Experiment, Ratio, Runner, Section, Trial};
use crate::page::text;
use crate::table::{Table, column};
use antumbra_scene::{Scene, builtin};

/// The paper's image size.
pub const SIZE: [u32; 2] = [800, 600];

/// A row of the paper and a built-in scene of its class.
struct Row {
    name: &'static str,
    class: &'static str,
    scene: &'static str,
    samples: u32,
    triangles: u64,
    texels: u64,
    pixels: u64,
    evaluations: u64,
    /// Milliseconds of the silhouette mask, the pairs, the shadow.
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

pub fn experiments(runner: &Runner) -> Result<Vec<Experiment>, Error> {
    let experiment = |name: &str, scene: Scene, samples: u32| -> Result<Experiment, Error> {
        Ok(Experiment::new(name, scene, runner.size(SIZE), specs(samples))?.with_point_light())
    };
    let own = ROWS.iter().map(|r| experiment(r.name, builtin::build(r.scene)?, r.samples));
    let further = runner.scenes.iter().map(|scene| experiment(&scene.name, scene.clone(), 32));
    own.chain(further).collect()
}

fn row_of(trial: &Trial) -> Option<&'static Row> {
    ROWS.iter().find(|r| r.name == trial.name)
}

/// A row of the table: our measurement of a scene, or the paper's.
struct Line {
    scene: String,
    samples: u32,
    triangles: u64,
    /// Silhouette texels, silhouette pixels, evaluations.
    counts: [String; 3],
    /// Milliseconds of the stages.
    stages: [f64; 3],
    ms: String,
    over_exact: String,
}

/// Both rows of a scene, where they exist.
fn lines(trial: &Trial) -> impl Iterator<Item = Line> {
    let samples = row_of(trial).map_or(32, |r| r.samples);
    let runs = trial.run(&spec(samples)).zip(trial.run(&counted(samples)));
    let ours = runs.map(|(run, counts)| Line {
        scene: trial.scene.clone(),
        samples,
        triangles: trial.triangles as u64,
        counts: ["silhouette texels", "silhouette pixels", "visibility evaluations"].map(|stat| counts.count(stat)),
        stages: STAGES.map(|of| run.cost.ms_of(|pass| of.contains(&pass.name.as_str())).unwrap_or(0.0)),
        ms: run.ms(),
        over_exact: text::ratio(trial.run(EXACT).map_or(f64::NAN, |exact| exact.speed_over(run))),
    });
    let paper = row_of(trial).map(|row| Line {
        scene: format!("{} (paper)", row.name),
        samples: row.samples,
        triangles: row.triangles,
        counts: [row.texels, row.pixels, row.evaluations].map(text::count),
        stages: row.ms,
        ms: text::ms(1000.0 / row.fps),
        over_exact: text::DASH.to_owned(),
    });
    ours.into_iter().chain(paper)
}

/// Table 1.
pub fn section(trials: &[Trial]) -> Section {
    let columns = [
        column("scene", "Ours, and the paper's of the same class", "", |l: &Line| l.scene.clone()),
        column("samples", "Samples per pixel", "", |l: &Line| l.samples.to_string()),
        column("triangles", "Triangles", "", |l: &Line| text::count(l.triangles)),
        column("texels", "Silhouette texels of the 512 x 512 map", "", |l: &Line| l.counts[0].clone()),
        column("pixels", "Silhouette pixels", "", |l: &Line| l.counts[1].clone()),
        column("tests", "Tests of a triangle against a pixel", "", |l: &Line| l.counts[2].clone()),
        column("mask", "Depth map and silhouette mask, by timestamps", "ms", |l: &Line| text::ms(l.stages[0])),
        column("pairs", "Facets, lists and pairs, by timestamps", "ms", |l: &Line| text::ms(l.stages[1])),
        column("shadow", "Tests and filter, by timestamps", "ms", |l: &Line| text::ms(l.stages[2])),
        column("ms", "The whole shadow; the paper's whole frame", "ms", |l: &Line| l.ms.clone()),
        column("÷ exact", "Over alias-free at one sample", "", |l: &Line| l.over_exact.clone()),
    ];
    let title = |trial: &Trial| {
        let class = row_of(trial).map_or("further", |r| r.class);
        format!("{class}: {}", trial.description())
    };
    let table = Table::grouped(&columns, trials.iter().map(|trial| (title(trial), lines(trial))));
    Section::new(
        "Seven scenes (table 1)",
        "Maps of 512 x 512 texels, the paper's images of 800 x 600 pixels unless --size says otherwise; a point light. \
         The paper's milliseconds are those of a GeForce GTX 280. Counts come from a frame that is not timed.",
        vec![Content::references(trials), table.into()],
    )
}

/// A ratio of milliseconds, with the paper's value and the project's aim.
struct Aim {
    what: &'static str,
    aim: &'static str,
    paper: &'static str,
}

const AIMS: [Aim; 3] = [
    Aim { what: "32 samples over alias-free at one", aim: "1.25 at most (1.1)", paper: "1.20 on the windmill" },
    Aim { what: "128 samples over 32", aim: "1.5 at most (1.3)", paper: "about 1.4 (figure 10)" },
    Aim { what: "supersampled alias-free over 32 samples", aim: "10 at least (20)", paper: "an order of magnitude" },
];

/// Cost of the samples. Both sides of each ratio are from one trial.
pub fn ratios(trials: &[Trial], curves: &[Trial]) -> Vec<Ratio> {
    let of = |trial: &Trial, aim: usize, spec: &str, base: &str, paper| {
        let (run, base) = (trial.run(spec)?, trial.run(base)?);
        let (spec, base_spec) = (run.spec.clone(), base.spec.clone());
        let (what, trial) = (AIMS[aim].what, trial.name.clone());
        Some(Ratio { what, trial, spec, base: base_spec, paper, ours: base.speed_over(run) })
    };
    // The paper's figure 1 shows the windmill.
    let paper = |trial: &Trial| (trial.name == "Windmill").then_some(49.0 / 41.0);
    let each = trials
        .iter()
        .flat_map(|trial| [of(trial, 0, &spec(32), EXACT, paper(trial)), of(trial, 1, &spec(128), &spec(32), None)]);
    let brute = curves.iter().map(|trial| of(trial, 2, &format!("{EXACT}:samples=32"), &spec(32), Some(10.0)));
    each.chain(brute).flatten().collect()
}

/// All measured values of a ratio, sorted.
fn sorted(ratios: &[Ratio], aim: &Aim) -> Vec<f64> {
    let mut values: Vec<f64> = ratios.iter().filter(|r| r.what == aim.what).map(|r| r.ours).collect();
    values.sort_by(f64::total_cmp);
    values
}

fn middle(sorted: &[f64]) -> f64 {
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The ratios as a table.
pub fn costs(trials: &[Trial], curves: &[Trial]) -> Section {
    type Row = (&'static Aim, Vec<f64>);
    let ratios = ratios(trials, curves);
    let ratio = |value: Option<&f64>| text::ratio(value.copied().unwrap_or(f64::NAN));
    let columns = [
        column(
            "ratio",
            "Milliseconds over milliseconds, measured next to each other in one run",
            "",
            |(aim, _): &Row| aim.what.to_owned(),
        ),
        column("least", "Over the scenes", "", move |(_, ours): &Row| ratio(ours.first())),
        column("median", "Over the scenes", "", |(_, ours): &Row| text::ratio(middle(ours))),
        column("largest", "Over the scenes", "", move |(_, ours): &Row| ratio(ours.last())),
        column("paper", "The paper's value", "", |(aim, _): &Row| aim.paper.to_owned()),
        column("aim", "The project's limit, and in brackets its aim", "", |(aim, _): &Row| aim.aim.to_owned()),
    ];
    let rows = AIMS.iter().map(|aim| (aim, sorted(&ratios, aim)));
    Section::new(
        "What samples cost",
        "The paper: 49 frames per second for alias-free shadow maps at one sample, 41 at 32 samples.",
        vec![Table::new(&columns, format!("{} scenes", trials.len()), rows).into()],
    )
}

pub fn lead(trials: &[Trial], curves: &[Trial]) -> String {
    let ratios = ratios(trials, curves);
    let [one, more, brute] = AIMS.each_ref().map(|aim| text::ratio(middle(&sorted(&ratios, aim))));
    format!(
        "32 samples take {one} times as long as alias-free at one (paper: 1.20), 128 samples {more} times as long as 32, \
         supersampled alias-free at 32 {brute} times as long as subpixel (paper: an order of magnitude); medians over scenes."
    )
}
