//! Layered back-projection: error against milliseconds beside what it competes with, what its settings do, and what its
//! cost depends on. The presets follow from this.

mod cost;
mod error;
mod specs;
mod targets;

use super::Suite;
use super::kit::{self, Findings, Lab, Order, Ratio, Trial};
use crate::error::CliError;
use antumbra::Spec;
use antumbra_scene::{Scene, builtin};
use cost::Costs;
use error::Lit;
use specs::{COMPARED, Configuration, PCSS};

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
/// Scenes whose light grows. The first has one occluder, at a distance that is known.
const LIT: [&str; 2] = ["square", "layers"];
/// Edge of the light, as a part of the occluder's distance from it.
const LIGHTS: [f64; 7] = [0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.0];
/// The scene of the curves over the map and the picture.
const PLAIN: &str = "fence";
/// Sides of the pictures of that curve, as parts of the size: above one line, below the other.
const SIDES: [(u32, u32); 4] = [(1, 4), (1, 2), (1, 1), (2, 1)];
/// Trees of the forests of the curve over triangles.
const TREES: [u32; 4] = [1, 4, 16, 64];

fn run(lab: &Lab) -> Result<Findings, CliError> {
    let configurations = specs::all()?;
    let plan = Plan::new(lab, &configurations)?;
    let orders: Vec<Order> = plan.jobs.iter().map(|job| job.order(lab)).collect();
    let trials = lab.trials(&orders)?;
    Ok(findings(trials, plan.scenes, &configurations))
}

/// What is measured, in this order: scenes, lights, maps, pictures, triangles.
struct Plan {
    /// How many of the jobs are scenes.
    scenes: usize,
    jobs: Vec<Job>,
}

/// One trial to be, with all that it needs.
struct Job {
    name: String,
    scene: Scene,
    size: [u32; 2],
    specs: Vec<Spec>,
}

impl Job {
    fn order<'a>(&'a self, lab: &'a Lab) -> Order<'a> {
        let (frames, truth) = (lab.args.gpu.frames, &lab.args.truth);
        Order {
            name: &self.name,
            scene: &self.scene,
            size: self.size,
            specs: &self.specs,
            frames,
            truth,
            pictures: false,
        }
    }
}

impl Plan {
    fn new(lab: &Lab, configurations: &[Configuration]) -> Result<Plan, CliError> {
        let size = lab.size(SIZE);
        let half = scaled(size, (1, 2));
        let mut jobs = scenes(lab, size, configurations)?;
        let scenes = jobs.len();
        let texts = |of: &[(&str, &str)]| kit::specs(of.iter().map(|(_, spec)| (*spec).to_owned()).collect());
        for name in LIT {
            for part in LIGHTS {
                let (name, scene) = (format!("{name}, light {part}"), lit(builtin::build(name)?, part));
                jobs.push(Job { name, scene, size: half, specs: texts(&COMPARED)? });
            }
        }
        let of_maps = cost::DRAWN.iter().flat_map(|(_, spec)| cost::MAPS.map(|map| kit::with_map(spec, map)));
        let specs = kit::specs(of_maps.collect())?;
        jobs.push(Job { name: "maps".into(), scene: builtin::build(PLAIN)?, size: half, specs });
        for side in SIDES {
            let (size, name) = (scaled(size, side), format!("picture {}/{}", side.0, side.1));
            jobs.push(Job { name, scene: builtin::build(PLAIN)?, size, specs: texts(&cost::DRAWN)? });
        }
        for trees in TREES {
            let (name, scene) = (format!("forest, trees {trees}"), builtin::build(&format!("forest:trees={trees}"))?);
            jobs.push(Job { name, scene, size: half, specs: texts(&cost::DRAWN)? });
        }
        Ok(Plan { scenes, jobs })
    }
}

/// The scenes that errors are averaged over: the built-in ones, then the command line's.
fn scenes(lab: &Lab, size: [u32; 2], configurations: &[Configuration]) -> Result<Vec<Job>, CliError> {
    let own = SCENES.iter().map(|(name, spec)| Ok(((*name).to_owned(), builtin::build(spec)?)));
    let given = lab.scenes.iter().map(|scene| Ok((scene.name.clone(), scene.clone())));
    let specs: Vec<Spec> = configurations.iter().map(|c| c.spec.clone()).collect();
    let job = |named: Result<(String, Scene), CliError>| {
        named.map(|(name, scene)| Job { name, scene, size, specs: specs.clone() })
    };
    own.chain(given).map(job).collect()
}

fn scaled(size: [u32; 2], (times, over): (u32, u32)) -> [u32; 2] {
    size.map(|side| (side * times / over).max(1))
}

/// The scene with a square light whose edge is this part of the occluder's distance from it.
fn lit(mut scene: Scene, part: f64) -> Scene {
    let casters = scene.bounds_of(|instance| !instance.receiver_only);
    let distance = casters.center().distance(scene.light.center);
    scene.light.size = [part as f32 * distance; 2].into();
    scene
}

/// Puts into words, tables and curves what was measured, in the order of the plan.
fn findings(trials: Vec<Trial>, scenes: usize, configurations: &[Configuration]) -> Findings {
    let (scenes, rest) = trials.split_at(scenes.min(trials.len()));
    let (targets, lead) = targets::part(scenes);
    let ratios = scenes.iter().flat_map(ratios).collect();
    let mut parts =
        vec![targets, error::pareto(scenes, configurations), error::settings(scenes), error::scenes(scenes)];
    if let Some((lights, [maps, rest @ ..])) = rest.split_at_checked(LIT.len() * LIGHTS.len())
        && let Some((pictures, triangles)) = rest.split_at_checked(SIDES.len())
    {
        let sweeps: Vec<_> = LIT.into_iter().zip(lights.chunks(LIGHTS.len()).map(by_size)).collect();
        parts.push(error::lights(&sweeps));
        parts.push(cost::part(&Costs { lights: &sweeps, maps, pictures, triangles }));
    }
    Findings { lead, parts, ratios, trials }
}

/// Trials of a scene, each with the size of its light.
fn by_size(trials: &[Trial]) -> Vec<Lit<'_>> {
    LIGHTS.into_iter().zip(trials).collect()
}

/// How many times as fast as PCSS the presets are.
fn ratios(trial: &Trial) -> Vec<Ratio> {
    let ratio = |(_, spec): &(&str, &str)| {
        Some(Ratio {
            what: "speed",
            trial: trial.name.clone(),
            spec: (*spec).to_owned(),
            base: PCSS.to_owned(),
            paper: None,
            ours: targets::speed_over_pcss(trial, spec)?,
        })
    };
    COMPARED[..3].iter().filter_map(ratio).collect()
}

#[cfg(test)]
mod tests {
    use super::super::kit::tests::{run, trial};
    use super::*;

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
        let findings = findings(trials, SCENES.len(), &all);
        let titles: Vec<&str> = findings.parts.iter().map(|part| part.title.as_str()).collect();
        assert_eq!((titles.len(), titles[0], titles[5]), (6, "Targets", "Milliseconds"));
        assert_eq!(findings.ratios.len(), 3 * SCENES.len());
        assert!(findings.lead.contains("of 9 targets are met"), "{}", findings.lead);
    }
}
