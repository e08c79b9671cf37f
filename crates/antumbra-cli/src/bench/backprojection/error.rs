//! How near to the truth, for how many milliseconds: over all scenes, by setting, and scene by scene.

use super::super::kit::{Group, Part, Run, Scatter, Shown, Table, Trial};
use super::specs::{COMPARED, Configuration, GROUPS, Mean, SWEEPS, run_of, swept};
use super::targets::speed_over_pcss;
use crate::report::Point;
use crate::report::lines::{Curve, Lines, Spot};
use crate::report::text;

/// Each configuration's mean over the scenes.
pub fn pareto(scenes: &[Trial], configurations: &[Configuration]) -> Part {
    let trials: Vec<&Trial> = scenes.iter().collect();
    let point = |c: &Configuration| {
        let Mean { error, ms } = Mean::of(&trials, &c.spec.text)?;
        // The many of the sweep have a name only where nothing beats them; the chart of settings has them all.
        let labelled = c.group != 1;
        let (label, name) = (c.label.clone(), c.spec.text.clone());
        Some(Point { label, name, labelled, link: None, group: Some(c.group), ms, error })
    };
    let points = configurations.iter().filter_map(point).collect();
    Part {
        title: "Error against milliseconds".into(),
        text: format!(
            "Mean over {}, {}. Filled and joined: no other is both faster and nearer to the truth. Rest on a point for \
             its settings.",
            names(scenes),
            scenes.first().map_or(String::new(), Trial::pixels)
        ),
        shown: vec![Shown::Scatter(Scatter { groups: GROUPS.to_vec(), points })],
    }
}

fn names(scenes: &[Trial]) -> String {
    scenes.iter().map(|trial| trial.name.as_str()).collect::<Vec<_>>().join(", ")
}

/// A curve a setting: error against milliseconds as it alone changes.
pub fn settings(scenes: &[Trial]) -> Part {
    let trials: Vec<&Trial> = scenes.iter().collect();
    let curve = |(color, (key, values)): (usize, &(&str, &[&str]))| {
        let spot = |value: &&str| {
            let spec = swept(key, value);
            let Mean { error: y, ms: x } = Mean::of(&trials, &spec)?;
            Some(Spot { x, y, note: format!("{spec}: error {}, {} ms", text::figure(y), text::ms(x)) })
        };
        Curve {
            label: format!("{key} = {}", values.join(", ")),
            color,
            dashed: false,
            points: values.iter().filter_map(spot).collect(),
        }
    };
    Part {
        title: "Setting by setting".into(),
        text: "The same scenes. Along a line one setting of the balanced preset goes through the values of the legend, in \
               their order, and all others stay; the lines meet where nothing is changed."
            .into(),
        shown: vec![Shown::Lines(Lines {
            x: "GPU milliseconds a frame".into(),
            y: "average error".into(),
            less_is_better: true,
            curves: SWEEPS.iter().enumerate().map(curve).collect(),
            guides: Vec::new(),
        })],
    }
}

const HEADS: [(&str, &str); 8] = [
    ("technique", "Name and settings"),
    ("error", "Mean |error| where the truth is under 0.999: shadow and penumbra"),
    ("max", "Largest |error| of a pixel"),
    ("leak", "Mean visibility where the truth is under 0.001: light in the umbra"),
    ("acne", "Mean darkness where the truth is over 0.999"),
    ("ms", "GPU milliseconds of the shadow alone"),
    ("÷ pcss", "Milliseconds over those of PCSS at its defaults, in the same scene and the same run"),
    ("MB", "GPU memory that the technique owns, 10⁶ bytes"),
];

/// Everything, scene by scene.
pub fn scenes(scenes: &[Trial]) -> Part {
    let group =
        |trial: &Trial| Group { title: trial.heading(), rows: trial.runs.iter().map(|run| row(trial, run)).collect() };
    let table = Table { heads: HEADS.to_vec(), groups: scenes.iter().map(group).collect() };
    Part {
        title: "Scene by scene".into(),
        text: "Some built-in scenes have fewer triangles here than by default, so that 256 maps of them can be awaited on \
               a software adapter too. Penumbra is the part of the pixels whose true visibility is over 0.01 and under \
               0.99."
            .into(),
        shown: vec![Shown::Pictures((0..scenes.len()).collect()), Shown::Table(table)],
    }
}

fn row(trial: &Trial, run: &Run) -> Vec<String> {
    let f = &run.figures;
    // Speed over PCSS the other way round: what a frame takes in frames of PCSS.
    let over_pcss = speed_over_pcss(trial, &run.spec).map_or_else(|| "–".to_owned(), |speed| text::ratio(1.0 / speed));
    vec![
        run.spec.clone(),
        text::figure(f.average_error),
        text::figure(f.max),
        text::figure(f.leak),
        text::figure(f.acne),
        run.ms(),
        over_pcss,
        text::megabytes(run.cost.total_bytes),
    ]
}

/// A size of the light, as a part of the distance to the occluder, and what was measured with it.
pub type Lit<'a> = (f64, &'a Trial);

const LIGHT_HEADS: [(&str, &str); 7] = [
    ("technique", "Name and settings"),
    ("mean error", "Mean over the sizes of the light of the average error"),
    ("largest", "Largest average error of a size"),
    ("at", "Size of the light there, in distances of the occluder"),
    ("largest of a pixel", "Largest |error| of any pixel at any size"),
    ("at", "Size of the light there, in distances of the occluder"),
    ("p99", "Largest of the |errors| that 99 % of the pixels of a size do not exceed"),
];

/// What becomes of the error as the light grows; a sweep a scene.
pub fn lights(sweeps: &[(&str, Vec<Lit>)]) -> Part {
    let rows = |lit: &[Lit]| COMPARED.iter().filter_map(|(_, spec)| light_row(lit, spec)).collect();
    let groups = sweeps.iter().map(|(scene, lit)| Group { title: (*scene).to_owned(), rows: rows(lit) }).collect();
    let plot = |y: &str, value: fn(&Run) -> f64| {
        Shown::Lines(Lines {
            x: "size of the light ÷ distance of the occluder from it".into(),
            y: y.into(),
            less_is_better: false,
            curves: by_light(sweeps, value, text::figure),
            guides: Vec::new(),
        })
    };
    Part {
        title: "Error over the size of the light".into(),
        text: "The light's edge goes from 0.05 to 3 times the occluder's distance from it: the square hangs 2 m below its \
               light, the distance of other scenes is that to the middle of what casts shadows. Half the size of the \
               other pictures each way."
            .into(),
        shown: vec![
            plot("average error", |run| run.figures.average_error),
            plot("largest error of a pixel", |run| run.figures.max),
            Shown::Table(Table { heads: LIGHT_HEADS.to_vec(), groups }),
        ],
    }
}

/// A curve a scene and technique, over the size of the light.
pub fn by_light(sweeps: &[(&str, Vec<Lit>)], value: fn(&Run) -> f64, spoken: fn(f64) -> String) -> Vec<Curve> {
    let curves = sweeps.iter().enumerate().flat_map(|(i, (scene, lit))| {
        COMPARED.iter().enumerate().map(move |(color, (name, spec))| {
            let spot = |(x, trial): &Lit| {
                let y = value(run_of(trial, spec)?);
                Some(Spot { x: *x, y, note: format!("{spec}, {scene}, {x} times the distance: {}", spoken(y)) })
            };
            let points = lit.iter().filter_map(spot).collect();
            Curve { label: format!("{name}, {scene}"), color, dashed: i > 0, points }
        })
    });
    curves.collect()
}

fn light_row(lit: &[Lit], spec: &str) -> Option<Vec<String>> {
    let runs: Vec<(f64, &Run)> =
        lit.iter().map(|(x, trial)| Some((*x, run_of(trial, spec)?))).collect::<Option<_>>()?;
    let most = |value: fn(&Run) -> f64| runs.iter().map(|(x, run)| (value(run), *x)).max_by(|a, b| a.0.total_cmp(&b.0));
    let mean = runs.iter().map(|(_, run)| run.figures.average_error).sum::<f64>() / runs.len() as f64;
    let (average, of_average) = most(|run| run.figures.average_error)?;
    let (pixel, of_pixel) = most(|run| run.figures.max)?;
    let (p99, _) = most(|run| run.figures.p99)?;
    let figure = text::figure;
    Some(vec![
        spec.to_owned(),
        figure(mean),
        figure(average),
        of_average.to_string(),
        figure(pixel),
        of_pixel.to_string(),
        figure(p99),
    ])
}

#[cfg(test)]
mod tests {
    use super::super::super::kit::tests::{run, trial};
    use super::super::specs::{BALANCED, PCSS};
    use super::*;

    #[test]
    fn tables_have_a_cell_a_column_and_ratios_of_the_same_scene() {
        let scene = trial("fence", vec![run(BALANCED, 30.0, &[]), run(PCSS, 10.0, &[])]);
        let part = scenes(std::slice::from_ref(&scene));
        let [Shown::Pictures(_), Shown::Table(table)] = &part.shown[..] else { panic!("a table") };
        assert!(table.groups[0].rows.iter().all(|row| row.len() == HEADS.len()));
        assert_eq!(table.groups[0].rows.iter().map(|row| row[6].as_str()).collect::<Vec<_>>(), ["3.0", "1.0"]);
    }

    #[test]
    fn the_largest_error_of_a_sweep_is_told_with_the_light_that_it_was_found_at() {
        let all = |ms| trial("a", COMPARED.iter().map(|(_, spec)| run(spec, ms, &[])).collect());
        let mut trials = [all(1.0), all(2.0)];
        trials[1].runs[0].figures.average_error = 0.75;
        let lit = [0.05, 3.0].into_iter().zip(&trials).collect();
        let part = lights(&[("square", lit)]);
        let [Shown::Lines(lines), _, Shown::Table(table)] = &part.shown[..] else { panic!("plots and a table") };
        assert!(lines.curves.len() == COMPARED.len() && lines.curves.iter().all(|c| c.points.len() == 2));
        assert!(table.groups[0].rows.iter().all(|row| row.len() == LIGHT_HEADS.len()));
        assert_eq!(table.groups[0].rows[0][2..4], ["0.7500", "3"]);
    }
}
