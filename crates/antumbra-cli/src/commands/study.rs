//! `antumbra study`: a question that a paper has put to people, put to an image metric.

use super::print;
use crate::bench::kit::{self, Context};
use crate::cli::{RhoArgs, Study};
use crate::error::CliError;
use crate::study::rho;
use crate::{output, progress, setup};

/// Runs a study and writes its page.
pub fn run(study: &Study) -> Result<(), CliError> {
    match study {
        Study::Rho(args) => run_rho(args),
    }
}

fn run_rho(args: &RhoArgs) -> Result<(), CliError> {
    output::check_new_folder(&args.output)?;
    let found = rho::search(args.threshold, args.most)?;
    progress::check_cancelled()?;
    let findings = rho::findings(&found, args.threshold);
    let context = Context {
        suite: "rho",
        title: "Texels that a penumbra needs",
        source: "Shen 2011",
        adapter: "the CPU, in double precision".to_owned(),
        software: false,
        command: setup::command_line(),
        frames: 1,
    };
    kit::write(&context, &findings, &args.output)?;
    let page = args.output.join("rho.html");
    print(&format!("{}\n{}\n\nReport: {}\n", kit::terminal(&findings), findings.lead, page.display()))
}
