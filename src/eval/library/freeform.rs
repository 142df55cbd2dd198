//! Curves, curved surfaces and meshes: what a model gives is kept as it is, and understood when it is drawn.

use std::sync::LazyLock;

use super::{Arguments, Context, lists, new_object};
use crate::eval::freeform::{CurveForm, Freeform, MeshForm, Points, SurfaceForm};
use crate::eval::object::Data;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::graph::FieldId;
use crate::library::ClassId;
use glam::DVec3;

fn made(cx: &Context<'_>, class: ClassId, form: Freeform) -> Result<Value, Trap> {
    let charge = cx
        .machine
        .charge(form.bytes())
        .map_err(|trap| trap.at(cx.span))?;
    Ok(new_object(class, Data::Freeform(Box::new(form), charge)))
}

fn null(cx: &Context<'_>, what: &'static str) -> Trap {
    Trap::null(what, cx.span)
}

/// The numbers of an array or a list.
fn numbers(cx: &Context<'_>, args: &[Value], index: usize) -> Result<Vec<f64>, Trap> {
    let elements = lists::elements(cx, args, index)?;
    Ok(elements.iter().filter_map(Value::as_double).collect())
}

/// What an argument describes.
fn form(cx: &Context<'_>, args: &[Value], index: usize) -> Result<Freeform, Trap> {
    match &*cx.object(args, index)?.lock() {
        Data::Freeform(form, _) => Ok((**form).clone()),
        _ => Err(null(cx, "use a curve or surface")),
    }
}

fn curve(cx: &Context<'_>, args: &[Value], index: usize) -> Result<CurveForm, Trap> {
    match form(cx, args, index)? {
        Freeform::Curve(curve) => Ok(curve),
        _ => Err(null(cx, "use a curve")),
    }
}

pub(super) fn make_points(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let (data, dimension) = (numbers(cx, args, 0)?, args.int(1));
    made(cx, class, Freeform::Points(Points { data, dimension }))
}

pub(super) fn make_circle(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let radius = if args.is_empty() { 1.0 } else { args.double(0) };
    made(cx, class, Freeform::Curve(CurveForm::Circle(radius)))
}

pub(super) fn make_polygon(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let sides = if args.is_empty() { 6 } else { args.int(0) };
    made(cx, class, Freeform::Curve(CurveForm::Polygon(sides)))
}

pub(super) fn make_through(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let data = numbers(cx, args, 0)?;
    let points = Points { data, dimension: 3 };
    made(cx, class, Freeform::Curve(CurveForm::Through(points)))
}

pub(super) fn make_spline(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let Freeform::Points(points) = form(cx, args, 0)? else {
        return Err(null(cx, "use a list of points"));
    };
    let spline = CurveForm::Spline {
        points,
        degree: args.int(1),
        is_periodic: args.at(2).as_boolean() == Some(true),
        is_bezier: args.at(3).as_boolean() == Some(true),
    };
    made(cx, class, Freeform::Curve(spline))
}

pub(super) fn make_grid(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let (data, dimension) = (numbers(cx, args, 0)?, args.int(1));
    let grid = SurfaceForm::Grid {
        points: Points { data, dimension },
        u_count: args.int(2),
        degrees: (args.len() > 3).then(|| [args.int(3), args.int(4)]),
    };
    made(cx, class, Freeform::Surface(grid))
}

pub(super) fn make_sweep(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let sweep = SurfaceForm::Sweep(curve(cx, args, 0)?, curve(cx, args, 1)?);
    made(cx, class, Freeform::Surface(sweep))
}

pub(super) fn make_skin(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let values = match &*cx.object(args, 0)?.lock() {
        Data::List(list) => list.values.clone(),
        _ => return Err(null(cx, "use a list of curves")),
    };
    let profiles: Result<Vec<_>, _> = (0..values.len()).map(|i| curve(cx, &values, i)).collect();
    made(cx, class, Freeform::Surface(SurfaceForm::Skin(profiles?)))
}

pub(super) fn make_revolution(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let profile = curve(cx, args, 0)?;
    made(
        cx,
        class,
        Freeform::Surface(SurfaceForm::Revolution(profile)),
    )
}

pub(super) fn make_mesh(cx: &mut Context<'_>, class: ClassId, _: &[Value]) -> Result<Value, Trap> {
    made(cx, class, Freeform::Mesh(MeshForm::default()))
}

/// Changes a mesh, and what it takes of the budget.
fn change(cx: &Context<'_>, args: &[Value], f: impl FnOnce(&mut MeshForm)) -> Result<Value, Trap> {
    if let Data::Freeform(form, charge) = &mut *cx.object(args, 0)?.lock() {
        if let Freeform::Mesh(mesh) = &mut **form {
            f(mesh);
        }
        *charge = cx
            .machine
            .charge(form.bytes())
            .map_err(|trap| trap.at(cx.span))?;
    }
    Ok(Value::Null)
}

pub(super) fn set_vertices(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let new = numbers(cx, args, 1)?;
    change(cx, args, |mesh| mesh.vertices = new)
}

pub(super) fn set_indices(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let new = numbers(cx, args, 1)?;
    change(cx, args, |mesh| {
        mesh.indices = new.into_iter().map(|x| x as i32).collect();
    })
}

pub(super) fn set_normals(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let new = numbers(cx, args, 1)?;
    change(cx, args, |mesh| mesh.normals = new)
}

pub(super) fn set_textures(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let new = numbers(cx, args, 1)?;
    change(cx, args, |mesh| mesh.textures = new)
}

/// `node.getSurfaceArea()`
pub(super) fn mesh_area(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    static POLYGONS: LazyLock<Option<FieldId>> = LazyLock::new(|| {
        let table = crate::turtle::types();
        table.field(table.find("MeshNode")?, "polygons")
    });
    let node = cx.node(args, 0)?;
    let graph = &cx.machine.graph;
    let ty = graph.types().find("MeshNode");
    let field = POLYGONS.filter(|_| ty.is_some_and(|ty| graph.is_a(node, ty)));
    let held = field.and_then(|field| graph.peek_object(node, field).ok().flatten());
    let area = held
        .and_then(Value::as_object)
        .map(|object| match &*object.lock() {
            Data::Freeform(form, _) => match &**form {
                Freeform::Mesh(mesh) => area_of(mesh),
                _ => 0.0,
            },
            _ => 0.0,
        });
    Ok(Value::Double(area.unwrap_or(0.0)))
}

/// Area of the triangles whose corners there are.
fn area_of(mesh: &MeshForm) -> f64 {
    let corners: Vec<DVec3> = mesh
        .vertices
        .chunks_exact(3)
        .map(DVec3::from_slice)
        .collect();
    let in_order = || (0..corners.len()).collect();
    let numbers: Vec<usize> = if mesh.indices.is_empty() {
        in_order()
    } else {
        let number = |i: &i32| usize::try_from(*i).unwrap_or(usize::MAX);
        mesh.indices.iter().map(number).collect()
    };
    let area = |triangle: &[usize]| {
        let [a, b, c] = [0, 1, 2].map(|i| corners.get(triangle[i]));
        let (a, b, c) = (a?, b?, c?);
        Some(0.5 * (*b - *a).cross(*c - *a).length())
    };
    numbers.chunks_exact(3).filter_map(area).sum()
}
