//! `cargo xtask validate`: every technique under Vulkan's validation layer with its synchronisation checks.

use std::fs;
use std::path::{Path, PathBuf};

use crate::machine::{self, Need};
use crate::step::{Failure, Line, Step, cargo, output, target};

/// Settings of the layer: `enables` for versions before 1.3.280, `validate_sync` for those after.
const SETTINGS: &str = "\
khronos_validation.debug_action = VK_DBG_LAYER_ACTION_LOG_MSG
khronos_validation.report_flags = error,warn,info
khronos_validation.enables = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT
khronos_validation.validate_sync = true
khronos_validation.enable_message_limit = false
";

/// Tests that resize, move casters, and record several lights and frames into one submission.
const TESTS: [&str; 2] = ["a_technique_follows_a_change", "one_instance_serves"];

/// Draws with every technique and runs the tests; any message of the layer fails.
pub fn run() -> Result<(), Failure> {
    machine::set_up(&[Need::CppCompiler, Need::VulkanDriver, Need::ValidationLayer])?;
    Step::new("build", cargo(["build", "--bin", "antumbra"])).run()?;
    let program = target().join("debug").join("antumbra");
    let list = output(&program.to_string_lossy(), &["techniques"]).unwrap_or_default();
    let layer = Layer::new()?;
    let mut faults = Vec::new();
    for technique in crate::same_bits::names(&list) {
        // The plant has leaves cut out of a texture; the frames of a run are in flight together.
        let line = Line::new([&program]).args(["render", "builtin:plant", "-t", &technique, "--size", "97x64"]);
        let image = layer.folder.join("image.png");
        faults.extend(layer.check(line.args(["--frames", "3", "-o"]).args([image]), &technique)?);
    }
    for test in TESTS {
        let line = cargo(["test", "-p", "antumbra", "--test", "techniques", "--"]).args([test]);
        faults.extend(layer.check(line, test)?);
    }
    match faults.is_empty() {
        true => {
            println!("no message of the validation layer");
            Ok(())
        }
        false => Err(Failure::Machine(format!("the validation layer reports\n{}", faults.join("\n")))),
    }
}

/// The layer's settings file and log.
struct Layer {
    folder: PathBuf,
    log: PathBuf,
}

impl Layer {
    fn new() -> Result<Layer, Failure> {
        let folder = target().join("validate");
        let log = folder.join("messages.txt");
        let settings = format!("{SETTINGS}khronos_validation.log_filename = {}\n", log.display());
        let written =
            fs::create_dir_all(&folder).and_then(|()| fs::write(folder.join("vk_layer_settings.txt"), settings));
        written.map_err(|e| Failure::Machine(format!("{}: {e}", folder.display())))?;
        Ok(Layer { folder, log })
    }

    /// Runs a command under the layer; gives its messages, each kind once.
    fn check(&self, line: Line, what: &str) -> Result<Vec<String>, Failure> {
        // A log of an earlier run would be read as this one's.
        let _ = fs::remove_file(&self.log);
        let line = line
            .env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")
            .env("VK_LAYER_SETTINGS_PATH", self.folder.as_os_str())
            .env("NODEVICE_SELECT", "1")
            // Debug information of shaders names a language that older layers do not know.
            .env("WGPU_DEBUG", "0");
        Step::new("validate", line).run()?;
        messages(&read(&self.log)?)
            .map_err(|problem| Failure::Machine(format!("{what}: {problem}")))
            .map(|kinds| kinds.into_iter().map(|(kind, count)| format!("{what}, {count} times: {kind}")).collect())
    }
}

fn read(log: &Path) -> Result<String, Failure> {
    fs::read_to_string(log).map_err(|e| Failure::Machine(format!("{}: {e}; the layer did not run", log.display())))
}

/// The kinds of messages in a log with their counts. A layer that runs says so by a message of its own.
fn messages(log: &str) -> Result<Vec<(String, usize)>, &'static str> {
    if !log.contains("Validation Layer Active") {
        return Err("the validation layer was not active");
    }
    let mut kinds: Vec<(String, usize)> = Vec::new();
    // Objects of a message follow on lines of their own, indented.
    for line in log.lines().filter(|line| line.contains("msgNum:") && !line.contains("Validation Layer Active")) {
        let kind = line.split('(').next().unwrap_or(line).trim();
        match kinds.iter_mut().find(|(known, _)| known.starts_with(kind)) {
            Some((_, count)) => *count += 1,
            None => kinds.push((line.chars().take(500).collect(), 1)),
        }
    }
    Ok(kinds)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ACTIVE: &str = "STATUS(INFO / SPEC): msgNum: 1 - Validation Information: Khronos Validation Layer Active:\n";

    #[test]
    fn a_log_without_the_layers_own_message_is_refused() {
        assert!(messages("").is_err());
        assert_eq!(messages(ACTIVE), Ok(Vec::new()));
    }

    #[test]
    fn messages_are_counted_by_kind() {
        let log = format!(
            "{ACTIVE}    Objects: 1\nVUID-a(ERROR / SPEC): msgNum: 2 - one\n    Objects: 1\nSYNC-b(ERROR): msgNum: 3 - x\n\
             VUID-a(ERROR / SPEC): msgNum: 2 - two\n"
        );
        let found = messages(&log).unwrap();
        assert_eq!(found.iter().map(|(_, count)| *count).collect::<Vec<_>>(), [2, 1]);
        assert!(found[0].0.starts_with("VUID-a") && found[1].0.starts_with("SYNC-b"), "{found:?}");
    }
}
