//! What a suite has found: the trials, and how to show them.

use super::Trial;
use crate::measure::Timing;
use crate::report::{Lines, Point};
use antumbra_metrics::RgbImage;
use serde::Serialize;

/// All that a suite hands in.
pub struct Findings {
    /// What came out, in a sentence or two.
    pub lead: String,
    /// What is shown, in this order.
    pub parts: Vec<Part>,
    /// What a paper says beside what was measured here.
    pub ratios: Vec<Ratio>,
    /// Everything that was measured.
    pub trials: Vec<Trial>,
}

/// A chapter of the page.
pub struct Part {
    /// Its heading.
    pub title: String,
    /// What it shows, and how it was measured.
    pub text: String,
    /// Pictures, tables and plots.
    pub shown: Vec<Shown>,
}

/// Something to look at.
pub enum Shown {
    /// The truth of these trials (their places in [`Findings::trials`]), as small pictures.
    Pictures(Vec<usize>),
    /// What the techniques of a trial (its place in [`Findings::trials`]) made, if that was kept, beside the truth.
    Runs(usize),
    /// Pictures of any kind, side by side: a name, a remark, the picture.
    Gallery(Vec<(String, String, RgbImage)>),
    /// A table.
    Table(Table),
    /// Curves.
    Lines(Lines),
    /// Error against milliseconds.
    Scatter(Scatter),
}

/// Configurations of several groups, and which of them nothing beats.
pub struct Scatter {
    /// Names of the groups.
    pub groups: Vec<&'static str>,
    /// A point a configuration.
    pub points: Vec<Point>,
}

/// A table. The first column has names, the others numbers.
pub struct Table {
    /// Heading of each column, and what it means.
    pub heads: Vec<(&'static str, &'static str)>,
    /// Rows that belong together.
    pub groups: Vec<Group>,
}

/// Rows under a common heading.
pub struct Group {
    /// The heading.
    pub title: String,
    /// As many cells a row as there are columns.
    pub rows: Vec<Vec<String>>,
}

/// A ratio of a paper beside ours.
#[derive(Clone, Debug, Serialize)]
pub struct Ratio {
    /// What is divided by what.
    pub what: &'static str,
    /// On which trial.
    pub trial: String,
    /// The technique above the line.
    pub spec: String,
    /// The technique below the line.
    pub base: String,
    /// What the paper says, if it does.
    pub paper: Option<f64>,
    /// What was measured here.
    pub ours: f64,
}

/// Under what circumstances a suite ran.
#[derive(Clone, Debug, Serialize)]
pub struct Context {
    /// The suite's name.
    pub suite: &'static str,
    /// The suite's title.
    pub title: &'static str,
    /// The paper.
    pub source: &'static str,
    /// The adapter's name.
    pub adapter: String,
    /// Whether the adapter computes on the CPU, so that its milliseconds say nothing about a GPU.
    pub software: bool,
    /// The command line.
    pub command: String,
    /// Frames whose median counts.
    pub frames: u32,
}

impl Context {
    /// What a time is made of.
    pub fn counted(&self) -> String {
        match self.frames {
            1 => "one frame".to_owned(),
            n => format!("median of {n} frames"),
        }
    }
}

impl Findings {
    /// Which clock the milliseconds were read from.
    pub fn clock(&self) -> &'static str {
        let mut by_wall = self.trials.iter().flat_map(|t| &t.runs).map(|run| run.cost.timing == Timing::Wall);
        let first = by_wall.next().unwrap_or(false);
        match (first, by_wall.any(|wall| wall != first)) {
            (false, false) => "GPU timestamps",
            (true, false) => "wall time from submission to completion (*)",
            _ => "GPU timestamps; wall time (*) where they contradict it",
        }
    }
}
