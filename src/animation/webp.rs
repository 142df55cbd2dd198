//! The container of animated WebP: whole frames, each encoded without loss as a picture of its own.
//!
//! Source: [`WebpContainer`](crate::references#webpcontainer).

use super::gif::duration;

/// Longest side of a frame.
pub(super) const LONGEST_SIDE: u32 = 16_384;

/// Writes an animated WebP file.
#[derive(Clone, Debug)]
pub(super) struct WebpWriter {
    body: Vec<u8>,
    width: u32,
    height: u32,
    fps: u32,
    n: u32,
}

impl WebpWriter {
    /// A film that repeats for ever.
    pub(super) fn new(width: u32, height: u32, fps: u32) -> Self {
        let mut body = b"WEBP".to_vec();
        // Flags: it moves.
        let mut head = vec![2, 0, 0, 0];
        head.extend(u24(width - 1));
        head.extend(u24(height - 1));
        chunk(&mut body, b"VP8X", &head);
        // A white background, and no end of repeating.
        chunk(&mut body, b"ANIM", &[255, 255, 255, 255, 0, 0]);
        Self {
            body,
            width,
            height,
            fps,
            n: 0,
        }
    }

    /// Adds a frame, given as a WebP file of its own.
    pub(super) fn push(&mut self, file: &[u8]) {
        let mut frame = vec![0; 6];
        frame.extend(u24(self.width - 1));
        frame.extend(u24(self.height - 1));
        frame.extend(u24(duration(self.n, self.fps, 1000)));
        // Not mixed with the frame before.
        frame.push(2);
        // What follows `RIFF`, the size and `WEBP` is the picture.
        frame.extend_from_slice(file.get(12..).unwrap_or_default());
        chunk(&mut self.body, b"ANMF", &frame);
        self.n += 1;
    }

    /// The file; `None` if it is larger than the format allows.
    pub(super) fn finish(self) -> Option<Vec<u8>> {
        let size = u32::try_from(self.body.len()).ok()?;
        let mut out = b"RIFF".to_vec();
        out.extend_from_slice(&size.to_le_bytes());
        out.extend(self.body);
        Some(out)
    }
}

/// Adds a chunk, filled up to an even length.
fn chunk(out: &mut Vec<u8>, name: &[u8; 4], data: &[u8]) {
    out.extend_from_slice(name);
    out.extend_from_slice(&(data.len() as u32).to_le_bytes());
    out.extend_from_slice(data);
    if data.len() % 2 == 1 {
        out.push(0);
    }
}

fn u24(number: u32) -> [u8; 3] {
    let [a, b, c, _] = number.to_le_bytes();
    [a, b, c]
}
