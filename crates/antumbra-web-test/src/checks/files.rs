//! Files that come to the page, and files that it gives.

use super::QUERY;
use crate::page::Page;
use crate::{Outcome, PATIENCE, antumbra};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const WEDGE: &str = "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 3 4\n";

/// Drops a file on the image, as the desktop does.
fn drop_file(page: &mut Page, file: &Path) -> Outcome<()> {
    let data = json!({ "items": [], "files": [file], "dragOperationsMask": 1 });
    for kind in ["dragEnter", "dragOver", "drop"] {
        page.browser.call("Input.dispatchDragEvent", json!({ "type": kind, "x": 200, "y": 400, "data": data }))?;
    }
    Ok(())
}

fn written(folder: &Path, name: &str, text: &str) -> Outcome<PathBuf> {
    let file = folder.join(name);
    std::fs::write(&file, text).map_err(|e| format!("{}: {e}", file.display()))?;
    Ok(file)
}

fn temporary() -> Outcome<tempfile::TempDir> {
    tempfile::tempdir().map_err(|e| e.to_string())
}

/// A good file, a broken one and one of no known kind.
pub fn dropped(page: &mut Page) -> Outcome<String> {
    let folder = temporary()?;
    page.open(QUERY)?;
    page.settled()?;
    drop_file(page, &written(folder.path(), "wedge.obj", WEDGE)?)?;
    page.waited_for("the dropped model", |s| s["scene"] == "wedge.obj")?;
    page.settled()?;
    page.shot("dropped")?;
    let mut seen = vec!["wedge.obj is open".to_owned()];
    for (name, text) in [("cut.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n"), ("strange.xyz", "1 2 3")] {
        drop_file(page, &written(folder.path(), name, text)?)?;
        let state = page.waited_for("the message", |s| s["errors"][0].is_string())?;
        let message = state["errors"][0].as_str().unwrap_or_default().to_owned();
        page.shot("dropped-broken")?;
        if !message.contains(name) || state["scene"] != "wedge.obj" {
            return Err(format!("{name}: `{message}`, and {} is open", state["scene"]));
        }
        seen.push(format!("`{message}`"));
        page.ask(&json!("dismiss"))?;
    }
    page.no_errors()?;
    Ok(seen.join(", "))
}

/// The file dialog of the browser.
pub fn chosen(page: &mut Page) -> Outcome<String> {
    let folder = temporary()?;
    page.open(QUERY)?;
    page.settled()?;
    page.browser.call("Page.setInterceptFileChooserDialog", json!({ "enabled": true }))?;
    page.browser.forget();
    page.ask(&json!("choose"))?;
    let asked = page.browser.event("Page.fileChooserOpened", Duration::from_secs(20))?;
    let file = written(folder.path(), "chosen.obj", WEDGE)?;
    let answer = json!({ "files": [file], "backendNodeId": asked["backendNodeId"] });
    page.browser.call("DOM.setFileInputFiles", answer)?;
    page.waited_for("the chosen model", |s| s["scene"] == "chosen.obj")?;
    page.browser.call("Page.setInterceptFileChooserDialog", json!({ "enabled": false }))?;
    page.settled()?;
    page.no_errors()?;
    Ok(format!("a dialog of mode {} came, and chosen.obj is open", asked["mode"]))
}

/// The download of a save command.
fn downloaded(page: &mut Page, folder: &Path, name: &str, command: serde_json::Value) -> Outcome<Vec<u8>> {
    let allowed = json!({ "behavior": "allow", "downloadPath": folder });
    page.browser.call_whole("Browser.setDownloadBehavior", allowed)?;
    page.ask(&command)?;
    let (file, start) = (folder.join(name), Instant::now());
    // A download has another name until it is whole.
    while start.elapsed() < PATIENCE {
        if let Ok(bytes) = std::fs::read(&file)
            && !bytes.is_empty()
        {
            return Ok(bytes);
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    Err(format!("{name} is not among the downloads"))
}

/// A PNG file of the page's size.
pub fn screenshot(page: &mut Page) -> Outcome<String> {
    let folder = temporary()?;
    page.open(QUERY)?;
    page.settled()?;
    let png = downloaded(page, folder.path(), "window.png", json!({ "screenshot": "window.png" }))?;
    let side = |at: usize| png.get(at..at + 4).map_or(0, |b| u32::from_be_bytes([b[0], b[1], b[2], b[3]]));
    let (size, ends) = ([side(16), side(20)], png.ends_with(b"IEND\xaeB`\x82"));
    let canvas =
        page.browser.value("[document.getElementById('viewer').width, document.getElementById('viewer').height]")?;
    match png.starts_with(b"\x89PNG\r\n\x1a\n") && ends && canvas == json!(size) {
        true => Ok(format!("window.png: {} x {} pixels, {} bytes", size[0], size[1], png.len())),
        false => Err(format!("window.png of {} bytes says {size:?}, the canvas is {canvas}", png.len())),
    }
}

/// A scene file that the program draws.
pub fn scene_file(page: &mut Page) -> Outcome<String> {
    let folder = temporary()?;
    page.open(QUERY)?;
    page.settled()?;
    let text = downloaded(page, folder.path(), "saved.toml", json!({ "save_scene": "saved.toml" }))?;
    let [scene, picture] = ["saved.toml", "saved.png"].map(|f| folder.path().join(f).display().to_string());
    antumbra(&["render", &scene, "-t", "hard:map=128", "--size", "40x30", "-o", &picture])?;
    Ok(format!("saved.toml of {} bytes; the program draws it", text.len()))
}
