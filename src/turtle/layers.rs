//! Layers: numbers of nodes by which they are shown or hidden (`setLayer`).
//!
//! As in GroIMP there are sixteen, all of them shown unless the user hides some. A hidden node is not drawn and a lamp in it
//! does not shine; what follows it stands where it would. Nodes with other layer numbers are always shown.

use std::fmt;
use std::str::FromStr;

/// How many layers can be hidden.
const N_LAYERS: i32 = 16;

/// A set of layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layers(u16);

impl Layers {
    /// Whether none is in it.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether this layer is in it; numbers that are no layer never are.
    #[must_use]
    pub fn contains(self, layer: i32) -> bool {
        (0..N_LAYERS).contains(&layer) && self.0 >> layer & 1 == 1
    }

    /// With this layer in it; unchanged for numbers that are no layer.
    #[must_use]
    pub fn with(self, layer: i32) -> Self {
        if (0..N_LAYERS).contains(&layer) {
            Self(self.0 | 1 << layer)
        } else {
            self
        }
    }

    /// Without this layer in it.
    #[must_use]
    pub fn without(self, layer: i32) -> Self {
        if self.contains(layer) {
            Self(self.0 & !(1 << layer))
        } else {
            self
        }
    }
}

impl FromStr for Layers {
    /// What is allowed.
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text.trim() == "none" {
            return Ok(Self::default());
        }
        let mut layers = Self::default();
        for number in text.split(',').map(str::trim) {
            let layer = number.parse().ok().filter(|n| (0..N_LAYERS).contains(n));
            let expected = "numbers of layers from 0 to 15 with commas between them, or `none`";
            layers = layers.with(layer.ok_or(expected)?);
        }
        Ok(layers)
    }
}

impl fmt::Display for Layers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers: Vec<String> = (0..N_LAYERS)
            .filter(|n| self.contains(*n))
            .map(|n| n.to_string())
            .collect();
        match &numbers[..] {
            [] => f.write_str("none"),
            numbers => f.write_str(&numbers.join(",")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_read_and_written() {
        let layers = " 15, 1".parse::<Layers>().unwrap();
        assert_eq!(layers.to_string(), "1,15");
        let shown: Vec<i32> = (-1..18).filter(|n| layers.contains(*n)).collect();
        assert_eq!(shown, [1, 15]);
        assert_eq!(layers.without(1).without(2).to_string(), "15");
        assert_eq!("none".parse(), Ok(Layers::default()));
        assert!("16".parse::<Layers>().unwrap_err().contains("0 to 15"));
        assert!("".parse::<Layers>().is_err());
    }
}
