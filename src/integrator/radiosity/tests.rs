//! Tests of the parts of radiosity against what is known on paper.

mod enclosures;

use super::*;
use crate::geometry::Shape;
use crate::integrator::CancelToken;
use crate::material::Material;
use crate::validation::room::{Room, at, gray, square};
use glam::{DAffine3, DQuat, DVec3};
use laid::{Front, Laid, Means};
use system::PatchSide;

/// A scene with at most about so many patches.
fn cut(scene: &Scene, most: u64) -> Laid<'_> {
    Laid::cut(scene, most).unwrap()
}

/// Patches whose fronts get even light of 1 W/m² and send back the part `rho` of all.
fn even(laid: &Laid<'_>, rho: f64) -> Vec<Patch> {
    laid.with_fronts(&vec![Front { rho, source: 1.0 }; laid.mesh.patches.len()])
}

fn rows(laid: &Laid<'_>, factors: &dyn FormFactors, patches: &[Patch]) -> Vec<Row> {
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 1,
        cancel: &cancel,
        progress: &|_| {},
    };
    laid.all_rows(factors, patches, &context)
}

/// A closed cube of 2 m, seen from inside: six squares that look inwards.
pub(super) fn cube(materials: [Material; 6]) -> Room {
    let axes = [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::NEG_X,
        DVec3::NEG_Y,
        DVec3::NEG_Z,
    ];
    let walls = axes.into_iter().zip(materials);
    walls.fold(Room::default(), |room, (axis, material)| {
        let turn = DQuat::from_rotation_arc(DVec3::Z, -axis);
        let place = DAffine3::from_rotation_translation(turn, axis);
        room.with(square(1.0), place, material)
    })
}

pub(super) fn gray_cube(rho: f64) -> Room {
    cube(std::array::from_fn(|_| Material::lambert(gray(rho))))
}

#[test]
fn round_faces_are_split_as_often_as_wanted_and_no_more() {
    // At the middle of a disk and the poles of a ball edges have no length: their own corners are not smaller neighbours.
    for shape in [Shape::Sphere { radius: 1.0 }, Shape::Disk { radius: 1.0 }] {
        let room = Room::default().with(
            shape.clone(),
            DAffine3::IDENTITY,
            Material::lambert(gray(0.5)),
        );
        let scene = room.scene().unwrap();
        let mut mesh = cut(&scene, 1 << 20).mesh;
        let (n, cancel) = (mesh.patches.len(), CancelToken::default());
        let refinement = Refinement {
            threshold: 0.0,
            depth: 2,
            most: 1 << 20,
            size: 2.0,
            cancel: &cancel,
        };
        // Light that differs from node to node, so that all are split.
        let light = |mesh: &Mesh, first: usize| -> Vec<[Rgb; 2]> {
            let nodes = first..mesh.nodes.len();
            nodes.map(|at| [gray((at % 7) as f64); 2]).collect()
        };
        let mut irradiance = light(&mesh, 0);
        refine::refine(
            &mut mesh,
            &mut irradiance,
            &refinement,
            &vec![1.0; n],
            light,
        );
        let elements = mesh.elements().count();
        assert!(
            elements > n && elements <= 16 * n,
            "{shape:?}: {elements} of {n}"
        );
    }
}
