//! `antumbra compare`: techniques beside the reference, as a table and as a report.

use super::print;
use crate::cli::CompareArgs;
use crate::error::CliError;
use crate::progress::Terminal;
use crate::{output, setup};
use antumbra::Spec;
use antumbra_bench::{Error, Monitor, comparison};

/// Compares and writes the report.
pub fn run(args: &CompareArgs) -> Result<(), CliError> {
    output::check_new_folder(&args.output)?;
    let (scene, size) = setup::scene(&args.scene)?;
    let gpu = setup::gpu(&args.gpu, size)?;
    let specs: Vec<&Spec> = args.techniques.iter().flat_map(|t| &t.0).map(|t| &t.0).collect();
    let comparison = comparison::compare(
        (&gpu, &Terminal),
        (&args.scene.scene.to_string_lossy(), &scene, size),
        &specs,
        args.gpu.frames,
        &setup::truth(&args.truth),
        setup::command_line(),
    )?;
    print(&comparison::terminal(&comparison))?;
    Terminal.check()?;
    comparison::write(&comparison, &args.output).map_err(Error::from)?;
    print(&format!("\nReport: {}\n", args.output.join("index.html").display()))
}
