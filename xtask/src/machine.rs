//! What the machine must have, and bringing what it lacks.

use std::env;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::step::{Failure, Line, Step, available};

/// Something outside of the workspace that a task needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// For FLIP, which is built from C++.
    CppCompiler,
    /// A Vulkan loader with a driver that can work here: of a GPU, or the software one.
    VulkanDriver,
    /// Vulkan's validation layer.
    ValidationLayer,
    /// A display without a screen, and a hand for its mouse, for the tests of the window.
    VirtualDisplay,
    /// A browser with WebGPU, for the test of the page.
    Chromium,
    /// `cargo fmt`.
    Rustfmt,
    /// `cargo clippy`.
    Clippy,
}

impl Need {
    fn is_met(self) -> bool {
        match self {
            Need::CppCompiler if cfg!(windows) => true, // comes with the linker that Rust itself needs
            Need::CppCompiler => {
                env::var_os("CXX").is_some() || ["c++", "g++", "clang++"].iter().any(|c| available(c, &["--version"]))
            }
            Need::VulkanDriver => !cfg!(target_os = "linux") || (has_vulkan_loader() && has_vulkan_driver()),
            Need::ValidationLayer => has_validation_layer(),
            Need::VirtualDisplay => {
                !cfg!(target_os = "linux") || (is_on_path("Xvfb") && available("xdotool", &["--version"]))
            }
            Need::Chromium => is_on_path("chromium") || env::var_os("CHROMIUM").is_some(),
            Need::Rustfmt => available("cargo", &["fmt", "--version"]),
            Need::Clippy => available("cargo", &["clippy", "--version"]),
        }
    }

    fn title(self) -> &'static str {
        match self {
            Need::CppCompiler => "a C++ compiler",
            Need::VulkanDriver => "a Vulkan driver",
            Need::ValidationLayer => "Vulkan's validation layer",
            Need::VirtualDisplay => "a virtual display",
            Need::Chromium => "Chromium",
            Need::Rustfmt => "rustfmt",
            Need::Clippy => "clippy",
        }
    }

    /// Debian's packages that meet it.
    fn packages(self) -> &'static [&'static str] {
        match self {
            Need::CppCompiler => &["g++"],
            Need::VulkanDriver => &["mesa-vulkan-drivers", "libvulkan1"],
            Need::ValidationLayer => &["vulkan-validationlayers"],
            Need::VirtualDisplay => {
                &["xvfb", "xdotool", "libx11-xcb1", "libxkbcommon-x11-0", "libxcursor1", "libxi6", "libxrandr2"]
            }
            Need::Chromium => &["chromium"],
            Need::Rustfmt | Need::Clippy => &[],
        }
    }

    /// The component of rustup that meets it.
    fn component(self) -> Option<&'static str> {
        match self {
            Need::Rustfmt => Some("rustfmt"),
            Need::Clippy => Some("clippy"),
            _ => None,
        }
    }
}

/// Brings what is missing by apt and rustup, or says what to install.
pub fn set_up(needs: &[Need]) -> Result<(), Failure> {
    let missing: Vec<Need> = needs.iter().copied().filter(|need| !need.is_met()).collect();
    let packages: Vec<&str> = missing.iter().flat_map(|need| need.packages()).copied().collect();
    let components: Vec<&str> = missing.iter().filter_map(|need| need.component()).collect();
    if !packages.is_empty() {
        let titles: Vec<&str> =
            missing.iter().filter(|need| !need.packages().is_empty()).map(|need| need.title()).collect();
        eprintln!("xtask: this machine lacks {}", titles.join(" and "));
        apt_install(&packages)?;
    }
    if !components.is_empty() {
        let line = Line::new(["rustup", "component", "add"]).args(components.iter().copied());
        let by_hand = format!("`{line}`, or your system's packages, bring what is missing");
        Step::new("rustup", line).run().map_err(|_| Failure::Machine(by_hand))?;
    }
    match missing.iter().find(|need| !need.is_met()) {
        Some(need) => Err(Failure::Machine(format!("the machine still lacks {} after the set-up", need.title()))),
        None => Ok(()),
    }
}

fn apt_install(packages: &[&str]) -> Result<(), Failure> {
    let by_hand = format!(
        "install Debian's and Ubuntu's packages `{}` (elsewhere: what your system calls them), then try again",
        packages.join(" ")
    );
    let is_root = Command::new("id").arg("-u").output().is_ok_and(|id| id.stdout.trim_ascii() == b"0");
    let prefix: &[&str] = match () {
        _ if !available("apt-get", &["--version"]) => return Err(Failure::Machine(by_hand)),
        _ if is_root => &[],
        _ if available("sudo", &["--version"]) => &["sudo"],
        _ => return Err(Failure::Machine(by_hand)),
    };
    let apt = |arguments: &[&str]| {
        // As arguments of `env`, because sudo drops the caller's environment.
        let words = prefix.iter().chain(&["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-q"]).chain(arguments);
        Step::new("apt-get", Line::new(words.copied())).run()
    };
    // Package lists of a fresh machine are empty or old.
    apt(&["update"])
        .and_then(|_| apt(&[&["install", "-y", "--no-install-recommends"], packages].concat()))
        .map_err(|failure| Failure::Machine(format!("{failure}\n       {by_hand}")))?;
    Ok(())
}

/// Whether a program that has no harmless call lies where the system looks for programs.
fn is_on_path(program: &str) -> bool {
    env::var_os("PATH").is_some_and(|path| env::split_paths(&path).any(|folder| folder.join(program).is_file()))
}

/// The library that every Vulkan program opens.
fn has_vulkan_loader() -> bool {
    let listed = ["ldconfig", "/sbin/ldconfig"].iter().find_map(|ldconfig| {
        let output = Command::new(ldconfig).arg("-p").output().ok().filter(|output| output.status.success())?;
        Some(String::from_utf8_lossy(&output.stdout).contains("libvulkan.so.1"))
    });
    // Without ldconfig there is no telling; the program itself will say what it finds.
    listed.unwrap_or(true)
}

fn has_vulkan_driver() -> bool {
    let gpu = ["/dev/dri/renderD128", "/dev/nvidiactl", "/dev/dxg", "/dev/mali0"].iter().any(|p| Path::new(p).exists());
    can_render(&driver_manifests(|name| env::var_os(name)), gpu)
}

/// Mesa installs the drivers of all GPUs at once: without a GPU only a software driver is of use.
fn can_render(manifests: &[PathBuf], has_gpu: bool) -> bool {
    let is_software = |manifest: &PathBuf| {
        let name = manifest.file_name().unwrap_or_default().to_string_lossy();
        ["lvp", "swiftshader"].iter().any(|software| name.contains(software))
    };
    manifests.iter().any(|manifest| has_gpu || is_software(manifest))
}

/// The manifests that the Vulkan loader would read.
fn driver_manifests(variable: impl Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        if let Some(files) = variable(name) {
            return env::split_paths(&files).filter(|file| file.exists()).collect();
        }
    }
    manifests("vulkan/icd.d", variable)
}

fn has_validation_layer() -> bool {
    let layers = manifests("vulkan/explicit_layer.d", |name| env::var_os(name));
    layers.iter().any(|path| path.to_string_lossy().contains("khronos_validation"))
}

/// JSON files in a folder of the places where the Vulkan loader looks.
fn manifests(folder: &str, variable: impl Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    let home_data = variable("XDG_DATA_HOME").map(PathBuf::from);
    let home_data = home_data.or_else(|| Some(Path::new(&variable("HOME")?).join(".local/share")));
    let shared = variable("XDG_DATA_DIRS").map(|dirs| env::split_paths(&dirs).collect::<Vec<_>>());
    let always = ["/etc", "/usr/local/etc", "/usr/share", "/usr/local/share", "/run/opengl-driver/share"];
    home_data
        .into_iter()
        .chain(shared.unwrap_or_default())
        .chain(always.map(PathBuf::from))
        .filter_map(|data| data.join(folder).read_dir().ok())
        .flat_map(|entries| entries.flatten().map(|entry| entry.path()))
        .filter(|path| path.extension() == Some(OsStr::new("json")))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_driver_without_its_gpu_is_of_no_use() {
        let mesa = [PathBuf::from("/icd/radeon_icd.x86_64.json"), PathBuf::from("/icd/lvp_icd.x86_64.json")];
        assert!(can_render(&mesa, false));
        assert!(!can_render(&mesa[..1], false));
        assert!(can_render(&mesa[..1], true));
        assert!(!can_render(&[], true));
    }

    #[test]
    fn manifests_are_found_where_the_loader_looks() {
        let data = env::temp_dir().join(format!("antumbra-xtask-{}", std::process::id()));
        let folder = data.join("vulkan/icd.d");
        std::fs::create_dir_all(&folder).unwrap();
        let manifest = folder.join("lvp_icd.json");
        std::fs::write(&manifest, "{}").unwrap();
        std::fs::write(folder.join("notes.txt"), "").unwrap();

        let by_data_dirs = driver_manifests(|name| (name == "XDG_DATA_DIRS").then(|| data.clone().into()));
        let by_name = driver_manifests(|name| (name == "VK_DRIVER_FILES").then(|| manifest.clone().into()));
        let gone = driver_manifests(|name| (name == "VK_ICD_FILENAMES").then(|| data.join("none.json").into()));
        std::fs::remove_dir_all(&data).unwrap();

        assert!(by_data_dirs.contains(&manifest) && by_data_dirs.iter().all(|p| p.extension().unwrap() == "json"));
        assert_eq!(by_name, [manifest]);
        assert!(gone.is_empty());
    }
}
