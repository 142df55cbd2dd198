//! A `watch` under way, for whoever looks at its page.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A running `watch`, ended when it is dropped.
pub(crate) struct Watch(Child);

impl Watch {
    /// Starts it on a model in this folder; gives the address of its page, too.
    pub(crate) fn start(folder: &Path, model: &str, options: &str) -> (Self, String) {
        let mut child = Command::new(env!("CARGO_BIN_EXE_understory"))
            .current_dir(folder)
            .args(["watch", model, "--port", "0"])
            .args(options.split(' '))
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let line = lines.find(|line| line.as_ref().unwrap().contains("http://"));
        let address = line.unwrap().unwrap();
        let address = address.split("open ").nth(1).unwrap().trim().to_owned();
        std::thread::spawn(move || lines.for_each(drop));
        (Self(child), address)
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
