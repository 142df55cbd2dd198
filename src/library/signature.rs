//! What a row of a table says, and the macro that makes an enum and its table at once.

use std::collections::HashMap;
use std::hash::Hash;

use super::ValueType;

/// What calling a function or method does besides giving a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Nothing: equal arguments give equal values.
    Pure,
    /// Draws from the model's generator, or sets it.
    Random,
    /// Reads the graph beyond its arguments' own fields (positions, say).
    Graph,
    /// Changes the graph, the state of the model or the receiver, or reads the clock.
    Writes,
    /// Prints.
    Prints,
}

/// A function, constructor or method as its caller sees it.
#[derive(Clone, Copy, Debug)]
pub struct Signature {
    /// Class it belongs to: of a function the class in front of the dot (empty: none), of a method the receiver's class.
    pub owner: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Types of its parameters.
    pub params: &'static [ValueType],
    /// Names of its parameters, for people: nothing can be passed by name.
    pub names: &'static [&'static str],
    /// Type of its value.
    pub result: ValueType,
    /// What it does besides.
    pub effect: Effect,
    /// Units of parameters and value, empty where there are none.
    pub unit: &'static str,
    /// What it means, one sentence.
    pub doc: &'static str,
}

/// Ids by owner and name, in order of the table.
pub(super) struct Index<Id: 'static>(HashMap<&'static str, HashMap<&'static str, Vec<Id>>>);

impl<Id> Index<Id> {
    /// The ids of `owner.name`, none if there is no such row.
    pub(super) fn get(&self, owner: &str, name: &str) -> &[Id] {
        self.0
            .get(owner)
            .and_then(|names| names.get(name))
            .map_or(&[], Vec::as_slice)
    }
}

/// The index of a table.
pub(super) fn index<Id: Copy + Eq + Hash>(
    all: &[Id],
    signature: impl Fn(Id) -> &'static Signature,
) -> Index<Id> {
    let mut by_owner: HashMap<&'static str, HashMap<&'static str, Vec<Id>>> = HashMap::new();
    for &id in all {
        let row = signature(id);
        by_owner
            .entry(row.owner)
            .or_default()
            .entry(row.name)
            .or_default()
            .push(id);
    }
    Index(by_owner)
}

/// Declares an enum of overloads and their table: `Variant = owner.name(Type name, …) -> result, effect, unit, doc;`.
macro_rules! signatures {
    ($(#[$meta:meta])* $id:ident; $($variant:ident = $owner:literal . $name:literal ($($ty:ident $(($class:expr))? $param:ident),*) -> $result:expr, $effect:ident, $unit:literal, $doc:literal;)*) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[repr(u16)]
        pub enum $id { $(#[doc = $doc] $variant,)* }

        impl $id {
            /// All of them, in order.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// Its row of the table.
            pub fn signature(self) -> &'static Signature {
                &SIGNATURES[self as usize]
            }
        }

        static SIGNATURES: &[Signature] = &[$(Signature {
            owner: $owner, name: $name, params: &[$($ty $(($class))?),*], names: &[$(stringify!($param)),*],
            result: $result, effect: Effect::$effect, unit: $unit, doc: $doc,
        },)*];
    };
}
pub(super) use signatures;

#[cfg(test)]
mod tests {
    use super::Signature;
    use crate::library::{ClassId, ConstructorId, FunctionId, MethodId};
    use std::collections::HashSet;

    fn check_table(rows: impl Iterator<Item = &'static Signature>) {
        let mut seen = HashSet::new();
        for row in rows {
            let what = format!("{}.{}{:?}", row.owner, row.name, row.params);
            assert!(row.doc.ends_with('.') && row.doc.len() > 3, "{what}: doc");
            let different: HashSet<_> = row.names.iter().collect();
            assert_eq!(different.len(), row.params.len(), "{what}: names");
            assert!(seen.insert(what.clone()), "{what}: twice");
        }
        assert!(seen.len() > 10);
    }

    #[test]
    fn every_row_is_documented_and_unique() {
        check_table(FunctionId::ALL.iter().map(|f| f.signature()));
        check_table(ConstructorId::ALL.iter().map(|f| f.signature()));
        check_table(MethodId::ALL.iter().map(|f| f.signature()));
    }

    #[test]
    fn methods_and_constructors_belong_to_classes() {
        let known = |owner: &str| {
            ClassId::named(owner).is_some()
                || ["String", "Object", "Node", "Array"].contains(&owner)
        };
        for row in MethodId::ALL
            .iter()
            .map(|f| f.signature())
            .chain(ConstructorId::ALL.iter().map(|f| f.signature()))
        {
            assert!(known(row.owner), "{}.{}", row.owner, row.name);
        }
    }
}
