//! Bits of H.264 units, which never hold three bytes that look like the start of another: an escape byte stands between.

/// Reads the bits of a unit.
#[derive(Clone, Debug)]
pub(super) struct BitReader {
    bytes: Vec<u8>,
    end: usize,
}

impl BitReader {
    /// The bits of a unit whose escape bytes are dropped.
    pub(super) fn without_escapes(unit: &[u8]) -> Self {
        let mut bytes: Vec<u8> = Vec::with_capacity(unit.len());
        let mut zeros = 0;
        for &byte in unit {
            if zeros >= 2 && byte == 3 {
                zeros = 0;
                continue;
            }
            zeros = if byte == 0 { zeros + 1 } else { 0 };
            bytes.push(byte);
        }
        let end = bytes.len() * 8;
        Self { bytes, end }
    }

    /// Drops the 1 that ends every unit, and the zeros after it.
    pub(super) fn drop_trailing(&mut self) {
        while self.end > 0 && !self.bit(self.end - 1) {
            self.end -= 1;
        }
        self.end = self.end.saturating_sub(1);
    }

    /// How many bits there are.
    pub(super) fn remaining(&self) -> usize {
        self.end
    }

    /// The first `n` bits.
    pub(super) fn bits(&self, n: usize) -> impl Iterator<Item = bool> + '_ {
        (0..n.min(self.end)).map(|i| self.bit(i))
    }

    fn bit(&self, i: usize) -> bool {
        self.bytes[i / 8] >> (7 - i % 8) & 1 == 1
    }
}

/// Writes the bits of a unit.
#[derive(Clone, Debug, Default)]
pub(super) struct BitWriter {
    bytes: Vec<u8>,
    n: usize,
}

impl BitWriter {
    /// Adds a bit.
    pub(super) fn bit(&mut self, bit: bool) {
        if self.n.is_multiple_of(8) {
            self.bytes.push(0);
        }
        if let Some(last) = self.bytes.last_mut() {
            *last |= u8::from(bit) << (7 - self.n % 8);
        }
        self.n += 1;
    }

    /// Adds the lowest `n` bits of a number, highest first.
    pub(super) fn bits(&mut self, number: u32, n: u32) {
        for i in (0..n).rev() {
            self.bit(number >> i & 1 == 1);
        }
    }

    /// The unit, with the 1 that ends it and with escape bytes.
    pub(super) fn finish_with_escapes(mut self) -> Vec<u8> {
        self.bit(true);
        let mut out = Vec::with_capacity(self.bytes.len() + 4);
        let mut zeros = 0;
        for byte in self.bytes {
            if zeros >= 2 && byte <= 3 {
                out.push(3);
                zeros = 0;
            }
            zeros = if byte == 0 { zeros + 1 } else { 0 };
            out.push(byte);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again_and_never_looks_like_a_start() {
        let numbers = [0, 0, 1, 0, 2, 0, 0, 3, 255];
        let mut writer = BitWriter::default();
        for number in numbers {
            writer.bits(number, 8);
        }
        let unit = writer.finish_with_escapes();
        assert!(
            unit.windows(3)
                .all(|w| !(w[0] == 0 && w[1] == 0 && w[2] < 3)),
            "{unit:?}"
        );
        let mut reader = BitReader::without_escapes(&unit);
        reader.drop_trailing();
        assert_eq!(reader.remaining(), 72);
        let bits: Vec<bool> = reader.bits(72).collect();
        let read = bits
            .chunks(8)
            .map(|b| b.iter().fold(0, |n, &bit| 2 * n + u32::from(bit)));
        assert!(read.eq(numbers));
    }
}
