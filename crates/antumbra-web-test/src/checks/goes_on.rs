//! External events of an open page.

use super::QUERY;
use crate::Outcome;
use crate::page::Page;
use serde_json::json;
use std::time::Duration;

/// The device is destroyed; everything is there again on another.
pub fn after_a_loss(page: &mut Page) -> Outcome<String> {
    page.open(QUERY)?;
    page.ask(&json!({ "technique": { "half": 0, "spec": "vsm:map=64" } }))?;
    let before = page.settled()?;
    // The answer may be lost with the device.
    page.browser.value("antumbra.ask('lose_device'), 0")?;
    page.waited_for("the device that is lost", |s| s["lost"] == 1)?;
    let after = page.settled()?;
    page.shot("after-loss")?;
    let seen =
        format!("{} of {} before, {} of {} after it", before["drawn"], before["scene"], after["drawn"], after["scene"]);
    let is_same = ["drawn", "scene", "image", "light", "camera"].iter().all(|key| before[key] == after[key]);
    // Chromium warns on the console of pending work.
    if is_same && after["frames"].as_u64() > Some(0) { Ok(seen) } else { Err(seen) }
}

/// Nothing is drawn on nothing, and all of it afterwards.
pub fn resized_to_nothing(page: &mut Page) -> Outcome<String> {
    page.open(QUERY)?;
    let before = page.settled()?;
    let style = "document.getElementById('viewer').style";
    for size in ["0", "1px"] {
        page.browser.value(&format!("{style}.width = {style}.height = '{size}', 0"))?;
        std::thread::sleep(Duration::from_millis(600));
        page.state()?;
    }
    page.browser.value(&format!("{style}.width = {style}.height = '', 0"))?;
    let size = before["image"].clone();
    page.waited_for("an image of its first size", |s| s["image"] == size)?;
    // Changes are drawn again.
    page.ask(&json!({ "show": "visibility" }))?;
    std::thread::sleep(Duration::from_millis(300));
    let after = page.settled()?;
    page.shot("resized")?;
    page.no_errors()?;
    let frames = [&before, &after].map(|s| s["frames"].as_u64().unwrap_or_default());
    let seen = format!("{size} before and {} after it, {} frames more", after["image"], frames[1] - frames[0]);
    if after["image"] == size && frames[1] > frames[0] { Ok(seen) } else { Err(seen) }
}

/// A screen with two pixels for one, and back. The screen reports the canvas's size in pixels, which an emulated one
/// does not: it has as many as before.
pub fn another_scale(page: &mut Page) -> Outcome<String> {
    page.open(QUERY)?;
    let before = page.settled()?;
    let sides = page.browser.value("[innerWidth, innerHeight]")?;
    let metrics = json!({ "width": sides[0], "height": sides[1], "deviceScaleFactor": 2, "mobile": false });
    page.browser.call("Emulation.setDeviceMetricsOverride", metrics)?;
    let seen = page.waited_for("an image of another size", |s| s["image"] != before["image"]);
    page.shot("scale-2")?;
    page.browser.call("Emulation.clearDeviceMetricsOverride", json!({}))?;
    let seen = seen?;
    page.waited_for("an image of its first size", |s| s["image"] == before["image"])?;
    page.settled()?;
    page.no_errors()?;
    Ok(format!("{} pixels, {} at scale 2, and back", before["image"], seen["image"]))
}
