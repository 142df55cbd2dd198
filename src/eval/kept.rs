//! A running model as it stands between two steps, kept to be gone on from later, perhaps by another program.
//!
//! Texts are shared, for nothing changes them. Arrays and objects are copied with all they lead to, and stay one where they
//! were one.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::array::{Array, Elements};
use super::machine::{Machine, Statics};
use super::memory::Charge;
use super::object::{Data, Object};
use super::program::Program;
use super::random::JavaRandom;
use super::value::Value;
use crate::graph::Graph;
use crate::rewrite::Queue;
use crate::turtle::Poses;

/// Bytes that a node, and an array or object, are taken to hold: a guess on the high side.
const BYTES_PER_NODE: u64 = 96;
const BYTES_PER_OBJECT: u64 = 256;
/// A model whose texts, arrays and collections take more than this part of what they may is not kept: copies take no share of
/// that budget, so it would bind less than in a run from the beginning.
const CROWDED: u64 = 8;

/// A model as it stands between two steps.
pub struct Kept {
    graph: Graph<Value>,
    random: JavaRandom,
    statics: Statics,
    derivation_mode: i32,
    step: u64,
    is_finished: bool,
    bytes: u64,
}

impl Kept {
    /// The number of the step after which it was kept; 0 after `init`.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// About how much memory it takes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Machine {
    /// About how much memory a copy of the model would take, objects aside.
    pub fn weight(&self) -> u64 {
        BYTES_PER_NODE * self.graph.n_places() as u64
    }

    /// A copy of the model as it stands between two steps; `None` if it holds something that cannot be copied, such as an
    /// open file, or has written files or drawn tables.
    pub fn keep(&self) -> Option<Kept> {
        let is_crowded = self.meter.used() > self.limits().memory / CROWDED;
        let has_outputs =
            !(self.written.is_empty() && self.charts.is_empty() && self.tables.is_empty());
        if is_crowded || has_outputs {
            return None;
        }
        let mut copies = Copies::default();
        let (graph, statics) = copies.model(&self.graph, &self.statics)?;
        Some(Kept {
            graph,
            random: self.random.clone(),
            statics,
            derivation_mode: self.derivation_mode,
            step: self.step,
            is_finished: self.is_finished,
            bytes: self.weight() + BYTES_PER_OBJECT * copies.count(),
        })
    }

    /// Goes back (or on) to where the model was kept. `program` is that of this machine; its types are those that the model
    /// was kept with.
    pub fn go_to(&mut self, kept: &Kept, program: &Program) {
        let limit = self.graph.limit();
        let copied = Copies::default().model(&kept.graph, &kept.statics);
        let (graph, statics) = copied.expect("invariant: what was copied once can be copied again");
        self.graph = graph;
        self.graph.adopt(Arc::clone(program.types()), limit);
        (self.poses, self.queue) = (Poses::default(), Queue::default());
        self.statics = statics;
        self.random = kept.random.clone();
        self.derivation_mode = kept.derivation_mode;
        self.step = kept.step;
        self.is_finished = kept.is_finished;
    }
}

/// What was copied so far: originals by address, with their copies. Never iterated.
#[derive(Default)]
struct Copies {
    arrays: HashMap<*const Array, Arc<Array>>,
    objects: HashMap<*const Object, Arc<Object>>,
    /// Copies whose parts are still the originals.
    open: Vec<Open>,
    n_elements: u64,
}

/// A copy whose parts are still those of the original.
enum Open {
    Array(Arc<Array>),
    Object(Arc<Object>),
}

impl Copies {
    fn count(&self) -> u64 {
        (self.arrays.len() + self.objects.len()) as u64 + self.n_elements / 16
    }

    /// A graph and variables with all they lead to; `None` if something cannot be copied.
    fn model(
        &mut self,
        graph: &Graph<Value>,
        statics: &Statics,
    ) -> Option<(Graph<Value>, Statics)> {
        let mut graph = graph.clone();
        let mut values = statics.values.clone();
        for value in graph.objects_mut().chain(&mut values) {
            self.replace(value);
        }
        // One after the other: chains of objects may be longer than a stack is deep.
        while let Some(open) = self.open.pop() {
            match open {
                Open::Array(array) => self.finish_array(&array),
                Open::Object(object) => self.finish_object(&object)?,
            }
        }
        let words = statics.words.clone();
        Some((graph, Statics { words, values }))
    }

    /// Puts the copy of what `value` refers to in its place.
    fn replace(&mut self, value: &mut Value) {
        match value {
            Value::Array(array) => *array = self.array(array),
            Value::Object(object) => *object = self.object(object),
            Value::Null
            | Value::Boolean(_)
            | Value::Byte(_)
            | Value::Short(_)
            | Value::Char(_)
            | Value::Int(_)
            | Value::Long(_)
            | Value::Float(_)
            | Value::Double(_)
            | Value::Text(_)
            | Value::Node(_) => {}
        }
    }

    fn array(&mut self, array: &Arc<Array>) -> Arc<Array> {
        let known = self.arrays.entry(Arc::as_ptr(array));
        let open = &mut self.open;
        self.n_elements += array.len() as u64;
        let copy = known.or_insert_with(|| {
            let copy = Arc::new(array.copied());
            open.push(Open::Array(Arc::clone(&copy)));
            copy
        });
        Arc::clone(copy)
    }

    fn object(&mut self, object: &Arc<Object>) -> Arc<Object> {
        let known = self.objects.entry(Arc::as_ptr(object));
        let open = &mut self.open;
        let copy = known.or_insert_with(|| {
            let data = object.lock().clone();
            let copy = Arc::new(Object::new(object.class, data));
            open.push(Open::Object(Arc::clone(&copy)));
            copy
        });
        Arc::clone(copy)
    }

    fn finish_array(&mut self, array: &Array) {
        if let Elements::Reference(elements) = array.elements() {
            for element in elements {
                self.replace(&mut element.lock().unwrap_or_else(PoisonError::into_inner));
            }
        }
    }

    fn finish_object(&mut self, object: &Object) -> Option<()> {
        let mut data = object.lock();
        match &mut *data {
            Data::List(list) => self.replace_all(&mut list.values),
            Data::Instance(instance) => self.replace_all(&mut instance.fields),
            Data::Function(_, captured) => self.replace_all(captured),
            Data::Map(map) | Data::Set(map) => self.replace_all(map.parts_mut()),
            Data::Shaders(pair) => self.replace_all([&mut pair.first, &mut pair.second]),
            Data::Reversed(value) => self.replace(value),
            Data::LightColor(light) => *light = self.object(light),
            Data::Tuple(_)
            | Data::Color(_)
            | Data::Shader(_)
            | Data::Picture(_)
            | Data::Placement(_)
            | Data::Phong(_)
            | Data::Finish(_)
            | Data::Light(_)
            | Data::LightModel(_)
            | Data::Random(_)
            | Data::Buffer(..)
            | Data::Throwable(_)
            | Data::File(_)
            | Data::Freeform(..)
            | Data::Pattern(_)
            | Data::Moment(_)
            | Data::Matrix(_)
            | Data::Opaque => {}
            Data::Tokens(_)
            | Data::Table(_)
            | Data::Row(..)
            | Data::Reader(_)
            | Data::Writer(_)
            | Data::Entry(..) => return None,
        }
        Some(())
    }

    fn replace_all<'v>(&mut self, values: impl IntoIterator<Item = &'v mut Value>) {
        values.into_iter().for_each(|value| self.replace(value));
    }
}

impl Array {
    /// An array with the same elements, which takes no share of the memory budget.
    fn copied(&self) -> Self {
        fn all<T, U>(elements: &[T], of: impl Fn(&T) -> U) -> Box<[U]> {
            elements.iter().map(of).collect()
        }
        use std::sync::atomic::Ordering::Relaxed;
        let elements = match self.elements() {
            Elements::Boolean(e) => Elements::Boolean(all(e, |x| x.load(Relaxed).into())),
            Elements::Byte(e) => Elements::Byte(all(e, |x| x.load(Relaxed).into())),
            Elements::Short(e) => Elements::Short(all(e, |x| x.load(Relaxed).into())),
            Elements::Char(e) => Elements::Char(all(e, |x| x.load(Relaxed).into())),
            Elements::Int(e) => Elements::Int(all(e, |x| x.load(Relaxed).into())),
            Elements::Long(e) => Elements::Long(all(e, |x| x.load(Relaxed).into())),
            Elements::Float(e) => Elements::Float(all(e, |x| x.load(Relaxed).into())),
            Elements::Double(e) => Elements::Double(all(e, |x| x.load(Relaxed).into())),
            Elements::Reference(e) => Elements::Reference(all(e, |x| {
                Mutex::new(x.lock().unwrap_or_else(PoisonError::into_inner).clone())
            })),
        };
        Self::new(elements, Charge::none())
    }
}
