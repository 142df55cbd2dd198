//! Contact sheets: frames of a film, small and side by side.

use crate::image::{Picture, Pixels};

/// Frames on a sheet, at most.
const MOST: u32 = 20;
/// Frames in a row.
const COLUMNS: u32 = 5;
/// Width of a small frame in pixels.
const THUMB_WIDTH: u32 = 192;
/// Pixels between two of them.
const GAP: u32 = 4;
/// What is seen between them.
const PAPER: u8 = 24;

/// Which of `n_frames` frames stand on the sheet: the first, the last, and others evenly between.
pub fn chosen(n_frames: u32) -> Vec<u32> {
    let n = n_frames.min(MOST);
    let last = n_frames.saturating_sub(1);
    (0..n)
        .map(|i| match n {
            1 => 0,
            _ => (u64::from(i) * u64::from(last) / u64::from(n - 1)) as u32,
        })
        .collect()
}

/// The sheet of these frames: each `width` × `height` pixels, 8-bit sRGB.
pub fn sheet(frames: &[Vec<u8>], width: u32, height: u32) -> Picture {
    let small_width = THUMB_WIDTH.min(width);
    let small_height = (height * small_width).div_ceil(width).max(1);
    let n = frames.len() as u32;
    let columns = n.clamp(1, COLUMNS);
    let rows = n.div_ceil(columns).max(1);
    let (sheet_width, sheet_height) = (
        columns * (small_width + GAP) + GAP,
        rows * (small_height + GAP) + GAP,
    );
    let mut pixels = vec![PAPER; (sheet_width * sheet_height * 3) as usize];
    for (i, frame) in (0..).zip(frames) {
        let (left, top) = (
            GAP + i % columns * (small_width + GAP),
            GAP + i / columns * (small_height + GAP),
        );
        for y in 0..small_height {
            for x in 0..small_width {
                let columns = x * width / small_width..((x + 1) * width).div_ceil(small_width);
                let rows = y * height / small_height..((y + 1) * height).div_ceil(small_height);
                let color = mean(frame, width, columns, rows);
                let at = 3 * ((top + y) * sheet_width + left + x) as usize;
                pixels[at..at + 3].copy_from_slice(&color);
            }
        }
    }
    Picture {
        width: sheet_width,
        height: sheet_height,
        pixels: Pixels::Srgb(pixels),
    }
}

/// The mean color of a part of a frame.
fn mean(
    frame: &[u8],
    width: u32,
    columns: std::ops::Range<u32>,
    rows: std::ops::Range<u32>,
) -> [u8; 3] {
    let mut sums = [0_u32; 3];
    let mut n = 0;
    for y in rows {
        for x in columns.clone() {
            let at = 3 * (y * width + x) as usize;
            for (sum, value) in sums
                .iter_mut()
                .zip(frame.get(at..at + 3).unwrap_or_default())
            {
                *sum += u32::from(*value);
            }
            n += 1;
        }
    }
    sums.map(|sum| (sum / n.max(1)) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_and_last_stand_on_the_sheet() {
        assert_eq!(chosen(3), [0, 1, 2]);
        assert_eq!((chosen(1), chosen(0)), (vec![0], vec![]));
        let many = chosen(1000);
        assert_eq!((many.len(), many[0], many[19]), (20, 0, 999));
    }

    #[test]
    fn frames_stand_side_by_side() {
        let frames: Vec<Vec<u8>> = (1..8).map(|i| vec![i * 30; 400 * 200 * 3]).collect();
        let sheet = sheet(&frames, 400, 200);
        assert_eq!((sheet.width, sheet.height), (5 * 196 + 4, 2 * 100 + 4));
        let Pixels::Srgb(pixels) = sheet.pixels else {
            panic!()
        };
        let at = |x: u32, y: u32| pixels[3 * (y * sheet.width + x) as usize];
        assert_eq!(
            (
                at(10, 10),
                at(4 * 196 + 10, 50),
                at(10, 150),
                at(196 + 10, 199)
            ),
            (30, 150, 180, 210)
        );
        assert_eq!((at(0, 0), at(3 * 196 + 10, 150)), (PAPER, PAPER));
    }
}
