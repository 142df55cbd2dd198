//! Random numbers as pure functions of counters: no state, no clock, no thread.
//!
//! Every number of a picture is a function of (seed, what it is for, which item, which dimension), so that it does not
//! depend on who asks for it or when.

/// Scrambles 64 bits so that every input bit reaches every output bit; a bijection.
///
/// The finalizer of `SplitMix64`, variant 13 of [Stafford2011](crate::references#stafford2011).
#[must_use]
pub const fn mix(mut x: u64) -> u64 {
    x ^= x >> 30;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^= x >> 27;
    x = x.wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// A 64-bit number that depends on every one of `keys` and on their order.
#[must_use]
pub fn hash(keys: &[u64]) -> u64 {
    keys.iter().fold(NO_KEYS, |state, key| hash_on(state, *key))
}

/// [`hash`] of no keys.
const NO_KEYS: u64 = 0x6A09_E667_F3BC_C908;

/// The [`hash`] of some keys and one more, given that of the others.
#[must_use]
pub const fn hash_on(others: u64, key: u64) -> u64 {
    // The odd constant is 2^64 / golden ratio: keys that count 0, 1, 2 … start far apart.
    mix(others
        .wrapping_add(key.wrapping_mul(0x9E37_79B9_7F4A_7C15))
        .wrapping_add(0x632B_E59B_D9B4_E019))
}

/// [`hash`] of one key.
#[must_use]
pub const fn hash_one(key: u64) -> u64 {
    hash_on(NO_KEYS, key)
}

/// The uniform number in [0, 1) made of the upper 53 bits.
#[must_use]
pub const fn unit_f64(bits: u64) -> f64 {
    const SCALE: f64 = 1.0 / (1_u64 << 53) as f64;
    (bits >> 11) as f64 * SCALE
}

/// The uniform number in [0, 1) with this 32-bit fraction.
#[must_use]
pub const fn unit_f64_from_u32(bits: u32) -> f64 {
    const SCALE: f64 = 1.0 / (1_u64 << 32) as f64;
    bits as f64 * SCALE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_and_number_of_keys_matter() {
        assert_ne!(hash(&[1, 2]), hash(&[2, 1]));
        assert_ne!(hash(&[0]), hash(&[0, 0]));
    }

    #[test]
    fn unit_numbers_stay_below_one() {
        assert!(unit_f64(u64::MAX) < 1.0);
        assert!(unit_f64_from_u32(u32::MAX) < 1.0);
        assert_eq!((unit_f64(0), unit_f64_from_u32(1 << 31)), (0.0, 0.5));
    }
}
