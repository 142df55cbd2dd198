//! Frames of local variables: numbers and nodes as raw words, everything else as values, each in one growing stack.

use super::value::Value;
use crate::check::model::{Slot, Type};
use crate::graph::NodeId;

/// Where a local variable lives in its frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Local {
    /// In the words, at this offset.
    Word(u32),
    /// In the values, at this offset.
    Value(u32),
}

/// How the slots of a frame are laid out.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    locals: Vec<Local>,
    n_words: u32,
    n_values: u32,
}

impl Layout {
    /// The layout of slots of these types.
    pub fn new(types: &[Type]) -> Self {
        let mut layout = Self::default();
        for ty in types {
            let counter = if is_word(ty) {
                &mut layout.n_words
            } else {
                &mut layout.n_values
            };
            let at = *counter;
            *counter += 1;
            layout.locals.push(if is_word(ty) {
                Local::Word(at)
            } else {
                Local::Value(at)
            });
        }
        layout
    }

    /// Where a slot lives.
    pub fn local(&self, slot: Slot) -> Local {
        self.local_at(usize::from(slot.0))
    }

    /// Where the variable with this number lives.
    pub fn local_at(&self, index: usize) -> Local {
        self.locals
            .get(index)
            .copied()
            .expect("invariant: slots are numbered by the checker")
    }

    /// Number of words and of values.
    pub fn size(&self) -> (u32, u32) {
        (self.n_words, self.n_values)
    }

    /// The same slots with room for temporaries behind them.
    #[must_use]
    pub fn with_size(mut self, n_words: u32, n_values: u32) -> Self {
        (self.n_words, self.n_values) = (n_words, n_values);
        self
    }
}

/// Whether a variable of this type is kept as a raw word.
pub fn is_word(ty: &Type) -> bool {
    match ty {
        Type::Boolean | Type::Byte | Type::Short | Type::Char | Type::Int | Type::Long => true,
        Type::Float | Type::Double | Type::Node(_) => true,
        Type::Void | Type::Null | Type::String | Type::Array(_) | Type::Object => false,
        Type::Class(_) | Type::Generic(..) | Type::Instance(_) => false,
    }
}

/// The stack of a machine: all frames that are active.
#[derive(Debug, Default)]
pub struct Stack {
    words: Vec<u64>,
    values: Vec<Value>,
    word_base: usize,
    value_base: usize,
    /// Number of active frames.
    pub depth: u32,
    /// Result of the method that returned last, if it is a word.
    pub result_word: u64,
    /// Result of the method that returned last, if it is no word.
    pub result_value: Value,
}

/// Where a stack stood, to return to.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    n_words: usize,
    n_values: usize,
    word_base: usize,
    value_base: usize,
    depth: u32,
}

impl Stack {
    /// Where the stack stands now.
    pub fn mark(&self) -> Mark {
        Mark {
            n_words: self.words.len(),
            n_values: self.values.len(),
            word_base: self.word_base,
            value_base: self.value_base,
            depth: self.depth,
        }
    }

    /// Drops everything above `mark` and makes the frame current that was then.
    pub fn release(&mut self, mark: Mark) {
        self.words.truncate(mark.n_words);
        self.values.truncate(mark.n_values);
        (self.word_base, self.value_base, self.depth) =
            (mark.word_base, mark.value_base, mark.depth);
    }

    /// Makes a frame current whose first variables (the arguments) were pushed since `mark`; the rest begins as zero.
    pub fn enter(&mut self, mark: Mark, layout: &Layout) {
        (self.word_base, self.value_base) = (mark.n_words, mark.n_values);
        self.words.resize(mark.n_words + layout.n_words as usize, 0);
        self.values
            .resize(mark.n_values + layout.n_values as usize, Value::Null);
        self.depth += 1;
    }

    /// Pushes an argument that is a word.
    #[inline]
    pub fn push_word(&mut self, word: u64) {
        self.words.push(word);
    }

    /// Pushes an argument that is no word.
    #[inline]
    pub fn push_value(&mut self, value: Value) {
        self.values.push(value);
    }

    /// The word at `offset` of the current frame.
    #[inline]
    pub fn word(&self, offset: u32) -> u64 {
        self.words[self.word_base + offset as usize]
    }

    /// Sets the word at `offset` of the current frame.
    #[inline]
    pub fn set_word(&mut self, offset: u32, word: u64) {
        self.words[self.word_base + offset as usize] = word;
    }

    /// The value at `offset` of the current frame.
    #[inline]
    pub fn value(&self, offset: u32) -> &Value {
        &self.values[self.value_base + offset as usize]
    }

    /// Sets the value at `offset` of the current frame.
    #[inline]
    pub fn set_value(&mut self, offset: u32, value: Value) {
        self.values[self.value_base + offset as usize] = value;
    }
}

/// A type of Rust that variables of the language are computed in.
pub trait Kind: Clone + Default + Send + Sync + 'static {
    /// Reads a local variable of the current frame.
    fn load(stack: &Stack, offset: u32) -> Self;
    /// Writes a local variable of the current frame.
    fn store(self, stack: &mut Stack, offset: u32);
    /// Pushes an argument.
    fn push(self, stack: &mut Stack);
    /// Takes the result of the method that returned last.
    fn take_result(stack: &mut Stack) -> Self;
    /// Leaves the result of a method.
    fn leave_result(self, stack: &mut Stack);
    /// The variable at `offset` of a frame that is no part of the stack.
    fn read_from(words: &[u64], values: &[Value], offset: u32) -> Self;
    /// Writes the variable at `offset` of a frame that is no part of the stack.
    fn write_to(self, words: &mut [u64], values: &mut [Value], offset: u32);
}

macro_rules! word_kind {
    ($($ty:ty, $to:expr, $from:expr;)*) => {$(
        impl Kind for $ty {
            #[inline]
            fn load(stack: &Stack, offset: u32) -> Self {
                $from(stack.word(offset))
            }

            #[inline]
            fn store(self, stack: &mut Stack, offset: u32) {
                stack.set_word(offset, $to(self));
            }

            #[inline]
            fn push(self, stack: &mut Stack) {
                stack.push_word($to(self));
            }

            #[inline]
            fn take_result(stack: &mut Stack) -> Self {
                $from(stack.result_word)
            }

            #[inline]
            fn leave_result(self, stack: &mut Stack) {
                stack.result_word = $to(self);
            }

            fn read_from(words: &[u64], _: &[Value], offset: u32) -> Self {
                $from(words[offset as usize])
            }

            fn write_to(self, words: &mut [u64], _: &mut [Value], offset: u32) {
                words[offset as usize] = $to(self);
            }
        }
    )*};
}

word_kind! {
    bool, u64::from, |w| w != 0;
    i32, |x| x as u32 as u64, |w| w as u32 as i32;
    i64, |x| x as u64, |w| w as i64;
    f32, |x: f32| u64::from(x.to_bits()), |w| f32::from_bits(w as u32);
    f64, f64::to_bits, f64::from_bits;
    Option<NodeId>, node_word, NodeId::from_bits;
}

fn node_word(node: Option<NodeId>) -> u64 {
    node.map_or(0, NodeId::to_bits)
}

impl Kind for Value {
    #[inline]
    fn load(stack: &Stack, offset: u32) -> Self {
        stack.value(offset).clone()
    }

    #[inline]
    fn store(self, stack: &mut Stack, offset: u32) {
        stack.set_value(offset, self);
    }

    #[inline]
    fn push(self, stack: &mut Stack) {
        stack.push_value(self);
    }

    fn take_result(stack: &mut Stack) -> Self {
        std::mem::take(&mut stack.result_value)
    }

    fn leave_result(self, stack: &mut Stack) {
        stack.result_value = self;
    }

    fn read_from(_: &[u64], values: &[Value], offset: u32) -> Self {
        values[offset as usize].clone()
    }

    fn write_to(self, _: &mut [u64], values: &mut [Value], offset: u32) {
        values[offset as usize] = self;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_keep_words_and_values_apart() {
        let layout = Layout::new(&[Type::Int, Type::String, Type::Double, Type::Object]);
        assert_eq!(layout.local(Slot(2)), Local::Word(1));
        assert_eq!(layout.local(Slot(3)), Local::Value(1));
        let mut stack = Stack::default();
        let outer = stack.mark();
        7_i32.push(&mut stack);
        Value::text("a").push(&mut stack);
        stack.enter(outer, &layout);
        2.5_f64.store(&mut stack, 1);
        let inner = stack.mark();
        (-1_i32).push(&mut stack);
        stack.enter(inner, &layout);
        assert_eq!((i32::load(&stack, 0), f64::load(&stack, 1)), (-1, 0.0));
        stack.release(inner);
        assert_eq!(
            (i32::load(&stack, 0), f64::load(&stack, 1), stack.depth),
            (7, 2.5, 1)
        );
        assert_eq!(Value::load(&stack, 0).to_string(), "a");
        stack.release(outer);
        assert!(stack.words.is_empty() && stack.values.is_empty());
    }

    #[test]
    fn words_keep_every_bit() {
        let mut stack = Stack::default();
        for x in [i32::MIN, -1, 0, i32::MAX] {
            x.leave_result(&mut stack);
            assert_eq!(i32::take_result(&mut stack), x);
        }
        f32::NAN.leave_result(&mut stack);
        assert!(f32::take_result(&mut stack).is_nan());
        None::<NodeId>.leave_result(&mut stack);
        assert_eq!(Option::<NodeId>::take_result(&mut stack), None);
    }
}
