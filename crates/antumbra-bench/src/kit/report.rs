//! Report of a suite: the trials, and the sections that show them.

use super::trial::{Run, Trial};
use crate::measure::Timing;
use crate::page::images::halved;
use crate::page::lines::Lines;
use crate::page::scatter::Point;
use crate::page::text;
use crate::table::Table;
use antumbra_metrics::RgbImage;
use serde::Serialize;

/// Results of a suite.
pub struct Report {
    /// The result in a sentence or two.
    pub lead: String,
    /// Sections in the order of the page.
    pub sections: Vec<Section>,
    /// Ratios of the paper beside measured ones.
    pub ratios: Vec<Ratio>,
    /// All measurements.
    pub trials: Vec<Trial>,
}

/// A section of the page.
pub struct Section {
    /// Heading.
    pub title: String,
    /// Content and method of measurement.
    pub text: String,
    /// Images, tables and plots.
    pub contents: Vec<Content>,
}

/// An element of a section.
pub enum Content {
    /// Images side by side.
    Gallery(Vec<GalleryImage>),
    /// A table.
    Table(Table),
    /// A plot of curves.
    Lines(Lines),
    /// A plot of error against milliseconds.
    Scatter(Scatter),
}

/// An image with its captions.
pub struct GalleryImage {
    /// Name.
    pub name: String,
    /// Remark beside the name; may be empty.
    pub remark: String,
    /// Size on the page, pixels.
    pub size: [u32; 2],
    /// The image.
    pub image: RgbImage,
}

/// Techniques with their settings as points of a plot, in several groups.
pub struct Scatter {
    /// Names of the groups.
    pub groups: &'static [&'static str],
    /// One point per configuration.
    pub points: Vec<Point>,
}

/// A ratio of the paper beside the measured one.
#[derive(Clone, Debug, Serialize)]
pub struct Ratio {
    /// The measured quantity.
    pub what: &'static str,
    /// Name of the trial.
    pub trial: String,
    /// The technique of the numerator.
    pub spec: String,
    /// The technique of the denominator.
    pub base: String,
    /// The paper's value, if it has one.
    pub paper: Option<f64>,
    /// The measured value.
    pub ours: f64,
}

/// What was measured, and where.
#[derive(Clone, Debug, Serialize)]
pub struct Context {
    /// Name of the suite.
    pub suite: &'static str,
    /// Title of the suite.
    pub title: &'static str,
    /// The paper.
    pub source: &'static str,
    /// Name of the adapter.
    pub adapter: String,
    /// Whether the adapter computes on the CPU, so that its milliseconds say nothing about a GPU.
    pub software: bool,
    /// The command line.
    pub command: String,
    /// Timed frames.
    pub frames: u32,
}

impl Section {
    /// A section.
    pub fn new(title: impl Into<String>, text: impl Into<String>, contents: Vec<Content>) -> Section {
        Section { title: title.into(), text: text.into(), contents }
    }
}

impl Content {
    /// The references of these trials as small images.
    pub fn references(trials: &[Trial]) -> Content {
        let image = |trial: &Trial| GalleryImage {
            name: trial.name.clone(),
            remark: format!("{}, {} triangles", trial.scene, text::count(trial.triangles as u64)),
            size: [trial.width, trial.height],
            image: halved(&trial.image),
        };
        Content::Gallery(trials.iter().map(image).collect())
    }

    /// The kept images of a trial's techniques beside the reference.
    pub fn renders(trial: &Trial) -> Content {
        let run = |run: &Run| {
            let remark = format!("RMSE {}", text::metric(run.metrics.rmse));
            Some(GalleryImage::new(&run.spec, remark, run.image.clone()?))
        };
        let reference = GalleryImage::new("truth", "", trial.image.clone());
        Content::Gallery(std::iter::once(reference).chain(trial.runs.iter().filter_map(run)).collect())
    }
}

impl From<Table> for Content {
    fn from(table: Table) -> Content {
        Content::Table(table)
    }
}

impl From<Lines> for Content {
    fn from(lines: Lines) -> Content {
        Content::Lines(lines)
    }
}

impl GalleryImage {
    /// An image in its own size.
    pub fn new(name: impl Into<String>, remark: impl Into<String>, image: RgbImage) -> GalleryImage {
        GalleryImage { name: name.into(), remark: remark.into(), size: [image.width, image.height], image }
    }
}

impl Ratio {
    /// The speed of a run over that of `base`, a run of the same trial.
    pub fn speed(what: &'static str, trial: &Trial, run: &Run, base: &Run, paper: Option<f64>) -> Ratio {
        let (trial, spec, base_spec) = (trial.name.clone(), run.spec.clone(), base.spec.clone());
        Ratio { what, trial, spec, base: base_spec, paper, ours: run.speed_over(base) }
    }
}

impl Context {
    /// Number of frames that each time is measured over, in words.
    pub fn timed_frames(&self) -> String {
        match self.frames {
            1 => "one frame".to_owned(),
            n => format!("median of {n} frames"),
        }
    }
}

impl Report {
    /// The clock of the milliseconds, in words.
    pub fn clock(&self) -> &'static str {
        let mut by_wall = self.trials.iter().flat_map(|t| &t.runs).map(|run| run.cost.timing == Timing::Wall);
        let first = by_wall.next().unwrap_or(false);
        match (first, by_wall.any(|wall| wall != first)) {
            (false, false) => "GPU timestamps",
            (true, false) => "wall time from submission to completion (*)",
            _ => "GPU timestamps; wall time (*) where they contradict it",
        }
    }

    /// All tables, each with its section.
    pub fn tables(&self) -> impl Iterator<Item = (&Section, &Table)> {
        self.sections.iter().flat_map(|section| {
            section.contents.iter().filter_map(move |content| match content {
                Content::Table(table) => Some((section, table)),
                _ => None,
            })
        })
    }

    /// All tables as text for a terminal.
    pub fn terminal(&self) -> String {
        let mut text = String::new();
        for (section, table) in self.tables() {
            text += &format!("{}\n\n{}\n", section.title, table.terminal());
        }
        if self.clock().contains('*') { text + crate::measure::WALL } else { text }
    }

    /// The report in Markdown, without plots and images.
    pub fn markdown(&self, context: &Context) -> String {
        let Context { suite, title, source, adapter, command, .. } = context;
        let software =
            if context.software { ", a software adapter: its milliseconds say nothing about a GPU" } else { "" };
        let clock = match self.trials.is_empty() {
            true => String::new(),
            false => format!(" Milliseconds: {}, {}.", self.clock(), context.timed_frames()),
        };
        let adapter = crate::table::escaped(adapter);
        let lead = &self.lead;
        let mut text = format!(
            "## {title} [{source}]\n\nMeasured on {adapter}{software}.{clock} Made by\n\n    {command}\n\n{lead}\n"
        );
        let mut last: Option<&Section> = None;
        for (section, table) in self.tables() {
            let begins = !last.is_some_and(|last| std::ptr::eq(last, section));
            text += &if begins { format!("\n### {}\n\n{}\n\n", section.title, section.text) } else { "\n".to_owned() };
            text += &table.markdown();
            last = Some(section);
        }
        text + &format!(
            "\nPlots and images are in `{suite}.html`, every measurement in `{suite}.csv` and `{suite}.json`.\n"
        )
    }
}
