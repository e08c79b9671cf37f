//! `antumbra compare`: techniques beside the truth, as a table and as a report.

use super::print;
use crate::cli::CompareArgs;
use crate::error::CliError;
use crate::measure::{self, Drawn, Timing};
use crate::progress::{self, Progress};
use crate::report::{self, Entry, Pass, Report};
use crate::truth::{self, Truth};
use crate::{output, setup, table};
use antumbra::scene::SceneRenderer;
use antumbra::{Gpu, Spec};
use antumbra_metrics::RgbImage;
use antumbra_scene::Scene;

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
struct Shown<'a> {
    spec: &'a Spec,
    drawn: Drawn,
    picture: Vec<u8>,
}

fn draw_all<'a>(args: &'a CompareArgs, gpu: &Gpu, renderer: &SceneRenderer) -> Result<Vec<Shown<'a>>, CliError> {
    let specs: Vec<&Spec> = args.techniques.iter().flat_map(|t| &t.0).map(|t| &t.0).collect();
    let progress = Progress::new("Rendering");
    let count = specs.len() as f32;
    let draw = |(i, &spec): (usize, &&'a Spec)| {
        let show = |done| progress.set((i as f32 + done) / count);
        let drawn = measure::draw(gpu, renderer, spec, args.gpu.frames, show)?;
        Ok(Shown { spec, drawn, picture: setup::picture(gpu, renderer)? })
    };
    specs.iter().enumerate().map(draw).collect()
}

impl Shown<'_> {
    /// With its distance from the truth.
    fn judged(self, [width, height]: [u32; 2], truth: &Truth) -> Result<(Entry, Timing), CliError> {
        let (spec, Drawn { cost, visibility, .. }) = (self.spec, self.drawn);
        let entry = Entry {
            technique: spec.technique.name.to_owned(),
            title: spec.technique.title.to_owned(),
            source: spec.technique.source.to_owned(),
            spec: spec.text.clone(),
            settings: spec.settings.clone(),
            figures: truth.figures(&spec.text, &visibility)?,
            heat_map: truth.heat_map(&spec.text, &visibility)?,
            passes: cost.passes.into_iter().map(reported).collect(),
            total_ms: cost.total_ms,
            total_bytes: cost.total_bytes,
            picture: RgbImage { width, height, data: self.picture },
            visibility,
        };
        Ok((entry, cost.timing))
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
        command: setup::command_line(),
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
