//! Gathered irradiance kept where it changes slowly, for all cameras.
//!
//! Source: [`Ward1988`](crate::references#ward1988), with the gradients of [`WardHeckbert1992`](crate::references#wardheckbert1992)
//! and the clamping of radii to those of neighbours of [`Krivanek2006`](crate::references#krivanek2006).
//!
//! Ward's cache puts records where rays happen to come by, so what a picture shows depends on which came first. Here a picture
//! must depend on neither the order of threads nor on pictures before it. So the *places* of records are fixed once, all over the surfaces (of a photon map on its samples),
//! independent of any camera, in levels: of each level one place in each cell of a grid that is twice as wide as that of the finer
//! level, and the places of a level are places of all finer ones too. What a record holds is gathered when somebody first asks,
//! and depends on nothing but its place; so does how far it is trusted. A question begins with the widest level
//! and takes what is lacking in trust from finer ones, smoothly, so there are no seams. Views add records and the next
//! view finds them, yet each view shows what it would show alone.

use super::Places;
use super::guide::Guide;
use super::hemisphere::Gathered;
use crate::color::Rgb;
use crate::integrator::grid::{Grid, cell};
use glam::{DVec3, Vec3};
use std::sync::OnceLock;

/// The error that a record is trusted up to, in Ward's measure: distance over the harmonic mean distance of surfaces, and how
/// far the normal turns.
const TRUST: f64 = 0.35;

/// How far a record is trusted towards the nearest that its rays met: less than 1, because they do not meet the very nearest.
const BEFORE_WALLS: f64 = 0.8;

/// How far a record must be trusted to be worth its rays, in widths of its level: amid leaves none is.
const WORTHWHILE: f64 = 0.25;

/// How far a record is used, in widths of its level: every point of a cell is that near to the record in it.
const USE: f64 = 1.75;

/// Sum of the weights of records with which they need no finer ones.
const ENOUGH: f64 = 0.4;

/// How far a record may lie off the tangent plane, as a share of its distance: as on a ball whose normals differ by
/// [`IrradianceCache::SAME_NORMAL`].
const SLOPE: f64 = 0.2;

/// The same off the plane of a point whose normal differs so from that of the record: [`SLOPE`] and the sine of the angle.
const MOST_SLOPE: f64 = SLOPE + 0.436;

/// The widest level, as a share of the scene's size.
const WIDEST: f64 = 1.0 / 12.0;

/// The widest level, in spacings of the places.
const MOST_LEVELS: i32 = 12;

/// Angle in radians under which an eye must see the width of a level to be answered by it: a few pixels. Of what is smaller,
/// a record would cost more than the rays of the few samples that it serves.
const LEAST_ANGLE: f64 = 0.005;

/// A place of a record.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    position: Vec3,
    /// Of the side that the light comes from.
    pub(super) normal: Vec3,
    /// The widest level that it is of.
    level: u8,
}

/// A record.
#[derive(Debug)]
struct Record {
    irradiance: Vec3,
    per_turn: [Vec3; 3],
    per_metre: [Vec3; 3],
    /// Harmonic mean distance of surfaces, or what the nearest and the gradient allow, metres.
    distance: f32,
    guide: Option<Guide>,
}

/// Makes what the cache keeps: always the same for the same place, given with its number.
pub(super) trait Gather {
    /// A first look at how far away the nearest surface is, metres; 0 where nothing can be gathered.
    fn nearest(&mut self, at: usize, place: &Place) -> f64;

    /// What the record of a place holds.
    fn gather(&mut self, at: usize, place: &Place) -> Option<Gathered>;
}

/// What is known of a place.
#[derive(Debug, Default)]
struct Slot {
    /// The nearest surface at first look, metres.
    nearest: OnceLock<f32>,
    /// Empty inside where the surface was not found again.
    record: OnceLock<Option<Box<Record>>>,
    /// Its radius, not larger than those of its neighbours let it be.
    radius: OnceLock<f32>,
}

/// Where places of a level are.
#[derive(Clone, Copy, Debug)]
struct Pin {
    position: Vec3,
    normal: Vec3,
    at: u32,
}

#[derive(Debug)]
struct Level {
    width: f64,
    pins: Grid<Pin>,
}

/// A question to the cache.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    /// Where, in the world.
    pub(super) position: DVec3,
    /// Normal of the side.
    pub(super) normal: DVec3,
    /// How far the surface goes or is about flat there, metres.
    pub(super) flat: f64,
    /// How far away the eye is, metres.
    pub(super) eye: f64,
}

/// Gathered irradiance.
#[derive(Debug)]
pub(super) struct IrradianceCache {
    center: DVec3,
    spacing: f64,
    places: Vec<Place>,
    slots: Vec<Slot>,
    /// Widest first.
    levels: Vec<Level>,
}

impl IrradianceCache {
    /// Least cosine between normals.
    pub(super) const SAME_NORMAL: f64 = 0.9;

    /// Room for records at these places, in a scene of this size in metres round `center`.
    pub(super) fn new(places: Places, center: DVec3, size: f64) -> Self {
        let spacing = places.spacing;
        let mut places: Vec<Place> = places
            .all
            .into_iter()
            .map(|(position, normal)| Place {
                position: (position - center).as_vec3(),
                normal: normal.as_vec3(),
                level: 0,
            })
            .collect();
        let n_levels = (0..MOST_LEVELS)
            .take_while(|level| spacing * 2_f64.powi(*level) < WIDEST * size)
            .count()
            .max(1);
        let mut members: Vec<u32> = (0..places.len() as u32).collect();
        let mut levels = Vec::with_capacity(n_levels);
        for level in 0..n_levels {
            let width = spacing * 2_f64.powi(level as i32);
            members = first_of_cells(&places, members, width);
            for at in &members {
                places[*at as usize].level = level as u8;
            }
            let pin = |at: &u32| Pin {
                position: places[*at as usize].position,
                normal: places[*at as usize].normal,
                at: *at,
            };
            let pins = members.iter().map(pin).collect();
            let place = |pin: &Pin| pin.position.as_dvec3();
            levels.push(Level {
                width,
                pins: Grid::new(pins, USE * width, place),
            });
        }
        levels.reverse();
        Self {
            center,
            spacing,
            slots: places.iter().map(|_| Slot::default()).collect(),
            places,
            levels,
        }
    }

    /// Where a place is in the world.
    pub(super) fn position(&self, place: &Place) -> DVec3 {
        self.center + place.position.as_dvec3()
    }

    /// Distance between places of the finest level, metres.
    pub(super) fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Irradiance, W/m² per channel, and how certain it is: 1 needs nothing else, 0 is nothing.
    pub(super) fn irradiance(&self, asked: &Asked, mut gather: impl Gather) -> (Rgb, f64) {
        let position = asked.position - self.center;
        let (mut sum, mut left) = (DVec3::ZERO, 1.0);
        for level in &self.levels {
            let fine = level.width / (LEAST_ANGLE * asked.eye) - 1.0;
            if fine <= 0.0 {
                break;
            }
            if asked.flat < level.width {
                continue;
            }
            let (light, weights) = self.interpolate(level, position, asked.normal, &mut gather);
            if weights > 0.0 {
                let certain = left * (weights / ENOUGH).min(1.0) * fine.min(1.0);
                sum += light * (certain / weights);
                left -= certain;
            }
            if left <= 0.0 {
                break;
            }
        }
        let certain = 1.0 - left;
        if certain > 0.0 {
            (Rgb::from_array((sum / certain).to_array()), certain)
        } else {
            (Rgb::BLACK, 0.0)
        }
    }

    /// Where light comes from, roughly: as the nearest record of the widest level that has one has it.
    pub(super) fn guide(&self, asked: &Asked, mut gather: impl Gather) -> Option<&Guide> {
        let position = asked.position - self.center;
        let levels = self.levels.iter().filter(|level| level.width <= asked.flat);
        for level in levels.take_while(|level| level.width > LEAST_ANGLE * asked.eye) {
            let mut nearest: Option<(f64, usize)> = None;
            let reach = USE * level.width;
            let thickness = SLOPE * reach + 0.01 * self.spacing;
            level
                .pins
                .near_plane(position, asked.normal, thickness, |pin| {
                    let from = position - pin.position.as_dvec3();
                    let (square, at) = (from.length_squared(), pin.at as usize);
                    if square >= reach * reach
                        || pin.normal.as_dvec3().dot(asked.normal) < Self::SAME_NORMAL
                        || from.dot(asked.normal).abs() > thickness
                        || nearest.is_some_and(|(least, _)| least <= square)
                        || self.trusted(at, &mut gather) < WORTHWHILE * level.width
                    {
                        return;
                    }
                    nearest = Some((square, at));
                });
            if let Some((_, at)) = nearest
                && let Some(record) = self.record(at, &mut gather)
            {
                return record.guide.as_ref();
            }
        }
        None
    }

    /// Weighted sum over the records of a level near a point, and the sum of the weights.
    fn interpolate(
        &self,
        level: &Level,
        position: DVec3,
        normal: DVec3,
        gather: &mut impl Gather,
    ) -> (DVec3, f64) {
        let reach = USE * level.width;
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        let thickness = MOST_SLOPE * reach + 0.01 * self.spacing;
        level.pins.near_plane(position, normal, thickness, |pin| {
            let from = position - pin.position.as_dvec3();
            let share = from.length_squared() / (reach * reach);
            if share >= 1.0 {
                return;
            }
            let at = pin.at as usize;
            let own = pin.normal.as_dvec3();
            let turn = own.dot(normal);
            let distance = from.length();
            let off = SLOPE * distance + 0.01 * self.spacing;
            if turn < Self::SAME_NORMAL || from.dot(own).abs() > off {
                return;
            }
            let trusted = self.trusted(at, gather);
            if distance >= trusted || trusted < WORTHWHILE * level.width {
                return;
            }
            let Some(record) = self.record(at, gather) else {
                return;
            };
            let radius = self.radius(at, record, gather);
            let error = distance / radius + (1.0 - turn).max(0.0).sqrt();
            let trust = 1.0 - error / TRUST;
            if trust > 0.0 {
                let weight = trust * (1.0 - share) * (1.0 - share);
                sum += record.carried(from, own.cross(normal)) * weight;
                weights += weight;
            }
        });
        (sum, weights)
    }

    /// The record of a place.
    fn record(&self, at: usize, gather: &mut impl Gather) -> Option<&Record> {
        let made = || {
            let trusted = self.trusted(at, gather);
            let found = gather.gather(at, &self.places[at])?;
            Some(Box::new(Record::new(found, trusted)))
        };
        self.slots[at].record.get_or_init(made).as_deref()
    }

    /// How far a record is trusted at most, metres, as a first look tells.
    fn trusted(&self, at: usize, gather: &mut impl Gather) -> f64 {
        let look = || gather.nearest(at, &self.places[at]) as f32;
        BEFORE_WALLS * f64::from(*self.slots[at].nearest.get_or_init(look))
    }

    /// Radius of a record: its own, or less where a neighbour of its level knows of something nearer.
    fn radius(&self, at: usize, record: &Record, gather: &mut impl Gather) -> f64 {
        if let Some(known) = self.slots[at].radius.get() {
            return f64::from(*known);
        }
        let place = self.places[at];
        let level = &self.levels[self.levels.len() - 1 - usize::from(place.level)];
        let reach = USE * level.width;
        let position = place.position.as_dvec3();
        let mut radius = f64::from(record.distance);
        level.pins.near(position, |pin| {
            let other = pin.at as usize;
            let distance = (pin.position.as_dvec3() - position).length();
            let is_alike = f64::from(pin.normal.dot(place.normal)) > Self::SAME_NORMAL;
            if other == at || !is_alike || distance >= reach {
                return;
            }
            let trusted = self.trusted(other, gather);
            let known = if trusted < WORTHWHILE * level.width {
                trusted / TRUST
            } else if let Some(neighbour) = self.record(other, gather) {
                f64::from(neighbour.distance)
            } else {
                return;
            };
            radius = radius.min(known + distance);
        });
        f64::from(*self.slots[at].radius.get_or_init(|| radius as f32))
    }
}

impl Record {
    fn new(found: Gathered, trusted: f64) -> Self {
        let irradiance = DVec3::from_array(found.irradiance.to_array());
        // A record is not trusted beyond the nearest wall, nor farther than its gradient takes it to nothing or to the double.
        let slopes = found.per_metre.map(DVec3::length);
        let slope = slopes[0] + slopes[1] + slopes[2];
        let allowed = irradiance.element_sum() / slope;
        let nearest = (found.nearest * BEFORE_WALLS).min(trusted);
        let open = found.distance.min(nearest / TRUST);
        let distance = if slope > 0.0 { open.min(allowed) } else { open };
        Self {
            irradiance: irradiance.as_vec3(),
            per_turn: found.per_turn.map(|gradient| gradient.as_vec3()),
            per_metre: found.per_metre.map(|gradient| gradient.as_vec3()),
            distance: distance as f32,
            guide: found.guide,
        }
    }

    /// Irradiance so far away from the record, where the normal is turned round this axis.
    fn carried(&self, from: DVec3, turn: DVec3) -> DVec3 {
        let here = self.irradiance.as_dvec3();
        let change = |channel: usize| {
            self.per_metre[channel].as_dvec3().dot(from)
                + self.per_turn[channel].as_dvec3().dot(turn)
        };
        let carried = here + DVec3::new(change(0), change(1), change(2));
        carried.clamp(DVec3::ZERO, here * 2.0)
    }
}

/// Those of some places that are the first in their cell of this width with their main direction of the normal.
fn first_of_cells(places: &[Place], members: Vec<u32>, width: f64) -> Vec<u32> {
    let mut keys: Vec<([i32; 3], u8, u32)> = members
        .into_iter()
        .map(|at| {
            let Place {
                position, normal, ..
            } = places[at as usize];
            let axis = normal.abs().max_position();
            let direction = 2 * axis as u8 + u8::from(normal[axis] < 0.0);
            (cell(position.as_dvec3(), width).to_array(), direction, at)
        })
        .collect();
    keys.sort_unstable();
    keys.dedup_by_key(|(cell, direction, _)| (*cell, *direction));
    keys.into_iter().map(|(_, _, at)| at).collect()
}
