//! What a rule or a query looks for: nodes, the edges between them, and conditions.

use super::{FieldId, TypeId};
use crate::diag::Span;

/// A pattern; `E` is an expression (checked tree in `check`, compiled code in `eval`).
#[derive(Clone, Debug)]
pub struct Pattern<E> {
    /// The nodes, in textual order.
    pub nodes: Vec<PatternNode<E>>,
    /// Edges between them.
    pub edges: Vec<PatternEdge>,
    /// Conditions, in textual order.
    pub conditions: Vec<Condition<E>>,
    /// Parts that are searched apart from the rest, in textual order.
    pub choices: Vec<Choice>,
    /// What [`EdgeKind::Walk`] stands for.
    pub walks: Vec<Vec<WalkStep>>,
    /// What [`EdgeKind::Relation`] stands for: gives the node that is related to the left one, which stands in its slot.
    pub relations: Vec<E>,
    /// Leftmost node that is not context (`in` of the embedding), if any.
    pub first: Option<usize>,
    /// Rightmost node that is not context and in no branch (`out` of the embedding), if any.
    pub last: Option<usize>,
    /// The whole pattern.
    pub span: Span,
}

/// One node of a pattern.
#[derive(Clone, Debug)]
pub struct PatternNode<E> {
    /// What it may be.
    pub what: Candidate<E>,
    /// Local slot that receives the node.
    pub slot: Option<u16>,
    /// Positional parameters.
    pub args: Vec<PatternArg<E>>,
    /// Whether it stands in `(* … *)`: matched but never consumed.
    pub is_context: bool,
    /// The part searched apart that it belongs to, by index.
    pub choice: Option<usize>,
    /// Its place.
    pub span: Span,
}

/// What a pattern node may be.
#[derive(Clone, Debug)]
pub enum Candidate<E> {
    /// Any node.
    Any,
    /// A node of this type or of one that extends it.
    Type(TypeId),
    /// The root, `^`.
    Root,
    /// The very node that this expression gives when the search begins (`this`, a variable).
    Value(E),
    /// The same node as an earlier pattern node (a label used again).
    Same(usize),
}

/// A positional parameter of a pattern node.
#[derive(Clone, Debug)]
pub enum PatternArg<E> {
    /// Stores the field in a local slot.
    Bind(FieldId, u16),
    /// The field must equal the value (compared in the field's own type).
    Equal(FieldId, E),
}

/// An edge that must be there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PatternEdge {
    /// Index of the pattern node it starts from (as written, left).
    pub from: usize,
    /// Index of the pattern node it leads to (as written, right).
    pub to: usize,
    /// What edge.
    pub kind: EdgeKind,
    /// Which way.
    pub way: EdgeWay,
    /// Closure: least and greatest number of edges; (1, Some(1)) for a plain edge. Of a walk only whether its least
    /// number is 0.
    pub repeat: (u32, Option<u32>),
    /// Whether it is walked no further than to nodes from which the rest of the pattern was found: `(-->)+ :(A)`.
    pub is_minimal: bool,
    /// The part searched apart that it belongs to, by index.
    pub choice: Option<usize>,
}

/// How a part of a pattern is searched that is set apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// `(: … )`: only its first match counts.
    First,
    /// `(& … )`: after all that is not set apart.
    Late,
    /// `(? … )`: without a match its labels are null.
    Optional,
}

/// A part of a way that is more than one closure of one edge.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WalkStep {
    /// One edge.
    Edge(EdgeKind, EdgeWay),
    /// A node of this type on the way.
    Type(TypeId),
    /// All of this, between so many and so many times.
    Repeat(Vec<WalkStep>, u32, Option<u32>),
}

/// Kinds of edges that can be asked for or made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeKind {
    /// Any kind (patterns only).
    Any,
    /// Successor, `>`.
    Successor,
    /// Branch, `+>`.
    Branch,
    /// Refinement, `/>`.
    Refinement,
    /// `-ancestor->`: the nearest nodes of the target's type against the edges.
    Ancestor,
    /// `-minDescendants->`: the nearest nodes of the target's type along the edges.
    MinDescendants,
    /// `-descendants->`: all nodes of the target's type along the edges.
    Descendants,
    /// A user's own edge bit (0..=20).
    User(u8),
    /// A way of several edges, by index into the pattern's walks (patterns only).
    Walk(u16),
    /// To the node that a method gives, by index into the pattern's relations (patterns only).
    Relation(u16),
}

/// Which way an edge runs, seen from the left node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeWay {
    /// Left to right.
    Forward,
    /// Right to left.
    Backward,
    /// One each way.
    Both,
    /// Either way.
    Undirected,
}

/// A condition of a pattern.
#[derive(Clone, Debug)]
pub struct Condition<E> {
    /// A boolean expression.
    pub expr: E,
    /// The pattern nodes (by index) whose label or parameters it uses; with none it is evaluated once per search, not per
    /// match.
    pub needs: Vec<usize>,
    /// The part searched apart that it belongs to, by index.
    pub choice: Option<usize>,
}
