//! Reading and writing the fields of a node.
//!
//! Numbers are kept in the field's own kind. The accessors convert between kinds as Rust's `as` does; the language makes
//! its own conversions before it comes here.

use super::store::{Graph, GraphError, HAS_SIDE, SideValue};
use super::{FieldId, FieldKind, NodeId, Payload, Storage, TypeId};

impl<O: Payload> Graph<O> {
    /// An integer field (boolean: 0 or 1).
    pub fn get_i32(&self, node: NodeId, field: FieldId) -> Result<i32, GraphError> {
        let (kind, words) = self.words_of(node, field)?;
        Ok(match kind {
            FieldKind::Float => f32::from_bits(words[0]) as i32,
            FieldKind::Double => f64::from_bits(wide(words)) as i32,
            FieldKind::Boolean
            | FieldKind::Byte
            | FieldKind::Short
            | FieldKind::Char
            | FieldKind::Int
            | FieldKind::Long
            | FieldKind::Object => words[0] as i32,
        })
    }

    /// A `long` field.
    pub fn get_i64(&self, node: NodeId, field: FieldId) -> Result<i64, GraphError> {
        let (kind, words) = self.words_of(node, field)?;
        Ok(match kind {
            FieldKind::Long => wide(words) as i64,
            FieldKind::Float => f32::from_bits(words[0]) as i64,
            FieldKind::Double => f64::from_bits(wide(words)) as i64,
            FieldKind::Boolean
            | FieldKind::Byte
            | FieldKind::Short
            | FieldKind::Char
            | FieldKind::Int
            | FieldKind::Object => i64::from(words[0] as i32),
        })
    }

    /// A `float` field.
    pub fn get_f32(&self, node: NodeId, field: FieldId) -> Result<f32, GraphError> {
        Ok(self.get_f64(node, field)? as f32)
    }

    /// A `double` field, or any other number widened.
    pub fn get_f64(&self, node: NodeId, field: FieldId) -> Result<f64, GraphError> {
        let (kind, words) = self.words_of(node, field)?;
        Ok(match kind {
            FieldKind::Float => f64::from(f32::from_bits(words[0])),
            FieldKind::Double => f64::from_bits(wide(words)),
            FieldKind::Long => wide(words) as i64 as f64,
            FieldKind::Boolean
            | FieldKind::Byte
            | FieldKind::Short
            | FieldKind::Char
            | FieldKind::Int
            | FieldKind::Object => f64::from(words[0] as i32),
        })
    }

    /// A `boolean` field.
    pub fn get_bool(&self, node: NodeId, field: FieldId) -> Result<bool, GraphError> {
        Ok(self.get_i32(node, field)? != 0)
    }

    /// An object field; null for other fields.
    pub fn get_object(&self, node: NodeId, field: FieldId) -> Result<O, GraphError> {
        Ok(self.peek_object(node, field)?.cloned().unwrap_or_default())
    }

    /// An object field without copying it; `None` if it is null.
    pub fn peek_object(&self, node: NodeId, field: FieldId) -> Result<Option<&O>, GraphError> {
        let index = self.live_index(node)?;
        let declared = self.field_of(index, field);
        if declared.kind != FieldKind::Object {
            return Ok(None);
        }
        Ok(match declared.storage {
            Storage::Words(offset) => self
                .objects
                .peek(self.words.get(self.word_place(index, offset))),
            Storage::Side => match self.side.get(&(index as u32, field.0)) {
                Some(SideValue::Object(object)) => Some(object),
                Some(SideValue::Words(_)) | None => None,
            },
        })
    }

    /// Whether a rare field was ever set in this node.
    pub fn has_side(&self, node: NodeId, field: FieldId) -> bool {
        self.live_index(node).is_ok_and(|index| {
            self.nodes[index].flags & HAS_SIDE != 0
                && self.side.contains_key(&(index as u32, field.0))
        })
    }

    /// Calls `visit` with the words of a field of every node of type `ty`, in the order of [`Graph::extent`]; one word of
    /// them counts, or both for kinds of two words. `false`, and no call, for rare fields.
    pub fn scan(&self, ty: TypeId, field: FieldId, mut visit: impl FnMut([u32; 2])) -> bool {
        let Some(declared) = self.types[ty].fields.get(usize::from(field.0)) else {
            return false;
        };
        // Fields keep their places in types that extend others.
        let Storage::Words(offset) = declared.storage else {
            return false;
        };
        let is_wide = declared.kind.words() == 2;
        for &ty in self.types[ty].descendants() {
            for index in self.extents.exactly(ty) {
                let place = self.word_place(index, offset);
                let high = if is_wide {
                    self.words.get(place + 1)
                } else {
                    0
                };
                visit([self.words.get(place), high]);
            }
        }
        true
    }

    /// A new node of the same type with the same values. Queries do not find it, and nothing is linked to it.
    ///
    /// # Errors
    /// The node is gone, or there is no room for another.
    pub fn twin(&mut self, node: NodeId) -> Result<NodeId, GraphError> {
        let ty = self.type_of(node)?;
        let copy = self.create(ty)?;
        for number in 0..self.types[ty].fields.len() {
            let field = &self.types[ty].fields[number];
            let (kind, is_aside) = (field.kind, matches!(field.storage, Storage::Side));
            let field = FieldId(number as u16);
            if is_aside && !self.has_side(node, field) {
                continue;
            }
            match kind {
                FieldKind::Object => {
                    let value = self.get_object(node, field)?;
                    self.set_object(copy, field, value)?;
                }
                FieldKind::Float | FieldKind::Double => {
                    let value = self.get_f64(node, field)?;
                    self.set_f64(copy, field, value)?;
                }
                FieldKind::Boolean
                | FieldKind::Byte
                | FieldKind::Short
                | FieldKind::Char
                | FieldKind::Int
                | FieldKind::Long => {
                    let value = self.get_i64(node, field)?;
                    self.set_i64(copy, field, value)?;
                }
            }
        }
        Ok(copy)
    }

    /// Sets an integer field.
    pub fn set_i32(&mut self, node: NodeId, field: FieldId, value: i32) -> Result<(), GraphError> {
        self.set_number(node, field, |kind| kind.encode_i32(value))
    }

    /// Sets a `long` field.
    pub fn set_i64(&mut self, node: NodeId, field: FieldId, value: i64) -> Result<(), GraphError> {
        self.set_number(node, field, |kind| kind.encode_i64(value))
    }

    /// Sets a `float` field.
    pub fn set_f32(&mut self, node: NodeId, field: FieldId, value: f32) -> Result<(), GraphError> {
        self.set_f64(node, field, f64::from(value))
    }

    /// Sets a `double` field, or a narrower one.
    pub fn set_f64(&mut self, node: NodeId, field: FieldId, value: f64) -> Result<(), GraphError> {
        self.set_number(node, field, |kind| kind.encode(value))
    }

    /// Sets a `boolean` field.
    pub fn set_bool(&mut self, node: NodeId, field: FieldId, on: bool) -> Result<(), GraphError> {
        self.set_i32(node, field, i32::from(on))
    }

    /// Sets an object field; nothing happens to other fields.
    pub fn set_object(&mut self, node: NodeId, field: FieldId, value: O) -> Result<(), GraphError> {
        let index = self.live_index(node)?;
        let declared = self.field_of(index, field);
        if declared.kind != FieldKind::Object {
            return Ok(());
        }
        match declared.storage {
            Storage::Words(offset) => {
                let place = self.word_place(index, offset);
                let number = self.words.get(place);
                let number = if value.is_null() {
                    self.objects.release(number);
                    0
                } else {
                    self.objects.put(number, value)
                };
                self.words.set(place, number);
            }
            Storage::Side => self.set_side(index, field, SideValue::Object(value)),
        }
        self.touch_field(index, field);
        Ok(())
    }

    fn set_number(
        &mut self,
        node: NodeId,
        field: FieldId,
        encode: impl FnOnce(FieldKind) -> [u32; 2],
    ) -> Result<(), GraphError> {
        let index = self.live_index(node)?;
        let declared = self.field_of(index, field);
        let (kind, storage) = (declared.kind, declared.storage);
        if kind == FieldKind::Object {
            return Ok(());
        }
        let words = encode(kind);
        match storage {
            Storage::Words(offset) => {
                let place = self.word_place(index, offset);
                for (i, &word) in words[..kind.words()].iter().enumerate() {
                    self.words.set(place + i as u32, word);
                }
            }
            Storage::Side => self.set_side(index, field, SideValue::Words(words)),
        }
        self.touch_field(index, field);
        Ok(())
    }

    fn set_side(&mut self, index: usize, field: FieldId, value: SideValue<O>) {
        self.nodes[index].flags |= HAS_SIDE;
        self.side.insert((index as u32, field.0), value);
    }

    /// Only fields of built-in types move or shape anything.
    fn touch_field(&mut self, index: usize, field: FieldId) {
        let types = self.types();
        let builtin = types[self.nodes[index].type_id].builtin;
        let is_shape = usize::from(field.0) < types[builtin].fields.len();
        self.touch(is_shape);
    }

    fn words_of(&self, node: NodeId, field: FieldId) -> Result<(FieldKind, [u32; 2]), GraphError> {
        let index = self.live_index(node)?;
        let declared = self.field_of(index, field);
        let words = match declared.storage {
            Storage::Words(offset) => {
                let place = self.word_place(index, offset);
                let high = if declared.kind.words() == 2 {
                    self.words.get(place + 1)
                } else {
                    0
                };
                [self.words.get(place), high]
            }
            Storage::Side => match self.side.get(&(index as u32, field.0)) {
                Some(SideValue::Words(words)) => *words,
                Some(SideValue::Object(_)) | None => declared.kind.encode(declared.default),
            },
        };
        Ok((declared.kind, words))
    }
}

fn wide(words: [u32; 2]) -> u64 {
    u64::from(words[0]) | u64::from(words[1]) << 32
}

#[cfg(test)]
mod tests {
    use super::super::{FieldId, FieldKind, Graph, NewField, TypeTable};
    use std::sync::Arc;

    #[test]
    fn every_kind_keeps_its_value() {
        let mut table = TypeTable::default();
        let kinds = [
            FieldKind::Byte,
            FieldKind::Long,
            FieldKind::Float,
            FieldKind::Double,
            FieldKind::Char,
            FieldKind::Boolean,
        ];
        let mut fields: Vec<_> = kinds.iter().map(|&k| NewField::new("f", k)).collect();
        fields.push(NewField {
            is_rare: true,
            default: 0.25,
            ..NewField::new("r", FieldKind::Double)
        });
        let ty = table.add_builtin("T", None, false, &fields);
        let mut graph: Graph<()> = Graph::new(Arc::new(table), 10).expect("small");
        let node = graph.create(ty).expect("room");
        graph.set_i32(node, FieldId(0), 200).expect("exists");
        graph.set_i64(node, FieldId(1), -1 << 40).expect("exists");
        graph.set_f32(node, FieldId(2), 0.1).expect("exists");
        graph.set_f64(node, FieldId(3), 0.1).expect("exists");
        graph.set_i32(node, FieldId(4), -1).expect("exists");
        graph.set_bool(node, FieldId(5), true).expect("exists");
        assert_eq!(graph.get_i32(node, FieldId(0)), Ok(-56));
        assert_eq!(graph.get_i64(node, FieldId(1)), Ok(-1 << 40));
        assert_eq!(graph.get_f32(node, FieldId(2)), Ok(0.1));
        assert_eq!(graph.get_f64(node, FieldId(3)), Ok(0.1));
        assert_eq!(graph.get_i32(node, FieldId(4)), Ok(65535));
        assert_eq!(graph.get_bool(node, FieldId(5)), Ok(true));
        assert_eq!(graph.get_f64(node, FieldId(6)), Ok(0.25));
        assert!(!graph.has_side(node, FieldId(6)));
        graph.set_f64(node, FieldId(6), 3.5).expect("exists");
        assert_eq!(graph.get_f64(node, FieldId(6)), Ok(3.5));
    }
}
