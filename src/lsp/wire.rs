//! Messages on a pipe: a head with the length, an empty line, JSON.
//!
//! Written out here because a server must outlive what it cannot read: a broken head is passed over line by line, a broken
//! body is skipped by its length, and no length makes it reserve memory.

use serde_json::Value;
use std::io::{self, BufRead, Read, Write};

/// No message is longer than this many bytes: 64 MiB.
const LONGEST_MESSAGE: u64 = 1 << 26;
/// No line of a head is longer than this many bytes.
const LONGEST_LINE: u64 = 1 << 12;

/// What came in.
#[derive(Clone, Debug, PartialEq)]
pub enum Incoming {
    /// A message.
    Message(Value),
    /// Something that is none, and why.
    Broken(String),
}

/// Reads the next message; `None` at the end.
///
/// # Errors
/// If the pipe breaks.
pub fn read(input: &mut impl BufRead) -> io::Result<Option<Incoming>> {
    let length = match head(input)? {
        Head::End => return Ok(None),
        Head::Broken(why) => return Ok(Some(Incoming::Broken(why))),
        Head::Length(length) => length,
    };
    let mut body = input.take(length);
    if length > LONGEST_MESSAGE {
        io::copy(&mut body, &mut io::sink())?;
        let why = format!("a message of {length} bytes is too long");
        return Ok(Some(Incoming::Broken(why)));
    }
    let mut text = vec![];
    body.read_to_end(&mut text)?;
    if (text.len() as u64) < length {
        return Ok(None);
    }
    Ok(Some(match serde_json::from_slice(&text) {
        Ok(message) => Incoming::Message(message),
        Err(error) => Incoming::Broken(error.to_string()),
    }))
}

enum Head {
    Length(u64),
    Broken(String),
    End,
}

fn head(input: &mut impl BufRead) -> io::Result<Head> {
    let mut length = None;
    loop {
        let mut line = vec![];
        let n_read = input.take(LONGEST_LINE).read_until(b'\n', &mut line)?;
        if n_read == 0 {
            return Ok(Head::End);
        }
        let line = String::from_utf8_lossy(&line);
        let line = line.trim();
        if line.is_empty() {
            match length {
                Some(length) => return Ok(Head::Length(length)),
                // Stray empty lines between messages.
                None => continue,
            }
        }
        let Some((name, value)) = line.split_once(':') else {
            return Ok(Head::Broken("a line of the head has no colon".into()));
        };
        if name.trim().eq_ignore_ascii_case("content-length") {
            match value.trim().parse() {
                Ok(number) => length = Some(number),
                Err(_) => return Ok(Head::Broken("the length is no number".into())),
            }
        }
    }
}

/// Writes a message.
///
/// # Errors
/// If the pipe breaks.
pub fn write(output: &mut impl Write, message: &Value) -> io::Result<()> {
    let text = message.to_string();
    write!(output, "Content-Length: {}\r\n\r\n{text}", text.len())?;
    output.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn all(text: &[u8]) -> Vec<Incoming> {
        let mut input = text;
        let mut found = vec![];
        while let Some(incoming) = read(&mut input).unwrap() {
            found.push(incoming);
        }
        found
    }

    #[test]
    fn what_is_written_is_read_again() {
        let (a, b) = (json!({"id": 1, "text": "ä\r\n"}), json!([]));
        let mut pipe = vec![];
        write(&mut pipe, &a).unwrap();
        write(&mut pipe, &b).unwrap();
        assert_eq!(all(&pipe), [Incoming::Message(a), Incoming::Message(b)]);
    }

    #[test]
    fn broken_messages_are_passed_over() {
        let text = b"nonsense\r\nContent-Length: x\r\nContent-Length: 3\r\n\r\n{,}Content-Length: 99999999999999\r\n\r\n{}";
        let found = all(text);
        assert!(found.iter().all(|i| matches!(i, Incoming::Broken(_))));
        assert_eq!(found.len(), 4);
        let mut pipe = b"what\n\n".to_vec();
        write(&mut pipe, &json!(7)).unwrap();
        assert_eq!(all(&pipe).last(), Some(&Incoming::Message(json!(7))));
    }

    #[test]
    fn a_message_that_ends_early_ends_the_pipe() {
        assert_eq!(all(b"Content-Length: 10\r\n\r\n{}"), []);
    }
}
