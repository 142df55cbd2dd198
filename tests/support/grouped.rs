//! Worlds of groups within groups, some of which dissolve unless they are kept.

use super::room::{at, even_sky, gray, square};
use glam::{DAffine3, DVec3};
use std::sync::Arc;
use understory::geometry::{Shape, TriangleMesh};
use understory::material::Material;
use understory::material::image::Image;
use understory::material::texture::{Pictures, Texture};
use understory::scene::Scene;
use understory::scene::description::{
    Extras, Group, GroupId, Instance, MaterialId, OrganId, PlacedShape, SceneDescription,
};

/// The world of the last of these groups under an even sky, with all of them kept or not.
fn built(materials: Vec<Material>, groups: Vec<Group>, is_kept: bool) -> Scene {
    let root = u32::try_from(groups.len()).unwrap() - 1;
    let extras = Extras {
        groups: is_kept,
        ..Extras::default()
    };
    let description = SceneDescription {
        materials,
        groups,
        root: Some(GroupId(root)),
        environment: even_sky(1.0),
        extras,
        ..SceneDescription::default()
    };
    Scene::build(description).unwrap()
}

fn placed(shape: Shape, to_group: DAffine3, material: u32, organ: u32) -> PlacedShape {
    PlacedShape {
        shape,
        to_group,
        material: MaterialId(material),
        organ: OrganId(organ),
    }
}

fn instance(group: u32, to_group: DAffine3, organ: OrganId) -> Instance {
    Instance {
        group: GroupId(group),
        to_group,
        organ,
    }
}

const BALL: Shape = Shape::Sphere { radius: 0.2 };

/// Balls in a row.
fn row(n: u32, z: f64, material: u32) -> Group {
    let ball = |k| placed(BALL, at(f64::from(k) * 0.1 - 0.8, 0.0, z), material, k);
    Group {
        shapes: (0..n).map(ball).collect(),
        instances: vec![],
    }
}

/// Rows used once, and one that is used twice.
pub(crate) fn rows(is_kept: bool) -> Scene {
    let place = |group: u32, x: f64| {
        let to_group = at(x, 0.3, 0.0) * DAffine3::from_rotation_z(x);
        instance(group, to_group, OrganId::COPY)
    };
    let root = Group {
        shapes: vec![],
        instances: vec![place(0, 0.1), place(1, 0.0), place(2, -0.2), place(2, 0.3)],
    };
    let groups = vec![row(20, 0.4, 0), row(3, 0.9, 0), row(20, 1.4, 0), root];
    built(vec![Material::lambert(gray(0.5))], groups, is_kept)
}

/// Twigs, each a group of two leaves.
pub(crate) fn twigs(is_kept: bool) -> Scene {
    let leaf = |x: f64| {
        let tilted = at(x, 0.0, 0.0) * DAffine3::from_rotation_y(x * 6.0);
        placed(square(0.08), tilted, 0, 0)
    };
    let twig = Group {
        shapes: vec![leaf(-0.1), leaf(0.1)],
        instances: vec![],
    };
    let place = |k: u32| {
        let [x, y, z] = [k % 12, k / 12 % 12, k / 144].map(|i| f64::from(i) / 6.0 - 1.0);
        let turned = at(x, y, z + 1.0) * DAffine3::from_rotation_z(f64::from(k));
        instance(0, turned, OrganId::COPY)
    };
    let root = Group {
        shapes: vec![],
        instances: (0..1728).map(place).collect(),
    };
    let leaf = Material::leaf(gray(0.3), gray(0.3));
    built(vec![leaf], vec![twig, root], is_kept)
}

/// A quarter of a square, of two triangles with coordinates and smoothed normals.
fn patch() -> Shape {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let normal = |[x, y]: [f64; 2]| DVec3::new(x - 0.5, y - 0.5, 2.0).normalize();
    Shape::Mesh(Arc::new(TriangleMesh {
        positions: corners.map(|[x, y]| DVec3::new(x, y, 0.0)).into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        normals: corners.map(normal).into(),
        uvs: corners.map(Into::into).into(),
    }))
}

/// All kinds of shapes in groups that are mirrored, stretched, nested, shining, painted, endless or used often.
pub(crate) fn nested(is_kept: bool) -> Scene {
    let frustum = Shape::Frustum {
        length: 0.7,
        base_radius: 0.3,
        top_radius: 0.1,
        base_cap: true,
        top_cap: false,
    };
    let block = Shape::Box {
        half_x: 0.2,
        half_y: 0.3,
        length: 0.4,
    };
    let tin = Shape::Frustum {
        length: 0.5,
        base_radius: 0.2,
        top_radius: 0.2,
        base_cap: true,
        top_cap: true,
    };
    let twig = Group {
        shapes: vec![
            placed(frustum, at(0.0, 0.0, 0.1), 2, 1),
            placed(block, at(0.8, 0.0, 0.0), 3, 2),
            placed(Shape::Disk { radius: 0.4 }, at(0.0, 0.9, 0.3), 1, 3),
            placed(square(0.3), at(-0.9, 0.0, 0.5), 1, 4),
            placed(patch(), at(0.0, -1.2, 0.6), 2, 5),
        ],
        instances: vec![],
    };
    let slant = DAffine3::from_rotation_x(0.7) * DAffine3::from_scale(DVec3::new(0.8, 1.2, 1.0));
    let branch = Group {
        shapes: vec![placed(BALL, at(0.0, 0.0, 1.5), 2, 6)],
        instances: vec![instance(0, at(0.1, 0.2, 0.6) * slant, OrganId::COPY)],
    };
    let holder = Group {
        shapes: vec![placed(Shape::Plane, at(0.0, 0.0, -1.5), 0, 7)],
        instances: vec![
            instance(2, at(0.0, 0.5, -0.7), OrganId(50)),
            instance(2, at(0.0, -0.5, -1.0), OrganId::COPY),
        ],
    };
    let mirrored =
        DAffine3::from_scale(DVec3::new(-1.1, 0.9, 1.0)) * DAffine3::from_rotation_z(0.4);
    let root = Group {
        shapes: vec![placed(tin, at(-1.2, -1.0, -0.5), 3, 8)],
        instances: vec![
            instance(1, mirrored, OrganId(100)),
            instance(
                3,
                at(0.1, 0.0, 0.0) * DAffine3::from_rotation_z(1.0),
                OrganId::COPY,
            ),
        ],
    };
    let holes = Texture::new(Arc::new(
        Image::linear(2, 1, vec![[1.0; 4], [1.0, 1.0, 1.0, 0.5]]).unwrap(),
    ));
    let holed = Material {
        pictures: Some(Box::new(Pictures {
            layers: vec![],
            holes: vec![holes],
        })),
        ..Material::lambert(gray(0.5))
    };
    let materials = vec![
        Material::lambert(gray(0.5)),
        Material::lambert(gray(0.2)).emitting(gray(2.0), gray(1.0)),
        holed,
        Material::mirror(gray(0.9)),
    ];
    let groups = vec![twig, branch, row(20, 0.0, 2), holder, root];
    built(materials, groups, is_kept)
}
