//! The viewer as a process, and what it shows.

use crate::display::Display;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// How long an answer may take on a slow machine without a GPU.
const PATIENCE: Duration = Duration::from_secs(240);

/// The window of a viewer.
pub struct Window<'a> {
    display: &'a Display,
    process: Child,
    commands: ChildStdin,
    answers: Receiver<String>,
    id: String,
}

/// A screenshot.
pub struct Shot {
    path: PathBuf,
    pixels: image::RgbImage,
}

impl<'a> Window<'a> {
    /// Opens the viewer with these arguments.
    pub fn open(display: &'a Display, arguments: &[&str]) -> Window<'a> {
        let mut process = display
            .command(env!("CARGO_BIN_EXE_antumbra"))
            .args(["view", "--commands", "--size", "1000x640"])
            // A desktop that has no file dialog to offer: no portal, and no program that shows one.
            .envs([("DBUS_SESSION_BUS_ADDRESS", "unix:path=/nonexistent"), ("PATH", "")])
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the viewer starts");
        let commands = process.stdin.take().expect("it is piped");
        let (send, answers) = channel();
        let lines = BufReader::new(process.stdout.take().expect("it is piped")).lines();
        std::thread::spawn(move || {
            for line in lines.map_while(Result::ok) {
                // The test has failed already where nobody listens.
                let _ = send.send(line);
            }
        });
        let mut window = Window { display, process, commands, answers, id: String::new() };
        window.ask(json!("state"));
        window.id = display.xdotool(&["search", "--sync", "--onlyvisible", "--name", "Antumbra"]);
        window
    }

    /// Gives a command and returns its answer.
    pub fn ask(&mut self, command: Value) -> Value {
        writeln!(self.commands, "{command}").unwrap_or_else(|e| panic!("{command}: the viewer has ended: {e}"));
        let answer = self.answers.recv_timeout(PATIENCE).unwrap_or_else(|e| panic!("{command}: no answer: {e}"));
        let answer: Value = serde_json::from_str(&answer).unwrap_or_else(|e| panic!("{command}: {answer}: {e}"));
        assert!(answer["error"].is_null(), "{command}: {answer}");
        answer
    }

    /// What is on the screen, once nothing is under way. No GPU error is tolerated.
    pub fn settled(&mut self) -> Value {
        self.ask(json!("wait"));
        let state = self.ask(json!("state"))["state"].take();
        assert_eq!(state["faults"], json!([]), "{state}");
        assert_eq!(state["failed"], json!([null, null]), "{state}");
        state
    }

    /// What is on the screen as soon as it is as wanted.
    pub fn waited_for(&mut self, wanted: impl Fn(&Value) -> bool) -> Value {
        let started = Instant::now();
        loop {
            let state = self.ask(json!("state"))["state"].take();
            assert_eq!(state["faults"], json!([]), "{state}");
            if wanted(&state) {
                return state;
            }
            assert!(started.elapsed() < PATIENCE, "it never comes: {state}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// The place of a handle of the light in the window, pixels.
    pub fn handle(&self, state: &Value, name: &str) -> [f64; 2] {
        let handles = state["handles"].as_array().expect("a list");
        let found = handles.iter().find(|h| h[0] == name).unwrap_or_else(|| panic!("no handle {name}: {state}"));
        [0, 1].map(|i| found[1][i].as_f64().expect("a number"))
    }

    /// Drags the mouse, as a hand does.
    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        let mouse = |at: [f64; 2]| {
            let [x, y] = at.map(|v| format!("{v:.0}"));
            self.display.xdotool(&["mousemove", "--window", &self.id, &x, &y]);
            std::thread::sleep(Duration::from_millis(120));
        };
        mouse(from);
        self.display.xdotool(&["mousedown", "1"]);
        std::thread::sleep(Duration::from_millis(200));
        for step in 1..=5 {
            let part = f64::from(step) / 5.0;
            mouse([0, 1].map(|i| from[i] + (to[i] - from[i]) * part));
        }
        // The window may be busy: it sees the last move before the button goes up.
        self.settled();
        self.display.xdotool(&["mouseup", "1"]);
        std::thread::sleep(Duration::from_millis(200));
    }

    /// Turns the wheel, which zooms out.
    pub fn scroll_away(&mut self, [x, y]: [f64; 2]) {
        self.display.xdotool(&["mousemove", "--window", &self.id, &x.to_string(), &y.to_string()]);
        self.display.xdotool(&["click", "--repeat", "8", "--delay", "120", "5"]);
        std::thread::sleep(Duration::from_millis(300));
    }

    /// Gives the window another size; the window itself may stop at its smallest.
    pub fn resize(&mut self, [width, height]: [u32; 2]) {
        self.display.xdotool(&["windowsize", &self.id, &width.to_string(), &height.to_string()]);
        std::thread::sleep(Duration::from_millis(300));
    }

    /// Takes the window off the screen and puts it back.
    pub fn minimise(&mut self) {
        self.display.xdotool(&["windowunmap", &self.id]);
        std::thread::sleep(Duration::from_millis(500));
        self.display.xdotool(&["windowmap", &self.id]);
        std::thread::sleep(Duration::from_millis(300));
    }

    /// Takes a screenshot of the whole window. It has to show something.
    pub fn shot(&mut self, name: &str) -> Shot {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("view");
        std::fs::create_dir_all(&folder).expect("a folder in the target's");
        let path = folder.join(format!("{name}.png"));
        self.ask(json!({"screenshot": path}));
        let pixels = image::open(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).to_rgb8();
        let (low, high) = pixels.as_raw().iter().fold((255, 0), |(low, high), &v| (v.min(low), v.max(high)));
        assert!(high - low > 100, "{} is empty: all between {low} and {high}", path.display());
        Shot { path, pixels }
    }

    /// Closes the window and sees that the program ends well.
    pub fn quit(mut self) {
        self.ask(json!("close"));
        let started = Instant::now();
        while started.elapsed() < Duration::from_secs(60) {
            if let Some(status) = self.process.try_wait().expect("it is ours") {
                assert!(status.success(), "the viewer ended with {status}");
                return;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        panic!("the viewer does not close");
    }
}

impl Drop for Window<'_> {
    fn drop(&mut self) {
        // One that has ended already needs no end.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Shot {
    /// Mean difference of two screenshots' channels, in [0, 1].
    pub fn difference(&self, other: &Shot) -> f64 {
        let paths = format!("{} and {}", self.path.display(), other.path.display());
        assert_eq!(self.pixels.dimensions(), other.pixels.dimensions(), "{paths}");
        let pairs = self.pixels.as_raw().iter().zip(other.pixels.as_raw());
        let sum: f64 = pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
        sum / 255.0 / self.pixels.as_raw().len() as f64
    }
}
