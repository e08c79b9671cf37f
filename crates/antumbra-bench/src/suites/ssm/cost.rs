//! Milliseconds and their causes: figures 21 to 25, the second pass, gathering against blending.

use super::levels::{self, LARGE};
use super::scenes::{Occluder, Placement};
use super::stage::{Sample, Stage};
use crate::Error;
use crate::kit::{Content, Ratio, Runner, Section};
use crate::measure::median;
use crate::page::lines::{Curve, Lines, Point};
use crate::page::text;

/// Copies of the occluder; the last exceeds the paper's 340 000 triangles.
const COPIES: [u32; 4] = [1, 2, 4, 6];
const MAPS: [u32; 5] = [64, 128, 256, 512, 1024];
const LARGEST_FLAT: u32 = 256;
const LIGHTS: [f32; 5] = [0.01, 0.02, 0.05, 0.1, 0.2];
const LIGHT_MAPS: [u32; 3] = [64, 128, 256];

/// Values to compare with the paper's bounds.
pub struct Costs {
    /// Milliseconds of a map of 512 x 512 over those of 128 x 128, two passes.
    pub large_over_small: f64,
    /// Two passes over one, map of 128 x 128, the median over the copies.
    pub second_pass: f64,
    /// Ours over the CPU's way, map of 512 x 512, one pass.
    pub over_cpu: f64,
    /// Error of levels minus that of the flat map, 512 x 512.
    pub levels_error: f64,
    /// Milliseconds of the flat map over those of levels.
    pub levels_speed: f64,
}

/// Results so far.
#[derive(Default)]
pub struct Measured {
    pub sections: Vec<Section>,
    pub ratios: Vec<Ratio>,
}

pub fn measure(runner: &Runner, occluder: &Occluder, found: &mut Measured) -> Result<Costs, Error> {
    runner.monitor.log(&format!("costs: {}", occluder.name));
    let usual = Stage::new(runner, occluder.scene(Placement::default()))?;
    let second_pass = triangles(runner, occluder, found)?;
    let large_over_small = maps(&usual, runner.frames, found)?;
    found.sections.push(lights(runner, occluder)?);
    let (section, (levels_error, levels_speed)) = levels::levels(&usual)?;
    found.sections.push(section);
    let (section, over_cpu) = levels::over_the_cpu(&usual, runner.frames)?;
    found.sections.push(section);
    Ok(Costs { large_over_small, second_pass, over_cpu, levels_error, levels_speed })
}

const MS: &str = "milliseconds per frame";

fn ratio(stage: &Stage, what: &'static str, spec: &str, base: &str, paper: f64, ours: f64) -> Ratio {
    Ratio { what, trial: stage.scene.name.clone(), spec: spec.into(), base: base.into(), paper: Some(paper), ours }
}

/// Figures 21 and 25: copies of the occluder side by side.
fn triangles(runner: &Runner, occluder: &Occluder, found: &mut Measured) -> Result<f64, Error> {
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
    let mut curves: Vec<Curve> = specs.iter().enumerate().map(|(i, s)| Curve::new(*s, i, []).dashed(i > 2)).collect();
    let mut factors = Vec::new();
    for copies in COPIES {
        let stage = Stage::new(runner, occluder.copies(copies, 0.1))?;
        let triangles = stage.scene.triangle_count();
        let times = specs.iter().map(|spec| stage.time(spec, runner.frames)).collect::<Result<Vec<_>, _>>()?;
        for (curve, (spec, ms)) in curves.iter_mut().zip(specs.iter().zip(&times)) {
            let note = format!("{spec}, {} triangles: {} ms", text::count(triangles as u64), text::ms(*ms));
            curve.points.push(Point::new(triangles as f64, *ms, note));
        }
        factors.push(times[1] / times[0]);
        found.ratios.push(ratio(&stage, "second pass", TWO, ONE, 1.7, times[1] / times[0]));
    }
    found.sections.push(Section::new(
        "Triangles (figures 21 and 25)",
        format!(
            "Copies of {} side by side, light of 0.1. The paper: linear in triangles, over 30 frames per second with \
             340 000 on a GeForce 6800 Ultra; two passes take 1.6 to 1.8 times as long as one. Its figure 25 compares \
             maps of 210 x 210 with soft shadow volumes, whose time grows faster with copies; here the dashed lines \
             show other techniques of this program.",
            occluder.name
        ),
        vec![Lines::new("triangles", MS, curves).guides(&[("x", 1.0)]).into()],
    ));
    Ok(median(factors))
}

/// Figure 22: texels of the map; gathering and blending, levels and the flat map.
fn maps(stage: &Stage, frames: u32, found: &mut Measured) -> Result<f64, Error> {
    let variants = [
        ("gather, levels", "", 1024),
        ("gather, levels, one pass", ",passes=1", 1024),
        ("gather, flat", ",hierarchy=false", LARGEST_FLAT),
        ("blend, levels", ",accumulate=blend", LARGEST_FLAT),
        ("blend, flat", ",hierarchy=false,accumulate=blend", 128),
    ];
    let texels = |map: u32| f64::from(map * map);
    let mut curves = Vec::new();
    for (i, (label, rest, largest)) in variants.into_iter().enumerate() {
        let point = |map| {
            let spec = format!("ssm:map={map}{rest}");
            let ms = stage.time(&spec, frames)?;
            Ok(Point::new(texels(map), ms, format!("{spec}: {} ms", text::ms(ms))))
        };
        let points = MAPS.into_iter().filter(|map| *map <= largest).map(point).collect::<Result<Vec<_>, Error>>()?;
        curves.push(Curve::new(label, i, points));
    }
    let at = |map: u32| curves[0].points.iter().find(|p| p.x == texels(map)).map_or(f64::NAN, |p| p.y);
    let (small, growth) = (at(128), at(LARGE) / at(128));
    let paper = [(128, 10.0), (256, 50.0), (512, 150.0)].map(|(map, ms)| {
        let note = format!("the paper: {ms} ms with {map} x {map}, drawn relative to 128 x 128");
        Point::new(texels(map), ms / 10.0 * small, note)
    });
    curves.push(Curve::new("the paper, relative to 128 x 128", 7, paper).dashed(true));
    let what = "milliseconds, 512 over 128 texels per side";
    found.ratios.push(ratio(stage, what, &format!("ssm:map={LARGE}"), "ssm:map=128", 15.0, growth));
    found.sections.push(Section::new(
        "Texels of the map (figure 22)",
        "Light of 0.1. The paper: linear in texels, since their transfer to the CPU dominates; 10 to 50 ms for 128 x 128 \
         and 256 x 256, 150 ms for 512 x 512. Without the transfer the flat map grows with the square of texels, as each \
         has a rectangle of more texels; levels grow with texels.",
        vec![Lines::new("texels of the map", MS, curves).guides(&[("x", 1.0)]).into()],
    ));
    Ok(growth)
}

/// Figure 24: the light's size at three sizes of map.
fn lights(runner: &Runner, occluder: &Occluder) -> Result<Section, Error> {
    let variants: Vec<(u32, bool)> = LIGHT_MAPS.iter().flat_map(|&m| [(m, false), (m, true)]).collect();
    let mut samples: Vec<Vec<(f64, Sample)>> = vec![Vec::new(); variants.len()];
    for light in LIGHTS {
        let stage = Stage::new(runner, occluder.scene(Placement { light, ..Placement::default() }))?;
        for (of, (map, levels)) in samples.iter_mut().zip(&variants) {
            of.push((f64::from(light), stage.sample(&format!("ssm:map={map},hierarchy={levels}"), runner.frames)?));
        }
    }
    let plot = |y: &str, value: fn(&Sample) -> f64| -> Content {
        let curve = |i: usize| {
            let (map, levels) = variants[i];
            let point = |(x, s): &(f64, Sample)| {
                Point::new(*x, value(s), format!("{}, light {x}: {}", s.spec, text::metric(value(s))))
            };
            let label = format!("{map} x {map}, {}", if levels { "levels" } else { "flat" });
            Curve::new(label, i / 2, samples[i].iter().map(point)).dashed(levels)
        };
        let x = "edge of the light; the scene is 1 wide, the occluder 0.2";
        Lines::new(x, y, (0..variants.len()).map(curve)).into()
    };
    Ok(Section::new(
        "Milliseconds and error over the light's size (figure 24)",
        "Two passes. The paper: time grows with the light; a large light needs no large map for the same error, a small \
         light does.",
        vec![plot(MS, |s| s.ms), plot("average error of the soft shadow map", |s| s.error)],
    ))
}
