//! Layered back-projection: error against milliseconds beside its competitors, the effect of its settings, and the
//! causes of its cost. The presets follow from this.

mod cost;
mod error;
mod lights;
mod specs;
mod targets;

use crate::Error;
use crate::kit::{Experiment, Ratio, Report, Runner, Suite, Trial, split, with_map};
use antumbra_scene::{Scene, builtin};
use cost::Costs;
use specs::{COMPARED, Configuration, PCSS, run_of};

pub const SUITE: Suite = Suite {
    name: "backprojection",
    title: "Layered back-projection",
    source: "Guennebaud 2006, 2007",
    summary: "its settings beside PCSS and fixed sampling",
    scenes: true,
    run,
};

const SIZE: [u32; 2] = [512, 512];
/// Built-in scenes with their names here. The finest are coarser than by default: fixed sampling draws them 256 times.
const SCENES: [(&str, &str); 6] = [
    ("fence", "fence"),
    ("layers", "layers"),
    ("plant", "plant"),
    ("spheres", "spheres:segments=32"),
    ("bumpy", "bumpy:side=96"),
    ("atrium", "atrium:bays=3"),
];
/// Scenes of the light sweep. The first has one occluder at a known distance.
const LIT: [&str; 2] = ["square", "layers"];
/// Edge of the light over the occluder's distance from it.
const LIGHTS: [f64; 7] = [0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.0];
/// The scene of the curves over the map and the image.
const PLAIN: &str = "fence";
/// Sides of the images of that curve over the size, as fractions.
const SIDES: [(u32, u32); 4] = [(1, 4), (1, 2), (1, 1), (2, 1)];
/// Trees of the forests in the curve over triangles.
const TREES: [u32; 4] = [1, 4, 16, 64];

fn run(runner: &Runner) -> Result<Report, Error> {
    let configurations = specs::all()?;
    let (trials, counts) = runner.run_groups(groups(runner, &configurations)?)?;
    Ok(report(trials, counts, &configurations))
}

/// Experiments of scenes, lights, maps, images, triangles.
fn groups(runner: &Runner, configurations: &[Configuration]) -> Result<[Vec<Experiment>; 5], Error> {
    let size = runner.size(SIZE);
    let half = scaled(size, (1, 2));
    let drawn = || cost::DRAWN.iter().map(|(_, spec)| *spec);
    // Errors are averaged over the built-in scenes and the command line's.
    let own = SCENES.iter().map(|(name, spec)| Ok((*name, builtin::build(spec)?)));
    let given = runner.scenes.iter().map(|scene| Ok((scene.name.as_str(), scene.clone())));
    let scenes = own.chain(given).map(|named: Result<(&str, Scene), Error>| {
        let (name, scene) = named?;
        Experiment::new(name, scene, size, configurations.iter().map(|c| &c.spec.text))
    });
    let lights = LIT.into_iter().flat_map(|name| LIGHTS.map(|part| (name, part))).map(|(name, part)| {
        let scene = lit(builtin::build(name)?, part);
        Experiment::new(format!("{name}, light {part}"), scene, half, COMPARED.map(|(_, spec)| spec))
    });
    let of_maps = drawn().flat_map(|spec| cost::MAPS.map(|map| with_map(spec, map)));
    let maps = Experiment::new("maps", builtin::build(PLAIN)?, half, of_maps)?;
    let images = SIDES.into_iter().map(|side| {
        let name = format!("image {}/{}", side.0, side.1);
        Experiment::new(name, builtin::build(PLAIN)?, scaled(size, side), drawn())
    });
    let triangles = TREES.into_iter().map(|trees| {
        let scene = builtin::build(&format!("forest:trees={trees}"))?;
        Experiment::new(format!("forest, trees {trees}"), scene, half, drawn())
    });
    Ok([all(scenes)?, all(lights)?, vec![maps], all(images)?, all(triangles)?])
}

fn scaled(size: [u32; 2], (times, over): (u32, u32)) -> [u32; 2] {
    size.map(|side| (side * times / over).max(1))
}

/// The scene with a square light whose edge is this fraction of the occluder's distance from it.
fn lit(mut scene: Scene, part: f64) -> Scene {
    let casters = scene.bounds_of(|instance| !instance.receiver_only);
    let distance = casters.center().distance(scene.light.center);
    scene.light.size = [part as f32 * distance; 2].into();
    scene
}

fn all(experiments: impl Iterator<Item = Result<Experiment, Error>>) -> Result<Vec<Experiment>, Error> {
    experiments.collect()
}

/// The report on the trials, in the order of the experiments.
fn report(trials: Vec<Trial>, counts: [usize; 5], configurations: &[Configuration]) -> Report {
    let [scenes, lights, maps, images, triangles] = split(&trials, counts);
    let (targets, lead) = targets::section(scenes);
    let ratios = scenes.iter().flat_map(ratios).collect();
    let mut sections =
        vec![targets, error::pareto(scenes, configurations), error::settings(scenes), error::scenes(scenes)];
    if let [maps] = maps {
        let by_size = lights.chunks(LIGHTS.len()).map(|trials| LIGHTS.into_iter().zip(trials).collect());
        let sweeps: Vec<_> = LIT.into_iter().zip(by_size).collect();
        sections.push(lights::section(&sweeps));
        sections.push(cost::section(&Costs { lights: &sweeps, maps, images, triangles }));
    }
    Report { lead, sections, ratios, trials }
}

/// Speed of the presets over PCSS.
fn ratios(trial: &Trial) -> Vec<Ratio> {
    let ratio = |(_, spec): &(&str, &str)| {
        let (run, pcss) = (run_of(trial, spec)?, run_of(trial, PCSS)?);
        let (trial, ours) = (trial.name.clone(), run.speed_over(pcss));
        Some(Ratio { what: "speed", trial, spec: (*spec).to_owned(), base: PCSS.to_owned(), paper: None, ours })
    };
    COMPARED[..3].iter().filter_map(ratio).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::made_up::{run, trial};

    #[test]
    fn every_scene_is_known_and_bearable() {
        for (name, spec) in SCENES {
            let triangles = builtin::build(spec).unwrap().triangle_count();
            assert!((1000..100_000).contains(&triangles), "{name}: {triangles}");
        }
        for trees in TREES {
            builtin::build(&format!("forest:trees={trees}")).unwrap();
        }
    }

    #[test]
    fn lights_are_parts_of_the_distance() {
        let square = lit(builtin::build(LIT[0]).unwrap(), 3.0);
        assert!(square.light.size.abs_diff_eq([6.0; 2].into(), 0.01), "{}", square.light.size);
    }

    #[test]
    fn every_part_is_filled_in_the_order_of_the_plan() {
        let all = specs::all().unwrap();
        let of = |name: &str, specs: &[String]| trial(name, specs.iter().map(|spec| run(spec, 3.0, &[])).collect());
        let every: Vec<String> = all.iter().map(|c| c.spec.text.clone()).collect();
        let few: Vec<String> = COMPARED.iter().map(|(_, spec)| (*spec).to_owned()).collect();
        let rest = LIT.len() * LIGHTS.len() + 1 + SIDES.len() + TREES.len();
        let trials: Vec<Trial> =
            SCENES.iter().map(|(name, _)| of(name, &every)).chain((0..rest).map(|_| of("rest", &few))).collect();
        let counts = [SCENES.len(), LIT.len() * LIGHTS.len(), 1, SIDES.len(), TREES.len()];
        let report = report(trials, counts, &all);
        let titles: Vec<&str> = report.sections.iter().map(|section| section.title.as_str()).collect();
        assert_eq!((titles.len(), titles[0], titles[5]), (6, "Targets", "Milliseconds"));
        assert_eq!(report.ratios.len(), 3 * SCENES.len());
        assert!(report.lead.contains("of 9 targets are met"), "{}", report.lead);
    }
}
