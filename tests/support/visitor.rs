//! A visitor of the page of `watch`, without a browser.

use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// How long anything may take.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// An answer of the server.
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }
}

/// A visitor of the page at this port.
#[derive(Clone, Copy)]
pub(crate) struct Visitor {
    pub(crate) port: u16,
}

impl Visitor {
    /// Sends these lines of a request and reads what comes back until the end.
    pub(crate) fn say(&self, request: &str) -> Answer {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut all = Vec::new();
        stream.read_to_end(&mut all).unwrap();
        let end = all.windows(4).position(|w| w == b"\r\n\r\n").unwrap();
        let head = String::from_utf8_lossy(&all[..end]).into_owned();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        let body = all[end + 4..].to_vec();
        Answer { status, head, body }
    }

    /// `GET`, as a page of the server does it.
    pub(crate) fn get(&self, path: &str) -> Answer {
        let port = self.port;
        self.say(&format!(
            "GET {path} HTTP/1.1\r\nHost: localhost:{port}\r\nConnection: close\r\n\r\n"
        ))
    }

    /// `POST` of a JSON text, as a page of the server does it.
    pub(crate) fn post(&self, path: &str, json: &str) -> Answer {
        let (port, length) = (self.port, json.len());
        self.say(&format!(
            "POST {path} HTTP/1.1\r\nHost: localhost:{port}\r\nOrigin: http://localhost:{port}\r\n\
             Content-Type: application/json\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{json}"
        ))
    }

    /// The states that the server sends.
    pub(crate) fn events(&self) -> Events {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let port = self.port;
        write!(
            stream,
            "GET /events HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n"
        )
        .unwrap();
        Events {
            lines: BufReader::new(stream),
        }
    }
}

/// The states that the server sends, one after the other.
pub(crate) struct Events {
    lines: BufReader<TcpStream>,
}

impl Events {
    /// The next state; `None` once the server has gone.
    pub(crate) fn next(&mut self) -> Option<Value> {
        loop {
            let mut line = String::new();
            if self.lines.read_line(&mut line).ok()? == 0 {
                return None;
            }
            if let Some(data) = line.trim_end().strip_prefix("data: ") {
                return Some(serde_json::from_str(data).unwrap());
            }
        }
    }

    /// Reads states until one is as it should be.
    pub(crate) fn until(&mut self, what: &str, is_it: impl Fn(&Value) -> bool) -> Value {
        let end = Instant::now() + PATIENCE;
        let mut last = Value::Null;
        while Instant::now() < end {
            match self.next() {
                Some(state) if is_it(&state) => return state,
                Some(state) => last = state,
                None => panic!("the server went away before there was {what}; last: {last}"),
            }
        }
        panic!("no {what}; last: {last}");
    }

    /// Reads states until the picture is whole.
    pub(crate) fn whole(&mut self, what: &str, is_it: impl Fn(&Value) -> bool) -> Value {
        self.until(what, |state| state["activity"] == "done" && is_it(state))
    }
}
