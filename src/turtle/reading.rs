//! From a node of the graph to what it does: reads the numbers its type's [`Effect`] needs.

use super::effect::{Change, Effect, StepLength, Target};
use super::motion::Action;
use super::state::{Look, TurtleState};
use super::{builtin_types, types};
use crate::graph::{FieldId, Graph, NodeId, Payload, TypeTable};
use glam::{DAffine3, DVec3};
use std::sync::LazyLock;

/// A built-in type's effect and the fields it reads, found once. Modules inherit them with their numbers.
struct Reader {
    effect: Effect,
    /// The fields of [`fields_of`], in that order.
    fields: [FieldId; 4],
    /// `transform`, and the parts of a translation, for types that have them.
    transform: Option<[FieldId; 4]>,
    /// `length`, `startPosition` and `endPosition` of the primitives along the head.
    axis: Option<[FieldId; 3]>,
    /// `shiftPivot` and `width` of a box.
    pivot: Option<[FieldId; 2]>,
    /// A shoot's own `diameter` and `color`.
    shoot: Option<[FieldId; 2]>,
    /// `shader` of what has a surface.
    shader: Option<FieldId>,
    /// `transforming` of what has a transformation.
    transforming: Option<FieldId>,
}

static READERS: LazyLock<Vec<Reader>> = LazyLock::new(|| {
    let table = types();
    builtin_types()
        .map(|row| reader(&table, row.name, row.effect))
        .collect()
});

fn reader(table: &TypeTable, type_name: &str, effect: Effect) -> Reader {
    let field = |name: &str| table.field(table.find(type_name)?, name);
    let mut fields = [FieldId(0); 4];
    for (slot, name) in fields.iter_mut().zip(fields_of(effect)) {
        *slot = field(name).expect("invariant: the table gives each effect its fields");
    }
    fn all<const N: usize>(
        field: impl Fn(&str) -> Option<FieldId>,
        names: [&str; N],
    ) -> Option<[FieldId; N]> {
        let found: Option<Vec<FieldId>> = names.iter().map(|name| field(name)).collect();
        found?.try_into().ok()
    }
    Reader {
        effect,
        fields,
        transform: all(
            field,
            ["transform", "transform.x", "transform.y", "transform.z"],
        ),
        axis: all(field, ["length", "startPosition", "endPosition"]),
        pivot: all(field, ["shiftPivot", "width"]),
        shoot: field("diameter").zip(field("color")).map(|(d, c)| [d, c]),
        shader: field("shader"),
        transforming: field("transforming"),
    }
}

/// The names of the fields an effect reads.
fn fields_of(effect: Effect) -> &'static [&'static str] {
    match effect {
        Effect::Step {
            length: StepLength::Own,
            ..
        } => &["length"],
        Effect::Step {
            length: StepLength::Plus | StepLength::Times | StepLength::Relative,
            ..
        } => &["argument"],
        Effect::Turn(..) | Effect::SetInclination => &["angle"],
        Effect::Gravitropism => &["strength"],
        Effect::Tropism(Target::Direction | Target::Plane) => &["direction", "strength"],
        Effect::Tropism(Target::Point) => &["target", "strength"],
        Effect::Tropism(Target::Node) => &["targetNode", "strength"],
        Effect::Assign(_, Change::Set | Change::Add | Change::Mul, _) => &["argument"],
        Effect::Translate => &["translateX", "translateY", "translateZ"],
        Effect::Rotate => &["rotateX", "rotateY", "rotateZ"],
        Effect::Scale => &["scaleX", "scaleY", "scaleZ", "scale"],
        Effect::Step {
            length: StepLength::Register,
            ..
        }
        | Effect::Assign(_, Change::Reset, _)
        | Effect::None
        | Effect::AdjustUp
        | Effect::HeadDown
        | Effect::RegisterGravitropism
        | Effect::Group
        | Effect::Draw(_)
        | Effect::Instance
        | Effect::Grid => &[],
    }
}

fn reader_of<O: Payload>(graph: &Graph<O>, node: NodeId) -> Option<&'static Reader> {
    let ty = graph.type_of(node).ok()?;
    READERS.get(usize::from(graph.types()[ty].builtin.0))
}

/// What a node does to the turtle and to the picture; nothing for a deleted node.
pub fn effect<O: Payload>(graph: &Graph<O>, node: NodeId) -> Effect {
    reader_of(graph, node).map_or(Effect::None, |reader| reader.effect)
}

/// The transformation a node applies before it is drawn (`setTransform`, `Null(x, y, z)`, `setStartPosition`), where it
/// has one.
pub fn own_transform<O: Payload>(graph: &Graph<O>, node: NodeId) -> Option<DAffine3> {
    let reader = reader_of(graph, node)?;
    let [whole, x, y, z] = reader.transform?;
    let shift = axis_shift(graph, node, reader);
    if shift == 0.0 && ![whole, x, y, z].iter().any(|f| graph.has_side(node, *f)) {
        return None;
    }
    let part = |field| graph.get_f64(node, field).unwrap_or(0.0);
    let offset = DAffine3::from_translation(DVec3::new(part(x), part(y), part(z)));
    let along = DAffine3::from_translation(DVec3::Z * f64::from(shift));
    let whole = graph.peek_object(node, whole).ok().flatten();
    Some(match whole.and_then(Payload::as_transform) {
        Some(whole) => offset * whole * along,
        None => offset * along,
    })
}

/// Whether what follows a node inherits its frame; if not (`setTransforming(false)`), it begins where the node began.
pub fn is_transforming<O: Payload>(graph: &Graph<O>, node: NodeId) -> bool {
    let field = reader_of(graph, node).and_then(|reader| reader.transforming);
    field.is_none_or(|field| graph.get_bool(node, field).unwrap_or(true))
}

/// Lets the turtle look as a node makes it look: by its shader, or by a shoot's colour. Whether the node has a say in it.
pub fn dress<O: Payload>(graph: &Graph<O>, node: NodeId, state: &mut TurtleState) -> bool {
    let Some(reader) = reader_of(graph, node) else {
        return false;
    };
    let shader = reader.shader.filter(|field| graph.has_side(node, *field));
    let shader = shader.and_then(|field| graph.peek_object(node, field).ok().flatten());
    let look = if shader.is_some() {
        Some(Look::Of(node))
    } else {
        shoot_color(graph, node, state).map(Look::Ega)
    };
    state.look = look.unwrap_or(state.look);
    look.is_some()
}

/// How far along its head a primitive is drawn from where the turtle stands (`setStartPosition`, `setShiftPivot`).
fn axis_shift<O: Payload>(graph: &Graph<O>, node: NodeId, reader: &Reader) -> f32 {
    let Some([length, start, _]) = reader.axis else {
        return 0.0;
    };
    let single = |field| graph.get_f32(node, field).unwrap_or(0.0);
    let start = if graph.has_side(node, start) {
        single(start) * single(length)
    } else {
        0.0
    };
    start - pivot_shift(graph, node, reader)
}

/// How far `setShiftPivot` moves a box back: half its width, whatever its length, as in GroIMP.
fn pivot_shift<O: Payload>(graph: &Graph<O>, node: NodeId, reader: &Reader) -> f32 {
    match reader.pivot {
        Some([is_shifted, width]) if graph.get_bool(node, is_shifted).unwrap_or(false) => {
            0.5 * graph.get_f32(node, width).unwrap_or(0.0)
        }
        _ => 0.0,
    }
}

/// How far the turtle walks from where a primitive is drawn: to `endPosition` of its length.
fn axis_walk<O: Payload>(graph: &Graph<O>, node: NodeId, reader: &Reader) -> f32 {
    let Some([length, start, end]) = reader.axis else {
        return 0.0;
    };
    let single = |field| graph.get_f32(node, field).unwrap_or(0.0);
    let share = single(end) - single(start);
    share * single(length) + pivot_shift(graph, node, reader)
}

/// What a node does to the turtle on the way to its children. `locate` tells where another node is, for `RN`.
pub fn action<O: Payload>(
    graph: &Graph<O>,
    node: NodeId,
    locate: &mut dyn FnMut(NodeId) -> Option<DVec3>,
) -> Action {
    let Some(reader) = reader_of(graph, node) else {
        return Action::None;
    };
    let number = |i: usize| graph.get_f64(node, reader.fields[i]).unwrap_or(0.0);
    let single = |i: usize| graph.get_f32(node, reader.fields[i]).unwrap_or(0.0);
    let triple = || DVec3::new(number(0), number(1), number(2));
    let object = || graph.peek_object(node, reader.fields[0]).ok().flatten();
    let vector = || object().and_then(Payload::as_vector);
    match reader.effect {
        Effect::None | Effect::Group | Effect::Instance | Effect::Grid => Action::None,
        Effect::Step { length, is_shoot } => Action::Step {
            length,
            own: if length == StepLength::Register {
                0.0
            } else {
                single(0)
            },
            is_shoot,
        },
        Effect::Turn(axis, sign) => Action::Turn(axis, f64::from(sign) * number(0)),
        Effect::SetInclination => Action::SetInclination(number(0)),
        Effect::AdjustUp => Action::AdjustUp,
        Effect::HeadDown => Action::HeadDown,
        Effect::Gravitropism => Action::Gravitropism(number(0)),
        Effect::RegisterGravitropism => Action::RegisterGravitropism,
        Effect::Tropism(target) => {
            let (bend, place): (fn(DVec3, f64) -> Action, _) = match target {
                Target::Direction => (Action::BendTowards, vector()),
                Target::Plane => (Action::BendAcross, vector()),
                Target::Point => (Action::BendToPoint, vector()),
                Target::Node => {
                    let other = object().and_then(Payload::as_node);
                    (Action::BendToPoint, other.and_then(locate))
                }
            };
            place.map_or(Action::None, |place| bend(place, number(1)))
        }
        Effect::Assign(register, change, scope) => {
            let x = if change == Change::Reset {
                0.0
            } else {
                single(0)
            };
            Action::Assign(register, change, scope, x)
        }
        Effect::Translate => Action::Translate(triple()),
        Effect::Rotate => Action::Rotate(triple()),
        Effect::Scale => Action::Scale(triple() * number(3)),
        Effect::Draw(primitive) if primitive.moves() => {
            Action::Walk(f64::from(axis_walk(graph, node, reader)))
        }
        Effect::Draw(_) => Action::None,
    }
}

/// Radius in metres of a shoot that the turtle draws in this state; `None` if the node is no shoot.
pub fn shoot_radius<O: Payload>(
    graph: &Graph<O>,
    node: NodeId,
    state: &TurtleState,
) -> Option<f64> {
    let reader = shoot_reader(graph, node)?;
    let own = reader
        .shoot
        .and_then(|[diameter, _]| graph.get_f32(node, diameter).ok());
    Some(state.shoot_radius(own.unwrap_or(-1.0)))
}

/// EGA colour index of a shoot that the turtle draws in this state; `None` if the node is no shoot.
pub fn shoot_color<O: Payload>(graph: &Graph<O>, node: NodeId, state: &TurtleState) -> Option<i32> {
    let reader = shoot_reader(graph, node)?;
    let own = reader
        .shoot
        .and_then(|[_, color]| graph.get_i32(node, color).ok());
    Some(state.shoot_color(own.unwrap_or(-1)))
}

fn shoot_reader<O: Payload>(graph: &Graph<O>, node: NodeId) -> Option<&'static Reader> {
    reader_of(graph, node)
        .filter(|reader| matches!(reader.effect, Effect::Step { is_shoot: true, .. }))
}
