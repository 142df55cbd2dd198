//! How a ray gets to what it may meet: through the hierarchies of groups within groups.

use super::Scene;
use super::group::{Group, Item, ItemKind};
use super::query::{Hit, Sink};
use crate::accel::{BoxRay, Kernel, Lanes, Step, Visitor, Walking, walk};
use crate::color::Rgb;
use crate::geometry::interval::{Interval, Line};
use crate::geometry::triangle::{FlatHit, Shear, intersect_parallelogram, intersect_triangle};
use crate::geometry::unit::Face;
use crate::math::tolerance::gamma;
use crate::math::{Bounds3, PrimitiveId, Ray};
use glam::{DAffine3, DVec3};
use std::ops::ControlFlow;

/// The walk of one ray through everything but infinite planes.
pub(super) struct Walk<'s, 'k, S> {
    pub(super) scene: &'s Scene,
    pub(super) root: &'s Group,
    /// The ray in the frame of the root.
    pub(super) line: Line,
    pub(super) ray: &'k Ray,
    /// What is done with what is found.
    pub(super) sink: &'k mut S,
}

impl<S: Sink> Kernel for Walk<'_, '_, S> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> ControlFlow<()> {
        let Self {
            scene,
            root,
            line,
            ray,
            sink,
        } = self;
        let Some((shift, inverse)) = enter(&root.bounds, &line, interval(sink, 0.0)) else {
            return ControlFlow::Continue(());
        };
        let at = Place::new(root, 0, [0.0, shift], &line, inverse);
        let mut visit = Visit {
            scene,
            ray,
            sink,
            at,
            root: None,
            depth: 0,
            between: Vec::new(),
        };
        let walking = visit.walking();
        walk::<V, _>(walking, &mut visit)
    }
}

/// A group somewhere in the world, and the ray there.
#[derive(Clone, Copy)]
struct Place<'s> {
    group: &'s Group,
    /// World number of the group's first primitive here.
    first: u64,
    /// What has to be added to parameters of the line in this group to get those of the ray.
    offset: f64,
    line: Line,
    shear: Shear,
    box_ray: BoxRay,
}

impl<'s> Place<'s> {
    /// The group with a line given in its frame, which starts `offset` later than the ray and enters the group another `shift`
    /// later; `inverse` is 1 / its direction.
    #[inline(always)]
    fn new(
        group: &'s Group,
        first: u64,
        [offset, shift]: [f64; 2],
        line: &Line,
        inverse: DVec3,
    ) -> Self {
        // Start where the line enters the group, so that how far away the ray began costs no digits inside it.
        let line = Line {
            origin: line.at(shift),
            direction: line.direction,
        };
        Self {
            group,
            first,
            offset: offset + shift,
            line,
            shear: Shear::new(&line),
            box_ray: BoxRay::new(line.origin, line.direction, inverse),
        }
    }
}

/// The interval that still counts, in parameters of a line that starts `offset` later than the ray.
///
/// It ends later by what the difference may be rounded, so that nothing is lost that lies just at the end; what is
/// found is judged by [`Sink::wants`] in the ray's own parameter.
#[inline(always)]
fn interval<S: Sink>(sink: &S, offset: f64) -> Interval {
    let whole = sink.interval();
    Interval {
        after: whole.after - offset,
        until: whole.until - offset + gamma(4) * (whole.until + offset),
    }
}

/// A walk under way.
struct Visit<'s, 'k, S> {
    scene: &'s Scene,
    ray: &'k Ray,
    sink: &'k mut S,
    at: Place<'s>,
    /// Where it began, once an instance has been entered; kept, because most are entered from there.
    root: Option<Place<'s>>,
    /// How many instances lie around `at`.
    depth: usize,
    /// The places between the root and `at`.
    between: Vec<Place<'s>>,
}

impl<'s, S: Sink> Visitor<'s> for Visit<'s, '_, S> {
    const NEAREST_FIRST: bool = !S::EVERY;

    #[inline(always)]
    fn leaf<V: Lanes>(&mut self, leaf: u32, part: [f32; 2]) -> Step<'s> {
        let [_, limit] = part;
        let done = match Item::from_bits(leaf).map(Item::kind) {
            Some(ItemKind::Block(index)) => self.offer_block::<V>(index, part),
            Some(ItemKind::Solid(index)) => self.offer_solid(index),
            Some(kind @ (ItemKind::Instance(index) | ItemKind::TwoInstances(index))) => {
                let second = Item::new(ItemKind::Instance(index + 1)).bits();
                let is_two = matches!(kind, ItemKind::TwoInstances(_));
                return self.enter(index, is_two.then_some(second), limit);
            }
            Some(ItemKind::Triangle(_) | ItemKind::Quad(_)) | None => ControlFlow::Continue(()),
        };
        match done {
            ControlFlow::Continue(()) => Step::Continue(self.limit()),
            ControlFlow::Break(()) => Step::Stop,
        }
    }

    #[inline(always)]
    fn soon<V: Lanes>(&self, leaf: u32) {
        let group = self.at.group;
        match Item::from_bits(leaf).map(Item::kind) {
            Some(ItemKind::Block(index)) => {
                if let Some(block) = group.blocks.get(index) {
                    V::prefetch(block);
                }
            }
            Some(ItemKind::Instance(index) | ItemKind::TwoInstances(index)) => {
                if let Some(instance) = group.instances.get(index) {
                    V::prefetch(instance);
                }
            }
            _ => {}
        }
    }

    #[inline(always)]
    fn leave(&mut self) -> Walking<'s> {
        self.depth = self.depth.saturating_sub(1);
        let outer = match self.depth {
            0 => self.root,
            _ => self.between.pop(),
        };
        self.at = outer.expect("invariant: what is entered from is kept");
        self.walking()
    }
}

impl<'s, S: Sink> Visit<'s, '_, S> {
    /// The end of what counts, for box tests here.
    #[inline(always)]
    fn limit(&self) -> f32 {
        let until = interval(self.sink, self.at.offset).until;
        self.at.box_ray.limit(until)
    }

    #[inline(always)]
    fn walking(&self) -> Walking<'s> {
        Walking {
            bvh: &self.at.group.bvh,
            ray: self.at.box_ray,
            start: self.at.box_ray.start(self.sink.start() - self.at.offset),
            limit: self.limit(),
        }
    }

    /// Goes into an instance, or on to the rest of the leaf if the ray misses it.
    #[inline(always)]
    fn enter(&mut self, index: usize, rest: Option<u32>, limit: f32) -> Step<'s> {
        let at = &self.at;
        let instance = &at.group.instances[index];
        let group = &self.scene.groups[instance.group as usize];
        let line = transformed(&at.line, &at.group.to_child(instance));
        let first = at.first + instance.first;
        let offset = at.offset;
        match enter(&group.bounds, &line, interval(self.sink, offset)) {
            Some((shift, inverse)) => {
                if self.depth > 0 {
                    self.between.push(self.at);
                } else if self.root.is_none() {
                    self.root = Some(self.at);
                }
                self.depth += 1;
                self.at = Place::new(group, first, [offset, shift], &line, inverse);
                Step::Enter(self.walking(), rest)
            }
            None => rest.map_or(Step::Continue(limit), Step::Look),
        }
    }

    /// Offers what the ray meets of eight flat primitives.
    #[inline(always)]
    fn offer_block<V: Lanes>(&mut self, index: usize, [near, limit]: [f32; 2]) -> ControlFlow<()> {
        let Some(block) = self.at.group.blocks.get(index) else {
            return ControlFlow::Continue(());
        };
        let start = self.at.box_ray.start(self.sink.start() - self.at.offset);
        let candidates = block.candidates::<V>(&self.at.shear, [near, start, limit]);
        let mut lanes = candidates.possible;
        if S::EVERY && self.at.group.is_opaque && candidates.certain != 0 {
            // Nothing comes through, whichever it is that is hit: no need to fetch it and see exactly where.
            let own = self.own_name();
            let mut certain = candidates.certain;
            while certain != 0 {
                if block.name(certain.trailing_zeros() as usize) != own {
                    return self.sink.block();
                }
                certain &= certain - 1;
            }
        }
        while lanes != 0 {
            let name = block.name(lanes.trailing_zeros() as usize);
            lanes &= lanes - 1;
            self.offer_flat(name)?;
        }
        ControlFlow::Continue(())
    }

    /// Offers a triangle or parallelogram, if the ray meets it.
    #[inline(always)]
    fn offer_flat(&mut self, name: u32) -> ControlFlow<()> {
        let group = self.at.group;
        let interval = interval(self.sink, self.at.offset);
        let (number, hit) = match Item::from_bits(name).map(Item::kind) {
            Some(ItemKind::Triangle(index)) => {
                let triangle = &group.triangles[index];
                let [a, b, c] = &triangle.corners;
                let hit = intersect_triangle(&self.at.shear, [a, b, c], interval);
                (triangle.number, hit)
            }
            Some(ItemKind::Quad(index)) => {
                let quad = &group.quads[index];
                let hit =
                    intersect_parallelogram(&self.at.shear, quad.corner, quad.edges, interval);
                (quad.number, hit)
            }
            _ => (0, None),
        };
        let Some(FlatHit { t, u, v }) = hit else {
            return ControlFlow::Continue(());
        };
        let hit = self.hit(number, [t, u, v], Face::Side);
        if hit.primitive == self.ray.skip || !self.sink.wants(&hit) {
            return ControlFlow::Continue(());
        }
        self.take(number, hit)
    }

    fn offer_solid(&mut self, index: usize) -> ControlFlow<()> {
        let solid = &self.at.group.solids[index];
        if self.primitive(solid.number) == self.ray.skip {
            return ControlFlow::Continue(());
        }
        let line = transformed(&self.at.line, &solid.to_unit);
        let mut interval = interval(self.sink, self.at.offset);
        while let Some((t, face)) = solid.form.intersect(&line, interval) {
            interval.after = t;
            let hit = self.hit(solid.number, [t, 0.0, 0.0], face);
            if !self.sink.wants(&hit) {
                continue;
            }
            self.take(solid.number, hit)?;
            if !S::EVERY {
                break;
            }
        }
        ControlFlow::Continue(())
    }

    /// What the primitive that the ray starts on is called in this group; 0 if it is not in it.
    #[inline(always)]
    fn own_name(&self) -> u32 {
        let number = self.ray.skip.0.wrapping_sub(self.at.first);
        let place = usize::try_from(number)
            .ok()
            .and_then(|number| self.at.group.places.get(number));
        place.copied().flatten().map_or(0, Item::bits)
    }

    /// The number in the world of a primitive here.
    #[inline(always)]
    fn primitive(&self, number: u32) -> PrimitiveId {
        PrimitiveId(self.at.first + u64::from(number))
    }

    /// The hit at parameter t of the line here, with coordinates u and v.
    #[inline(always)]
    fn hit(&self, number: u32, [t, u, v]: [f64; 3], face: Face) -> Hit {
        Hit {
            t: t + self.at.offset,
            primitive: self.primitive(number),
            u,
            v,
            face,
        }
    }

    #[inline(always)]
    fn take(&mut self, number: u32, hit: Hit) -> ControlFlow<()> {
        let (scene, ray, group) = (self.scene, self.ray, self.at.group);
        self.sink.take(hit, |hit| {
            if group.is_opaque {
                Rgb::BLACK
            } else {
                scene.passage(ray, hit, group.shape_of(number).material)
            }
        })
    }
}

/// The same line in another frame; the parameter keeps its meaning.
#[inline(always)]
pub(super) fn transformed(line: &Line, map: &DAffine3) -> Line {
    Line {
        origin: map.transform_point3(line.origin),
        direction: map.transform_vector3(line.direction),
    }
}

/// Where the line enters the box, or 0 if it starts inside, and 1 / its direction; `None` if it misses the box within the
/// interval.
#[inline(always)]
fn enter(bounds: &Bounds3, line: &Line, interval: Interval) -> Option<(f64, DVec3)> {
    /// Two roundings each way.
    const SLACK: f64 = 1.0 + 4.0 * f64::EPSILON;
    let reciprocal = 1.0 / line.direction;
    let (mut enter, mut exit) = (interval.after.max(0.0), interval.until);
    for axis in 0..3 {
        let inverse = reciprocal[axis];
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
    (enter <= exit && enter < f64::INFINITY).then_some((shift, reciprocal))
}
