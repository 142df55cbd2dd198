//! Irradiance from stored photons: their power within a small disk of surface, over the area of surface that is really there.
//!
//! The sum over the photons near a point, weighted by a kernel that falls from 1 in the middle to 0 at the radius r (Epanechnikov's,
//! 1 - d²/r²), is divided by the same sum over the surface itself. A photon counts if it lies near the tangent plane, with a
//! similar normal, on the same side; the surface is measured with exactly these tests, by rays from above the point to the cells
//! of a disk. So edges and corners are not darker than they are, walls do not leak into floors, and where other things stand on
//! the surface the part behind them counts neither as area nor as light
//! ([`HeyPurgathofer2002`](crate::references#heypurgathofer2002) take the area from the geometry instead).
//!
//! How large the kernel may be is told by the photons in it ([`Estimate::is_even`]): the light inside may differ from that outside by
//! no more than chance makes it, nor its middle lie aside.
//!
//! Of a piece smaller than the kernel the whole is taken ([`pieces`](super::pieces)): all its photons of one side over its area.

use super::stored::Stored;
use crate::color::Rgb;
use crate::integrator::carrier::facing;
use crate::integrator::grid::Grid;
use crate::math::Ray;
use crate::math::frame::Frame;
use crate::math::functions::{atan2, cos, sin};
use crate::scene::Scene;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// How far from the tangent plane photons and surface may be, in radii: as far as a body falls off within the kernel that
/// [`Piece::Body`](crate::scene::Piece) allows.
const THICKNESS: f64 = 0.15;

/// Least cosine between normals.
const SAME_NORMAL: f64 = 0.9;

/// Cosine between normals above which a surface is as good as flat: areas are then right to 10⁻⁴.
const FLAT_NORMAL: f64 = 0.9999;

/// Rings of the disk that measures the surface; ring i has 3 (2 i + 1) cells, all of the same area: 3 n² in n rings.
const RINGS: usize = 3;

/// Rings where not all of the disk is surface that can be seen.
const FINE_RINGS: usize = 6;

/// How high above the surface its measuring starts, in radii; less where something is above.
const LIFT: f64 = 0.5;

/// How high looking up for that starts, in radii: photons are stored with 24 bits per coordinate.
const NEAR: f64 = 0.02;

/// Rings of the disk whose light is compared: what is fine beside the kernel shows in the inmost of them, what is coarse in all.
const COMPARED: usize = 3;

/// How many standard deviations light inside and outside of each border may differ. The bias that goes with such a difference beyond the
/// outer one costs more than the noise of a kernel of half the radius from 1.5 on; tests of even light fail by chance at 2.5 once in a
/// hundred. Few photons lie within the inner border: what its test lets halve by chance is noisy by just that chance, so it is rarer, once in
/// two thousand.
const TELLING: [f64; COMPARED - 1] = [3.5, 2.5];

/// How far aside the middle of the light may lie, in radii: that of an edge lies at 0.34, that of a linear fall to 0 at 0.17.
const ASIDE: f64 = 0.2;

/// The least share of the disk that must be surface inside and outside for a comparison: half of the inmost ring.
const COMPARABLE: f64 = 0.05;

/// The surface round a point, as the cells of the disk see it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Measured {
    /// ∫ of the kernel over the surface that is there, m².
    kernel_area: f64,
    /// The same, times the place in radii.
    moment: DVec2,
    /// Area of the surface in each of the compared rings, m².
    areas: [f64; COMPARED],
    hidden: Hidden,
}

impl Measured {
    /// The cells that something stands before.
    pub(super) fn hidden(&self) -> Hidden {
        self.hidden
    }
}

/// The light round a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate {
    /// W/m².
    pub(super) irradiance: Rgb,
    /// Photons of equal power that would be as noisy.
    pub(super) photons: f64,
    /// Whether the light is as even as such photons can tell: a smaller kernel would show more noise and hardly more light.
    pub(super) is_even: bool,
}

/// A place on a surface, relative to the middle of the scene, and its side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
}

/// The cells of the fine disk round a point that something stands before: a bit for each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Hidden(u128);

impl Hidden {
    /// The cells as bits.
    pub(super) fn bits(self) -> u128 {
        self.0
    }

    /// The cells of these bits; `None` if there are no such cells.
    pub(super) fn from_bits(bits: u128) -> Option<Self> {
        (bits >> (3 * FINE_RINGS * FINE_RINGS) == 0).then_some(Self(bits))
    }

    /// Whether none is.
    pub(super) fn is_none(self) -> bool {
        self.0 == 0
    }

    /// Whether the point `flat` of the unit disk is.
    pub(super) fn holds(self, flat: DVec2) -> bool {
        self.0 != 0 && self.0 >> cell_of(flat) & 1 == 1
    }
}

/// The light on a side of the surface at a place round which the surface was [`measure`]d. Photons that lie so far from it as
/// `is_hidden` says do not count.
///
/// The photon whose place is sampled counts too. Of independent photons that would be 2 too many in n (twice the kernel's mean);
/// but photons are spread evenly, and leaving it out was measured to be 8 % too dark where 22 photons are in the kernel, counting it 1 %
/// too bright.
pub(super) fn estimate(
    photons: &Grid<Stored>,
    spot: Spot,
    radius: f64,
    measured: &Measured,
    is_hidden: impl Fn(DVec3) -> bool,
) -> Estimate {
    let frame = Frame::from_normal(spot.normal);
    let mut flux = Rgb::BLACK;
    let (mut powers, mut squares) = ([0.0; COMPARED], 0.0);
    let (mut weights, mut moment) = (0.0, DVec2::ZERO);
    let thickness = THICKNESS * radius;
    photons.near_plane(spot.position, spot.normal, thickness, |photon| {
        let to = photon.position() - spot.position;
        let share = to.length_squared() / (radius * radius);
        if share >= 1.0 || photon.normal().dot(spot.normal) <= SAME_NORMAL {
            return;
        }
        let local = frame.to_local(to) / radius;
        let flat = local.truncate();
        if local.z.abs() > THICKNESS || measured.hidden.holds(flat) || is_hidden(to) {
            return;
        }
        let power = photon.power();
        flux += power * (1.0 - share);
        let power = power.sum();
        powers[ring_of(share)] += power;
        squares += power * power;
        weights += power * (1.0 - share);
        moment += flat * (power * (1.0 - share));
    });
    if !(measured.kernel_area > 0.0 && squares > 0.0) {
        return Estimate {
            irradiance: Rgb::BLACK,
            photons: 0.0,
            is_even: true,
        };
    }
    let power = powers.iter().sum::<f64>();
    let n = power * power / squares;
    let aside = moment / weights - measured.moment / measured.kernel_area;
    Estimate {
        irradiance: flux / measured.kernel_area,
        photons: n,
        is_even: aside.length() <= ASIDE && is_same_inside(powers, measured.areas, n, radius),
    }
}

/// The compared ring of a point of the unit disk, by its squared distance from the middle.
fn ring_of(square: f64) -> usize {
    const BORDER: f64 = 1.0 / (COMPARED * COMPARED) as f64;
    (1..COMPARED)
        .filter(|ring| square >= (ring * ring) as f64 * BORDER)
        .count()
}

/// Whether the light within each border of rings is that beyond, as far as `n` photons can tell.
fn is_same_inside(powers: [f64; COMPARED], areas: [f64; COMPARED], n: f64, radius: f64) -> bool {
    let disk = PI * radius * radius;
    let (power, area) = (powers.iter().sum::<f64>(), areas.iter().sum::<f64>());
    TELLING.iter().zip(1..).all(|(telling, border)| {
        let inside = |of: &[f64]| of[..border].iter().sum::<f64>();
        let (inner, within) = (inside(&areas), inside(&powers));
        let (outer, beyond) = (area - inner, power - within);
        if inner.min(outer) < COMPARABLE * disk {
            return true;
        }
        let difference = (within / inner - beyond / outer).abs() * area / power;
        let variance = (area / inner + area / outer) / n;
        difference <= telling * variance.sqrt()
    })
}

/// The cell of a point of the unit disk, of the fine ones.
fn cell_of(flat: DVec2) -> usize {
    let ring = ((flat.length() * FINE_RINGS as f64) as usize).min(FINE_RINGS - 1);
    let sectors = 3 * (2 * ring + 1);
    let turn = (atan2(flat.y, flat.x) / TAU).rem_euclid(1.0);
    3 * ring * ring + ((turn * sectors as f64) as usize).min(sectors - 1)
}

/// Measures the surface round a point of the world, on one side, by rays.
pub(super) fn measure(scene: &Scene, at: DVec3, normal: DVec3, radius: f64) -> Measured {
    let frame = &Frame::from_normal(normal);
    // Rise as far as nothing is in the way.
    let up = Ray::new(at + normal * (NEAR * radius), normal).until(2.0 * LIFT * radius);
    let free = scene.closest(&up).map_or(f64::INFINITY, |hit| hit.t);
    let height = NEAR * radius + (0.5 * free).min(LIFT * radius);
    let eye = at + normal * height;
    let coarse = measure_in(scene, at, eye, frame, radius, RINGS);
    coarse.unwrap_or_else(|_| {
        let fine = measure_in(scene, at, eye, frame, radius, FINE_RINGS);
        fine.unwrap_or_else(|partial| partial)
    })
}

/// The surface round a point, seen from `eye` in the cells of so many rings; `Err` with what there is if that is not surface
/// everywhere.
fn measure_in(
    scene: &Scene,
    at: DVec3,
    eye: DVec3,
    frame: &Frame,
    radius: f64,
    rings: usize,
) -> Result<Measured, Measured> {
    let normal = frame.normal;
    let cell_area = PI * radius * radius / (3 * rings * rings) as f64;
    let mut measured = Measured::default();
    let mut is_whole = true;
    for ring in 0..rings {
        let sectors = 3 * (2 * ring + 1);
        // The kernel's mean over the ring: it is linear in d².
        let squares = (ring * ring + (ring + 1) * (ring + 1)) as f64;
        let kernel = 1.0 - 0.5 * squares / (rings * rings) as f64;
        let distance = (0.5 * squares).sqrt() / rings as f64;
        for sector in 0..sectors {
            let angle = TAU * (sector as f64 + 0.5) / sectors as f64;
            let flat = DVec2::new(cos(angle), sin(angle)) * distance;
            let target = at + frame.to_world(flat.extend(0.0)) * radius;
            match look(scene, eye, target, at, normal, radius) {
                Seen::Surface(stretch) => {
                    let area = cell_area * stretch;
                    measured.kernel_area += kernel * area;
                    measured.moment += flat * (kernel * area);
                    measured.areas[ring * COMPARED / rings] += area;
                }
                Seen::Nothing => is_whole = false,
                Seen::Obstacle => {
                    is_whole = false;
                    measured.hidden.0 |= 1 << (3 * ring * ring + sector);
                }
            }
        }
    }
    if is_whole {
        Ok(measured)
    } else {
        Err(measured)
    }
}

/// What is seen of a cell.
enum Seen {
    /// The surface, this much larger than the cell.
    Surface(f64),
    /// No surface there.
    Nothing,
    /// Something before it.
    Obstacle,
}

/// What of a curved surface lies straight over or under a cell.
fn over(scene: &Scene, target: DVec3, normal: DVec3, radius: f64) -> Seen {
    let thickness = THICKNESS * radius;
    let ray = Ray::new(target + normal * thickness, -normal).until(2.0 * thickness);
    let Some(hit) = scene.closest(&ray) else {
        return Seen::Nothing;
    };
    let cosine = facing(scene.surface(&ray, &hit).normal_g, normal).dot(normal);
    if cosine > SAME_NORMAL {
        Seen::Surface(1.0 / cosine)
    } else {
        Seen::Nothing
    }
}

fn look(scene: &Scene, eye: DVec3, target: DVec3, at: DVec3, normal: DVec3, radius: f64) -> Seen {
    let to = target - eye;
    let distance = to.length();
    let Some(direction) = to.try_normalize() else {
        return Seen::Nothing;
    };
    let ray = Ray::new(eye, direction).until(1.5 * distance);
    let mut next = scene.closest(&ray);
    while let Some(hit) = next {
        let point = scene.surface(&ray, &hit);
        let off = (point.position - at).dot(normal);
        if off.abs() <= THICKNESS * radius {
            let facing = facing(point.normal_g, -direction);
            if facing.dot(normal) > SAME_NORMAL {
                // Where the surface is curved the ray meets it beside the cell.
                return if facing.dot(normal) > FLAT_NORMAL {
                    Seen::Surface(1.0)
                } else {
                    over(scene, target, normal, radius)
                };
            }
            // The edge of something else: a wall's foot, the side of a step.
            return if off > 0.0 {
                Seen::Obstacle
            } else {
                over(scene, target, normal, radius)
            };
        }
        if off < 0.0 {
            break;
        }
        if scene.optics(&point).is_opaque() {
            return Seen::Obstacle;
        }
        next = scene.closest_after(&ray, &hit);
    }
    // Past the cell: over the edge, or where the surface turns away.
    over(scene, target, normal, radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;
    use crate::material::Material;
    use crate::scene::description::{
        Group, GroupId, MaterialId, OrganId, PlacedShape, SceneDescription,
    };
    use glam::DAffine3;

    const RADIUS: f64 = 0.1;

    /// A square round the origin with this half edge, front up, and perhaps a wall that stands on it at x = 0.05.
    fn floor(half: f64, wall: bool) -> Scene {
        let placed = |shape, to_group| PlacedShape {
            shape,
            to_group,
            material: MaterialId(0),
            organ: OrganId(0),
        };
        let square = Shape::Parallelogram {
            corner: DVec3::new(-half, -half, 0.0),
            edge_u: DVec3::X * (2.0 * half),
            edge_v: DVec3::Y * (2.0 * half),
        };
        let upright = Shape::Parallelogram {
            corner: DVec3::new(0.05, -half, 0.0),
            edge_u: DVec3::Y * (2.0 * half),
            edge_v: DVec3::Z,
        };
        let mut shapes = vec![placed(square, DAffine3::IDENTITY)];
        if wall {
            shapes.push(placed(upright, DAffine3::IDENTITY));
        }
        Scene::build(SceneDescription {
            materials: vec![Material::default()],
            groups: vec![Group {
                shapes,
                instances: vec![],
            }],
            root: Some(GroupId(0)),
            ..SceneDescription::default()
        })
        .unwrap()
    }

    /// Photons on a fine lattice over the square of half edge 0.3 that carry the flux of an irradiance.
    fn lattice(irradiance: impl Fn(f64, f64) -> f64) -> Vec<Stored> {
        let n = 600;
        let step = 0.6 / f64::from(n);
        let at = |i: i32| (f64::from(i) + 0.5) * step - 0.3;
        let photon = |i: i32| {
            let (x, y) = (at(i % n), at(i / n));
            Stored::at(
                DVec3::new(x, y, 0.0),
                DVec3::Z,
                irradiance(x, y) * step * step,
            )
        };
        (0..n * n).map(photon).collect()
    }

    fn at(scene: &Scene, photons: Vec<Stored>, place: DVec3, radius: f64) -> f64 {
        let grid = Grid::new(photons, radius, Stored::position);
        found(scene, &grid, (place, DVec3::Z), radius).irradiance.g
    }

    fn found(
        scene: &Scene,
        grid: &Grid<Stored>,
        (position, normal): (DVec3, DVec3),
        radius: f64,
    ) -> Estimate {
        let measured = measure(scene, position, normal, radius);
        estimate(grid, Spot { position, normal }, radius, &measured, |_| {
            false
        })
    }

    #[test]
    fn even_light_is_told_from_spots_lines_and_edges() {
        // At an edge of the floor and at the foot of a wall too. 2 of 10⁴ tests of even light may call it uneven.
        let scene = floor(0.3, true);
        let n_even = |light: &dyn Fn(f64, f64) -> f64, places: &[DVec3]| {
            let grid = Grid::new(lattice(light), RADIUS, Stored::position);
            let tell = |place: &&DVec3| found(&scene, &grid, (**place, DVec3::Z), RADIUS).is_even;
            places.iter().filter(tell).count()
        };
        let places: Vec<DVec3> = [-0.3, -0.2, -0.1, 0.0, 0.049, 0.2, 0.3]
            .into_iter()
            .map(|x| DVec3::new(x, 0.01, 0.0))
            .collect();
        assert_eq!(n_even(&|_, _| 1.0, &places), places.len());
        assert_eq!(n_even(&|x, _| 3.0 + x, &places), places.len());
        let at = |x: f64| [DVec3::new(x, 0.0, 0.0)];
        let spot = |x: f64, y: f64| if (x + 0.15).hypot(y) < 0.05 { 1.0 } else { 0.1 };
        let line = |x: f64, _: f64| if (x + 0.15).abs() < 0.01 { 1.0 } else { 0.1 };
        let edge = |x: f64, _: f64| if x < -0.15 { 1.0 } else { 0.02 };
        for x in [-0.15, -0.12] {
            assert_eq!(n_even(&spot, &at(x)), 0, "spot {x}");
            assert_eq!(n_even(&line, &at(x)), 0, "line {x}");
            assert_eq!(n_even(&edge, &at(x)), 0, "edge {x}");
        }
    }

    #[test]
    fn c35_the_edge_of_a_surface_is_as_bright_as_its_middle() {
        let scene = floor(0.3, false);
        for place in [
            DVec3::new(0.299, 0.0, 0.0),
            DVec3::new(0.299, -0.299, 0.0),
            DVec3::new(0.27, 0.1, 0.0),
        ] {
            let edge = at(&scene, lattice(|_, _| 1.0), place, RADIUS);
            assert!((edge - 1.0).abs() < 0.12, "{place}: {edge}");
        }
    }

    #[test]
    fn c35_a_wall_keeps_the_light_behind_it() {
        let behind = lattice(|x, _| if x > 0.05 { 100.0 } else { 1.0 });
        let scene = floor(2.0, true);
        for x in [-0.04, 0.0, 0.04] {
            let before = at(&scene, behind.clone(), DVec3::X * x, RADIUS);
            assert!(before > 0.7 && before < 4.0, "{x}: {before}");
        }
    }

    #[test]
    fn a_ball_is_as_bright_as_its_light() {
        // From outside and from inside, with kernels up to where its surface turns by 17°.
        let ball = PlacedShape {
            shape: Shape::Sphere { radius: 0.3 },
            to_group: DAffine3::IDENTITY,
            material: MaterialId(0),
            organ: OrganId(0),
        };
        let scene = Scene::build(SceneDescription {
            materials: vec![Material::default()],
            groups: vec![Group {
                shapes: vec![ball],
                instances: vec![],
            }],
            root: Some(GroupId(0)),
            ..SceneDescription::default()
        })
        .unwrap();
        let n = 40_000;
        for side in [1.0, -1.0] {
            let photon = |i: i32| {
                let z = (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
                let w = crate::math::warp::direction(z, f64::from(i) * 0.618_033_988_75);
                Stored::at(w * 0.3, w * side, 0.36 * PI / f64::from(n))
            };
            let photons: Vec<Stored> = (0..n).map(photon).collect();
            for radius in [0.03, 0.06, 0.09] {
                let grid = Grid::new(photons.clone(), radius, Stored::position);
                for w in [DVec3::X, DVec3::new(0.6, -0.48, 0.64)] {
                    let at = (w * 0.3, w * side);
                    let found = found(&scene, &grid, at, radius).irradiance.g;
                    assert!((found - 1.0).abs() < 0.06, "{side} {radius} {w}: {found}");
                }
            }
        }
    }

    #[test]
    fn cells_have_equal_areas_and_hold_their_middles() {
        let n = 500;
        let mut counts = [0_u32; 3 * FINE_RINGS * FINE_RINGS];
        for i in 0..n * n {
            let p = DVec2::new(f64::from(i % n), f64::from(i / n)) * (2.0 / f64::from(n)) - 1.0;
            if p.length() < 1.0 {
                counts[cell_of(p)] += 1;
            }
        }
        let mean = counts.iter().sum::<u32>() as f64 / counts.len() as f64;
        assert!(
            counts
                .iter()
                .all(|n| (f64::from(*n) / mean - 1.0).abs() < 0.1),
            "{counts:?}"
        );
    }
}
