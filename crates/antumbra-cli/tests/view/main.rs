//! The real window under a virtual display, driven by commands on its standard input and by the mouse.
//!
//! Screenshots stay in the target's temporary folder; the message of a failure names them.
#![cfg(all(feature = "viewer", target_os = "linux"))]

mod display;
mod window;

use antumbra::techniques::TECHNIQUES;
use display::Display;
use serde_json::json;
use window::Window;

/// The SPEC of a technique with small and few maps, if it has them.
fn quick(name: &str) -> String {
    let info = TECHNIQUES.iter().find(|t| t.name == name).expect("of the list");
    let small = [("map", 128), ("samples", 4), ("maps", 9)];
    let its = small.iter().filter(|(key, _)| info.settings.iter().any(|s| s.key == *key));
    let values: Vec<String> = its.map(|(key, value)| format!("{key}={value}")).collect();
    format!("{name}:{}", values.join(","))
}

#[test]
fn a_session_at_the_window() {
    let display = Display::start();
    let mut window = Window::open(&display, &["builtin:square", "-t", &quick("hard"), "-t", &quick("pcf")]);
    window.ask(json!({"resolution": 0.2}));
    window.settled();

    // Each technique, on the left half, draws something of its own kind without an error.
    for technique in TECHNIQUES {
        let spec = quick(technique.name);
        window.ask(json!({"technique": {"half": 0, "spec": spec}}));
        let state = window.settled();
        let drawn = state["drawn"][0].as_str().unwrap_or_default().to_owned();
        assert!(drawn.starts_with(technique.name), "{spec}: {state}");
        // The viewer can show each of its debug views.
        window.ask(json!({"debug_views": 0}));
        let views = window.settled()["debug_views"][0].take();
        for name in views.as_array().expect("a list") {
            window.ask(json!({"debug_view": [name, 0]}));
            window.settled();
        }
        window.ask(json!({"debug_views": null}));
    }
    window.shot("techniques");

    // Hard shadows have hard edges, and a setting changes what is seen: a map of 16 texels is blocky.
    window.ask(json!({"compare": "one"}));
    window.ask(json!({"show": "visibility"}));
    window.ask(json!({"technique": {"half": 0, "spec": "hard:map=1024"}}));
    window.settled();
    let fine = window.shot("map-1024");
    window.ask(json!({"technique": {"half": 0, "spec": "hard:map=16"}}));
    window.settled();
    let coarse = window.shot("map-16");
    let changed = fine.difference(&coarse);
    assert!(changed > 0.0005, "a map of 16 texels looks like one of 1024: {changed}");

    // The wheel zooms out until the light is in the image. The mouse drags the light, and light and shadow follow.
    window.ask(json!({"technique": {"half": 0, "spec": "hard:map=256"}}));
    window.scroll_away([300.0, 300.0]);
    let before = window.settled();
    let at_first = window.shot("light-before");
    let from = window.handle(&before, "Move");
    assert!(from[1] > 60.0, "the light is outside of the image: {before}");
    window.drag(from, [from[0] + 60.0, from[1] + 5.0]);
    let after = window.settled();
    let later = window.shot("light-after");
    let now = window.handle(&after, "Move");
    assert!((now[0] - from[0] - 60.0).abs() < 4.0 && (now[1] - from[1] - 5.0).abs() < 4.0, "{from:?} to {now:?}");
    assert_eq!(before["light"][1], after["light"][1], "moving does not resize");
    assert!(at_first.difference(&later) > 0.0005, "the image is the same after the light has moved");

    // A drag at the lower border of the image, where no handle is, orbits the camera.
    window.drag([100.0, 420.0], [180.0, 420.0]);
    window.settled();
    assert!(later.difference(&window.shot("orbited")) > 0.001, "dragging moves nothing");
    window.quit();
}

#[test]
fn errors_are_measured_against_the_truth() {
    let display = Display::start();
    let mut window = Window::open(&display, &["builtin:square", "-t", &quick("backprojection")]);
    window.ask(json!({"resolution": 0.1}));
    window.ask(json!({"show": "error"}));
    let state = window.settled();
    assert_eq!(state["truth"], 1.0, "{state}");
    let close = state["average_error"][0].as_f64().unwrap_or_else(|| panic!("{state}"));
    window.shot("error-backprojection");
    window.ask(json!({"technique": {"half": 0, "spec": quick("hard")}}));
    let state = window.settled();
    let far = state["average_error"][0].as_f64().unwrap_or_else(|| panic!("{state}"));
    window.shot("error-hard");
    assert!(close < 0.06 && far > 3.0 * close, "back-projection {close}, a plain shadow map {far}");
    window.quit();
}

#[test]
fn files_good_and_bad() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("a file in a temporary folder");
        path.display().to_string()
    };
    let display = Display::start();
    let mut window = Window::open(&display, &["builtin:square", "-t", &quick("hard"), "-t", &quick("pcf")]);
    window.ask(json!({"resolution": 0.1}));
    window.settled();

    let model = file("wedge.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 3 4\n");
    window.ask(json!({"drop": model}));
    let state = window.waited_for(|s| s["scene"] == json!(model));
    assert_eq!(state["errors"], json!([]), "{state}");
    window.shot("dropped");

    for (name, text, named) in [
        ("cut.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n", "cut.obj"),
        ("words.ply", "this is no ply", "words.ply"),
        ("strange.xyz", "1 2 3", "strange.xyz"),
        ("scene.toml", "[[meshes]]\npath = 'missing.obj'\n", "missing.obj"),
    ] {
        let bad = file(name, text);
        window.ask(json!({"drop": bad}));
        let state = window.waited_for(|s| s["errors"][0].is_string());
        let message = state["errors"][0].as_str().unwrap_or_default();
        assert!(message.contains(named), "{name}: {message}");
        assert_eq!(state["scene"], json!(model), "a bad file leaves the open scene");
        window.shot("message");
        window.ask(json!("dismiss"));
    }

    // Where the desktop has no file dialog, the message names another way to open a file.
    window.ask(json!("choose"));
    let state = window.waited_for(|s| s["errors"][0].is_string());
    let message = state["errors"][0].as_str().unwrap_or_default();
    assert!(message.contains("no file dialog") && message.contains("drop the file"), "{message}");
    window.shot("no-dialog");
    window.ask(json!("dismiss"));

    // A saved scene can be opened.
    let saved = folder.path().join("saved.toml").display().to_string();
    window.ask(json!({"save_scene": saved}));
    window.ask(json!({"open": saved}));
    let state = window.waited_for(|s| s["scene"] == json!(saved));
    assert_eq!(state["errors"], json!([]), "{state}");
    window.quit();
}

#[test]
fn the_window_survives_resizing_and_a_lost_device() {
    let display = Display::start();
    let mut window = Window::open(&display, &["builtin:square", "-t", &quick("hard"), "-t", &quick("pcf")]);
    window.ask(json!({"resolution": 0.1}));
    window.ask(json!({"technique": {"half": 1, "spec": "vsm:map=64"}}));
    let before = window.settled();

    // The smallest size, a minimised window, another scale factor.
    window.resize([1, 1]);
    window.settled();
    window.resize([900, 600]);
    window.minimise();
    window.settled();
    window.ask(json!({"zoom": 1.6}));
    let state = window.settled();
    assert_eq!(state["drawn"], before["drawn"]);
    window.shot("zoomed");
    window.ask(json!({"zoom": 1.0}));

    // Occluders turn, and stop.
    let frames = window.settled()["frames"].as_u64();
    window.ask(json!({"turn": true}));
    window.waited_for(|s| s["frames"].as_u64() > frames.map(|f| f + 5));
    window.ask(json!({"turn": false}));
    window.settled();

    // A lost device is replaced; techniques and scene stay.
    window.ask(json!("lose_device"));
    let state = window.waited_for(|s| s["lost"] == 1 && s["drawn"][1].is_string());
    assert_eq!((&state["drawn"], &state["scene"]), (&before["drawn"], &before["scene"]));
    window.shot("after-loss");
    window.quit();
}
