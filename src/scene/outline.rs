//! How far a scene reaches in a direction: what a camera needs to know to frame it.

use super::Scene;
use super::group::{Group, Item, ItemKind};
use crate::math::tolerance::FRAMING_SLACK;
use glam::{DAffine3, DVec3};

impl Scene {
    /// The largest value of `normal · p` over all points p of the scene, infinite planes left out; -∞ if there are none.
    ///
    /// Exact for triangles, parallelograms, balls, disks, cubes and frusta up to 10⁻⁵ of the scene's size, for `normal` of
    /// length about 1. Known as the support function of the scene's convex hull.
    #[must_use]
    pub fn reach(&self, normal: DVec3) -> f64 {
        let Some(root) = self.groups.last() else {
            return f64::NEG_INFINITY;
        };
        let slack = self.bounds.diagonal().length() * FRAMING_SLACK;
        let from_root = self.to_root.inverse();
        self.group_reach(root, &from_root, normal, slack, f64::NEG_INFINITY)
    }

    /// The larger of `least` and the reach of a group that `to_world` places.
    fn group_reach(
        &self,
        group: &Group,
        to_world: &DAffine3,
        normal: DVec3,
        slack: f64,
        least: f64,
    ) -> f64 {
        // p ↦ normal · (A p + b) = (Aᵀ normal) · p + normal · b
        let offset = normal.dot(to_world.translation);
        let inner = to_world.matrix3.transpose() * normal;
        let mut reach = |leaf: u32, best: f64| {
            let items = match Item::from_bits(leaf).map(Item::kind) {
                Some(ItemKind::Block(index)) => group.blocks[index].names().collect(),
                Some(ItemKind::TwoInstances(first)) => [first, first + 1]
                    .map(|index| Item::new(ItemKind::Instance(index)).bits())
                    .to_vec(),
                _ => vec![leaf],
            };
            let items = items.into_iter().filter_map(Item::from_bits);
            let reaches = items.map(|item| match item.kind() {
                ItemKind::Block(_) | ItemKind::TwoInstances(_) => f64::NEG_INFINITY,
                ItemKind::Instance(index) => {
                    let instance = &group.instances[index];
                    let child = &self.groups[instance.group as usize];
                    let placed = *to_world * group.to_child(instance).inverse();
                    let least = best + offset;
                    self.group_reach(child, &placed, normal, slack, least) - offset
                }
                ItemKind::Triangle(index) => {
                    let corners = group.triangles[index].corners();
                    furthest(corners.map(|corner| inner.dot(corner)))
                }
                ItemKind::Quad(index) => {
                    let quad = &group.quads[index];
                    let edges = quad.edges.map(|edge| inner.dot(edge).max(0.0));
                    inner.dot(quad.corner) + edges[0] + edges[1]
                }
                ItemKind::Solid(index) => {
                    let solid = &group.solids[index];
                    let from_unit = solid.to_unit.inverse();
                    let along = from_unit.matrix3.transpose() * inner;
                    solid.form.reach(along) + inner.dot(from_unit.translation)
                }
            });
            reaches.fold(f64::NEG_INFINITY, f64::max)
        };
        group.bvh.extreme(inner, slack, least - offset, &mut reach) + offset
    }
}

fn furthest(values: [f64; 3]) -> f64 {
    values.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use crate::geometry::Shape;
    use crate::scene::Scene;
    use crate::scene::description::{
        Group, GroupId, Instance, MaterialId, OrganId, PlacedShape, SceneDescription,
    };
    use glam::{DAffine3, DVec3};

    fn placed(shape: Shape, to_group: DAffine3) -> PlacedShape {
        PlacedShape {
            shape,
            to_group,
            material: MaterialId(0),
            organ: OrganId(0),
        }
    }

    fn scene(groups: Vec<Group>) -> Scene {
        let root = GroupId(groups.len() as u32 - 1);
        Scene::build(SceneDescription {
            materials: vec![crate::material::Material::default()],
            groups,
            root: Some(root),
            ..SceneDescription::default()
        })
        .unwrap()
    }

    fn group(shapes: Vec<PlacedShape>) -> Group {
        Group {
            shapes,
            instances: vec![],
        }
    }

    #[test]
    fn a_stretched_ball_reaches_as_its_closed_form_says() {
        let map = DAffine3::from_translation(DVec3::new(5.0, 0.0, 1.0))
            * DAffine3::from_scale(DVec3::new(3.0, 1.0, 2.0));
        let ball = scene(vec![group(vec![
            placed(Shape::Sphere { radius: 1.0 }, map),
            placed(Shape::Plane, DAffine3::IDENTITY),
        ])]);
        for normal in [DVec3::X, DVec3::NEG_Y, DVec3::new(0.6, 0.0, 0.8)] {
            let expected =
                normal.dot(map.translation) + (DVec3::new(3.0, 1.0, 2.0) * normal).length();
            assert!((ball.reach(normal) - expected).abs() < 1e-4, "{normal}");
        }
    }

    #[test]
    fn shapes_of_instances_count_where_they_stand_and_2_to_the_28_of_them_cost_nothing() {
        let mut groups = vec![group(vec![placed(
            Shape::Sphere { radius: 1.0 },
            DAffine3::IDENTITY,
        )])];
        for level in 0..14 {
            let instance = |(x, y): (f64, f64)| Instance {
                group: GroupId(level),
                to_group: DAffine3::from_translation(DVec3::new(x, y, 0.0)),
                organ: OrganId(0),
            };
            groups.push(Group {
                shapes: vec![],
                instances: vec![(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)]
                    .into_iter()
                    .map(instance)
                    .collect(),
            });
        }
        let row = scene(groups);
        assert!((row.reach(DVec3::X) - 15.0).abs() < 0.01);
        assert!((row.reach(DVec3::Z) - 1.0).abs() < 0.01);
    }

    #[test]
    fn an_empty_scene_reaches_nowhere() {
        assert_eq!(
            scene(vec![group(vec![])]).reach(DVec3::X),
            f64::NEG_INFINITY
        );
    }
}
