//! What shading needs to know of a hit.

use super::Scene;
use super::description::{MaterialId, OrganId};
use super::group::{Group, Item, ItemKind, MeshShading, PlacedGroup, ShapeRecord};
use super::query::{FIRST_PLANE, Hit};
use crate::math::tolerance::{EDGE_MARGIN, EDGE_MARGIN_LIMIT, SHADOW_GAP, SPAWN_SAFETY, gamma};
use crate::math::{PrimitiveId, Ray};
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec2Swizzles};

/// A point of a surface, seen along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Where it is, in world coordinates, metres.
    pub position: DVec3,
    /// Bound on the error of each coordinate of `position`, in metres, with what carrying it back into the frame of its
    /// primitive may add.
    pub error: DVec3,
    /// Geometric normal: unit, on the front side.
    pub normal_g: DVec3,
    /// Shading normal: unit, interpolated if the mesh has normals per corner, otherwise the geometric one.
    pub normal_s: DVec3,
    /// Texture coordinates: of the mesh; turns round the axis and height for round shapes; 0..=1 across flat ones; metres
    /// for planes. Of balls and the sides of frusta only in a scene with pictures, 0 otherwise.
    pub uv: DVec2,
    /// The material.
    pub material: MaterialId,
    /// The organ.
    pub organ: OrganId,
    /// The organ that made the outermost instance around the point, mere copies left out, if there is one.
    pub instance_organ: Option<OrganId>,
    /// Whether the ray came from the front.
    pub is_front: bool,
    /// The primitive.
    pub primitive: PrimitiveId,
    /// Whether the primitive is flat, so that a ray from here cannot meet it again.
    is_flat: bool,
}

impl SurfacePoint {
    /// The organ that the point belongs to as a whole: who made the outermost instance around it, else its own.
    #[must_use]
    pub fn owner(&self) -> OrganId {
        self.instance_organ.unwrap_or(self.organ)
    }

    /// A ray that leaves the surface in a unit direction, to the side that the direction points to.
    ///
    /// It starts off the surface by a multiple of the carried error and cannot meet the primitive again if that is flat.
    #[must_use]
    pub fn spawn_ray(&self, direction: DVec3) -> Ray {
        self.ray_from(self.start(direction), direction)
    }

    /// A ray from the surface to a point, ending just before it. If the point is where the ray starts, it has length 0 and
    /// meets nothing.
    #[must_use]
    pub fn spawn_ray_to(&self, target: DVec3) -> Ray {
        let start = self.start(target - self.position);
        let distance = (target - start).length();
        let direction = (target - start).try_normalize().unwrap_or(self.normal_g);
        // How far the rounding of the target's coordinates may have moved it.
        let blur = gamma(16) * (target.abs().max_element() + start.abs().max_element());
        let t_max = (distance * (1.0 - SHADOW_GAP) - blur).max(0.0);
        Ray {
            t_max,
            ..self.ray_from(start, direction)
        }
    }

    fn ray_from(&self, start: DVec3, direction: DVec3) -> Ray {
        let skip = if self.is_flat {
            self.primitive
        } else {
            PrimitiveId::NONE
        };
        Ray {
            skip,
            ..Ray::new(start, direction)
        }
    }

    /// The position, moved off the surface to the side of `direction`.
    fn start(&self, direction: DVec3) -> DVec3 {
        let distance = SPAWN_SAFETY * self.error.dot(self.normal_g.abs());
        self.position + self.normal_g * distance.copysign(direction.dot(self.normal_g))
    }
}

/// A hit as the ray gives it, in the frame of a group.
struct CarriedIn {
    position: DVec3,
    /// How near to an edge, per axis, rays had better not start.
    blur: DVec3,
}

/// A point in the frame of a group, or of the world.
struct LocalPoint {
    position: DVec3,
    error: DVec3,
    normal_g: DVec3,
    normal_s: DVec3,
    uv: DVec2,
    is_flat: bool,
}

impl LocalPoint {
    /// Carries the point out of a frame, given the map into it.
    fn leave(self, into: &DAffine3) -> Self {
        self.leave_by(into, &into.inverse())
    }

    /// Carries the point out of a frame, given the maps into it and out of it.
    fn leave_by(self, into: &DAffine3, out: &DAffine3) -> Self {
        let position = out.transform_point3(self.position);
        // The error made on the way out, and the error that carrying the result in again will make.
        let made = absolute(&out.matrix3) * self.position.abs() + out.translation.abs();
        let again = absolute(&into.matrix3) * position.abs() + into.translation.abs();
        let inside = self.error + again * gamma(4);
        let normal = |n: DVec3| (into.matrix3.transpose() * n).normalize();
        let normal_g = normal(self.normal_g);
        let normal_s = if self.normal_s == self.normal_g {
            normal_g
        } else {
            normal(self.normal_s)
        };
        Self {
            position,
            error: absolute(&out.matrix3) * inside + made * gamma(4),
            normal_g,
            normal_s,
            ..self
        }
    }
}

fn absolute(matrix: &DMat3) -> DMat3 {
    DMat3::from_cols(
        matrix.x_axis.abs(),
        matrix.y_axis.abs(),
        matrix.z_axis.abs(),
    )
}

/// A primitive with the way to it from the world.
pub(super) struct Located<'s> {
    pub(super) group: &'s Group,
    pub(super) number: u32,
    /// The instances on the way, each with the group that it is in. Hardly ever more than one, so no list for it.
    outermost: Option<(&'s Group, &'s PlacedGroup)>,
    deeper: Vec<(&'s Group, &'s PlacedGroup)>,
}

impl Located<'_> {
    /// The maps on the way in, each from one frame to the next, the first from the world.
    pub(super) fn maps(&self, to_root: &DAffine3) -> impl DoubleEndedIterator<Item = DAffine3> {
        std::iter::once(*to_root).chain(self.inner_maps())
    }

    /// The maps on the way in from the root's frame.
    fn inner_maps(&self) -> impl DoubleEndedIterator<Item = DAffine3> {
        self.outermost
            .iter()
            .chain(&self.deeper)
            .map(|(group, instance)| group.to_child(instance))
    }

    /// The organ of the outermost instance that has one.
    pub(super) fn instance_organ(&self) -> Option<OrganId> {
        let path = self.outermost.iter().chain(&self.deeper);
        let mut organs = path.map(|(_, instance)| instance.organ);
        let outermost = organs.find(OrganId::is_own);
        outermost.or(self.group.shape_of(self.number).instance_organ)
    }
}

impl Scene {
    /// What shading needs to know of `hit`, a result of [`Scene::closest`] for this `ray`.
    #[must_use]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        if hit.primitive.0 >= FIRST_PLANE {
            return self.plane_surface(ray, hit);
        }
        let located = self.locate(hit.primitive);
        let shape = located.group.shape_of(located.number);
        let near = || self.carried_in(&located, ray.at(hit.t));
        let group = located.group;
        let mut local = match group.places[located.number as usize].map(Item::kind) {
            Some(ItemKind::Triangle(index)) => triangle_point(group, shape, index, hit, near),
            Some(ItemKind::Quad(index)) => quad_point(group, shape, index, hit, near),
            Some(ItemKind::Solid(index)) => {
                solid_point(group, index, hit, &near(), self.has_coordinates)
            }
            Some(ItemKind::Instance(_) | ItemKind::TwoInstances(_) | ItemKind::Block(_)) | None => {
                unreachable!("invariant: only stored primitives are hit")
            }
        };
        for map in located.inner_maps().rev() {
            local = local.leave(&map);
        }
        let local = local.leave_by(&self.to_root, &self.from_root);
        finish(local, shape, located.instance_organ(), ray, hit)
    }

    /// Carries a point of the world into the frame of a located primitive's group.
    fn carried_in(&self, located: &Located, point: DVec3) -> CarriedIn {
        let mut carried = CarriedIn {
            position: point,
            blur: point.abs() * EDGE_MARGIN,
        };
        for map in located.maps(&self.to_root) {
            carried.position = map.transform_point3(carried.position);
            carried.blur = absolute(&map.matrix3) * carried.blur;
        }
        carried.blur += carried.position.abs() * EDGE_MARGIN;
        carried
    }

    fn plane_surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let plane = &self.planes[(hit.primitive.0 - FIRST_PLANE) as usize];
        let local = LocalPoint {
            position: DVec3::new(hit.u, hit.v, 0.0),
            error: DVec3::new(hit.u.abs(), hit.v.abs(), 0.0) * gamma(4),
            normal_g: DVec3::Z,
            normal_s: DVec3::Z,
            uv: DVec2::new(hit.u, hit.v),
            is_flat: true,
        };
        let local = local.leave(&plane.to_plane);
        finish(local, &plane.shape, plane.shape.instance_organ, ray, hit)
    }

    /// Takes the number of a primitive apart, which must not be a plane's.
    pub(super) fn locate(&self, primitive: PrimitiveId) -> Located<'_> {
        let root = &self.groups[self.groups.len() - 1];
        let mut located = Located {
            group: root,
            number: 0,
            outermost: None,
            deeper: Vec::new(),
        };
        let mut number = primitive.0;
        while number >= located.group.places.len() as u64 {
            let instance = located.group.instance_of(number);
            number -= instance.first;
            let step = (located.group, instance);
            if located.outermost.is_none() {
                located.outermost = Some(step);
            } else {
                located.deeper.push(step);
            }
            located.group = &self.groups[instance.group as usize];
        }
        located.number = number as u32;
        located
    }
}

fn finish(
    local: LocalPoint,
    shape: &ShapeRecord,
    instance_organ: Option<OrganId>,
    ray: &Ray,
    hit: &Hit,
) -> SurfacePoint {
    SurfacePoint {
        position: local.position,
        error: local.error,
        normal_g: local.normal_g,
        normal_s: local.normal_s,
        uv: local.uv,
        material: shape.material,
        organ: shape.organ,
        instance_organ: instance_organ.filter(OrganId::is_own),
        is_front: ray.direction.dot(local.normal_g) < 0.0,
        primitive: hit.primitive,
        is_flat: local.is_flat,
    }
}

/// +1, or -1 for a mirrored shape, whose corners run the other way round.
fn orientation(shape: &ShapeRecord) -> f64 {
    if shape.is_mirrored { -1.0 } else { 1.0 }
}

fn triangle_point(
    group: &Group,
    shape: &ShapeRecord,
    index: usize,
    hit: &Hit,
    near: impl FnOnce() -> CarriedIn,
) -> LocalPoint {
    let triangle = &group.triangles[index];
    let corners = triangle.corners();
    let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let weights = inner_weights(&corners, cross.length(), hit, near);
    let parts: [DVec3; 3] = std::array::from_fn(|corner| corners[corner] * weights[corner]);
    let normal_g = cross.normalize() * orientation(shape);
    let mut point = LocalPoint {
        position: parts[0] + parts[1] + parts[2],
        error: (parts[0].abs() + parts[1].abs() + parts[2].abs()) * gamma(7),
        normal_g,
        normal_s: normal_g,
        uv: DVec2::new(weights[1], weights[2]),
        is_flat: true,
    };
    if let Some(mesh) = shape.mesh {
        let number = (triangle.number - shape.first) as usize;
        shade_mesh(&mut point, &group.meshes[mesh as usize], number, weights);
    }
    point
}

/// The weights of a triangle's corners at a hit, moved inwards where the hit is too near to an edge.
fn inner_weights(
    corners: &[DVec3; 3],
    area: f64,
    hit: &Hit,
    near: impl FnOnce() -> CarriedIn,
) -> [f64; 3] {
    let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
    if weights.iter().all(|weight| *weight >= EDGE_MARGIN_LIMIT) {
        // No margin reaches so far.
        let sum = weights[0] + weights[1] + weights[2];
        return weights.map(|weight| weight / sum);
    }
    let near = near();
    let edge = |corner: usize| corners[(corner + 2) % 3] - corners[(corner + 1) % 3];
    // Per corner: what share of its height over the opposite edge the margin is.
    let margin = |corner| edge_margin(&near, edge(corner), area);
    let weights: [f64; 3] = std::array::from_fn(|corner| weights[corner].max(margin(corner)));
    let sum = weights[0] + weights[1] + weights[2];
    weights.map(|weight| weight / sum)
}

/// The margin along an edge of a face, as a share of the height over it; `area` is that of the parallelogram, edge times
/// height.
fn edge_margin(near: &CarriedIn, edge: DVec3, area: f64) -> f64 {
    (near.blur.length() * edge.length() / area).min(EDGE_MARGIN_LIMIT)
}

/// Replaces shading normal and texture coordinates by those of the mesh, where it has any.
fn shade_mesh(point: &mut LocalPoint, shading: &MeshShading, triangle: usize, weights: [f64; 3]) {
    let mesh = &shading.mesh;
    let corners = mesh.triangles[triangle].map(|corner| corner as usize);
    if !mesh.normals.is_empty() {
        let normal: DVec3 = (0..3).map(|i| mesh.normals[corners[i]] * weights[i]).sum();
        let normal = shading.normal_map * normal;
        point.normal_s = normal.try_normalize().unwrap_or(point.normal_g);
    }
    if !mesh.uvs.is_empty() {
        point.uv = (0..3).map(|i| mesh.uvs[corners[i]] * weights[i]).sum();
    }
}

fn quad_point(
    group: &Group,
    shape: &ShapeRecord,
    index: usize,
    hit: &Hit,
    near: impl FnOnce() -> CarriedIn,
) -> LocalPoint {
    let quad = &group.quads[index];
    let cross = quad.edges[0].cross(quad.edges[1]);
    let is_inside = |share: f64| (EDGE_MARGIN_LIMIT..=1.0 - EDGE_MARGIN_LIMIT).contains(&share);
    let uv = if is_inside(hit.u) && is_inside(hit.v) {
        // No margin reaches so far.
        DVec2::new(hit.u, hit.v)
    } else {
        let near = near();
        let inner = |share: f64, other: DVec3| {
            let margin = edge_margin(&near, other, cross.length());
            share.clamp(margin, 1.0 - margin)
        };
        DVec2::new(inner(hit.u, quad.edges[1]), inner(hit.v, quad.edges[0]))
    };
    let (along_u, along_v) = (quad.edges[0] * uv.x, quad.edges[1] * uv.y);
    let normal_g = cross.normalize() * orientation(shape);
    LocalPoint {
        position: quad.corner + along_u + along_v,
        error: (quad.corner.abs() + along_u.abs() + along_v.abs()) * gamma(7),
        normal_g,
        normal_s: normal_g,
        uv: if quad.is_turned { uv.yx() } else { uv },
        is_flat: true,
    }
}

fn solid_point(
    group: &Group,
    index: usize,
    hit: &Hit,
    near: &CarriedIn,
    has_uv: bool,
) -> LocalPoint {
    let solid = &group.solids[index];
    let blur = absolute(&solid.to_unit.matrix3) * near.blur;
    let margin = (blur.max_element() + EDGE_MARGIN).min(EDGE_MARGIN_LIMIT);
    let near = solid.to_unit.transform_point3(near.position);
    let point = solid.form.point_with(hit.face, near, margin, has_uv);
    let local = LocalPoint {
        position: point.position,
        // Coordinates are at most 1, and so are the errors of the equations that define the surface.
        error: DVec3::splat(gamma(8)),
        normal_g: point.normal,
        normal_s: point.normal,
        uv: point.uv,
        is_flat: solid.form.is_flat(),
    };
    local.leave(&solid.to_unit)
}
