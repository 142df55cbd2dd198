//! Generalised cylinders: a flat section carried along a spine, as stems, petioles and roots are made.
//!
//! The section keeps at right angles to the spine and turns about it no more than it must (a rotation-minimising frame, found
//! by double reflection). On a closed spine what is missing to close the surface is spread over its length.
//! Source: [Wang2008](crate::references#wang2008).

use super::curve::Curve;
use super::tessellate::{Tolerance, grid};
use super::{CurvedError, Parametric};
use crate::geometry::{TriangleMesh, polygon};
use crate::math::functions::{atan2, cos, sin};
use crate::math::tolerance::{BESIDE, CREASE};
use glam::{DVec2, DVec3};

/// Frames kept per piece of the spine; between them one more reflection finds the frame.
const FRAMES: usize = 32;
/// Tests that cutting a section into triangles may take.
const CAP_TESTS: u64 = 1 << 26;

/// A section carried along a spine. u runs along the section, v along the spine; outside is the front if the section turns
/// from x through y.
#[derive(Clone, Debug)]
pub struct Sweep {
    spine: Curve,
    section: Curve,
    /// Its x is the scale of the section, over the spine's parameter.
    radius: Curve,
    frames: Vec<Frame>,
    /// By how much the section is turned about the spine until its end, radians, beyond what the spine turns it.
    twist: f64,
}

/// How the section stands at a place of the spine.
#[derive(Clone, Copy, Debug)]
struct Frame {
    t: f64,
    at: DVec3,
    head: DVec3,
    x: DVec3,
}

impl Sweep {
    /// Carries `section`, a curve in the plane of x and y, along `spine`, scaled by the x of `radius`, which runs over the
    /// same parameters. A scale below 0 counts as 0.
    ///
    /// # Errors
    /// If the spine is a point.
    pub fn new(spine: Curve, section: Curve, radius: Curve) -> Result<Self, CurvedError> {
        let mut sweep = Self {
            spine,
            section,
            radius,
            frames: vec![],
            twist: 0.0,
        };
        sweep.find_frames()?;
        Ok(sweep)
    }

    /// A round stem through these points, with a radius at each; the radius between them follows the same smooth curve.
    ///
    /// # Errors
    /// If there are fewer than two different points, or a number is not finite.
    pub fn stem(points: &[(DVec3, f64)]) -> Result<Self, CurvedError> {
        if !points
            .iter()
            .all(|(at, radius)| at.is_finite() && radius.is_finite())
        {
            return Err(CurvedError::NotFinite);
        }
        let mut points = points.to_vec();
        points.dedup_by_key(|(at, _)| *at);
        let places: Vec<DVec3> = points.iter().map(|(at, _)| *at).collect();
        let spine = Curve::through(&places)?;
        let radii: Vec<f64> = points.iter().map(|(_, radius)| *radius).collect();
        let radius = radius_over(&spine, &radii)?;
        Self::new(spine, Curve::circle(1.0)?, radius)
    }

    /// Whether the spine ends where it begins, in the direction it began with.
    fn is_ring(&self) -> bool {
        let [start, end] = self.spine.basis().range();
        let [from, to] = [start, end].map(|t| self.spine.at(t).1.normalize_or_zero());
        self.spine.is_closed() && from.dot(to) > 1.0 - CREASE
    }

    fn find_frames(&mut self) -> Result<(), CurvedError> {
        let breaks = self.spine.basis().breaks();
        let places = breaks.windows(2).flat_map(|piece| {
            let (from, to) = (piece[0], piece[1]);
            (0..FRAMES).map(move |i| from + (to - from) * (i as f64 / FRAMES as f64))
        });
        let places: Vec<f64> = places.chain(breaks.last().copied()).collect();
        // Where the spine stands still, the first direction it takes up afterwards.
        let heads = places.iter().map(|t| self.spine.at(*t).1.try_normalize());
        let Some(head) = heads.flatten().next() else {
            return Err(CurvedError::Points("its spine is a point".to_owned()));
        };
        let first = places.first().copied().unwrap_or_default();
        let mut frame = Frame {
            t: first,
            at: self.spine.at(first).0,
            head,
            x: first_axis(head),
        };
        for t in places {
            frame = self.carried(&frame, t);
            self.frames.push(frame);
        }
        if self.is_ring() {
            let start = self.frames[0].x;
            self.twist = atan2(start.dot(frame.head.cross(frame.x)), start.dot(frame.x));
        }
        Ok(())
    }

    /// The frame at `t`, of one before it, by reflecting it twice ([Wang2008](crate::references#wang2008) §3).
    fn carried(&self, from: &Frame, t: f64) -> Frame {
        let (at, slope) = self.spine.at(t);
        let head = slope.try_normalize().unwrap_or(from.head);
        let reflected = |v: DVec3, mirror: DVec3| {
            let size = mirror.length_squared();
            if size > 0.0 {
                v - mirror * (2.0 * v.dot(mirror) / size)
            } else {
                v
            }
        };
        let first = at - from.at;
        let (x, turned) = (reflected(from.x, first), reflected(from.head, first));
        let x = reflected(x, head - turned);
        let x = (x - head * x.dot(head)).try_normalize().unwrap_or(from.x);
        Frame { t, at, head, x }
    }

    /// The middle, the axes of the section and its scale at `t`.
    fn stand(&self, t: f64) -> (DVec3, [DVec3; 2], f64) {
        let [start, end] = self.spine.basis().range();
        let t = t.clamp(start, end);
        let next = self.frames.partition_point(|frame| frame.t <= t);
        let frame = self.carried(&self.frames[next.max(1) - 1], t);
        let y = frame.head.cross(frame.x);
        let turn = self.twist * (t - start) / (end - start);
        let axes = if turn == 0.0 {
            [frame.x, y]
        } else {
            let (sin, cos) = (sin(turn), cos(turn));
            [frame.x * cos + y * sin, y * cos - frame.x * sin]
        };
        (frame.at, axes, self.radius.at(t).0.x.max(0.0))
    }

    /// The triangles that stand for it, each end closed by a flat face if that is asked for, the section closes and has a
    /// size there.
    ///
    /// # Errors
    /// As [`tessellate`](super::tessellate()).
    pub fn closed(&self, error: Tolerance, caps: [bool; 2]) -> Result<TriangleMesh, CurvedError> {
        let mut side = grid(self, error)?;
        if self.section.is_closed() && !self.is_ring() {
            let [start, end] = self.spine.basis().range();
            let last_row = side.mesh.positions.len() - side.n_columns;
            for (at_end, t, first) in [(false, start, 0), (true, end, last_row)] {
                if caps[usize::from(at_end)] {
                    let rim = side.mesh.positions[first..first + side.n_columns].to_vec();
                    self.close(&mut side.mesh, rim, at_end, t);
                }
            }
        }
        Ok(side.mesh)
    }

    /// Adds the flat face at an end, with the very corners of the side.
    fn close(&self, mesh: &mut TriangleMesh, mut outline: Vec<DVec3>, at_end: bool, t: f64) {
        let (middle, [x, y], scale) = self.stand(t);
        outline.dedup();
        if outline.first() == outline.last() {
            outline.pop();
        }
        if outline.len() < 3 || scale == 0.0 {
            return;
        }
        // The base looks back along the spine: turned over, so that its outline runs the other way.
        if !at_end {
            outline.reverse();
        }
        let normal = x.cross(y) * if at_end { 1.0 } else { -1.0 };
        let flat: Vec<DVec2> = outline
            .iter()
            .map(|p| DVec2::new((*p - middle).dot(x), (*p - middle).dot(y)))
            .collect();
        let reach = flat
            .iter()
            .map(|p| p.abs().max_element())
            .fold(0.0, f64::max);
        let n = mesh.positions.len() as u32;
        let mut tests = CAP_TESTS;
        let triangles = &mut mesh.triangles;
        let cut = polygon::cut(&outline, &mut tests, |triangle| {
            triangles.push(triangle.map(|corner| corner as u32 + n));
        });
        if cut.is_err() {
            return;
        }
        mesh.normals
            .extend(std::iter::repeat_n(normal, outline.len()));
        let across = DVec2::new(1.0, if at_end { 1.0 } else { -1.0 });
        mesh.uvs.extend(
            flat.iter()
                .map(|p| *p * across / (2.0 * reach) + DVec2::splat(0.5)),
        );
        mesh.positions.append(&mut outline);
    }
}

/// Where x goes when z is turned to `head` by the shortest way; for a head that points down, x as far as it can stay.
fn first_axis(head: DVec3) -> DVec3 {
    if head.z > -0.5 {
        let share = head.x / (1.0 + head.z);
        return DVec3::new(1.0 - head.x * share, -head.y * share, -head.x);
    }
    let across = if head.x.abs() < 0.9 {
        DVec3::X
    } else {
        DVec3::Y
    };
    (across - head * across.dot(head)).normalize()
}

/// A curve whose x goes through these radii at the ends of the pieces of `spine`.
fn radius_over(spine: &Curve, radii: &[f64]) -> Result<Curve, CurvedError> {
    let ends = spine.basis().breaks();
    let rate = |i: usize| (radii[i + 1] - radii[i]) / (ends[i + 1] - ends[i]);
    let last = ends.len() - 1;
    // The tangents of a monotone cubic: where radii grow and shrink again, and never beyond the radii given.
    let slope = |i: usize| match i {
        0 => rate(0),
        _ if i == last => rate(last - 1),
        _ => {
            let (before, after) = (rate(i - 1), rate(i));
            if before * after <= 0.0 {
                0.0
            } else {
                2.0 * before * after / (before + after)
            }
        }
    };
    let plain = |x: f64| DVec3::X.extend(0.0) * x + glam::DVec4::W;
    let mut control = vec![plain(radii[0])];
    for i in 0..last {
        let third = (ends[i + 1] - ends[i]) / 3.0;
        control.push(plain(radii[i] + slope(i) * third));
        control.push(plain(radii[i + 1] - slope(i + 1) * third));
        control.push(plain(radii[i + 1]));
    }
    Curve::new(super::basis::Basis::pieces(3, &ends)?, control)
}

impl Parametric for Sweep {
    fn breaks(&self) -> [Vec<f64>; 2] {
        [self.section.basis().breaks(), self.spine.basis().breaks()]
    }

    fn point(&self, at: DVec2) -> DVec3 {
        let (middle, [x, y], scale) = self.stand(at.y);
        let on = self.section.at(at.x).0;
        middle + (x * on.x + y * on.y) * scale
    }

    fn tangents(&self, at: DVec2) -> [DVec3; 2] {
        let (_, [x, y], scale) = self.stand(at.y);
        let along = self.section.at(at.x).1;
        let [start, end] = self.spine.basis().range();
        let step = (end - start) * BESIDE;
        let [before, after] = [(at.y - step).max(start), (at.y + step).min(end)];
        let forward = self.point(DVec2::new(at.x, after)) - self.point(DVec2::new(at.x, before));
        [
            (x * along.x + y * along.y) * scale,
            forward / (after - before),
        ]
    }

    fn first_cuts(&self) -> [usize; 2] {
        [self.section.basis().degree(), self.spine.basis().degree()]
    }
}

#[cfg(test)]
mod tests {
    use super::super::tessellate::tests::{area, assert_watertight, volume};
    use super::*;
    use std::f64::consts::PI;

    fn ring(radius: f64, thickness: f64) -> Sweep {
        let one = Curve::through(&[DVec3::X * thickness, DVec3::new(thickness, 1.0, 0.0)]).unwrap();
        let constant = Curve::new(one.basis().clone(), vec![one.control()[0]; 4]).unwrap();
        Sweep::new(
            Curve::circle(radius).unwrap(),
            Curve::circle(1.0).unwrap(),
            constant,
        )
        .unwrap()
    }

    #[test]
    fn a_ring_has_the_area_and_volume_of_a_torus() {
        let mesh = ring(3.0, 0.5)
            .closed(Tolerance::Metres(1e-4), [true; 2])
            .unwrap();
        assert_watertight(&mesh);
        let (expected_area, expected_volume) = (4.0 * PI * PI * 1.5, 2.0 * PI * PI * 3.0 * 0.25);
        assert!(
            (area(&mesh) / expected_area - 1.0).abs() < 1e-3,
            "{}",
            area(&mesh)
        );
        assert!(
            (volume(&mesh) / expected_volume - 1.0).abs() < 1e-3,
            "{}",
            volume(&mesh)
        );
        for (at, normal) in mesh.positions.iter().zip(&mesh.normals) {
            let middle = at.truncate().normalize().extend(0.0) * 3.0;
            assert!(
                (*at - middle).normalize().dot(*normal) > 1.0 - 1e-6,
                "outside is the front"
            );
        }
    }

    #[test]
    fn a_straight_stem_is_a_cylinder_or_a_cone() {
        let base = DVec3::new(5.0, -2.0, 1.0);
        let top = base + DVec3::new(1.0, 2.0, 2.0);
        for (low, high, volume_per_pi) in [(0.5, 0.5, 0.75), (0.5, 0.0, 0.25), (0.0, 0.5, 0.25)] {
            let stem = Sweep::stem(&[(base, low), (top, high)]).unwrap();
            let mesh = stem.closed(Tolerance::Metres(1e-4), [true; 2]).unwrap();
            assert_watertight(&mesh);
            let expected = volume_per_pi * PI;
            assert!(
                (volume(&mesh) / expected - 1.0).abs() < 2e-3,
                "{low} {high}: {}",
                volume(&mesh)
            );
            let open = stem.closed(Tolerance::Metres(1e-4), [false; 2]).unwrap();
            let caps = area(&mesh) - area(&open);
            assert!(
                (caps - PI * (low * low + high * high)).abs() < 2e-3,
                "{caps}"
            );
        }
    }

    #[test]
    fn sections_turn_no_more_than_their_spine() {
        // Once round a helix: the frame keeps right angles and hardly turns from one place to the next.
        let helix: Vec<(DVec3, f64)> = (0..40)
            .map(|i| (f64::from(i) * 0.3, 0.1))
            .map(|(t, r)| (DVec3::new(t.cos(), t.sin(), t * 0.2), r))
            .collect();
        let sweep = Sweep::stem(&helix).unwrap();
        let [start, end] = sweep.spine.basis().range();
        let mut last: Option<[DVec3; 2]> = None;
        for i in 0..=4000 {
            let t = start + (end - start) * f64::from(i) / 4000.0;
            let (_, [x, y], radius) = sweep.stand(t);
            let head = sweep.spine.at(t).1.normalize();
            assert!(
                x.dot(head).abs() < 1e-12 && x.dot(y).abs() < 1e-12 && (radius - 0.1).abs() < 1e-12
            );
            if let Some([x0, y0]) = last {
                // The part of the turn that is about the spine itself.
                assert!((x - x0).dot(y0).abs() < 1e-5, "{i}: {}", (x - x0).dot(y0));
            }
            last = Some([x, y]);
        }
    }

    #[test]
    fn rings_in_space_close_smoothly() {
        // A spine that does not lie in a plane: the frame comes back turned, and is turned back on the way.
        let spine: Vec<DVec3> = (0..=24)
            .map(|i| f64::from(i % 24) * PI / 12.0)
            .map(|t| {
                DVec3::new(
                    3.0 * t.cos(),
                    3.0 * t.sin() + (3.0 * t).cos(),
                    (2.0 * t).sin(),
                )
            })
            .collect();
        let spine = Curve::through(&spine).unwrap();
        let section = Curve::polygon(0.4, 5).unwrap();
        let radius = radius_over(&spine, &[1.0; 25]).unwrap();
        let sweep = Sweep::new(spine, section, radius).unwrap();
        assert!(sweep.twist.abs() > 1e-3);
        let mesh = sweep.closed(Tolerance::USUAL, [true; 2]).unwrap();
        assert_watertight(&mesh);
    }

    #[test]
    fn radii_do_not_overshoot_and_impossible_stems_are_refused() {
        let stem = Sweep::stem(&[
            (DVec3::ZERO, 1.0),
            (DVec3::Z, 1.0),
            (DVec3::Z * 2.0, 0.0),
            (DVec3::Z * 3.0, 0.0),
        ])
        .unwrap();
        let [start, end] = stem.spine.basis().range();
        for i in 0..=300 {
            let (_, _, radius) = stem.stand(start + (end - start) * f64::from(i) / 300.0);
            assert!((0.0..=1.0 + 1e-12).contains(&radius), "{radius}");
        }
        assert!(Sweep::stem(&[(DVec3::ZERO, 1.0)]).is_err());
        assert!(Sweep::stem(&[(DVec3::ZERO, 1.0), (DVec3::ZERO, 2.0)]).is_err());
        assert!(Sweep::stem(&[(DVec3::ZERO, f64::NAN), (DVec3::Z, 2.0)]).is_err());
    }
}
