//! What a ray meets: the questions, and what is kept of what the [walk](super::walk) finds.

use super::Scene;
use super::planes::WorldPlane;
use super::walk::{Walk, transformed};
use crate::accel::dispatch;
use crate::color::Rgb;
use crate::geometry::interval::{Interval, Line};
use crate::geometry::unit::Face;
use crate::math::{PrimitiveId, Ray};
use std::ops::ControlFlow;

/// The nearest surface along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance from the ray's origin, in metres.
    pub t: f64,
    /// What was hit.
    pub primitive: PrimitiveId,
    /// Triangle: weight of the second corner; parallelogram: fraction along its first edge; otherwise 0.
    pub u: f64,
    /// Triangle: weight of the third corner; parallelogram: fraction along its second edge; otherwise 0.
    pub v: f64,
    /// Which part of the primitive.
    pub(super) face: Face,
}

/// Planes are numbered from here, above all other primitives.
pub(super) const FIRST_PLANE: u64 = 1 << 63;

/// What the walk does with what it finds.
pub(super) trait Sink {
    /// Whether all intersections are wanted, in whatever order, not only the nearest.
    const EVERY: bool;
    /// The part of the ray that still counts.
    fn interval(&self) -> Interval;
    /// What lies wholly nearer than this does not count either, and need not be looked at.
    fn start(&self) -> f64 {
        self.interval().after
    }
    /// Whether an intersection inside the interval counts.
    fn wants(&self, hit: &Hit) -> bool {
        hit.t <= self.interval().until
    }
    /// Is told of a surface inside the interval that lets nothing through; for sinks that want every one, and not where it is.
    fn block(&mut self) -> ControlFlow<()>;
    /// Takes an intersection inside the interval; `passage` tells what it lets straight through.
    fn take(&mut self, hit: Hit, passage: impl FnOnce(&Hit) -> Rgb) -> ControlFlow<()>;
}

/// Keeps the nearest intersection; of several at the same distance, the one with the lowest number.
struct Nearest {
    after: f64,
    until: f64,
    /// Only what comes later than this in the order of distance and number counts.
    passed: Option<Passed>,
    best: Option<Hit>,
}

/// A place in the order of a ray's intersections.
type Passed = (f64, PrimitiveId);

impl Sink for Nearest {
    const EVERY: bool = false;

    #[inline]
    fn interval(&self) -> Interval {
        Interval {
            after: self.after,
            until: self.until,
        }
    }

    #[inline]
    fn start(&self) -> f64 {
        self.passed.map_or(self.after, |(t, _)| t)
    }

    #[inline]
    fn wants(&self, hit: &Hit) -> bool {
        let is_later = |passed| (hit.t, hit.primitive) > passed;
        hit.t <= self.until && self.passed.is_none_or(is_later)
    }

    #[inline]
    fn block(&mut self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    #[inline]
    fn take(&mut self, hit: Hit, _: impl FnOnce(&Hit) -> Rgb) -> ControlFlow<()> {
        let is_nearer = |best: Hit| (hit.t, hit.primitive) < (best.t, best.primitive);
        if self.best.is_none_or(is_nearer) {
            self.until = hit.t;
            self.best = Some(hit);
        }
        ControlFlow::Continue(())
    }
}

/// Multiplies what each surface lets through.
struct Transmittance {
    interval: Interval,
    value: Rgb,
}

impl Sink for Transmittance {
    const EVERY: bool = true;

    #[inline]
    fn interval(&self) -> Interval {
        self.interval
    }

    #[inline]
    fn block(&mut self) -> ControlFlow<()> {
        self.value = Rgb::BLACK;
        ControlFlow::Break(())
    }

    #[inline]
    fn take(&mut self, hit: Hit, passage: impl FnOnce(&Hit) -> Rgb) -> ControlFlow<()> {
        self.value *= passage(&hit);
        if self.value.is_black() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

impl Scene {
    /// The nearest surface along the ray, however transparent; at equal distance, the primitive with the lowest number.
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.nearest(ray, None)
    }

    /// The next surface along the same ray after `hit`, one of its intersections: the next in the order of distance and,
    /// at equal distance, of numbers. So surfaces that lie in one another are found one after the other, each once.
    #[must_use]
    pub fn closest_after(&self, ray: &Ray, hit: &Hit) -> Option<Hit> {
        self.nearest(ray, Some((hit.t, hit.primitive)))
    }

    fn nearest(&self, ray: &Ray, passed: Option<Passed>) -> Option<Hit> {
        // The interval is that of the whole ray whatever was passed: it decides where parameters are counted from, and
        // they must be the same bits each time to be compared.
        let mut sink = Nearest {
            after: ray.t_min,
            until: ray.t_max,
            passed,
            best: None,
        };
        let _ = self.walk(ray, &mut sink);
        sink.best
    }

    /// The fraction of light per channel that the surfaces along the ray let straight through: the product of their
    /// [passages](crate::material::Optics::passage), black as soon as one is opaque, 1 if there are none.
    #[must_use]
    pub fn transmittance(&self, ray: &Ray) -> Rgb {
        let interval = Interval {
            after: ray.t_min,
            until: ray.t_max,
        };
        let mut sink = Transmittance {
            interval,
            value: Rgb::WHITE,
        };
        match self.walk(ray, &mut sink) {
            ControlFlow::Continue(()) => sink.value,
            ControlFlow::Break(()) => Rgb::BLACK,
        }
    }

    /// Whether no light at all comes straight through the surfaces along the ray.
    #[must_use]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.transmittance(ray).is_black()
    }

    /// Offers everything along the ray to the sink.
    fn walk<S: Sink>(&self, ray: &Ray, sink: &mut S) -> ControlFlow<()> {
        for (index, plane) in self.planes.iter().enumerate() {
            let primitive = PrimitiveId(FIRST_PLANE + index as u64);
            if primitive != ray.skip {
                self.offer_plane(plane, primitive, ray, sink)?;
            }
        }
        let line = Line {
            origin: ray.origin,
            direction: ray.direction,
        };
        match self.groups.last() {
            Some(root) => dispatch(Walk {
                scene: self,
                root,
                line: transformed(&line, &self.to_root),
                ray,
                sink,
            }),
            None => ControlFlow::Continue(()),
        }
    }

    fn offer_plane<S: Sink>(
        &self,
        plane: &WorldPlane,
        primitive: PrimitiveId,
        ray: &Ray,
        sink: &mut S,
    ) -> ControlFlow<()> {
        let line = Line {
            origin: ray.origin,
            direction: ray.direction,
        };
        let line = transformed(&line, &plane.to_plane);
        let t = -line.origin.z / line.direction.z;
        if !sink.interval().contains(t) {
            return ControlFlow::Continue(());
        }
        let at = line.at(t);
        let hit = Hit {
            t,
            primitive,
            u: at.x,
            v: at.y,
            face: Face::Side,
        };
        if !sink.wants(&hit) {
            return ControlFlow::Continue(());
        }
        sink.take(hit, |hit| self.passage(ray, hit, plane.shape.material))
    }
}
