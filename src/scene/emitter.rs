//! Surfaces that shine, for sampling.
//!
//! Each emitting primitive of the world is listed with its place, so that a light sampler needs no knowledge of groups.

use super::Scene;
use super::description::{MaterialId, OrganId};
use super::error::SceneError;
use super::group::{Group, ItemKind, ShapeRecord};
use super::query::Hit;
use crate::geometry::area::RoundArea;
use crate::geometry::unit::UnitShape;
use crate::math::PrimitiveId;
use glam::{DAffine3, DVec3};

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

#[derive(Clone, Debug)]
enum Form {
    /// Corner, two edges, and the front normal.
    Triangle(DVec3, [DVec3; 2], DVec3),
    /// Corner, two edges, and the front normal.
    Parallelogram(DVec3, [DVec3; 2], DVec3),
    /// The cube -1..=1, mapped into the world.
    Cube(DAffine3),
    /// A sphere, disk or frustum.
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
            Form::Round(round) => {
                let (position, normal) = round.sample(u);
                EmitterSample {
                    position,
                    normal,
                    pdf_area: round.pdf_area(normal),
                }
            }
        }
    }

    /// The density with which [`Emitter::sample`] chooses a point of the surface where the unit normal of the front is
    /// `normal`, per square metre.
    #[must_use]
    pub fn pdf_area(&self, normal: DVec3) -> f64 {
        match &self.form {
            Form::Round(round) => round.pdf_area(normal),
            Form::Triangle(..) | Form::Parallelogram(..) | Form::Cube(_) => 1.0 / self.area,
        }
    }

    /// The emitter that a stored primitive becomes, or `None` if it has no area that can be counted.
    fn new(
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
                let corners = group.corners(&group.triangles[index]);
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
                        let round = RoundArea::new(form, &to_world)?;
                        (round.area(), Form::Round(Box::new(round)))
                    }
                }
            }
            ItemKind::Instance(_) => return None,
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
    for group in &scene.groups {
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
