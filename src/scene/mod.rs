//! The world as light sees it: immutable once built, ignorant of grammars.
//!
//! ```text
//! SceneDescription (f64 data) → Scene::build → Scene { closest, transmittance, surface, emitters, lights, bounds }
//!   plan      which groups stay groups
//!   bake      each group in a frame of its own
//!   arrange   … in the order of the hierarchy over it
//!   planes    what is endless stays outside
//!   query     what a ray meets
//!   walk      how it gets there: through the hierarchies of groups within groups
//!   surface   what shading needs to know there
//!   emitter   surfaces that shine, for sampling
//!   extents   where the surfaces of some materials are
//!   areas     how much surface each organ has
//!   digest    whether two worlds differ in more than light and colour
//!   charts    faces with coordinates
//! ```
//! Groups within groups are never copied: a ray is carried into the frame of each instance it enters. A primitive of the
//! world is therefore not stored anywhere; its number, a [`PrimitiveId`](crate::math::PrimitiveId), counts through all
//! instances and is taken apart again when a hit is shaded.
//!
//! ```
//! use glam::{DAffine3, DVec3};
//! use understory::geometry::Shape;
//! use understory::material::Material;
//! use understory::math::Ray;
//! use understory::scene::Scene;
//! use understory::scene::description::*;
//!
//! let ball = PlacedShape {
//!     shape: Shape::Sphere { radius: 1.0 },
//!     to_group: DAffine3::IDENTITY,
//!     material: MaterialId(0),
//!     organ: OrganId(7),
//! };
//! let scene = Scene::build(SceneDescription {
//!     materials: vec![Material::default()],
//!     groups: vec![Group { shapes: vec![ball], instances: vec![] }],
//!     root: Some(GroupId(0)),
//!     ..Default::default()
//! })?;
//! let ray = Ray::new(DVec3::new(0.0, -5.0, 0.0), DVec3::Y);
//! let hit = scene.closest(&ray).expect("the ray points at the ball");
//! assert_eq!(hit.t, 4.0);
//! assert_eq!(scene.surface(&ray, &hit).organ, OrganId(7));
//! # Ok::<(), understory::scene::SceneError>(())
//! ```

mod areas;
mod arrange;
mod bake;
mod charts;
pub mod description;
mod digest;
mod emitter;
mod error;
mod extents;
mod group;
mod outline;
mod placement;
mod plan;
mod planes;
mod query;
mod subtended;
mod surface;
mod validate;
mod walk;

pub use charts::PlacedChart;
pub use emitter::{Emitter, EmitterId, EmitterSample, TowardSample};
pub use error::{Problem, SceneError};
pub use extents::{Extents, Piece};
pub use query::Hit;
pub use surface::SurfacePoint;

use crate::color::Rgb;
use crate::light::{Environment, Light};
use crate::material::{Material, Optics};
use crate::math::{Bounds3, Ray};
use description::{MaterialId, SceneDescription};
use glam::DAffine3;
use group::Group;
use planes::WorldPlane;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Asked now and then whether to go on; `true` if not.
pub type Stop<'a> = &'a (dyn Fn() -> bool + Sync);

/// A world ready for rays.
#[derive(Debug)]
pub struct Scene {
    materials: Vec<Material>,
    lights: Vec<Light>,
    environment: Environment,
    /// Each group after all it refers to; the root is the last. Shared by worlds that differ in light and colour only.
    groups: Arc<[Group]>,
    /// Digests of those groups that refer to no others, the root left out.
    prototypes: Arc<[Option<u64>]>,
    /// How many of them were taken over from another world.
    n_kept: usize,
    /// From world coordinates to the root's frame.
    to_root: DAffine3,
    /// Back again.
    from_root: DAffine3,
    planes: Vec<WorldPlane>,
    /// Sorted by primitive.
    emitters: Vec<Emitter>,
    bounds: Bounds3,
    /// Whether the texture coordinates of round shapes are wanted.
    has_coordinates: bool,
    left_out: LeftOut,
}

/// What a scene was spared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// Groups that were dissolved into those that use them.
    pub groups: usize,
}

/// How large a scene is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneStats {
    /// Groups that are stored.
    pub groups: usize,
    /// Primitives that are stored.
    pub primitives: usize,
    /// Instances that are stored.
    pub instances: usize,
    /// Primitives in the world, each as often as it is seen.
    pub world_primitives: u64,
    /// Infinite planes.
    pub planes: usize,
    /// Primitives in the world that shine.
    pub emitters: usize,
    /// Memory of groups and hierarchies, in bytes.
    pub bytes: usize,
    /// The part of `bytes` that instances cost, with their share of the hierarchies.
    pub instance_bytes: usize,
}

impl Scene {
    /// Checks a description and prepares it for rays. Parallel; the result does not depend on the number of threads.
    ///
    /// # Errors
    /// The first thing that cannot be part of a scene, naming its organ.
    pub fn build(description: SceneDescription) -> Result<Self, SceneError> {
        Self::build_unless(description, &|| false)
    }

    /// As [`build`](Self::build), but ends soon once `stop` says so.
    ///
    /// # Errors
    /// As [`build`](Self::build), or [`SceneError::Stopped`].
    pub fn build_unless(description: SceneDescription, stop: Stop<'_>) -> Result<Self, SceneError> {
        Self::build_like(description, None, stop)
    }

    /// As [`build_unless`](Self::build_unless), but what is drawn many times and is also in the world `before`, perhaps of other
    /// materials, is taken from there with its hierarchy.
    ///
    /// # Errors
    /// As [`build_unless`](Self::build_unless).
    pub fn build_like(
        description: SceneDescription,
        before: Option<&Self>,
        stop: Stop<'_>,
    ) -> Result<Self, SceneError> {
        check_light(&description)?;
        let plan = plan::plan(&description, stop)?;
        let known = Known::of(before, &plan);
        let groups = bake_all(&plan, &description.materials, &known, stop)?;
        let planes = planes::world_planes(&plan.groups)?;
        let left_out = LeftOut {
            groups: plan.n_dissolved,
        };
        drop(plan);

        let (to_root, bounds) = match groups.last() {
            Some(root) => {
                let to_world = root.frame.to_group();
                (to_world.inverse(), root.bounds.transformed(&to_world))
            }
            None => (DAffine3::IDENTITY, Bounds3::EMPTY),
        };
        let scene = Self {
            has_coordinates: wants_coordinates(&description),
            left_out,
            materials: description.materials,
            lights: description.lights,
            environment: description.environment,
            groups: groups.into(),
            n_kept: known.kept.iter().flatten().count(),
            prototypes: known.digests.into(),
            to_root,
            from_root: to_root.inverse(),
            planes,
            emitters: Vec::new(),
            bounds,
        };
        scene.shining()
    }

    /// The world of `description`, whose [`shape_digest`](SceneDescription::shape_digest) is that of the description that this
    /// one was built from: what rays walk through is shared.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn relit(&self, description: SceneDescription) -> Result<Self, SceneError> {
        check_light(&description)?;
        let scene = Self {
            has_coordinates: wants_coordinates(&description),
            materials: description.materials,
            lights: description.lights,
            environment: description.environment,
            groups: self.groups.clone(),
            prototypes: self.prototypes.clone(),
            planes: self.planes.clone(),
            emitters: Vec::new(),
            ..*self
        };
        scene.shining()
    }

    /// With the list of what shines.
    fn shining(mut self) -> Result<Self, SceneError> {
        self.emitters = emitter::collect(&self)?;
        Ok(self)
    }

    /// How many prototypes were built with hierarchies of their own, and how many were taken over.
    #[must_use]
    pub fn prototypes(&self) -> (usize, usize) {
        let n_all = self.prototypes.iter().flatten().count();
        (n_all - self.n_kept, self.n_kept)
    }

    /// What it was spared when it was built.
    #[must_use]
    pub fn left_out(&self) -> LeftOut {
        self.left_out
    }

    /// The materials, by [`MaterialId`].
    #[must_use]
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// One material.
    #[must_use]
    pub fn material(&self, id: MaterialId) -> &Material {
        &self.materials[id.0 as usize]
    }

    /// Light sources that are not surfaces.
    #[must_use]
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// Light from infinitely far away.
    #[must_use]
    pub fn environment(&self) -> &Environment {
        &self.environment
    }

    /// A box, in metres, that holds everything but infinite planes, wider by a few millionths; empty if there is nothing.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// All primitives that shine, wherever instances put them, except infinite planes.
    #[must_use]
    pub fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// How large the scene is.
    #[must_use]
    pub fn stats(&self) -> SceneStats {
        let mut stats = SceneStats {
            groups: self.groups.len(),
            planes: self.planes.len(),
            emitters: self.emitters.len(),
            world_primitives: self.groups.last().map_or(0, |root| root.total),
            ..SceneStats::default()
        };
        for group in self.groups.iter() {
            stats.primitives += group.places.len();
            stats.instances += group.instances.len();
            stats.bytes += group.bytes();
            let shared = group.bvh.bytes();
            let leaves = group.instances.len() + group.blocks.len() + group.solids.len();
            let share = group.instances.len() as f64 / leaves.max(1) as f64;
            stats.instance_bytes += size_of_val(&*group.instances)
                + size_of_val(&*group.matrices)
                + (shared as f64 * share) as usize;
        }
        stats
    }

    /// What the surface does to light at a point.
    #[inline]
    #[must_use]
    pub fn optics(&self, point: &SurfacePoint) -> Optics<'_> {
        self.material(point.material).optics_at(point.uv)
    }

    /// The fraction of light on `ray` that goes straight through the surface at `hit`, which has this material.
    fn passage(&self, ray: &Ray, hit: &Hit, id: MaterialId) -> Rgb {
        let material = self.material(id);
        if material.is_matt() && !material.has_holes() {
            return Rgb::splat(1.0 - material.alpha);
        }
        // How much a pane lets through depends on the angle, and holes have their places.
        let point = self.surface(ray, hit);
        self.optics(&point)
            .passage(point.normal_g.dot(ray.direction))
    }
}

/// Whether anything in a world looks at texture coordinates of round shapes.
fn wants_coordinates(description: &SceneDescription) -> bool {
    let mut materials = description.materials.iter();
    description.extras.coordinates || materials.any(|material| material.pictures.is_some())
}

/// Refuses materials and lights that cannot be.
fn check_light(description: &SceneDescription) -> Result<(), SceneError> {
    for (index, material) in description.materials.iter().enumerate() {
        material
            .validate()
            .map_err(|source| SceneError::Material { index, source })?;
    }
    for (index, light) in description.lights.iter().enumerate() {
        light
            .validate()
            .map_err(|source| SceneError::Light { index, source })?;
    }
    description
        .environment
        .validate()
        .map_err(SceneError::Environment)
}

/// What a plan has in common with a world that is there.
struct Known<'w> {
    /// By planned group: of those that refer to no others, the root left out.
    digests: Vec<Option<u64>>,
    /// The group with the same shapes.
    kept: Vec<Option<&'w Group>>,
}

impl<'w> Known<'w> {
    fn of(before: Option<&'w Scene>, plan: &plan::Plan) -> Self {
        let root = plan.groups.len().saturating_sub(1);
        let planned = plan.groups.par_iter().enumerate();
        let digests: Vec<Option<u64>> = planned
            .map(|(number, group)| {
                let is_prototype = number != root && group.instances.is_empty();
                is_prototype.then(|| digest::prototype_digest(group))
            })
            .collect();
        let there: BTreeMap<u64, &Group> = before
            .into_iter()
            .flat_map(|scene| scene.prototypes.iter().zip(scene.groups.iter()))
            .filter_map(|(digest, group)| Some(((*digest)?, group)))
            .collect();
        let find = |digest: &Option<u64>| there.get(digest.as_ref()?).copied();
        Self {
            kept: digests.iter().map(find).collect(),
            digests,
        }
    }
}

/// Bakes the groups level by level, those of one level in parallel.
fn bake_all(
    plan: &plan::Plan,
    materials: &[Material],
    known: &Known<'_>,
    stop: Stop<'_>,
) -> Result<Vec<Group>, SceneError> {
    let mut built: Vec<Group> = Vec::with_capacity(plan.groups.len());
    while built.len() < plan.groups.len() {
        // Groups stand after what they refer to, so a run that refers only to what is built can be built at once.
        let ready = plan.groups[built.len()..]
            .iter()
            .take_while(|group| group.instances.iter().all(|to| to.group < built.len()))
            .count();
        let run = built.len()..built.len() + ready;
        let baked: Vec<_> = plan.groups[run.clone()]
            .par_iter()
            .zip(&known.kept[run])
            .map(|(group, kept)| match kept {
                Some(kept) => bake::dressed(group, kept, materials),
                None => bake::bake(group, &built, (materials, stop)),
            })
            .collect();
        for group in baked {
            built.push(group?);
        }
    }
    Ok(built)
}
