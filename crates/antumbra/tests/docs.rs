//! A page for each technique, with a table of settings that is made from the code. `cargo xtask docs` writes the
//! tables.

use antumbra::TechniqueInfo;
use antumbra::technique::settings::Kind;
use antumbra::techniques::TECHNIQUES;
use std::fmt::Write;
use std::path::{Path, PathBuf};

const START: &str = "<!-- settings: made by `cargo xtask docs` -->";
const END: &str = "<!-- end of settings -->";

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/techniques")
}

fn range(kind: Kind) -> String {
    match kind {
        Kind::Integer { min, max } => format!("{min} to {max}"),
        Kind::Number { min, max } => format!("{min} to {max}"),
        Kind::Toggle => "true, false".to_owned(),
        Kind::Choice { options } => options.join(", "),
        Kind::Points { max } => format!("up to {max} points `x y;x y;…`"),
    }
}

/// The table of a technique's settings in Markdown.
fn table(info: &TechniqueInfo) -> String {
    let defaults = (info.defaults)(&serde_json::Map::new());
    let mut text = String::from("| setting | default | values | meaning |\n|---|---|---|---|\n");
    for s in info.settings {
        let default = match &defaults[s.key] {
            serde_json::Value::String(word) => word.clone(),
            serde_json::Value::Array(list) if list.is_empty() => "none".to_owned(),
            // Settings are declared in single precision.
            serde_json::Value::Number(n) if n.is_f64() => format!("{}", n.as_f64().expect("a float") as f32),
            other => other.to_string(),
        };
        let help = s.help.replace('|', "\\|");
        writeln!(text, "| `{}` | {default} | {} | {help} |", s.key, range(s.kind)).expect("a string grows");
    }
    text
}

/// A page with its table replaced.
fn updated(page: &str, table: &str) -> Option<String> {
    let (before, rest) = page.split_once(START)?;
    let (_, after) = rest.split_once(END)?;
    Some(format!("{before}{START}\n\n{table}\n{END}{after}"))
}

#[test]
fn every_technique_has_a_page_whose_settings_are_those_of_the_code() {
    let update = std::env::var_os("UPDATE_DOCS").is_some();
    let mut wrong = Vec::new();
    for info in TECHNIQUES {
        let file = folder().join(format!("{}.md", info.name));
        let Ok(page) = std::fs::read_to_string(&file) else {
            wrong.push(format!("docs/techniques/{}.md is missing; the headings are those of hard.md", info.name));
            continue;
        };
        match updated(&page, &table(info)) {
            None => wrong.push(format!("docs/techniques/{}.md has no lines `{START}` and `{END}`", info.name)),
            Some(new) if new == page => {}
            Some(new) if update => std::fs::write(&file, new).expect("the docs are writable"),
            Some(_) => wrong.push(format!("docs/techniques/{}.md: the table of settings is out of date", info.name)),
        }
    }
    assert!(wrong.is_empty(), "{}\n`cargo xtask docs` writes the tables", wrong.join("\n"));
}

#[test]
fn the_list_of_pages_names_every_technique() {
    let list = std::fs::read_to_string(folder().join("README.md")).expect("docs/techniques/README.md");
    for info in TECHNIQUES {
        assert!(
            list.contains(&format!("]({}.md)", info.name)),
            "docs/techniques/README.md has no link to {}.md",
            info.name
        );
    }
}
