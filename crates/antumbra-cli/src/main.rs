//! Soft shadows from the command line: render, reference, compare, a window to look, and lists of what there is.
#![deny(missing_docs)]

mod bench;
mod cli;
mod commands;
mod error;
mod measure;
mod output;
mod progress;
mod report;
mod setup;
mod study;
mod table;
mod truth;
mod warnings;

use clap::Parser;
use std::backtrace::{Backtrace, BacktraceStatus};
use std::panic::{self, AssertUnwindSafe};
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    warnings::show();
    progress::catch_ctrl_c();
    panic::set_hook(Box::new(say_bug));
    match panic::catch_unwind(AssertUnwindSafe(|| commands::run(&cli.command))) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
        Err(_) => ExitCode::FAILURE,
    }
}

/// A panic is a bug of ours: the user is told so in words, and those who ask for a backtrace get it.
fn say_bug(info: &panic::PanicHookInfo) {
    let place = info.location().map_or(String::new(), |l| format!(" ({l})"));
    let what = info.payload_as_str().unwrap_or("no message");
    eprintln!("error: this is a bug in antumbra, please report it: {what}{place}");
    let trace = Backtrace::capture();
    if trace.status() == BacktraceStatus::Captured {
        eprintln!("{trace}");
    }
}
