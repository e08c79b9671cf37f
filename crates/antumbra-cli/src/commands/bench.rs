//! `antumbra bench`: suites of measurements, each written as soon as it is complete.

use super::{print, write_report};
use crate::cli::BenchArgs;
use crate::error::CliError;
use crate::progress::Terminal;
use crate::{output, setup};
use antumbra_bench::kit::{Context, Runner, Suite};
use antumbra_bench::list::SUITES;
use antumbra_bench::{Error, truth};
use antumbra_scene::Scene;

/// Runs the suites of the command line, or all.
pub fn run(args: &BenchArgs) -> Result<(), CliError> {
    output::check_new_folder(&args.output)?;
    let size = args.size.map(|size| size.0);
    truth::check_size(size.unwrap_or([1, 1]))?;
    let scenes = scenes(args)?;
    let gpu = setup::gpu(&args.gpu, size.unwrap_or([1, 1]))?;
    let truth = setup::truth(&args.truth);
    let runner = Runner { gpu: &gpu, monitor: &Terminal, size, frames: args.gpu.frames, truth, scenes: &scenes };
    chosen(args).try_for_each(|suite| measure(suite, &runner, args))
}

fn chosen(args: &BenchArgs) -> impl Iterator<Item = &'static Suite> {
    let named = |suite: &&Suite| args.suites.is_empty() || args.suites.iter().any(|s| s.name == suite.name);
    SUITES.iter().filter(named)
}

/// Loads the command line's scenes first: a mistyped name shows before hours of work.
fn scenes(args: &BenchArgs) -> Result<Vec<Scene>, Error> {
    if !args.scenes.is_empty() && !chosen(args).any(|suite| suite.scenes) {
        tracing::warn!("--scene is for suites that take further scenes; the chosen suites do not");
    }
    Ok(args.scenes.iter().map(antumbra_scene::load).collect::<Result<_, _>>()?)
}

fn measure(suite: &Suite, runner: &Runner, args: &BenchArgs) -> Result<(), CliError> {
    let gpu = runner.gpu;
    let software = if gpu.is_software() { ", software" } else { "" };
    print(&format!("{} [{}], {}{software}\n\n", suite.title, suite.source, gpu.info.name))?;
    let report = (suite.run)(runner)?;
    let context = Context {
        suite: suite.name,
        title: suite.title,
        source: suite.source,
        adapter: gpu.info.name.clone(),
        software: gpu.is_software(),
        command: setup::command_line(),
        frames: runner.frames,
    };
    write_report(&context, &report, &args.output)
}
