//! What photons are aimed at: the projection map.
//!
//! A source that shines everywhere wastes most photons on nothing. Those that can provably miss everything that is wanted are not
//! emitted: lines of parallel light that pass no target's box, directions from a lamp that lie in no target's cone. Jensen
//! ([`Jensen1996`](crate::references#jensen1996)) marks the cells of a bitmap round each lamp; boxes and cones do the same
//! without cells, so nothing thin falls between them, and every line or direction has a density in closed form, overlaps
//! included. Lines are even over the union of silhouettes, directions over the union of cones, up to how often these overlap.

use crate::math::frame::Frame;
use crate::math::functions::{asin, cos};
use crate::math::tolerance::TARGET_SLACK;
use crate::math::{Bounds3, warp};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Targets told apart; more are put together with their neighbours. Each photon asks all of them.
const MOST: usize = 32;

/// Something to aim at.
#[derive(Clone, Copy, Debug)]
struct Target {
    bounds: Bounds3,
    center: DVec3,
    radius: f64,
    /// How densely lines and directions are wanted here, relative to other targets.
    density: f64,
}

/// What photons are aimed at.
#[derive(Clone, Debug, Default)]
pub(super) struct Targets {
    targets: Vec<Target>,
    /// How many of them are what is wanted; the others surround it.
    n_wanted: usize,
    /// Whether something infinite is wanted, so that no direction from a lamp is in vain.
    is_boundless: bool,
}

/// A line of parallel light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// A point of it.
    pub(super) point: DVec3,
    /// 1 over the density of lines, m².
    pub(super) area: f64,
    /// How many times larger that is than of lines that pass what is wanted, if this one passes only what surrounds it; else 1.
    pub(super) strength: f64,
}

/// A direction from a lamp.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aimed {
    /// Unit vector.
    pub(super) direction: DVec3,
    /// 1 over the density of directions, sr.
    pub(super) solid_angle: f64,
}

/// How a target looks from a point.
#[derive(Clone, Copy, Debug)]
struct Cone {
    axis: DVec3,
    /// Half angle in radians; π from inside.
    half_angle: f64,
    solid_angle: f64,
}

impl Target {
    fn new(bounds: Bounds3, density: f64) -> Self {
        let slack = TARGET_SLACK * (bounds.min.abs().max(bounds.max.abs()).max_element());
        let slack = DVec3::splat(slack) + bounds.diagonal() * TARGET_SLACK;
        let bounds = Bounds3 {
            min: bounds.min - slack,
            max: bounds.max + slack,
        };
        Self {
            bounds,
            center: bounds.center(),
            radius: 0.5 * bounds.diagonal().length(),
            density,
        }
    }

    /// Areas, as seen along `d`, of the three faces that are seen.
    fn faces(&self, d: DVec3) -> DVec3 {
        let e = self.bounds.diagonal();
        DVec3::new(e.y * e.z, e.z * e.x, e.x * e.y) * d.abs()
    }

    /// Where a line along `d`, even over the silhouette, enters the box.
    fn entry(&self, d: DVec3, u: DVec2) -> DVec3 {
        // The visible faces tile the silhouette, and each is seen without distortion of areas.
        let faces = self.faces(d);
        let mut rest = u.x * faces.element_sum();
        let mut axis = 0;
        while axis < 2 && rest >= faces[axis] {
            rest -= faces[axis];
            axis += 1;
        }
        let first = if faces[axis] > 0.0 {
            (rest / faces[axis]).min(1.0)
        } else {
            0.5
        };
        let (low, e) = (self.bounds.min, self.bounds.diagonal());
        let mut point = low;
        point[axis] = if d[axis] > 0.0 {
            low[axis]
        } else {
            self.bounds.max[axis]
        };
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
        point[a] += first * e[a];
        point[b] += u.y * e[b];
        point
    }

    /// Whether the line through `point` along `d` passes the box.
    fn is_passed(&self, point: DVec3, d: DVec3) -> bool {
        let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let (low, high) = (
                self.bounds.min[axis] - point[axis],
                self.bounds.max[axis] - point[axis],
            );
            if d[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
                continue;
            }
            let (a, b) = (low / d[axis], high / d[axis]);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        near <= far
    }

    fn cone(&self, from: DVec3) -> Cone {
        let to = self.center - from;
        let distance = to.length();
        if distance <= self.radius {
            return Cone {
                axis: DVec3::Z,
                half_angle: PI,
                solid_angle: 4.0 * PI,
            };
        }
        let half_angle = asin(self.radius / distance);
        Cone {
            axis: to / distance,
            half_angle,
            solid_angle: warp::cone_solid_angle(half_angle),
        }
    }
}

impl Cone {
    fn holds(&self, w: DVec3) -> bool {
        self.half_angle >= PI || w.dot(self.axis) >= cos(self.half_angle)
    }
}

impl Targets {
    /// These boxes, all wanted alike.
    pub(super) fn new(boxes: &[Bounds3], is_boundless: bool) -> Self {
        let few = gathered(boxes.to_vec(), MOST);
        Self {
            n_wanted: few.len(),
            targets: few.into_iter().map(|b| Target::new(b, 1.0)).collect(),
            is_boundless,
        }
    }

    /// Adds a box that surrounds the others, in which lines are wanted `density` times as densely.
    pub(super) fn push(&mut self, bounds: Bounds3, density: f64) {
        self.targets.push(Target::new(bounds, density));
    }

    /// Whether no direction from a lamp is in vain.
    pub(super) fn is_boundless(&self) -> bool {
        self.is_boundless
    }

    /// A line along `d` (unit) that passes a target, from a point of the unit square. `None` if all are seen edge on.
    pub(super) fn line(&self, d: DVec3, u: DVec2) -> Option<Line> {
        let shares = self.targets.iter();
        let shares = shares.map(|target| target.density * target.faces(d).element_sum());
        let (chosen, x, total) = choose(shares, u.x)?;
        let point = self.targets[chosen].entry(d, DVec2::new(x, u.y));
        let (mut density, mut is_wanted) = (0.0, false);
        for (at, target) in self.targets.iter().enumerate() {
            if at == chosen || target.is_passed(point, d) {
                density += target.density;
                is_wanted |= at < self.n_wanted;
            }
        }
        let strength = if is_wanted {
            1.0
        } else {
            let around = self.targets[self.n_wanted..].iter();
            let around: f64 = around.map(|target| target.density).sum();
            (1.0 + around) / density
        };
        Some(Line {
            point,
            area: total / density,
            strength,
        })
    }

    /// A direction from a point towards a target, from a point of the unit square. `None` if there is no target.
    pub(super) fn direction(&self, from: DVec3, u: DVec2) -> Option<Aimed> {
        if self.is_boundless {
            return Some(Aimed {
                direction: warp::sphere(u),
                solid_angle: 4.0 * PI,
            });
        }
        let cones = || self.targets.iter().map(|target| target.cone(from));
        let shares = cones().map(|cone| cone.solid_angle);
        let (chosen, x, total) = choose(shares, u.x)?;
        let cone = self.targets[chosen].cone(from);
        let local = warp::cone(DVec2::new(x, u.y), cone.half_angle);
        let direction = Frame::from_normal(cone.axis).to_world(local).normalize();
        let holding = cones().enumerate();
        let holding = holding.filter(|(at, cone)| *at == chosen || cone.holds(direction));
        Some(Aimed {
            direction,
            solid_angle: total / holding.count() as f64,
        })
    }

    /// Solid angle of all cones together, overlaps counted more than once, sr.
    pub(super) fn solid_angle(&self, from: DVec3) -> f64 {
        if self.is_boundless {
            return 4.0 * PI;
        }
        let cones = self.targets.iter().map(|target| target.cone(from));
        cones.map(|cone| cone.solid_angle).sum()
    }
}

/// Chooses one in proportion to its share by a uniform number; gives its place, the number made uniform again, and the sum of all
/// shares. `None` if all are 0.
fn choose(shares: impl Iterator<Item = f64> + Clone, u: f64) -> Option<(usize, f64, f64)> {
    let total: f64 = shares.clone().sum();
    if !(total > 0.0 && total.is_finite()) {
        return None;
    }
    let mut rest = u * total;
    let mut chosen = None;
    for (at, share) in shares.enumerate().filter(|(_, share)| *share > 0.0) {
        chosen = Some((at, (rest / share).clamp(0.0, 1.0 - f64::EPSILON), total));
        if rest < share {
            break;
        }
        rest -= share;
    }
    chosen
}

/// At most `most` boxes (a power of two) that hold all of these: halves them by their centres until they are few.
fn gathered(mut boxes: Vec<Bounds3>, most: usize) -> Vec<Bounds3> {
    if boxes.len() <= most {
        return boxes;
    }
    if most <= 1 {
        return vec![boxes.iter().fold(Bounds3::EMPTY, |all, one| all.union(one))];
    }
    let centers = Bounds3::of(boxes.iter().map(Bounds3::center));
    let e = centers.diagonal();
    let axis = usize::from(e.y > e.x);
    let axis = if e.z > e[axis] { 2 } else { axis };
    boxes.sort_by(|a, b| a.center()[axis].total_cmp(&b.center()[axis]));
    let upper = boxes.split_off(boxes.len() / 2);
    let mut all = gathered(boxes, most / 2);
    all.extend(gathered(upper, most / 2));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(center: DVec3, half: f64) -> Bounds3 {
        Bounds3::of([center - half, center + half])
    }

    /// Mean of the area over many lines, of those with `keep`.
    fn area(targets: &Targets, d: DVec3, keep: impl Fn(DVec3) -> bool) -> f64 {
        let n = 300;
        let mut sum = 0.0;
        for i in 0..n * n {
            let u = DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
            let line = targets.line(d, u).unwrap();
            if keep(line.point) {
                sum += line.area;
            }
        }
        sum / f64::from(n * n)
    }

    #[test]
    fn lines_measure_the_silhouette_of_all_boxes_together() {
        // Two cubes side by side, seen along the row: one silhouette. Seen from aside: two. Overlapping: their union.
        let row = Targets::new(&[cube(DVec3::ZERO, 1.0), cube(DVec3::X * 5.0, 1.0)], false);
        assert!((area(&row, DVec3::X, |_| true) - 4.0).abs() < 0.01);
        assert!((area(&row, DVec3::Y, |_| true) - 8.0).abs() < 0.01);
        let both = Targets::new(&[cube(DVec3::ZERO, 1.0), cube(DVec3::X, 1.0)], false);
        assert!((area(&both, DVec3::NEG_Z, |_| true) - 6.0).abs() < 0.02);
        let d = DVec3::new(1.0, -2.0, 2.0) / 3.0;
        // The silhouette of a cube: the sum of the cosines times its face.
        let one = Targets::new(&[cube(DVec3::ONE, 0.5)], false);
        assert!((area(&one, d, |_| true) - 5.0 / 3.0).abs() < 0.01);
        assert!((area(&one, d, |p| p.x > 1.0) - area(&one, d, |p| p.x <= 1.0)).abs() > 0.1);
    }

    #[test]
    fn wanted_densities_change_the_lines_but_not_the_measure() {
        let mut rings = Targets::new(&[cube(DVec3::ZERO, 1.0)], true);
        rings.push(cube(DVec3::ZERO, 2.0), 0.25);
        let inside = |p: DVec3| p.x.abs() < 1.0 && p.y.abs() < 1.0;
        assert!((area(&rings, DVec3::NEG_Z, inside) - 4.0).abs() < 0.03);
        assert!((area(&rings, DVec3::NEG_Z, |_| true) - 16.0).abs() < 0.05);
    }

    #[test]
    fn directions_measure_the_cones() {
        // Two distant balls' cones, one behind the other partly: the union counts once.
        let targets = Targets::new(
            &[cube(DVec3::X * 10.0, 0.5), cube(DVec3::X * 20.0, 0.5)],
            false,
        );
        let cone = |distance: f64| {
            let sine: f64 = 0.75_f64.sqrt() / distance;
            warp::cone_solid_angle(sine.asin())
        };
        let n = 300;
        let mut sum = 0.0;
        for i in 0..n * n {
            let u = DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
            sum += targets.direction(DVec3::ZERO, u).unwrap().solid_angle;
        }
        let mean = sum / f64::from(n * n);
        assert!((mean / cone(10.0) - 1.0).abs() < 1e-3, "{mean}");
        assert!((targets.solid_angle(DVec3::ZERO) - cone(10.0) - cone(20.0)).abs() < 1e-8);
        let inside = targets
            .direction(DVec3::X * 10.1, DVec2::splat(0.3))
            .unwrap();
        assert!(inside.solid_angle > 4.0 * PI - 1e-9);
    }

    #[test]
    fn many_boxes_become_few_that_hold_them_all() {
        let boxes: Vec<Bounds3> = (0..1000)
            .map(|i| cube(DVec3::new(f64::from(i % 40), f64::from(i / 40), 0.0), 0.1))
            .collect();
        let few = gathered(boxes.clone(), MOST);
        assert_eq!(few.len(), MOST);
        for b in boxes {
            assert!(few.iter().any(|f| f.union(&b) == *f));
        }
        assert!(Targets::default().line(DVec3::Z, DVec2::ZERO).is_none());
        assert!(
            Targets::default()
                .direction(DVec3::ZERO, DVec2::ZERO)
                .is_none()
        );
    }

    #[test]
    fn flat_and_edge_on_targets() {
        let flat = Targets::new(
            &[Bounds3::of([DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)])],
            false,
        );
        assert!((area(&flat, DVec3::NEG_Z, |_| true) - 1.0).abs() < 1e-6);
        let edge = flat.line(DVec3::X, DVec2::splat(0.5)).unwrap();
        assert!(edge.area < 1e-6 && edge.point.is_finite());
    }
}
