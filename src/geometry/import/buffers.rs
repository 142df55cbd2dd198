//! The bytes of a glTF document: the container `.glb`, files beside it, `data:` addresses.

use super::{FindBeside, ImportError, Room};

/// The parts of a `.glb` file.
pub(super) struct Container<'b> {
    /// The document.
    pub(super) json: &'b [u8],
    /// The bytes of its first buffer, if they are in the file.
    pub(super) binary: Option<&'b [u8]>,
}

const HEADER: usize = 12;
const MAGIC: u32 = u32::from_le_bytes(*b"glTF");
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BINARY: u32 = u32::from_le_bytes(*b"BIN\0");

fn broken(what: &str) -> ImportError {
    ImportError::Broken(what.to_owned())
}

/// Takes a `.glb` file apart.
pub(super) fn open(bytes: &[u8]) -> Result<Container<'_>, ImportError> {
    if number(bytes, 0) != Some(MAGIC) {
        return Err(broken(
            "it is no `.glb` file: it does not begin with `glTF`",
        ));
    }
    match number(bytes, 4) {
        Some(2) => {}
        Some(version) => {
            return Err(ImportError::Broken(format!(
                "it is of glTF version {version}; 2 is read"
            )));
        }
        None => return Err(broken("it ends within its header")),
    }
    let (mut at, mut json, mut binary) = (HEADER, None, None);
    while let (Some(length), Some(kind)) = (number(bytes, at), number(bytes, at + 4)) {
        let start = at + 8;
        let chunk = start
            .checked_add(length as usize)
            .and_then(|end| bytes.get(start..end));
        let chunk =
            chunk.ok_or_else(|| broken("it ends within one of its chunks: it is cut off"))?;
        match kind {
            JSON if json.is_none() => json = Some(chunk),
            BINARY if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        // Chunks begin at multiples of four bytes.
        at = start + chunk.len().next_multiple_of(4);
    }
    let json = json.ok_or_else(|| broken("it holds no document"))?;
    Ok(Container { json, binary })
}

/// The four bytes at `at` as a number.
fn number(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}

/// The bytes of each buffer of a document; missing ones are errors only if something needs them.
pub(super) fn load(
    buffers: &[gltf_json::Buffer],
    binary: Option<&[u8]>,
    room: &mut Room,
    beside: &mut FindBeside<'_>,
) -> Result<Vec<Vec<u8>>, ImportError> {
    let mut loaded = vec![];
    for (index, buffer) in buffers.iter().enumerate() {
        let bytes = match (&buffer.uri, binary) {
            (Some(uri), _) => fetch(uri, room, beside)?,
            (None, Some(binary)) if index == 0 => {
                room.take(binary.len() as u64, 1)?;
                binary.to_vec()
            }
            (None, _) => {
                return Err(ImportError::Broken(format!(
                    "its buffer {index} has no bytes"
                )));
            }
        };
        if (bytes.len() as u64) < buffer.byte_length.0 {
            let (found, wanted) = (bytes.len(), buffer.byte_length.0);
            return Err(ImportError::Broken(format!(
                "its buffer {index} has {found} bytes, not {wanted}: it is cut off"
            )));
        }
        loaded.push(bytes);
    }
    Ok(loaded)
}

fn fetch(uri: &str, room: &mut Room, beside: &mut FindBeside<'_>) -> Result<Vec<u8>, ImportError> {
    if let Some(data) = uri.strip_prefix("data:") {
        room.take(data.len() as u64, 1)?;
        return decode(data).ok_or_else(|| broken("it has a `data:` address that is not base64"));
    }
    let name = unescaped(uri);
    let fail = |why: String| ImportError::Beside {
        name: name.clone(),
        why,
    };
    let bytes = beside(&name).map_err(fail)?;
    let bytes = bytes.ok_or_else(|| fail("there is no such file".to_owned()))?;
    room.take(bytes.len() as u64, 1)?;
    Ok(bytes)
}

/// The content of a `data:` address, without that word; only base64 is read.
pub(super) fn decode(data: &str) -> Option<Vec<u8>> {
    let (_, text) = data.split_once(";base64,")?;
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut bits, mut n_bits) = (0_u32, 0);
    for byte in text.trim_end_matches('=').bytes() {
        let six = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(six);
        n_bits += 6;
        if n_bits >= 8 {
            n_bits -= 8;
            bytes.push((bits >> n_bits) as u8);
        }
    }
    Some(bytes)
}

/// A relative address as a path: `%20` is a space.
pub(super) fn unescaped(uri: &str) -> String {
    let mut bytes = vec![];
    let mut rest = uri.as_bytes();
    while let Some((&byte, tail)) = rest.split_first() {
        let escaped = (byte == b'%').then(|| tail.get(..2)).flatten();
        let escaped = escaped.and_then(|two| std::str::from_utf8(two).ok());
        match escaped.and_then(|two| u8::from_str_radix(two, 16).ok()) {
            Some(value) => {
                bytes.push(value);
                rest = &tail[2..];
            }
            None => {
                bytes.push(byte);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_decoded() {
        let text = |data| decode(data).map(|bytes| String::from_utf8(bytes).unwrap());
        assert_eq!(
            text("application/octet-stream;base64,cm9jaw==").as_deref(),
            Some("rock")
        );
        assert_eq!(text(";base64,cm9ja3M=").as_deref(), Some("rocks"));
        assert_eq!(text(";base64,").as_deref(), Some(""));
        assert_eq!((text(";base64,r o"), text("text/plain,rock")), (None, None));
        assert_eq!(unescaped("my%20rock%2.bin%"), "my rock%2.bin%");
    }

    #[test]
    fn a_container_that_is_cut_off_anywhere_is_told() {
        let mut whole = b"glTF\x02\0\0\0\0\0\0\0\x02\0\0\0JSON{}  \x04\0\0\0BIN\0".to_vec();
        whole.extend([1, 2, 3, 4]);
        let container = open(&whole).unwrap();
        assert_eq!(
            (container.json, container.binary),
            (&b"{}"[..], Some(&[1, 2, 3, 4][..]))
        );
        for length in 0..whole.len() {
            let cut = open(&whole[..length]);
            assert!(cut.is_err() || cut.unwrap().binary.is_none(), "{length}");
        }
        whole[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(open(&whole).is_err());
    }
}
