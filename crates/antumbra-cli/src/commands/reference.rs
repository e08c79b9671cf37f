//! `antumbra reference`: the ray-traced reference alone. It needs no GPU.

use super::print;
use crate::cli::ReferenceArgs;
use crate::error::CliError;
use crate::output::{self, Format, Outputs};
use crate::progress::Terminal;
use crate::setup;
use antumbra_bench::Monitor;
use antumbra_bench::truth::Truth;

/// Traces and writes the files of the command line.
pub fn run(args: &ReferenceArgs) -> Result<(), CliError> {
    output::check_files([Some(args.visibility.path.as_path()), args.valid.as_deref()].into_iter().flatten())?;
    let (scene, size) = setup::scene(&args.scene)?;
    let truth = Truth::of(&scene, size, &setup::truth(&args.truth), &Terminal)?;

    let mut outputs = Outputs::default();
    let bytes = output::encode_values(args.visibility.format, size, &truth.reference.visibility);
    outputs.stage(&args.visibility.path, bytes)?;
    if let Some(path) = &args.valid {
        let ones: Vec<f32> = truth.reference.valid.iter().map(|&v| f32::from(u8::from(v))).collect();
        outputs.stage(path, output::encode_values(Format::Npy, size, &ones))?;
    }
    Terminal.check()?;
    outputs.commit()?;
    print(&format!("{}\n", truth.summary()))
}
