//! A device that gives no more than every WebGPU device does.

use super::QUERY;
use crate::Outcome;
use crate::page::Page;
use serde_json::json;

/// Limits of adapter and device are the standard's minimum.
const LEAST: &str = "for (const [name, least] of [['maxStorageBuffersPerShaderStage', 8],
    ['maxComputeWorkgroupStorageSize', 16384]])
    Object.defineProperty(GPUSupportedLimits.prototype, name, { get: () => least });";

/// Techniques that need more are listed before they are chosen; others are not, and are drawn.
pub fn refused(page: &mut Page) -> Outcome<String> {
    let script = page.browser.call("Page.addScriptToEvaluateOnNewDocument", json!({ "source": LEAST }))?;
    let state = page.open(QUERY).and_then(|()| page.settled());
    let identifier = json!({ "identifier": script["identifier"] });
    page.browser.call("Page.removeScriptToEvaluateOnNewDocument", identifier)?;
    let refused = state?["refused"].clone();
    let names: Vec<&str> = refused.as_array().into_iter().flatten().filter_map(|r| r[0].as_str()).collect();
    let whys: Vec<&str> = refused.as_array().into_iter().flatten().filter_map(|r| r[1].as_str()).collect();
    let seen = whys.join("; ");
    if names.is_empty() || whys.iter().any(|w| !w.contains("this adapter gives")) {
        return Err(format!("with the least that WebGPU gives, these are refused: {refused}"));
    }
    menu(page)?;
    // What it says is so: the shader itself is refused too.
    for name in &names {
        page.ask(&json!({ "technique": { "half": 0, "spec": name } }))?;
        let state = page.waited_for("the technique's own error", |s| s["failed"][0].is_string())?;
        let error = state["failed"][0].as_str().unwrap_or_default();
        if !error.contains("this adapter gives") {
            return Err(format!("{name} is refused beforehand, but says `{error}` itself"));
        }
    }
    page.ask(&json!({ "technique": { "half": 0, "spec": "pcss:map=256" } }))?;
    let drawn = page.settled()?["drawn"][0].clone();
    if drawn == "pcss:map=256" { Ok(seen) } else { Err(format!("{drawn} is drawn")) }
}

/// A screenshot of the list with the pointer on the first refused technique.
fn menu(page: &mut Page) -> Outcome<()> {
    let mouse = |page: &mut Page, kind: &str, at: [f64; 2]| {
        let button = if kind == "mouseMoved" { "none" } else { "left" };
        let event = json!({ "type": kind, "x": at[0], "y": at[1], "button": button, "clickCount": 1 });
        page.browser.call("Input.dispatchMouseEvent", event).map(|_| ())
    };
    for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
        mouse(page, kind, [40.0, 74.0])?;
        std::thread::sleep(std::time::Duration::from_millis(200));
    }
    mouse(page, "mouseMoved", [120.0, 392.0])?;
    std::thread::sleep(std::time::Duration::from_millis(1500));
    page.shot("refused")?;
    let escape = json!({ "key": "Escape", "code": "Escape", "windowsVirtualKeyCode": 27 });
    for kind in ["keyDown", "keyUp"] {
        let mut event = escape.clone();
        event["type"] = kind.into();
        page.browser.call("Input.dispatchKeyEvent", event)?;
    }
    Ok(())
}
