//! Surfaces that shine, for sampling.
//!
//! Each emitting primitive of the world is listed with its place, so that a light sampler needs no knowledge of groups.

use super::Scene;
use super::description::{MaterialId, OrganId};
use super::error::SceneError;
use super::group::{Group, ItemKind, ShapeRecord};
use super::query::Hit;
use super::subtended::{SeenBall, SeenRectangle};
use crate::color::Rgb;
use crate::geometry::area::RoundArea;
use crate::geometry::unit::UnitShape;
use crate::light::LampOutline;
use crate::math::tolerance::{SIMILARITY, SPAWN_SAFETY, gamma};
use crate::math::{Bounds3, PrimitiveId, Ray};
use glam::{DAffine3, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// How many emitters a scene may have; more are a mistake or need another kind of light source.
const LIMIT: usize = 1 << 22;

/// Index into [`Scene::emitters`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EmitterId(pub u32);

/// A primitive that shines, in world coordinates.
#[derive(Clone, Debug)]
pub struct Emitter {
    /// The primitive.
    pub primitive: PrimitiveId,
    /// Its material, which says how strongly each side shines.
    pub material: MaterialId,
    /// Its organ.
    pub organ: OrganId,
    area: f64,
    form: Form,
}

/// A point chosen on an emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmitterSample {
    /// The point, metres.
    pub position: DVec3,
    /// Unit normal of the front side.
    pub normal: DVec3,
    /// Density with which the point was chosen, per square metre.
    pub pdf_area: f64,
}

/// A point chosen on an emitter to light another point with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TowardSample {
    /// The point, metres.
    pub position: DVec3,
    /// Unit normal of the front side.
    pub normal: DVec3,
    /// Density per steradian, as seen from the lit point, with which it was chosen.
    pub pdf_solid_angle: f64,
}

/// How an emitter looks from a point.
enum Seen {
    /// With its front normal.
    Rectangle(SeenRectangle, DVec3),
    Ball(SeenBall),
    /// Nothing better is known than its area.
    ByArea,
}

#[derive(Clone, Debug)]
enum Form {
    /// Corner, two edges, and the front normal.
    Triangle(DVec3, [DVec3; 2], DVec3),
    /// Corner, two edges, and the front normal.
    Parallelogram(DVec3, [DVec3; 2], DVec3),
    /// The cube -1..=1, mapped into the world.
    Cube(DAffine3),
    /// A sphere, not stretched.
    Ball {
        center: DVec3,
        radius: f64,
        area: Box<RoundArea>,
    },
    /// A stretched sphere, a disk or a frustum.
    Round(Box<RoundArea>),
}

impl Emitter {
    /// Its area, in square metres.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Chooses a point of the surface. Uniform by area, except on spheres and frusta that are stretched unevenly, where
    /// the density varies mildly; it is always given with the point.
    ///
    /// `u` are two uniform random numbers in [0, 1).
    #[must_use]
    pub fn sample(&self, u: [f64; 2]) -> EmitterSample {
        let flat = |position, normal| EmitterSample {
            position,
            normal,
            pdf_area: 1.0 / self.area,
        };
        match &self.form {
            Form::Triangle(corner, edges, normal) => {
                // Square to triangle by folding at the square root, which keeps neighbours together.
                let root = u[0].sqrt();
                flat(
                    *corner + edges[0] * (root * (1.0 - u[1])) + edges[1] * (root * u[1]),
                    *normal,
                )
            }
            Form::Parallelogram(corner, edges, normal) => {
                flat(*corner + edges[0] * u[0] + edges[1] * u[1], *normal)
            }
            Form::Cube(to_world) => {
                let (position, normal) = sample_cube(to_world, self.area, u);
                flat(position, normal)
            }
            Form::Round(round) | Form::Ball { area: round, .. } => {
                let (position, normal) = round.sample(u);
                EmitterSample {
                    position,
                    normal,
                    pdf_area: round.pdf_area(normal),
                }
            }
        }
    }

    /// A ray that leaves the emitter at a point chosen by [`Emitter::sample`], starting off the surface on the side of
    /// `direction` (unit).
    #[must_use]
    pub fn spawn_ray(&self, at: &EmitterSample, direction: DVec3) -> Ray {
        // The point is the sum of a corner or centre and of edges or radii, each of which its size bounds.
        let size = at.position.abs().max_element() + self.area.sqrt();
        let off = (SPAWN_SAFETY * gamma(32) * size).copysign(direction.dot(at.normal));
        let skip = match self.form {
            Form::Triangle(..) | Form::Parallelogram(..) => self.primitive,
            Form::Cube(_) | Form::Ball { .. } | Form::Round(_) => PrimitiveId::NONE,
        };
        Ray {
            skip,
            ..Ray::new(at.position + at.normal * off, direction)
        }
    }

    /// Chooses a point of the surface to light `from` with, evenly over the solid angle it subtends there where that has a
    /// closed form (rectangles, balls), as [`Emitter::sample`] does otherwise. `None` if it is seen edge on, or from itself.
    ///
    /// `u` are two uniform random numbers in [0, 1).
    #[must_use]
    pub fn sample_toward(&self, from: DVec3, u: [f64; 2]) -> Option<TowardSample> {
        let chosen = match self.seen(from) {
            Seen::Rectangle(seen, normal) => TowardSample {
                position: seen.sample(u),
                normal,
                pdf_solid_angle: 1.0 / seen.solid_angle(),
            },
            Seen::Ball(seen) => {
                let (position, normal) = seen.sample(u);
                TowardSample {
                    position,
                    normal,
                    pdf_solid_angle: 1.0 / seen.solid_angle(),
                }
            }
            Seen::ByArea => {
                let EmitterSample {
                    position,
                    normal,
                    pdf_area,
                } = self.sample(u);
                TowardSample {
                    position,
                    normal,
                    pdf_solid_angle: solid_angle_density(pdf_area, position - from, normal)?,
                }
            }
        };
        Some(chosen)
    }

    /// The density per steradian with which [`Emitter::sample_toward`] chooses the point `at`, where the unit normal of the
    /// front is `normal`; 0 if it cannot.
    #[must_use]
    pub fn pdf_toward(&self, from: DVec3, at: DVec3, normal: DVec3) -> f64 {
        match self.seen(from) {
            Seen::Rectangle(seen, _) => 1.0 / seen.solid_angle(),
            // Only the half that is turned to the viewer is chosen.
            Seen::Ball(_) if normal.dot(from - at) <= 0.0 => 0.0,
            Seen::Ball(seen) => 1.0 / seen.solid_angle(),
            Seen::ByArea => {
                solid_angle_density(self.pdf_area(normal), at - from, normal).unwrap_or(0.0)
            }
        }
    }

    /// How it looks from a point.
    fn seen(&self, from: DVec3) -> Seen {
        match &self.form {
            Form::Parallelogram(corner, edges, normal) => SeenRectangle::new(from, *corner, *edges)
                .map_or(Seen::ByArea, |seen| Seen::Rectangle(seen, *normal)),
            Form::Ball { center, radius, .. } => {
                SeenBall::new(from, *center, *radius).map_or(Seen::ByArea, Seen::Ball)
            }
            Form::Triangle(..) | Form::Cube(_) | Form::Round(_) => Seen::ByArea,
        }
    }

    /// Where it is and where to it shines, its sides with these radiances, W/(m² sr).
    #[must_use]
    pub fn outline(&self, front: Rgb, back: Rgb) -> LampOutline {
        let corners = |corner: DVec3, [u, v]: [DVec3; 2], far: DVec3| {
            Bounds3::of([corner, corner + u, corner + v, far])
        };
        let (bounds, normal) = match &self.form {
            Form::Triangle(corner, edges, normal) => {
                (corners(*corner, *edges, *corner), Some(*normal))
            }
            Form::Parallelogram(corner, edges, normal) => {
                let far = *corner + edges[0] + edges[1];
                (corners(*corner, *edges, far), Some(*normal))
            }
            Form::Cube(to_world) => {
                let unit = Bounds3::of([DVec3::NEG_ONE, DVec3::ONE]);
                (unit.transformed(to_world), None)
            }
            Form::Ball { area, .. } => (area.bounds(), None),
            Form::Round(area) => (area.bounds(), area.flat_normal()),
        };
        let (front, back) = (front.sum(), back.sum());
        match normal {
            Some(normal) => LampOutline {
                bounds,
                axis: if front > 0.0 { normal } else { -normal },
                spread: 0.0,
                emission: FRAC_PI_2,
                is_two_sided: front > 0.0 && back > 0.0,
                strength: front.max(back) * self.area,
            },
            // What is convex shows a quarter of its area on average, and shines to all sides.
            None => LampOutline {
                bounds,
                axis: DVec3::Z,
                spread: PI,
                emission: FRAC_PI_2,
                is_two_sided: false,
                strength: 0.25 * (front + back) * self.area,
            },
        }
    }

    /// The density with which [`Emitter::sample`] chooses a point of the surface where the unit normal of the front is
    /// `normal`, per square metre.
    #[must_use]
    pub fn pdf_area(&self, normal: DVec3) -> f64 {
        match &self.form {
            Form::Round(round) | Form::Ball { area: round, .. } => round.pdf_area(normal),
            Form::Triangle(..) | Form::Parallelogram(..) | Form::Cube(_) => 1.0 / self.area,
        }
    }

    /// The emitter that a stored primitive becomes, or `None` if it has no area that can be counted.
    pub(super) fn new(
        group: &Group,
        kind: ItemKind,
        shape: &ShapeRecord,
        to_world: &DAffine3,
        primitive: PrimitiveId,
    ) -> Option<Self> {
        let sign = if shape.is_mirrored != (to_world.matrix3.determinant() < 0.0) {
            -1.0
        } else {
            1.0
        };
        let (area, form) = match kind {
            ItemKind::Triangle(index) => {
                let corners = group.triangles[index].corners();
                let [a, b, c] = corners.map(|corner| to_world.transform_point3(corner));
                let cross = (b - a).cross(c - a);
                let normal = cross.normalize_or_zero() * sign;
                (
                    0.5 * cross.length(),
                    Form::Triangle(a, [b - a, c - a], normal),
                )
            }
            ItemKind::Quad(index) => {
                let quad = &group.quads[index];
                let edges = quad.edges.map(|edge| to_world.transform_vector3(edge));
                let cross = edges[0].cross(edges[1]);
                let corner = to_world.transform_point3(quad.corner);
                let normal = cross.normalize_or_zero() * sign;
                (cross.length(), Form::Parallelogram(corner, edges, normal))
            }
            ItemKind::Solid(index) => {
                let solid = &group.solids[index];
                let to_world = *to_world * solid.to_unit.inverse();
                match solid.form {
                    UnitShape::Cube => (
                        cube_faces(&to_world).iter().sum::<f64>() * 2.0,
                        Form::Cube(to_world),
                    ),
                    form => {
                        let area = Box::new(RoundArea::new(form, &to_world)?);
                        (area.area(), round(form, &to_world, area))
                    }
                }
            }
            ItemKind::Instance(_) | ItemKind::TwoInstances(_) | ItemKind::Block(_) => {
                return None;
            }
        };
        let (material, organ) = (shape.material, shape.organ);
        (area > 0.0).then_some(Self {
            primitive,
            material,
            organ,
            area,
            form,
        })
    }
}

/// A round form: a ball if it is one.
fn round(form: UnitShape, to_world: &DAffine3, area: Box<RoundArea>) -> Form {
    let m = to_world.matrix3;
    let radius = m.x_axis.length();
    let axes = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis / radius);
    let is_even = (0..3).all(|i| {
        (axes[i].length() - 1.0).abs() <= SIMILARITY
            && axes[i].dot(axes[(i + 1) % 3]).abs() <= SIMILARITY
    });
    if form == UnitShape::Sphere && is_even {
        Form::Ball {
            center: to_world.translation,
            radius,
            area,
        }
    } else {
        Form::Round(area)
    }
}

/// Density per steradian of a point that was chosen with a density per area, `to` away, where the surface has this unit
/// normal; `None` where it is no number (edge on, or at no distance).
fn solid_angle_density(pdf_area: f64, to: DVec3, normal: DVec3) -> Option<f64> {
    let distance = to.length();
    let cos = to.dot(normal).abs() / distance;
    let pdf = pdf_area * distance * distance / cos;
    (pdf > 0.0 && pdf.is_finite()).then_some(pdf)
}

/// Areas of one face of a mapped cube per axis.
fn cube_faces(to_world: &DAffine3) -> [f64; 3] {
    let m = to_world.matrix3;
    // Each face spans twice the half edges.
    [
        m.y_axis.cross(m.z_axis).length() * 4.0,
        m.z_axis.cross(m.x_axis).length() * 4.0,
        m.x_axis.cross(m.y_axis).length() * 4.0,
    ]
}

fn sample_cube(to_world: &DAffine3, area: f64, u: [f64; 2]) -> (DVec3, DVec3) {
    // Choose a face in proportion to its area, and use what is left of the number again.
    let faces = cube_faces(to_world);
    let mut rest = u[0] * area;
    let mut chosen = (2, 1.0);
    'faces: for (axis, face) in faces.into_iter().enumerate() {
        for side in [-1.0, 1.0] {
            if rest < face {
                chosen = (axis, side);
                break 'faces;
            }
            rest -= face;
        }
    }
    let (axis, side) = chosen;
    let mut local = DVec3::ZERO;
    local[axis] = side;
    local[(axis + 1) % 3] = 2.0 * (rest / faces[axis]).min(1.0) - 1.0;
    local[(axis + 2) % 3] = 2.0 * u[1] - 1.0;
    let mut outward = DVec3::ZERO;
    outward[axis] = side;
    let normal = (to_world.matrix3.inverse().transpose() * outward).normalize_or_zero();
    (to_world.transform_point3(local), normal)
}

impl Scene {
    /// The emitter that was hit, if it is one.
    #[must_use]
    pub fn emitter_of(&self, hit: &Hit) -> Option<EmitterId> {
        let found = self
            .emitters
            .binary_search_by_key(&hit.primitive, |emitter| emitter.primitive);
        found.ok().map(|index| EmitterId(index as u32))
    }
}

/// Lists all emitters of a scene, sorted by primitive.
pub(super) fn collect(scene: &Scene) -> Result<Vec<Emitter>, SceneError> {
    let shines: Vec<bool> = scene
        .materials()
        .iter()
        .map(|material| material.is_emitter())
        .collect();
    let shines = |shape: &ShapeRecord| shines[shape.material.0 as usize];
    let mut holds_light: Vec<bool> = Vec::with_capacity(scene.groups.len());
    for group in scene.groups.iter() {
        let below = group
            .instances
            .iter()
            .any(|instance| holds_light[instance.group as usize]);
        holds_light.push(below || group.shapes.iter().any(shines));
    }

    let mut emitters = Vec::new();
    let mut open = Vec::new();
    if let Some(root) = scene
        .groups
        .len()
        .checked_sub(1)
        .filter(|root| holds_light[*root])
    {
        open.push((root, 0, scene.to_root.inverse()));
    }
    while let Some((index, first, to_world)) = open.pop() {
        let group = &scene.groups[index];
        for (at, shape) in group
            .shapes
            .iter()
            .enumerate()
            .filter(|(_, shape)| shines(shape))
        {
            let end = group
                .shapes
                .get(at + 1)
                .map_or(group.places.len(), |next| next.first as usize);
            for number in shape.first as usize..end {
                let Some(item) = group.places[number] else {
                    continue;
                };
                let primitive = PrimitiveId(first + number as u64);
                emitters.extend(Emitter::new(
                    group,
                    item.kind(),
                    shape,
                    &to_world,
                    primitive,
                ));
            }
        }
        if emitters.len() + open.len() > LIMIT {
            return Err(SceneError::TooManyEmitters { limit: LIMIT });
        }
        for instance in &group.instances {
            if holds_light[instance.group as usize] {
                let to_world = to_world * group.to_child(instance).inverse();
                open.push((instance.group as usize, first + instance.first, to_world));
            }
        }
    }
    emitters.sort_by_key(|emitter| emitter.primitive);
    Ok(emitters)
}
