//! `antumbra bench`: suites of measurements, each written when it is done.

use super::print;
use crate::bench::kit::{self, Context, Lab};
use crate::bench::{SUITES, Suite};
use crate::cli::BenchArgs;
use crate::error::CliError;
use crate::{output, progress, setup, truth};
use antumbra_scene::Scene;

/// Runs the suites that were asked for, or all.
pub fn run(args: &BenchArgs) -> Result<(), CliError> {
    output::check_new_folder(&args.output)?;
    let size = args.size.map_or([1, 1], |size| size.0);
    truth::check_size(size)?;
    let scenes = scenes(args)?;
    let gpu = setup::gpu(&args.gpu, size)?;
    let lab = Lab { args, gpu: &gpu, scenes: &scenes };
    chosen(args).try_for_each(|suite| measured(suite, &lab))
}

fn chosen(args: &BenchArgs) -> impl Iterator<Item = &'static Suite> {
    let named = |suite: &&Suite| args.suites.is_empty() || args.suites.iter().any(|s| s.name == suite.name);
    SUITES.iter().filter(named)
}

/// Loads the command line's scenes first: a name that is mistyped shows before hours of work.
fn scenes(args: &BenchArgs) -> Result<Vec<Scene>, CliError> {
    if !args.scenes.is_empty() && !chosen(args).any(|suite| suite.scenes) {
        tracing::warn!("--scene is for suites that take further scenes; those that were asked for do not");
    }
    Ok(args.scenes.iter().map(|name| antumbra_scene::load(name)).collect::<Result<_, _>>()?)
}

fn measured(suite: &Suite, lab: &Lab) -> Result<(), CliError> {
    let Lab { args, gpu, .. } = *lab;
    let software = if gpu.is_software() { ", software" } else { "" };
    print(&format!("{} [{}], {}{software}\n\n", suite.title, suite.source, gpu.info.name))?;
    let findings = (suite.run)(lab)?;
    progress::check_cancelled()?;
    let context = Context {
        suite: suite.name,
        title: suite.title,
        source: suite.source,
        adapter: gpu.info.name.clone(),
        software: gpu.is_software(),
        command: setup::command_line(),
        frames: args.gpu.frames,
    };
    kit::write(&context, &findings, &args.output)?;
    let page = args.output.join(format!("{}.html", suite.name));
    print(&format!("{}\n{}\n\nReport: {}\n", kit::terminal(&findings), findings.lead, page.display()))
}
