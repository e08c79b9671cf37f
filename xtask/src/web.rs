//! `cargo xtask web`: the viewer as a folder for any web server; `cargo xtask test-web`: the same in a browser.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use crate::machine::{self, Need};
use crate::step::{Failure, Line, Step, cargo, output, root, target};
use crate::toolchain;

/// The profile in the workspace's `Cargo.toml`.
const PROFILE: &str = "web";
/// The program that becomes the page.
const PROGRAM: &str = "antumbra-page";

/// Builds the page into `--out FOLDER`.
pub fn run(arguments: &[String]) -> Result<(), Failure> {
    let out = match arguments {
        [] => target().join("page"),
        [option, folder] if option == "--out" => std::path::absolute(folder).unwrap_or_else(|_| folder.into()),
        _ => return Err(Failure::Usage(format!("`{}`: cargo xtask web [--out FOLDER]", arguments.join(" ")))),
    };
    build(&out)?;
    println!("the page is in {}; serve it, for example: python3 -m http.server -d {0}", out.display());
    Ok(())
}

/// Builds the page and drives it in a headless browser.
pub fn test(arguments: &[String]) -> Result<(), Failure> {
    machine::set_up(&[Need::CppCompiler, Need::VulkanDriver, Need::Chromium])?;
    let out = target().join("page");
    build(&out)?;
    let line = cargo(["run", "--package", "antumbra-web-test", "--"]).args([out]).args(arguments);
    Step::new("page", line).run()?;
    Ok(())
}

fn build(out: &Path) -> Result<(), Failure> {
    let toolchain = toolchain::find()?;
    let binder = binder()?;
    let line = cargo(["build", "--profile", PROFILE, "--package", "antumbra-viewer", "--bin", PROGRAM])
        .args(["--features", "page"])
        // Every browser that has WebGPU has these.
        .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", "-Ctarget-feature=+simd128");
    Step::new("build", toolchain.building(line)).run()?;
    let program = target().join(toolchain::TARGET).join(PROFILE).join(format!("{PROGRAM}.wasm"));
    let bind = Line::new([binder]).args(["--target", "web", "--no-typescript", "--out-name", "antumbra", "--out-dir"]);
    Step::new("wasm-bindgen", bind.args([out.as_os_str(), program.as_os_str()])).run()?;
    let page = root().join("crates/antumbra-viewer/page/index.html");
    std::fs::copy(&page, out.join("index.html"))
        .map_err(|e| Failure::Machine(format!("cannot copy {} to {}: {e}", page.display(), out.display())))?;
    Ok(())
}

/// The program `wasm-bindgen` of the very version of the library, installed below the target folder if need be.
fn binder() -> Result<OsString, Failure> {
    let lock = std::fs::read_to_string(root().join("Cargo.lock"))
        .map_err(|e| Failure::Machine(format!("cannot read Cargo.lock: {e}")))?;
    let version = version_of(&lock, "wasm-bindgen")
        .ok_or_else(|| Failure::Machine("wasm-bindgen is not in Cargo.lock".to_owned()))?;
    let tools = target().join("web-tools");
    let own: PathBuf = tools.join("bin").join(format!("wasm-bindgen{}", std::env::consts::EXE_SUFFIX));
    for known in ["wasm-bindgen".into(), own.clone()] {
        let said = output(&known.to_string_lossy(), &["--version"]);
        if said.is_some_and(|said| said.trim() == format!("wasm-bindgen {version}")) {
            return Ok(known.into());
        }
    }
    let install = cargo(["install", "--locked", "wasm-bindgen-cli", "--bin", "wasm-bindgen", "--version", version])
        .args(["--root".into(), tools.into_os_string()]);
    Step::new("wasm-bindgen", install.env("CARGO_TARGET_DIR", target().join("web-tools-build"))).run()?;
    Ok(own.into())
}

/// The version of a package in a lock file.
fn version_of<'a>(lock: &'a str, package: &str) -> Option<&'a str> {
    let (_, after) = lock.split_once(&format!("name = \"{package}\"\nversion = \""))?;
    after.split('"').next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_the_librarys() {
        let lock = "[[package]]\nname = \"wasm-bindgen-futures\"\nversion = \"0.4.1\"\n\n\
                    [[package]]\nname = \"wasm-bindgen\"\nversion = \"0.2.130\"\nsource = \"x\"\n";
        assert_eq!(version_of(lock, "wasm-bindgen"), Some("0.2.130"));
        assert_eq!(version_of(lock, "wgpu"), None);
    }
}
