//! A real browser without a window, told what to do through pipes (the protocol of its developer tools).

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Names that Chromium is installed by.
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// How long anything may take.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser with one page.
pub(crate) struct Browser {
    child: Child,
    session: Option<String>,
    number: u64,
}

/// A screenshot.
pub(crate) struct Shot {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl Shot {
    /// Red, green and blue at a place, in parts of the width and height; a mean over a small square.
    pub(crate) fn at(&self, x: f64, y: f64) -> [f64; 3] {
        let (x, y) = (x * self.width as f64, y * self.height as f64);
        let (x, y) = (x as usize, y as usize);
        let mut sum = [0.0; 3];
        for row in y.saturating_sub(1)..=(y + 1).min(self.height - 1) {
            for column in x.saturating_sub(1)..=(x + 1).min(self.width - 1) {
                for (channel, sum) in sum.iter_mut().enumerate() {
                    *sum += f64::from(self.pixels[3 * (row * self.width + column) + channel]) / 9.0;
                }
            }
        }
        sum
    }
}

impl Shot {
    /// Red, green and blue of a pixel.
    pub(crate) fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        let first = 3 * (y * self.width + x);
        std::array::from_fn(|channel| self.pixels[first + channel])
    }
}

impl Browser {
    /// Starts a browser whose window is so large; `None` if there is none on this machine. What it saves goes to `downloads`.
    pub(crate) fn start(width: u32, height: u32, downloads: &Path) -> Option<Self> {
        let runs = |name: &&&str| {
            let version = Command::new(name).arg("--version").output();
            version.is_ok_and(|output| output.status.success())
        };
        let name = NAMES.iter().find(runs)?;
        // It reads commands from descriptor 3 and answers on 4.
        let command = format!(
            "exec {name} --headless=new --no-sandbox --disable-gpu --enable-unsafe-swiftshader --disable-dev-shm-usage --no-first-run \
             --remote-debugging-pipe --user-data-dir=\"$1\" about:blank 3<&0 4>&1 </dev/null >/dev/null 2>&1"
        );
        let child = Command::new("sh")
            .args(["-c", &command, "sh"])
            .arg(downloads.join("profile"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut browser = Self {
            child,
            session: None,
            number: 0,
        };
        let target = browser.tell("Target.createTarget", json!({ "url": "about:blank" }));
        let id = &target["targetId"];
        let attached = browser.tell(
            "Target.attachToTarget",
            json!({ "targetId": id, "flatten": true }),
        );
        browser.tell(
            "Browser.setDownloadBehavior",
            json!({ "behavior": "allow", "downloadPath": downloads }),
        );
        browser.session = Some(attached["sessionId"].as_str().unwrap().to_owned());
        let metrics =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        browser.tell("Emulation.setDeviceMetricsOverride", metrics);
        Some(browser)
    }

    /// Sends a command and waits for its answer. Messages end with a zero byte.
    fn tell(&mut self, method: &str, params: Value) -> Value {
        self.number += 1;
        let mut message = json!({ "id": self.number, "method": method, "params": params });
        if let Some(session) = &self.session {
            message["sessionId"] = session.clone().into();
        }
        let mut line = message.to_string().into_bytes();
        line.push(0);
        self.child.stdin.as_mut().unwrap().write_all(&line).unwrap();
        loop {
            let mut answer = Vec::new();
            // Nothing is buffered beyond a message: it would be lost with the reader.
            let out = self.child.stdout.as_mut().unwrap();
            let n = BufReader::with_capacity(1, out).read_until(0, &mut answer);
            assert!(n.unwrap() > 0, "the browser has gone");
            answer.pop();
            let answer: Value = serde_json::from_slice(&answer).unwrap();
            if answer["id"] == self.number {
                assert!(answer["error"].is_null(), "{method}: {answer}");
                return answer["result"].clone();
            }
        }
    }

    /// Opens a page.
    pub(crate) fn open(&mut self, url: &str) {
        self.tell("Page.navigate", json!({ "url": url }));
    }

    /// The value of an expression of JavaScript on the page.
    pub(crate) fn ask(&mut self, expression: &str) -> Value {
        let question =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.tell("Runtime.evaluate", question);
        assert!(
            answer["exceptionDetails"].is_null(),
            "{expression}: {answer}"
        );
        answer["result"]["value"].clone()
    }

    /// Waits until an expression is true on the page.
    pub(crate) fn until(&mut self, expression: &str) {
        let end = Instant::now() + PATIENCE;
        while self.ask(expression) != true {
            let page = "document.body.innerText";
            assert!(
                Instant::now() < end,
                "never `{expression}` on\n{}",
                self.ask(page)
            );
            std::thread::sleep(Duration::from_millis(30));
        }
    }

    /// Waits until a screenshot of an element is as it should be.
    pub(crate) fn until_seen(&mut self, selector: &str, what: &str, is_it: impl Fn(&Shot) -> bool) {
        let end = Instant::now() + PATIENCE;
        while !is_it(&self.shot(selector)) {
            assert!(Instant::now() < end, "never seen: {what}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Where an element is: left, top, width, height.
    pub(crate) fn place(&mut self, selector: &str) -> [f64; 4] {
        let expression = format!(
            "(() => {{ const r = document.querySelector('{selector}').getBoundingClientRect(); \
             return [r.left, r.top, r.width, r.height]; }})()"
        );
        let place = self.ask(&expression);
        std::array::from_fn(|i| place[i].as_f64().unwrap())
    }

    /// What an element looks like.
    pub(crate) fn shot(&mut self, selector: &str) -> Shot {
        let [x, y, width, height] = self.place(selector);
        let clip = json!({ "x": x, "y": y, "width": width, "height": height, "scale": 1 });
        let shot = self.tell("Page.captureScreenshot", json!({ "clip": clip }));
        let png = base64(shot["data"].as_str().unwrap());
        let picture = image::load_from_memory(&png).unwrap().to_rgb8();
        Shot {
            width: picture.width() as usize,
            height: picture.height() as usize,
            pixels: picture.into_raw(),
        }
    }

    /// Gives the window another size, and the user a liking for the dark.
    pub(crate) fn dress(&mut self, width: u32, height: u32, is_dark: bool) {
        let metrics =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.tell("Emulation.setDeviceMetricsOverride", metrics);
        let scheme = if is_dark { "dark" } else { "light" };
        let features = json!([{ "name": "prefers-color-scheme", "value": scheme }]);
        self.tell(
            "Emulation.setEmulatedMedia",
            json!({ "features": features }),
        );
        std::thread::sleep(Duration::from_millis(300));
    }

    /// Keeps a picture of the window as a PNG file.
    pub(crate) fn keep(&mut self, path: &Path) {
        let shot = self.tell("Page.captureScreenshot", json!({}));
        std::fs::write(path, base64(shot["data"].as_str().unwrap())).unwrap();
    }

    /// A mouse event at a place of the page.
    fn mouse(&mut self, kind: &str, (x, y): (f64, f64), buttons: u32) {
        let event = json!({
            "type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1,
        });
        self.tell("Input.dispatchMouseEvent", event);
    }

    /// Clicks into the middle of an element.
    pub(crate) fn click(&mut self, selector: &str) {
        self.ask(&format!(
            "document.querySelector('{selector}').scrollIntoView({{ block: 'center' }})"
        ));
        let [x, y, width, height] = self.place(selector);
        let place = (x + width / 2.0, y + height / 2.0);
        self.mouse("mousePressed", place, 1);
        self.mouse("mouseReleased", place, 0);
    }

    /// Drags from a place of the page along a way.
    pub(crate) fn drag(&mut self, (x, y): (f64, f64), (dx, dy): (f64, f64)) {
        self.mouse("mousePressed", (x, y), 1);
        for step in 1..=10 {
            let part = f64::from(step) / 10.0;
            self.mouse("mouseMoved", (x + part * dx, y + part * dy), 1);
        }
        self.mouse("mouseReleased", (x + dx, y + dy), 0);
    }

    /// Presses a key.
    pub(crate) fn key(&mut self, key: &str) {
        for kind in ["rawKeyDown", "keyUp"] {
            let code = match key {
                "ArrowLeft" => 37,
                "ArrowUp" => 38,
                "ArrowRight" => 39,
                "ArrowDown" => 40,
                _ => 0,
            };
            let event =
                json!({ "type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code });
            self.tell("Input.dispatchKeyEvent", event);
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The bytes of a text in base 64.
fn base64(text: &str) -> Vec<u8> {
    let value = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let digits: Vec<u8> = text.bytes().filter(|c| *c != b'=').map(value).collect();
    let bytes = digits.chunks(4).flat_map(|chunk| {
        let bits = chunk
            .iter()
            .fold(0_u32, |bits, digit| bits << 6 | u32::from(*digit));
        let bits = bits << (6 * (4 - chunk.len()));
        bits.to_be_bytes()[1..chunk.len()].to_vec()
    });
    bytes.collect()
}
