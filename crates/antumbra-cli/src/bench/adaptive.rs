//! Adaptive sampling of the light against a fixed number of samples [Schwärzler 2009, section 5].

use super::Suite;
use super::kit::{Findings, Group, Lab, Order, Part, Ratio, Run, Shown, Table, Trial, specs};
use crate::cli::TruthArgs;
use crate::error::CliError;
use crate::report::lines::{Curve, Guide, Lines, Spot};
use crate::report::text;
use antumbra_scene::{Scene, builtin};

pub const SUITE: Suite = Suite {
    name: "adaptive",
    title: "Adaptive sampling of the light",
    source: "Schwärzler 2009",
    summary: "few, well placed shadow maps against 81, 128 and 256 fixed ones",
    scenes: false,
    run,
};

/// The paper's picture.
const SIZE: [u32; 2] = [1024, 768];
/// What the paper calls reasonably accurate, and divides by.
const BASE: &str = "uniform-sampling:map=512,samples=128";
/// The rows of every scene; the first two are the adaptive ones. Maps are the paper's.
const ROWS: [&str; 5] = [
    "adaptive-sampling:map=512",
    "adaptive-sampling:map=512,criterion=relative,weights=paper,filter=pcf",
    "uniform-sampling:map=512,samples=81",
    BASE,
    "uniform-sampling:map=512,samples=256",
];
/// Widths of the filter in the sweeps, texels.
const PCF: [u32; 4] = [1, 2, 4, 8];
const EPSILONS: [f64; 5] = [0.1, 0.03, 0.01, 0.003, 0.001];
const TOLERANCES: [f64; 6] = [0.2, 0.1, 0.05, 0.02, 0.01, 0.005];
const FIXED: [u32; 8] = [4, 9, 16, 36, 64, 81, 128, 256];
const PATTERNS: [&str; 3] = ["regular", "stratified", "low-discrepancy"];
const COUNTS: [u32; 5] = [4, 16, 64, 256, 1024];
/// Rays to the light at least, where a thousand samples are measured.
const FINE: u32 = 16384;

/// A scene and what the paper says of such a one.
struct Setup {
    /// How much of the picture is penumbra.
    name: &'static str,
    /// The same in a sentence.
    place: &'static str,
    builtin: &'static str,
    /// Sets camera and light.
    arrange: fn(&mut Scene),
    /// Speed relative to 128 fixed samples.
    paper: Option<f64>,
}

const SETUPS: [Setup; 4] = [
    Setup {
        name: "small penumbra",
        place: "with a small penumbra",
        builtin: "windmill",
        arrange: |scene| {
            look(scene, [22.0, 29.0, 38.0], [5.0, 3.5, 0.0], 42.0);
            scene.light.size = [0.15; 2].into();
        },
        paper: Some(5.5),
    },
    Setup {
        name: "medium penumbra",
        place: "with a medium one",
        builtin: "fence",
        arrange: |scene| scene.light.size = [0.2; 2].into(),
        paper: Some(2.0),
    },
    Setup { name: "large penumbra", place: "with a large one", builtin: "layers", arrange: |_| (), paper: None },
    Setup {
        name: "penumbra everywhere",
        place: "where it fills the picture",
        builtin: "fence",
        arrange: |scene| {
            look(scene, [0.6, 1.3, 2.3], [-0.8, 0.0, 0.75], 45.0);
            scene.light.size = [4.0; 2].into();
        },
        paper: Some(0.66),
    },
];
/// The scene of the sweeps.
const MEDIUM: usize = 1;
/// The scene of the patterns: an edge in every direction, and nothing that a map is too coarse for.
const DISK: &str = "disk";

fn look(scene: &mut Scene, eye: [f32; 3], target: [f32; 3], fov_y_deg: f32) {
    scene.camera.eye = eye.into();
    scene.camera.target = target.into();
    scene.camera.fov_y_deg = fov_y_deg;
}

impl Setup {
    fn scene(&self) -> Result<Scene, CliError> {
        let mut scene = builtin::build(self.builtin)?;
        (self.arrange)(&mut scene);
        Ok(scene)
    }
}

fn run(lab: &Lab) -> Result<Findings, CliError> {
    // What cannot be read shows itself before anything takes its time.
    let (rows, sweep, patterns) = (specs(rows())?, specs(sweep())?, specs(patterns())?);
    let size = lab.size(SIZE);
    let part = |n: u32| size.map(|side| (side / n).max(1));
    let (frames, truth) = (lab.args.gpu.frames, &lab.args.truth);
    let through_the_middle =
        TruthArgs { pixel_samples: 1, light_samples: truth.light_samples.max(FINE), ..truth.clone() };

    let mut trials = Vec::new();
    for setup in &SETUPS {
        let scene = &setup.scene()?;
        trials.push(lab.trial(&Order {
            name: setup.name,
            scene,
            size,
            specs: &rows,
            frames,
            truth,
            pictures: false,
        })?);
    }
    let scene = &SETUPS[MEDIUM].scene()?;
    let sweep = Order { name: "sweeps", scene, size: part(2), specs: &sweep, frames, truth, pictures: false };
    trials.push(lab.trial(&sweep)?);
    let (scene, truth) = (&builtin::build(DISK)?, &through_the_middle);
    trials.push(lab.trial(&Order {
        name: "patterns",
        scene,
        size: part(4),
        specs: &patterns,
        frames: 0,
        truth,
        pictures: false,
    })?);
    Ok(findings(trials))
}

fn rows() -> Vec<String> {
    ROWS.map(str::to_owned).to_vec()
}

fn by_epsilon(pcf: u32) -> Vec<String> {
    EPSILONS.map(|e| format!("adaptive-sampling:map=512,criterion=relative,epsilon={e},filter=pcf,pcf={pcf}")).to_vec()
}

fn by_tolerance(pcf: u32) -> Vec<String> {
    TOLERANCES.map(|t| format!("adaptive-sampling:map=512,criterion=local,tolerance={t},filter=pcf,pcf={pcf}")).to_vec()
}

/// Each map for its cell of the light: there is no width to choose.
fn by_cells() -> Vec<String> {
    TOLERANCES.map(|t| format!("adaptive-sampling:map=512,criterion=local,tolerance={t},filter=cell")).to_vec()
}

fn by_number(pcf: u32) -> Vec<String> {
    FIXED.map(|n| format!("uniform-sampling:map=512,samples={n},pcf={pcf}")).to_vec()
}

fn by_count(pattern: &str) -> Vec<String> {
    // A thousand maps are added up one by one: together they would not fit every adapter.
    COUNTS.map(|n| format!("uniform-sampling:map=512,samples={n},pattern={pattern},evaluation=accumulate")).to_vec()
}

fn sweep() -> Vec<String> {
    let of_width = |pcf| [by_epsilon(pcf), by_tolerance(pcf), by_number(pcf)].concat();
    PCF.into_iter().flat_map(of_width).chain(by_cells()).collect()
}

fn patterns() -> Vec<String> {
    PATTERNS.into_iter().flat_map(by_count).collect()
}

/// Puts into words, tables and curves what was measured: a trial a scene, the sweeps, the patterns.
fn findings(trials: Vec<Trial>) -> Findings {
    let (scenes, rest) = trials.split_at(SETUPS.len().min(trials.len()));
    let ratios = scenes.iter().zip(&SETUPS).flat_map(|(trial, setup)| ratios(trial, setup)).collect();
    let mut parts = vec![scenes_part(scenes)];
    if let [sweeps, patterns] = rest {
        parts.extend([
            sweep_part(sweeps, "Epsilon", "relative", by_epsilon, &[]),
            sweep_part(sweeps, "Tolerance", "local", by_tolerance, &by_cells()),
            patterns_part(patterns),
        ]);
    }
    Findings { lead: lead(scenes), parts, ratios, trials }
}

fn ratios(trial: &Trial, setup: &Setup) -> Vec<Ratio> {
    let Some(base) = trial.run(BASE) else { return Vec::new() };
    let adaptive = ROWS[..2].iter().filter_map(|spec| trial.run(spec));
    let ratio = |run: &Run| Ratio {
        what: "speed",
        trial: trial.name.clone(),
        spec: run.spec.clone(),
        base: base.spec.clone(),
        paper: setup.paper,
        ours: run.speed_over(base),
    };
    adaptive.map(ratio).collect()
}

fn lead(scenes: &[Trial]) -> String {
    let said = scenes.iter().zip(&SETUPS).filter_map(|(trial, setup)| {
        let (own, base) = (trial.run(ROWS[0])?, trial.run(BASE)?);
        let paper = setup.paper.map_or(String::new(), |p| format!(" (paper: {p})"));
        let (maps, speed) = (own.count("maps"), text::ratio(own.speed_over(base)));
        Some(format!("{maps} maps {}, {speed} times as fast{paper}", setup.place))
    });
    format!("Adaptive sampling at its defaults, beside 128 fixed samples: {}.", said.collect::<Vec<_>>().join("; "))
}

const HEADS: [(&str, &str); 9] = [
    ("technique", "Name and settings"),
    ("maps", "Shadow maps, that is points of the light"),
    ("ms", "GPU milliseconds of the shadow alone"),
    ("MB", "GPU memory that the technique owns, 10⁶ bytes"),
    ("error", "Mean |error| where the truth is under 0.999: shadow and penumbra"),
    ("RMSE", "Root of the mean squared error, all valid pixels"),
    ("speed", "Milliseconds of 128 fixed samples over these"),
    ("paper", "The same in the paper"),
    ("error − 128's", "Average error less that of 128 fixed samples"),
];

fn scenes_part(scenes: &[Trial]) -> Part {
    let groups = scenes.iter().zip(&SETUPS).map(|(trial, setup)| Group {
        title: trial.heading(),
        rows: trial.runs.iter().map(|run| row(trial, setup, run)).collect(),
    });
    let table = Table { heads: HEADS.to_vec(), groups: groups.collect() };
    Part {
        title: "Four sizes of penumbra".into(),
        text: format!(
            "{}, maps of 512 x 512. Penumbra is the part of the pixels whose true visibility is over 0.01 and under \
             0.99. Speed is relative to 128 fixed samples, in the same scene and the same run; the paper's column has \
             its text and figure 7: 5.5 with 7 maps, about 2 with up to 50, 0.66 at worst.",
            scenes.first().map_or(String::new(), Trial::pixels)
        ),
        shown: vec![Shown::Pictures((0..scenes.len()).collect()), Shown::Table(table)],
    }
}

fn row(trial: &Trial, setup: &Setup, run: &Run) -> Vec<String> {
    let base = trial.run(BASE);
    let against = |value: fn(&Run, &Run) -> String| base.map_or_else(|| "–".to_owned(), |base| value(run, base));
    let paper = setup.paper.filter(|_| ROWS[..2].contains(&run.spec.as_str()));
    vec![
        run.spec.clone(),
        run.count("maps"),
        run.ms(),
        text::megabytes(run.cost.total_bytes),
        text::figure(run.figures.average_error),
        text::figure(run.figures.rmse),
        against(|run, base| text::ratio(run.speed_over(base))),
        paper.map_or_else(|| "–".to_owned(), |p| p.to_string()),
        against(|run, base| format!("{:+.4}", run.figures.average_error - base.figures.average_error)),
    ]
}

/// Error against milliseconds as a threshold falls, beside fixed samples, for each width of the filter and for cells.
fn sweep_part(trial: &Trial, what: &str, criterion: &str, own: fn(u32) -> Vec<String>, cells: &[String]) -> Part {
    let adaptive = |(color, pcf)| error_by_ms(trial, format!("adaptive, pcf={pcf}"), (color, false), &own(pcf));
    let fixed = |(color, pcf)| error_by_ms(trial, format!("fixed, pcf={pcf}"), (color, true), &by_number(pcf));
    let widths = || PCF.into_iter().enumerate();
    let of_cells = error_by_ms(trial, "adaptive, cells".to_owned(), (PCF.len(), false), cells);
    let values = if own(1).len() == EPSILONS.len() { EPSILONS.as_slice() } else { &TOLERANCES };
    let values: Vec<String> = values.iter().map(f64::to_string).collect();
    Part {
        title: format!("{what} and the filter"),
        text: format!(
            "The scene of the medium penumbra at half the size each way, {}. Along a line adaptive-sampling with \
             criterion={criterion} has {} = {}, and uniform-sampling {} samples; from left to right.",
            trial.pixels(),
            what.to_lowercase(),
            values.join(", "),
            FIXED.map(|n| n.to_string()).join(", ")
        ),
        shown: vec![Shown::Lines(Lines {
            x: "GPU milliseconds a frame".into(),
            y: "average error".into(),
            less_is_better: true,
            curves: widths()
                .map(adaptive)
                .chain(Some(of_cells).filter(|curve| !curve.points.is_empty()))
                .chain(widths().map(fixed))
                .collect(),
            guides: Vec::new(),
        })],
    }
}

fn error_by_ms(trial: &Trial, label: String, (color, dashed): (usize, bool), specs: &[String]) -> Curve {
    let spot = |run: &Run| {
        let (x, y) = (run.cost.total_ms, run.figures.average_error);
        let note = format!("{}: error {}, {} ms, {} maps", run.spec, text::figure(y), text::ms(x), run.count("maps"));
        Spot { x, y, note }
    };
    Curve { label, color, dashed, points: specs.iter().filter_map(|s| trial.run(s)).map(spot).collect() }
}

/// RMSE against the number of samples for each pattern.
fn patterns_part(trial: &Trial) -> Part {
    let curve = |(color, pattern): (usize, &str)| {
        let spot = |(n, spec): (u32, String)| {
            let rmse = trial.run(&spec)?.figures.rmse;
            Some(Spot { x: f64::from(n), y: rmse, note: format!("{spec}: RMSE {}", text::figure(rmse)) })
        };
        let points = COUNTS.into_iter().zip(by_count(pattern)).filter_map(spot).collect();
        Curve { label: pattern.to_owned(), color, dashed: false, points }
    };
    let guide = |label: &str, exponent| Guide { label: label.into(), exponent };
    Part {
        title: "Patterns of points".into(),
        text: format!(
            "uniform-sampling in {}, {}: a round umbra, so that its edge meets the light's samples in every direction. \
             The truth goes through the middle of each pixel, as the technique does, with {} rays to the light: what \
             is left is the error of the light's samples. Points at random would follow n^-1/2, points that keep their \
             distances n^-3/4.",
            trial.scene,
            trial.pixels(),
            text::count(trial.light_samples.into())
        ),
        shown: vec![Shown::Lines(Lines {
            x: "samples".into(),
            y: "RMSE".into(),
            less_is_better: false,
            curves: PATTERNS.into_iter().enumerate().map(curve).collect(),
            guides: vec![guide("n^-1/2", -0.5), guide("n^-3/4", -0.75)],
        })],
    }
}

#[cfg(test)]
mod tests {
    use super::super::kit::tests::{run, trial};
    use super::*;

    #[test]
    fn every_spec_and_every_scene_is_known() {
        let texts = [rows(), sweep(), patterns()].concat();
        assert_eq!(specs(texts).unwrap().len(), ROWS.len() + 4 * (5 + 6 + 8) + 6 + 3 * 5);
        for setup in &SETUPS {
            let triangles = setup.scene().unwrap().triangle_count();
            assert!((1000..20_000).contains(&triangles), "{}: {triangles}", setup.name);
        }
    }

    #[test]
    fn the_paper_stands_beside_ours() {
        let runs = || ROWS.iter().zip([10.0, 5.0, 40.0, 60.0, 120.0]).map(|(spec, ms)| run(spec, ms, &[("maps", 7.0)]));
        let findings = findings(SETUPS.iter().map(|setup| trial(setup.name, runs().collect())).collect());
        let ratios: Vec<_> = findings.ratios.iter().map(|r| (r.paper, r.ours)).collect();
        assert_eq!(
            (ratios.len(), ratios[0], ratios[1], ratios[4]),
            (8, (Some(5.5), 6.0), (Some(5.5), 12.0), (None, 6.0))
        );
        let said = "7 maps with a small penumbra, 6.0 times as fast (paper: 5.5)";
        assert!(findings.lead.contains(said), "{}", findings.lead);
        let [Shown::Pictures(_), Shown::Table(table)] = &findings.parts[0].shown[..] else { panic!("a table") };
        assert_eq!(table.groups.len(), 4);
        assert!(table.groups.iter().flat_map(|g| &g.rows).all(|row| row.len() == HEADS.len()));
        assert_eq!(table.groups[0].rows[0][6..8], ["6.0", "5.5"]);
        assert_eq!(table.groups[0].rows[3][6..8], ["1.0", "–"]);
    }

    #[test]
    fn sweeps_become_a_curve_for_each_width_of_the_filter() {
        let runs = sweep().iter().enumerate().map(|(i, spec)| run(spec, 1.0 + i as f64, &[])).collect();
        let part = sweep_part(&trial("sweeps", runs), "Epsilon", "relative", by_epsilon, &[]);
        assert!(part.text.contains("epsilon = 0.1, 0.03, 0.01, 0.003, 0.001"), "{}", part.text);
        let [Shown::Lines(lines)] = &part.shown[..] else { panic!("a plot") };
        let points: Vec<_> = lines.curves.iter().map(|c| c.points.len()).collect();
        assert_eq!(points, [5, 5, 5, 5, 8, 8, 8, 8]);
    }
}
