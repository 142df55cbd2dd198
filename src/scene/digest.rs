//! Telling scenes apart by their shapes alone: where only lights and colours differ, what rays walk through is the same.

use super::Stop;
use super::description::{Group, PlacedShape, SceneDescription};
use super::plan::PlannedGroup;
use crate::geometry::Shape;
use crate::material::Material;
use crate::math::rng::hash_on;
use glam::DAffine3;
use rayon::prelude::*;

/// Shapes whose digests are made by one thread at a time.
const CHUNK: usize = 4096;

/// Numbers added up to one.
#[derive(Clone, Copy)]
struct Digest(u64);

impl Digest {
    fn add(&mut self, number: u64) {
        self.0 = hash_on(self.0, number);
    }

    fn add_real(&mut self, number: f64) {
        self.add(number.to_bits());
    }

    fn add_map(&mut self, map: &DAffine3) {
        map.to_cols_array().iter().for_each(|x| self.add_real(*x));
    }

    fn add_all(&mut self, numbers: impl IntoIterator<Item = f64>) {
        numbers.into_iter().for_each(|x| self.add_real(x));
    }
}

impl SceneDescription {
    /// A number that descriptions share whose shapes, places, organs and numbers of materials are equal, and whose materials
    /// let light through or not alike. Of others, two share it with a probability of 2⁻⁶⁴.
    #[must_use]
    pub fn shape_digest(&self) -> u64 {
        self.shape_digest_unless(&|| false)
    }

    /// As [`shape_digest`](Self::shape_digest), but ends soon once `stop` says so, with a number that means nothing.
    #[must_use]
    pub fn shape_digest_unless(&self, stop: Stop<'_>) -> u64 {
        let mut digest = Digest(0);
        digest.add(self.root.map_or(u64::MAX, |root| u64::from(root.0)));
        digest.add(u64::from(self.extras.groups));
        let opaque = self.materials.iter().map(Material::is_opaque);
        opaque.for_each(|is_opaque| digest.add(u64::from(is_opaque)));
        for group in &self.groups {
            digest.add(group_digest(group, stop));
        }
        digest.0
    }
}

fn group_digest(group: &Group, stop: Stop<'_>) -> u64 {
    let shapes = group.shapes.par_chunks(CHUNK).map(|shapes| {
        let mut digest = Digest(1);
        let shapes = if stop() { &[] } else { shapes };
        shapes
            .iter()
            .for_each(|shape| add_shape(&mut digest, shape));
        digest.0
    });
    let instances = group.instances.par_chunks(CHUNK).map(|instances| {
        let mut digest = Digest(2);
        let instances = if stop() { &[] } else { instances };
        for instance in instances {
            digest.add(u64::from(instance.group.0) << 32 | u64::from(instance.organ.0));
            digest.add_map(&instance.to_group);
        }
        digest.0
    });
    let parts: Vec<u64> = shapes.chain(instances).collect();
    let mut digest = Digest(3);
    digest.add(group.shapes.len() as u64);
    parts.into_iter().for_each(|part| digest.add(part));
    digest.0
}

/// A number that prototypes share whose shapes and their places are equal, whatever they are made of and whoever they belong
/// to. Of others, two share it with a probability of 2⁻⁶⁴.
pub(super) fn prototype_digest(planned: &PlannedGroup) -> u64 {
    let mut digest = Digest(4);
    for placed in &planned.shapes {
        add_form(&mut digest, (placed.shape, &placed.to_group));
    }
    digest.0
}

fn add_shape(digest: &mut Digest, placed: &PlacedShape) {
    digest.add(u64::from(placed.material.0) << 32 | u64::from(placed.organ.0));
    add_form(digest, (&placed.shape, &placed.to_group));
}

fn add_form(digest: &mut Digest, (shape, to_group): (&Shape, &DAffine3)) {
    digest.add_map(to_group);
    match shape {
        Shape::Sphere { radius } => {
            digest.add(1);
            digest.add_real(*radius);
        }
        Shape::Frustum {
            length,
            base_radius,
            top_radius,
            base_cap,
            top_cap,
        } => {
            digest.add(2 | u64::from(*base_cap) << 8 | u64::from(*top_cap) << 9);
            digest.add_all([*length, *base_radius, *top_radius]);
        }
        Shape::Box {
            half_x,
            half_y,
            length,
        } => {
            digest.add(3);
            digest.add_all([*half_x, *half_y, *length]);
        }
        Shape::Parallelogram {
            corner,
            edge_u,
            edge_v,
        } => {
            digest.add(4);
            digest.add_all(
                [corner, edge_u, edge_v]
                    .into_iter()
                    .flat_map(|v| v.to_array()),
            );
        }
        Shape::Disk { radius } => {
            digest.add(5);
            digest.add_real(*radius);
        }
        Shape::Plane => digest.add(6),
        Shape::Mesh(mesh) => {
            digest.add(7);
            digest.add(mesh.positions.len() as u64);
            digest.add(mesh.normals.len() as u64);
            digest.add_all(mesh.positions.iter().flat_map(|v| v.to_array()));
            digest.add_all(mesh.normals.iter().flat_map(|v| v.to_array()));
            digest.add_all(mesh.uvs.iter().flat_map(|v| v.to_array()));
            let corners = mesh.triangles.iter().flatten();
            corners.for_each(|corner| digest.add(u64::from(*corner)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::math::Ray;
    use crate::scene::description::{GroupId, Instance, MaterialId, OrganId};
    use crate::scene::{Scene, SceneError};
    use glam::DVec3;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn world(radius: f64, organ: u32) -> SceneDescription {
        let ball = PlacedShape {
            shape: Shape::Sphere { radius },
            to_group: DAffine3::IDENTITY,
            material: MaterialId(0),
            organ: OrganId(organ),
        };
        SceneDescription {
            materials: vec![Material::default()],
            groups: vec![Group {
                shapes: vec![ball],
                instances: vec![],
            }],
            root: Some(GroupId(0)),
            ..SceneDescription::default()
        }
    }

    #[test]
    fn a_world_in_another_light_is_the_one_built_so() {
        let mut red = world(1.0, 1);
        red.materials[0] = Material::lambert(Rgb::new(0.9, 0.1, 0.1));
        let mut lamp = world(1.0, 1);
        lamp.materials[0] = Material::default().emitting(Rgb::WHITE, Rgb::WHITE);
        assert_eq!(red.shape_digest(), lamp.shape_digest());
        let built = Scene::build(lamp.clone()).unwrap();
        let relit = Scene::build(red).unwrap().relit(lamp).unwrap();
        assert_eq!(built.materials(), relit.materials());
        assert_eq!((built.emitters().len(), relit.emitters().len()), (1, 1));
        assert_eq!(built.bounds(), relit.bounds());
        let ray = Ray::new(DVec3::new(0.1, -5.0, 0.2), DVec3::Y);
        assert_eq!(built.closest(&ray), relit.closest(&ray));
    }

    #[test]
    fn who_wants_a_world_no_more_does_not_get_it() {
        let stopped = Scene::build_unless(world(1.0, 1), &|| true);
        assert_eq!(stopped.unwrap_err(), SceneError::Stopped);
    }

    #[test]
    fn whoever_says_stop_at_whatever_moment_is_heard() {
        let mut crowd = world(1.0, 1);
        let ball = crowd.groups[0].shapes[0].clone();
        for x in 0..2_000 {
            let to_group = DAffine3::from_translation(DVec3::new(f64::from(x), 0.0, 0.0));
            let ball = ball.clone();
            crowd.groups[0]
                .shapes
                .push(PlacedShape { to_group, ..ball });
        }
        let n_shapes = crowd.groups[0].shapes.len();
        // Asks are counted; from the one with this number on the answer is yes.
        let build = |last: usize| {
            let asked = AtomicUsize::new(0);
            let stop = || asked.fetch_add(1, Ordering::Relaxed) >= last;
            let built = Scene::build_unless(crowd.clone(), &stop);
            (built.map(drop), asked.into_inner())
        };
        let (whole, n_asks) = build(usize::MAX);
        assert_eq!(whole, Ok(()));
        // Checked, baked, stored, boxed, put in order: each shape is a moment at which it is asked.
        assert!(n_asks > 5 * n_shapes, "{n_asks} asks");
        for tenth in 0..10 {
            let (stopped, _) = build(n_asks * tenth / 10);
            assert_eq!(stopped, Err(SceneError::Stopped), "at {tenth} tenths");
        }
    }

    #[test]
    fn prototypes_that_stay_as_they_were_are_not_built_again() {
        // Two twigs of twenty balls each, in three places each.
        let twigs = |size: f64, organ: u32, color: Rgb| {
            let twig = |radius: f64| Group {
                shapes: (0..20)
                    .map(|x| PlacedShape {
                        shape: Shape::Sphere { radius },
                        to_group: DAffine3::from_translation(DVec3::new(f64::from(x), 0.0, 0.0)),
                        material: MaterialId(0),
                        organ: OrganId(organ),
                    })
                    .collect(),
                instances: vec![],
            };
            let place = |n: u32| Instance {
                group: GroupId(n % 2),
                to_group: DAffine3::from_translation(DVec3::new(0.0, 3.0 * f64::from(n), 0.0)),
                organ: OrganId(100 + n),
            };
            let whole = Group {
                shapes: vec![],
                instances: (0..6).map(place).collect(),
            };
            SceneDescription {
                materials: vec![Material::lambert(color)],
                groups: vec![twig(0.3), twig(size), whole],
                root: Some(GroupId(2)),
                ..SceneDescription::default()
            }
        };
        let (red, green) = (Rgb::new(0.9, 0.1, 0.1), Rgb::new(0.1, 0.9, 0.1));
        let first = Scene::build(twigs(0.4, 1, red)).unwrap();
        assert_eq!(first.prototypes(), (2, 0));
        for (size, kept) in [(0.5, 1), (0.4, 2)] {
            // Organs and materials are the new ones, whatever is kept.
            let fresh = Scene::build(twigs(size, 7, green)).unwrap();
            let next = Scene::build_like(twigs(size, 7, green), Some(&first), &|| false).unwrap();
            assert_eq!(next.prototypes(), (2 - kept, kept));
            assert_eq!(fresh.bounds(), next.bounds());
            for x in 0..40 {
                for y in 0..18 {
                    let from = DVec3::new(0.5 * f64::from(x), f64::from(y) - 0.1, -9.0);
                    let ray = Ray::new(from, DVec3::Z);
                    let (a, b) = (fresh.closest(&ray), next.closest(&ray));
                    assert_eq!(a, b);
                    let Some(hit) = a else { continue };
                    let organ = |scene: &Scene| scene.surface(&ray, &hit).organ;
                    assert_eq!(organ(&fresh), organ(&next));
                }
            }
        }
    }

    #[test]
    fn shapes_and_organs_count_and_colours_do_not() {
        let digest = |world: &SceneDescription| world.shape_digest();
        let one = world(1.0, 1);
        assert_eq!(digest(&one), digest(&world(1.0, 1)));
        assert_ne!(digest(&one), digest(&world(1.5, 1)));
        assert_ne!(digest(&one), digest(&world(1.0, 2)));
        let mut other = world(1.0, 1);
        other.materials[0].alpha = 0.5;
        assert_ne!(digest(&one), digest(&other), "it lets light through");
        let mut other = world(1.0, 1);
        other.materials[0] =
            Material::lambert(Rgb::new(0.1, 0.9, 0.1)).emitting(Rgb::WHITE, Rgb::BLACK);
        assert_eq!(digest(&one), digest(&other));
        let mut other = world(1.0, 1);
        other.groups[0].shapes.clear();
        assert_ne!(digest(&one), digest(&other));
    }
}
