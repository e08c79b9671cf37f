//! `techniques`, `scenes` and `adapters`.

use crate::Place;

fn list(command: &str) -> Vec<serde_json::Value> {
    let run = Place::new().succeeds(&format!("{command} --json"));
    serde_json::from_str(&run.stdout).expect("a JSON list")
}

#[test]
fn techniques_tell_their_settings() {
    let techniques = list("techniques");
    let hard = techniques.iter().find(|t| t["name"] == "hard").expect("hard");
    let map = &hard["settings"].as_array().expect("settings")[0];
    assert_eq!((&map["key"], &map["default"]), (&"map".into(), &2048.into()));
    let text = Place::new().succeeds("techniques").stdout;
    assert!(techniques.iter().all(|t| text.contains(t["name"].as_str().expect("a name"))));
}

#[test]
fn scenes_tell_their_parameters() {
    let scenes = list("scenes");
    let forest = scenes.iter().find(|s| s["name"] == "forest").expect("forest");
    assert!(forest["parameters"].as_array().expect("parameters").iter().any(|p| p["name"] == "trees"));
    let text = Place::new().succeeds("scenes").stdout;
    assert!(text.contains("builtin:fence"));
}

#[test]
fn adapters_have_names() {
    let adapters = list("adapters");
    let name = adapters[0]["name"].as_str().expect("a name");
    assert!(Place::new().succeeds("adapters").stdout.contains(name));
}

#[test]
fn help_and_version_are_there() {
    let place = Place::new();
    assert!(place.succeeds("--version").stdout.starts_with("antumbra "));
    for command in ["render", "reference", "compare", "bench", "techniques", "scenes", "adapters"] {
        assert!(place.succeeds("--help").stdout.contains(command));
        assert!(place.succeeds(&format!("{command} --help")).stdout.contains("Usage: antumbra"));
    }
    assert!(place.succeeds("reference --help").stdout.contains("ANTUMBRA_CACHE"));
}
