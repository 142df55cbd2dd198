//! Light that an endless plane throws back at what stands on it.
//!
//! Far from the scene few photons that a plane throws back meet anything. So parallel light and sky are sent there less densely,
//! by rings round the scene, with photons that are as many times stronger; and what a matt plane sends into directions in which
//! there is nothing escapes without chance: the photon goes on towards the scene with the share of its power that goes there,
//! and Russian roulette brings it to the power of the photons that were sent to the scene itself. All photons that come to the
//! scene are then about alike, and how many are sent to a ring is decided by what of its light can arrive.
//!
//! The directions are those to an upright cylinder round the scene's box: a sector of azimuths up to an elevation, which holds a
//! share of a cosine's directions that is known in closed form.

use super::target::Targets;
use crate::color::Rgb;
use crate::material::Material;
use crate::math::Bounds3;
use crate::math::functions::{asin, cos, sin};
use crate::math::tolerance::{RING_SHARE, TARGET_SLACK};
use crate::scene::Scene;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Half widths of the rings' outer edges over the scene's half width or height above the plane, whichever is more.
const RINGS: [f64; 10] = [1.5, 2.2, 3.2, 5.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0];

/// Half width of the innermost ring over the cylinder's radius.
const CLOSE: f64 = 1.3;

/// The same, and the share of the photons in each relative to the box itself, where nothing is known of what planes throw back:
/// they mirror, or there are several. Photons there are as many times stronger as they are rarer.
const BLIND_RINGS: [(f64, f64); 2] = [(3.0, 0.5), (9.0, 0.5)];

/// The one endless plane of a scene, if it is matt and opaque, and what stands on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground {
    normal: DVec3,
    corners: [DVec3; 8],
    center: DVec3,
    /// Of the cylinder, metres.
    radius: f64,
    /// The largest share of light in any channel that it throws back.
    albedo: f64,
}

/// The directions from a point of the plane to the cylinder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sector {
    up: DVec3,
    ahead: DVec3,
    half_angle: f64,
    /// Squared sine of the highest elevation.
    sine2: f64,
}

impl Sector {
    /// The share of the directions of a cosine that lie in it.
    pub(super) fn share(&self) -> f64 {
        self.half_angle / PI * self.sine2
    }

    /// A direction in it, dense in proportion to the cosine to the plane's normal.
    pub(super) fn direction(&self, u: DVec2) -> DVec3 {
        // A cosine's directions are even over the disk below them.
        let radius2 = 1.0 - u.x * self.sine2;
        let turn = (2.0 * u.y - 1.0) * self.half_angle;
        let flat = self.ahead * cos(turn) + self.up.cross(self.ahead) * sin(turn);
        (flat * radius2.sqrt() + self.up * (1.0 - radius2).max(0.0).sqrt()).normalize()
    }

    /// That of a cylinder of this radius and height, whose axis is `distance` away in the direction `ahead`. `None` from inside.
    fn to_cylinder(
        up: DVec3,
        ahead: DVec3,
        distance: f64,
        radius: f64,
        height: f64,
    ) -> Option<Self> {
        let free = distance - radius;
        if free.is_nan() || free <= 0.0 {
            return None;
        }
        let height = height.max(0.0);
        Some(Self {
            up,
            ahead,
            half_angle: asin(radius / distance).min(FRAC_PI_2),
            sine2: height * height / (height * height + free * free),
        })
    }
}

impl Ground {
    /// The plane of a scene, and what is in `bounds`. `None` if there is nothing, no plane, several, or one that is not matt.
    pub(super) fn of(scene: &Scene, bounds: &Bounds3) -> Option<Self> {
        let mut planes = scene.planes();
        let (plane, None) = (planes.next()?, planes.next()) else {
            return None;
        };
        let material = scene.material(plane.material);
        if bounds.is_empty() || !is_matt(material) {
            return None;
        }
        let (corners, center) = (bounds.corners(), bounds.center());
        let across = corners.map(|corner| {
            (corner - center)
                .reject_from_normalized(plane.normal)
                .length()
        });
        let albedo = material
            .mean_sides()
            .map(|side| side.reflectance.max_channel());
        Some(Self {
            normal: plane.normal,
            corners,
            center,
            radius: across.into_iter().fold(0.0, f64::max) * (1.0 + TARGET_SLACK),
            albedo: albedo[0].max(albedo[1]),
        })
    }

    /// Where from a point of the plane, on the side to which `up` points, light may meet anything; `None` if it may anywhere.
    pub(super) fn sector(&self, point: DVec3, up: DVec3) -> Option<Sector> {
        let flat = (self.center - point).reject_from_normalized(up);
        let heights = self.corners.map(|corner| (corner - point).dot(up));
        let height = heights.into_iter().fold(0.0, f64::max) * (1.0 + TARGET_SLACK);
        let distance = flat.length();
        Sector::to_cylinder(up, flat / distance, distance, self.radius, height)
    }

    /// The half widths of rings on the plane through `point`, metres, and how densely photons are wanted in each, ever less; for a
    /// scene of this largest half width.
    fn rings(&self, point: DVec3, half: f64) -> Vec<(f64, f64)> {
        let heights = self
            .corners
            .map(|corner| (corner - point).dot(self.normal).abs());
        let height = heights.into_iter().fold(0.0, f64::max);
        // Where photons cannot be aimed at the cylinder all must be about as strong as the scene's own.
        let first = CLOSE * self.radius;
        let mut rings = vec![(first, 0.5 * self.albedo)];
        // What is high above the plane gets light from as far as if it reached down to it.
        let outer = RINGS.map(|factor| factor * half.max(height));
        let mut inner = first;
        for outer in outer.into_iter().filter(|outer| *outer > first) {
            rings.push((outer, self.wanted((inner * outer).sqrt(), height)));
            inner = outer;
        }
        rings
    }

    /// How densely photons are wanted so far from the middle: by the share of their light that comes to the scene.
    fn wanted(&self, distance: f64, height: f64) -> f64 {
        let sector = Sector::to_cylinder(DVec3::Z, DVec3::X, distance, self.radius, height);
        self.albedo * sector.map_or(0.5, |sector| sector.share().min(0.5))
    }
}

/// Whether all that a surface sends back is spread evenly on the side it comes from.
fn is_matt(material: &Material) -> bool {
    let [front, back] = material.mean_sides();
    let is_opaque = [front, back]
        .iter()
        .all(|side| side.transmittance == Rgb::BLACK);
    is_opaque && material.lobes.is_empty() && material.alpha == 1.0 && !material.has_holes()
}

/// Adds rings round `bounds` to what photons are aimed at, for what endless planes throw back from there.
pub(super) fn surround(
    targets: &mut Targets,
    scene: &Scene,
    bounds: &Bounds3,
    ground: Option<&Ground>,
) {
    let half = bounds.diagonal() * 0.5;
    let normals: Vec<DVec3> = scene.planes().map(|plane| plane.normal).collect();
    let is_across = |axis: usize| normals.iter().all(|normal| normal[axis].abs() > 0.999);
    // Along planes the box grows, across them nothing is thrown back.
    let grown = |extent: f64| {
        let mut wide = *bounds;
        for axis in (0..3).filter(|axis| !is_across(*axis)) {
            let more = extent.max(half[axis]) - half[axis];
            wide.min[axis] -= more;
            wide.max[axis] += more;
        }
        wide
    };
    let (Some(ground), Some(plane)) = (ground, scene.planes().next()) else {
        for (factor, share) in BLIND_RINGS {
            let wide = grown(half.max_element() * factor);
            // As many photons in the wider box as `share` of those in the box itself.
            let area = |b: &Bounds3| b.surface_area().max(f64::MIN_POSITIVE);
            targets.push(wide, share * area(bounds) / area(&wide));
        }
        return;
    };
    let rings = ground.rings(plane.point, half.max_element());
    let matters = |(extent, wanted): &(f64, f64)| {
        grown(*extent).surface_area() * wanted >= RING_SHARE * bounds.surface_area()
    };
    let rings: Vec<_> = rings.into_iter().take_while(matters).collect();
    for (at, (extent, wanted)) in rings.iter().enumerate() {
        let mut wide = grown(*extent);
        // Only where the light lands counts.
        for axis in (0..3).filter(|axis| is_across(*axis)) {
            wide.min[axis] = plane.point[axis];
            wide.max[axis] = plane.point[axis];
        }
        // Boxes lie in each other: their densities add up to the wanted one.
        let beyond = rings.get(at + 1).map_or(0.0, |(_, beyond)| *beyond);
        targets.push(wide, wanted - beyond);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;

    /// Against counting: which of a cosine's directions meet the cylinder's shadow of azimuths and elevations.
    #[test]
    fn a_sector_holds_its_share_of_directions_and_no_others() {
        let (distance, radius, height) = (3.0, 1.2, 0.8);
        let sector = Sector::to_cylinder(DVec3::Z, DVec3::Y, distance, radius, height).unwrap();
        let holds = |w: DVec3| {
            let turn = w.truncate().angle_to(DVec2::Y).abs();
            turn <= (radius / distance).asin()
                && w.z / w.truncate().length() <= height / (distance - radius)
        };
        let n = 1500;
        let grid = (0..n * n)
            .map(|i| DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n));
        let counted = grid
            .clone()
            .filter(|u| holds(warp::cosine_hemisphere(*u)))
            .count();
        let share = counted as f64 / f64::from(n * n);
        assert!(
            (sector.share() / share - 1.0).abs() < 0.01,
            "{} {share}",
            sector.share()
        );
        for u in grid.step_by(997) {
            let w = sector.direction(u);
            let inward = (w * DVec3::new(0.999, 1.0, 0.999)).normalize();
            assert!(holds(inward) && (w.length() - 1.0).abs() < 1e-12, "{w}");
        }
        assert!(Sector::to_cylinder(DVec3::Z, DVec3::Y, 1.0, 1.2, 0.8).is_none());
        // A cylinder that stands below the plane gets nothing.
        let below = Sector::to_cylinder(DVec3::Z, DVec3::Y, 3.0, 1.2, -1.0).unwrap();
        assert_eq!(below.share(), 0.0);
    }

    /// The mean cosine of the directions of a cosine in a sector up to the zenith is that of the hemisphere, 2/3.
    #[test]
    fn directions_are_dense_in_proportion_to_the_cosine() {
        let sector = Sector {
            up: DVec3::Z,
            ahead: DVec3::X,
            half_angle: 0.4,
            sine2: 1.0,
        };
        let n = 2000;
        let cosines = (0..n).map(|i| {
            sector
                .direction(DVec2::new((f64::from(i) + 0.5) / f64::from(n), 0.3))
                .z
        });
        let mean = cosines.sum::<f64>() / f64::from(n);
        assert!((mean - 2.0 / 3.0).abs() < 1e-3, "{mean}");
    }
}
