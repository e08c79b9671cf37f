//! The commands: each takes its arguments and works through to the end.

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
use std::io::{self, Write};

/// Does what was asked.
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

/// Prints to stdout. A reader that has gone away (`| head`) has seen what it wanted.
fn print(text: &str) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(source) if source.kind() != io::ErrorKind::BrokenPipe => {
            Err(CliError::Write { path: "standard output".into(), source })
        }
        _ => Ok(()),
    }
}
