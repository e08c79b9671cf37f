//! `cargo xtask fuzz`: random bytes against the importers.

use std::path::Path;

use crate::step::{Failure, Step, available, cargo, root};

/// How long a target is fuzzed where the caller does not say, seconds.
const DEFAULT_SECONDS: u32 = 60;

/// Fuzzes `[TARGET] [SECONDS]`, or every target in turn.
pub fn run(arguments: &[String]) -> Result<(), Failure> {
    let (chosen, seconds) = plan(arguments, &targets(&root().join("fuzz"))?)?;
    if !available("cargo", &["fuzz", "--version"]) {
        return Err(Failure::Machine("cargo-fuzz is missing: cargo install --locked cargo-fuzz".into()));
    }
    for target in chosen {
        // No sanitizer: all our code is safe Rust, and so a stable toolchain does.
        let line = cargo(["fuzz", "run", "--sanitizer", "none"]).args([&target]).args(["--"]);
        Step::new("fuzz", line.args([format!("-max_total_time={seconds}")])).run()?;
    }
    Ok(())
}

/// The targets' names, sorted.
fn targets(folder: &Path) -> Result<Vec<String>, Failure> {
    let sources = folder.join("fuzz_targets");
    let entries = sources
        .read_dir()
        .map_err(|error| Failure::Machine(format!("there is nothing to fuzz in {}: {error}", sources.display())))?;
    let paths = entries.flatten().map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "rs"));
    let mut names: Vec<_> = paths.filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned())).collect();
    names.sort();
    Ok(names)
}

/// Which targets, and how many seconds each.
fn plan(arguments: &[String], targets: &[String]) -> Result<(Vec<String>, u32), Failure> {
    let wrong = |what: String| {
        Failure::Usage(format!("{what}\ncargo xtask fuzz [TARGET] [SECONDS], TARGET being {}", targets.join(", ")))
    };
    let seconds = |text: &str| match text.parse() {
        Ok(0) | Err(_) => Err(wrong(format!("`{text}` is no number of seconds"))),
        Ok(seconds) => Ok(seconds),
    };
    let one = |name: &String| match targets.contains(name) {
        true => Ok(vec![name.clone()]),
        false => Err(wrong(format!("`{name}` is no fuzz target"))),
    };
    match arguments {
        [] => Ok((targets.to_vec(), DEFAULT_SECONDS)),
        [text] if text.starts_with(|c: char| c.is_ascii_digit()) => Ok((targets.to_vec(), seconds(text)?)),
        [name] => Ok((one(name)?, DEFAULT_SECONDS)),
        [name, text] => Ok((one(name)?, seconds(text)?)),
        _ => Err(wrong("too many arguments".into())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planned(arguments: &[&str]) -> Result<(Vec<String>, u32), Failure> {
        let arguments: Vec<String> = arguments.iter().map(|a| a.to_string()).collect();
        plan(&arguments, &["gltf".into(), "obj".into()])
    }

    #[test]
    fn target_and_seconds_are_both_optional() {
        assert_eq!(planned(&[]).unwrap(), (vec!["gltf".into(), "obj".into()], DEFAULT_SECONDS));
        assert_eq!(planned(&["5"]).unwrap().1, 5);
        assert_eq!(planned(&["obj"]).unwrap(), (vec!["obj".into()], DEFAULT_SECONDS));
        assert_eq!(planned(&["obj", "7"]).unwrap(), (vec!["obj".into()], 7));
    }

    #[test]
    fn nonsense_is_refused_with_the_targets() {
        for arguments in [&["ply"][..], &["obj", "soon"], &["0"], &["obj", "1", "2"]] {
            let failure = planned(arguments).unwrap_err();
            assert!(failure.to_string().contains("gltf, obj"), "{failure}");
        }
    }
}
