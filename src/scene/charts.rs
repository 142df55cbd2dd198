//! The faces of all surfaces, with coordinates: what is solved on surfaces is laid out over them.

use super::Scene;
use super::description::MaterialId;
use super::group::{Group, ItemKind, ShapeRecord};
use super::query::{FIRST_PLANE, Hit};
use super::surface::SurfacePoint;
use crate::geometry::chart::{Chart, Form};
use crate::geometry::unit::{Face, UnitShape};
use crate::math::frame::Frame;
use crate::math::{PrimitiveId, Ray};
use glam::{DAffine3, DVec2, DVec3};

/// A face of a primitive of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedChart {
    /// Its coordinates.
    pub chart: Chart,
    /// The primitive.
    pub primitive: PrimitiveId,
    /// Which part of it.
    pub face: Face,
    /// Its material.
    pub material: MaterialId,
}

impl Hit {
    /// Which part of the primitive was hit.
    #[must_use]
    pub fn face(&self) -> Face {
        self.face
    }
}

impl PlacedChart {
    /// Whether it is a part of an infinite plane.
    #[must_use]
    pub fn is_plane(&self) -> bool {
        self.primitive.0 >= FIRST_PLANE
    }
}

impl Scene {
    /// All faces of the world, sorted by primitive, those of each instance on their own. Of an infinite plane a square with
    /// sides of `2 · reach` metres around what is nearest to `center` stands for all.
    ///
    /// # Errors
    /// The number of primitives if that is more than `most`.
    pub fn charts(&self, most: u64, center: DVec3, reach: f64) -> Result<Vec<PlacedChart>, u64> {
        let mut charts = Vec::new();
        let total = self.groups.last().map_or(0, |root| root.total);
        if total > most {
            return Err(total);
        }
        let mut open = Vec::new();
        let root = self.groups.len().checked_sub(1);
        open.extend(root.map(|root| (root, 0, self.to_root.inverse())));
        while let Some((index, first, to_world)) = open.pop() {
            let group = &self.groups[index];
            for (at, shape) in group.shapes.iter().enumerate() {
                let next = group.shapes.get(at + 1);
                let end = next.map_or(group.places.len(), |next| next.first as usize);
                for number in shape.first as usize..end {
                    let Some(item) = group.places[number] else {
                        continue;
                    };
                    let primitive = PrimitiveId(first + number as u64);
                    add_faces(group, item.kind(), shape, &to_world, primitive, &mut charts);
                }
            }
            for instance in &group.instances {
                let to_world = to_world * group.to_child(instance).inverse();
                open.push((instance.group as usize, first + instance.first, to_world));
            }
        }
        // Stable: the faces of a primitive stay in their order.
        charts.sort_by_key(|chart| chart.primitive);
        for (index, plane) in self.planes.iter().enumerate() {
            let near = plane.to_plane.transform_point3(center);
            let from_plane = plane.to_plane.inverse();
            let middle = from_plane.transform_point3(near.truncate().extend(0.0));
            let front = (plane.to_plane.matrix3.transpose() * DVec3::Z).normalize_or_zero();
            let frame = Frame::from_normal(front);
            let corner = middle - (frame.tangent + frame.bitangent) * reach;
            let edges = [frame.tangent, frame.bitangent].map(|edge| edge * (2.0 * reach));
            charts.push(PlacedChart {
                chart: Chart::flat(Form::Parallelogram, corner, edges, front),
                primitive: PrimitiveId(FIRST_PLANE + index as u64),
                face: Face::Side,
                material: plane.shape.material,
            });
        }
        Ok(charts)
    }

    /// What shading needs to know of a point of a face, seen from its front or from its back.
    #[must_use]
    pub fn point_on(&self, placed: &PlacedChart, uv: DVec2, from_front: bool) -> SurfacePoint {
        let point = placed.chart.point(uv);
        let toward = if from_front {
            -point.normal
        } else {
            point.normal
        };
        let uv = if placed.is_plane() {
            let plane = &self.planes[(placed.primitive.0 - FIRST_PLANE) as usize];
            plane.to_plane.transform_point3(point.position).truncate()
        } else {
            uv
        };
        let hit = Hit {
            t: 0.0,
            primitive: placed.primitive,
            u: uv.x,
            v: uv.y,
            face: placed.face,
        };
        self.surface(&Ray::new(point.position, toward), &hit)
    }
}

/// Adds the faces of a stored primitive that have area.
fn add_faces(
    group: &Group,
    kind: ItemKind,
    shape: &ShapeRecord,
    to_world: &DAffine3,
    primitive: PrimitiveId,
    charts: &mut Vec<PlacedChart>,
) {
    let mut add = |chart: Chart, face: Face| {
        let middle = chart.density(DVec2::splat(0.5));
        if middle > 0.0 && middle.is_finite() {
            charts.push(PlacedChart {
                chart,
                primitive,
                face,
                material: shape.material,
            });
        }
    };
    match kind {
        ItemKind::Triangle(_) | ItemKind::Quad(_) => {
            let is_mirrored = shape.is_mirrored != (to_world.matrix3.determinant() < 0.0);
            let (corner, edges) = group.parallelogram(kind);
            let edges = edges.map(|edge| to_world.transform_vector3(edge));
            let front = edges[0].cross(edges[1]).normalize_or_zero();
            let front = if is_mirrored { -front } else { front };
            let form = match kind {
                ItemKind::Triangle(_) => Form::Triangle,
                _ => Form::Parallelogram,
            };
            let corner = to_world.transform_point3(corner);
            add(Chart::flat(form, corner, edges, front), Face::Side);
        }
        ItemKind::Solid(index) => {
            let solid = &group.solids[index];
            let to_world = *to_world * solid.to_unit.inverse();
            for (chart, face) in faces_of(solid.form, &to_world) {
                add(chart, face);
            }
        }
        ItemKind::Instance(_) | ItemKind::TwoInstances(_) | ItemKind::Block(_) => {}
    }
}

/// The faces of a unit shape under a map.
fn faces_of(form: UnitShape, to_world: &DAffine3) -> Vec<(Chart, Face)> {
    let whole = |form, face| {
        let to_world = *to_world;
        vec![(Chart { to_world, form }, face)]
    };
    match form {
        UnitShape::Sphere => whole(Form::Sphere, Face::Side),
        UnitShape::Disk => whole(Form::Disk, Face::Side),
        UnitShape::Cube => (0..3)
            .flat_map(|axis| [false, true].map(|is_positive| (axis, is_positive)))
            .map(|(axis, is_positive)| {
                let chart = cube_face(to_world, axis, is_positive);
                (chart, Face::Cube(axis as u8, is_positive))
            })
            .collect(),
        UnitShape::Frustum(frustum) => {
            let (base, top) = (frustum.base, frustum.top);
            let mut faces = whole(Form::Side { base, top }, Face::Side);
            for (end, face, radius) in [(0, Face::Base, base), (1, Face::Top, top)] {
                if frustum.caps[end] && radius > 0.0 {
                    let height = end as f64;
                    // The disk at the base looks down: it is turned over.
                    let over = if end == 0 { -1.0 } else { 1.0 };
                    let place = DAffine3::from_scale_rotation_translation(
                        DVec3::new(radius, radius * over, over),
                        glam::DQuat::IDENTITY,
                        DVec3::Z * height,
                    );
                    let cap = Chart {
                        to_world: *to_world * place,
                        form: Form::Disk,
                    };
                    faces.push((cap, face));
                }
            }
            faces
        }
    }
}

/// A face of the cube -1..=1 under a map.
fn cube_face(to_world: &DAffine3, axis: usize, is_positive: bool) -> Chart {
    let m = to_world.matrix3;
    let side = if is_positive { 1.0 } else { -1.0 };
    let axes = [m.x_axis, m.y_axis, m.z_axis];
    let [out, a, b] = [axes[axis], axes[(axis + 1) % 3], axes[(axis + 2) % 3]];
    let corner = to_world.translation + out * side - a - b;
    let normal = a.cross(b).normalize_or_zero();
    let front = if normal.dot(out) * side < 0.0 {
        -normal
    } else {
        normal
    };
    Chart::flat(Form::Parallelogram, corner, [a * 2.0, b * 2.0], front)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;
    use crate::material::Material;
    use crate::validation::room::{Room, at, square};
    use std::f64::consts::PI;

    fn shapes() -> Vec<(Shape, f64)> {
        let frustum = |top| Shape::Frustum {
            length: 2.0,
            base_radius: 0.5,
            top_radius: top,
            base_cap: true,
            top_cap: true,
        };
        vec![
            (Shape::Sphere { radius: 1.5 }, 9.0 * PI),
            (
                Shape::Box {
                    half_x: 0.5,
                    half_y: 1.0,
                    length: 3.0,
                },
                22.0,
            ),
            (frustum(0.5), 2.5 * PI),
            (frustum(0.0), PI * 0.5 * 4.25_f64.sqrt() + PI * 0.25),
            (Shape::Disk { radius: 2.0 }, 4.0 * PI),
            (square(0.7), 1.96),
        ]
    }

    /// Rays that leave points of faces and come back meet the same face at the same coordinates, from the same side.
    #[test]
    fn points_of_faces_are_where_rays_meet_them() {
        for (shape, area) in shapes() {
            for place in [
                at(1.0, 2.0, 3.0),
                at(0.0, 0.0, -1.0) * DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0)),
            ] {
                let room = Room::default().with(shape.clone(), place, Material::default());
                let scene = room.scene().unwrap();
                let charts = scene.charts(100, DVec3::ZERO, 1.0).unwrap();
                let mut sum = 0.0;
                for placed in &charts {
                    sum += placed.chart.area(DVec2::ZERO, DVec2::ONE);
                    for k in 0..36 {
                        let uv = DVec2::new(f64::from(k % 6) + 0.5, f64::from(k / 6) + 0.5) / 6.0;
                        let point = scene.point_on(placed, uv, true);
                        let expected = placed.chart.point(uv);
                        assert!((point.position - expected.position).length() < 1e-9);
                        assert!(
                            point.normal_g.dot(expected.normal) > 1.0 - 1e-9,
                            "{shape:?}"
                        );
                        assert!(point.is_front);
                        let above = expected.position + expected.normal * 0.01;
                        let hit = scene.closest(&Ray::new(above, -expected.normal)).unwrap();
                        assert_eq!((hit.primitive, hit.face()), (placed.primitive, placed.face));
                    }
                }
                assert!((sum / area - 1.0).abs() < 1e-9, "{shape:?} {sum} {area}");
            }
        }
    }

    #[test]
    fn a_plane_has_a_part_that_stands_for_it() {
        let room = Room::default().with(Shape::Plane, at(0.0, 0.0, 2.0), Material::default());
        let scene = room.scene().unwrap();
        let charts = scene.charts(9, DVec3::new(5.0, 6.0, 9.0), 3.0).unwrap();
        let middle = scene.point_on(&charts[0], DVec2::splat(0.5), false);
        assert!((middle.position - DVec3::new(5.0, 6.0, 2.0)).length() < 1e-9);
        assert!(!middle.is_front && middle.normal_g == DVec3::Z);
        assert_eq!(charts[0].chart.area(DVec2::ZERO, DVec2::ONE), 36.0);
    }

    #[test]
    fn too_many_primitives_are_counted() {
        let mut room = Room::default();
        for k in 0..5 {
            room = room.with(square(0.1), at(f64::from(k), 0.0, 0.0), Material::default());
        }
        let scene = room.scene().unwrap();
        assert_eq!(scene.charts(4, DVec3::ZERO, 1.0).err(), Some(5));
    }
}
