//! Each kind of source: where a photon leaves it, and with how much power.

use super::emission::{Aim, Emission};
use crate::color::Rgb;
use crate::light::{Light, LightSample};
use crate::math::frame::Frame;
use crate::math::{Ray, warp};
use crate::scene::EmitterId;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// A source of photons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// Index into the scene's lights.
    Lamp(usize),
    Sun,
    Sky,
    /// What the sky shows below the horizon where light sampling does not look.
    Land,
    /// The front (`true`) or back of a surface that shines.
    Emitter(EmitterId, bool),
}

/// A ray that leaves a source.
pub(super) struct Start {
    pub(super) ray: Ray,
    /// Power of the source along the ray over the density of the ray, W per channel: on average, the power of the source.
    pub(super) power: Rgb,
    pub(super) is_direct: bool,
    /// How many times more power it stands for than a ray of the source to what is wanted; at least 1.
    pub(super) strength: f64,
}

impl Source {
    pub(super) const KINDS: usize = 4;

    pub(super) fn kind(self) -> usize {
        match self {
            Self::Lamp(_) => 0,
            Self::Sun => 1,
            Self::Sky | Self::Land => 2,
            Self::Emitter(..) => 3,
        }
    }
}

impl Emission<'_> {
    /// Power of a source where it is known on paper.
    pub(super) fn known_power(&self, source: Source) -> Option<Rgb> {
        let aims_everywhere = self.targets.is_boundless();
        match source {
            Source::Lamp(index) => match self.scene.lights()[index] {
                ref lamp @ Light::Point { position, .. } => {
                    let all = self.targets.solid_angle(position) >= 4.0 * PI;
                    all.then(|| lamp.power(1.0))
                }
                ref lamp @ (Light::Spot { .. } | Light::Directional { .. }) => {
                    let is_whole = aims_everywhere && matches!(lamp, Light::Spot { .. });
                    is_whole.then(|| lamp.power(1.0))
                }
            },
            Source::Emitter(id, is_front) if self.aim == Aim::Everything => {
                let emitter = &self.scene.emitters()[id.0 as usize];
                let radiance = self
                    .scene
                    .material(emitter.material)
                    .emitted_radiance(is_front);
                Some(radiance * (PI * emitter.area()))
            }
            Source::Sun | Source::Sky | Source::Land | Source::Emitter(..) => None,
        }
    }

    /// A ray out of a source, from two points of the unit square.
    pub(super) fn leave(&self, source: Source, place: DVec2, direction: DVec2) -> Option<Start> {
        match source {
            Source::Lamp(index) => match &self.scene.lights()[index] {
                Light::Directional {
                    direction,
                    irradiance,
                    origin,
                } => {
                    let line = self.targets.line(*direction, place)?;
                    // From the plane where the light begins, whatever stands upstream of the target.
                    let along = (line.point - *origin).dot(*direction);
                    let start = line.point - *direction * along;
                    Some(Start {
                        ray: Ray::new(start, *direction),
                        power: *irradiance * line.area,
                        is_direct: true,
                        strength: line.strength,
                    })
                }
                lamp @ (Light::Point { position, .. } | Light::Spot { position, .. }) => {
                    self.leave_lamp(lamp, *position, direction)
                }
            },
            Source::Sun => {
                let light = self.sun.as_ref()?.sample(direction);
                self.arrive(&light, place, true)
            }
            Source::Sky => self.arrive(&self.dome.sample(direction)?, place, true),
            Source::Land => {
                let light = LightSample {
                    wi: warp::direction(-direction.x, direction.y),
                    distance: f64::INFINITY,
                    facing_irradiance: self.land_radiance() * TAU,
                    pdf_solid_angle: Some(1.0 / TAU),
                };
                self.arrive(&light, place, false)
            }
            Source::Emitter(id, is_front) => self.leave_surface(id, is_front, place, direction),
        }
    }

    /// What the sky shows below the horizon, if light sampling leaves it out.
    pub(super) fn land_radiance(&self) -> Rgb {
        if self.dome.pdf_solid_angle(DVec3::NEG_Z) > 0.0 || !self.dome.has_land() {
            Rgb::BLACK
        } else {
            self.dome.radiance(DVec3::NEG_Z)
        }
    }

    fn leave_lamp(&self, lamp: &Light, position: DVec3, u: DVec2) -> Option<Start> {
        let beam = match lamp {
            Light::Spot { outer, .. } => warp::cone_solid_angle(outer.radians()),
            Light::Point { .. } | Light::Directional { .. } => 4.0 * PI,
        };
        let (w, power) = if beam <= self.targets.solid_angle(position) {
            (lamp.emit(u)?, lamp.power(1.0))
        } else {
            let aimed = self.targets.direction(position, u)?;
            // The irradiance at a metre is the intensity.
            let light = lamp.illuminate(position + aimed.direction)?;
            (aimed.direction, light.facing_irradiance * aimed.solid_angle)
        };
        Some(Start {
            ray: Ray::new(position, w),
            power,
            is_direct: true,
            strength: 1.0,
        })
    }

    fn leave_surface(
        &self,
        id: EmitterId,
        is_front: bool,
        place: DVec2,
        u: DVec2,
    ) -> Option<Start> {
        let emitter = &self.scene.emitters()[id.0 as usize];
        let at = emitter.sample(place.to_array());
        let normal = if is_front { at.normal } else { -at.normal };
        let radiance = self
            .scene
            .material(emitter.material)
            .emitted_radiance(is_front);
        // A target that fills half the sky is met by the cosine's directions as well.
        let is_aimed = self.aim == Aim::Specular && self.targets.solid_angle(at.position) < PI;
        let (w, projected) = if is_aimed {
            let aimed = self.targets.direction(at.position, u)?;
            let cosine = aimed.direction.dot(normal);
            (aimed.direction, cosine * aimed.solid_angle)
        } else {
            (
                Frame::from_normal(normal).to_world(warp::cosine_hemisphere(u)),
                PI,
            )
        };
        (projected > 0.0 && w.dot(normal) > 0.0).then(|| Start {
            ray: emitter.spawn_ray(&at, w.normalize()),
            power: radiance * (projected / at.pdf_area),
            is_direct: true,
            strength: 1.0,
        })
    }

    /// A ray of light from far away along a line that passes the target.
    fn arrive(&self, light: &LightSample, place: DVec2, is_direct: bool) -> Option<Start> {
        let direction = -light.wi;
        let line = self.targets.line(direction, place)?;
        Some(Start {
            ray: Ray::new(self.before_all(line.point, direction), direction),
            power: light.facing_irradiance * line.area,
            is_direct,
            strength: line.strength,
        })
    }

    /// The point of a line of light where it has not met anything of the scene yet.
    fn before_all(&self, point: DVec3, direction: DVec3) -> DVec3 {
        if let Some(plot) = &self.plot {
            return plot.before_all(point, direction);
        }
        let bounds = self.bounds;
        let radius = bounds.diagonal().length();
        let back = (point - bounds.center()).dot(direction) + radius;
        let start = point - direction * back.max(0.0);
        if self.has_planes {
            // Infinite planes may stand anywhere upstream.
            let upstream = Ray::new(start, -direction);
            let mut last = None;
            let mut next = self.scene.closest(&upstream);
            while let Some(hit) = next {
                last = Some(hit.t);
                next = self.scene.closest_after(&upstream, &hit);
            }
            if let Some(t) = last {
                return start - direction * (t + radius);
            }
        }
        start
    }
}
