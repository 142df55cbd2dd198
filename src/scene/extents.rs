//! Where the surfaces of some materials are: boxes that light is aimed at.

use super::Scene;
use super::group::{Group, Item, ItemKind, ShapeRecord};
use super::query::{FIRST_PLANE, Hit};
use crate::material::Material;
use crate::math::Bounds3;
use glam::{DAffine3, DVec3};

/// Where the surfaces of some materials are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extents {
    /// Boxes in world coordinates, metres, that hold every such primitive, infinite planes left out. They may overlap and hold more.
    pub boxes: Vec<Bounds3>,
    /// Whether an infinite plane is among them.
    pub has_planes: bool,
}

impl Hit {
    /// Whether an infinite plane was hit.
    #[must_use]
    pub fn is_plane(&self) -> bool {
        self.primitive.0 >= FIRST_PLANE
    }
}

impl Scene {
    /// Unit normals of the infinite planes.
    pub fn plane_normals(&self) -> impl Iterator<Item = DVec3> {
        let normal = |map: &DAffine3| (map.matrix3.transpose() * DVec3::Z).normalize_or_zero();
        self.planes.iter().map(move |plane| normal(&plane.to_plane))
    }

    /// Where the surfaces are whose material `wanted` picks: one box for each shape, or for each instance where the shapes would
    /// be more than about `limit`.
    #[must_use]
    pub fn extents_of(&self, wanted: impl Fn(&Material) -> bool, limit: usize) -> Extents {
        let wanted: Vec<bool> = self.materials.iter().map(wanted).collect();
        let wanted = |shape: &ShapeRecord| wanted[shape.material.0 as usize];
        let mut holds: Vec<bool> = Vec::with_capacity(self.groups.len());
        for group in &self.groups {
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
        assert_eq!(scene(1).plane_normals().collect::<Vec<_>>(), [DVec3::Z]);
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
