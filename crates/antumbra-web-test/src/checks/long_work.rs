//! How long the page stands still at most.

use super::QUERY;
use crate::Outcome;
use crate::page::Page;
use serde_json::json;
use std::time::Instant;

/// Loading, sorting and tracing a large scene.
pub fn pipes(page: &mut Page) -> Outcome<String> {
    page.open(QUERY)?;
    page.settled()?;
    let mut seen = Vec::new();
    let mut stage = |page: &mut Page, name: &str, command: serde_json::Value| -> Outcome<()> {
        let start = Instant::now();
        page.ask(&json!({ "watch": true }))?;
        page.ask(&command)?;
        page.settled()?;
        let longest = page.state()?["longest_frame"].as_f64().unwrap_or_default();
        page.ask(&json!({ "watch": false }))?;
        let seconds = start.elapsed().as_secs_f32();
        println!("    {name}: {longest:.0} ms between two frames at most, {seconds:.1} s in all");
        seen.push(format!("{name} {longest:.0} ms"));
        Ok(())
    };
    page.ask(&json!({ "resolution": 0.05 }))?;
    stage(page, "opening", json!({ "open": "builtin:pipes" }))?;
    for spec in ["pcss:map=256", "backprojection:map=256"] {
        stage(page, spec, json!({ "technique": { "half": 0, "spec": spec } }))?;
    }
    stage(page, "tracing", json!({ "compare": "truth" }))?;
    page.shot("pipes")?;
    Ok(seen.join(", "))
}
