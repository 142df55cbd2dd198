//! Cutting polygons into triangles.
//!
//! A convex polygon becomes a fan. Any other loses one ear after the other: a corner whose triangle turns the right way and
//! holds no other corner. A polygon that cuts itself has no inside; what is left of it becomes a fan.

use glam::{DVec2, DVec3};

/// Corners of one polygon, at most.
const MOST_CORNERS: usize = 1 << 16;

/// Cuts the polygon with this outline; `push` gets the numbers of corners, in the polygon's own turn.
///
/// `tests` is how many tests of points it may still take.
pub(crate) fn cut(
    outline: &[DVec3],
    tests: &mut u64,
    mut push: impl FnMut([usize; 3]),
) -> Result<(), String> {
    let n = outline.len();
    if n > MOST_CORNERS {
        return Err(format!(
            "a polygon has {n} corners, more than {MOST_CORNERS}"
        ));
    }
    let flat = flattened(outline);
    if n <= 3 || is_convex(&flat) {
        (2..n).for_each(|i| push([0, i - 1, i]));
        return Ok(());
    }
    let mut left: Vec<usize> = (0..n).collect();
    let (mut at, mut misses) = (0, 0);
    while left.len() > 3 && misses < left.len() {
        let corner = |step: usize| left[(at + step) % left.len()];
        let ear = [corner(0), corner(1), corner(2)];
        *tests = tests
            .checked_sub(left.len() as u64)
            .ok_or("its polygons are too intricate to be cut into triangles")?;
        if is_ear(&flat, ear, &left) {
            push(ear);
            left.remove((at + 1) % left.len());
            misses = 0;
        } else {
            misses += 1;
        }
        at = (at + 1) % left.len();
    }
    (2..left.len()).for_each(|i| push([left[0], left[i - 1], left[i]]));
    Ok(())
}

/// The outline seen from the side it turns counter-clockwise on.
fn flattened(outline: &[DVec3]) -> Vec<DVec2> {
    // Newell's sum: twice the area, as a normal. Coordinates are taken from the first corner on, so that far ones keep digits.
    let from = outline.first().copied().unwrap_or_default();
    let next = outline.iter().cycle().skip(1);
    let normal: DVec3 = outline
        .iter()
        .zip(next)
        .map(|(a, b)| (*a - from).cross(*b - from))
        .sum();
    let normal = normal.try_normalize().unwrap_or(DVec3::Z);
    let (x, y) = normal.any_orthonormal_pair();
    let turn = if x.cross(y).dot(normal) < 0.0 {
        -1.0
    } else {
        1.0
    };
    outline
        .iter()
        .map(|p| DVec2::new((*p - from).dot(x), (*p - from).dot(y) * turn))
        .collect()
}

fn turn(flat: &[DVec2], [a, b, c]: [usize; 3]) -> f64 {
    (flat[b] - flat[a]).perp_dot(flat[c] - flat[b])
}

fn is_convex(flat: &[DVec2]) -> bool {
    let n = flat.len();
    let turns_left = (0..n).all(|i| turn(flat, [i, (i + 1) % n, (i + 2) % n]) >= 0.0);
    // A star turns left all the time, too, but more than once round.
    let up = |i: usize| flat[(i + 1) % n].y >= flat[i].y;
    turns_left && (0..n).filter(|&i| up(i) && !up((i + 1) % n)).count() <= 1
}

fn is_ear(flat: &[DVec2], ear: [usize; 3], left: &[usize]) -> bool {
    if turn(flat, ear) <= 0.0 {
        return false;
    }
    let corners = ear.map(|corner| flat[corner]);
    let holds = |p: DVec2| {
        (0..3).all(|i| {
            let (from, to) = (corners[i], corners[(i + 1) % 3]);
            (to - from).perp_dot(p - from) >= 0.0
        })
    };
    !left.iter().any(|&other| {
        let p = flat[other];
        !ear.contains(&other) && !corners.contains(&p) && holds(p)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(outline: &[DVec3]) -> (f64, usize, bool) {
        let (mut sum, mut n, mut all_left) = (0.0, 0, true);
        let whole: DVec3 = (2..outline.len())
            .map(|i| (outline[i - 1] - outline[0]).cross(outline[i] - outline[0]))
            .sum();
        cut(outline, &mut 1_000_000, |[a, b, c]| {
            let normal = (outline[b] - outline[a]).cross(outline[c] - outline[a]);
            all_left &= normal.dot(whole) >= 0.0;
            sum += normal.length() / 2.0;
            n += 1;
        })
        .unwrap();
        (sum, n, all_left)
    }

    #[test]
    fn concave_outlines_keep_their_area_and_their_turn() {
        let comb = [
            [0, 0],
            [5, 0],
            [5, 3],
            [4, 3],
            [4, 1],
            [3, 1],
            [3, 3],
            [2, 3],
            [2, 1],
            [1, 1],
            [1, 3],
            [0, 3],
        ];
        let slant = |[x, y]: [i32; 2]| {
            let (x, y) = (f64::from(x), f64::from(y));
            DVec3::new(x + 100.0, y * 0.6, y * 0.8)
        };
        let mut outline: Vec<DVec3> = comb.map(slant).to_vec();
        for _ in 0..2 {
            let (sum, n, all_left) = area(&outline);
            assert!((sum - 11.0).abs() < 1e-9 && all_left, "{sum}");
            assert_eq!(n, comb.len() - 2);
            outline.reverse();
        }
    }

    #[test]
    fn fans_degenerate_outlines_and_budgets() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y + DVec3::Z];
        assert_eq!(area(&square).1, 2);
        let needle = [
            DVec3::ZERO,
            DVec3::X,
            DVec3::X * 2.0,
            DVec3::X,
            DVec3::X * 0.5,
        ];
        assert_eq!(area(&needle).1, 3);
        let bow = [
            DVec3::ZERO,
            DVec3::new(1.0, 1.0, 0.0),
            DVec3::X,
            DVec3::Y,
            DVec3::new(0.5, 3.0, 0.0),
        ];
        assert_eq!(area(&bow).1, 3);
        let zigzag: Vec<DVec3> = (0..100)
            .map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0))
            .collect();
        assert!(cut(&zigzag, &mut 10, |_| ()).is_err());
        assert!(cut(&vec![DVec3::ZERO; MOST_CORNERS + 1], &mut (1 << 40), |_| ()).is_err());
    }
}
