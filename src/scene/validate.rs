//! Refusing numbers that no scene can be made of.

use super::description::OrganId;
use super::error::{Problem, SceneError};
use super::plan::PlannedShape;
use crate::geometry::{Shape, TriangleMesh};
use crate::math::Bounds3;
use crate::math::tolerance::{MAX_COORDINATE, SINGULAR_DETERMINANT};
use glam::DAffine3;

/// Checks that a placement is finite and has an inverse.
pub(super) fn check_placement(map: &DAffine3, organ: OrganId) -> Result<(), SceneError> {
    let fail = |problem| Err(SceneError::Organ { organ, problem });
    if !map.is_finite() {
        return fail(Problem::NotFinite);
    }
    if map.translation.abs().max_element() > MAX_COORDINATE {
        return fail(Problem::TooLarge {
            limit: MAX_COORDINATE,
        });
    }
    // Columns of length 1, so that small scales are no less invertible than large ones.
    let mut columns = map.matrix3;
    for column in [
        &mut columns.x_axis,
        &mut columns.y_axis,
        &mut columns.z_axis,
    ] {
        let size = column.abs().max_element();
        if size == 0.0 || !(1.0 / size).is_finite() {
            return fail(Problem::Singular);
        }
        *column = (*column / size).normalize();
    }
    // NaN counts as singular, too.
    if columns.determinant().abs() > SINGULAR_DETERMINANT {
        Ok(())
    } else {
        fail(Problem::Singular)
    }
}

/// Checks the box of something placed in a group.
pub(super) fn check_bounds(bounds: &Bounds3, organ: OrganId) -> Result<(), SceneError> {
    let fail = |problem| Err(SceneError::Organ { organ, problem });
    if bounds.is_empty() {
        return Ok(());
    }
    if !bounds.min.is_finite() || !bounds.max.is_finite() {
        return fail(Problem::NotFinite);
    }
    if bounds.min.abs().max(bounds.max.abs()).max_element() > MAX_COORDINATE {
        return fail(Problem::TooLarge {
            limit: MAX_COORDINATE,
        });
    }
    Ok(())
}

/// Checks the numbers of a shape and its placement.
pub(super) fn check_shape(planned: &PlannedShape, n_materials: usize) -> Result<(), SceneError> {
    let fail = |problem| SceneError::Organ {
        organ: planned.organ,
        problem,
    };
    if planned.material.0 as usize >= n_materials {
        return Err(fail(Problem::NoMaterial(planned.material.0)));
    }
    check_placement(&planned.to_group, planned.organ)?;
    match planned.shape {
        Shape::Sphere { radius } | Shape::Disk { radius } => check_sizes(&[("radius", *radius)]),
        Shape::Frustum {
            length,
            base_radius,
            top_radius,
            ..
        } => check_sizes(&[
            ("length", *length),
            ("radius at the base", *base_radius),
            ("radius at the top", *top_radius),
        ]),
        Shape::Box {
            half_x,
            half_y,
            length,
        } => check_sizes(&[
            ("half width", *half_x),
            ("half height", *half_y),
            ("length", *length),
        ]),
        Shape::Parallelogram {
            corner,
            edge_u,
            edge_v,
        } => {
            let is_finite = corner.is_finite() && edge_u.is_finite() && edge_v.is_finite();
            if is_finite {
                Ok(())
            } else {
                Err(Problem::NotFinite)
            }
        }
        Shape::Plane => Ok(()),
        Shape::Mesh(mesh) => check_mesh(mesh),
    }
    .map_err(fail)
}

fn check_sizes(sizes: &[(&'static str, f64)]) -> Result<(), Problem> {
    for &(size, value) in sizes {
        if !value.is_finite() {
            return Err(Problem::NotFinite);
        }
        if value < 0.0 {
            return Err(Problem::Negative { size, value });
        }
    }
    Ok(())
}

fn check_mesh(mesh: &TriangleMesh) -> Result<(), Problem> {
    let corners = mesh.positions.len();
    for (what, found) in [
        ("normals", mesh.normals.len()),
        ("texture coordinates", mesh.uvs.len()),
    ] {
        if found != 0 && found != corners {
            return Err(Problem::MeshLists {
                what,
                found,
                corners,
            });
        }
    }
    let beyond = |triangle: &[u32; 3]| triangle.iter().any(|corner| *corner as usize >= corners);
    if let Some(index) = mesh.triangles.iter().position(beyond) {
        return Err(Problem::NoCorner(index));
    }
    let is_finite = mesh
        .positions
        .iter()
        .chain(&mesh.normals)
        .all(|vector| vector.is_finite())
        && mesh.uvs.iter().all(|uv| uv.is_finite());
    if is_finite {
        Ok(())
    } else {
        Err(Problem::NotFinite)
    }
}
