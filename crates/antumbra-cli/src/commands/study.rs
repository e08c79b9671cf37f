//! `antumbra study`: one question, answered as a page, a table and numbers.

use super::print;
use crate::bench::kit::{self, Context};
use crate::cli::StudyArgs;
use crate::error::CliError;
use crate::{output, progress, setup};

/// Studies, and writes what was found.
pub fn run(args: &StudyArgs) -> Result<(), CliError> {
    output::check_new_folder(&args.output)?;
    let study = args.study;
    let gpu = setup::gpu(&args.gpu, [1, 1])?;
    print(&format!("{} [{}], {}\n\n", study.title, study.source, gpu.info.name))?;
    let findings = (study.run)(&gpu, args)?;
    progress::check_cancelled()?;
    let context = Context {
        suite: study.name,
        title: study.title,
        source: study.source,
        adapter: gpu.info.name.clone(),
        software: gpu.is_software(),
        command: setup::command_line(),
        frames: args.gpu.frames,
    };
    kit::write(&context, &findings, &args.output)?;
    let page = args.output.join(format!("{}.html", study.name));
    print(&format!("{}\n{}\n\nReport: {}\n", kit::terminal(&findings), findings.lead, page.display()))
}
