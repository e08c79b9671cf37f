//! Soft shadows from the command line: render, reference, compare, measure, a viewer, and lists.
#![deny(missing_docs)]

mod cli;
mod commands;
mod error;
mod output;
mod progress;
mod setup;
mod warnings;

use antumbra_bench::Monitor;
use clap::Parser;
use progress::Terminal;
use std::backtrace::{Backtrace, BacktraceStatus};
use std::panic::{self, AssertUnwindSafe};
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    warnings::show();
    progress::catch_ctrl_c();
    panic::set_hook(Box::new(report_bug));
    match panic::catch_unwind(AssertUnwindSafe(|| commands::run(&cli.command))) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) => {
            Terminal.log(&format!("error: {error}"));
            ExitCode::from(error.exit_code())
        }
        Err(_) => ExitCode::FAILURE,
    }
}

/// Reports a panic as a bug, with a backtrace where the user has enabled one.
fn report_bug(info: &panic::PanicHookInfo) {
    let position = info.location().map_or(String::new(), |l| format!(" ({l})"));
    let what = info.payload_as_str().unwrap_or("no message");
    Terminal.log(&format!("error: this is a bug in antumbra, please report it: {what}{position}"));
    let trace = Backtrace::capture();
    if trace.status() == BacktraceStatus::Captured {
        Terminal.log(&trace.to_string());
    }
}
