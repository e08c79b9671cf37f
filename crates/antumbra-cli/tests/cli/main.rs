//! The program from the outside: what it writes, what it says, how it ends.

mod bad_input;
mod bench;
mod compare;
mod files;
mod lists;
mod meshes;
mod outputs;
mod stopping;
mod study;

use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// A folder of its own for each test: scenes, outputs and the reference cache.
struct Place(TempDir);

/// How a run ended.
#[derive(Debug)]
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Place {
    fn new() -> Place {
        Place(tempfile::tempdir().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file and returns its name.
    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        std::fs::write(self.path(name), content).expect("a file in a temporary folder");
        name.to_owned()
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.bytes(name)).expect("JSON")
    }

    /// All files and folders but the cache's, sorted.
    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("a folder");
        let mut names: Vec<String> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.retain(|n| n != "cache");
        names.sort();
        names
    }

    /// The program in this folder; arguments are separated by spaces.
    fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_antumbra"));
        command.args(arguments.split_whitespace()).current_dir(self.0.path());
        command.env("ANTUMBRA_CACHE", self.path("cache"));
        // Without it the windowing libraries that an OpenGL driver brings complain on stderr.
        command.env("XDG_RUNTIME_DIR", self.0.path());
        command
    }

    fn run(&self, arguments: &str) -> Run {
        finish(self.command(arguments))
    }

    /// Runs and insists on success.
    fn succeeds(&self, arguments: &str) -> Run {
        let run = self.run(arguments);
        assert_eq!(run.code, Some(0), "antumbra {arguments}: {}", run.stderr);
        run
    }

    /// Runs and insists on one readable message with these words in it, this exit code, and no new file.
    fn refuses(&self, arguments: &str, code: i32, words: &[&str]) {
        let before = self.names();
        check_refusal(arguments, &self.run(arguments), code, words);
        assert_eq!(self.names(), before, "antumbra {arguments} must leave nothing");
    }
}

fn finish(mut command: Command) -> Run {
    let output = command.output().expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    Run { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

fn check_refusal(arguments: &str, run: &Run, code: i32, words: &[&str]) {
    let said = run.stderr.to_lowercase();
    assert_eq!(run.code, Some(code), "antumbra {arguments}: {run:?}");
    assert!(run.stderr.starts_with("error: "), "antumbra {arguments}: {run:?}");
    assert_eq!(said.matches("error: ").count(), 1, "antumbra {arguments}: {run:?}");
    assert!(!said.contains("panic") && !said.contains("bug in antumbra"), "antumbra {arguments}: {run:?}");
    for word in words {
        assert!(said.contains(&word.to_lowercase()), "antumbra {arguments}: `{word}` in {run:?}");
    }
}

fn is_png(path: &Path) -> bool {
    std::fs::read(path).is_ok_and(|bytes| bytes.starts_with(b"\x89PNG\r\n\x1a\n"))
}
