//! The turtle: built-in node types and what they do to a frame that walks through space.
//!
//! Metres, degrees, z up. The turtle walks along its local +z ("head"); local x is "left", local y is "up"; all turns
//! are right-handed about a local axis.

pub mod effect;
pub mod layers;
pub mod motion;
pub mod pose;
pub mod reading;
pub mod state;
pub mod table;
mod tropism;

use crate::graph::{NewField, TypeId, TypeTable};
use std::sync::LazyLock;

pub use effect::Effect;
pub use layers::Layers;
pub use motion::Action;
pub use pose::Poses;
pub use state::{Look, Registers, TurtleState};
pub use table::{BuiltinField, BuiltinType, FieldType, builtin_types};

/// A table that holds the built-in types; modules of a model are added to it.
pub fn types() -> TypeTable {
    static BUILT_IN: LazyLock<TypeTable> = LazyLock::new(built_in_types);
    BUILT_IN.clone()
}

fn built_in_types() -> TypeTable {
    let mut table = TypeTable::default();
    for ty in builtin_types() {
        let fields: Vec<NewField> = ty.fields.iter().map(new_field).collect();
        let id = table.add_builtin(ty.name, table.find(ty.parent), ty.is_abstract, &fields);
        let field = |name: &&str| table.field(id, name);
        let lists = ty
            .constructors
            .iter()
            .map(|list| list.iter().filter_map(field).collect());
        table.set_constructors(id, lists.collect());
    }
    table
}

fn new_field(field: &BuiltinField) -> NewField {
    NewField {
        name: field.name.into(),
        kind: field.ty.kind(),
        default: field.default,
        is_rare: field.is_rare,
    }
}

/// The row of the table for a built-in type; `None` for modules.
pub fn builtin(ty: TypeId) -> Option<&'static BuiltinType> {
    static ROWS: LazyLock<Vec<&'static BuiltinType>> = LazyLock::new(|| builtin_types().collect());
    ROWS.get(usize::from(ty.0)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_and_cylinders_are_shaded_nulls_and_lamps_are_not() {
        let table = types();
        let id = |name| table.find(name).unwrap_or_else(|| panic!("{name}"));
        assert!(table.is_a(id("Sphere"), id("ShadedNull")));
        assert!(table.is_a(id("Cylinder"), id("ShadedNull")));
        assert!(table.is_a(id("F"), id("Node")));
        assert!(!table.is_a(id("LightNode"), id("ShadedNull")));
        assert_eq!(builtin(id("Sphere")).map(|t| t.name), Some("Sphere"));
    }

    #[test]
    fn constructors_name_fields() {
        let table = types();
        for ty in builtin_types() {
            let id = table.find(ty.name).expect("in the table");
            for name in ty.constructors.iter().copied().flatten() {
                assert!(table.field(id, name).is_some(), "{} has no {name}", ty.name);
            }
        }
    }
}
