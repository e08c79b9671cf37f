//! Running one command after another, stopping at the first that fails.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};
use std::{fmt, io};

/// The folder that holds the workspace.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace")
}

/// The folder of what cargo builds.
pub fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |folder| root().join(folder))
}

/// Why a task ended early.
#[derive(Debug)]
pub enum Failure {
    /// The command line makes no sense.
    Usage(String),
    /// A step ended with an error.
    Step { name: String, command: String, code: Option<i32> },
    /// A program could not be started.
    Start { command: String, error: io::Error },
    /// The machine lacks something that we could not bring.
    Machine(String),
}

impl Failure {
    /// 2 for bad input, 1 for a failure.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(if matches!(self, Failure::Usage(_)) { 2 } else { 1 })
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Usage(what) | Failure::Machine(what) => f.write_str(what),
            Failure::Step { name, command, code: Some(code) } => {
                write!(f, "`{name}` failed with exit code {code}; to repeat it alone: {command}")
            }
            Failure::Step { name, command, code: None } => write!(f, "`{name}` was stopped by a signal: {command}"),
            Failure::Start { command, error } => write!(f, "cannot start `{command}`: {error}"),
        }
    }
}

/// A command line under construction, run in the workspace's root unless it says another folder.
#[derive(Debug)]
pub struct Line {
    words: Vec<OsString>,
    folder: Option<PathBuf>,
    environment: Vec<(&'static str, OsString)>,
}

impl Line {
    /// A program and its first arguments.
    pub fn new<S: Into<OsString>>(words: impl IntoIterator<Item = S>) -> Self {
        Self { words: words.into_iter().map(Into::into).collect(), folder: None, environment: Vec::new() }
    }

    /// Appends arguments.
    pub fn args<S: Into<OsString>>(mut self, more: impl IntoIterator<Item = S>) -> Self {
        self.words.extend(more.into_iter().map(Into::into));
        self
    }

    /// Runs it in another folder.
    pub fn folder(mut self, folder: &Path) -> Self {
        self.folder = Some(folder.to_path_buf());
        self
    }

    /// Sets a variable of the program's environment.
    pub fn env(mut self, name: &'static str, value: impl Into<OsString>) -> Self {
        self.environment.push((name, value.into()));
        self
    }
}

impl fmt::Display for Line {
    /// As one would type it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, value) in &self.environment {
            write!(f, "{name}='{}' ", value.to_string_lossy())?;
        }
        let words: Vec<_> = self.words.iter().map(|word| word.to_string_lossy()).collect();
        f.write_str(&words.join(" "))
    }
}

/// A call of cargo.
pub fn cargo<const N: usize>(arguments: [&str; N]) -> Line {
    Line::new(["cargo"]).args(arguments)
}

/// Whether a program starts and ends well; what it prints is dropped.
pub fn available(program: &str, arguments: &[&str]) -> bool {
    let status = Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

/// What a program prints, if it ends well.
pub fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).stderr(Stdio::null()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// A command with a name.
#[derive(Debug)]
pub struct Step {
    name: &'static str,
    line: Line,
}

impl Step {
    /// `name` is what messages call it.
    pub fn new(name: &'static str, line: Line) -> Self {
        Self { name, line }
    }

    /// What messages call it.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Runs to the end with the terminal's streams; gives the wall time.
    pub fn run(self) -> Result<Duration, Failure> {
        let command = self.line.to_string();
        eprintln!("xtask: {command}");
        let start = Instant::now();
        let mut process = Command::new(&self.line.words[0]);
        process.args(&self.line.words[1..]).envs(self.line.environment.iter().map(|(name, value)| (name, value)));
        process.current_dir(self.line.folder.as_deref().unwrap_or(root()));
        let status = process.status().map_err(|error| Failure::Start { command: command.clone(), error })?;
        if status.success() {
            return Ok(start.elapsed());
        }
        Err(Failure::Step { name: self.name.into(), command, code: status.code() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_prints_as_typed() {
        let line = cargo(["doc", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings");
        assert_eq!(line.to_string(), "RUSTDOCFLAGS='-D warnings' cargo doc --no-deps");
    }

    #[test]
    fn a_failing_step_is_named() {
        let failure = Step::new("lint", Line::new(["sh", "-c", "exit 3"])).run().unwrap_err();
        assert!(matches!(&failure, Failure::Step { name, code: Some(3), .. } if name == "lint"), "{failure}");
    }

    #[test]
    fn a_missing_program_is_named() {
        let failure = Step::new("lint", Line::new(["no-such-program"])).run().unwrap_err();
        assert!(failure.to_string().contains("cannot start `no-such-program`"), "{failure}");
    }
}
