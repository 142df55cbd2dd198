//! What values tell of themselves: classes, functions; and where nodes stand in the graph.

use super::{Arguments, Context, new_object};
use crate::eval::object::{Data, qualified};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::graph::{EdgeBits, GraphError, NodeId};
use crate::library::ClassId;

/// `function.evaluate…(argument)`, and what calls a function for each element.
pub(super) fn evaluate(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (method, mut all) = match &*cx.object(args, 0)?.lock() {
        Data::Function(method, captured) => (*method, captured.clone()),
        _ => return Err(Trap::null("call a function", cx.span)),
    };
    all.extend(args.get(1).cloned());
    let this = all.first().cloned().unwrap_or_default();
    let rest = if cx.program.has_this(method) {
        &all[1..]
    } else {
        &all[..]
    };
    cx.program
        .call_method(cx.machine, method, &this, rest, cx.span)
}

/// The simple name of the class of a value.
fn class_name(cx: &Context<'_>, value: &Value) -> String {
    if let Some(ty) = value.type_in(&cx.machine.graph) {
        return cx.program.types()[ty].name.to_string();
    }
    match value {
        Value::Text(_) => "String".into(),
        Value::Array(array) => array.type_name().into(),
        other => other.class().map_or("Object", ClassId::name).into(),
    }
}

/// `object.getClass()`: a value that names the class, equal for equal classes.
pub(super) fn class_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    if args.at(0).is_null() {
        return Err(Trap::null("call `getClass` of an object", cx.span));
    }
    let name = class_name(cx, args.at(0));
    Ok(new_object(ClassId::Class, Data::Pattern(name.into())))
}

fn name(cx: &Context<'_>, args: &[Value]) -> Result<String, Trap> {
    Ok(match &*cx.object(args, 0)?.lock() {
        Data::Pattern(name) => name.to_string(),
        _ => String::new(),
    })
}

pub(super) fn simple_name(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    cx.new_text(name(cx, args)?)
}

/// `class.getName()`: classes of Java with their package.
pub(super) fn full_name(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let name = name(cx, args)?;
    let of_library = ClassId::named(&name).filter(|class| class.is_a(ClassId::Throwable));
    let boxed = [
        "String",
        "Integer",
        "Long",
        "Float",
        "Double",
        "Boolean",
        "Character",
    ];
    cx.new_text(match of_library {
        Some(class) => qualified(class),
        None if boxed.contains(&name.as_str()) => format!("java.lang.{name}"),
        None => name,
    })
}

/// `node.getId()`
pub(super) fn id(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Long(cx.node(args, 0)?.index() as i64))
}

fn value(node: Option<NodeId>) -> Value {
    node.map_or(Value::Null, Value::Node)
}

/// The receiver, if it is still there.
fn known(cx: &Context<'_>, args: &[Value]) -> Result<NodeId, Trap> {
    let node = cx.node(args, 0)?;
    if cx.machine.graph.exists(node) {
        return Ok(node);
    }
    Err(cx
        .machine
        .graph_trap(&GraphError::DeletedNode, node, cx.span))
}

/// The first node behind an edge of one of these kinds.
fn first_behind(cx: &Context<'_>, args: &[Value], wanted: EdgeBits) -> Result<Value, Trap> {
    let node = known(cx, args)?;
    let mut edges = cx.machine.graph.out_edges(node);
    Ok(value(
        edges
            .find(|(_, bits)| bits.intersects(wanted))
            .map(|(to, _)| to),
    ))
}

/// The first node before an edge of one of these kinds.
fn first_before(cx: &Context<'_>, node: NodeId, wanted: EdgeBits) -> Option<NodeId> {
    let mut edges = cx.machine.graph.in_edges(node);
    edges
        .find(|(_, bits)| bits.intersects(wanted))
        .map(|(from, _)| from)
}

pub(super) fn successor(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    first_behind(cx, args, EdgeBits::SUCCESSOR)
}

pub(super) fn branch(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    first_behind(cx, args, EdgeBits::BRANCH)
}

pub(super) fn predecessor(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let node = known(cx, args)?;
    Ok(value(first_before(cx, node, EdgeBits::SUCCESSOR)))
}

pub(super) fn axis_parent(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let node = known(cx, args)?;
    let bits = EdgeBits::SUCCESSOR.union(EdgeBits::BRANCH);
    Ok(value(first_before(cx, node, bits)))
}

pub(super) fn n_children(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let node = known(cx, args)?;
    let n = cx.machine.graph.out_edges(node).count();
    Ok(Value::Int(i32::try_from(n).unwrap_or(i32::MAX)))
}

/// `a.isAncestorOf(b)`
pub(super) fn is_ancestor(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (ancestor, mut at) = (known(cx, args)?, cx.node(args, 1)?);
    let bits = EdgeBits::SUCCESSOR.union(EdgeBits::BRANCH);
    // In a graph with a circle the way up has no end; no way is longer than there are nodes.
    for _ in 0..=cx.machine.graph.n_nodes() {
        match first_before(cx, at, bits) {
            Some(above) if above == ancestor => return Ok(Value::Boolean(true)),
            Some(above) => at = above,
            None => break,
        }
        cx.machine.tick(cx.span)?;
    }
    Ok(Value::Boolean(false))
}

/// `Objects.equals(a, b)`
pub(super) fn equal(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(cx.equal(args.at(0), args.at(1))?))
}
