//! A compiler for web pages: rustup's target, or Debian's packages unpacked into a folder of their own.

use std::path::{Path, PathBuf};

use crate::step::{Failure, Line, Step, available, output, target};

/// What is compiled for.
pub const TARGET: &str = "wasm32-unknown-unknown";

/// Debian's packages to begin with; they bring along the one of their version and of its LLVM. They are never
/// installed: that would take away the other Rust compiler.
const PACKAGES: [&str; 2] = ["rustc-web", "rust-web-src"];

const BY_HAND: &str = "\
`rustup target add wasm32-unknown-unknown` brings it. On Debian 12 and later it is brought by itself, from packages \
that are unpacked below the target folder; that needs apt-get, dpkg and the network";

/// A compiler that is there.
#[derive(Debug)]
pub enum Toolchain {
    /// The usual one, with the standard library of the target.
    Rustup,
    /// Debian's, unpacked into this folder; the standard library is built from its source.
    Unpacked(PathBuf),
}

/// Finds a compiler, or brings one.
pub fn find() -> Result<Toolchain, Failure> {
    let library = output("rustc", &["--print", "target-libdir", "--target", TARGET]);
    if library.is_some_and(|folder| has_library(Path::new(folder.trim()), "libstd-")) {
        return Ok(Toolchain::Rustup);
    }
    let folder = target().join("web-toolchain");
    if !folder.join("whole").exists() {
        unpack(&folder).map_err(|failure| Failure::Machine(format!("{failure}\n       {BY_HAND}")))?;
    }
    Ok(Toolchain::Unpacked(folder.join("root")))
}

impl Toolchain {
    /// The line with what makes cargo build for the target.
    pub fn building(&self, line: Line) -> Line {
        let line = line.args(["--target", TARGET]);
        let Toolchain::Unpacked(root) = self else { return line };
        let llvm = newest(&root.join("usr/lib"), "llvm-").map(|llvm| llvm.join("lib"));
        let folders = [root.join("usr/lib")].into_iter().chain(architecture(root)).chain(llvm);
        let path = std::env::join_paths(folders).unwrap_or_default();
        let linker = newest(&root.join("usr/bin"), "wasm-ld").unwrap_or_default();
        line.args(["-Zbuild-std=std,panic_abort"])
            .env("RUSTC_BOOTSTRAP", "1")
            .env("RUSTC", root.join("usr/bin/rustc"))
            .env("LD_LIBRARY_PATH", path)
            .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker)
    }
}

/// The folder of libraries of this machine's architecture, which has the compiler's.
fn architecture(root: &Path) -> Option<PathBuf> {
    let entries = root.join("usr/lib").read_dir().ok()?;
    entries.flatten().map(|e| e.path()).find(|p| has_library(p, "librustc_driver"))
}

fn has_library(folder: &Path, prefix: &str) -> bool {
    let names = folder.read_dir().into_iter().flatten().flatten().map(|e| e.file_name());
    names.into_iter().any(|name| name.to_string_lossy().starts_with(prefix))
}

/// What is in a folder under a name that begins like this; of several the last.
fn newest(folder: &Path, prefix: &str) -> Option<PathBuf> {
    let paths = folder.read_dir().ok()?.flatten().map(|e| e.path());
    paths.filter(|p| p.file_name().is_some_and(|n| n.to_string_lossy().starts_with(prefix))).max()
}

/// Downloads and unpacks Debian's packages.
fn unpack(folder: &Path) -> Result<(), Failure> {
    if !available("apt-get", &["--version"]) || !available("dpkg", &["--version"]) {
        return Err(Failure::Machine(format!("Rust's standard library for {TARGET} is missing")));
    }
    let packages = needed(&|package| output("apt-cache", &["depends", package]).unwrap_or_default());
    let (debs, root) = (folder.join("debs"), folder.join("root"));
    for new in [&debs, &root] {
        std::fs::create_dir_all(new).map_err(|e| Failure::Machine(format!("cannot make {}: {e}", new.display())))?;
    }
    let download = Line::new(["apt-get", "-q", "download"]).args(packages).folder(&debs);
    Step::new("download", download).run()?;
    let files = debs.read_dir().into_iter().flatten().flatten().map(|e| e.path());
    for file in files.filter(|f| f.extension().is_some_and(|e| e == "deb")) {
        Step::new("unpack", Line::new(["dpkg", "-x"]).args([&file, &root])).run()?;
    }
    std::fs::write(folder.join("whole"), "").map_err(|e| Failure::Machine(format!("{}: {e}", folder.display())))
}

/// All packages: those that ours depend on and that do not come with every system, and the linker of the same LLVM.
fn needed(depends: &dyn Fn(&str) -> String) -> Vec<String> {
    let mut all: Vec<String> = PACKAGES.map(str::to_owned).to_vec();
    let mut at = 0;
    while at < all.len() {
        let text = depends(&all[at]);
        let named = text.lines().filter_map(|line| line.trim().strip_prefix("Depends: "));
        for name in named.filter(|n| n.starts_with("libstd-rust-web") || n.starts_with("libllvm")) {
            if !all.iter().any(|known| known == name) {
                all.push(name.to_owned());
            }
        }
        at += 1;
    }
    let linkers: Vec<String> =
        all.iter().filter_map(|name| Some(format!("lld-{}", name.strip_prefix("libllvm")?))).collect();
    [all, linkers].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_linker_is_of_the_compilers_llvm() {
        let depends = |package: &str| match package {
            "rustc-web" => {
                "rustc-web\n  Depends: libc6\n  Depends: libstd-rust-web-dev\n  Conflicts: rustup\n".to_owned()
            }
            "libstd-rust-web-dev" => "libstd-rust-web-dev\n  Depends: libstd-rust-web-1.96\n".to_owned(),
            "libstd-rust-web-1.96" => "libstd-rust-web-1.96\n  Depends: libgcc-s1\n  Depends: libllvm22\n".to_owned(),
            _ => String::new(),
        };
        let wanted =
            ["rustc-web", "rust-web-src", "libstd-rust-web-dev", "libstd-rust-web-1.96", "libllvm22", "lld-22"];
        assert_eq!(needed(&depends), wanted);
    }
}
