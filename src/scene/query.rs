//! What a ray meets: the walk through groups within groups, and the questions asked with it.

use super::Scene;
use super::bake::WorldPlane;
use super::group::{Group, Item, ItemKind};
use crate::accel::{BoxRay, TraversalStack};
use crate::color::Rgb;
use crate::geometry::interval::{Interval, Line};
use crate::geometry::triangle::{FlatHit, Shear, intersect_parallelogram, intersect_triangle};
use crate::geometry::unit::Face;
use crate::math::tolerance::gamma;
use crate::math::{Bounds3, PrimitiveId, Ray};
use glam::DAffine3;
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
trait Sink {
    /// Whether all intersections are wanted, not only the nearest of each primitive.
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
        let Some(root) = self.groups.last() else {
            return ControlFlow::Continue(());
        };
        let place = Place {
            group: root,
            first: 0,
            offset: 0.0,
        };
        let line = Line {
            origin: ray.origin,
            direction: ray.direction,
        };
        let line = transformed(&line, &self.to_root);
        let mut walk = Walk {
            scene: self,
            ray,
            sink,
        };
        walk.visit(place, &line, &mut TraversalStack::default())
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

/// A group somewhere in the world.
#[derive(Clone, Copy)]
struct Place<'s> {
    group: &'s Group,
    /// World number of the group's first primitive here.
    first: u64,
    /// What has to be added to parameters of the line in this group to get those of the ray.
    offset: f64,
}

struct Walk<'s, 'k, S> {
    scene: &'s Scene,
    ray: &'k Ray,
    sink: &'k mut S,
}

/// The line and what was prepared of it for one group.
struct Prepared {
    line: Line,
    shear: Shear,
}

impl<S: Sink> Walk<'_, '_, S> {
    /// The interval that still counts, in parameters of a line that starts `offset` later than the ray.
    ///
    /// It ends later by what the difference may be rounded, so that nothing is lost that lies just at the end; what is
    /// found is judged by [`Sink::wants`] in the ray's own parameter.
    #[inline]
    fn interval(&self, offset: f64) -> Interval {
        let whole = self.sink.interval();
        Interval {
            after: whole.after - offset,
            until: whole.until - offset + gamma(4) * (whole.until + offset),
        }
    }

    /// Visits a group along a line given in the group's frame.
    fn visit(&mut self, place: Place, line: &Line, stack: &mut TraversalStack) -> ControlFlow<()> {
        // Start where the line enters the group, so that how far away the ray began costs no digits inside it.
        let Some(shift) = enter(&place.group.bounds, line, self.interval(place.offset)) else {
            return ControlFlow::Continue(());
        };
        let line = Line {
            origin: line.at(shift),
            direction: line.direction,
        };
        let place = Place {
            offset: place.offset + shift,
            ..place
        };
        let prepared = Prepared {
            line,
            shear: Shear::new(&line),
        };

        let box_ray = BoxRay::new(line.origin, line.direction);
        let start = box_ray.start(self.sink.start() - place.offset);
        let limit = box_ray.limit(self.interval(place.offset).until);
        place
            .group
            .bvh
            .traverse(&box_ray, start..=limit, stack, |range, stack| {
                for item in &place.group.items[range] {
                    if self.offer(*item, place, &prepared, stack).is_break() {
                        return ControlFlow::Break(());
                    }
                }
                ControlFlow::Continue(box_ray.limit(self.interval(place.offset).until))
            })
    }

    /// Offers what the line meets of one item.
    #[inline]
    fn offer(
        &mut self,
        item: Item,
        place: Place,
        prepared: &Prepared,
        stack: &mut TraversalStack,
    ) -> ControlFlow<()> {
        let interval = self.interval(place.offset);
        match item.kind() {
            ItemKind::Triangle(index) => {
                let triangle = &place.group.triangles[index];
                let corners = triangle
                    .corners
                    .map(|corner| &place.group.vertices[corner as usize]);
                match intersect_triangle(&prepared.shear, corners, interval) {
                    Some(hit) => self.take_flat(place, triangle.number, hit),
                    None => ControlFlow::Continue(()),
                }
            }
            ItemKind::Quad(index) => {
                let quad = &place.group.quads[index];
                match intersect_parallelogram(&prepared.shear, quad.corner, quad.edges, interval) {
                    Some(hit) => self.take_flat(place, quad.number, hit),
                    None => ControlFlow::Continue(()),
                }
            }
            ItemKind::Solid(index) => self.offer_solid(index, place, &prepared.line),
            ItemKind::Instance(index) => {
                let instance = &place.group.instances[index];
                let inner = Place {
                    group: &self.scene.groups[instance.group as usize],
                    first: place.first + instance.first,
                    offset: place.offset,
                };
                self.visit(
                    inner,
                    &transformed(&prepared.line, &place.group.to_child(instance)),
                    stack,
                )
            }
        }
    }

    #[inline]
    fn take_flat(&mut self, place: Place, number: u32, hit: FlatHit) -> ControlFlow<()> {
        let primitive = PrimitiveId(place.first + u64::from(number));
        if primitive == self.ray.skip {
            return ControlFlow::Continue(());
        }
        let FlatHit { t, u, v } = hit;
        let hit = Hit {
            t: t + place.offset,
            primitive,
            u,
            v,
            face: Face::Side,
        };
        if !self.sink.wants(&hit) {
            return ControlFlow::Continue(());
        }
        self.take(place, number, hit)
    }

    fn offer_solid(&mut self, index: usize, place: Place, line: &Line) -> ControlFlow<()> {
        let solid = &place.group.solids[index];
        let primitive = PrimitiveId(place.first + u64::from(solid.number));
        if primitive == self.ray.skip {
            return ControlFlow::Continue(());
        }
        let line = transformed(line, &solid.to_unit);
        let mut interval = self.interval(place.offset);
        while let Some((t, face)) = solid.form.intersect(&line, interval) {
            let hit = Hit {
                t: t + place.offset,
                primitive,
                u: 0.0,
                v: 0.0,
                face,
            };
            interval.after = t;
            if !self.sink.wants(&hit) {
                continue;
            }
            self.take(place, solid.number, hit)?;
            if !S::EVERY {
                break;
            }
        }
        ControlFlow::Continue(())
    }

    #[inline]
    fn take(&mut self, place: Place, number: u32, hit: Hit) -> ControlFlow<()> {
        let (scene, ray) = (self.scene, self.ray);
        self.sink.take(hit, |hit| {
            if place.group.is_opaque {
                Rgb::BLACK
            } else {
                scene.passage(ray, hit, place.group.shape_of(number).material)
            }
        })
    }
}

/// The same line in another frame; the parameter keeps its meaning.
#[inline]
fn transformed(line: &Line, map: &DAffine3) -> Line {
    Line {
        origin: map.transform_point3(line.origin),
        direction: map.transform_vector3(line.direction),
    }
}

/// Where the line enters the box, or 0 if it starts inside; `None` if it misses the box within the interval.
#[inline]
fn enter(bounds: &Bounds3, line: &Line, interval: Interval) -> Option<f64> {
    /// Two roundings each way.
    const SLACK: f64 = 1.0 + 4.0 * f64::EPSILON;
    let (mut enter, mut exit) = (interval.after.max(0.0), interval.until);
    for axis in 0..3 {
        let inverse = 1.0 / line.direction[axis];
        let at_min = (bounds.min[axis] - line.origin[axis]) * inverse;
        let at_max = (bounds.max[axis] - line.origin[axis]) * inverse;
        let (near, far) = if inverse < 0.0 {
            (at_max, at_min)
        } else {
            (at_min, at_max)
        };
        // 0 · ∞ is NaN, for a line in the plane of a face; it compares false and changes nothing.
        enter = if near > enter { near } else { enter };
        exit = if far * SLACK < exit {
            far * SLACK
        } else {
            exit
        };
    }
    let starts_inside = line.origin.cmpge(bounds.min).all() && line.origin.cmple(bounds.max).all();
    let shift = if starts_inside { 0.0 } else { enter };
    // A line beside a face that it is parallel to, or an empty box, is entered at infinity.
    (enter <= exit && enter < f64::INFINITY).then_some(shift)
}
