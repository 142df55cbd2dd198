//! Where nodes are and how they are drawn.

use glam::DVec3;

use super::{Context, new_object, shaders};
use crate::color::palette::ega;
use crate::eval::object::Data;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::graph::NodeId;
use crate::library::ClassId;
use crate::turtle::{TurtleState, reading};

/// The turtle with which the node at `index` is drawn.
fn state(
    cx: &mut Context<'_>,
    args: &[Value],
    index: usize,
) -> Result<(NodeId, TurtleState), Trap> {
    let node = cx.node(args, index)?;
    let machine = &mut *cx.machine;
    match machine.poses.at(&machine.graph, node) {
        Ok(state) => Ok((node, state)),
        Err(error) => Err(machine.graph_trap(&error, node, cx.span)),
    }
}

/// The turtle from which the children of the first argument start.
fn state_after(cx: &mut Context<'_>, args: &[Value]) -> Result<TurtleState, Trap> {
    let node = cx.node(args, 0)?;
    let machine = &mut *cx.machine;
    machine
        .poses
        .after(&machine.graph, node)
        .map_err(|error| machine.graph_trap(&error, node, cx.span))
}

fn point(position: DVec3) -> Value {
    new_object(ClassId::Point3d, Data::Tuple(position))
}

fn vector(direction: DVec3) -> Value {
    new_object(ClassId::Vector3d, Data::Tuple(direction))
}

pub(super) fn location(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(point(state(cx, args, 0)?.1.position()))
}

pub(super) fn end_location(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(point(state_after(cx, args)?.position()))
}

pub(super) fn transformation(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(super::matrices::of_place(state(cx, args, 0)?.1.transform))
}

pub(super) fn direction(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(vector(state(cx, args, 0)?.1.head()))
}

pub(super) fn end_direction(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(vector(state_after(cx, args)?.head()))
}

fn offset(cx: &mut Context<'_>, args: &[Value]) -> Result<DVec3, Trap> {
    Ok(state(cx, args, 0)?.1.position() - state(cx, args, 1)?.1.position())
}

pub(super) fn distance(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Double(offset(cx, args)?.length()))
}

pub(super) fn distance_squared(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Double(offset(cx, args)?.length_squared()))
}

pub(super) fn distance_of_points(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let place = |index| Ok::<_, Trap>(cx.object(args, index)?.tuple().unwrap_or_default());
    Ok(Value::Double(place(0)?.distance(place(1)?)))
}

/// Degrees by which the node itself turns its children.
pub(super) fn angle(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let before = state(cx, args, 0)?.1.head();
    let after = state_after(cx, args)?.head();
    Ok(Value::Double(
        libm::atan2(before.cross(after).length(), before.dot(after)).to_degrees(),
    ))
}

pub(super) fn radius(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (node, state) = state(cx, args, 0)?;
    let radius = reading::shoot_radius(&cx.machine.graph, node, &state);
    let radius = radius.or_else(|| {
        let graph = &cx.machine.graph;
        let field = graph.types().field(graph.type_of(node).ok()?, "radius")?;
        graph.get_f64(node, field).ok()
    });
    Ok(Value::Float(radius.unwrap_or(0.0) as f32))
}

pub(super) fn color_index(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (node, state) = state(cx, args, 0)?;
    Ok(Value::Int(
        reading::shoot_color(&cx.machine.graph, node, &state).unwrap_or(0),
    ))
}

/// The node's own shader, else that of the colour with which the turtle draws it, else half gray.
pub(super) fn shader(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (node, state) = state(cx, args, 0)?;
    let graph = &cx.machine.graph;
    let own = graph
        .type_of(node)
        .ok()
        .and_then(|ty| graph.types().field(ty, "shader"))
        .and_then(|field| graph.get_object(node, field).ok())
        .filter(|value| value.as_object().is_some());
    Ok(
        own.unwrap_or_else(|| match reading::shoot_color(graph, node, &state) {
            Some(index) => shaders::opaque(ega(index)),
            None => shaders::half_gray(),
        }),
    )
}

pub(super) fn order(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Int(
        i32::try_from(state(cx, args, 0)?.1.order).unwrap_or(i32::MAX),
    ))
}
