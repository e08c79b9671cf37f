//! What milliseconds depend on.

use super::super::kit::{Part, Run, Shown, Trial, with_map};
use super::error::{Lit, by_light};
use super::specs::{BALANCED, PCSS, run_of};
use crate::report::lines::{Curve, Guide, Lines, Spot};
use crate::report::text;

/// Whose cost is drawn.
pub const DRAWN: [(&str, &str); 2] = [("balanced", BALANCED), ("pcss", PCSS)];
/// Maps of the curve over the size of the map, texels a side.
pub const MAPS: [u32; 4] = [256, 512, 1024, 2048];

/// What the four curves are made of.
pub struct Costs<'a> {
    /// A sweep a scene.
    pub lights: &'a [(&'a str, Vec<Lit<'a>>)],
    /// Every size of map in one trial.
    pub maps: &'a Trial,
    /// The same scene in several sizes.
    pub pictures: &'a [Trial],
    /// Scenes of more and more triangles.
    pub triangles: &'a [Trial],
}

/// Milliseconds over the light's size, the map's, the picture's, and triangles.
pub fn part(costs: &Costs) -> Part {
    let maps = |spec: &str| {
        let run = |map: &u32| Some((f64::from(*map), run_of(costs.maps, &with_map(spec, *map))?));
        MAPS.iter().filter_map(run).collect::<Vec<_>>()
    };
    let pixels = |trial: &Trial| f64::from(trial.width) * f64::from(trial.height);
    let scene = |trials: &[Trial]| trials.first().map_or(String::new(), |trial| trial.scene.clone());
    Part {
        title: "Milliseconds".into(),
        text: format!(
            "Over the size of the light, as above; of the map, {}, {}; over the pixels of the picture, {}; over the \
             triangles of a forest, {}. The presets as they are, but for what the axis says.",
            costs.maps.scene,
            costs.maps.pixels(),
            scene(costs.pictures),
            costs.triangles.first().map_or(String::new(), Trial::pixels),
        ),
        shown: vec![
            plot("size of the light ÷ distance of the occluder from it", by_light(costs.lights, of_ms, spoken), &[]),
            plot("texels a side of the map", curves(maps), &[("x²", 2.0)]),
            plot("pixels", curves(|spec| over(costs.pictures, spec, pixels)), &[("x", 1.0)]),
            plot("triangles", curves(|spec| over(costs.triangles, spec, |t| t.triangles as f64)), &[]),
        ],
    }
}

fn of_ms(run: &Run) -> f64 {
    run.cost.total_ms
}

fn spoken(ms: f64) -> String {
    format!("{} ms", text::ms(ms))
}

fn over<'a>(trials: &'a [Trial], spec: &str, x: impl Fn(&Trial) -> f64) -> Vec<(f64, &'a Run)> {
    trials.iter().filter_map(|trial| Some((x(trial), run_of(trial, spec)?))).collect()
}

fn plot(x: &str, curves: Vec<Curve>, guides: &[(&str, f64)]) -> Shown {
    let guide = |(label, exponent): &(&str, f64)| Guide { label: (*label).into(), exponent: *exponent };
    Shown::Lines(Lines {
        x: x.into(),
        y: "GPU milliseconds a frame".into(),
        less_is_better: false,
        curves,
        guides: guides.iter().map(guide).collect(),
    })
}

fn curves<'a>(runs: impl Fn(&str) -> Vec<(f64, &'a Run)>) -> Vec<Curve> {
    // The colours that these two have over the size of the light.
    let colors = [1, 3];
    let curve = |((label, spec), color): (&(&str, &str), usize)| {
        let spot = |(x, run): (f64, &Run)| {
            let y = of_ms(run);
            Spot { x, y, note: format!("{}: {} at {}", run.spec, spoken(y), text::count(x as u64)) }
        };
        let points = runs(spec).into_iter().map(spot).collect();
        Curve { label: (*label).to_owned(), color, dashed: false, points }
    };
    DRAWN.iter().zip(colors).map(curve).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::kit::tests::{run, trial};
    use super::*;

    #[test]
    fn each_curve_has_a_point_a_measurement() {
        let both = |name: &str| trial(name, DRAWN.iter().map(|(_, spec)| run(spec, 5.0, &[])).collect());
        let of_maps = DRAWN.iter().flat_map(|(_, spec)| MAPS.map(|map| run(&with_map(spec, map), 5.0, &[])));
        let (maps, pictures) = (trial("maps", of_maps.collect()), [both("a"), both("b")]);
        let costs = Costs { lights: &[], maps: &maps, pictures: &pictures, triangles: &pictures[..1] };
        let points = |shown: &Shown| match shown {
            Shown::Lines(lines) => lines.curves.iter().map(|c| c.points.len()).collect::<Vec<_>>(),
            _ => panic!("a plot"),
        };
        let points: Vec<_> = part(&costs).shown.iter().map(points).collect();
        assert_eq!(points, [vec![], vec![4, 4], vec![2, 2], vec![1, 1]]);
    }
}
