//! Eight `f32` at once: with AVX2 where the processor has it, one after the other where not.
//!
//! The only file of the crate with `unsafe` code. Both ways give the same bits: every operation below is exactly one operation of
//! IEEE 754 per lane (nothing is contracted to fused multiply-adds), and `min` and `max` are the comparisons of the
//! instructions, written out. The tests below hold them beside each other.
//!
//! A processor is asked once per ray, in [`dispatch`]; everything from there down to a lane is inlined into one function
//! that is compiled for AVX2, so that no `-C target-cpu` is needed.
#![allow(
    unsafe_code,
    reason = "the intrinsics of a feature that is looked for at run time"
)]

/// Lanes of a vector.
pub const WIDTH: usize = 8;

/// Bytes that come from memory at once.
#[cfg(target_arch = "x86_64")]
const CACHE_LINE: usize = 64;

/// Eight `f32`.
pub trait Lanes: Copy {
    /// Reads eight numbers.
    fn load(from: &[f32; WIDTH]) -> Self;
    /// Eight times the same number.
    fn splat(x: f32) -> Self;
    /// The numbers.
    fn store(self) -> [f32; WIDTH];
    /// `self + other`.
    fn add(self, other: Self) -> Self;
    /// `self - other`.
    fn sub(self, other: Self) -> Self;
    /// `self · other`.
    fn mul(self, other: Self) -> Self;
    /// `self` where it is smaller, otherwise (also if one of them is NaN) `other`.
    fn min(self, other: Self) -> Self;
    /// `self` where it is larger, otherwise (also if one of them is NaN) `other`.
    fn max(self, other: Self) -> Self;
    /// Without sign.
    fn abs(self) -> Self;
    /// The other sign where that of `other` is minus.
    fn signed_by(self, other: Self) -> Self;
    /// Bit i is set if lane i is at most that of `other`; not if one of them is NaN.
    fn at_most(self, other: Self) -> u32;
    /// Asks for memory that will soon be wanted, without waiting for it. Changes no result.
    fn prefetch<T>(what: &T);
    /// The lanes of `other` where the highest bit of `flags` is set, those of `self` elsewhere.
    fn or_where(self, other: Self, flags: &[u32; WIDTH]) -> Self;
}

/// A computation that wants to run with the widest lanes there are.
///
/// Its `run` must be `#[inline(always)]`, and so must be every function below it that touches lanes; no closure may, nor
/// anything handed to `map` and its like. What is not inlined is compiled without AVX2 and calls a function per operation.
pub trait Kernel {
    /// What it results in.
    type Output;
    /// Does it.
    fn run<V: Lanes>(self) -> Self::Output;
}

/// Runs a computation with AVX2 if this processor has it. The result does not depend on that.
#[inline]
pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("bmi1") {
        // SAFETY: the processor has the features that the function is compiled for.
        return unsafe { avx2::run(kernel) };
    }
    kernel.run::<Scalar>()
}

/// One lane after the other.
#[derive(Clone, Copy)]
pub(super) struct Scalar([f32; WIDTH]);

impl Scalar {
    #[inline(always)]
    fn zip(self, other: Self, of: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|lane| of(self.0[lane], other.0[lane])))
    }
}

impl Lanes for Scalar {
    #[inline(always)]
    fn load(from: &[f32; WIDTH]) -> Self {
        Self(*from)
    }

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; WIDTH])
    }

    #[inline(always)]
    fn store(self) -> [f32; WIDTH] {
        self.0
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn signed_by(self, other: Self) -> Self {
        self.zip(other, |a, b| if b.is_sign_negative() { -a } else { a })
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> u32 {
        (0..WIDTH).fold(0, |bits, lane| {
            bits | u32::from(self.0[lane] <= other.0[lane]) << lane
        })
    }

    #[inline(always)]
    fn prefetch<T>(_: &T) {}

    #[inline(always)]
    fn or_where(self, other: Self, flags: &[u32; WIDTH]) -> Self {
        let pick = |lane: usize| {
            let is_set = flags[lane] >> 31 != 0;
            if is_set { other.0[lane] } else { self.0[lane] }
        };
        Self(std::array::from_fn(pick))
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{CACHE_LINE, Kernel, Lanes, WIDTH};
    use std::arch::x86_64::{
        __m256, _CMP_LE_OQ, _MM_HINT_T0, _mm_prefetch, _mm256_add_ps, _mm256_and_ps,
        _mm256_andnot_ps, _mm256_blendv_ps, _mm256_cmp_ps, _mm256_loadu_ps, _mm256_max_ps,
        _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_ps, _mm256_storeu_ps,
        _mm256_sub_ps, _mm256_xor_ps,
    };

    /// The computation, compiled for AVX2.
    #[target_feature(enable = "avx2,bmi1")]
    pub(super) fn run<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<Avx2>()
    }

    /// A register. Whoever makes one vouches for a processor with AVX2, as [`run`] does.
    #[derive(Clone, Copy)]
    pub(super) struct Avx2(__m256);

    impl Lanes for Avx2 {
        #[inline(always)]
        fn load(from: &[f32; WIDTH]) -> Self {
            // SAFETY: eight numbers are read from where eight are; AVX2 is there (see `Avx2`).
            Self(unsafe { _mm256_loadu_ps(from.as_ptr()) })
        }

        #[inline(always)]
        fn splat(x: f32) -> Self {
            // SAFETY: AVX2 is there (see `Avx2`).
            Self(unsafe { _mm256_set1_ps(x) })
        }

        #[inline(always)]
        fn store(self) -> [f32; WIDTH] {
            let mut to = [0.0; WIDTH];
            // SAFETY: eight numbers are written to where eight have room; AVX2 is there (see `Avx2`).
            unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) };
            to
        }

        #[inline(always)]
        fn add(self, other: Self) -> Self {
            // SAFETY: AVX2 is there (see `Avx2`).
            Self(unsafe { _mm256_add_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: AVX2 is there (see `Avx2`).
            Self(unsafe { _mm256_sub_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: AVX2 is there (see `Avx2`).
            Self(unsafe { _mm256_mul_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn min(self, other: Self) -> Self {
            // SAFETY: AVX2 is there (see `Avx2`).
            Self(unsafe { _mm256_min_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            // SAFETY: AVX2 is there (see `Avx2`).
            Self(unsafe { _mm256_max_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn abs(self) -> Self {
            // SAFETY: AVX2 is there (see `Avx2`).
            Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
        }

        #[inline(always)]
        fn signed_by(self, other: Self) -> Self {
            // SAFETY: AVX2 is there (see `Avx2`).
            Self(unsafe { _mm256_xor_ps(self.0, _mm256_and_ps(_mm256_set1_ps(-0.0), other.0)) })
        }

        #[inline(always)]
        fn at_most(self, other: Self) -> u32 {
            // SAFETY: AVX2 is there (see `Avx2`).
            let bits = unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) };
            bits as u32
        }

        #[inline(always)]
        fn prefetch<T>(what: &T) {
            let first: *const i8 = std::ptr::from_ref(what).cast();
            let mut at = 0;
            while at < size_of::<T>() {
                // SAFETY: the address is that of a byte of `what`, and nothing is read into the program.
                unsafe { _mm_prefetch::<_MM_HINT_T0>(first.add(at)) };
                at += CACHE_LINE;
            }
        }

        #[inline(always)]
        fn or_where(self, other: Self, flags: &[u32; WIDTH]) -> Self {
            // SAFETY: eight words are read from where eight are, of the size of `f32`; AVX2 is there (see `Avx2`).
            Self(unsafe {
                let flags = _mm256_loadu_ps(flags.as_ptr().cast());
                _mm256_blendv_ps(self.0, other.0, flags)
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All operations on all pairs of some awkward numbers, as bits.
    struct Everything;

    impl Kernel for Everything {
        type Output = Vec<u32>;

        #[inline(always)]
        fn run<V: Lanes>(self) -> Vec<u32> {
            let numbers = [
                0.0,
                -0.0,
                1.0,
                -1.5,
                f32::NAN,
                f32::INFINITY,
                f32::NEG_INFINITY,
                1e-42,
                -3e38,
                0.1,
                16_777_217.0,
                f32::MIN_POSITIVE,
            ];
            let flags = std::array::from_fn(|lane| (lane as u32 % 3) << 31 | 5);
            let mut bits = Vec::new();
            for first in 0..numbers.len() {
                for second in 0..numbers.len() {
                    let some = |from: usize, step: usize| {
                        std::array::from_fn(|lane| numbers[(from + lane * step) % numbers.len()])
                    };
                    let (a, b) = (V::load(&some(first, 1)), V::load(&some(second, 5)));
                    for result in [
                        a.add(b),
                        a.sub(b),
                        a.mul(b),
                        a.min(b),
                        a.max(b),
                        a.abs(),
                        a.signed_by(b),
                        a.or_where(b, &flags),
                        V::splat(numbers[first]),
                    ] {
                        // The bits of a NaN that an operation makes are nobody's business.
                        let known = |x: f32| if x.is_nan() { u32::MAX } else { x.to_bits() };
                        bits.extend(result.store().map(known));
                    }
                    bits.push(a.at_most(b));
                }
            }
            bits
        }
    }

    #[test]
    fn the_scalar_twin_gives_the_same_bits() {
        let scalar = Everything.run::<Scalar>();
        assert_eq!(dispatch(Everything), scalar);
        assert!(scalar.len() > 9000);
    }
}
