//! The commands.

mod bench;
mod compare;
mod list;
mod reference;
mod render;
mod study;
#[cfg(feature = "viewer")]
mod view;

use crate::cli::Command;
use crate::error::CliError;
use crate::progress::Terminal;
use antumbra_bench::kit::{self, Context, Report};
use antumbra_bench::{Error, Monitor};
use std::io::{self, Write};
use std::path::Path;

/// Runs a command.
pub fn run(command: &Command) -> Result<(), CliError> {
    match command {
        Command::Render(args) => render::run(args),
        Command::Reference(args) => reference::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Study(study) => study::run(study),
        #[cfg(feature = "viewer")]
        Command::View(args) => view::run(args),
        Command::Techniques(args) => list::techniques(args.json),
        Command::Scenes(args) => list::scenes(args.json),
        Command::Adapters(args) => list::adapters(args.json),
    }
}

/// Prints to stdout. A closed pipe (`| head`) is no error.
fn print(text: &str) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(source) if source.kind() != io::ErrorKind::BrokenPipe => {
            Err(CliError::Write { path: "standard output".into(), source })
        }
        _ => Ok(()),
    }
}

/// Writes the files of a suite or study and prints its tables.
fn write_report(context: &Context, report: &Report, to: &Path) -> Result<(), CliError> {
    Terminal.check()?;
    kit::write(context, report, to).map_err(Error::from)?;
    let page = to.join(format!("{}.html", context.suite));
    print(&format!("{}\n{}\n\nReport: {}\n", report.terminal(), report.lead, page.display()))
}
