//! Milliseconds over the parameters that they depend on.

use super::lights::{LIGHT_AXIS, LightTrial, by_light};
use super::specs::{BALANCED, PCSS, run_of};
use crate::kit::{Content, Run, Section, Trial, with_map};
use crate::page::lines::{Curve, Lines, Point};
use crate::page::text;

/// Techniques of the curves.
pub const DRAWN: [(&str, &str); 2] = [("balanced", BALANCED), ("pcss", PCSS)];
/// Maps of the curve over the size of the map, texels per side.
pub const MAPS: [u32; 4] = [256, 512, 1024, 2048];

/// Trials of the four curves.
pub struct Costs<'a> {
    /// One sweep per scene.
    pub lights: &'a [(&'a str, Vec<LightTrial<'a>>)],
    /// A trial with every size of map.
    pub maps: &'a Trial,
    /// The same scene in several sizes.
    pub images: &'a [Trial],
    /// Scenes with increasing numbers of triangles.
    pub triangles: &'a [Trial],
}

/// Milliseconds over the light's size, the map's, the image's, and triangles.
pub fn section(costs: &Costs) -> Section {
    let maps = |spec: &str| {
        let run = |map: &u32| Some((f64::from(*map), run_of(costs.maps, &with_map(spec, *map))?));
        MAPS.iter().filter_map(run).collect()
    };
    let text = format!(
        "Milliseconds over the size of the light (as above), over the size of the map ({}, {}), over the pixels of the \
         image ({}) and over the triangles of a forest ({}). Only the parameter of the axis changes.",
        costs.maps.scene,
        costs.maps.pixels(),
        costs.images.first().map_or("", |trial| &trial.scene),
        costs.triangles.first().map_or(String::new(), Trial::pixels),
    );
    let triangles = |trial: &Trial| trial.triangles as f64;
    Section::new(
        "Milliseconds",
        text,
        vec![
            plot(LIGHT_AXIS, by_light(costs.lights, total_ms, with_unit), &[]),
            plot("texels per side of the map", curves(maps), &[("x²", 2.0)]),
            plot("pixels", curves(|spec| over(costs.images, spec, Trial::pixel_count)), &[("x", 1.0)]),
            plot("triangles", curves(|spec| over(costs.triangles, spec, triangles)), &[]),
        ],
    )
}

fn total_ms(run: &Run) -> f64 {
    run.cost.total_ms
}

fn with_unit(ms: f64) -> String {
    format!("{} ms", text::ms(ms))
}

fn over<'a>(trials: &'a [Trial], spec: &str, x: impl Fn(&Trial) -> f64) -> Vec<(f64, &'a Run)> {
    trials.iter().filter_map(|trial| Some((x(trial), run_of(trial, spec)?))).collect()
}

fn plot(x: &str, curves: Vec<Curve>, guides: &[(&'static str, f64)]) -> Content {
    Lines::new(x, "GPU milliseconds per frame", curves).guides(guides).into()
}

fn curves<'a>(runs: impl Fn(&str) -> Vec<(f64, &'a Run)>) -> Vec<Curve> {
    // The colours of these two in the plots over the size of the light.
    let colors = [1, 3];
    let curve = |((label, spec), color): (&(&str, &str), usize)| {
        let point = |(x, run): (f64, &Run)| {
            let y = total_ms(run);
            Point::new(x, y, format!("{}: {} at {}", run.spec, with_unit(y), text::count(x as u64)))
        };
        Curve::new(*label, color, runs(spec).into_iter().map(point))
    };
    DRAWN.iter().zip(colors).map(curve).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::made_up::{run, trial};

    #[test]
    fn each_curve_has_a_point_per_measurement() {
        let both = |name: &str| trial(name, DRAWN.iter().map(|(_, spec)| run(spec, 5.0, &[])).collect());
        let of_maps = DRAWN.iter().flat_map(|(_, spec)| MAPS.map(|map| run(&with_map(spec, map), 5.0, &[])));
        let (maps, images) = (trial("maps", of_maps.collect()), [both("a"), both("b")]);
        let costs = Costs { lights: &[], maps: &maps, images: &images, triangles: &images[..1] };
        let points = |content: &Content| match content {
            Content::Lines(lines) => lines.curves.iter().map(|c| c.points.len()).collect::<Vec<_>>(),
            _ => panic!("a plot"),
        };
        let points: Vec<_> = section(&costs).contents.iter().map(points).collect();
        assert_eq!(points, [vec![], vec![4, 4], vec![2, 2], vec![1, 1]]);
    }
}
