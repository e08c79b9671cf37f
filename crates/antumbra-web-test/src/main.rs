//! Drives the page of the viewer in a headless browser: `cargo xtask test-web`.
//!
//! Called with the page's folder, and maybe with SPECs in the place of the usual three, or `all`. It compares the error
//! of each technique with what the program `antumbra` gives for the same scene and size, and keeps a screenshot of each
//! beside the folder.

mod browser;
mod server;

use browser::Browser;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

const SCENE: &str = "builtin:fence";
const SPECS: [&str; 3] = ["hard", "pcss", "backprojection"];
/// The window, pixels; the picture is what its panels leave, at this part of the resolution.
const WINDOW: [u32; 2] = [760, 640];
const RESOLUTION: f32 = 0.25;
/// How far the errors on the page and of the program may be apart.
const APART: f64 = 0.01;
/// The longest that anything on the page may take.
const PATIENCE: Duration = Duration::from_secs(420);

type Outcome<T> = Result<T, String>;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((page, specs)) = arguments.split_first() else {
        eprintln!("antumbra-web-test PAGE [SPEC … | all]");
        return ExitCode::from(2);
    };
    match chosen(specs).and_then(|specs| run(Path::new(page), &specs)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("the page fails: {error}");
            ExitCode::FAILURE
        }
    }
}

fn chosen(arguments: &[String]) -> Outcome<Vec<String>> {
    match arguments {
        [] => Ok(SPECS.map(str::to_owned).to_vec()),
        [all] if all == "all" => {
            let techniques: Value =
                serde_json::from_str(&antumbra(&["techniques", "--json"])?).map_err(|e| e.to_string())?;
            let names = techniques.as_array().into_iter().flatten().filter_map(|t| t["name"].as_str());
            Ok(names.map(str::to_owned).collect())
        }
        _ => Ok(arguments.to_vec()),
    }
}

/// What the program prints.
fn antumbra(arguments: &[&str]) -> Outcome<String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let called = Command::new(cargo).args(["run", "--quiet", "--bin", "antumbra", "--"]).args(arguments).output();
    let output = called.map_err(|e| e.to_string())?;
    match output.status.success() {
        true => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
        false => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
    }
}

fn run(page: &Path, specs: &[String]) -> Outcome<()> {
    let shots = page.with_file_name("page-test");
    std::fs::create_dir_all(&shots).map_err(|e| e.to_string())?;
    let address = server::serve(page.to_path_buf()).map_err(|e| e.to_string())?;
    let mut browser = Browser::start(WINDOW)?;
    says_what_is_missing(&mut browser, &address, &shots)?;
    let drawn = draw(&mut browser, &address, &shots, specs);
    if drawn.is_err() {
        let shot = browser.screenshot()?;
        std::fs::write(shots.join("failed.png"), shot).map_err(|e| e.to_string())?;
    }
    drop(browser);
    let (state, errors) = drawn?;
    compare(&state, specs, &errors)
}

/// What the page says at the end, and the error of each technique.
fn draw(browser: &mut Browser, address: &str, shots: &Path, specs: &[String]) -> Outcome<(Value, Vec<f64>)> {
    let start = Instant::now();
    let first = &specs[0];
    let query = format!("?scene={SCENE}&technique={first}&compare=truth&resolution={RESOLUTION}");
    browser.open(&format!("{address}/{query}"))?;
    browser.wait_for("!!window.antumbra?.ask && document.getElementById('cover').className != ''", PATIENCE)?;
    rest(browser)?;
    println!("loaded, drawn and traced in {:.1} s", start.elapsed().as_secs_f32());

    let mut errors = Vec::new();
    for spec in specs {
        let start = Instant::now();
        ask(browser, &json!({ "technique": { "half": 0, "spec": spec } }))?;
        rest(browser)?;
        let state = ask(browser, &json!("state"))?["state"].clone();
        let shot = shots.join(format!("{}.png", spec.replace([':', '=', ','], "-")));
        std::fs::write(&shot, browser.screenshot()?).map_err(|e| format!("{}: {e}", shot.display()))?;
        let seconds = start.elapsed().as_secs_f32();
        errors.push(error_of(&state, spec).inspect_err(|e| println!("{spec}: {e} ({seconds:.1} s)"))?);
        println!("{spec}: average error {:.4} ({seconds:.1} s)", errors[errors.len() - 1]);
    }
    let state = ask(browser, &json!("state"))?["state"].clone();
    if !browser.errors.is_empty() {
        return Err(format!("errors on the console:\n{}", browser.errors.join("\n")));
    }
    Ok((state, errors))
}

/// Without WebGPU the page says so in words.
fn says_what_is_missing(browser: &mut Browser, address: &str, shots: &Path) -> Outcome<()> {
    let hide = "Object.defineProperty(Navigator.prototype, 'gpu', { get: () => undefined })";
    let script = browser.call("Page.addScriptToEvaluateOnNewDocument", json!({ "source": hide }))?;
    browser.open(address)?;
    browser.wait_for("document.getElementById('cover')?.className == 'failed'", PATIENCE)?;
    let text = browser.value("document.getElementById('message').innerText")?;
    let said = text.as_str().is_some_and(|t| t.contains("no WebGPU"));
    std::fs::write(shots.join("no-webgpu.png"), browser.screenshot()?).map_err(|e| e.to_string())?;
    browser.call("Page.removeScriptToEvaluateOnNewDocument", json!({ "identifier": script["identifier"] }))?;
    if said { Ok(()) } else { Err(format!("without WebGPU the page says: {text}")) }
}

/// Waits until nothing is under way on the page.
fn rest(browser: &mut Browser) -> Outcome<()> {
    browser.value("window.rested = false, antumbra.ask('wait').then(() => window.rested = true), 0")?;
    let rested = browser.wait_for("window.rested || document.getElementById('cover').className == 'failed'", PATIENCE);
    match rested.and_then(|()| browser.value("window.rested")) {
        Ok(Value::Bool(true)) => Ok(()),
        Ok(_) => Err(format!("the page broke off:\n{}", browser.errors.join("\n"))),
        Err(error) => Err(format!("{error}\n{}", browser.errors.join("\n"))),
    }
}

/// The answer to a command.
fn ask(browser: &mut Browser, command: &Value) -> Outcome<Value> {
    let answer = browser.value(&format!("antumbra.ask({command})"))?;
    match answer.get("error").and_then(Value::as_str) {
        Some(error) => Err(format!("{command}: {error}")),
        None => Ok(answer),
    }
}

/// The average error of what is drawn, if all went well.
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

/// Against what the program gives for the same scene and size.
fn compare(state: &Value, specs: &[String], errors: &[f64]) -> Outcome<()> {
    let report = tempfile::tempdir().map_err(|e| e.to_string())?;
    let size = format!("{}x{}", state["picture"][0], state["picture"][1]);
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
