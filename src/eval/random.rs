//! `java.util.Random`: the 48-bit linear congruential generator of every Java program, number for number.

use crate::math::functions::ln;

const MULTIPLIER: u64 = 0x5_DEEC_E66D;
const INCREMENT: u64 = 0xB;
const MASK: u64 = (1 << 48) - 1;

/// A generator and the spare normal deviate it may hold.
#[derive(Clone, Debug, PartialEq)]
pub struct JavaRandom {
    state: u64,
    spare: Option<f64>,
}

impl JavaRandom {
    /// `new Random(seed)`.
    pub fn new(seed: i64) -> Self {
        Self {
            state: (seed as u64 ^ MULTIPLIER) & MASK,
            spare: None,
        }
    }

    /// `setSeed(seed)`.
    pub fn set_seed(&mut self, seed: i64) {
        *self = Self::new(seed);
    }

    /// The generator after `n` more 32-bit draws, in O(log n); forgets the spare normal deviate.
    #[must_use]
    pub fn jumped(&self, mut n: u64) -> Self {
        // state·a + c composed with itself: (a, c)² = (a², a·c + c), modulo 2^48.
        let (mut state, mut a, mut c) = (self.state, MULTIPLIER, INCREMENT);
        while n > 0 {
            if n & 1 == 1 {
                state = state.wrapping_mul(a).wrapping_add(c) & MASK;
            }
            c = a.wrapping_mul(c).wrapping_add(c) & MASK;
            a = a.wrapping_mul(a) & MASK;
            n >>= 1;
        }
        Self { state, spare: None }
    }

    /// The next `bits` (1..=32) random bits as Java's protected `next` gives them.
    fn next(&mut self, bits: u32) -> i32 {
        self.state = self.state.wrapping_mul(MULTIPLIER).wrapping_add(INCREMENT) & MASK;
        (self.state >> (48 - bits)) as u32 as i32
    }

    /// Any `int`.
    pub fn next_int(&mut self) -> i32 {
        self.next(32)
    }

    /// An `int` in `0..bound`; `None` if `bound` is not positive.
    pub fn next_int_below(&mut self, bound: i32) -> Option<i32> {
        if bound <= 0 {
            return None;
        }
        let mut bits = self.next(31);
        if bound & (bound - 1) == 0 {
            return Some(((i64::from(bound) * i64::from(bits)) >> 31) as i32);
        }
        // Reject the incomplete last interval so that all values are equally likely.
        loop {
            let value = bits % bound;
            if bits.wrapping_sub(value).wrapping_add(bound - 1) >= 0 {
                return Some(value);
            }
            bits = self.next(31);
        }
    }

    /// Any `long`.
    pub fn next_long(&mut self) -> i64 {
        let high = i64::from(self.next(32));
        (high << 32).wrapping_add(i64::from(self.next(32)))
    }

    /// A fair coin.
    pub fn next_boolean(&mut self) -> bool {
        self.next(1) != 0
    }

    /// A `float` in `0..1`, a multiple of 2^-24.
    pub fn next_float(&mut self) -> f32 {
        self.next(24) as f32 / (1 << 24) as f32
    }

    /// A `double` in `0..1`, a multiple of 2^-53.
    pub fn next_double(&mut self) -> f64 {
        let high = i64::from(self.next(26)) << 27;
        (high + i64::from(self.next(27))) as f64 / (1_i64 << 53) as f64
    }

    /// A standard normal deviate by the polar method; every second one is kept from the draw before.
    pub fn next_gaussian(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let x = 2.0 * self.next_double() - 1.0;
            let y = 2.0 * self.next_double() - 1.0;
            let s = x * x + y * y;
            if s < 1.0 && s != 0.0 {
                let factor = (-2.0 * ln(s) / s).sqrt();
                self.spare = Some(y * factor);
                return x * factor;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seed_42_draws_what_java_draws() {
        let mut r = JavaRandom::new(42);
        let ints: Vec<i32> = (0..4).map(|_| r.next_int_below(10).unwrap()).collect();
        assert_eq!(ints, [0, 3, 8, 4]);
        r.set_seed(42);
        let powers: Vec<i32> = (0..6).map(|_| r.next_int_below(8).unwrap()).collect();
        assert_eq!(powers, [5, 0, 5, 0, 2, 7]);
        r.set_seed(42);
        assert_eq!(r.next_float(), 0.727_563_7);
        r.set_seed(42);
        let normal: Vec<f64> = (0..4).map(|_| r.next_gaussian()).collect();
        assert_eq!(
            normal,
            [
                1.141_905_315_473_054_7,
                0.919_407_948_982_787_9,
                -0.949_866_636_890_895_9,
                -1.106_990_286_399_337_7
            ]
        );
    }

    #[test]
    fn a_jump_equals_as_many_draws() {
        for n in [0, 1, 2, 3, 17, 1000] {
            let mut walked = JavaRandom::new(7);
            for _ in 0..n {
                walked.next_int();
            }
            assert_eq!(JavaRandom::new(7).jumped(n), walked);
        }
    }

    #[test]
    fn a_bound_that_is_not_positive_is_refused() {
        assert_eq!(JavaRandom::new(1).next_int_below(0), None);
        assert_eq!(JavaRandom::new(1).next_int_below(-3), None);
    }
}
