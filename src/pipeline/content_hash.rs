//! Names for contents: equal contents have equal names, on every machine and in every version.

use std::fmt;

/// A 128-bit FNV-1a hash. Tells changed contents from equal ones; no protection against people who forge.
///
/// Source: [FNV](crate::references#fnv) (128-bit prime and offset basis).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ContentHash(u128);

impl ContentHash {
    const BASIS: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;

    /// The hash of several parts; where one ends and the next begins makes a difference.
    pub fn of<'a>(parts: impl IntoIterator<Item = &'a [u8]>) -> Self {
        let mut hash = Self::BASIS;
        for part in parts {
            let length = (part.len() as u64).to_le_bytes();
            for &byte in length.iter().chain(part) {
                hash = (hash ^ u128::from(byte)).wrapping_mul(Self::PRIME);
            }
        }
        Self(hash)
    }

    /// The hash as bytes.
    #[must_use]
    pub fn to_bytes(self) -> [u8; 16] {
        self.0.to_le_bytes()
    }

    /// The hash of this and a text.
    #[must_use]
    pub fn with(self, text: &str) -> Self {
        Self::of([&self.0.to_le_bytes()[..], text.as_bytes()])
    }
}

impl fmt::Display for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_their_borders_count() {
        let hash = |parts: &[&str]| ContentHash::of(parts.iter().map(|p| p.as_bytes()));
        assert_eq!(hash(&["ab", "c"]), hash(&["ab", "c"]));
        assert_ne!(hash(&["ab", "c"]), hash(&["a", "bc"]));
        assert_ne!(hash(&["a"]), hash(&["a"]).with(""));
        assert_eq!(hash(&[]).to_string(), "6c62272e07bb014262b821756295c58d");
    }
}
