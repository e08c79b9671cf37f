//! `antumbra study`: a paper's user study, repeated with an image metric.

use super::write_report;
use crate::cli::{RhoArgs, Study};
use crate::error::CliError;
use crate::progress::Terminal;
use crate::{output, setup};
use antumbra_bench::studies::rho;

/// Runs a study and writes its page.
pub fn run(study: &Study) -> Result<(), CliError> {
    match study {
        Study::Rho(args) => run_rho(args),
    }
}

fn run_rho(args: &RhoArgs) -> Result<(), CliError> {
    output::check_new_folder(&args.output)?;
    let found = rho::search(args.threshold, args.most, &Terminal)?;
    write_report(&rho::context(setup::command_line()), &rho::report(&found, args.threshold), &args.output)
}
