//! `cargo xtask same-bits COMMIT [SCENE …]`: the visibility of every technique at its defaults, now and at an earlier
//! commit, bit for bit.

use std::fs;
use std::path::{Path, PathBuf};

use crate::step::{Failure, Line, Step, cargo, output, root, target};

/// Scenes that are compared besides those of the command line.
const SCENES: [&str; 4] = ["builtin:fence", "builtin:layers", "builtin:plant", "builtin:bumpy"];
const SIZE: &str = "192x128";

/// Builds the program of both commits, draws everything twice and compares the files.
pub fn run(arguments: &[String]) -> Result<(), Failure> {
    let Some((commit, scenes)) = arguments.split_first() else {
        return Err(Failure::Usage("same-bits needs a commit to compare with".into()));
    };
    let folder = target().join("same-bits");
    fs::create_dir_all(&folder).map_err(|e| Failure::Machine(format!("{}: {e}", folder.display())))?;
    let before = program(commit, &folder)?;
    Step::new("build", cargo(["build", "--bin", "antumbra"])).run()?;
    let now = target().join("debug").join("antumbra");
    let mut different = Vec::new();
    let mut count = 0;
    for scene in SCENES.iter().copied().chain(scenes.iter().map(String::as_str)) {
        for technique in techniques(&before)? {
            let files = ["before.npy", "now.npy"].map(|name| folder.join(name));
            for (program, file) in [&before, &now].into_iter().zip(&files) {
                render(program, scene, &technique, file)?;
            }
            count += 1;
            let [before, now] = files.map(|file| fs::read(file).unwrap_or_default());
            if before.is_empty() || before != now {
                eprintln!("xtask: {technique} on {scene} differs");
                different.push(format!("{technique} on {scene}"));
            }
        }
    }
    if different.is_empty() {
        println!("all {count} visibilities are the same, bit for bit");
        return Ok(());
    }
    Err(Failure::Machine(format!("{} of {count} visibilities differ: {}", different.len(), different.join(", "))))
}

/// The program as it was at a commit, built once and kept.
fn program(commit: &str, folder: &Path) -> Result<PathBuf, Failure> {
    let unknown = || Failure::Usage(format!("`{commit}` names no commit"));
    let hash = output("git", &["-C", &root().to_string_lossy(), "rev-parse", commit]).ok_or_else(unknown)?;
    let kept = folder.join(format!("antumbra-{}", hash.trim()));
    if kept.exists() {
        return Ok(kept);
    }
    let sources = folder.join("sources");
    let git = |words: &[&str]| Line::new(["git"]).args(words.iter().copied());
    let place = sources.to_string_lossy().into_owned();
    if sources.exists() {
        Step::new("checkout", git(&["-C", &place, "checkout", "--detach", hash.trim()])).run()?;
    } else {
        Step::new("worktree", git(&["worktree", "add", "--force", "--detach", &place, hash.trim()])).run()?;
    }
    let build =
        cargo(["build", "--bin", "antumbra"]).folder(&sources).env("CARGO_TARGET_DIR", target().into_os_string());
    Step::new("build of the earlier commit", build).run()?;
    let built = target().join("debug").join("antumbra");
    fs::copy(&built, &kept).map_err(|e| Failure::Machine(format!("{}: {e}", built.display())))?;
    Ok(kept)
}

/// The names that `antumbra techniques` lists: the first words of the lines that start one.
fn techniques(program: &Path) -> Result<Vec<String>, Failure> {
    let list = output(&program.to_string_lossy(), &["techniques"]);
    let list = list.ok_or_else(|| Failure::Machine(format!("{} lists no techniques", program.display())))?;
    Ok(names(&list))
}

pub fn names(list: &str) -> Vec<String> {
    let starts = list.lines().filter(|line| !line.starts_with(' '));
    starts.filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect()
}

fn render(program: &Path, scene: &str, technique: &str, file: &Path) -> Result<(), Failure> {
    let line = Line::new([program]).args(["render", scene, "-t", technique, "--size", SIZE, "--frames", "1"]);
    Step::new("render", line.args(["--visibility".as_ref(), file.as_os_str()]).env("NODEVICE_SELECT", "1")).run()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_the_first_words_of_unindented_lines() {
        let list = "hard               Shadow map\n                   one\n                     map=2048  Shadow map\npcf  P\n";
        assert_eq!(names(list), ["hard", "pcf"]);
    }
}
