//! Meshes, random numbers and one-line worlds to try rays in.

use crate::geometry::{Shape, TriangleMesh};
use crate::material::Material;
use crate::math::rng;
use crate::scene::description::{
    Extras, Group, GroupId, Instance, MaterialId, OrganId, PlacedShape, SceneDescription,
};
use crate::scene::{Scene, SceneError};
use glam::{DAffine3, DMat3, DVec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A stream of pseudo-random numbers (`SplitMix64`), the same in every run.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        rng::mix(self.0)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        rng::unit_f64(self.bits())
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A whole number below `n`, which is not 0.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n.max(1) as u64) as usize
    }

    /// Uniform in the cube -1..1.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::new(
            self.between(-1.0, 1.0),
            self.between(-1.0, 1.0),
            self.between(-1.0, 1.0),
        )
    }

    /// Uniform over all directions.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.in_cube();
            // Nearer to the middle rounding would show.
            if v.length_squared() <= 1.0 && v.length_squared() > 1.0 / 1e6 {
                return v.normalize();
            }
        }
    }

    /// A rotation, uneven scale and sometimes a mirror, times `scale`.
    pub fn affine(&mut self, scale: f64) -> DAffine3 {
        let x = self.direction();
        let y = x.any_orthonormal_vector();
        let z = x.cross(y) * if self.unit() < 0.5 { -1.0 } else { 1.0 };
        let stretch = DVec3::new(
            self.between(0.3, 2.0),
            self.between(0.3, 2.0),
            self.between(0.3, 2.0),
        );
        DAffine3 {
            matrix3: DMat3::from_cols(x, y, z) * DMat3::from_diagonal(stretch * scale),
            translation: self.in_cube() * 3.0 * scale,
        }
    }
}

/// A closed ball of 20·4ⁿ triangles round the origin, fronts outside.
#[must_use]
pub fn icosphere(n: u32, radius: f64) -> TriangleMesh {
    let g = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut positions: Vec<DVec3> = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ]
    .map(|p| DVec3::from_array(p).normalize())
    .to_vec();
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..n {
        let mut middles = BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    positions.iter_mut().for_each(|p| *p *= radius);
    TriangleMesh {
        positions,
        triangles,
        ..TriangleMesh::default()
    }
}

/// A closed mesh with acute edges, its front outside, round the origin.
#[must_use]
pub fn tetrahedron(size: f64) -> TriangleMesh {
    let corners = [
        [1.0, 1.0, 1.0],
        [-1.0, -1.0, 1.0],
        [-1.0, 1.0, -1.0],
        [1.0, -1.0, -1.0],
    ];
    let corners = corners.map(|corner| DVec3::from_array(corner) * size);
    TriangleMesh {
        positions: corners.to_vec(),
        triangles: vec![[0, 1, 3], [0, 2, 1], [0, 3, 2], [1, 2, 3]],
        ..TriangleMesh::default()
    }
}

/// A mesh of separate triangles.
#[must_use]
pub fn soup(corners: &[[DVec3; 3]]) -> TriangleMesh {
    TriangleMesh {
        positions: corners.iter().flatten().copied().collect(),
        triangles: (0..corners.len() as u32)
            .map(|k| [3 * k, 3 * k + 1, 3 * k + 2])
            .collect(),
        ..TriangleMesh::default()
    }
}

/// A shape of the first material.
#[must_use]
pub fn placed(shape: Shape, to_group: DAffine3, organ: u32) -> PlacedShape {
    PlacedShape {
        shape,
        to_group,
        material: MaterialId(0),
        organ: OrganId(organ),
    }
}

/// A mesh as a shape.
#[must_use]
pub fn mesh(mesh: TriangleMesh) -> Shape {
    Shape::Mesh(Arc::new(mesh))
}

/// A group somewhere.
#[must_use]
pub fn instance(group: u32, to_group: DAffine3, organ: u32) -> Instance {
    Instance {
        group: GroupId(group),
        to_group,
        organ: OrganId(organ),
    }
}

/// A description with one grey material whose root is the last group.
#[must_use]
pub fn describe(groups: Vec<Group>) -> SceneDescription {
    SceneDescription {
        materials: vec![Material::default()],
        root: groups.len().checked_sub(1).map(|root| GroupId(root as u32)),
        groups,
        // Rays are asked for the coordinates of what they meet.
        extras: Extras {
            coordinates: true,
            ..Extras::default()
        },
        ..SceneDescription::default()
    }
}

/// A world of these shapes.
///
/// # Errors
/// The first thing that cannot be part of one.
pub fn try_build(shapes: Vec<PlacedShape>) -> Result<Scene, SceneError> {
    Scene::build(describe(vec![Group {
        shapes,
        instances: vec![],
    }]))
}
