//! Irradiance and how it changes, from rays into the cells of a half-space.
//!
//! Source: [`WardHeckbert1992`](crate::references#wardheckbert1992). The half-space is cut into cells of equal projected solid
//! angle, `n_polar` rings of `n_turns` cells, one ray in each. The rotational gradient follows from where the light comes from; the
//! translational one from how far away the surfaces are whose edges lie between two cells: seen from a point that has moved,
//! the nearer of two surfaces has moved before the farther one.

use crate::color::Rgb;
use crate::integrator::viewer::Arriving;
use crate::math::frame::Frame;
use crate::math::functions::sin_cos;
use crate::sampler::{Sampler, SamplerKind, Use};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Least cosine that a ray counts with in the rotational gradient: the tangent of a level ray would make it the whole gradient.
const LEAST_COSINE: f64 = 0.05;

/// The cells of a half-space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hemisphere {
    frame: Frame,
    n_polar: u32,
    n_turns: u32,
}

/// What a gather has found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gathered {
    /// W/m² per channel.
    pub(super) irradiance: Rgb,
    /// Change of each channel per radian that the normal turns round an axis, W/m².
    pub(super) per_turn: [DVec3; 3],
    /// Change of each channel per metre along the surface, W/m³.
    pub(super) per_metre: [DVec3; 3],
    /// Harmonic mean of the distances of surfaces, metres; infinite where there are none.
    pub(super) distance: f64,
    /// Distance of the nearest that a ray met, metres.
    pub(super) nearest: f64,
}

/// What the ray of a cell has found.
struct Cell {
    arriving: Arriving,
    /// Its direction in the plane of the surface: as long as the sine of its angle to the normal.
    flat: DVec2,
}

impl Hemisphere {
    /// Cells for about so many rays, as wide as they are high.
    pub(super) fn new(normal: DVec3, n_rays: u32) -> Self {
        let n_polar = ((f64::from(n_rays) / PI).sqrt().round() as u32).max(1);
        Self {
            frame: Frame::from_normal(normal),
            n_polar,
            n_turns: (n_rays / n_polar).max(1),
        }
    }

    /// Directions through the middles of the cells.
    pub(super) fn middles(self) -> impl Iterator<Item = DVec3> {
        (0..self.n_polar * self.n_turns)
            .map(move |index| self.to_world(self.flat(index, DVec2::splat(0.5))))
    }

    /// Where over the unit disk a place in [0, 1)² of a cell lies.
    fn flat(&self, index: u32, u: DVec2) -> DVec2 {
        let (turn, polar) = (index / self.n_polar, index % self.n_polar);
        let sine = ((f64::from(polar) + u.x) / f64::from(self.n_polar)).sqrt();
        let angle = TAU * (f64::from(turn) + u.y) / f64::from(self.n_turns);
        let (sin, cos) = sin_cos(angle);
        DVec2::new(cos, sin) * sine
    }

    /// The direction over a point of the unit disk.
    fn to_world(self, flat: DVec2) -> DVec3 {
        let height = (1.0 - flat.length_squared()).max(0.0).sqrt();
        self.frame.to_world(flat.extend(height))
    }

    /// Asks for the light from one direction in each cell. Random numbers are those of `stream`; the one of vertex 0 for
    /// directions is used.
    pub(super) fn gather(
        &self,
        stream: u64,
        mut light: impl FnMut(DVec3, &mut Sampler) -> Arriving,
    ) -> Gathered {
        let n_cells = self.n_polar * self.n_turns;
        let cells: Vec<Cell> = (0..n_cells)
            .map(|index| {
                let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
                let flat = self.flat(index, sampler.point(Use::Direction));
                let wi = self.to_world(flat);
                Cell {
                    arriving: light(wi, &mut sampler),
                    flat,
                }
            })
            .collect();
        let share = PI / f64::from(n_cells);
        let sum: Rgb = cells.iter().map(|cell| cell.arriving.radiance).sum();
        let nearness: f64 = cells.iter().map(|cell| 1.0 / cell.arriving.distance).sum();
        let distances = cells.iter().map(|cell| cell.arriving.distance);
        Gathered {
            nearest: distances.fold(f64::INFINITY, f64::min),
            irradiance: sum * share,
            per_turn: self.per_turn(&cells),
            per_metre: self.per_metre(&cells),
            distance: f64::from(n_cells) / nearness,
        }
    }

    /// A world vector of each channel from vectors of the plane.
    fn of_channels(&self, sums: [DVec2; 3]) -> [DVec3; 3] {
        sums.map(|sum| self.frame.to_world(sum.extend(0.0)))
    }

    fn per_turn(&self, cells: &[Cell]) -> [DVec3; 3] {
        let mut sums = [DVec2::ZERO; 3];
        for cell in cells {
            let sine = cell.flat.length();
            let cosine = (1.0 - sine * sine).max(0.0).sqrt().max(LEAST_COSINE);
            // tan θ along the axis that turns the normal towards the cell.
            let weight = cell.flat.perp() * (PI / (cosine * cells.len() as f64));
            for (sum, light) in sums.iter_mut().zip(cell.arriving.radiance.to_array()) {
                *sum += weight * light;
            }
        }
        self.of_channels(sums)
    }

    fn per_metre(&self, cells: &[Cell]) -> [DVec3; 3] {
        let (n_polar, n_turns) = (self.n_polar as usize, self.n_turns as usize);
        let mut sums = [DVec2::ZERO; 3];
        let mut edge = |cell: &Cell, other: &Cell, weight: DVec2| {
            let (near, far) = (cell.arriving.distance, other.arriving.distance);
            let weight = weight / near.min(far);
            let change = cell.arriving.radiance - other.arriving.radiance;
            for (sum, light) in sums.iter_mut().zip(change.to_array()) {
                *sum += weight * light;
            }
        };
        let sine_of = |ring: usize| (ring as f64 / n_polar as f64).sqrt();
        for turn in 0..n_turns {
            let along = |turns: f64| {
                let (sin, cos) = sin_cos(TAU * turns / n_turns as f64);
                DVec2::new(cos, sin)
            };
            let middle = along(turn as f64 + 0.5);
            let across = along(turn as f64).perp();
            for polar in 0..n_polar {
                let at = turn * n_polar + polar;
                if polar > 0 {
                    // The edge to the ring above: an arc, seen under the cosine of its height.
                    let sine = sine_of(polar);
                    let weight = TAU / n_turns as f64 * sine * (1.0 - sine * sine);
                    edge(&cells[at], &cells[at - 1], middle * weight);
                }
                if n_turns > 1 {
                    // The edge to the cell before in the ring: part of a meridian.
                    let before = (turn + n_turns - 1) % n_turns * n_polar + polar;
                    let weight = sine_of(polar + 1) - sine_of(polar);
                    edge(&cells[at], &cells[before], across * weight);
                }
            }
        }
        self.of_channels(sums)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gathers at a point above the origin's plane, facing up, from a ceiling at height 1 whose radiance depends on the place.
    fn under_ceiling(at: DVec2, normal: DVec3, radiance: impl Fn(DVec2) -> f64) -> Gathered {
        Hemisphere::new(normal, 40_000).gather(7, |wi, _| {
            if wi.z <= 1e-9 {
                return Arriving {
                    radiance: Rgb::BLACK,
                    distance: f64::INFINITY,
                };
            }
            let distance = 1.0 / wi.z;
            let place = at + wi.truncate() * distance;
            Arriving {
                radiance: Rgb::splat(radiance(place)),
                distance,
            }
        })
    }

    #[test]
    fn even_light_has_irradiance_pi_and_no_gradient() {
        for n in [1, 2, 7, 64, 256] {
            let even = Hemisphere::new(DVec3::new(0.6, 0.0, 0.8), n).gather(1, |_, _| Arriving {
                radiance: Rgb::WHITE,
                distance: 2.0,
            });
            assert!((even.irradiance.g - PI).abs() < 1e-12);
            assert!((even.distance - 2.0).abs() < 1e-12);
            assert!(even.per_metre[0].length() < 1e-12);
        }
    }

    #[test]
    fn gradients_are_differences_of_irradiance() {
        // A bright half of the ceiling: what its edge gives to a point that moves, and to a normal that turns.
        let lit = |place: DVec2| if place.x > 0.3 { 1.0 } else { 0.0 };
        let here = under_ceiling(DVec2::ZERO, DVec3::Z, lit);
        let step = 0.1;
        let moved = |x: f64| under_ceiling(DVec2::X * x, DVec3::Z, lit).irradiance.g;
        let slope = (moved(step) - moved(-step)) / (2.0 * step);
        // A half-plane at height h and distance a: E = π/2 (1 - a / √(a² + h²)), whose slope is -π/2 h² / (a² + h²)^(3/2).
        let exact = PI / 2.0 / 1.09_f64.powf(1.5);
        assert!((slope / exact - 1.0).abs() < 0.02, "{slope} {exact}");
        let found = here.per_metre[1].x;
        assert!((found / exact - 1.0).abs() < 0.05, "{found} {exact}");
        assert!(here.per_metre[1].y.abs() < 0.05, "{:?}", here.per_metre);

        // Turning the normal round y by an angle moves it towards +x.
        let turned = |angle: f64| {
            let normal = DVec3::new(angle.sin(), 0.0, angle.cos());
            under_ceiling(DVec2::ZERO, normal, lit).irradiance.g
        };
        let slope = (turned(step) - turned(-step)) / (2.0 * step);
        // As it is used: change = (old normal × new normal) · gradient.
        let found = here.per_turn[1].dot(DVec3::Z.cross(DVec3::X));
        assert!((found / slope - 1.0).abs() < 0.05, "{found} {slope}");
    }
}
