//! `antumbra reference`: the ray-traced reference alone. It needs no GPU.

use super::print;
use crate::cli::ReferenceArgs;
use crate::error::CliError;
use crate::output::{self, Format, OutputFile, Outputs};
use crate::progress::Terminal;
use crate::setup;
use antumbra_bench::Monitor;
use antumbra_bench::truth::Truth;

/// Traces and writes the files of the command line.
pub fn run(args: &ReferenceArgs) -> Result<(), CliError> {
    let files = || [Some(&args.visibility.file), args.valid.as_ref()].into_iter().flatten();
    output::check_files(files())?;
    let (scene, size) = setup::scene(&args.scene)?;
    let truth = Truth::of(&scene, size, &setup::truth(&args.truth), &Terminal)?;

    let mut outputs = Outputs::default();
    let bytes = output::encode_values(args.visibility.format, size, &truth.reference.visibility);
    outputs.stage(&args.visibility.file, bytes)?;
    if let Some(file) = &args.valid {
        let ones: Vec<f32> = truth.reference.valid.iter().map(|&v| f32::from(u8::from(v))).collect();
        outputs.stage(file, output::encode_values(Format::Npy, size, &ones))?;
    }
    Terminal.check()?;
    outputs.commit()?;
    if files().any(OutputFile::is_stdout) {
        Terminal.log(&truth.summary());
        return Ok(());
    }
    print(&format!("{}\n", truth.summary()))
}
