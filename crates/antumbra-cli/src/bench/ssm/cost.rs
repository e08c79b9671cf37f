//! What milliseconds depend on: figures 21 to 25, the second pass, levels against the flat map, gathering against
//! blending, and the paper's way over the CPU.

use super::super::kit::{Group, Lab, Part, Ratio, Shown, Table};
use super::readback;
use super::scenes::{Occluder, Place};
use super::stage::{Sample, Stage};
use crate::error::CliError;
use crate::report::lines::{Curve, Guide, Lines, Spot};
use crate::report::text;

/// Copies of the occluder; the last is to exceed the paper's 340 000 triangles.
const COPIES: [u32; 4] = [1, 2, 4, 6];
const MAPS: [u32; 5] = [64, 128, 256, 512, 1024];
const LARGEST_FLAT: u32 = 256;
const LIGHTS: [f32; 5] = [0.01, 0.02, 0.05, 0.1, 0.2];
const LIGHT_MAPS: [u32; 3] = [64, 128, 256];
/// The map of the comparison with the CPU, and of levels with the flat map.
const LARGE: u32 = 512;

/// What is compared with the paper's bounds.
pub struct Costs {
    /// Milliseconds of a map of 512 x 512 over those of 128 x 128, two passes.
    pub large_over_small: f64,
    /// Of two passes over one, map of 128 x 128, the median over the copies.
    pub second_pass: f64,
    /// Ours over the CPU's way, map of 512 x 512, one pass.
    pub over_cpu: f64,
    /// Error of levels less that of the flat map, 512 x 512.
    pub levels_error: f64,
    /// Milliseconds of the flat map over those of levels.
    pub levels_speed: f64,
}

/// What has come out so far.
#[derive(Default)]
pub struct Measured {
    pub parts: Vec<Part>,
    pub ratios: Vec<Ratio>,
}

pub fn measure(lab: &Lab, occluder: &Occluder, found: &mut Measured) -> Result<Costs, CliError> {
    eprintln!("costs: {}", occluder.name);
    let frames = lab.args.gpu.frames;
    let usual = Stage::new(lab, occluder.scene(Place::default()))?;
    let second_pass = triangles(lab, occluder, frames, found)?;
    let large_over_small = maps(&usual, frames, found)?;
    lights(lab, occluder, frames, found)?;
    let (levels_error, levels_speed) = levels(&usual, found)?;
    let over_cpu = over_the_cpu(&usual, frames, found)?;
    Ok(Costs { large_over_small, second_pass, over_cpu, levels_error, levels_speed })
}

fn curve(label: &str, color: usize, dashed: bool, points: Vec<(f64, f64, String)>) -> Curve {
    let points = points.into_iter().map(|(x, y, note)| Spot { x, y, note }).collect();
    Curve { label: label.into(), color, dashed, points }
}

fn plot(x: &str, y: &str, curves: Vec<Curve>, guide: Option<(&str, f64)>) -> Shown {
    let guides = guide.into_iter().map(|(label, exponent)| Guide { label: label.into(), exponent }).collect();
    Shown::Lines(Lines { x: x.into(), y: y.into(), less_is_better: false, curves, guides })
}

const MS: &str = "milliseconds a frame";

fn ratio(stage: &Stage, what: &'static str, spec: &str, base: &str, paper: f64, ours: f64) -> Ratio {
    Ratio { what, trial: stage.scene.name.clone(), spec: spec.into(), base: base.into(), paper: Some(paper), ours }
}

/// Figures 21 and 25: copies of the occluder side by side.
fn triangles(lab: &Lab, occluder: &Occluder, frames: u32, found: &mut Measured) -> Result<f64, CliError> {
    const ONE: &str = "ssm:map=128,passes=1,hierarchy=false";
    const TWO: &str = "ssm:map=128,passes=2,hierarchy=false";
    let specs = [
        ONE,
        TWO,
        "ssm:map=210",
        "pcss:map=512",
        "backprojection:quality=fast,map=512",
        "uniform-sampling:map=512,samples=16",
    ];
    let mut curves: Vec<Curve> = specs.iter().enumerate().map(|(i, s)| curve(s, i, i > 2, Vec::new())).collect();
    let mut factors = Vec::new();
    for copies in COPIES {
        let stage = Stage::new(lab, occluder.copies(copies, 0.1))?;
        let x = stage.scene.triangle_count() as f64;
        let times = specs.iter().map(|spec| stage.time(spec, frames)).collect::<Result<Vec<_>, _>>()?;
        for (curve, (spec, ms)) in curves.iter_mut().zip(specs.iter().zip(&times)) {
            let note = format!("{spec}, {} triangles: {} ms", text::count(x as u64), text::ms(*ms));
            curve.points.push(Spot { x, y: *ms, note });
        }
        let factor = times[1] / times[0];
        found.ratios.push(ratio(&stage, "second pass", TWO, ONE, 1.7, factor));
        factors.push(factor);
    }
    found.parts.push(Part {
        title: "Triangles (figures 21 and 25)".into(),
        text: format!(
            "Copies of {} side by side, light of 0.1. The paper: linear in triangles, over 30 frames a second with \
             340 000 on a GeForce 6800 Ultra; two passes take 1.6 to 1.8 times as long as one. Its figure 25 compares \
             maps of 210 x 210 with soft shadow volumes, whose time grows faster with copies; here the others of this \
             program (broken lines) stand beside it.",
            occluder.name
        ),
        shown: vec![plot("triangles", MS, curves, Some(("x", 1.0)))],
    });
    factors.sort_by(f64::total_cmp);
    Ok(0.5 * (factors[(factors.len() - 1) / 2] + factors[factors.len() / 2]))
}

/// Figure 22: texels of the map; gathering and blending, levels and the flat map.
fn maps(stage: &Stage, frames: u32, found: &mut Measured) -> Result<f64, CliError> {
    let variants = [
        ("gather, levels", "", 1024),
        ("gather, levels, one pass", ",passes=1", 1024),
        ("gather, flat", ",hierarchy=false", LARGEST_FLAT),
        ("blend, levels", ",accumulate=blend", LARGEST_FLAT),
        ("blend, flat", ",hierarchy=false,accumulate=blend", 128),
    ];
    let mut curves = Vec::new();
    let mut times = Vec::new();
    for (i, (label, rest, largest)) in variants.into_iter().enumerate() {
        let mut points = Vec::new();
        for map in MAPS.into_iter().filter(|map| *map <= largest) {
            let spec = format!("ssm:map={map}{rest}");
            let ms = stage.time(&spec, frames)?;
            if i == 0 {
                times.push((map, ms));
            }
            points.push((f64::from(map * map), ms, format!("{spec}: {} ms", text::ms(ms))));
        }
        curves.push(curve(label, i, false, points));
    }
    let of = |map: u32| times.iter().find(|(m, _)| *m == map).map_or(f64::NAN, |(_, ms)| *ms);
    let paper = [(128.0, 10.0), (256.0, 50.0), (512.0, 150.0)].map(|(map, ms): (f64, f64)| {
        let scaled = ms / 10.0 * of(128);
        (map * map, scaled, format!("the paper: {ms} ms with {map} x {map}, drawn relative to 128 x 128"))
    });
    curves.push(curve("the paper, relative to 128 x 128", 7, true, paper.to_vec()));
    let growth = of(LARGE) / of(128);
    let [large, small] = [LARGE, 128].map(|map| format!("ssm:map={map}"));
    found.ratios.push(ratio(stage, "milliseconds, 512 over 128 texels a side", &large, &small, 15.0, growth));
    found.parts.push(Part {
        title: "Texels of the map (figure 22)".into(),
        text: "Light of 0.1. The paper: linear in texels, since their transfer to the CPU dominates; 10 to 50 ms for \
               128 x 128 and 256 x 256, 150 ms for 512 x 512. Without the transfer the flat map grows with the square \
               of texels, as each has a rectangle of more texels; levels grow with texels."
            .into(),
        shown: vec![plot("texels of the map", MS, curves, Some(("x", 1.0)))],
    });
    Ok(growth)
}

/// Figure 24: the light's size at three sizes of map.
fn lights(lab: &Lab, occluder: &Occluder, frames: u32, found: &mut Measured) -> Result<(), CliError> {
    let variants: Vec<(u32, bool)> = LIGHT_MAPS.iter().flat_map(|&m| [(m, false), (m, true)]).collect();
    let mut samples: Vec<Vec<(f64, Sample)>> = vec![Vec::new(); variants.len()];
    for light in LIGHTS {
        let stage = Stage::new(lab, occluder.scene(Place { light, ..Place::default() }))?;
        for (of, (map, levels)) in samples.iter_mut().zip(&variants) {
            of.push((f64::from(light), stage.sample(&format!("ssm:map={map},hierarchy={levels}"), frames)?));
        }
    }
    let curves = |value: fn(&Sample) -> f64| {
        let curve = |((map, levels), samples): (&(u32, bool), &Vec<(f64, Sample)>)| {
            let note = |x: f64, s: &Sample| format!("{}, light {x}: {}", s.spec, text::figure(value(s)));
            let points = samples.iter().map(|(x, s)| (*x, value(s), note(*x, s))).collect();
            let color = LIGHT_MAPS.iter().position(|m| m == map).unwrap_or(0);
            let label = format!("{map} x {map}, {}", if *levels { "levels" } else { "flat" });
            curve(&label, color, *levels, points)
        };
        variants.iter().zip(&samples).map(curve).collect::<Vec<_>>()
    };
    let x = "edge of the light; the scene is 1 wide, the occluder 0.2";
    let error = "average error of the soft shadow map";
    found.parts.push(Part {
        title: "Milliseconds and error over the light's size (figure 24)".into(),
        text:
            "Two passes. The paper: time grows with the light; a large light needs no large map for the same error, a \
               small light does."
                .into(),
        shown: vec![plot(x, MS, curves(|s| s.ms), None), plot(x, error, curves(|s| s.error), None)],
    });
    Ok(())
}

/// Levels against the flat map.
fn levels(stage: &Stage, found: &mut Measured) -> Result<(f64, f64), CliError> {
    let of_map = |map: u32| {
        let rest = ["hierarchy=false", "window=4", "window=8", "window=16"];
        rest.iter().map(|rest| stage.sample(&format!("ssm:map={map},{rest}"), 1)).collect::<Result<Vec<_>, CliError>>()
    };
    let mut groups = Vec::new();
    let mut last = (0.0, 0.0);
    for map in [128, 256, LARGE] {
        let samples = of_map(map)?;
        let flat = &samples[0];
        let row = |s: &Sample| {
            let difference = format!("{:+.4}", s.error - flat.error);
            vec![s.spec.clone(), text::figure(s.error), difference, text::ms(s.ms), text::ratio(flat.ms / s.ms)]
        };
        groups.push(Group { title: format!("{map} x {map}"), rows: samples.iter().map(row).collect() });
        last = (samples[2].error - flat.error, flat.ms / samples[2].ms);
    }
    let heads = vec![
        ("technique", "Name and settings"),
        ("error", "Average error of the soft shadow map"),
        ("− flat", "The same less that of the flat map"),
        ("ms", "Milliseconds of the shadow"),
        ("speed", "Milliseconds of the flat map over these"),
    ];
    found.parts.push(Part {
        title: "Levels against the flat map".into(),
        text:
            "Light of 0.1, two passes. On a level a penumbra is `window` to twice as many texels wide, or narrower on \
               the finest; 8 is the default. The paper hopes for it in its section 7."
                .into(),
        shown: vec![Shown::Table(Table { heads, groups })],
    });
    Ok(last)
}

/// The paper's own way: read the map back, loop, blend.
fn over_the_cpu(stage: &Stage, frames: u32, found: &mut Measured) -> Result<f64, CliError> {
    let mut rows = Vec::new();
    let mut last = 0.0;
    for map in [128, LARGE] {
        let spec = format!("ssm:map={map},passes=1");
        let ours = stage.time(&spec, frames)?;
        let (steps, _) = readback::frame(stage, map)?;
        last = ours / steps.total();
        rows.push(vec![
            spec,
            text::ms(ours),
            text::ms(steps.read),
            text::ms(steps.made),
            text::ms(steps.drawn),
            text::ratio(last),
        ]);
    }
    let heads = vec![
        ("technique", "Name and settings"),
        ("ms", "Milliseconds of ours, the maps' drawing included"),
        ("read", "The paper's way: reading the occluder map back"),
        ("loop", "The CPU's loop over its texels"),
        ("blend", "Uploading and drawing the rectangles; the drawing of the maps is left out"),
        ("ours ÷", "Ours over these three"),
    ];
    found.parts.push(Part {
        title: "Without the CPU".into(),
        text: "One pass, light of 0.1. The paper's way reads the occluder map back, makes the rectangles on the CPU \
               and blends them; it names the transfer as its bottleneck. On a software adapter the transfer costs \
               nothing and the rectangles most."
            .into(),
        shown: vec![Shown::Table(Table { heads, groups: vec![Group { title: stage.scene.name.clone(), rows }] })],
    });
    Ok(last)
}
