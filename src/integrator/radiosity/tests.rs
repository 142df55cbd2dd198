//! Tests of the parts of radiosity against what is known on paper.

mod enclosures;
mod factors;

use super::*;
use crate::geometry::Shape;
use crate::integrator::CancelToken;
use crate::material::Material;
use crate::validation::room::{Room, at, gray, square};
use glam::{DAffine3, DQuat, DVec3};
use system::PatchSide;

/// A scene with its patches.
pub(super) struct Laid<'s> {
    pub(super) carrier: Carrier<'s>,
    pub(super) mesh: Mesh,
}

impl<'s> Laid<'s> {
    pub(super) fn new(scene: &'s Scene) -> Self {
        Self::cut(scene, 1 << 20)
    }

    /// With at most about so many patches.
    pub(super) fn cut(scene: &'s Scene, most: u64) -> Self {
        Self {
            carrier: Carrier {
                scene,
                bodies: Bodies::new(scene),
                max_depth: 8,
            },
            mesh: Mesh::new(scene, most).unwrap(),
        }
    }

    /// A back end, with so many rays a row or pixels along a cube.
    pub(super) fn factors(
        &self,
        method: FormFactorMethod,
        n_rays: u32,
        pixels: u32,
    ) -> Box<dyn FormFactors + '_> {
        match method {
            FormFactorMethod::Rays => Box::new(self.rays(n_rays)),
            FormFactorMethod::Hemicube => {
                let (mesh, carrier) = (&self.mesh, &self.carrier);
                Box::new(Hemicubes::new(mesh, carrier, 1, pixels, CUBES, None))
            }
            FormFactorMethod::Analytic => Box::new(NearForms::new(self.rays(n_rays))),
        }
    }

    pub(super) fn rays(&self, n: u32) -> CosineRays<'_, 's> {
        CosineRays {
            mesh: &self.mesh,
            carrier: &self.carrier,
            seed: 1,
            n,
        }
    }

    /// Patches whose fronts get this irradiance from a source and send back the part `rho` of all.
    pub(super) fn patches(&self, rho: f64, source: impl Fn(u32) -> f64) -> Vec<Patch> {
        let front = |node: u32| PatchSide {
            reflectance: gray(rho),
            source: gray(source(node)),
            ..PatchSide::default()
        };
        let nodes = self.mesh.patches.iter();
        nodes
            .map(|node| Patch {
                area: self.mesh.nodes[*node as usize].area,
                weight: self.mesh.nodes[*node as usize].area,
                sides: [front(*node), PatchSide::default()],
            })
            .collect()
    }

    pub(super) fn rows(&self, factors: &dyn FormFactors, patches: &[Patch]) -> Vec<Row> {
        let cancel = CancelToken::default();
        let context = RenderContext {
            seed: 1,
            cancel: &cancel,
            progress: &|_| {},
        };
        gathered_rows(factors, patches, &self.mesh, &context)
    }
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

/// C-13: all that leaves a patch of a closed room arrives somewhere, whatever the surfaces are.
#[test]
fn all_rays_of_a_closed_room_arrive() {
    let ball = Shape::Sphere { radius: 0.4 };
    let tube = Shape::Frustum {
        length: 1.0,
        base_radius: 0.3,
        top_radius: 0.1,
        base_cap: true,
        top_cap: false,
    };
    let stretched = at(0.4, 0.4, -0.3) * DAffine3::from_scale(DVec3::new(1.0, 0.5, 0.7));
    let room = gray_cube(0.5)
        .with(ball, stretched, Material::default())
        .with(tube, at(-0.4, -0.4, -0.9), Material::default());
    let scene = room.scene().unwrap();
    let laid = Laid::new(&scene);
    let rays = laid.rays(64);
    for (patch, node) in laid.mesh.patches.iter().enumerate().step_by(7) {
        let row = rays.row(*node, 0);
        let sum: f64 = row.entries().map(|(_, factor)| factor.g).sum();
        assert!((sum - 1.0).abs() < 1e-6, "patch {patch}: {sum}");
    }
}

/// C-17: in a closed room that shines evenly everywhere has E/(1 - ρ); C-19: at once where nothing is reflected.
#[test]
fn a_furnace_is_even() {
    let scene = gray_cube(0.5).scene().unwrap();
    let laid = Laid::new(&scene);
    let rays = laid.rays(16);
    let mut rows = Vec::new();
    for rho in [0.5, 0.9, 0.99, 0.999, 0.0] {
        let patches = laid.patches(rho, |_| 1.0);
        if rows.is_empty() {
            rows = laid.rows(&rays, &patches);
        }
        let mut sweeps = 0;
        let solved = gather::solve(&patches, &rows, 1e-5, |_| {
            sweeps += 1;
            true
        });
        assert!(solved.is_converged);
        assert!(rho > 0.0 || sweeps == 0, "{sweeps} sweeps for nothing");
        let expected = rho / (1.0 - rho);
        for light in solved.irradiance.iter().step_by(2).filter(|_| rho > 0.0) {
            assert!((light.g / expected - 1.0).abs() < 1e-4, "{rho}: {light:?}");
        }
    }
}

/// C-18: where nothing is ever lost there is no solution, which is said.
#[test]
fn a_room_that_loses_nothing_is_told() {
    let scene = gray_cube(1.0).scene().unwrap();
    let laid = Laid::new(&scene);
    let patches = laid.patches(1.0, |_| 1.0);
    let rays = laid.rays(1);
    let rows = laid.rows(&rays, &patches);
    let left = std::cell::Cell::new(0);
    let few = |_| {
        left.set(left.get() - 1);
        left.get() > 0
    };
    left.set(100);
    let gathered = gather::solve(&patches, &rows, 1e-3, few);
    let shots = shoot::Shots {
        factors: &rays,
        nodes: &laid.mesh.patches,
        room: 1 << 30,
    };
    left.set(100);
    let shot = shoot::solve(&patches, &shots, 1e-3, few);
    left.set(100);
    let thrown = stochastic::solve(&patches, &rays, 1 << 12, 1e-3, few);
    for solved in [gathered, shot, thrown] {
        assert!(!solved.is_converged && solved.residual > 0.1);
        let finite = |light: &Rgb| light.is_finite() && light.min_channel() >= 0.0;
        assert!(solved.irradiance.iter().all(finite));
    }
}

/// C-20b: all ways to solve find the same light: what all walls get together is known; that of each wall agrees to 3 %, with factors whose noise
/// averages out over hundreds of patches. A factor π, an area or a side mixed up would be off by a half.
#[test]
fn solvers_agree() {
    let scene = gray_cube(0.6).scene().unwrap();
    let laid = Laid::new(&scene);
    let first = |node: u32| {
        let chart = laid.mesh.nodes[node as usize].cell.chart;
        if chart == 0 { 1.0 } else { 0.0 }
    };
    let patches = laid.patches(0.6, first);
    let rays = laid.rays(64);
    let rows = laid.rows(&rays, &patches);
    let gathered = gather::solve(&patches, &rows, 1e-4, |_| true);
    let shots = shoot::Shots {
        factors: &rays,
        nodes: &laid.mesh.patches,
        room: 1 << 30,
    };
    let shot = shoot::solve(&patches, &shots, 1e-3, |_| true);
    let n_rays = 64 * patches.len() as u64;
    let thrown = stochastic::solve(&patches, &rays, n_rays, 1e-3, |_| true);
    let mut all = Vec::new();
    for (name, solved) in [
        ("gather", gathered),
        ("shoot", shot),
        ("stochastic", thrown),
    ] {
        assert!(solved.is_converged, "{name}");
        let mut walls = [0.0; 6];
        for (patch, node) in laid.mesh.patches.iter().enumerate() {
            let node = &laid.mesh.nodes[*node as usize];
            walls[node.cell.chart as usize] += solved.irradiance[2 * patch].g * node.area / 4.0;
        }
        // One wall gets 1; all together get 1/(1 - 0.6), and 1 of that is not from other walls.
        let sum: f64 = walls.iter().sum();
        assert!((sum / 1.5 - 1.0).abs() < 0.01, "{name}: {sum}");
        all.push((name, walls));
    }
    for (name, walls) in &all[1..] {
        for (found, expected) in walls.iter().zip(all[0].1) {
            assert!(
                (found / expected - 1.0).abs() < 0.03,
                "{name}: {found} {expected}"
            );
        }
    }
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
        let mut mesh = Laid::new(&scene).mesh;
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
