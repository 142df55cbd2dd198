//! Curved surfaces and meshes that a model describes: each different one becomes triangles once, as a group, which stands
//! wherever a node describes the same.

use super::appearance::Appearance;
use super::failure::{self, Failure};
use super::shapes::FIELDS;
use super::source::Source;
use super::walk::{Painter, Place};
use crate::eval::freeform::{CurveForm, Freeform, MeshForm, Points, SurfaceForm};
use crate::geometry::curved::basis::Basis;
use crate::geometry::curved::curve::plain;
use crate::geometry::curved::tessellate::Tolerance;
use crate::geometry::curved::{Curve, CurvedError, Surface, Sweep, tessellate};
use crate::geometry::{Shape, TriangleMesh};
use crate::graph::NodeId;
use crate::scene::description::{GroupId, MaterialId, PlacedShape};
use crate::turtle::TurtleState;
use crate::turtle::effect::{Effect, Primitive};
use glam::{DAffine3, DVec2, DVec3, DVec4};
use std::collections::HashMap;
use std::sync::Arc;

/// What was drawn before.
#[derive(Debug, Default)]
pub(super) struct CurvedShapes {
    /// By primitive, numbers and error. Looked up only, never iterated.
    numbers: HashMap<Vec<u64>, usize>,
    meshes: Vec<Arc<TriangleMesh>>,
    /// By mesh and material. Looked up only, never iterated.
    groups: HashMap<(usize, MaterialId), GroupId>,
}

impl<S: Source> Painter<'_, S> {
    /// Draws a curved surface or mesh that a node describes.
    pub(super) fn draw_curved(
        &mut self,
        node: NodeId,
        primitive: Primitive,
        state: &TurtleState,
        place: Place,
    ) -> Result<(), Failure> {
        let Some(form) = self.form_of(node, primitive) else {
            self.warn(node, "curved-nothing", "has no surface to draw");
            return Ok(());
        };
        let graph = self.source.graph();
        let error = graph.get_f64(node, FIELDS.curved_error).unwrap_or(0.0);
        let is_open = |field| graph.get_bool(node, field).unwrap_or(false);
        let caps = FIELDS.sweep_open.map(|field| !is_open(field));
        let mut key = vec![
            primitive as u64,
            error.to_bits(),
            u64::from(caps[0]),
            u64::from(caps[1]),
        ];
        form.write_key(&mut key);
        let number = match self.curved.numbers.get(&key) {
            Some(number) => *number,
            None => {
                let error = if error > 0.0 {
                    Tolerance::Metres(error)
                } else {
                    Tolerance::USUAL
                };
                let mesh = mesh_of(&form, primitive, error, caps);
                let mesh = mesh.map_err(|why| {
                    failure::curved(&self.name(node, place), &why.to_string(), self.made(node))
                })?;
                self.charge(mesh.bytes() + 8 * key.len(), node, place)?;
                let number = self.curved.meshes.len();
                self.curved.meshes.push(Arc::new(mesh));
                self.curved.numbers.insert(key, number);
                number
            }
        };
        let shape = Shape::Mesh(Arc::clone(&self.curved.meshes[number]));
        let does = Effect::Draw(primitive);
        let material = self.material_of(node, does, state, (&shape, &state.transform), place)?;
        let group = match self.curved.groups.get(&(number, material)) {
            Some(group) => *group,
            None => {
                let outer = std::mem::take(&mut self.canvas);
                let organ = self.organ(node, place);
                let to_group = DAffine3::IDENTITY;
                let shape = PlacedShape {
                    shape,
                    to_group,
                    material,
                    organ,
                };
                let drawn = self.push_shape(shape, node, place);
                let canvas = std::mem::replace(&mut self.canvas, outer);
                drawn?;
                let group = self.add_group(canvas);
                self.curved.groups.insert((number, material), group);
                group
            }
        };
        self.push_instance(group, state.transform, node, place)
    }

    fn form_of(&self, node: NodeId, primitive: Primitive) -> Option<Freeform> {
        let field = match primitive {
            Primitive::Surface => FIELDS.surface,
            Primitive::Polygons => FIELDS.polygons,
            _ => FIELDS.sweep_points,
        };
        let object = self.source.graph().peek_object(node, field).ok().flatten();
        object.and_then(Appearance::freeform)
    }
}

fn mesh_of(
    form: &Freeform,
    primitive: Primitive,
    error: Tolerance,
    caps: [bool; 2],
) -> Result<TriangleMesh, CurvedError> {
    match form {
        Freeform::Surface(form) => surface_mesh(form, error),
        Freeform::Mesh(form) => polygons(form),
        Freeform::Points(points) if primitive == Primitive::Sweep => {
            let four = points.data.chunks_exact(4);
            if !four.remainder().is_empty() {
                return Err(points_error(
                    "its numbers are not x, y, z and radius of each point: their count is no multiple of 4",
                ));
            }
            let stem: Vec<(DVec3, f64)> =
                four.map(|p| (DVec3::new(p[0], p[1], p[2]), p[3])).collect();
            Sweep::stem(&stem)?.closed(error, caps)
        }
        Freeform::Points(_) | Freeform::Curve(_) => {
            Err(points_error("it is a line, which has no surface"))
        }
    }
}

fn points_error(what: &str) -> CurvedError {
    CurvedError::Points(what.to_owned())
}

/// A count or degree of the model.
fn count(n: i32) -> usize {
    usize::try_from(n).unwrap_or(0)
}

fn surface_mesh(form: &SurfaceForm, error: Tolerance) -> Result<TriangleMesh, CurvedError> {
    match form {
        SurfaceForm::Grid {
            points,
            u_count,
            degrees,
        } => {
            let points = control(points)?;
            let n_u = count(*u_count);
            if n_u < 2 || !points.len().is_multiple_of(n_u) {
                let message = format!("{} points do not fill rows of {u_count}", points.len());
                return Err(CurvedError::Points(message));
            }
            let n_v = points.len() / n_u;
            let [u, v] = degrees.map_or([n_u - 1, n_v.saturating_sub(1)], |d| d.map(count));
            let bases = [Basis::clamped(u, n_u)?, Basis::clamped(v, n_v)?];
            tessellate(&Surface::new(bases, points)?, error)
        }
        SurfaceForm::Sweep(profile, trajectory) => {
            let spine = smooth(curve(trajectory)?)?;
            let constant = spine
                .control()
                .iter()
                .map(|p| DVec4::new(p.w, 0.0, 0.0, p.w))
                .collect();
            let radius = Curve::new(spine.basis().clone(), constant)?;
            tessellate(&Sweep::new(spine, curve(profile)?, radius)?, error)
        }
        SurfaceForm::Skin(profiles) => {
            let curves: Result<Vec<Curve>, _> = profiles.iter().map(curve).collect();
            tessellate(&Surface::skin(&curves?)?, error)
        }
        SurfaceForm::Revolution(profile) => {
            tessellate(&Surface::revolution(&curve(profile)?)?, error)
        }
    }
}

/// A spine without corners: one of straight pieces becomes the smooth curve through its points.
fn smooth(spine: Curve) -> Result<Curve, CurvedError> {
    if spine.basis().degree() > 1 {
        return Ok(spine);
    }
    let points: Vec<DVec3> = spine.control().iter().map(|p| p.truncate() / p.w).collect();
    Curve::through(&points)
}

fn curve(form: &CurveForm) -> Result<Curve, CurvedError> {
    match form {
        CurveForm::Circle(radius) => Curve::circle(*radius),
        CurveForm::Polygon(sides) => Curve::polygon(1.0, count(*sides)),
        CurveForm::Through(points) => {
            let points: Vec<DVec3> = control(points)?.into_iter().map(DVec4::truncate).collect();
            Curve::through(&points)
        }
        CurveForm::Spline {
            points,
            degree,
            is_periodic,
            is_bezier,
        } => {
            let mut points = control(points)?;
            // GroIMP lowers the degree of a curve of too few points.
            let degree = count(*degree).min(points.len().saturating_sub(1));
            let basis = if *is_periodic {
                points.extend_from_within(..degree.min(points.len()));
                Basis::periodic(degree, points.len())?
            } else if *is_bezier {
                let pieces = points
                    .len()
                    .saturating_sub(1)
                    .checked_div(degree)
                    .unwrap_or(0);
                let ends: Vec<f64> = (0..=pieces).map(|i| i as f64).collect();
                points.truncate(pieces * degree + 1);
                Basis::pieces(degree, &ends)?
            } else {
                Basis::clamped(degree, points.len())?
            };
            Curve::new(basis, points)
        }
    }
}

/// Control points: of two coordinates in the plane of x and y, of four with their weight, x, y and z times it.
fn control(points: &Points) -> Result<Vec<DVec4>, CurvedError> {
    let dimension = count(points.dimension);
    if !(2..=4).contains(&dimension) {
        return Err(points_error("its points must have 2, 3 or 4 numbers each"));
    }
    let each = points.data.chunks_exact(dimension);
    if !each.remainder().is_empty() {
        let message = format!(
            "its {} numbers are no multiple of {dimension}",
            points.data.len()
        );
        return Err(CurvedError::Points(message));
    }
    Ok(each
        .map(|p| match p {
            [x, y] => plain(DVec3::new(*x, *y, 0.0)),
            [x, y, z] => plain(DVec3::new(*x, *y, *z)),
            [x, y, z, w, ..] => DVec4::new(*x, *y, *z, *w),
            _ => DVec4::W,
        })
        .collect())
}

fn polygons(form: &MeshForm) -> Result<TriangleMesh, CurvedError> {
    let vector = |v: &[f64]| DVec3::new(v[0], v[1], v[2]);
    let vectors = |list: &[f64]| -> Vec<DVec3> { list.chunks_exact(3).map(vector).collect() };
    let positions = vectors(&form.vertices);
    let normals: Vec<DVec3> = vectors(&form.normals)
        .into_iter()
        .map(DVec3::normalize_or_zero)
        .collect();
    let uvs: Vec<DVec2> = form
        .textures
        .chunks_exact(2)
        .map(|uv| DVec2::new(uv[0], uv[1]))
        .collect();
    let n = positions.len();
    for (what, found) in [
        ("normals", normals.len()),
        ("texture coordinates", uvs.len()),
    ] {
        if found != 0 && found != n {
            return Err(CurvedError::Points(format!(
                "it has {found} {what} for {n} corners"
            )));
        }
    }
    let is_finite = form
        .vertices
        .iter()
        .chain(&form.textures)
        .all(|x| x.is_finite());
    if !is_finite {
        return Err(CurvedError::NotFinite);
    }
    let indices: Vec<u32> = if form.indices.is_empty() {
        (0..n as u32).collect()
    } else {
        form.indices
            .iter()
            .map(|index| u32::try_from(*index).unwrap_or(u32::MAX))
            .collect()
    };
    if let Some(at) = indices.iter().position(|index| *index as usize >= n) {
        let message = format!(
            "its index {at} is {}, but it has {n} corners",
            form.indices[at]
        );
        return Err(CurvedError::Points(message));
    }
    Ok(TriangleMesh {
        positions,
        triangles: indices
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]])
            .collect(),
        normals,
        uvs,
    })
}
