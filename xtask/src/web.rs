//! `cargo xtask web`: the viewer as a folder for any web server; `cargo xtask test-web`: the same in a browser.

use std::path::Path;

use crate::machine::{self, Need};
use crate::step::{Failure, Step, cargo, root, target};
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
    let line = cargo(["build", "--profile", PROFILE, "--package", "antumbra-viewer", "--bin", PROGRAM])
        .args(["--features", "page"])
        // Every browser that has WebGPU has these.
        .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", "-Ctarget-feature=+simd128");
    Step::new("build", toolchain.building(line)).run()?;
    let program = target().join(toolchain::TARGET).join(PROFILE).join(format!("{PROGRAM}.wasm"));
    let bind = cargo(["run", "--quiet", "--locked", "--manifest-path", "xtask/bind/Cargo.toml", "--"]);
    let bind = bind.args([program.as_os_str(), "antumbra".as_ref(), out.as_os_str()]);
    Step::new("bind", bind.env("CARGO_TARGET_DIR", target().join("web-bind"))).run()?;
    let page = root().join("crates/antumbra-viewer/page/index.html");
    std::fs::copy(&page, out.join("index.html"))
        .map_err(|e| Failure::Machine(format!("cannot copy {} to {}: {e}", page.display(), out.display())))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The version of a package in a lock file.
    fn version_of(lock: &Path, package: &str) -> String {
        let text = std::fs::read_to_string(root().join(lock)).unwrap();
        let (_, after) = text.split_once(&format!("name = \"{package}\"\nversion = \"")).expect("it is locked");
        after.split('"').next().unwrap().to_owned()
    }

    #[test]
    fn the_binder_is_of_the_librarys_version() {
        let library = version_of(Path::new("Cargo.lock"), "wasm-bindgen");
        let binder = version_of(Path::new("xtask/bind/Cargo.lock"), "wasm-bindgen-cli-support");
        assert_eq!(library, binder, "set the version in xtask/bind/Cargo.toml and run `cargo update` there");
    }
}
