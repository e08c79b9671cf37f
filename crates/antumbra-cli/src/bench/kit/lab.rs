//! Measuring techniques on scenes.

use crate::cli::{BenchArgs, TruthArgs};
use crate::error::CliError;
use crate::measure::{self, Cost, Drawn, Timing};
use crate::progress::Progress;
use crate::report::text;
use crate::truth::{self, Truth};
use crate::{progress, setup};
use antumbra::scene::SceneRenderer;
use antumbra::{Error, Gpu, Spec};
use antumbra_metrics::{Figures, RgbImage};
use antumbra_scene::Scene;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// Truth between these is penumbra that a viewer can tell from light and from umbra.
const PENUMBRA: std::ops::Range<f32> = 0.01..0.99;

/// Where suites measure.
pub struct Lab<'a> {
    /// What the command line says.
    pub args: &'a BenchArgs,
    /// What draws.
    pub gpu: &'a Gpu,
    /// Scenes beside a suite's own.
    pub scenes: &'a [Scene],
}

/// Reads SPECs.
pub fn specs(texts: Vec<String>) -> Result<Vec<Spec>, CliError> {
    Ok(texts.iter().map(|text| text.parse::<Spec>()).collect::<Result<_, _>>().map_err(Error::from)?)
}

/// A SPEC with a map of this size.
pub fn with_map(spec: &str, map: u32) -> String {
    format!("{spec}{}map={map}", if spec.contains(':') { ',' } else { ':' })
}

/// What to measure.
pub struct Order<'a> {
    /// Name of the trial in the suite.
    pub name: &'a str,
    /// What is drawn.
    pub scene: &'a Scene,
    /// Size of the picture in pixels.
    pub size: [u32; 2],
    /// Which techniques draw.
    pub specs: &'a [Spec],
    /// How many frames of each count; 0 draws one without warming up, where only the error matters.
    pub frames: u32,
    /// How the truth is traced.
    pub truth: &'a TruthArgs,
    /// Whether the picture that each technique makes is kept to be shown.
    pub pictures: bool,
}

/// A scene at one size, and what several techniques made of it one after another.
#[derive(Clone, Debug, Serialize)]
pub struct Trial {
    /// Its name in the suite.
    pub name: String,
    /// The scene that it was made from.
    pub scene: String,
    /// Triangles of the scene.
    pub triangles: usize,
    /// Width of the picture, pixels.
    pub width: u32,
    /// Height of the picture, pixels.
    pub height: u32,
    /// Part of the valid pixels whose true visibility is neither 0 nor 1, but for a hundredth.
    pub penumbra: f64,
    /// Shadow rays of a pixel of the truth.
    pub light_samples: u32,
    /// Primary rays of a pixel of the truth.
    pub pixel_samples: u32,
    /// The tracer's estimate of its own mean error in visibility.
    pub truth_error: f64,
    /// How many frames of each technique count; with 0 the times include what the first frame prepares.
    pub frames: u32,
    /// The scene shaded with the truth.
    #[serde(skip)]
    pub picture: RgbImage,
    /// One entry a technique.
    pub runs: Vec<Run>,
}

/// One technique on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Run {
    /// Its name.
    pub technique: &'static str,
    /// Its name and settings as one would type them.
    pub spec: String,
    /// All settings.
    pub settings: serde_json::Value,
    /// How far from the truth it is.
    pub figures: Figures,
    /// What it says of its work, such as the number of maps.
    pub work: BTreeMap<&'static str, f64>,
    /// What it took.
    #[serde(flatten)]
    pub cost: Cost,
    /// The scene shaded with what it found, if that is to be shown.
    #[serde(skip)]
    pub picture: Option<RgbImage>,
}

impl Lab<'_> {
    /// The command line's size, or what the suite likes best.
    pub fn size(&self, own: [u32; 2]) -> [u32; 2] {
        self.args.size.map_or(own, |size| size.0)
    }

    /// Measures one order after another, and says on stderr how far it is.
    pub fn trials(&self, orders: &[Order]) -> Result<Vec<Trial>, CliError> {
        let (all, started) = (orders.len(), Instant::now());
        let trial = |(i, order): (usize, &Order)| {
            let [width, height] = order.size;
            let (name, techniques, after) =
                (order.name, order.specs.len(), text::seconds(started.elapsed().as_secs_f64()));
            eprintln!("{} of {all}: {name}, {width} x {height}, {techniques} techniques, after {after}", i + 1);
            self.trial(order)
        };
        orders.iter().enumerate().map(trial).collect()
    }

    /// Measures techniques on a scene, next to one another, and then traces what they are judged by.
    pub fn trial(&self, order: &Order) -> Result<Trial, CliError> {
        let Order { scene, size, specs, .. } = *order;
        self.gpu.check_size("picture", size[0], size[1])?;
        let renderer = setup::renderer(self.gpu, scene, size)?;
        let drawn = self.draw_all(order, &renderer)?;
        let truth = truth::of(scene, size, order.truth)?;
        progress::check_cancelled()?;
        let shaded = |visibility: &[f32]| -> Result<RgbImage, CliError> {
            renderer.write_visibility(self.gpu, visibility);
            Ok(RgbImage { width: size[0], height: size[1], data: setup::picture(self.gpu, &renderer)? })
        };
        let run = |(spec, drawn): (&Spec, Drawn)| {
            let picture = if order.pictures { Some(shaded(&drawn.visibility)?) } else { None };
            Run::new(spec, drawn, picture, &truth)
        };
        let runs = specs.iter().zip(drawn).map(run).collect::<Result<_, _>>()?;
        Ok(Trial {
            name: order.name.to_owned(),
            scene: scene.name.clone(),
            triangles: scene.triangle_count(),
            width: size[0],
            height: size[1],
            penumbra: penumbra(&truth),
            light_samples: order.truth.light_samples,
            pixel_samples: order.truth.pixel_samples,
            frames: order.frames,
            truth_error: truth.reference.rms_error(),
            picture: shaded(&truth.reference.visibility)?,
            runs,
        })
    }

    fn draw_all(&self, order: &Order, renderer: &SceneRenderer) -> Result<Vec<Drawn>, CliError> {
        let progress = Progress::new(format!("Measuring {}", order.name));
        let draw = |(i, spec)| {
            let show = |done| progress.set((i as f32 + done) / order.specs.len() as f32);
            measure::draw(self.gpu, renderer, spec, order.frames, show)
        };
        let mut drawn: Vec<Drawn> = order.specs.iter().enumerate().map(draw).collect::<Result<_, _>>()?;
        one_clock(&mut drawn);
        Ok(drawn)
    }
}

/// Ratios need both sides by the same clock: where one goes by wall time, all do.
fn one_clock(drawn: &mut [Drawn]) {
    if drawn.iter().any(|d| d.cost.timing == Timing::Wall) {
        for Drawn { cost, .. } in drawn {
            (cost.total_ms, cost.timing) = (cost.wall_ms, Timing::Wall);
        }
    }
}

/// The part of the valid pixels that is in penumbra.
fn penumbra(truth: &Truth) -> f64 {
    let reference = &truth.reference;
    let valid = || reference.visibility.iter().zip(&reference.valid).filter(|(_, valid)| **valid);
    valid().filter(|(v, _)| PENUMBRA.contains(v)).count() as f64 / valid().count().max(1) as f64
}

impl Trial {
    /// The run of this spec.
    pub fn run(&self, spec: &str) -> Option<&Run> {
        self.runs.iter().find(|run| run.spec == spec)
    }

    /// Size of the picture.
    pub fn pixels(&self) -> String {
        format!("{} x {} pixels", self.width, self.height)
    }

    /// What was drawn, above the rows of a table.
    pub fn heading(&self) -> String {
        format!("{}: {}", self.name, self.drawn())
    }

    /// The scene, its size, and how sure the truth is.
    pub fn drawn(&self) -> String {
        format!(
            "{}, {} triangles, {:.1} % penumbra, truth ± {}",
            self.scene,
            text::count(self.triangles as u64),
            100.0 * self.penumbra,
            text::figure(self.truth_error)
        )
    }
}

impl Run {
    fn new(spec: &Spec, drawn: Drawn, picture: Option<RgbImage>, truth: &Truth) -> Result<Run, CliError> {
        Ok(Run {
            technique: spec.technique.name,
            spec: spec.text.clone(),
            settings: spec.settings.clone(),
            figures: truth.figures(&spec.text, &drawn.visibility)?,
            work: drawn.work.into_iter().collect(),
            cost: drawn.cost,
            picture,
        })
    }

    /// How many times as fast as `base`, a run of the same trial, it is.
    pub fn speed_over(&self, base: &Run) -> f64 {
        base.cost.total_ms / self.cost.total_ms
    }

    /// Milliseconds, with a star if they are wall time.
    pub fn ms(&self) -> String {
        let star = if self.cost.timing == Timing::Wall { "*" } else { "" };
        text::ms(self.cost.total_ms) + star
    }

    /// A figure of its work as a whole number; a dash if the technique does not tell.
    pub fn count(&self, of: &str) -> String {
        self.work.get(of).map_or_else(|| "–".to_owned(), |n| text::count(n.round() as u64))
    }
}
