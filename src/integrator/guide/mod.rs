//! Path guiding: where light is learnt from photons, and paths are sent there more often.
//!
//! Before the picture, [photons](super::photon) are followed from the sources; each remembers from where it arrived at a matt
//! surface. Space is divided (a tree per side of the axes, so that walls of a corner are told apart) until a cell holds a few
//! hundred of them, and each cell keeps a [density of directions](directions). A path then leaves a matt surface half of
//! the time as the guide says and half of the time as the surface scatters; the density of both together is known, so the
//! mean is the same as without a guide, whatever was learnt. Light that comes straight from a lamp is not learnt: it is sampled
//! anyway.
//!
//! It is worth its cost where mirrors or glass make caustics, which paths find by luck only: with a mirroring and a glass ball
//! in a box it halves the variance for a quarter more time. Without them it was measured to gain nothing (light through a
//! narrow door) or to lose a little (an open box), so then there is no guide.
//!
//! Photons do not know the camera, so one guide serves all views of a scene, and it does not depend on the number of threads.
//!
//! Sources: [Jensen1995](crate::references#jensen1995) (photons as guides), [Muller2017](crate::references#muller2017)
//! (trees of space and directions).

mod directions;
mod training;

use super::{RenderContext, RenderError};
use crate::material::Optics;
use crate::scene::{Scene, SurfacePoint};
use directions::{Arrival, Forest, Root};
use glam::{DVec2, DVec3, Vec3};

/// A cell of space with more photons than this is divided.
const CELL: usize = 512;

/// With fewer photons than this nothing is known.
const FEWEST: usize = 64;

/// How often the guide chooses a direction at the first surfaces of a path …
const SHARE: f64 = 0.5;

/// … and after so many scatterings …
const MANY: u32 = 4;

/// … how often. Where the guide is wrong, the surface makes up for it with weights of 1 / (1 - share), which multiply along the
/// path: ρ² / (1 - share) below 1 keeps their spread in bounds however long it is.
const LATER_SHARE: f64 = 0.25;

/// A photon's arrival on a matt surface.
#[derive(Clone, Copy, Debug)]
struct Photon {
    position: Vec3,
    side: u8,
    arrival: Arrival,
}

/// What was learnt about a scene.
#[derive(Debug)]
pub struct Guide {
    forest: Forest,
    branches: Vec<Branch>,
    /// By the side of the axes that surfaces face.
    sides: [Cell; 6],
}

/// A part of space.
#[derive(Clone, Copy, Debug)]
enum Cell {
    /// Divided: index into the branches.
    Divided(u32),
    /// What is known of it.
    Known(Root),
    /// Too little arrives there.
    Unknown,
}

/// A part of space that is divided.
#[derive(Clone, Copy, Debug)]
struct Branch {
    axis: u8,
    at: f32,
    halves: [Cell; 2],
}

/// What the guide knows of one place.
#[derive(Clone, Copy, Debug)]
pub struct Advice<'g> {
    forest: &'g Forest,
    root: Root,
    /// How often it is to be followed, 0..1.
    pub share: f64,
}

impl Guide {
    /// Learns where light is in `scene`. It pays where
    /// [`Feature::Guide`](super::requirements::Feature::Guide) is required: not if nothing shines or nothing makes caustics, nor under a
    /// sun or sky, which light a scene evenly and would need many more photons.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`] if the context was cancelled meanwhile.
    pub fn new(scene: &Scene, context: &RenderContext<'_>) -> Result<Self, RenderError> {
        let mut photons = training::photons(scene, context)?;
        photons.sort_by_key(|photon| photon.side);
        let mut guide = Self {
            forest: Forest::default(),
            branches: Vec::new(),
            sides: [Cell::Unknown; 6],
        };
        for side in 0..6_u8 {
            let start = photons.partition_point(|photon| photon.side < side);
            let end = photons.partition_point(|photon| photon.side <= side);
            guide.sides[usize::from(side)] = guide.learn(&mut photons[start..end]);
        }
        Ok(guide)
    }

    /// Divides space until cells are small enough, and learns directions there.
    fn learn(&mut self, photons: &mut [Photon]) -> Cell {
        if photons.len() < FEWEST {
            return Cell::Unknown;
        }
        let (low, high) = photons.iter().fold(
            (Vec3::INFINITY, Vec3::NEG_INFINITY),
            |(low, high), photon| (low.min(photon.position), high.max(photon.position)),
        );
        let axis = (high - low).max_position();
        if photons.len() <= CELL || high[axis] <= low[axis] {
            let mut arrivals: Vec<Arrival> = photons.iter().map(|photon| photon.arrival).collect();
            return match self.forest.plant(&mut arrivals) {
                Some(root) => Cell::Known(root),
                None => Cell::Unknown,
            };
        }
        let middle = photons.len() / 2;
        let place = |photon: &Photon| photon.position[axis];
        photons.select_nth_unstable_by(middle, |a, b| place(a).total_cmp(&place(b)));
        let at = place(&photons[middle]);
        let index = self.branches.len();
        self.branches.push(Branch {
            axis: axis as u8,
            at,
            halves: [Cell::Unknown; 2],
        });
        let (lower, upper) = photons.split_at_mut(middle);
        let halves = [self.learn(lower), self.learn(upper)];
        self.branches[index].halves = halves;
        Cell::Divided(index as u32)
    }

    /// What is known of the light that arrives at a surface, on the side that is seen, on a path that has been scattered
    /// `n_scatterings` times before.
    #[must_use]
    pub fn advice(&self, at: &SurfacePoint, n_scatterings: u32) -> Option<Advice<'_>> {
        let position = at.position.as_vec3();
        let mut cell = self.sides[usize::from(side(facing(at)))];
        loop {
            match cell {
                Cell::Divided(index) => {
                    let branch = &self.branches[index as usize];
                    let is_above = position[usize::from(branch.axis)] >= branch.at;
                    cell = branch.halves[usize::from(is_above)];
                }
                Cell::Known(root) => {
                    return Some(Advice {
                        forest: &self.forest,
                        root,
                        share: if n_scatterings < MANY {
                            SHARE
                        } else {
                            LATER_SHARE
                        },
                    });
                }
                Cell::Unknown => return None,
            }
        }
    }
}

impl Advice<'_> {
    /// A unit direction from which light is likely to come, from a point of the unit square.
    #[must_use]
    pub fn sample(&self, u: DVec2) -> DVec3 {
        self.forest.sample(self.root, u)
    }

    /// Density with which a direction is found that the surface alone finds with the density `own`.
    #[must_use]
    pub fn combined_pdf(&self, own: f64, w: DVec3) -> f64 {
        (1.0 - self.share) * own + self.share * self.pdf_solid_angle(w)
    }

    /// Density per steradian with which [`sample`](Self::sample) finds the unit direction `w`.
    #[must_use]
    pub fn pdf_solid_angle(&self, w: DVec3) -> f64 {
        self.forest.pdf_solid_angle(self.root, w)
    }
}

/// Whether paths are guided at a surface: it is matt and lets nothing through.
#[must_use]
pub fn is_guided(optics: &Optics<'_>) -> bool {
    let sides = &optics.scattering.sides;
    optics.scattering.is_matt()
        && sides.iter().any(|side| !side.reflectance.is_black())
        && sides.iter().all(|side| side.transmittance.is_black())
}

/// The normal on the side that a point is seen from.
fn facing(point: &SurfacePoint) -> DVec3 {
    if point.is_front {
        point.normal_g
    } else {
        -point.normal_g
    }
}

/// The side of the axes that a normal points to most.
fn side(normal: DVec3) -> u8 {
    let axis = normal.abs().max_position();
    axis as u8 * 2 + u8::from(normal[axis] < 0.0)
}
