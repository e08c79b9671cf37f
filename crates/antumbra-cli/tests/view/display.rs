//! A virtual display.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// An X server without a screen; ends with the value.
pub struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// Starts one under a free number.
    pub fn start() -> Display {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let told = folder.path().join("number");
        let written = std::fs::File::create(&told).expect("a file in a temporary folder");
        // The server finds a free number itself and writes it to the stream that `-displayfd` names.
        let server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"])
            .stdout(written)
            .stderr(Stdio::null())
            .spawn()
            .unwrap_or_else(|e| panic!("Xvfb: {e}; `cargo xtask test` installs it"));
        let mut display = Display { server, name: String::new() };
        let started = Instant::now();
        while started.elapsed() < Duration::from_secs(20) {
            let number = std::fs::read_to_string(&told).unwrap_or_default();
            if let Some(number) = number.strip_suffix('\n') {
                display.name = format!(":{number}");
                return display;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        panic!("Xvfb does not start");
    }

    /// A program on this display.
    pub fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("DISPLAY", &self.name).env("NODEVICE_SELECT", "1").env_remove("WAYLAND_DISPLAY");
        command
    }

    /// What the mouse and the window manager would do; the answer is what the tool prints.
    pub fn xdotool(&self, arguments: &[&str]) -> String {
        let output = self.command("xdotool").args(arguments).output();
        let output = output.unwrap_or_else(|e| panic!("xdotool: {e}; `cargo xtask test` installs it"));
        assert!(output.status.success(), "xdotool {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).trim().to_owned()
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // A server that has ended already needs no end.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
