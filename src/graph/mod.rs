//! The growth graph: typed nodes with parameters, directed edges, and extents (all nodes of a type, in order of birth).

pub mod pattern;

/// A node type: built-in or a module of the model. Index into [`TypeTable`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TypeId(pub u16);

/// A field of a node type; fields of a type include those of its parents, which come first and keep their numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FieldId(pub u16);

/// All node types of a model.
#[derive(Debug, Default)]
pub struct TypeTable;
