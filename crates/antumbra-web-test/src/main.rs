//! Drives the page of the viewer in a headless browser: `cargo xtask test-web`.
//!
//! Called with the page's folder, and maybe with SPECs in the place of the usual three, or `all`. It compares the error
//! of each technique with what the program `antumbra` gives for the same scene and size, repeats user actions
//! ([`checks`]), and keeps screenshots beside the folder. `--check NAME` does only the checks whose names have that
//! part.

mod browser;
mod checks;
mod page;
mod server;

use browser::Browser;
use checks::CHECKS;
use page::Page;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

const SCENE: &str = "builtin:fence";
const SPECS: [&str; 3] = ["hard", "pcss", "backprojection"];
/// The window, pixels; the image fills the rest beside the panels, at this fraction of the resolution.
const WINDOW: [u32; 2] = [760, 640];
const RESOLUTION: f32 = 0.25;
/// How far the errors on the page and of the program may be apart.
const APART: f64 = 0.01;
/// The longest that anything on the page may take.
const PATIENCE: Duration = Duration::from_secs(420);

type Outcome<T> = Result<T, String>;

/// Browser program.
struct Arguments {
    specs: Vec<String>,
    /// A part of the names of the checks that are wanted, and nothing else.
    check: Option<String>,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((page, rest)) = arguments.split_first() else {
        eprintln!("antumbra-web-test PAGE [SPEC … | all | --check NAME]");
        return ExitCode::from(2);
    };
    match chosen(rest).and_then(|rest| run(Path::new(page), &rest)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("the page fails: {error}");
            ExitCode::FAILURE
        }
    }
}

fn chosen(arguments: &[String]) -> Outcome<Arguments> {
    let of = |specs| Ok(Arguments { specs, check: None });
    match arguments {
        [] => of(SPECS.map(str::to_owned).to_vec()),
        [option, name] if option == "--check" => Ok(Arguments { specs: Vec::new(), check: Some(name.clone()) }),
        [all] if all == "all" => {
            let techniques: Value =
                serde_json::from_str(&antumbra(&["techniques", "--json"])?).map_err(|e| e.to_string())?;
            let names = techniques.as_array().into_iter().flatten().filter_map(|t| t["name"].as_str());
            of(names.map(str::to_owned).collect())
        }
        _ => of(arguments.to_vec()),
    }
}

/// Output of the program.
fn antumbra(arguments: &[&str]) -> Outcome<String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let called = Command::new(cargo).args(["run", "--quiet", "--bin", "antumbra", "--"]).args(arguments).output();
    let output = called.map_err(|e| e.to_string())?;
    match output.status.success() {
        true => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
        false => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
    }
}

fn run(page: &Path, arguments: &Arguments) -> Outcome<()> {
    let shots = page.with_file_name("page-test");
    std::fs::create_dir_all(&shots).map_err(|e| e.to_string())?;
    let address = server::serve(page.to_path_buf()).map_err(|e| e.to_string())?;
    let mut page = Page { browser: Browser::start(WINDOW)?, address, shots };
    let all = drive(&mut page, arguments);
    if all.is_err() {
        page.shot("failed")?;
    }
    all
}

/// All checks in sequence; the first that is wrong ends it.
fn drive(page: &mut Page, arguments: &Arguments) -> Outcome<()> {
    if arguments.check.is_none() {
        says_what_is_missing(page)?;
        let (state, errors) = draw(page, &arguments.specs)?;
        compare(&state, &arguments.specs, &errors)?;
    }
    let named = |name: &str| arguments.check.as_ref().is_none_or(|part| name.contains(part.as_str()));
    for (name, check) in CHECKS.into_iter().filter(|(name, _)| named(name)) {
        let start = Instant::now();
        let seen = check(page).map_err(|e| format!("{name}: {e}"))?;
        println!("{name}: {seen} ({:.1} s)", start.elapsed().as_secs_f32());
    }
    Ok(())
}

/// The page's final state, and the error of each technique.
fn draw(page: &mut Page, specs: &[String]) -> Outcome<(Value, Vec<f64>)> {
    let start = Instant::now();
    let first = &specs[0];
    page.open(&format!("?scene={SCENE}&technique={first}&compare=truth&resolution={RESOLUTION}"))?;
    page.rest()?;
    println!("loaded, drawn and traced in {:.1} s", start.elapsed().as_secs_f32());

    let mut errors = Vec::new();
    for spec in specs {
        let start = Instant::now();
        page.ask(&json!({ "technique": { "half": 0, "spec": spec } }))?;
        page.rest()?;
        let state = page.state()?;
        page.shot(&spec.replace([':', '=', ','], "-"))?;
        let seconds = start.elapsed().as_secs_f32();
        errors.push(error_of(&state, spec).inspect_err(|e| println!("{spec}: {e} ({seconds:.1} s)"))?);
        println!("{spec}: average error {:.4} ({seconds:.1} s)", errors[errors.len() - 1]);
    }
    page.no_errors()?;
    Ok((page.state()?, errors))
}

/// Without WebGPU the page says so in words.
fn says_what_is_missing(page: &mut Page) -> Outcome<()> {
    let hide = "Object.defineProperty(Navigator.prototype, 'gpu', { get: () => undefined })";
    let script = page.browser.call("Page.addScriptToEvaluateOnNewDocument", json!({ "source": hide }))?;
    page.browser.open(&page.address)?;
    page.browser.wait_for("document.getElementById('cover')?.className == 'failed'", PATIENCE)?;
    let text = page.browser.value("document.getElementById('message').innerText")?;
    let said = text.as_str().is_some_and(|t| t.contains("no WebGPU"));
    page.shot("no-webgpu")?;
    let identifier = json!({ "identifier": script["identifier"] });
    page.browser.call("Page.removeScriptToEvaluateOnNewDocument", identifier)?;
    if said { Ok(()) } else { Err(format!("without WebGPU the page says: {text}")) }
}

/// The average error of the drawn technique.
fn error_of(state: &Value, spec: &str) -> Outcome<f64> {
    for key in ["errors", "faults"] {
        if state[key].as_array().is_none_or(|list| !list.is_empty()) {
            return Err(format!("{key}: {}", state[key]));
        }
    }
    if let Some(why) = state["failed"][0].as_str() {
        return Err(why.to_owned());
    }
    if state["drawn"][0] != spec {
        return Err(format!("{} is drawn", state["drawn"][0]));
    }
    state["average_error"][0].as_f64().ok_or_else(|| format!("there is no error: {state}"))
}

/// Comparison with the program for the same scene and size.
fn compare(state: &Value, specs: &[String], errors: &[f64]) -> Outcome<()> {
    let report = tempfile::tempdir().map_err(|e| e.to_string())?;
    let size = format!("{}x{}", state["image"][0], state["image"][1]);
    let folder = report.path().to_string_lossy().into_owned();
    let mut arguments = vec!["compare", SCENE, "--size", &size, "-o", &folder];
    arguments.extend(specs.iter().flat_map(|spec| ["-t", spec]));
    antumbra(&arguments)?;
    let file: PathBuf = report.path().join("results.json");
    let text = std::fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
    let results: Value = serde_json::from_str(&text).map_err(|e| e.to_string())?;
    let mut apart = Vec::new();
    println!("{size}  page     program");
    for (i, (spec, here)) in specs.iter().zip(errors).enumerate() {
        let there = results["techniques"][i]["figures"]["average_error"].as_f64();
        let there = there.ok_or_else(|| format!("the program gives no error of {spec}: {results}"))?;
        println!("{spec}: {here:.4} {there:.4}");
        if (here - there).abs() > APART {
            apart.push(format!("{spec}: {here:.4} on the page, {there:.4} by the program"));
        }
    }
    if apart.is_empty() { Ok(()) } else { Err(apart.join("; ")) }
}
