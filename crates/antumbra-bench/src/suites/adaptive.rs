//! Adaptive sampling of the light against a fixed number of samples [Schwärzler 2009, section 5].

use crate::Error;
use crate::kit::{Content, Experiment, Ratio, Report, Run, Runner, Section, Suite, Trial, columns, split};
use crate::page::lines::{Curve, Lines, Point};
use crate::page::text;
use crate::table::{Table, column};
use crate::truth::TruthSettings;
use antumbra_scene::{Scene, builtin};

pub const SUITE: Suite = Suite {
    name: "adaptive",
    title: "Adaptive sampling of the light",
    source: "Schwärzler 2009",
    summary: "few, well placed shadow maps against 81, 128 and 256 fixed ones",
    scenes: false,
    run,
};

/// The paper's image size.
const SIZE: [u32; 2] = [1024, 768];
/// The paper's reference of speed and error.
const BASE: &str = "uniform-sampling:map=512,samples=128";
/// The rows of every scene; the first two are the adaptive ones. Maps are the paper's.
const ROWS: [&str; 5] = [
    "adaptive-sampling:map=512",
    "adaptive-sampling:map=512,criterion=relative,weights=paper,filter=pcf",
    "uniform-sampling:map=512,samples=81",
    BASE,
    "uniform-sampling:map=512,samples=256",
];
/// Filter widths of the sweeps, texels.
const PCF: [u32; 4] = [1, 2, 4, 8];
const EPSILONS: [f64; 5] = [0.1, 0.03, 0.01, 0.003, 0.001];
const TOLERANCES: [f64; 6] = [0.2, 0.1, 0.05, 0.02, 0.01, 0.005];
const FIXED: [u32; 8] = [4, 9, 16, 36, 64, 81, 128, 256];
const PATTERNS: [&str; 3] = ["regular", "stratified", "low-discrepancy"];
const COUNTS: [u32; 5] = [4, 16, 64, 256, 1024];
/// Fewest shadow rays where a thousand samples are measured.
const FINE: u32 = 16384;

/// A scene and the paper's result for one of its class.
struct Setup {
    /// Extent of the penumbra.
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
        place: "where it fills the image",
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
/// The scene of the patterns: edges in every direction, and no detail finer than a texel.
const DISK: &str = "disk";

fn look(scene: &mut Scene, eye: [f32; 3], target: [f32; 3], fov_y_deg: f32) {
    scene.camera.eye = eye.into();
    scene.camera.target = target.into();
    scene.camera.fov_y_deg = fov_y_deg;
}

impl Setup {
    fn scene(&self) -> Result<Scene, Error> {
        let mut scene = builtin::build(self.builtin)?;
        (self.arrange)(&mut scene);
        Ok(scene)
    }
}

fn run(runner: &Runner) -> Result<Report, Error> {
    let size = runner.size(SIZE);
    let part = |n: u32| size.map(|side| (side / n).max(1));
    let setup = |setup: &Setup| Experiment::new(setup.name, setup.scene()?, size, ROWS);
    let mut experiments = SETUPS.iter().map(setup).collect::<Result<Vec<_>, _>>()?;
    experiments.push(Experiment::new("sweeps", SETUPS[MEDIUM].scene()?, part(2), sweep())?);
    let truth =
        |t: &TruthSettings| TruthSettings { pixel_samples: 1, light_samples: t.light_samples.max(FINE), ..t.clone() };
    let patterns = Experiment::new("patterns", builtin::build(DISK)?, part(4), patterns())?.untimed();
    experiments.push(Experiment { truth, ..patterns });
    Ok(report(runner.run_all(&experiments)?))
}

fn by_epsilon(pcf: u32) -> Vec<String> {
    EPSILONS.map(|e| format!("adaptive-sampling:map=512,criterion=relative,epsilon={e},filter=pcf,pcf={pcf}")).to_vec()
}

fn by_tolerance(pcf: u32) -> Vec<String> {
    TOLERANCES.map(|t| format!("adaptive-sampling:map=512,criterion=local,tolerance={t},filter=pcf,pcf={pcf}")).to_vec()
}

/// Each map stands for its cell of the light, without a filter width.
fn by_cells() -> Vec<String> {
    TOLERANCES.map(|t| format!("adaptive-sampling:map=512,criterion=local,tolerance={t},filter=cell")).to_vec()
}

fn by_number(pcf: u32) -> Vec<String> {
    FIXED.map(|n| format!("uniform-sampling:map=512,samples={n},pcf={pcf}")).to_vec()
}

fn by_count(pattern: &str) -> Vec<String> {
    // Accumulation one by one: a thousand maps at once exceed the memory of some adapters.
    COUNTS.map(|n| format!("uniform-sampling:map=512,samples={n},pattern={pattern},evaluation=accumulate")).to_vec()
}

fn sweep() -> Vec<String> {
    let of_width = |pcf| [by_epsilon(pcf), by_tolerance(pcf), by_number(pcf)].concat();
    PCF.into_iter().flat_map(of_width).chain(by_cells()).collect()
}

fn patterns() -> Vec<String> {
    PATTERNS.into_iter().flat_map(by_count).collect()
}

/// The report on one trial per scene, the sweeps, and the patterns.
fn report(trials: Vec<Trial>) -> Report {
    let [scenes, rest] = split(&trials, [SETUPS.len(), 2]);
    let ratios = scenes.iter().zip(&SETUPS).flat_map(|(trial, setup)| ratios(trial, setup)).collect();
    let mut sections = vec![scenes_section(scenes)];
    if let [sweeps, patterns] = rest {
        sections.extend([
            sweep_section(sweeps, "Epsilon", "relative", by_epsilon, &[]),
            sweep_section(sweeps, "Tolerance", "local", by_tolerance, &by_cells()),
            patterns_section(patterns),
        ]);
    }
    Report { lead: lead(scenes), sections, ratios, trials }
}

fn ratios(trial: &Trial, setup: &Setup) -> Vec<Ratio> {
    let Some(base) = trial.run(BASE) else { return Vec::new() };
    let adaptive = ROWS[..2].iter().filter_map(|spec| trial.run(spec));
    adaptive.map(|run| Ratio::speed("speed", trial, run, base, setup.paper)).collect()
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

fn scenes_section(scenes: &[Trial]) -> Section {
    type Row<'a> = (&'a Trial, &'a Run, &'static Setup);
    let base = |row: &Row, text: fn(&Run, &Run) -> String| text::or_dash(row.0.run(BASE).map(|base| text(row.1, base)));
    let columns = [
        columns::technique(),
        columns::count("maps", "Shadow maps, that is sample points of the light", "maps"),
        columns::ms(),
        columns::megabytes(),
        columns::error(),
        columns::rmse(),
        column("speed", "Milliseconds of 128 fixed samples over these", "", move |row: &Row| {
            base(row, |run, base| text::ratio(run.speed_over(base)))
        }),
        column("paper", "The same in the paper", "", |(_, run, setup): &Row| {
            text::or_dash(setup.paper.filter(|_| ROWS[..2].contains(&run.spec.as_str())).map(|p| p.to_string()))
        }),
        column("error − 128's", "Average error minus that of 128 fixed samples", "", move |row: &Row| {
            base(row, |run, base| format!("{:+.4}", run.metrics.average_error - base.metrics.average_error))
        }),
    ];
    let groups = scenes.iter().zip(&SETUPS).map(|(t, setup)| (t.heading(), t.runs.iter().map(move |r| (t, r, setup))));
    let text = format!(
        "{}, maps of 512 x 512. Penumbra is the fraction of the pixels whose reference visibility is over 0.01 and \
         under 0.99. Speed is relative to 128 fixed samples, in the same scene and the same run; the paper's column \
         has its text and figure 7: 5.5 with 7 maps, about 2 with up to 50, 0.66 at worst.",
        scenes.first().map_or(String::new(), Trial::pixels)
    );
    let table = Table::grouped(&columns, groups);
    Section::new("Four sizes of penumbra", text, vec![Content::references(scenes), table.into()])
}

/// Error against milliseconds over a threshold, beside fixed samples, for each filter width and for cells.
fn sweep_section(trial: &Trial, what: &str, criterion: &str, own: fn(u32) -> Vec<String>, cells: &[String]) -> Section {
    let adaptive = |(color, pcf)| error_by_ms(trial, format!("adaptive, pcf={pcf}"), color, &own(pcf));
    let fixed = |(color, pcf)| error_by_ms(trial, format!("fixed, pcf={pcf}"), color, &by_number(pcf)).dashed(true);
    let widths = || PCF.into_iter().enumerate();
    let of_cells = error_by_ms(trial, "adaptive, cells".to_owned(), PCF.len(), cells);
    let of_cells = Some(of_cells).filter(|curve| !curve.points.is_empty());
    let values = if own(1).len() == EPSILONS.len() { EPSILONS.as_slice() } else { &TOLERANCES };
    let values: Vec<String> = values.iter().map(f64::to_string).collect();
    let text = format!(
        "The scene of the medium penumbra at half the size each way, {}. Along a line adaptive-sampling with \
         criterion={criterion} has {} = {}, and uniform-sampling {} samples; from left to right.",
        trial.pixels(),
        what.to_lowercase(),
        values.join(", "),
        FIXED.map(|n| n.to_string()).join(", ")
    );
    let curves = widths().map(adaptive).chain(of_cells).chain(widths().map(fixed));
    let lines = Lines::new("GPU milliseconds per frame", "average error", curves).less_is_better();
    Section::new(format!("{what} and the filter"), text, vec![lines.into()])
}

fn error_by_ms(trial: &Trial, label: String, color: usize, specs: &[String]) -> Curve {
    let point = |run: &Run| {
        let (x, y) = (run.cost.total_ms, run.metrics.average_error);
        let (error, ms, maps) = (text::metric(y), text::ms(x), run.count("maps"));
        Point::new(x, y, format!("{}: error {error}, {ms} ms, {maps} maps", run.spec))
    };
    Curve::new(label, color, specs.iter().filter_map(|s| trial.run(s)).map(point))
}

/// RMSE against the number of samples for each pattern.
fn patterns_section(trial: &Trial) -> Section {
    let curve = |(color, pattern): (usize, &str)| {
        let point = |(n, spec): (u32, String)| {
            let rmse = trial.run(&spec)?.metrics.rmse;
            Some(Point::new(f64::from(n), rmse, format!("{spec}: RMSE {}", text::metric(rmse))))
        };
        Curve::new(pattern, color, COUNTS.into_iter().zip(by_count(pattern)).filter_map(point))
    };
    let text = format!(
        "uniform-sampling in {}, {}: a round umbra, whose edge crosses the light's samples in every direction. The \
         reference goes through the centre of each pixel, as the technique does, with {} rays to the light: only the \
         error of the light's samples remains. Random points would follow n^-1/2, well-distributed points n^-3/4.",
        trial.scene,
        trial.pixels(),
        text::count(trial.light_samples.into())
    );
    let curves = PATTERNS.into_iter().enumerate().map(curve);
    let lines = Lines::new("samples", "RMSE", curves).guides(&[("n^-1/2", -0.5), ("n^-3/4", -0.75)]);
    Section::new("Patterns of points", text, vec![lines.into()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::made_up::{run, trial};

    #[test]
    fn every_spec_and_every_scene_is_known() {
        let texts = [ROWS.map(str::to_owned).to_vec(), sweep(), patterns()].concat();
        let specs: Vec<antumbra::Spec> = texts.iter().map(|text| text.parse().unwrap()).collect();
        assert_eq!(specs.len(), ROWS.len() + 4 * (5 + 6 + 8) + 6 + 3 * 5);
        for setup in &SETUPS {
            let triangles = setup.scene().unwrap().triangle_count();
            assert!((1000..20_000).contains(&triangles), "{}: {triangles}", setup.name);
        }
    }

    #[test]
    fn the_paper_stands_beside_ours() {
        let runs = || ROWS.iter().zip([10.0, 5.0, 40.0, 60.0, 120.0]).map(|(spec, ms)| run(spec, ms, &[("maps", 7.0)]));
        let report = report(SETUPS.iter().map(|setup| trial(setup.name, runs().collect())).collect());
        let ratios: Vec<_> = report.ratios.iter().map(|r| (r.paper, r.ours)).collect();
        assert_eq!(
            (ratios.len(), ratios[0], ratios[1], ratios[4]),
            (8, (Some(5.5), 6.0), (Some(5.5), 12.0), (None, 6.0))
        );
        let said = "7 maps with a small penumbra, 6.0 times as fast (paper: 5.5)";
        assert!(report.lead.contains(said), "{}", report.lead);
        let [Content::Gallery(_), Content::Table(table)] = &report.sections[0].contents[..] else { panic!("a table") };
        assert_eq!(table.groups.len(), 4);
        assert!(table.rows().all(|row| row.len() == table.headings.len()));
        assert_eq!(table.groups[0].rows[0][6..8], ["6.0", "5.5"]);
        assert_eq!(table.groups[0].rows[3][6..8], ["1.0", "–"]);
    }

    #[test]
    fn sweeps_become_a_curve_for_each_width_of_the_filter() {
        let runs = sweep().iter().enumerate().map(|(i, spec)| run(spec, 1.0 + i as f64, &[])).collect();
        let section = sweep_section(&trial("sweeps", runs), "Epsilon", "relative", by_epsilon, &[]);
        assert!(section.text.contains("epsilon = 0.1, 0.03, 0.01, 0.003, 0.001"), "{}", section.text);
        let [Content::Lines(lines)] = &section.contents[..] else { panic!("a plot") };
        let points: Vec<_> = lines.curves.iter().map(|c| c.points.len()).collect();
        assert_eq!(points, [5, 5, 5, 5, 8, 8, 8, 8]);
    }
}
