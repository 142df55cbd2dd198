//! Strings of the language: Java's, counted in UTF-16 units, stored as UTF-8.

use super::memory::Charge;

/// An immutable text.
#[derive(Debug, Default)]
pub struct Text {
    text: Box<str>,
    is_ascii: bool,
    _charge: Charge,
}

impl Text {
    /// A text that carries its share of the memory budget.
    pub fn new(text: impl Into<Box<str>>, charge: Charge) -> Self {
        let text = text.into();
        Self {
            is_ascii: text.is_ascii(),
            text,
            _charge: charge,
        }
    }

    /// The text itself.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// Number of UTF-16 units.
    pub fn len(&self) -> usize {
        if self.is_ascii {
            self.text.len()
        } else {
            self.text.encode_utf16().count()
        }
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.text.is_empty()
    }

    /// The UTF-16 unit at `index`.
    pub fn unit(&self, index: usize) -> Option<u16> {
        if self.is_ascii {
            return self.text.as_bytes().get(index).map(|&b| u16::from(b));
        }
        self.text.encode_utf16().nth(index)
    }

    /// The units `from..to`; `None` if that is no range within the text. Half a character outside the basic plane becomes
    /// U+FFFD.
    pub fn slice(&self, from: usize, to: usize) -> Option<String> {
        if from > to || to > self.len() {
            return None;
        }
        if self.is_ascii {
            return self.text.get(from..to).map(str::to_owned);
        }
        let units: Vec<u16> = self
            .text
            .encode_utf16()
            .skip(from)
            .take(to - from)
            .collect();
        Some(String::from_utf16_lossy(&units))
    }

    /// Where `part` first occurs at or after `from`, in units.
    pub fn find(&self, part: &str, from: usize) -> Option<usize> {
        let start = self.byte_of(from.min(self.len()));
        let at = start + self.text.get(start..)?.find(part)?;
        Some(self.unit_of(at))
    }

    /// Where `part` last occurs, in units.
    pub fn rfind(&self, part: &str) -> Option<usize> {
        Some(self.unit_of(self.text.rfind(part)?))
    }

    fn byte_of(&self, unit: usize) -> usize {
        if self.is_ascii {
            return unit;
        }
        let mut units = 0;
        let reached = self.text.char_indices().find(|(_, c)| {
            let is_there = units >= unit;
            units += c.len_utf16();
            is_there
        });
        reached.map_or(self.text.len(), |(at, _)| at)
    }

    fn unit_of(&self, byte: usize) -> usize {
        if self.is_ascii {
            byte
        } else {
            self.text[..byte].encode_utf16().count()
        }
    }
}

/// The character of a UTF-16 unit; U+FFFD for half a pair.
pub fn char_of(unit: u16) -> char {
    char::from_u32(u32::from(unit)).unwrap_or(char::REPLACEMENT_CHARACTER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_utf16_units() {
        let text = Text::new("aé𝄞b", Charge::none());
        assert_eq!(text.len(), 5);
        assert_eq!(text.unit(1), Some(0xe9));
        assert_eq!(text.unit(2), Some(0xd834));
        assert_eq!(text.slice(1, 4).as_deref(), Some("é𝄞"));
        assert_eq!(text.find("b", 0), Some(4));
        assert_eq!(text.find("a", 1), None);
        assert_eq!(text.rfind("b"), Some(4));
        assert_eq!(text.slice(3, 2), None);
        assert_eq!(Text::new("abc", Charge::none()).slice(1, 9), None);
    }
}
