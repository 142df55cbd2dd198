//! Follows one photon from surface to surface.

use super::emission::Photon;
use super::ground::{Ground, Sector};
use super::ledger::Ledger;
use super::plot::{Leg, Plot};
use crate::color::Rgb;
use crate::integrator::medium::{Bodies, Media, left_after};
use crate::material::{Density, Optics, ScatterNumbers, ScatterSample, ScatteringFrame, Transport};
use crate::math::Ray;
use crate::sampler::{Sampler, Use};
use crate::scene::{Hit, Scene, SurfacePoint};
use glam::{DVec2, DVec3};

/// What the way of a photon to a surface was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum History {
    /// Straight from a source that light sampling knows: direct light.
    Direct,
    /// Straight from what light sampling does not know: land below the horizon of a sky.
    Unsampled,
    /// Mirrored or refracted, each time into a single direction: light of caustics.
    Specular,
    /// Scattered into many directions at least once.
    Diffuse,
}

/// A photon arrives at a surface.
#[derive(Clone, Copy, Debug)]
pub struct PhotonHit<'a> {
    /// Where.
    pub point: &'a SurfacePoint,
    /// What the surface does to light there.
    pub optics: &'a Optics<'a>,
    /// Unit direction back to where the photon comes from.
    pub wo: DVec3,
    /// Power that meets the surface (what alpha lets pass does not), W per channel.
    pub power: Rgb,
    /// What the surface keeps of it on average: `power - reflected - transmitted`.
    pub absorbed: Rgb,
    /// What it throws back: on average where that is known on paper (matt surfaces), as chance has it elsewhere.
    pub reflected: Rgb,
    /// What it lets through to the other side, scattered or straight on; as with `reflected`.
    pub transmitted: Rgb,
    /// Scatterings so far.
    pub depth: u32,
    /// What its way was.
    pub history: History,
}

/// Whether a photon goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Onward {
    /// It does.
    Go,
    /// Nobody wants to know.
    Stop,
}

/// Who wants to know of photons.
pub trait Visitor: Send {
    /// A photon arrives at a surface that scatters or keeps light.
    fn arrives(&mut self, hit: &PhotonHit<'_>) -> Onward;

    /// A photon of this power, W per channel, flies along all of a ray, between two surfaces or out of the scene.
    fn flies(&mut self, _ray: &Ray, _power: Rgb) {}
}

/// What all photons of a scene share.
pub(super) struct Tracer<'s> {
    pub(super) scene: &'s Scene,
    pub(super) bodies: Bodies<'s>,
    /// Scatterings after which a photon is lost.
    pub(super) max_depth: u32,
    /// Where the world repeats itself.
    pub(super) plot: Option<Plot>,
    /// The endless plane that throws light back at what stands on it.
    pub(super) ground: Option<Ground>,
}

/// How often a photon may go round a plot before it is given up: one that flies level may never meet anything.
const MOST_ROUNDS: u32 = 10_000;

/// A photon on its way.
struct Flight {
    ray: Ray,
    power: Rgb,
    /// How many times stronger it is than photons that are sent to the scene itself; at least 1.
    strength: f64,
    media: Media,
    history: History,
    depth: u32,
    sampler: Sampler,
}

/// A surface at which a photon does not go straight on.
struct Arrival<'s> {
    point: SurfacePoint,
    optics: Optics<'s>,
    /// Part of the power that meets the surface which goes straight on, in the mean.
    straight: Rgb,
    /// Whether it is an endless plane.
    is_plane: bool,
}

/// What comes of a scattering.
struct Scattered {
    reflected: Rgb,
    transmitted: Rgb,
    onward: Option<ScatterSample>,
}

impl<'s> Tracer<'s> {
    /// Follows a photon to its end.
    pub(super) fn follow(&self, photon: &Photon, visitor: &mut impl Visitor, books: &mut Ledger) {
        books.n_photons += 1;
        books.emitted.add(books.scale().quanta(photon.power));
        let mut flight = Flight {
            ray: self.plot.map_or(photon.ray, |plot| plot.enter(&photon.ray)),
            power: photon.power,
            strength: photon.strength,
            media: self.bodies.around(photon.ray.origin),
            history: if photon.is_direct {
                History::Direct
            } else {
                History::Unsampled
            },
            depth: 0,
            sampler: photon.sampler.clone(),
        };
        loop {
            flight.sampler.start_vertex(flight.depth.saturating_add(1));
            let Some(arrival) = self.arrive(&mut flight, visitor, books) else {
                return;
            };
            if !self.scatter(&mut flight, &arrival, visitor, books) {
                return;
            }
        }
    }

    /// Carries a photon along its ray to the surface that scatters it; `None` if it ends on the way.
    ///
    /// As the path tracer does: what goes straight through a surface stays on the same ray.
    fn arrive(
        &self,
        flight: &mut Flight,
        visitor: &mut impl Visitor,
        books: &mut Ledger,
    ) -> Option<Arrival<'s>> {
        let scale = books.scale();
        let mut passages = 0..u16::MAX;
        let mut rounds = 0;
        let mut from = 0.0;
        let mut side = self.begin_leg(flight);
        books.n_rays += 1;
        let mut next = self.scene.closest(&flight.ray);
        loop {
            let until = next.map_or(flight.ray.t_max, |hit| hit.t);
            let way = Ray {
                t_min: from,
                t_max: until,
                ..flight.ray
            };
            visitor.flies(&way, flight.power);
            self.absorb(flight, until - from, books);
            let Some(hit) = next else {
                let Some(shift) = side else {
                    books.escaped.add(scale.quanta(flight.power));
                    return None;
                };
                rounds += 1;
                if rounds > MOST_ROUNDS {
                    books.lost.add(scale.quanta(flight.power));
                    return None;
                }
                let at = flight.ray.at(flight.ray.t_max) + shift;
                flight.ray = Ray::new(at, flight.ray.direction);
                from = 0.0;
                side = self.begin_leg(flight);
                books.n_rays += 1;
                next = self.scene.closest(&flight.ray);
                continue;
            };
            let passage = passages.next();
            if let Some(arrival) = self.meet(flight, &hit, passage, visitor, books) {
                return Some(arrival);
            }
            if flight.power.is_black() {
                return None;
            }
            from = hit.t;
            books.n_rays += 1;
            next = self.scene.closest_after(&flight.ray, &hit);
        }
    }

    /// Ends the ray of a photon at the side of the plot it comes to, if there is a plot; gives by what it is moved there.
    fn begin_leg(&self, flight: &mut Flight) -> Option<DVec3> {
        match self.plot?.leg(&flight.ray) {
            Leg::Last => None,
            Leg::Side(t, shift) => {
                flight.ray.t_max = t;
                Some(shift)
            }
        }
    }

    /// Takes what the body around a photon absorbs over a distance.
    fn absorb(&self, flight: &mut Flight, distance: f64, books: &mut Ledger) {
        let absorption = flight.media.absorption();
        if absorption.is_black() {
            return;
        }
        let left = flight.power * left_after(absorption, distance);
        books.absorbed.add(books.scale().quanta(flight.power));
        books.absorbed.take(books.scale().quanta(left));
        flight.power = left;
    }

    /// Decides whether a photon meets a surface or goes straight through, and keeps the mean; `None` if it goes through.
    fn meet(
        &self,
        flight: &mut Flight,
        hit: &Hit,
        passage: Option<u16>,
        visitor: &mut impl Visitor,
        books: &mut Ledger,
    ) -> Option<Arrival<'s>> {
        let point = self.scene.surface(&flight.ray, hit);
        let optics = self.scene.optics(&point);
        let (Some(passage), false) = (passage, optics.is_opaque()) else {
            return Some(Arrival {
                point,
                optics,
                straight: Rgb::BLACK,
                is_plane: hit.is_plane(),
            });
        };
        let scale = books.scale();
        let before = flight.power;
        let through = optics.passage(point.normal_g.dot(flight.ray.direction));
        // What passes of the light that meets the surface: alpha of the light does.
        let straight = if optics.alpha > 0.0 {
            (through - Rgb::splat(1.0 - optics.alpha)).map(|c| c.max(0.0)) / optics.alpha
        } else {
            Rgb::BLACK
        };
        if optics.is_nothing_else() {
            // A surface that only takes some of the light: no chance needed.
            flight.power = before * through;
            let met = before * optics.alpha;
            let arrival = Arrival {
                point,
                optics,
                straight,
                is_plane: hit.is_plane(),
            };
            let nothing = Scattered {
                reflected: Rgb::BLACK,
                transmitted: Rgb::BLACK,
                onward: None,
            };
            let hit = arrival.hit(flight, met, &nothing);
            let onward = visitor.arrives(&hit);
            books.absorbed.add(scale.quanta(before));
            books.absorbed.take(scale.quanta(flight.power));
            if onward == Onward::Stop {
                books.ended.add(scale.quanta(flight.power));
                flight.power = Rgb::BLACK;
            }
            return None;
        }
        let chance_of_meeting = 1.0 - through.mean();
        let chance = flight.sampler.point(Use::Passage(passage)).x;
        let meets = chance < chance_of_meeting;
        flight.power = if meets {
            before * (optics.alpha / chance_of_meeting)
        } else {
            before * through / (1.0 - chance_of_meeting)
        };
        books.chance.add(scale.quanta(before));
        books.chance.take(scale.quanta(flight.power));
        meets.then_some(Arrival {
            point,
            optics,
            straight,
            is_plane: hit.is_plane(),
        })
    }

    /// Scatters a photon that has met a surface; false if it ends there.
    fn scatter(
        &self,
        flight: &mut Flight,
        arrival: &Arrival<'_>,
        visitor: &mut impl Visitor,
        books: &mut Ledger,
    ) -> bool {
        let scale = books.scale();
        let met = flight.power;
        let scattered = arrival.scattered(flight);
        let onward = visitor.arrives(&arrival.hit(flight, met, &scattered));
        let sent = scale.quanta(scattered.reflected);
        let through = scale.quanta(scattered.transmitted + met * arrival.straight);
        books.absorbed.add(scale.quanta(met));
        books.absorbed.take(sent);
        books.absorbed.take(through);
        if onward == Onward::Stop {
            books.ended.add(sent);
            books.ended.add(through);
            return false;
        }
        books.chance.add(sent);
        books.chance.add(through);
        let (onward, density, wi) = if let Some(sector) = self.only_way(flight, arrival) {
            // What goes where nothing is escapes without chance.
            let onward = scattered.reflected * sector.share();
            books.escaped.add(sent);
            books.escaped.take(scale.quanta(onward));
            books.chance.take(sent);
            books.chance.add(scale.quanta(onward));
            let wi = sector.direction(flight.sampler.point(Use::Direction));
            (onward, None, wi)
        } else if let Some(sample) = scattered.onward {
            (met * sample.weight, Some(sample.density), sample.wi)
        } else {
            return false;
        };
        let Some(power) = flight.survivor(met, onward) else {
            return false;
        };
        books.chance.take(scale.quanta(power));
        flight.depth += 1;
        if flight.depth > self.max_depth {
            books.lost.add(scale.quanta(power));
            return false;
        }

        // On to the next surface.
        let ends = [-flight.ray.direction, wi];
        let frame = arrival.frame();
        self.bodies
            .cross(&mut flight.media, &arrival.point, &frame, ends);
        flight.history = match (flight.history, density) {
            (History::Direct | History::Specular, Some(Density::Delta)) => History::Specular,
            _ => History::Diffuse,
        };
        flight.power = power;
        flight.ray = arrival.point.spawn_ray(wi);
        true
    }

    /// The directions in which something may be, for a photon that a plane far from the scene throws back.
    fn only_way(&self, flight: &Flight, arrival: &Arrival<'_>) -> Option<Sector> {
        if !arrival.is_plane || flight.strength <= 1.0 {
            return None;
        }
        let up = arrival.frame().facing_normal(-flight.ray.direction);
        self.ground.as_ref()?.sector(arrival.point.position, up)
    }
}

impl Arrival<'_> {
    fn frame(&self) -> ScatteringFrame {
        ScatteringFrame {
            normal_g: self.point.normal_g,
            normal_s: self.point.normal_s,
        }
    }

    /// Where the power of a photon goes here, and in which direction the photon does.
    fn scattered(&self, flight: &Flight) -> Scattered {
        let (scattering, frame) = (&self.optics.scattering, self.frame());
        let (met, wo) = (flight.power, -flight.ray.direction);
        let numbers = ScatterNumbers {
            direction: flight.sampler.point(Use::Direction),
            lobe: if scattering.is_matt() {
                DVec2::ZERO
            } else {
                flight.sampler.point(Use::Lobe)
            },
        };
        let onward = scattering.sample(&frame, wo, numbers, Transport::Importance);
        let is_in_front = frame.is_in_front(wo);
        let (reflected, transmitted) = if scattering.is_matt() && frame.normal_g == frame.normal_s {
            let side = scattering.sides[usize::from(!is_in_front)];
            (met * side.reflectance, met * side.transmittance)
        } else {
            let sent = |to_front: bool| {
                let sample = onward.filter(|sample| frame.is_in_front(sample.wi) == to_front);
                sample.map_or(Rgb::BLACK, |sample| met * sample.weight)
            };
            (sent(is_in_front), sent(!is_in_front))
        };
        Scattered {
            reflected,
            transmitted,
            onward,
        }
    }

    fn hit(&self, flight: &Flight, met: Rgb, scattered: &Scattered) -> PhotonHit<'_> {
        let transmitted = scattered.transmitted + met * self.straight;
        PhotonHit {
            point: &self.point,
            optics: &self.optics,
            wo: -flight.ray.direction,
            power: met,
            absorbed: met - scattered.reflected - transmitted,
            reflected: scattered.reflected,
            transmitted,
            depth: flight.depth,
            history: flight.history,
        }
    }
}

impl Flight {
    /// Russian roulette: the power with which the photon goes on that met a surface with the power `met` and would leave it with
    /// `sent`, or `None` if it does not. Its strongest channel stays as strong as it was, so that photons stay alike
    /// ([`Jensen2001`, §5.2](crate::references#jensen2001)); one that is stronger than others comes down to them.
    fn survivor(&mut self, met: Rgb, sent: Rgb) -> Option<Rgb> {
        let usual = met.max_channel() / self.strength;
        let survival = sent.max_channel() / usual;
        if survival.is_nan() || survival <= 0.0 {
            return None;
        }
        if survival >= 1.0 {
            self.strength = survival.min(self.strength);
            return Some(sent);
        }
        self.strength = 1.0;
        (self.sampler.point(Use::Choice).y < survival).then(|| sent / survival)
    }
}
