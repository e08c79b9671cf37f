//! `antumbra view`: techniques in a window.

use crate::cli::ViewArgs;
use crate::error::CliError;
use crate::progress::Terminal;
use antumbra_bench::Monitor;
use antumbra_viewer::Options;

/// Opens the window; ends when it is closed.
pub fn run(args: &ViewArgs) -> Result<(), CliError> {
    // Ctrl-C only requests a stop of long work; a window closes at once.
    std::thread::spawn(|| {
        while !Terminal.stop().load(std::sync::atomic::Ordering::Relaxed) {
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        std::process::exit(130);
    });
    let options = Options {
        scene: args.scene.as_ref().map(|s| s.to_string_lossy().into_owned()),
        specs: args.techniques.iter().map(|t| t.0.clone()).collect(),
        adapter: args.adapter.clone().unwrap_or_default(),
        size: args.size.map(|s| s.0),
        commands: args.commands,
    };
    Ok(antumbra_viewer::run(options)?)
}
