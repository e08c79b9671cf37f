//! The whole family: error over the light's size and the map's, cost over the filter's width.

use super::super::kit::{Group, Lab, Part, Run, Shown, Table, Trial, specs, with_map};
use super::{Job, read, with_point_light};
use crate::error::CliError;
use crate::report::lines::{Curve, Lines, Spot};
use crate::report::text;
use antumbra_scene::{Scene, builtin};

const HARD: [&str; 5] = ["vsm", "evsm", "msm", "esm", "csm"];
const SOFT: [&str; 3] = ["savsm", "vssm", "cssm"];
const SCENES: [&str; 2] = ["fence", "layers"];
/// The light's edge, as a part of what it is in the scene.
const LIGHTS: [f64; 6] = [0.05, 0.1, 0.25, 0.5, 1.0, 2.0];
const MAPS: [u32; 4] = [256, 512, 1024, 2048];
const BLURS: [u32; 5] = [1, 3, 7, 15, 31];
const SIZE: [u32; 2] = [384, 384];

/// What costs are compared with.
const COMPARED: &str = "pcss";

fn with_light(mut scene: Scene, part: f64) -> Scene {
    scene.light.size *= part as f32;
    scene
}

pub fn jobs(lab: &Lab) -> Result<Vec<Job>, CliError> {
    let size = lab.args.size.map_or(SIZE, |size| size.0.map(|side| (side / 2).max(1)));
    let frames = lab.args.gpu.frames;
    let all: Vec<&str> = HARD.into_iter().chain(SOFT).chain([COMPARED]).collect();
    let mut jobs = Vec::new();
    for scene in SCENES {
        for part in LIGHTS {
            jobs.push(Job {
                name: format!("{scene}, light {part}"),
                scene: with_light(builtin::build(scene)?, part),
                size,
                specs: read(&all)?,
                hard: false,
                pictures: false,
                frames,
            });
        }
    }
    let of_maps = |list: &[&str]| specs(list.iter().flat_map(|s| MAPS.map(|map| with_map(s, map))).collect());
    for (name, list, hard) in [("maps, hard", &HARD[..], true), ("maps, soft", &SOFT[..], false)] {
        let scene = builtin::build(SCENES[0])?;
        jobs.push(Job {
            name: name.into(),
            scene: if hard { with_point_light(scene) } else { scene },
            size,
            specs: of_maps(list)?,
            hard,
            pictures: false,
            frames: 0,
        });
    }
    jobs.push(Job {
        name: "blurs".into(),
        scene: with_point_light(builtin::build(SCENES[0])?),
        size,
        specs: specs(
            BLURS.map(|n| format!("vsm:blur={n}")).into_iter().chain(BLURS.map(|n| format!("pcf:pcf={n}"))).collect(),
        )?,
        hard: true,
        pictures: false,
        frames,
    });
    Ok(jobs)
}

const ERROR_HEADS: [(&str, &str); 6] = [
    ("technique", "Name and settings"),
    ("RMSE", "Root of the mean squared error, all valid pixels"),
    ("error", "Mean |error| where the truth is under 0.999"),
    ("leak", "Mean visibility where the truth is under 0.001: light in the umbra"),
    ("acne", "Mean darkness where the truth is over 0.999"),
    ("MB", "GPU memory that the technique owns, 10⁶ bytes"),
];

/// Errors and memory of a trial.
pub fn error_table(trial: &Trial) -> Table {
    let row = |run: &Run| {
        let f = &run.figures;
        let figures = [f.rmse, f.average_error, f.leak, f.acne].map(text::figure);
        std::iter::once(run.spec.clone()).chain(figures).chain([text::megabytes(run.cost.total_bytes)]).collect()
    };
    let rows = trial.runs.iter().map(row).collect();
    Table { heads: ERROR_HEADS.to_vec(), groups: vec![Group { title: String::new(), rows }] }
}

pub fn parts(trials: &[Trial]) -> Vec<Part> {
    let Some((lights, [hard, soft, blurs])) = trials.split_at_checked(SCENES.len() * LIGHTS.len()) else {
        return Vec::new();
    };
    let mut parts: Vec<Part> =
        lights.chunks(LIGHTS.len()).zip(SCENES).map(|(trials, scene)| by_light(scene, trials)).collect();
    parts.push(by_map(hard, soft));
    parts.push(by_width(lights, blurs));
    parts
}

fn lines(x: &str, y: &str, curves: Vec<Curve>) -> Shown {
    Shown::Lines(Lines { x: x.into(), y: y.into(), less_is_better: false, curves, guides: Vec::new() })
}

fn spot(x: f64, run: &Run, value: fn(&Run) -> f64) -> Spot {
    let y = value(run);
    Spot { x, y, note: format!("{} at {x}: {}", run.spec, text::figure(y)) }
}

/// A curve a technique over the light's size.
fn over_lights(trials: &[Trial], list: &[&str], value: fn(&Run) -> f64) -> Vec<Curve> {
    let curve = |(color, spec): (usize, &&str)| {
        let points =
            LIGHTS.iter().zip(trials).filter_map(|(x, trial)| Some(spot(*x, trial.run(spec)?, value))).collect();
        Curve { label: (*spec).to_owned(), color: color % 8, dashed: color >= 8, points }
    };
    list.iter().enumerate().map(curve).collect()
}

fn by_light(scene: &str, trials: &[Trial]) -> Part {
    let all: Vec<&str> = SOFT.into_iter().chain(HARD).chain([COMPARED]).collect();
    let full = LIGHTS.iter().position(|part| *part == 1.0).and_then(|i| trials.get(i));
    let mut shown = vec![lines(
        "size of the light ÷ that of the scene",
        "average error",
        over_lights(trials, &all, |run| run.figures.average_error),
    )];
    shown.extend(full.map(|trial| Shown::Table(error_table(trial))));
    Part {
        title: format!("Error over the size of the light: {scene}"),
        text:
            "Against the area light's truth. Hard techniques know a point only, so their error grows with the light. \
               Under a small light they are nearer, for they filter over the pixel; soft techniques and the comparison \
               sample its middle, which small pictures show most. The table is for the scene's own light."
                .into(),
        shown,
    }
}

fn by_map(hard: &Trial, soft: &Trial) -> Part {
    let curves = |trial: &Trial, list: &[&str]| {
        let curve = |(color, spec): (usize, &&str)| {
            let at = |map: u32| Some(spot(f64::from(map), trial.run(&with_map(spec, map))?, |run| run.figures.rmse));
            Curve { label: (*spec).to_owned(), color, dashed: false, points: MAPS.into_iter().filter_map(at).collect() }
        };
        list.iter().enumerate().map(curve).collect::<Vec<_>>()
    };
    Part {
        title: "Error over the size of the map".into(),
        text: format!("{}: hard techniques against a hard shadow filtered over the pixel, then soft ones.", SCENES[0]),
        shown: vec![
            lines("texels a side of the map", "RMSE", curves(hard, &HARD)),
            lines("texels a side of the map", "RMSE", curves(soft, &SOFT)),
        ],
    }
}

/// Milliseconds of the pass that filters.
fn filter_ms(run: &Run) -> f64 {
    let filters = ["soft lookup", "blocker search and filter"];
    let own = run.cost.passes.iter().filter(|pass| filters.contains(&pass.name.as_str()));
    own.filter_map(|pass| pass.ms).sum()
}

fn by_width(lights: &[Trial], blurs: &Trial) -> Part {
    let of_blur = |(color, (label, stem)): (usize, (&str, &str))| {
        let at = |n: u32| Some(spot(f64::from(n), blurs.run(&format!("{stem}={n}"))?, |run| run.cost.total_ms));
        Curve { label: label.into(), color, dashed: false, points: BLURS.into_iter().filter_map(at).collect() }
    };
    let blurred = [("vsm, blur", "vsm:blur"), ("pcf, kernel", "pcf:pcf")];
    let soft: Vec<&str> = SOFT.into_iter().chain([COMPARED]).collect();
    Part {
        title: "Cost over the width of the filter".into(),
        text: "The filter of the soft techniques is as wide as the light makes it: four corners of a summed-area table serve \
               any width, so what grows is the number of pixels in penumbra, which the second plot divides out. Below, the \
               blur of a map and the kernel of comparisons."
            .into(),
        shown: vec![
            lines("size of the light ÷ that of the scene", "ms of the filter's pass", over_lights(&lights[..LIGHTS.len()], &soft, filter_ms)),
            lines("size of the light ÷ that of the scene", "the same ÷ penumbra", per_penumbra(&lights[..LIGHTS.len()], &soft)),
            lines("texels", "ms", blurred.into_iter().enumerate().map(of_blur).collect()),
        ],
    }
}

fn per_penumbra(trials: &[Trial], list: &[&str]) -> Vec<Curve> {
    let curve = |(color, spec): (usize, &&str)| {
        let at = |(x, trial): (&f64, &Trial)| {
            let y = filter_ms(trial.run(spec)?) / trial.penumbra.max(1e-3);
            Some(Spot { x: *x, y, note: format!("{spec} at {x}: {}", text::ms(y)) })
        };
        let points = LIGHTS.iter().zip(trials).filter_map(at).collect();
        Curve { label: (*spec).to_owned(), color, dashed: false, points }
    };
    list.iter().enumerate().map(curve).collect()
}
