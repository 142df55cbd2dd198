//! Insides of closed bodies: nothing lights them, so nothing is solved there.
//!
//! A ball, a box, or a cylinder or frustum with both caps, of a material that lets nothing through, has no light inside unless a source
//! is there: a lamp, a surface that shines, or the plane where parallel light begins. Then its inner sides neither get light nor send any,
//! and whatever stands inside is as dark. (A room that is one box, with its lamp in it, is no such body.)

use super::mesh::Mesh;
use crate::geometry::chart::{Chart, Form};
use crate::geometry::unit::Face;
use crate::light::Light;
use crate::material::{Lobe, Material};
use crate::math::{Bounds3, PrimitiveId};
use crate::scene::description::MaterialId;
use crate::scene::{PlacedChart, Scene};
use glam::{DAffine3, DVec2, DVec3};

/// Shining surfaces that are asked one by one whether they are in a body; of more, the box of all is.
const FEW: usize = 64;

/// Whether light cannot pass a surface of this material in any way, whatever its pictures show.
pub(in crate::integrator) fn seals(material: &Material) -> bool {
    let passes = |is_front: bool| {
        let side = material.most_sides()[usize::from(!is_front)];
        !side.transmittance.is_black()
    };
    material.is_opaque()
        && !material.lobes.iter().any(Lobe::transmits)
        && !passes(true)
        && !passes(false)
        && material.emission[1].is_black()
}

/// Where light begins.
struct Origins<'s> {
    scene: &'s Scene,
    /// Boxes of surfaces that shine, each with its primitive; one for all, with that of none, if they are many.
    shining: Vec<(PrimitiveId, Bounds3)>,
}

impl<'s> Origins<'s> {
    fn new(scene: &'s Scene) -> Self {
        let boxes = scene.emitters().iter().map(|emitter| {
            let [front, back] = scene.material(emitter.material).emission;
            (emitter.primitive, emitter.outline(front, back).bounds)
        });
        let shining = if scene.emitters().len() > FEW {
            let all = boxes.fold(Bounds3::EMPTY, |all, (_, bounds)| all.union(&bounds));
            vec![(PrimitiveId::NONE, all)]
        } else {
            boxes.collect()
        };
        Self { scene, shining }
    }

    /// Whether light may begin within a box, other than at this primitive.
    fn are_in(&self, bounds: &Bounds3, primitive: PrimitiveId) -> bool {
        let lamp = |light: &Light| match light {
            Light::Point { position, .. } | Light::Spot { position, .. } => {
                let inside = position.clamp(bounds.min, bounds.max);
                inside == *position
            }
            Light::Directional {
                direction, origin, ..
            } => {
                let middle = (bounds.center() - *origin).dot(*direction);
                let reach = 0.5 * bounds.diagonal().dot(direction.abs());
                middle.abs() <= reach
            }
        };
        let overlaps = |other: &Bounds3| {
            other.min.cmple(bounds.max).all() && bounds.min.cmple(other.max).all()
        };
        let mut shining = self.shining.iter();
        self.scene.lights().iter().any(lamp)
            || shining.any(|(of, other)| *of != primitive && overlaps(other))
    }
}

/// For each face of a mesh, whether its back is the inside of a body that no light is in.
pub(super) fn sealed(scene: &Scene, mesh: &Mesh) -> Vec<bool> {
    let seals: Vec<bool> = scene.materials().iter().map(seals).collect();
    let seals = |id: MaterialId| seals[id.0 as usize];
    let planes_shine =
        scene.stats().planes > 0 && scene.materials().iter().any(Material::is_emitter);
    let origins = Origins::new(scene);
    let mut sealed = Vec::with_capacity(mesh.charts.len());
    for faces in mesh.charts.chunk_by(|a, b| a.primitive == b.primitive) {
        let is_dark = seals(faces[0].material)
            && !planes_shine
            && closed_box(faces).is_some_and(|bounds| !origins.are_in(&bounds, faces[0].primitive));
        sealed.extend(faces.iter().map(|_| is_dark));
    }
    sealed
}

/// A box round the body that the faces of a primitive close, if they do, with their backs inside.
fn closed_box(faces: &[PlacedChart]) -> Option<Bounds3> {
    let has = |face: Face| faces.iter().any(|placed| placed.face == face);
    let first = faces.first()?;
    let round = |low: f64| {
        let unit = Bounds3 {
            min: DVec3::new(-1.0, -1.0, low),
            max: DVec3::ONE,
        };
        unit.transformed(&first.chart.to_world)
    };
    let bounds = match first.chart.form {
        Form::Sphere => round(-1.0),
        Form::Side { base, top } => {
            let is_closed = |radius: f64, cap: Face| radius <= 0.0 || has(cap);
            let closes = is_closed(base, Face::Base) && is_closed(top, Face::Top);
            closes.then(|| round(0.0))?
        }
        Form::Parallelogram if matches!(first.face, Face::Cube(..)) && faces.len() == 6 => {
            let corners = faces
                .iter()
                .flat_map(|placed| corners(&placed.chart.to_world));
            Bounds3::of(corners)
        }
        Form::Triangle | Form::Parallelogram | Form::Disk => return None,
    };
    let center = bounds.center();
    let looks_out = |chart: &Chart| {
        let middle = chart.point(DVec2::splat(0.5));
        middle.normal.dot(middle.position - center) > 0.0
    };
    faces
        .iter()
        .all(|placed| looks_out(&placed.chart))
        .then_some(bounds)
}

/// The corners of a flat face.
fn corners(to_world: &DAffine3) -> [DVec3; 4] {
    [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y].map(|at| to_world.transform_point3(at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::geometry::Shape;
    use crate::validation::room::{Room, at, gray, square};

    fn frustum(top: f64, caps: [bool; 2]) -> Shape {
        Shape::Frustum {
            length: 2.0,
            base_radius: 1.0,
            top_radius: top,
            base_cap: caps[0],
            top_cap: caps[1],
        }
    }

    const BALL: Shape = Shape::Sphere { radius: 1.0 };
    const BLOCK: Shape = Shape::Box {
        half_x: 1.0,
        half_y: 1.0,
        length: 2.0,
    };

    fn is_sealed(room: Room) -> bool {
        let scene = room.scene().unwrap();
        let mesh = Mesh::new(&scene, 100_000).unwrap();
        let sealed = sealed(&scene, &mesh);
        assert_eq!(sealed.len(), mesh.charts.len());
        sealed[0]
    }

    fn of(shape: Shape, material: Material) -> Room {
        Room::default().with(shape, at(0.0, 0.0, 0.0), material)
    }

    #[test]
    fn closed_bodies_are_told_from_open_ones() {
        let cases = [
            (BALL, true),
            (BLOCK, true),
            (frustum(0.5, [true, true]), true),
            (frustum(0.0, [true, false]), true),
            (frustum(0.5, [true, false]), false),
            (frustum(0.5, [false, true]), false),
            (square(1.0), false),
            (Shape::Disk { radius: 1.0 }, false),
        ];
        for (shape, expected) in cases {
            let mirrored = at(3.0, 1.0, 0.0) * DAffine3::from_scale(DVec3::new(-2.0, 1.0, 0.5));
            for place in [at(0.0, 0.0, 0.0), mirrored] {
                let room = Room::default().with(shape.clone(), place, Material::default());
                assert_eq!(is_sealed(room), expected, "{shape:?}");
            }
        }
    }

    #[test]
    fn what_lets_light_in_or_holds_a_source_is_not_dark() {
        let leaf = Material::leaf(gray(0.2), gray(0.3));
        let glass = Material::glass(1.5, 0.0, Rgb::BLACK);
        let shining = |front: f64, back: f64| Material::default().emitting(gray(front), gray(back));
        for (material, expected) in [
            (Material::default(), true),
            (Material::mirror(gray(0.9)), true),
            (shining(1.0, 0.0), true),
            (shining(0.0, 1.0), false),
            (leaf, false),
            (glass, false),
            (Material::default().with_alpha(0.9), false),
        ] {
            assert_eq!(
                is_sealed(of(BALL, material.clone())),
                expected,
                "{material:?}"
            );
        }
        let ball = || of(BALL, Material::default());
        let lamp = |x: f64| Light::point(DVec3::new(x, 0.0, 0.0), gray(1.0));
        let beam = |z: f64| Light::Directional {
            direction: DVec3::NEG_Z,
            irradiance: gray(1.0),
            origin: DVec3::new(50.0, 0.0, z),
        };
        assert!(!is_sealed(ball().lit_by(lamp(0.5))));
        assert!(is_sealed(ball().lit_by(lamp(1.5))));
        assert!(!is_sealed(ball().lit_by(beam(0.5))));
        assert!(is_sealed(ball().lit_by(beam(5.0))));
        let panel = |x: f64| ball().with(square(0.2), at(x, 0.0, 0.0), shining(1.0, 0.0));
        assert!(!is_sealed(panel(0.5)));
        assert!(is_sealed(panel(3.0)));
    }
}
