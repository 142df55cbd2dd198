//! Colours a model can name: the 16 EGA indices of turtle commands and the constants of `java.awt.Color`.
//!
//! Channels are the palette's byte divided by 255, read as linear reflectance (see [`color`](super)).

use super::Rgb;

/// EGA palette of GroIMP's `RGBAShader.forEGAColor`, bytes red, green, blue.
const EGA: [[u8; 3]; 16] = [
    [0x00, 0x00, 0x00],
    [0x00, 0x00, 0xAA],
    [0x00, 0xAA, 0x00],
    [0x00, 0xAA, 0xAA],
    [0xAA, 0x00, 0x00],
    [0xAA, 0x00, 0xAA],
    [0xAA, 0x55, 0x00],
    [0xAA, 0xAA, 0xAA],
    [0x55, 0x55, 0x55],
    [0x55, 0x55, 0xFF],
    [0x55, 0xFF, 0x55],
    [0x55, 0xFF, 0xFF],
    [0xFF, 0x55, 0x55],
    [0xFF, 0x55, 0xFF],
    [0xFF, 0xFF, 0x55],
    [0xFF, 0xFF, 0xFF],
];

/// Constants of `java.awt.Color`, bytes red, green, blue.
const NAMED: [(&str, [u8; 3]); 13] = [
    ("BLACK", [0, 0, 0]),
    ("BLUE", [0, 0, 255]),
    ("CYAN", [0, 255, 255]),
    ("DARK_GRAY", [64, 64, 64]),
    ("GRAY", [128, 128, 128]),
    ("GREEN", [0, 255, 0]),
    ("LIGHT_GRAY", [192, 192, 192]),
    ("MAGENTA", [255, 0, 255]),
    ("ORANGE", [255, 200, 0]),
    ("PINK", [255, 175, 175]),
    ("RED", [255, 0, 0]),
    ("WHITE", [255, 255, 255]),
    ("YELLOW", [255, 255, 0]),
];

fn linear([r, g, b]: [u8; 3]) -> Rgb {
    Rgb::new(f64::from(r), f64::from(g), f64::from(b)) / 255.0
}

/// The EGA colour of a turtle colour index; only its low four bits count, as in GroIMP.
#[must_use]
pub fn ega(index: i32) -> Rgb {
    let [low, ..] = index.to_le_bytes();
    linear(EGA[usize::from(low & 15)])
}

/// The `java.awt.Color` constant of this name (`"DARK_GRAY"`), if there is one.
#[must_use]
pub fn named(name: &str) -> Option<Rgb> {
    NAMED
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, bytes)| linear(*bytes))
}

/// The names [`named`] knows, in alphabetical order.
pub fn names() -> impl Iterator<Item = &'static str> {
    NAMED.iter().map(|(name, _)| *name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ega_indices_wrap_and_name_the_right_colours() {
        assert_eq!(ega(2), Rgb::new(0.0, 170.0 / 255.0, 0.0));
        assert_eq!(ega(14), Rgb::new(1.0, 1.0, 85.0 / 255.0));
        assert_eq!(ega(14 + 16), ega(14));
        assert_eq!(ega(-1), Rgb::WHITE);
    }

    #[test]
    fn names_are_java_awt() {
        assert_eq!(named("GREEN"), Some(Rgb::new(0.0, 1.0, 0.0)));
        assert_eq!(named("ORANGE"), Some(Rgb::new(1.0, 200.0 / 255.0, 0.0)));
        assert_eq!(named("green"), None);
        assert_eq!(names().count(), 13);
    }
}
