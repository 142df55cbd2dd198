//! Where the surfaces of some materials are: boxes that light is aimed at.

use super::Scene;
use super::description::{MaterialId, OrganId};
use super::emitter::Emitter;
use super::group::{Group, Item, ItemKind, ShapeRecord};
use super::query::{FIRST_PLANE, Hit};
use crate::geometry::unit::UnitShape;
use crate::material::Material;
use crate::math::{Bounds3, PrimitiveId};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;

/// Where the surfaces of some materials are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extents {
    /// Boxes in world coordinates, metres, that hold every such primitive, infinite planes left out. They may overlap and hold more.
    pub boxes: Vec<Bounds3>,
    /// Whether an infinite plane is among them.
    pub has_planes: bool,
}

/// An infinite plane of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndlessPlane {
    /// A point of it in the world, metres.
    pub point: DVec3,
    /// Its unit normal in the world, on its front.
    pub normal: DVec3,
    /// Its material.
    pub material: MaterialId,
    /// The organ that it belongs to as a whole.
    pub owner: OrganId,
}

/// How large the surface is that a primitive belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Piece {
    /// A flat or nearly flat shape of few primitives: a leaf.
    Flat {
        /// Its first primitive, which names it.
        first: PrimitiveId,
        /// Area of one side, m².
        area: f64,
        /// Diagonal of its box, metres.
        size: f64,
    },
    /// A ball, frustum or box.
    Body {
        /// The primitive that it is.
        first: PrimitiveId,
        /// So far from any of its points, in metres, its surface is about flat where it is not an edge.
        flat: f64,
        /// About the area of its surface, m²: that of what it would be if it were stretched evenly.
        area: f64,
    },
    /// Anything else.
    Large,
}

/// Primitives of a shape that are looked at one by one.
const FEW: usize = 64;

/// Share of its radius over which a round surface counts as flat: its normals turn by 17°.
const FLAT_SHARE: f64 = 0.3;

/// Cosine between normals of primitives that count as one flat piece.
const NEARLY_FLAT: f64 = 0.9;

impl Hit {
    /// Whether an infinite plane was hit.
    #[must_use]
    pub fn is_plane(&self) -> bool {
        self.primitive.0 >= FIRST_PLANE
    }
}

impl Scene {
    /// The infinite planes.
    pub fn planes(&self) -> impl Iterator<Item = EndlessPlane> {
        self.planes.iter().map(|plane| EndlessPlane {
            point: plane.to_plane.inverse().translation,
            normal: (plane.to_plane.matrix3.transpose() * DVec3::Z).normalize_or_zero(),
            material: plane.shape.material,
            owner: plane.shape.instance_organ.unwrap_or(plane.shape.organ),
        })
    }

    /// How many stored shapes are closed bodies of a material that `wanted` picks, and how many shapes are stored.
    #[must_use]
    pub fn closed_bodies(&self, wanted: impl Fn(&Material) -> bool) -> (usize, usize) {
        let wanted: Vec<bool> = self.materials.iter().map(wanted).collect();
        let (mut n_closed, mut n_all) = (0, 0);
        for group in self.groups.iter() {
            let is_closed = |shape: &&ShapeRecord| {
                let item = group.places.get(shape.first as usize).copied().flatten();
                wanted[shape.material.0 as usize]
                    && matches!(item.map(Item::kind), Some(ItemKind::Solid(at)) if group.solids[at].form.is_closed())
            };
            n_closed += group.shapes.iter().filter(is_closed).count();
            n_all += group.shapes.len();
        }
        (n_closed, n_all)
    }

    /// Where the surfaces are whose material `wanted` picks: one box for each shape, or for each instance where the shapes would
    /// be more than about `limit`.
    #[must_use]
    pub fn extents_of(&self, wanted: impl Fn(&Material) -> bool, limit: usize) -> Extents {
        let wanted: Vec<bool> = self.materials.iter().map(wanted).collect();
        let wanted = |shape: &ShapeRecord| wanted[shape.material.0 as usize];
        let mut holds: Vec<bool> = Vec::with_capacity(self.groups.len());
        for group in self.groups.iter() {
            let mut instances = group.instances.iter();
            let below = instances.any(|instance| holds[instance.group as usize]);
            holds.push(below || group.shapes.iter().any(wanted));
        }

        let mut boxes = Vec::new();
        let mut open = Vec::new();
        let root = self.groups.len().checked_sub(1);
        open.extend(root.map(|root| (root, self.to_root.inverse())));
        while let Some((index, to_world)) = open.pop() {
            let group = &self.groups[index];
            if !holds[index] {
                continue;
            }
            let n_wanted = group.shapes.iter().filter(|shape| wanted(shape)).count();
            if boxes.len() + open.len() + group.instances.len() + n_wanted > limit {
                boxes.push(group.bounds.transformed(&to_world));
                continue;
            }
            let own = (0..group.shapes.len()).filter(|at| wanted(&group.shapes[*at]));
            boxes.extend(own.map(|at| shape_box(group, at, &to_world)));
            let placed = group.instances.iter().map(|instance| {
                let to_world = to_world * group.to_child(instance).inverse();
                (instance.group as usize, to_world)
            });
            open.extend(placed);
        }
        boxes.retain(|bounds| !bounds.is_empty());
        Extents {
            boxes,
            has_planes: self.planes.iter().any(|plane| wanted(&plane.shape)),
        }
    }
}

impl Scene {
    /// How large the surface is that a primitive, the result of a query, belongs to.
    #[must_use]
    pub fn piece(&self, primitive: PrimitiveId) -> Piece {
        if primitive.0 >= FIRST_PLANE {
            return Piece::Large;
        }
        let located = self.locate(primitive);
        let maps = located.maps(&self.to_root);
        let to_world = maps.fold(DAffine3::IDENTITY, |all, map| all * map.inverse());
        let (group, number) = (located.group, located.number);
        let after = group.shapes.partition_point(|shape| shape.first <= number);
        let first = group.shapes[after.saturating_sub(1)].first;
        let next = group.shapes.get(after);
        let end = next.map_or(group.places.len(), |next| next.first as usize);
        let items = &group.places[first as usize..end];
        if let [Some(item)] = items
            && let ItemKind::Solid(index) = item.kind()
            && group.solids[index].form != UnitShape::Disk
        {
            let solid = &group.solids[index];
            let to_world = to_world * solid.to_unit.inverse();
            return Piece::Body {
                first: primitive,
                flat: flat_extent(solid.form, &to_world),
                area: about_area(solid.form, &to_world),
            };
        }
        if items.len() > FEW {
            return Piece::Large;
        }
        let mut normal = DVec3::ZERO;
        let (mut area, mut bounds) = (0.0, Bounds3::EMPTY);
        for item in items.iter().flatten() {
            let Some(own) = vector_area(group, *item, &to_world) else {
                return Piece::Large;
            };
            if bounds.is_empty() {
                normal = own.normalize_or_zero();
            }
            if own.dot(normal) < NEARLY_FLAT * own.length() {
                return Piece::Large;
            }
            area += own.length();
            bounds = bounds.union(&item_box(group, *item, &to_world));
        }
        Piece::Flat {
            first: PrimitiveId(primitive.0 - u64::from(number - first)),
            area,
            size: bounds.diagonal().length(),
        }
    }
}

impl Scene {
    /// Area of the surface of a single primitive, m², one side of it; 0 of planes and of what is too small to have any.
    #[must_use]
    pub fn area_of(&self, primitive: PrimitiveId) -> f64 {
        if primitive.0 >= FIRST_PLANE {
            return 0.0;
        }
        let located = self.locate(primitive);
        let maps = located.maps(&self.to_root);
        let to_world = maps.fold(DAffine3::IDENTITY, |all, map| all * map.inverse());
        let group = located.group;
        let Some(item) = group.places[located.number as usize] else {
            return 0.0;
        };
        let shape = group.shape_of(located.number);
        let surface = Emitter::new(group, item.kind(), shape, &to_world, primitive);
        surface.map_or(0.0, |surface| surface.area())
    }
}

/// How far from any of its points a unit shape, placed in the world, is about flat, metres.
fn flat_extent(form: UnitShape, to_world: &DAffine3) -> f64 {
    let m = to_world.matrix3;
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::length);
    match form {
        UnitShape::Sphere => FLAT_SHARE * x.min(y).min(z),
        UnitShape::Frustum(_) | UnitShape::Disk => FLAT_SHARE * x.min(y),
        // The middle one: a wall is flat however thin it is.
        UnitShape::Cube => x.max(y).min(x.max(z)).min(y.max(z)),
    }
}

/// About the area of the surface of a unit shape, placed in the world, m².
fn about_area(form: UnitShape, to_world: &DAffine3) -> f64 {
    let m = to_world.matrix3;
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::length);
    match form {
        UnitShape::Sphere => 4.0 / 3.0 * PI * (x * y + y * z + z * x),
        UnitShape::Frustum(frustum) => {
            let (base, top) = (frustum.base, frustum.top);
            let is_closed = frustum
                .caps
                .map(|is_there| if is_there { 1.0 } else { 0.0 });
            let caps = base * base * is_closed[0] + top * top * is_closed[1];
            let slope = z.hypot((base - top) * 0.5 * (x + y));
            PI * ((base + top) * 0.5 * (x + y) * slope + caps * x * y)
        }
        UnitShape::Disk => PI * x * y,
        UnitShape::Cube => 8.0 * (x * y + y * z + z * x),
    }
}

/// Area of a flat primitive times its normal; `None` of others.
fn vector_area(group: &Group, item: Item, to_world: &DAffine3) -> Option<DVec3> {
    let place = |edge: DVec3| to_world.transform_vector3(edge);
    match item.kind() {
        ItemKind::Triangle(index) => {
            let [a, b, c] = group.triangles[index].corners();
            Some(place(b - a).cross(place(c - a)) * 0.5)
        }
        ItemKind::Quad(index) => {
            let [a, b] = group.quads[index].edges.map(place);
            Some(a.cross(b))
        }
        ItemKind::Solid(index) if group.solids[index].form == UnitShape::Disk => {
            let m = (*to_world * group.solids[index].to_unit.inverse()).matrix3;
            Some(m.x_axis.cross(m.y_axis) * PI)
        }
        ItemKind::Solid(_)
        | ItemKind::Instance(_)
        | ItemKind::TwoInstances(_)
        | ItemKind::Block(_) => None,
    }
}

/// The box of the shape at `at` of a group that `to_world` places.
fn shape_box(group: &Group, at: usize, to_world: &DAffine3) -> Bounds3 {
    let first = group.shapes[at].first as usize;
    let next = group.shapes.get(at + 1);
    let end = next.map_or(group.places.len(), |next| next.first as usize);
    let items = group.places[first..end].iter().flatten();
    items.fold(Bounds3::EMPTY, |bounds, item| {
        bounds.union(&item_box(group, *item, to_world))
    })
}

/// The box of a primitive; of a curved one, of the cube round it.
fn item_box(group: &Group, item: Item, to_world: &DAffine3) -> Bounds3 {
    let place = |point: DVec3| to_world.transform_point3(point);
    match item.kind() {
        ItemKind::Triangle(index) => Bounds3::of(group.triangles[index].corners().map(place)),
        ItemKind::Quad(index) => {
            let quad = &group.quads[index];
            let [a, b] = quad.edges;
            let corners = [DVec3::ZERO, a, b, a + b].map(|edge| place(quad.corner + edge));
            Bounds3::of(corners)
        }
        ItemKind::Solid(index) => {
            let cube = Bounds3::of([DVec3::NEG_ONE, DVec3::ONE]);
            cube.transformed(&(*to_world * group.solids[index].to_unit.inverse()))
        }
        ItemKind::Instance(_) | ItemKind::TwoInstances(_) | ItemKind::Block(_) => Bounds3::EMPTY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::geometry::Shape;
    use crate::scene::description::{
        Group, GroupId, Instance, MaterialId, OrganId, PlacedShape, SceneDescription,
    };

    fn placed(shape: Shape, at: DVec3, material: u32) -> PlacedShape {
        PlacedShape {
            shape,
            to_group: DAffine3::from_translation(at),
            material: MaterialId(material),
            organ: OrganId(0),
        }
    }

    fn scene(n_instances: u32) -> Scene {
        let ball = placed(Shape::Sphere { radius: 0.5 }, DVec3::ZERO, 1);
        let child = Group {
            shapes: vec![ball],
            instances: vec![],
        };
        let instance = |i| Instance {
            group: GroupId(0),
            to_group: DAffine3::from_translation(DVec3::X * 10.0 * f64::from(i)),
            organ: OrganId(0),
        };
        let gray = placed(Shape::Sphere { radius: 1.0 }, DVec3::NEG_Y * 50.0, 0);
        let world = Group {
            shapes: vec![gray, placed(Shape::Plane, DVec3::ZERO, 0)],
            instances: (0..n_instances).map(instance).collect(),
        };
        Scene::build(SceneDescription {
            materials: vec![Material::default(), Material::mirror(Rgb::WHITE)],
            groups: vec![child, world],
            root: Some(GroupId(1)),
            ..SceneDescription::default()
        })
        .unwrap()
    }

    #[test]
    fn boxes_hold_the_picked_shapes_wherever_instances_put_them() {
        let extents = scene(3).extents_of(Material::is_specular, 100);
        assert!(!extents.has_planes);
        assert_eq!(extents.boxes.len(), 3);
        for i in 0..3 {
            let center = DVec3::X * 10.0 * f64::from(i);
            let mut boxes = extents.boxes.iter();
            let found = boxes
                .find(|b| (b.center() - center).length() < 1e-9)
                .unwrap();
            assert!((found.diagonal() - DVec3::ONE).length() < 1e-9);
        }
        assert!(scene(1).extents_of(|_| true, 100).has_planes);
        assert_eq!(
            scene(1)
                .planes()
                .map(|plane| plane.normal)
                .collect::<Vec<_>>(),
            [DVec3::Z]
        );
    }

    #[test]
    fn pieces_are_measured_in_the_world() {
        let stretch = DAffine3::from_scale(DVec3::new(2.0, 3.0, 0.5));
        let square = Shape::Parallelogram {
            corner: DVec3::ZERO,
            edge_u: DVec3::X,
            edge_v: DVec3::Y,
        };
        let shape = |shape, to_group| PlacedShape {
            shape,
            to_group,
            material: MaterialId(0),
            organ: OrganId(0),
        };
        let scene = Scene::build(SceneDescription {
            materials: vec![Material::default()],
            groups: vec![Group {
                shapes: vec![
                    shape(square, stretch),
                    shape(
                        Shape::Disk { radius: 2.0 },
                        DAffine3::from_translation(DVec3::Z),
                    ),
                    shape(Shape::Sphere { radius: 1.0 }, stretch),
                ],
                instances: vec![],
            }],
            root: Some(GroupId(0)),
            ..SceneDescription::default()
        })
        .unwrap();
        let Piece::Flat { first, area, size } = scene.piece(PrimitiveId(0)) else {
            panic!()
        };
        assert_eq!(first, PrimitiveId(0));
        assert!((area - 6.0).abs() < 1e-9 && (size - 13.0_f64.sqrt()).abs() < 1e-9);
        let Piece::Flat { area, .. } = scene.piece(PrimitiveId(1)) else {
            panic!()
        };
        assert!((area - 4.0 * PI).abs() < 1e-9);
        assert!(
            matches!(scene.piece(PrimitiveId(2)), Piece::Body { first: PrimitiveId(2), flat, area }
                if (flat - 0.15).abs() < 1e-9 && (area - 34.0 / 3.0 * PI).abs() < 1e-9)
        );
        assert!((scene.area_of(PrimitiveId(0)) - 6.0).abs() < 1e-9);
        assert!((scene.area_of(PrimitiveId(1)) - 4.0 * PI).abs() < 1e-9);
    }

    #[test]
    fn beyond_the_limit_one_box_holds_many() {
        let extents = scene(200).extents_of(Material::is_specular, 100);
        let whole = extents
            .boxes
            .iter()
            .fold(Bounds3::EMPTY, |all, b| all.union(b));
        assert!(extents.boxes.len() <= 100);
        assert!(whole.max.x > 1990.0 && whole.min.x < 0.0);
    }
}
