//! Texts inside PNG files: how a picture was made, and whether a file is whole.
//!
//! Only the container is read and written here (length, type, data, check sum of each chunk); the texts are international
//! ones (`iTXt`, UTF-8, not compressed), right after the header.
//!
//! Source: [PNG3](crate::references#png3) §5 (chunks), §11.3.3 (texts), Annex D (check sum).

/// Bytes before the first chunk.
const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
/// The signature and the header chunk, which is always 13 bytes of data.
const AFTER_HEADER: usize = SIGNATURE.len() + 4 + 4 + 13 + 4;

/// The file with the texts added; `png` must be a whole PNG file, keys are 1 to 79 ASCII letters or spaces.
pub fn insert(png: Vec<u8>, texts: &[(&str, String)]) -> Vec<u8> {
    let mut chunks = Vec::new();
    for (key, value) in texts {
        let mut data = key.as_bytes().to_vec();
        data.extend_from_slice(&[0, 0, 0, 0, 0]);
        data.extend_from_slice(value.as_bytes());
        push_chunk(&mut chunks, *b"iTXt", &data);
    }
    let mut out = png;
    out.splice(AFTER_HEADER..AFTER_HEADER, chunks);
    out
}

/// The texts of a PNG file, or `None` if the file is not a whole PNG file (cut off, or any check sum wrong).
pub fn read(file: &[u8]) -> Option<Vec<(String, String)>> {
    let mut rest = file.strip_prefix(SIGNATURE)?;
    let mut texts = Vec::new();
    loop {
        let length = u32::from_be_bytes(*rest.first_chunk()?) as usize;
        let body = rest.get(4..length.checked_add(8)?)?;
        let sum = u32::from_be_bytes(*rest.get(length + 8..)?.first_chunk()?);
        if crc(body) != sum {
            return None;
        }
        let (kind, data) = body.split_at(4);
        match kind {
            b"IEND" => return Some(texts),
            b"iTXt" => texts.extend(text(data)),
            _ => {}
        }
        rest = &rest[length + 12..];
    }
}

/// Key and value of an `iTXt` chunk as [`insert`] writes it.
fn text(data: &[u8]) -> Option<(String, String)> {
    let end = data.iter().position(|&byte| byte == 0)?;
    let value = data.get(end..)?.strip_prefix(&[0; 5])?;
    let read = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).ok();
    Some((read(&data[..end])?, read(value)?))
}

fn push_chunk(out: &mut Vec<u8>, kind: [u8; 4], data: &[u8]) {
    let length = u32::try_from(data.len()).unwrap_or(u32::MAX);
    out.extend_from_slice(&length.to_be_bytes());
    let start = out.len();
    out.extend_from_slice(&kind);
    out.extend_from_slice(data);
    let sum = crc(&out[start..]);
    out.extend_from_slice(&sum.to_be_bytes());
}

/// The cyclic redundancy check of ISO 3309 that PNG uses.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, &byte| {
        CRC[usize::from(sum as u8 ^ byte)] ^ (sum >> 8)
    })
}

const CRC: [u32; 256] = {
    let mut table = [0; 256];
    let mut n = 0;
    while n < 256 {
        let mut c = n as u32;
        let mut bit = 0;
        while bit < 8 {
            c = if c & 1 == 1 {
                0xedb8_8320 ^ (c >> 1)
            } else {
                c >> 1
            };
            bit += 1;
        }
        table[n] = c;
        n += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Format, Picture, Pixels, encode};

    fn file(texts: &[(&str, String)]) -> Vec<u8> {
        let picture = Picture {
            width: 2,
            height: 1,
            pixels: Pixels::Srgb(vec![7; 6]),
        };
        encode(&picture, Format::Png, texts).unwrap()
    }

    #[test]
    fn texts_come_back_and_the_picture_still_reads() {
        let texts = [
            ("Software", "understory".to_owned()),
            ("Model", "brêle; 7".to_owned()),
        ];
        let bytes = file(&texts);
        let expected: Vec<(String, String)> = texts
            .iter()
            .map(|(k, v)| ((*k).to_owned(), v.clone()))
            .collect();
        assert_eq!(read(&bytes), Some(expected));
        assert_eq!(
            image::load_from_memory(&bytes)
                .unwrap()
                .to_rgb8()
                .into_raw(),
            vec![7; 6]
        );
    }

    #[test]
    fn damaged_files_are_not_whole() {
        let bytes = file(&[("Software", "understory".to_owned())]);
        for cut in 0..bytes.len() {
            assert_eq!(read(&bytes[..cut]), None, "cut at {cut}");
        }
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1;
            assert_eq!(read(&damaged), None, "byte {at}");
        }
    }
}
