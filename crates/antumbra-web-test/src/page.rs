//! The viewer's page in the browser: its commands and replies.

use crate::browser::Browser;
use crate::{Outcome, PATIENCE};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// The page.
pub struct Page {
    /// Shows it.
    pub browser: Browser,
    /// Where it is served.
    pub address: String,
    /// Where screenshots go.
    pub shots: PathBuf,
}

impl Page {
    /// Opens it with a query, until it answers commands.
    pub fn open(&mut self, query: &str) -> Outcome<()> {
        self.browser.open(&format!("{}/{query}", self.address))?;
        let ready = "!!window.antumbra?.ask && document.getElementById('cover').className != ''";
        self.browser.wait_for(ready, PATIENCE)
    }

    /// The answer to a command.
    pub fn ask(&mut self, command: &Value) -> Outcome<Value> {
        let answer = self.browser.value(&format!("antumbra.ask({command})"))?;
        match answer.get("error").and_then(Value::as_str) {
            Some(error) => Err(format!("{command}: {error}")),
            None => Ok(answer),
        }
    }

    /// The state.
    pub fn state(&mut self) -> Outcome<Value> {
        Ok(self.ask(&json!("state"))?["state"].take())
    }

    /// Waits until no work is pending.
    pub fn rest(&mut self) -> Outcome<()> {
        let browser = &mut self.browser;
        browser.value("window.rested = false, antumbra.ask('wait').then(() => window.rested = true), 0")?;
        let ended = "window.rested || document.getElementById('cover').className == 'failed'";
        match browser.wait_for(ended, PATIENCE).and_then(|()| browser.value("window.rested")) {
            Ok(Value::Bool(true)) => Ok(()),
            Ok(_) => Err(format!("the page broke off:\n{}", browser.errors.join("\n"))),
            Err(error) => Err(format!("{error}\n{}", browser.errors.join("\n"))),
        }
    }

    /// The state once no work is pending; nothing may have gone wrong.
    pub fn settled(&mut self) -> Outcome<Value> {
        self.rest()?;
        let state = self.state()?;
        let wrong = |key: &str| state[key].as_array().is_none_or(|list| list.iter().any(|e| !e.is_null()));
        match ["errors", "faults", "failed"].into_iter().find(|key| wrong(key)) {
            Some(key) => Err(format!("{key}: {}", state[key])),
            None => Ok(state),
        }
    }

    /// The state as soon as it meets a condition.
    pub fn waited_for(&mut self, what: &str, wanted: impl Fn(&Value) -> bool) -> Outcome<Value> {
        let start = Instant::now();
        loop {
            let state = self.state()?;
            if wanted(&state) {
                return Ok(state);
            }
            if start.elapsed() > PATIENCE {
                return Err(format!("{what}: after {} s still {state}", PATIENCE.as_secs()));
            }
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    /// Saves and returns a screenshot.
    pub fn shot(&mut self, name: &str) -> Outcome<Vec<u8>> {
        let file = self.shots.join(format!("{name}.png"));
        let png = self.browser.screenshot()?;
        std::fs::write(&file, &png).map_err(|e| format!("{}: {e}", file.display()))?;
        Ok(png)
    }

    /// Nothing may be on the console.
    pub fn no_errors(&self) -> Outcome<()> {
        match self.browser.errors.is_empty() {
            true => Ok(()),
            false => Err(format!("errors on the console:\n{}", self.browser.errors.join("\n"))),
        }
    }
}
