//! The solution as bytes, and back.
//!
//! Number of patches, residual, whether it converged; the faces; the grid of each; of each cell its children and its patch; the
//! corners of elements; the light at corners, and, if there is such light, what mirrors and glass threw of it. What cells are follows from that, to the last bit. Whoever reads trusts nothing.

use super::RadiositySolution;
use super::mesh::{Cell, Grid, Mesh, NONE, Node, faces, parts};
use super::vertices::Vertices;
use crate::geometry::chart::{Chart, Form};
use crate::geometry::unit::Face;
use crate::integrator::Unreadable;
use crate::integrator::bytes::{Reader, put};
use crate::math::PrimitiveId;
use crate::scene::description::MaterialId;
use crate::scene::{PlacedChart, Scene};
use glam::{DAffine3, DMat3};
use std::sync::OnceLock;

/// Bytes of a face with its grid, of a cell, and of the light at a corner.
const FACE: usize = 12 * 8 + 1 + 16 + 8 + 1 + 4 + 12;
const CELL: usize = 8;
const LIGHT: usize = 48;

/// What face it is, as a number; a cube's axis and side are added.
const SIDE: u8 = 0;
const BASE: u8 = 1;
const TOP: u8 = 2;
const CUBE: u8 = 3;

const WRONG_TREE: Unreadable = Unreadable("its cells are no trees");

impl RadiositySolution {
    /// The solution as bytes.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        put(&mut out, self.patches.to_le_bytes());
        put(&mut out, self.residual.to_le_bytes());
        out.push(u8::from(self.is_converged));
        put(&mut out, (self.mesh.charts.len() as u64).to_le_bytes());
        for (placed, grid) in self.mesh.charts.iter().zip(&self.mesh.grids) {
            put_face(&mut out, placed);
            for number in [grid.first, grid.n[0], grid.n[1]] {
                put(&mut out, number.to_le_bytes());
            }
        }
        put(&mut out, (self.mesh.nodes.len() as u64).to_le_bytes());
        for node in &self.mesh.nodes {
            put(&mut out, node.children.to_le_bytes());
            put(&mut out, node.patch.to_le_bytes());
        }
        for node in self.mesh.elements() {
            for corner in self.vertices.corners[node as usize] {
                put(&mut out, corner.to_le_bytes());
            }
        }
        put(&mut out, (self.vertices.values.len() as u64).to_le_bytes());
        for light in self.vertices.values.as_flattened() {
            let light = light.to_array();
            light.iter().for_each(|c| put(&mut out, c.to_le_bytes()));
        }
        for light in self.focused.iter().flatten().flatten() {
            let light = light.to_array();
            light.iter().for_each(|c| put(&mut out, c.to_le_bytes()));
        }
        out
    }

    /// The solution that these bytes are of.
    ///
    /// # Errors
    /// If they are of none.
    pub(super) fn from_bytes(bytes: &[u8]) -> Result<Self, Unreadable> {
        let mut reader = Reader(bytes);
        let (patches, residual) = (reader.u64()?, reader.f64()?);
        let is_converged = reader.flag()?;
        let mesh = reader.mesh(patches)?;
        let mut corners = vec![[NONE; 4]; mesh.nodes.len()];
        for node in mesh.elements() {
            for corner in &mut corners[node as usize] {
                *corner = reader.u32()?;
            }
        }
        let n = reader.count(LIGHT)?;
        let values = (0..n).map(|_| Ok([reader.light()?, reader.light()?]));
        let values = values.collect::<Result<Vec<_>, Unreadable>>()?;
        let is_known = |corner: &u32| *corner == NONE || (*corner as usize) < n;
        if !corners.as_flattened().iter().all(is_known) {
            return Err(Unreadable("an element has corners that there are not"));
        }
        // Files of before that part was held apart end here too.
        let focused = (!reader.0.is_empty()).then(|| {
            let values = (0..n).map(|_| Ok([reader.light()?, reader.light()?]));
            values.collect::<Result<Vec<_>, Unreadable>>()
        });
        let focused = focused.transpose()?;
        reader.end()?;
        Ok(Self {
            focused,
            is_split: true,
            mesh,
            vertices: Vertices { corners, values },
            fits: OnceLock::new(),
            gather: OnceLock::new(),
            patches,
            residual,
            is_converged,
        })
    }

    /// Whether its faces are those of the scene: what is read may be of any.
    pub(super) fn fits(&self, scene: &Scene) -> bool {
        *self
            .fits
            .get_or_init(|| faces(scene, u64::MAX).is_ok_and(|faces| faces == self.mesh.charts))
    }
}

fn put_face(out: &mut Vec<u8>, placed: &PlacedChart) {
    let PlacedChart {
        chart,
        primitive,
        face,
        material,
    } = placed;
    let map = chart.to_world.to_cols_array();
    map.iter().for_each(|x| put(out, x.to_le_bytes()));
    let (form, radii) = match chart.form {
        Form::Triangle => (0, [0.0; 2]),
        Form::Parallelogram => (1, [0.0; 2]),
        Form::Disk => (2, [0.0; 2]),
        Form::Sphere => (3, [0.0; 2]),
        Form::Side { base, top } => (4, [base, top]),
    };
    out.push(form);
    radii.iter().for_each(|x| put(out, x.to_le_bytes()));
    put(out, primitive.0.to_le_bytes());
    out.push(match *face {
        Face::Side => SIDE,
        Face::Base => BASE,
        Face::Top => TOP,
        Face::Cube(axis, is_positive) => CUBE + 2 * axis + u8::from(is_positive),
    });
    put(out, material.0.to_le_bytes());
}

impl Reader<'_> {
    fn face(&mut self) -> Result<PlacedChart, Unreadable> {
        let axes = [self.dvec3()?, self.dvec3()?, self.dvec3()?];
        let to_world = DAffine3 {
            matrix3: DMat3::from_cols(axes[0], axes[1], axes[2]),
            translation: self.dvec3()?,
        };
        let (form, base, top) = (self.u8()?, self.f64()?, self.f64()?);
        let form = match form {
            0 => Form::Triangle,
            1 => Form::Parallelogram,
            2 => Form::Disk,
            3 => Form::Sphere,
            4 => Form::Side { base, top },
            _ => return Err(Unreadable("a face has no form that there is")),
        };
        let primitive = PrimitiveId(self.u64()?);
        let face = match self.u8()? {
            SIDE => Face::Side,
            BASE => Face::Base,
            TOP => Face::Top,
            cube @ CUBE..=8 => Face::Cube((cube - CUBE) / 2, (cube - CUBE) % 2 == 1),
            _ => return Err(Unreadable("a face is not one of its shape")),
        };
        Ok(PlacedChart {
            chart: Chart { to_world, form },
            primitive,
            face,
            material: MaterialId(self.u32()?),
        })
    }

    fn mesh(&mut self, n_patches: u64) -> Result<Mesh, Unreadable> {
        let n_faces = self.count(FACE)?;
        let (mut charts, mut grids) = (Vec::new(), Vec::new());
        for _ in 0..n_faces {
            charts.push(self.face()?);
            let (first, n) = (self.u32()?, [self.u32()?, self.u32()?]);
            grids.push(Grid { first, n });
        }
        let n_cells = self.count(CELL)?;
        let trees = (0..n_cells).map(|_| Ok([self.u32()?, self.u32()?]));
        let trees = trees.collect::<Result<Vec<_>, Unreadable>>()?;
        let cells = cells(&charts, &grids, &trees)?;
        let nodes = cells.into_iter().zip(&trees);
        let nodes: Vec<Node> = nodes
            .map(|(cell, [children, patch])| Node {
                cell,
                children: *children,
                patch: *patch,
                area: charts[cell.chart as usize]
                    .chart
                    .area(cell.origin, cell.size),
            })
            .collect();
        let patches = patches(&nodes, n_patches)?;
        Ok(Mesh {
            charts,
            grids,
            nodes,
            patches,
        })
    }
}

/// The cells of which grids and children tell: each belongs to one grid or has one parent, which stands before it.
fn cells(
    charts: &[PlacedChart],
    grids: &[Grid],
    trees: &[[u32; 2]],
) -> Result<Vec<Cell>, Unreadable> {
    let mut cells: Vec<Option<Cell>> = vec![None; trees.len()];
    let mut place = |at: u64, cell: Cell| match cells.get_mut(at as usize) {
        Some(free @ None) => {
            *free = Some(cell);
            Ok(())
        }
        _ => Err(WRONG_TREE),
    };
    for (chart, grid) in grids.iter().enumerate() {
        let [n, m] = grid.n;
        let is_possible = n > 0 && m > 0 && u64::from(n) * u64::from(m) <= trees.len() as u64;
        if !is_possible {
            return Err(WRONG_TREE);
        }
        for k in 0..n * m {
            let cell = Cell::of_grid(chart as u32, grid.n, k);
            place(u64::from(grid.first) + u64::from(k), cell)?;
        }
    }
    for (at, [children, _]) in trees.iter().enumerate() {
        let cell = cells[at].ok_or(WRONG_TREE)?;
        if *children == NONE {
            continue;
        }
        let is_triangle = charts[cell.chart as usize].chart.form == Form::Triangle;
        for (k, part) in (0..).zip(parts(&cell, is_triangle)) {
            match cells.get_mut(*children as usize + k) {
                Some(free @ None) => *free = Some(part),
                _ => return Err(WRONG_TREE),
            }
        }
    }
    cells
        .into_iter()
        .map(|cell| cell.ok_or(WRONG_TREE))
        .collect()
}

/// The cell that each patch is: the first of those that belong to it.
fn patches(nodes: &[Node], n: u64) -> Result<Vec<u32>, Unreadable> {
    let unknown = Unreadable("a cell belongs to a patch that there is not");
    if n > nodes.len() as u64 {
        return Err(unknown);
    }
    let mut patches = vec![NONE; n as usize];
    for (at, node) in (0_u32..).zip(nodes) {
        if node.patch != NONE {
            let patch = patches.get_mut(node.patch as usize).ok_or(unknown)?;
            *patch = (*patch).min(at);
        }
    }
    if patches.contains(&NONE) {
        return Err(unknown);
    }
    Ok(patches)
}
