//! The whole family: error over the light's size and the map's, cost over the filter's width.

use super::errors;
use crate::Error;
use crate::kit::{Content, Experiment, Run, Runner, Section, Trial, with_map};
use crate::page::lines::{Curve, Lines, Point};
use crate::page::text;
use antumbra_scene::{Scene, builtin};

const HARD: [&str; 5] = ["vsm", "evsm", "msm", "esm", "csm"];
const SOFT: [&str; 3] = ["savsm", "vssm", "cssm"];
const SCENES: [&str; 2] = ["fence", "layers"];
/// The light's edge relative to that of the scene.
const LIGHTS: [f64; 6] = [0.05, 0.1, 0.25, 0.5, 1.0, 2.0];
const MAPS: [u32; 4] = [256, 512, 1024, 2048];
const BLURS: [u32; 5] = [1, 3, 7, 15, 31];
const SIZE: [u32; 2] = [384, 384];

/// The reference of the costs.
const COMPARED: &str = "pcss";

fn with_light(mut scene: Scene, part: f64) -> Scene {
    scene.light.size *= part as f32;
    scene
}

pub fn experiments(runner: &Runner) -> Result<Vec<Experiment>, Error> {
    let size = runner.half_size(SIZE);
    let plain = || builtin::build(SCENES[0]);
    let all = HARD.into_iter().chain(SOFT).chain([COMPARED]);
    let mut experiments = Vec::new();
    for scene in SCENES {
        for part in LIGHTS {
            let (name, scene) = (format!("{scene}, light {part}"), with_light(builtin::build(scene)?, part));
            experiments.push(Experiment::new(name, scene, size, all.clone())?);
        }
    }
    let of_maps = |list: &[&str]| list.iter().flat_map(|s| MAPS.map(|map| with_map(s, map))).collect::<Vec<_>>();
    experiments.push(Experiment::new("maps, hard", plain()?, size, of_maps(&HARD))?.with_point_light().untimed());
    experiments.push(Experiment::new("maps, soft", plain()?, size, of_maps(&SOFT))?.untimed());
    let blurs = ["vsm:blur", "pcf:pcf"].into_iter().flat_map(|stem| BLURS.map(|n| format!("{stem}={n}")));
    experiments.push(Experiment::new("blurs", plain()?, size, blurs)?.with_point_light());
    Ok(experiments)
}

pub fn sections(trials: &[Trial]) -> Vec<Section> {
    let Some((lights, [hard, soft, blurs])) = trials.split_at_checked(SCENES.len() * LIGHTS.len()) else {
        return Vec::new();
    };
    let by_scene = lights.chunks(LIGHTS.len()).zip(SCENES);
    let mut sections: Vec<Section> = by_scene.map(|(trials, scene)| by_light(scene, trials)).collect();
    sections.extend([by_map(hard, soft), by_width(&lights[..LIGHTS.len()], blurs)]);
    sections
}

/// Title of the axis of [`LIGHTS`].
const LIGHT_AXIS: &str = "size of the light ÷ that of the scene";
/// Title of the axis of [`MAPS`].
const MAP_AXIS: &str = "texels per side of the map";

fn point(x: f64, run: &Run, value: fn(&Run) -> f64) -> Point {
    let y = value(run);
    Point::new(x, y, format!("{} at {x}: {}", run.spec, text::metric(y)))
}

/// One curve per technique; `at` gives its points.
fn curves<'a, P: IntoIterator<Item = Point>>(list: &[&'a str], at: impl Fn(&'a str) -> P) -> Vec<Curve> {
    let curve = |(color, spec): (usize, &&'a str)| Curve::new(*spec, color % 8, at(spec)).dashed(color >= 8);
    list.iter().enumerate().map(curve).collect()
}

/// One curve per technique over the light's size.
fn over_lights(trials: &[Trial], list: &[&str], value: fn(&Run) -> f64) -> Vec<Curve> {
    curves(list, |spec| LIGHTS.iter().zip(trials).filter_map(move |(x, t)| Some(point(*x, t.run(spec)?, value))))
}

fn by_light(scene: &str, trials: &[Trial]) -> Section {
    let all: Vec<&str> = SOFT.into_iter().chain(HARD).chain([COMPARED]).collect();
    let full = LIGHTS.iter().position(|part| *part == 1.0).and_then(|i| trials.get(i));
    let errors = over_lights(trials, &all, |run| run.metrics.average_error);
    let mut contents: Vec<Content> = vec![Lines::new(LIGHT_AXIS, "average error", errors).into()];
    contents.extend(full.map(|trial| errors::table(trial).into()));
    Section::new(
        format!("Error over the size of the light: {scene}"),
        "Against the area light's reference. Hard techniques know a point only, so their error grows with the light. \
         Under a small light they are nearer, for they filter over the pixel; soft techniques and the comparison \
         sample its centre, which shows most in small images. The table is for the scene's own light.",
        contents,
    )
}

fn by_map(hard: &Trial, soft: &Trial) -> Section {
    let plot = |trial: &Trial, list: &[&str]| {
        let at = |spec: &str| {
            MAPS.into_iter()
                .filter_map(|map| Some(point(map.into(), trial.run(&with_map(spec, map))?, |run| run.metrics.rmse)))
                .collect::<Vec<_>>()
        };
        Lines::new(MAP_AXIS, "RMSE", curves(list, at)).into()
    };
    let text = format!("{}: hard techniques against a hard shadow filtered over the pixel, then soft ones.", SCENES[0]);
    Section::new("Error over the size of the map", text, vec![plot(hard, &HARD), plot(soft, &SOFT)])
}

/// Milliseconds of the filter pass.
fn filter_ms(run: &Run) -> f64 {
    let filters = ["soft lookup", "blocker search and filter"];
    run.cost.ms_of(|pass| filters.contains(&pass.name.as_str())).unwrap_or(0.0)
}

fn by_width(lights: &[Trial], blurs: &Trial) -> Section {
    let of_blur = |(color, (label, stem)): (usize, (&str, &str))| {
        let at = |n: u32| Some(point(n.into(), blurs.run(&format!("{stem}={n}"))?, |run| run.cost.total_ms));
        Curve::new(label, color, BLURS.into_iter().filter_map(at))
    };
    let blurred = [("vsm, blur", "vsm:blur"), ("pcf, kernel", "pcf:pcf")];
    let soft: Vec<&str> = SOFT.into_iter().chain([COMPARED]).collect();
    Section::new(
        "Cost over the width of the filter",
        "The light sets the filter width of the soft techniques. A summed-area table needs four samples for any width, \
         so only the number of pixels in penumbra grows; the second plot divides by it. Below: the blur of a map and \
         the kernel of comparisons.",
        vec![
            Lines::new(LIGHT_AXIS, "ms of the filter's pass", over_lights(lights, &soft, filter_ms)).into(),
            Lines::new(LIGHT_AXIS, "the same ÷ penumbra", per_penumbra(lights, &soft)).into(),
            Lines::new("texels", "ms", blurred.into_iter().enumerate().map(of_blur)).into(),
        ],
    )
}

fn per_penumbra(trials: &[Trial], list: &[&str]) -> Vec<Curve> {
    curves(list, |spec| {
        LIGHTS.iter().zip(trials).filter_map(move |(x, trial)| {
            let y = filter_ms(trial.run(spec)?) / trial.penumbra.max(1e-3);
            Some(Point::new(*x, y, format!("{spec} at {x}: {}", text::ms(y))))
        })
    })
}
