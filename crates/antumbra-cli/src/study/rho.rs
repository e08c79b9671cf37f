//! How many texels a penumbra of so many pixels needs: figure 9, with FLIP in place of twelve people.

use super::disk::Disk;
use super::search::{Motion, Needed, Screening};
use super::{Study, fit};
use crate::bench::kit::{Findings, Group, Part, Shown, Table};
use crate::cli::StudyArgs;
use crate::error::CliError;
use crate::progress::Progress;
use crate::report::Lines;
use crate::report::lines::{Curve, Spot};
use antumbra::Gpu;

pub const STUDY: Study = Study {
    name: "rho",
    title: "Texels that a penumbra needs",
    source: "Shen 2011, figure 9",
    summary: "texels over penumbrae of 1 to 512 pixels, still and moving, beside the paper's polynomials",
    run,
};

/// The paper's polynomials of log2 of the penumbra's pixels.
const DYNAMIC: [f64; 4] = [0.667, 0.7794, 0.3967, -0.02716];
const STATIC: [f64; 4] = [0.5477, 1.406, -0.04687, -0.003944];

/// What was found for a still picture and for a film, with the paper's answer.
struct Answer {
    motion: Motion,
    name: &'static str,
    paper: [f64; 4],
    needed: Vec<(u32, Needed)>,
}

impl Answer {
    /// The cubic through what was found, but for ends of the search, which are no answers.
    fn fit(&self) -> Option<[f64; 4]> {
        let found = self.needed.iter().filter(|(_, needed)| !needed.at_the_end);
        let points: Vec<(f64, f64)> = found.map(|(n, needed)| (f64::from(*n), needed.texels)).collect();
        (points.len() >= 4).then(|| fit::cubic(&points))
    }
}

fn run(gpu: &Gpu, args: &StudyArgs) -> Result<Findings, CliError> {
    let widths: Vec<u32> = (0..=9).map(|i| 1 << i).filter(|n| *n <= args.largest).collect();
    let mut answers = [
        Answer { motion: Motion::Still, name: "still", paper: STATIC, needed: Vec::new() },
        Answer { motion: Motion::Moving, name: "moving", paper: DYNAMIC, needed: Vec::new() },
    ];
    let progress = Progress::new("Searching");
    let steps = (widths.len() * answers.len()) as f32;
    for (i, n) in widths.iter().enumerate() {
        for (j, answer) in answers.iter_mut().enumerate() {
            progress.set((2 * i + j) as f32 / steps);
            let screening = Screening::new(gpu, Disk::of_penumbra(*n), answer.motion)?;
            answer.needed.push((*n, screening.search(args.threshold)?));
        }
    }
    let fits: Vec<String> = answers.iter().map(told).collect();
    Ok(Findings {
        lead: format!("At most {} of FLIP over the penumbra. {}", args.threshold, fits.join(" ")),
        parts: vec![plot(&answers), table(&answers)],
        ratios: Vec::new(),
        trials: Vec::new(),
    })
}

fn told(answer: &Answer) -> String {
    match answer.fit() {
        Some(c) => format!(
            "{}: rho(n) = {:.4} + {:.4} x + {:.5} x² + {:.6} x³ with x = log2(n).",
            answer.name, c[0], c[1], c[2], c[3]
        ),
        None => format!("{}: too few penumbrae for a cubic; it wants four.", answer.name),
    }
}

fn plot(answers: &[Answer]) -> Part {
    let curve = |label: String, color, dashed, points: Vec<Spot>| Curve { label, color, dashed, points };
    let smooth = |c: [f64; 4], largest: u32| {
        let steps = 4 * largest.ilog2();
        let spot = |i: u32| {
            let n = 2f64.powf(f64::from(i) / 4.0);
            Spot { x: n, y: fit::at(c, n), note: String::new() }
        };
        (0..=steps).map(spot).collect::<Vec<Spot>>()
    };
    let mut curves = Vec::new();
    for (i, answer) in answers.iter().enumerate() {
        let largest = answer.needed.last().map_or(1, |(n, _)| *n);
        let note =
            |n: u32, needed: &Needed| format!("{n} pixels: {:.2} texels, FLIP {:.4}", needed.texels, needed.flip);
        let found = answer.needed.iter();
        let spots = found.map(|(n, needed)| Spot { x: f64::from(*n), y: needed.texels, note: note(*n, needed) });
        curves.push(curve(format!("{}, by FLIP", answer.name), i, false, spots.collect()));
        curves.push(curve(format!("{}, twelve people", answer.name), i, true, smooth(answer.paper, largest)));
    }
    Part {
        title: "Texels over pixels".to_owned(),
        text: "The smallest map whose shadow of a disk cannot be told from that of a map with four texels a pixel, by halving \
               the range of 1 to twice as many texels as pixels. Still: the mean FLIP over the penumbra of three pictures. \
               Moving: the most that any of four frames shows, or that changes from one to the next otherwise than with \
               the fine map."
            .to_owned(),
        shown: vec![Shown::Lines(Lines {
            x: "width of the filter, pixels".to_owned(),
            y: "texels in that width".to_owned(),
            less_is_better: false,
            curves,
            guides: Vec::new(),
        })],
    }
}

fn table(answers: &[Answer]) -> Part {
    let heads = vec![
        ("filter", "Width of the filter on the ground, in pixels"),
        ("texels", "Texels in that width that the search found; > or < at an end of its range"),
        ("FLIP", "What is noticed with that many"),
        ("fit", "The cubic through the column before"),
        ("paper", "The paper's cubic"),
    ];
    let group = |answer: &Answer| {
        let fit = answer.fit();
        let row = |(n, needed): &(u32, Needed)| {
            let end = match (needed.at_the_end, needed.texels > f64::from(*n)) {
                (false, _) => "",
                (true, true) => "> ",
                (true, false) => "< ",
            };
            let of_fit = fit.map_or("-".to_owned(), |c| format!("{:.2}", fit::at(c, f64::from(*n))));
            let paper = format!("{:.2}", fit::at(answer.paper, f64::from(*n)));
            vec![n.to_string(), format!("{end}{:.2}", needed.texels), format!("{:.4}", needed.flip), of_fit, paper]
        };
        Group { title: answer.name.to_owned(), rows: answer.needed.iter().map(row).collect() }
    };
    Part {
        title: "What was found".to_owned(),
        text: "People were sure up to 64 pixels and less so beyond; the metric has one answer for each.".to_owned(),
        shown: vec![Shown::Table(Table { heads, groups: answers.iter().map(group).collect() })],
    }
}
