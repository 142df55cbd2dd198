//! What a path runs through: the clear bodies around it, and what they absorb.
//!
//! A body of glass begins behind the front of its surface. A path that crosses to the back enters it, one that crosses to the
//! front leaves it; bodies within bodies are remembered in order. Nothing scatters on the way.

use super::requirements::{Feature, Features, Requirements};
use crate::color::Rgb;
use crate::material::ScatteringFrame;
use crate::math::Ray;
use crate::math::functions::exp;
use crate::scene::description::MaterialId;
use crate::scene::{Scene, SurfacePoint};
use glam::DVec3;
use std::sync::{PoisonError, RwLock};

/// How many bodies within each other are told apart; further ones are counted, but absorb nothing.
const DEPTH: usize = 8;

/// Any direction that no model is likely to line up with.
const AWAY: DVec3 = DVec3::new(
    0.267_261_241_912_424_4,
    0.534_522_483_824_848_8,
    0.801_783_725_737_273_2,
);

/// Fraction of light per channel that is left after `distance` metres through what absorbs `absorption` 1/m.
#[must_use]
pub fn left_after(absorption: Rgb, distance: f64) -> Rgb {
    absorption.map(|sigma| {
        if sigma > 0.0 {
            exp(-sigma * distance)
        } else {
            1.0
        }
    })
}

/// A body around a path.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Body {
    material: MaterialId,
    absorption: Rgb,
}

/// The bodies around a point of a path, outermost first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Media {
    bodies: [Option<Body>; DEPTH],
    n: usize,
}

impl Media {
    /// What the innermost body absorbs, 1/m; black in the open.
    #[must_use]
    pub fn absorption(&self) -> Rgb {
        let innermost = self.n.checked_sub(1).and_then(|at| self.bodies.get(at));
        innermost
            .copied()
            .flatten()
            .map_or(Rgb::BLACK, |body| body.absorption)
    }

    fn enter(&mut self, body: Body) {
        if let Some(place) = self.bodies.get_mut(self.n) {
            *place = Some(body);
        }
        self.n += 1;
    }

    /// Leaves the innermost body of this material; if there is none, nothing happens (the shape was not closed).
    fn leave(&mut self, material: MaterialId) {
        if self.n > DEPTH {
            self.n -= 1;
            return;
        }
        let is_it = |body: &Option<Body>| body.is_some_and(|body| body.material == material);
        if let Some(at) = self.bodies[..self.n].iter().rposition(is_it) {
            self.bodies.copy_within(at + 1..self.n, at);
            self.n -= 1;
            self.bodies[self.n] = None;
        }
    }
}

/// The bodies of a scene.
#[derive(Debug)]
pub struct Bodies<'s> {
    scene: &'s Scene,
    /// Whether any may absorb; if not, none is remembered.
    absorb: bool,
    /// What was found around the last point asked for: the camera asks for the same one again and again.
    last: RwLock<Option<(DVec3, Media)>>,
}

impl<'s> Bodies<'s> {
    /// The bodies of `scene`, as far as they absorb.
    #[must_use]
    pub fn new(scene: &'s Scene) -> Self {
        Self::required(scene, &Requirements::of(scene, Features::NONE))
    }

    /// The bodies of a scene that requires this.
    #[must_use]
    pub fn required(scene: &'s Scene, requirements: &Requirements) -> Self {
        Self::remembered(scene, requirements.has(Feature::Bodies))
    }

    /// The bodies of a scene, which are forgotten unless they are to be remembered.
    pub(super) fn remembered(scene: &'s Scene, absorb: bool) -> Self {
        Self {
            scene,
            absorb,
            last: RwLock::new(None),
        }
    }

    /// The bodies around a point that lies on no surface.
    #[must_use]
    pub fn around(&self, point: DVec3) -> Media {
        if !self.absorb {
            return Media::default();
        }
        let known = *self.last.read().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, media)) = known
            && of == point
        {
            return media;
        }
        let media = self.search(point);
        *self.last.write().unwrap_or_else(PoisonError::into_inner) = Some((point, media));
        media
    }

    /// Follows a ray to the end of the world: what it leaves without having entered is around its start.
    fn search(&self, point: DVec3) -> Media {
        let ray = Ray::new(point, AWAY);
        let (mut entered, mut around) = (Vec::new(), Vec::new());
        let mut next = self.scene.closest(&ray);
        while let Some(hit) = next {
            let at = self.scene.surface(&ray, &hit);
            if let Some(absorption) = self.scene.optics(&at).scattering.body() {
                let material = at.material;
                if at.is_front {
                    entered.push(material);
                } else if let Some(place) = entered.iter().rposition(|known| *known == material) {
                    entered.remove(place);
                } else {
                    around.push(Body {
                        material,
                        absorption,
                    });
                }
            }
            next = self.scene.closest_after(&ray, &hit);
        }
        let mut media = Media::default();
        around.into_iter().rev().for_each(|body| media.enter(body));
        media
    }

    /// What is absorbed per metre on the other side of a surface that a path arrives at along `wo` through `media`, 1/m.
    #[must_use]
    pub fn beyond(
        &self,
        media: &Media,
        point: &SurfacePoint,
        frame: &ScatteringFrame,
        wo: DVec3,
    ) -> Rgb {
        if !self.absorb {
            return Rgb::BLACK;
        }
        let mut beyond = *media;
        self.cross(&mut beyond, point, frame, [wo, -wo]);
        beyond.absorption()
    }

    /// Changes the bodies around a path that arrived at a surface along `wo` and goes on along `wi`.
    pub fn cross(
        &self,
        media: &mut Media,
        point: &SurfacePoint,
        frame: &ScatteringFrame,
        [wo, wi]: [DVec3; 2],
    ) {
        if !self.absorb || frame.is_in_front(wo) == frame.is_in_front(wi) {
            return;
        }
        if let Some(absorption) = self.scene.optics(point).scattering.body() {
            if frame.is_in_front(wo) {
                media.enter(Body {
                    material: point.material,
                    absorption,
                });
            } else {
                media.leave(point.material);
            }
        }
    }
}
