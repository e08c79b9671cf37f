//! Error against milliseconds: over all scenes, by setting, and scene by scene.

use super::specs::{Configuration, GROUPS, Mean, PCSS, SWEEPS, run_of, swept};
use crate::kit::{Content, Run, Scatter, Section, Trial, columns};
use crate::page::lines::{Curve, Lines, Point};
use crate::page::{scatter, text};
use crate::table::{Table, column};

/// Each configuration's mean over the scenes.
pub fn pareto(scenes: &[Trial], configurations: &[Configuration]) -> Section {
    let point = |c: &Configuration| {
        let Mean { error, ms } = Mean::of(scenes, &c.spec.text)?;
        // Points of the sweep have a label only where no other is better; the plot of settings labels them all.
        let labelled = c.group != 1;
        let (label, name) = (c.label.clone(), c.spec.text.clone());
        Some(scatter::Point { label, name, labelled, link: None, group: Some(c.group), ms, error })
    };
    let names: Vec<&str> = scenes.iter().map(|trial| trial.name.as_str()).collect();
    let text = format!(
        "Mean over {}, {}. Filled and joined: no other is both faster and nearer to the reference. Hover over a point for \
         its settings.",
        names.join(", "),
        scenes.first().map_or(String::new(), Trial::pixels)
    );
    let points = configurations.iter().filter_map(point).collect();
    let scatter = Scatter { groups: &GROUPS, points };
    Section::new("Error against milliseconds", text, vec![Content::Scatter(scatter)])
}

/// One curve per setting: error against milliseconds as it alone varies.
pub fn settings(scenes: &[Trial]) -> Section {
    let curve = |(color, (key, values)): (usize, &(&str, &[&str]))| {
        let point = |value: &&str| {
            let spec = swept(key, value);
            let Mean { error, ms } = Mean::of(scenes, &spec)?;
            Some(Point::new(ms, error, format!("{spec}: error {}, {} ms", text::metric(error), text::ms(ms))))
        };
        Curve::new(format!("{key} = {}", values.join(", ")), color, values.iter().filter_map(point))
    };
    let curves = SWEEPS.iter().enumerate().map(curve);
    Section::new(
        "Setting by setting",
        "The same scenes. Along a line one setting of the balanced preset takes the values of the legend in their order, \
         and all others stay; the lines meet at the preset.",
        vec![Lines::new("GPU milliseconds per frame", "average error", curves).less_is_better().into()],
    )
}

/// Everything, scene by scene.
pub fn scenes(scenes: &[Trial]) -> Section {
    let columns = [
        columns::technique::<(&Trial, &Run)>(),
        columns::error(),
        columns::metric("max", "Largest |error| of a pixel", |run| run.metrics.max),
        columns::leak(),
        columns::acne(),
        columns::ms(),
        column(
            "÷ pcss",
            "Over PCSS at its defaults, in the same scene and the same run",
            "",
            |(trial, run): &(&Trial, &Run)| {
                let pcss = run_of(trial, PCSS);
                text::or_dash(pcss.map(|pcss| text::ratio(run.cost.total_ms / pcss.cost.total_ms)))
            },
        ),
        columns::megabytes(),
    ];
    let table = Table::grouped(&columns, scenes.iter().map(|trial| (trial.heading(), trial.rows())));
    Section::new(
        "Scene by scene",
        "Some built-in scenes have fewer triangles here than by default, to keep the rendering of 256 maps short on a \
         software adapter too. Penumbra is the fraction of the pixels whose reference visibility is over 0.01 and under \
         0.99.",
        vec![Content::references(scenes), table.into()],
    )
}

#[cfg(test)]
mod tests {
    use super::super::specs::BALANCED;
    use super::*;
    use crate::kit::made_up::{run, trial};

    #[test]
    fn tables_have_a_cell_a_column_and_ratios_of_the_same_scene() {
        let scene = trial("fence", vec![run(BALANCED, 30.0, &[]), run(PCSS, 10.0, &[])]);
        let section = scenes(std::slice::from_ref(&scene));
        let [Content::Gallery(_), Content::Table(table)] = &section.contents[..] else { panic!("a table") };
        assert!(table.groups[0].rows.iter().all(|row| row.len() == table.headings.len()));
        assert_eq!(table.groups[0].rows.iter().map(|row| row[6].as_str()).collect::<Vec<_>>(), ["3.0", "1.0"]);
    }
}
