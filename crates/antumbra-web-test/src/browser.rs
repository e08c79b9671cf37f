//! A headless Chromium, spoken to by the DevTools protocol.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket};

/// A browser with one page. It is closed when this is dropped.
pub struct Browser {
    process: Child,
    /// Talks of the browser as a whole.
    whole: WebSocket<TcpStream>,
    /// Talks of the page.
    page: WebSocket<TcpStream>,
    calls: u64,
    /// Errors on the page's console, and uncaught exceptions.
    pub errors: Vec<String>,
    /// Other events of the page, by name, since the last query.
    events: Vec<Value>,
    _folder: tempfile::TempDir,
}

/// SwiftShader draws: it is part of Chromium and the same on every machine.
const FLAGS: [&str; 14] = [
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--disable-sync",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--enable-unsafe-webgpu",
    "--use-webgpu-adapter=swiftshader",
    "--enable-features=Vulkan",
    "--use-vulkan=swiftshader",
    "--use-angle=swiftshader",
    "--remote-debugging-port=0",
    "about:blank",
];

type Outcome<T> = Result<T, String>;

impl Browser {
    /// Starts it with a window of this size in pixels. `CHROMIUM` names another program than `chromium`.
    pub fn start(size: [u32; 2]) -> Outcome<Browser> {
        let program = std::env::var("CHROMIUM").unwrap_or_else(|_| "chromium".to_owned());
        let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
        let mut process = Command::new(&program)
            .arg(format!("--user-data-dir={}", folder.path().display()))
            .arg(format!("--window-size={},{}", size[0], size[1]))
            .args(FLAGS)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|e| format!("cannot start {program}: {e}"))?;
        let (port, path) = match address(&mut process) {
            Ok(address) => address,
            Err(error) => {
                // It may have ended by itself.
                let _ = process.kill();
                return Err(error);
            }
        };
        let [whole, page] = [connect(port, &path)?, connect(port, &path)?];
        let mut browser =
            Browser { whole, page, process, calls: 0, errors: Vec::new(), events: Vec::new(), _folder: folder };
        let made = browser.call_whole("Target.createTarget", json!({ "url": "about:blank" }))?;
        let target = made["targetId"].as_str().ok_or("the browser opens no page")?;
        browser.page = connect(port, &format!("/devtools/page/{target}"))?;
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.call(domain, json!({}))?;
        }
        Ok(browser)
    }

    /// Calls a method of the protocol that is about the page.
    pub fn call(&mut self, method: &str, parameters: Value) -> Outcome<Value> {
        self.calls += 1;
        send(&mut self.page, self.calls, method, parameters)?;
        loop {
            let value = receive(&mut self.page, method)?;
            if value["id"] == self.calls {
                return result(method, value);
            }
            self.errors.extend(error_in(&value));
            self.events.push(value);
        }
    }

    /// Calls a method of the protocol that is about the browser as a whole.
    pub fn call_whole(&mut self, method: &str, parameters: Value) -> Outcome<Value> {
        self.calls += 1;
        send(&mut self.whole, self.calls, method, parameters)?;
        loop {
            let value = receive(&mut self.whole, method)?;
            if value["id"] == self.calls {
                return result(method, value);
            }
        }
    }

    /// Waits for an event of this name; [`Browser::forget`] drops earlier ones.
    pub fn event(&mut self, name: &str, most: Duration) -> Outcome<Value> {
        let start = Instant::now();
        loop {
            // Whatever it answers, events come with it.
            self.value("0")?;
            if let Some(event) = self.events.iter().find(|e| e["method"] == name) {
                return Ok(event["params"].clone());
            }
            if start.elapsed() > most {
                let names: Vec<_> = self.events.iter().filter_map(|e| e["method"].as_str()).collect();
                return Err(format!("no {name} within {} s, but {names:?}", most.as_secs()));
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Drops the events so far.
    pub fn forget(&mut self) {
        self.events.clear();
    }

    /// Goes to an address; the console's messages count from here.
    pub fn open(&mut self, address: &str) -> Outcome<()> {
        self.errors.clear();
        self.forget();
        self.call("Page.navigate", json!({ "url": address })).map(|_| ())
    }

    /// The value of an expression; promises are waited for.
    pub fn value(&mut self, expression: &str) -> Outcome<Value> {
        // As if by a click: browsers open a file dialog for nothing less.
        let asked =
            json!({ "expression": expression, "awaitPromise": true, "returnByValue": true, "userGesture": true });
        let answer = self.call("Runtime.evaluate", asked)?;
        match answer.get("exceptionDetails") {
            Some(details) => Err(format!("{expression}: {}", details["exception"]["description"])),
            None => Ok(answer["result"]["value"].clone()),
        }
    }

    /// Waits until an expression is true.
    pub fn wait_for(&mut self, expression: &str, most: Duration) -> Outcome<()> {
        let start = Instant::now();
        while self.value(expression)? != Value::Bool(true) {
            if start.elapsed() > most {
                return Err(format!("after {} s this is not true: {expression}", most.as_secs()));
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        Ok(())
    }

    /// A screenshot as a PNG file.
    pub fn screenshot(&mut self) -> Outcome<Vec<u8>> {
        use base64::Engine;
        let answer = self.call("Page.captureScreenshot", json!({ "format": "png" }))?;
        let text = answer["data"].as_str().unwrap_or_default();
        base64::engine::general_purpose::STANDARD.decode(text).map_err(|e| e.to_string())
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Closed in order its children end too; it may have ended by itself.
        let _ = self.whole.send(Message::text(json!({ "id": 0, "method": "Browser.close" }).to_string()));
        for _ in 0..50 {
            if !matches!(self.process.try_wait(), Ok(None)) {
                return;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The port and the path that the browser says it listens on.
fn address(process: &mut Child) -> Outcome<(u16, String)> {
    let errors = process.stderr.take().ok_or("the browser has no stderr")?;
    let mut lines = BufReader::new(errors).lines();
    let mut said = String::new();
    while let Some(Ok(line)) = lines.next() {
        let address = line.strip_prefix("DevTools listening on ws://127.0.0.1:");
        if let Some((port, path)) = address.and_then(|a| a.split_once('/'))
            && let Ok(port) = port.parse()
        {
            // It must never wait for a reader.
            std::thread::spawn(move || lines.for_each(drop));
            return Ok((port, format!("/{path}")));
        }
        said = format!("{said}\n{line}");
    }
    Err(format!("the browser ended at once:{said}"))
}

fn send(socket: &mut WebSocket<TcpStream>, id: u64, method: &str, parameters: Value) -> Outcome<()> {
    let text = json!({ "id": id, "method": method, "params": parameters }).to_string();
    socket.send(Message::text(text)).map_err(|e| format!("{method}: {e}"))
}

/// The next message while an answer to `method` is waited for.
fn receive(socket: &mut WebSocket<TcpStream>, method: &str) -> Outcome<Value> {
    loop {
        let message = socket.read().map_err(|e| format!("{method}: no answer: {e}"))?;
        if let Message::Text(text) = message {
            return serde_json::from_str(&text).map_err(|e| e.to_string());
        }
    }
}

fn result(method: &str, answer: Value) -> Outcome<Value> {
    match answer.get("error") {
        Some(error) => Err(format!("{method}: {error}")),
        None => Ok(answer["result"].clone()),
    }
}

fn connect(port: u16, path: &str) -> Outcome<WebSocket<TcpStream>> {
    let stream = TcpStream::connect(("127.0.0.1", port)).map_err(|e| format!("cannot reach the browser: {e}"))?;
    stream.set_read_timeout(Some(Duration::from_secs(600))).map_err(|e| e.to_string())?;
    let (socket, _) =
        tungstenite::client(format!("ws://127.0.0.1:{port}{path}"), stream).map_err(|e| format!("{path}: {e}"))?;
    Ok(socket)
}

/// The error of an event.
fn error_in(event: &Value) -> Option<String> {
    let parameters = &event["params"];
    match event["method"].as_str()? {
        "Runtime.exceptionThrown" => Some(parameters["exceptionDetails"].to_string()),
        "Runtime.consoleAPICalled" if parameters["type"] == "error" || parameters["type"] == "assert" => {
            let words = parameters["args"].as_array()?.iter();
            let words = words.map(|w| w["value"].as_str().map_or_else(|| w.to_string(), str::to_owned));
            Some(words.collect::<Vec<_>>().join(" "))
        }
        "Log.entryAdded" if parameters["entry"]["level"] == "error" => {
            Some(format!("{} {}", parameters["entry"]["text"], parameters["entry"]["url"]))
        }
        _ => None,
    }
}
