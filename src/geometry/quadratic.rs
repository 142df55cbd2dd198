//! Roots of quadratic equations without cancellation.

/// The real roots of a·t² + 2·b·t + c, given `apart`, a quarter of the discriminant (b² - a·c) in a form that the caller
/// knows to be accurate where b² and a·c nearly cancel. The first root is not larger than the second; roots that do not
/// exist are NaN.
///
/// Where a·c is negative nothing cancels and b² - a·c itself is used: it cannot become negative, so a start inside a closed
/// body always finds the way out, however flat the ray. The root where -b and the square root would cancel is found from
/// the product of the roots instead, so its sign follows the sign of `c` reliably: a start outside a convex body stays
/// outside.
///
/// Source: [Haines2019](crate::references#haines2019).
#[inline]
#[must_use]
pub fn roots(a: f64, b: f64, c: f64, apart: f64) -> [f64; 2] {
    let discriminant = if a * c <= 0.0 { b * b - a * c } else { apart };
    if discriminant < 0.0 {
        return [f64::NAN; 2];
    }
    let q = -(b + discriminant.sqrt().copysign(b));
    let (first, second) = (q / a, c / q);
    if first > second {
        [second, first]
    } else {
        [first, second]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_keep_their_digits() {
        // t² - 2·10⁸·t + 1: the small root is 5e-9, which the schoolbook formula loses.
        let [small, large] = roots(1.0, -1e8, 1.0, 1e16 - 1.0);
        assert!((small - 5e-9).abs() < 1e-23 && (large - 2e8).abs() < 1e-6);
        assert!(roots(1.0, 0.0, 1.0, -1.0)[0].is_nan());
        assert_eq!(roots(1.0, 0.0, -4.0, 4.0), [-2.0, 2.0]);
    }

    #[test]
    fn a_start_inside_finds_the_way_out_whatever_became_of_the_discriminant() {
        let [back, ahead] = roots(1.9e-8, -9.1e-12, -2.0e-14, -1e-17);
        assert!(back < 0.0 && ahead > 0.0);
    }

    #[test]
    fn a_linear_equation_has_one_root() {
        let found = roots(0.0, 0.5, -3.0, 0.25);
        assert!(found.contains(&3.0), "{found:?}");
    }
}
