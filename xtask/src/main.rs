//! What a contributor types: `cargo xtask demo`, `test`, `fuzz`, `web`, `test-web`.

mod fuzz;
mod machine;
mod same_bits;
mod step;
mod toolchain;
mod validate;
mod web;

use std::process::ExitCode;

use step::{Failure, Step, available, cargo};

const USAGE: &str = "\
cargo xtask demo [ARGUMENT …]         compare techniques on a built-in scene; arguments go on to `antumbra compare`
cargo xtask test                      formatting, lints, documentation and all tests, as the CI does
cargo xtask docs                      write the tables of settings in docs/techniques anew
cargo xtask same-bits COMMIT [SCENE …]  compare every technique's visibility with that at a commit, bit for bit
cargo xtask validate                  draw with every technique under Vulkan's validation layer
cargo xtask fuzz [TARGET] [SECONDS]   fuzz one importer, or all in turn, for 60 seconds each
cargo xtask web [--out FOLDER]        build the web page of the viewer, for any web server
cargo xtask test-web                  build it and drive it in a headless browser";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match arguments.split_first() {
        Some((task, rest)) if task == "demo" => demo(rest),
        Some((task, [])) if task == "test" => test(),
        Some((task, [])) if task == "docs" => docs(),
        Some((task, rest)) if task == "same-bits" => same_bits::run(rest),
        Some((task, [])) if task == "validate" => validate::run(),
        Some((task, rest)) if task == "fuzz" => fuzz::run(rest),
        Some((task, rest)) if task == "web" => web::run(rest),
        Some((task, rest)) if task == "test-web" => web::test(rest),
        Some((task, _)) if task == "help" || task == "--help" => {
            println!("{USAGE}");
            Ok(())
        }
        _ => Err(Failure::Usage(format!("`{}` is no task; there are\n{USAGE}", arguments.join(" ")))),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("xtask: {failure}");
            failure.exit_code()
        }
    }
}

/// Renders and compares a built-in scene; the program's table and the report's place are the last output.
fn demo(more: &[String]) -> Result<(), Failure> {
    machine::set_up(&[machine::Need::CppCompiler, machine::Need::VulkanDriver])?;
    // `--bin` and no `--package`: features are then those of the whole workspace, so that `test` builds nothing twice.
    let mut compare = cargo(["run", "--bin", "antumbra", "--", "compare", "builtin:fence"])
        .args(["-t", "hard", "-t", "pcf", "-t", "pcss", "-t", "backprojection"])
        .args(more);
    // A quarter of the usual rays: nobody waits long for a demo.
    for (option, value) in [("-o", "target/demo"), ("--light-samples", "256")] {
        if !more.iter().any(|given| given == option) {
            compare = compare.args([option, value]);
        }
    }
    // Mesa's device chooser complains of a missing display on every start; the program chooses its adapter itself.
    Step::new("demo", compare.env("NODEVICE_SELECT", "1")).run()?;
    Ok(())
}

/// Writes what the documents have from the code: the test that compares them rewrites them instead.
fn docs() -> Result<(), Failure> {
    let line = cargo(["test", "-p", "antumbra", "--test", "docs"]).env("UPDATE_DOCS", "1");
    Step::new("docs", line).run()?;
    Ok(())
}

/// All that must hold before a commit is shared. The tests come last and nothing is printed after them, so that their
/// closing lines can be read by a machine.
fn test() -> Result<(), Failure> {
    use machine::Need;
    machine::set_up(&[Need::CppCompiler, Need::VulkanDriver, Need::VirtualDisplay, Need::Rustfmt, Need::Clippy])?;
    let mut steps = vec![
        Step::new("fmt", cargo(["fmt", "--all", "--check"])),
        Step::new("clippy", cargo(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])),
        Step::new("doc", cargo(["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings")),
    ];
    let tests = if available("cargo", &["nextest", "--version"]) {
        steps.push(Step::new("doctests", cargo(["test", "--workspace", "--doc"])));
        cargo(["nextest", "run", "--workspace"])
    } else {
        eprintln!("xtask: cargo-nextest is not installed; `cargo test` serves, slower");
        cargo(["test", "--workspace"])
    };

    let mut times = Vec::new();
    for step in steps {
        let name = step.name();
        times.push(format!("{name} {:.0} s", step.run()?.as_secs_f64()));
    }
    eprintln!("xtask: {}", times.join(", "));
    Step::new("tests", tests).run()?;
    Ok(())
}
