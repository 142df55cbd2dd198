//! Node types: names, inheritance, fields, and how the fields of a node are laid out in words.

use std::collections::HashMap;
use std::sync::Arc;

/// A node type: built-in or a module of the model. Index into [`TypeTable`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TypeId(pub u16);

/// A field of a node type; fields of a type include those of its parents, which come first and keep their numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FieldId(pub u16);

/// What a field holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are Java's own")]
pub enum FieldKind {
    Boolean,
    Byte,
    Short,
    Char,
    Int,
    Long,
    Float,
    Double,
    /// A string, an array, a node, a library object, or null.
    Object,
}

impl FieldKind {
    /// Number of 32-bit words a value of this kind takes.
    pub fn words(self) -> usize {
        match self {
            Self::Long | Self::Double => 2,
            Self::Boolean
            | Self::Byte
            | Self::Short
            | Self::Char
            | Self::Int
            | Self::Float
            | Self::Object => 1,
        }
    }

    /// The words of an integer (or boolean) in this kind.
    pub(crate) fn encode_i32(self, value: i32) -> [u32; 2] {
        match self {
            Self::Long | Self::Float | Self::Double => self.encode_i64(i64::from(value)),
            Self::Boolean => [u32::from(value != 0), 0],
            Self::Byte => [i32::from(value as i8) as u32, 0],
            Self::Short => [i32::from(value as i16) as u32, 0],
            Self::Char => [u32::from(value as u16), 0],
            Self::Int | Self::Object => [value as u32, 0],
        }
    }

    /// The words of a long integer in this kind.
    pub(crate) fn encode_i64(self, value: i64) -> [u32; 2] {
        let wide = |bits: u64| [bits as u32, (bits >> 32) as u32];
        match self {
            Self::Long => wide(value as u64),
            Self::Float => [(value as f32).to_bits(), 0],
            Self::Double => wide((value as f64).to_bits()),
            Self::Boolean | Self::Byte | Self::Short | Self::Char | Self::Int | Self::Object => {
                [value as u32, 0]
            }
        }
    }

    /// The words of `value` in this kind. Objects are null whatever the value.
    pub(crate) fn encode(self, value: f64) -> [u32; 2] {
        let wide = |bits: u64| [bits as u32, (bits >> 32) as u32];
        match self {
            Self::Boolean => [u32::from(value != 0.0), 0],
            Self::Byte | Self::Short | Self::Char | Self::Int => [value as i32 as u32, 0],
            Self::Long => wide(value as i64 as u64),
            Self::Float => [(value as f32).to_bits(), 0],
            Self::Double => wide(value.to_bits()),
            Self::Object => [0, 0],
        }
    }
}

/// Where a node keeps a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// In the node's own words, from this offset on.
    Words(u16),
    /// In the table of rarely used attributes.
    Side,
}

/// A field of a node type.
#[derive(Clone, Debug)]
pub struct Field {
    /// Its name in the language. Names with a dot cannot be written there; they belong to setters such as
    /// `setTransform(x, y, z)`.
    pub name: Arc<str>,
    /// What it holds.
    pub kind: FieldKind,
    /// What it holds in a node made without arguments (objects: null).
    pub default: f64,
    /// Where it is kept.
    pub storage: Storage,
}

/// What [`TypeTable::add`] needs to know of a field.
#[derive(Clone, Debug)]
pub struct NewField {
    /// Name in the language.
    pub name: Arc<str>,
    /// What it holds.
    pub kind: FieldKind,
    /// Its first value (objects: null).
    pub default: f64,
    /// Whether few nodes ever set it: it then costs memory only in those.
    pub is_rare: bool,
}

impl NewField {
    /// An ordinary field that begins as zero, false or null.
    pub fn new(name: &str, kind: FieldKind) -> Self {
        Self {
            name: name.into(),
            kind,
            default: 0.0,
            is_rare: false,
        }
    }
}

/// A node type.
#[derive(Clone, Debug)]
pub struct NodeType {
    /// Name in the language.
    pub name: Arc<str>,
    /// The type it extends.
    pub parent: Option<TypeId>,
    /// Whether no node can have exactly this type.
    pub is_abstract: bool,
    /// The nearest built-in type: itself, or the ancestor whose behaviour a module inherits.
    pub builtin: TypeId,
    /// All fields, inherited ones first.
    pub fields: Vec<Field>,
    /// The fields that constructors fill, one list per constructor, shorter ones first. What is printed of a node.
    pub constructors: Vec<Vec<FieldId>>,
    /// Ancestors from the topmost down to the type itself.
    lineage: Vec<TypeId>,
    /// The type itself and all that extend it, in table order.
    descendants: Vec<TypeId>,
    /// The words of a new node.
    template: Vec<u32>,
    /// Offsets of the words that are object references.
    object_words: Vec<u16>,
}

impl NodeType {
    /// The type itself and all that extend it, directly or not, in table order.
    pub fn descendants(&self) -> &[TypeId] {
        &self.descendants
    }

    /// The words of a new node.
    pub(crate) fn template(&self) -> &[u32] {
        &self.template
    }

    /// Offsets of the words that are object references.
    pub(crate) fn object_words(&self) -> &[u16] {
        &self.object_words
    }

    fn add_field(&mut self, field: &NewField) -> FieldId {
        let storage = if field.is_rare {
            Storage::Side
        } else {
            let offset = self.template.len() as u16;
            let n_words = field.kind.words();
            self.template
                .extend_from_slice(&field.kind.encode(field.default)[..n_words]);
            if field.kind == FieldKind::Object {
                self.object_words.push(offset);
            }
            Storage::Words(offset)
        };
        let (name, kind, default) = (field.name.clone(), field.kind, field.default);
        self.fields.push(Field {
            name,
            kind,
            default,
            storage,
        });
        FieldId((self.fields.len() - 1) as u16)
    }
}

/// All node types of a model: the built-in ones first (made by [`crate::turtle::types`]), then its modules.
#[derive(Clone, Debug, Default)]
pub struct TypeTable {
    types: Vec<NodeType>,
    by_name: HashMap<Arc<str>, TypeId>,
}

impl TypeTable {
    /// Adds a built-in type; its parent must be there already.
    pub fn add_builtin(
        &mut self,
        name: &str,
        parent: Option<TypeId>,
        is_abstract: bool,
        own_fields: &[NewField],
    ) -> TypeId {
        let id = TypeId(self.types.len() as u16);
        self.add(name, parent, is_abstract, id, own_fields)
    }

    /// Adds a module of the model; its parent must be there already, with all its fields.
    pub fn add_module(
        &mut self,
        name: &str,
        parent: TypeId,
        is_abstract: bool,
        own_fields: &[NewField],
    ) -> TypeId {
        let builtin = self[parent].builtin;
        self.add(name, Some(parent), is_abstract, builtin, own_fields)
    }

    /// Adds a class of the model. Its objects are no nodes: they stand in no graph, only its fields are described here.
    pub fn add_class(
        &mut self,
        name: &str,
        parent: Option<TypeId>,
        is_abstract: bool,
        own_fields: &[NewField],
    ) -> TypeId {
        let id = TypeId(self.types.len() as u16);
        self.add(name, parent, is_abstract, id, own_fields)
    }

    fn add(
        &mut self,
        name: &str,
        parent: Option<TypeId>,
        is_abstract: bool,
        builtin: TypeId,
        own_fields: &[NewField],
    ) -> TypeId {
        let id = TypeId(self.types.len() as u16);
        let name: Arc<str> = name.into();
        let mut new = match parent {
            Some(parent) => self[parent].clone(),
            None => NodeType {
                name: name.clone(),
                parent,
                is_abstract,
                builtin,
                fields: vec![],
                constructors: vec![],
                lineage: vec![],
                descendants: vec![],
                template: vec![],
                object_words: vec![],
            },
        };
        (new.name, new.parent, new.is_abstract, new.builtin) =
            (name.clone(), parent, is_abstract, builtin);
        new.descendants = vec![id];
        new.constructors = vec![];
        new.lineage.push(id);
        for field in own_fields {
            new.add_field(field);
        }
        for &ancestor in &new.lineage[..new.lineage.len() - 1] {
            self.types[usize::from(ancestor.0)].descendants.push(id);
        }
        self.types.push(new);
        self.by_name.insert(name, id);
        id
    }

    /// Adds a field to a type that nothing extends yet and of which there is no node yet.
    pub fn add_field(&mut self, ty: TypeId, field: &NewField) -> FieldId {
        let ty = &mut self.types[usize::from(ty.0)];
        debug_assert_eq!(
            ty.descendants.len(),
            1,
            "fields must be complete before a type is extended"
        );
        ty.add_field(field)
    }

    /// Sets which fields the constructors of a type fill, shorter lists first.
    pub fn set_constructors(&mut self, ty: TypeId, constructors: Vec<Vec<FieldId>>) {
        self.types[usize::from(ty.0)].constructors = constructors;
    }

    /// Number of types.
    pub fn len(&self) -> usize {
        self.types.len()
    }

    /// Whether there is no type at all.
    pub fn is_empty(&self) -> bool {
        self.types.is_empty()
    }

    /// All types with their numbers.
    pub fn iter(&self) -> impl Iterator<Item = (TypeId, &NodeType)> {
        self.types
            .iter()
            .enumerate()
            .map(|(i, t)| (TypeId(i as u16), t))
    }

    /// The type of this name; of several of one name the one added last.
    pub fn find(&self, name: &str) -> Option<TypeId> {
        self.by_name.get(name).copied()
    }

    /// The field of this name; a type's own field hides an inherited one.
    pub fn field(&self, ty: TypeId, name: &str) -> Option<FieldId> {
        let fields = &self[ty].fields;
        fields
            .iter()
            .rposition(|f| &*f.name == name)
            .map(|i| FieldId(i as u16))
    }

    /// Whether `a` is `b` or extends it.
    pub fn is_a(&self, a: TypeId, b: TypeId) -> bool {
        let depth = self[b].lineage.len() - 1;
        self[a].lineage.get(depth) == Some(&b)
    }
}

impl std::ops::Index<TypeId> for TypeTable {
    type Output = NodeType;

    fn index(&self, id: TypeId) -> &NodeType {
        &self.types[usize::from(id.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> (TypeTable, TypeId, TypeId, TypeId) {
        let mut table = TypeTable::default();
        let node = table.add_builtin("Node", None, false, &[]);
        let length = NewField {
            default: 1.5,
            ..NewField::new("length", FieldKind::Float)
        };
        let label = NewField {
            is_rare: true,
            ..NewField::new("label", FieldKind::Object)
        };
        let base = table.add_builtin("Base", Some(node), true, &[length, label]);
        let own = [
            NewField::new("mass", FieldKind::Double),
            NewField::new("who", FieldKind::Object),
        ];
        let leaf = table.add_module("Leaf", base, false, &own);
        (table, node, base, leaf)
    }

    #[test]
    fn fields_are_inherited_with_their_numbers() {
        let (table, _, base, leaf) = table();
        assert_eq!(table.field(base, "length"), table.field(leaf, "length"));
        assert_eq!(table.field(leaf, "mass"), Some(FieldId(2)));
        assert_eq!(table.field(base, "mass"), None);
        assert_eq!(table[leaf].builtin, base);
    }

    #[test]
    fn layout_puts_rare_fields_aside() {
        let (table, _, _, leaf) = table();
        assert_eq!(table[leaf].fields[1].storage, Storage::Side);
        assert_eq!(table[leaf].template(), [1.5f32.to_bits(), 0, 0, 0]);
        assert_eq!(table[leaf].object_words(), [3]);
    }

    #[test]
    fn inheritance_is_known_both_ways() {
        let (table, node, base, leaf) = table();
        assert!(table.is_a(leaf, node) && table.is_a(leaf, leaf) && !table.is_a(base, leaf));
        assert_eq!(table[node].descendants(), [node, base, leaf]);
        assert_eq!(table.find("Leaf"), Some(leaf));
    }
}
