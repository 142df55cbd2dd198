//! Arrays: fixed length, shared by reference, numbers stored unboxed.
//!
//! Elements are relaxed atomics, which cost no more than plain memory: values can be shared between threads that read a
//! grown model, while the language itself runs on one.

use std::sync::atomic::{
    AtomicI8, AtomicI16, AtomicI32, AtomicI64, AtomicU16, AtomicU32, AtomicU64, Ordering,
};
use std::sync::{Mutex, PoisonError};

use super::memory::Charge;
use super::value::{Value, free};

/// An array of the language.
#[derive(Debug)]
pub struct Array {
    elements: Elements,
    _charge: Charge,
}

/// What an array holds.
#[derive(Debug)]
#[allow(missing_docs, reason = "the names are Java's own")]
pub enum Elements {
    Boolean(Box<[AtomicI8]>),
    Byte(Box<[AtomicI8]>),
    Short(Box<[AtomicI16]>),
    Char(Box<[AtomicU16]>),
    Int(Box<[AtomicI32]>),
    Long(Box<[AtomicI64]>),
    Float(Box<[AtomicU32]>),
    Double(Box<[AtomicU64]>),
    /// Texts, nodes, arrays, objects.
    Reference(Box<[Mutex<Value>]>),
}

impl Elements {
    /// As many zeros (or nulls) of the same kind.
    pub fn zeros(&self, n: usize) -> Self {
        fn made<T: Default>(n: usize) -> Box<[T]> {
            std::iter::repeat_with(T::default).take(n).collect()
        }
        match self {
            Self::Boolean(_) => Self::Boolean(made(n)),
            Self::Byte(_) => Self::Byte(made(n)),
            Self::Short(_) => Self::Short(made(n)),
            Self::Char(_) => Self::Char(made(n)),
            Self::Int(_) => Self::Int(made(n)),
            Self::Long(_) => Self::Long(made(n)),
            Self::Float(_) => Self::Float(made(n)),
            Self::Double(_) => Self::Double(made(n)),
            Self::Reference(_) => Self::Reference(made(n)),
        }
    }
}

impl Array {
    /// An array that carries its share of the memory budget.
    pub fn new(elements: Elements, charge: Charge) -> Self {
        Self {
            elements,
            _charge: charge,
        }
    }

    /// What it holds.
    pub fn elements(&self) -> &Elements {
        &self.elements
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        match &self.elements {
            Elements::Boolean(e) | Elements::Byte(e) => e.len(),
            Elements::Short(e) => e.len(),
            Elements::Char(e) => e.len(),
            Elements::Int(e) => e.len(),
            Elements::Long(e) => e.len(),
            Elements::Float(e) => e.len(),
            Elements::Double(e) => e.len(),
            Elements::Reference(e) => e.len(),
        }
    }

    /// Whether it has no elements.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The element, boxed.
    pub fn get(&self, index: usize) -> Option<Value> {
        Some(match &self.elements {
            Elements::Boolean(e) => Value::Boolean(e.get(index)?.load(Ordering::Relaxed) != 0),
            Elements::Byte(e) => Value::Byte(e.get(index)?.load(Ordering::Relaxed)),
            Elements::Short(e) => Value::Short(e.get(index)?.load(Ordering::Relaxed)),
            Elements::Char(e) => Value::Char(e.get(index)?.load(Ordering::Relaxed)),
            Elements::Int(e) => Value::Int(e.get(index)?.load(Ordering::Relaxed)),
            Elements::Long(e) => Value::Long(e.get(index)?.load(Ordering::Relaxed)),
            Elements::Float(e) => {
                Value::Float(f32::from_bits(e.get(index)?.load(Ordering::Relaxed)))
            }
            Elements::Double(e) => {
                Value::Double(f64::from_bits(e.get(index)?.load(Ordering::Relaxed)))
            }
            Elements::Reference(e) => e
                .get(index)?
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .clone(),
        })
    }

    /// Stores a boxed value, numbers converted to what the array holds; nothing if the index is out of bounds.
    pub fn put(&self, index: usize, value: Value) {
        let (int, double) = (
            value.as_int().unwrap_or(0),
            value.as_double().unwrap_or(0.0),
        );
        match &self.elements {
            Elements::Boolean(e) => store(e, index, i8::from(value.as_boolean() == Some(true))),
            Elements::Byte(e) => store(e, index, int as i8),
            Elements::Short(e) => store(e, index, int as i16),
            Elements::Char(e) => store(e, index, int as u16),
            Elements::Int(e) => store(e, index, int),
            Elements::Long(e) => store(e, index, value.as_long().unwrap_or(0)),
            Elements::Float(e) => store(e, index, (double as f32).to_bits()),
            Elements::Double(e) => store(e, index, double.to_bits()),
            Elements::Reference(e) => {
                if let Some(slot) = e.get(index) {
                    *slot.lock().unwrap_or_else(PoisonError::into_inner) = value;
                }
            }
        }
    }

    /// Moves the references that it holds to `parts`.
    pub(super) fn take_parts(&mut self, parts: &mut Vec<Value>) {
        if let Elements::Reference(elements) = &mut self.elements {
            let values = elements.iter_mut();
            parts.extend(
                values.map(|v| std::mem::take(v.get_mut().unwrap_or_else(PoisonError::into_inner))),
            );
        }
    }

    /// Java's name of its type, as printed for a reference.
    pub fn type_name(&self) -> &'static str {
        match self.elements {
            Elements::Boolean(_) => "boolean[]",
            Elements::Byte(_) => "byte[]",
            Elements::Short(_) => "short[]",
            Elements::Char(_) => "char[]",
            Elements::Int(_) => "int[]",
            Elements::Long(_) => "long[]",
            Elements::Float(_) => "float[]",
            Elements::Double(_) => "double[]",
            Elements::Reference(_) => "Object[]",
        }
    }
}

impl Drop for Array {
    fn drop(&mut self) {
        if matches!(self.elements, Elements::Reference(_)) {
            let mut parts = vec![];
            self.take_parts(&mut parts);
            free(parts);
        }
    }
}

impl Elements {
    /// `n` zeros, falses or nulls of the same kind as `self`.
    #[must_use]
    pub fn zeros_like(&self, n: usize) -> Self {
        match self {
            Self::Boolean(_) => Self::Boolean(filled(n)),
            Self::Byte(_) => Self::Byte(filled(n)),
            Self::Short(_) => Self::Short(filled(n)),
            Self::Char(_) => Self::Char(filled(n)),
            Self::Int(_) => Self::Int(filled(n)),
            Self::Long(_) => Self::Long(filled(n)),
            Self::Float(_) => Self::Float(filled(n)),
            Self::Double(_) => Self::Double(filled(n)),
            Self::Reference(_) => Self::Reference(filled(n)),
        }
    }

    /// Bytes that one element takes.
    pub fn element_bytes(&self) -> usize {
        match self {
            Self::Boolean(_) | Self::Byte(_) => 1,
            Self::Short(_) | Self::Char(_) => 2,
            Self::Int(_) | Self::Float(_) => 4,
            Self::Long(_) | Self::Double(_) => 8,
            Self::Reference(_) => size_of::<Mutex<Value>>(),
        }
    }
}

/// Cells of plain numbers.
trait Cell<T> {
    fn put(&self, value: T);
}

macro_rules! cells {
    ($($cell:ty: $number:ty;)*) => {$(
        impl Cell<$number> for $cell {
            fn put(&self, value: $number) {
                self.store(value, Ordering::Relaxed);
            }
        }
    )*};
}
cells! {
    AtomicI8: i8; AtomicI16: i16; AtomicI32: i32; AtomicI64: i64; AtomicU16: u16; AtomicU32: u32; AtomicU64: u64;
}

fn store<T, C: Cell<T>>(cells: &[C], index: usize, value: T) {
    if let Some(cell) = cells.get(index) {
        cell.put(value);
    }
}

fn filled<T: Default>(n: usize) -> Box<[T]> {
    std::iter::repeat_with(T::default).take(n).collect()
}
