//! `antumbra compare`: techniques beside the truth, as a table and as a report.

use super::print;
use crate::cli::CompareArgs;
use crate::error::CliError;
use crate::measure::{self, Cost, Timing};
use crate::progress::{self, Progress};
use crate::report::{self, Entry, Pass, Report};
use crate::truth::{self, Truth};
use crate::{output, setup, table};
use antumbra::scene::SceneRenderer;
use antumbra::{Gpu, Spec};
use antumbra_metrics::{Image, MetricsError, RgbImage, figures, heat_map};
use antumbra_scene::Scene;
use pollster::block_on;

/// Compares and writes the report.
pub fn run(args: &CompareArgs) -> Result<(), CliError> {
    output::check_new_folder(&args.output)?;
    let (scene, size) = setup::scene(&args.scene)?;
    let gpu = setup::gpu(&args.gpu, size)?;
    let renderer = setup::renderer(&gpu, &scene, size)?;

    // Techniques first: what is wrong with one shows itself before the truth takes its time.
    let drawn = draw_all(args, &gpu, &renderer)?;
    let truth = truth::of(&scene, size, &args.truth)?;
    let entries = drawn.into_iter().map(|d| d.judged(size, &truth)).collect::<Result<Vec<_>, _>>()?;
    let report = assemble(args, &gpu, &renderer, &scene, size, truth, entries)?;
    progress::check_cancelled()?;
    report::write(&report, &args.output)?;
    print(&format!("\nReport: {}\n", args.output.join("index.html").display()))
}

/// What a technique has made of the scene.
struct Drawn<'a> {
    spec: &'a Spec,
    cost: Cost,
    visibility: Vec<f32>,
    picture: Vec<u8>,
}

fn draw_all<'a>(args: &'a CompareArgs, gpu: &Gpu, renderer: &SceneRenderer) -> Result<Vec<Drawn<'a>>, CliError> {
    let specs: Vec<&Spec> = args.techniques.iter().flat_map(|t| &t.0).map(|t| &t.0).collect();
    let progress = Progress::new("Rendering");
    let count = specs.len() as f32;
    let draw = |(i, &spec): (usize, &&'a Spec)| {
        let mut technique = block_on(gpu.checked(|| spec.make(gpu)))?;
        let shown = |done| progress.set((i as f32 + done) / count);
        let cost = measure::measure(gpu, renderer, &mut *technique, args.gpu.frames, shown)?;
        let visibility = setup::visibility(gpu, renderer)?;
        Ok(Drawn { spec, cost, visibility, picture: setup::picture(gpu, renderer)? })
    };
    specs.iter().enumerate().map(draw).collect()
}

impl Drawn<'_> {
    /// With its distance from the truth.
    fn judged(self, size: [u32; 2], truth: &Truth) -> Result<(Entry, Timing), CliError> {
        let [width, height] = size;
        let reference = &truth.reference;
        let compare = || {
            let test = Image::new(width, height, &self.visibility)?;
            let exact = Image::new(width, height, &reference.visibility)?;
            Ok((figures(test, exact, &reference.valid)?, heat_map(test, exact, &reference.valid)?))
        };
        let wrong = |source: MetricsError| CliError::Metrics { spec: self.spec.text.clone(), source };
        let (figures, heat_map) = compare().map_err(wrong)?;
        let info = self.spec.technique;
        let entry = Entry {
            technique: info.name.to_owned(),
            title: info.title.to_owned(),
            source: info.source.to_owned(),
            spec: self.spec.text.clone(),
            settings: self.spec.settings.clone(),
            figures,
            passes: self.cost.passes.into_iter().map(reported).collect(),
            total_ms: self.cost.total_ms,
            total_bytes: self.cost.total_bytes,
            picture: RgbImage { width, height, data: self.picture },
            visibility: self.visibility,
            heat_map,
        };
        Ok((entry, self.cost.timing))
    }
}

/// A pass as the report has it, where an unknown time is not a number.
fn reported(pass: measure::Pass) -> Pass {
    Pass { name: pass.name, ms: pass.ms.unwrap_or(f64::NAN), bytes: pass.bytes, host: pass.host }
}

/// Prints the table and puts the report together.
fn assemble(
    args: &CompareArgs,
    gpu: &Gpu,
    renderer: &SceneRenderer,
    scene: &Scene,
    size: [u32; 2],
    truth: Truth,
    entries: Vec<(Entry, Timing)>,
) -> Result<Report, CliError> {
    let [width, height] = size;
    let triangles = scene.triangle_count();
    let software = if gpu.is_software() { ", software" } else { "" };
    let head = format!(
        "{}, {triangles} triangles, {width} x {height}, {}{software}\nTruth: {}\n\n",
        args.scene.scene,
        gpu.info.name,
        truth.summary()
    );
    print(&(head + &table::of(&entries)))?;
    renderer.write_visibility(gpu, &truth.reference.visibility);
    let picture = RgbImage { width, height, data: setup::picture(gpu, renderer)? };
    Ok(Report {
        scene: args.scene.scene.clone(),
        triangles: triangles as u64,
        width,
        height,
        adapter: gpu.info.name.clone(),
        software: gpu.is_software(),
        command: command_line(),
        truth: report::Truth {
            picture,
            light_samples: args.truth.light_samples,
            pixel_samples: args.truth.pixel_samples,
            seconds: truth.seconds,
            error_estimate: truth.reference.rms_error(),
            visibility: truth.reference.visibility,
        },
        entries: entries.into_iter().map(|(entry, _)| entry).collect(),
    })
}

/// The command as it was typed; words with spaces in quotes.
fn command_line() -> String {
    let quoted = |word: String| if word.contains(' ') { format!("'{word}'") } else { word };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("antumbra".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
