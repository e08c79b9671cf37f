//! How long the page stands still at most.

use super::QUERY;
use crate::Outcome;
use crate::page::Page;
use serde_json::{Value, json};
use std::time::Instant;

/// Collects how long the page's thread was held by one task, where it was more than 50 ms.
const OBSERVE: &str = "window.tasks = []; new PerformanceObserver(list =>
    tasks.push(...list.getEntries().map(e => Math.round(e.duration)))).observe({ type: 'longtask' }), 0";

/// The longest that one task may hold the page's thread, milliseconds: several times the longest job without slices,
/// which is making the scene.
const MOST: f64 = 5000.0;

/// Loading, sorting, compiling for and tracing a large scene: no task of the page may hold its thread for long.
pub fn pipes(page: &mut Page) -> Outcome<String> {
    page.open(QUERY)?;
    page.settled()?;
    page.browser.value(OBSERVE)?;
    page.ask(&json!({ "resolution": 0.05 }))?;
    let mut seen = Vec::new();
    for (name, command) in [
        ("opening", json!({ "open": "builtin:pipes" })),
        ("pcss", json!({ "technique": { "half": 0, "spec": "pcss:map=256" } })),
        ("backprojection", json!({ "technique": { "half": 0, "spec": "backprojection:map=256" } })),
        ("tracing", json!({ "compare": "truth" })),
    ] {
        seen.push(held(page, name, &command)?);
    }
    page.shot("pipes")?;
    Ok(seen.join("; "))
}

/// Time that a command blocks the page's thread.
fn held(page: &mut Page, name: &str, command: &Value) -> Outcome<String> {
    let start = Instant::now();
    page.browser.value("tasks.length = 0")?;
    page.ask(&json!({ "watch": true }))?;
    page.ask(command)?;
    page.settled()?;
    let gap = page.state()?["longest_frame"].as_f64().unwrap_or_default();
    page.ask(&json!({ "watch": false }))?;
    let tasks = page.browser.value("tasks.sort((a, b) => b - a).slice(0, 6)")?;
    let seconds = start.elapsed().as_secs_f32();
    println!("    {name}: longest tasks {tasks} ms, {gap:.0} ms between two frames at most, {seconds:.1} s in all");
    match tasks[0].as_f64().unwrap_or_default() {
        longest if longest <= MOST => Ok(format!("{name} {longest} ms")),
        longest => Err(format!("{name} holds the page for {longest} ms, {MOST} may be")),
    }
}
