//! What is known while one body (method, constructor, initializer, instantiation) is being checked.

use super::model::{Constant, MethodId, Sequence, Slot, StaticId};
use crate::diag::Span;
use crate::graph::TypeId;
use crate::library::Type;

/// A local variable, a parameter, or what a pattern binds.
#[derive(Clone, Debug)]
pub(super) struct Local {
    pub(super) name: String,
    /// `None` where its type could not be read; whatever uses it is passed over silently.
    pub(super) ty: Option<Type>,
    pub(super) slot: Slot,
    /// Whether it must not be assigned.
    pub(super) is_final: bool,
    /// Its value, where it is a constant.
    pub(super) value: Option<Constant>,
}

/// One step of the search for a name, from the inside out.
#[derive(Clone, Debug)]
pub(super) enum Layer {
    /// Variables of a block.
    Block(Vec<Local>),
    /// Inside `x.( … )`: the members of the object in the slot.
    With(Slot, Type),
}

/// A label of a statement.
#[derive(Clone, Debug)]
pub(super) struct Label {
    pub(super) name: String,
    pub(super) number: u16,
    pub(super) is_loop: bool,
}

/// Whether a query may stand here, and the one that was found.
#[derive(Debug, Default)]
pub(super) enum Collector {
    /// A single value is wanted.
    #[default]
    Closed,
    /// Inside an aggregate or the head of a `for`: a query may stand here.
    Open,
    /// A query was found: its values pass through the slot.
    Found(Sequence, Slot),
}

/// A body that another one runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Body {
    Method(MethodId),
    Constructor(TypeId),
    Instantiation(TypeId),
}

/// What a body does that decides whether equal nodes make equal geometry.
#[derive(Clone, Debug, Default)]
pub(super) struct Facts {
    /// Depends on or changes something outside its own node.
    pub(super) is_impure: bool,
    /// What it runs.
    pub(super) runs: Vec<Body>,
    /// Variables of the model that it reads.
    pub(super) reads: Vec<StaticId>,
}

/// The state of the body at hand.
#[derive(Debug, Default)]
pub(super) struct Context {
    /// Index of the file it stands in.
    pub(super) file: usize,
    /// Type of `this`, in slot 0.
    pub(super) this: Option<TypeId>,
    /// The module it belongs to, also where there is no `this`.
    pub(super) owner: Option<TypeId>,
    /// Types of the slots given out so far.
    pub(super) frame: Vec<Type>,
    /// Where names are looked for, outermost first.
    pub(super) layers: Vec<Layer>,
    /// What `return` must give; `None` where there is no `return` or its type is unknown.
    pub(super) result: Option<Type>,
    /// Labels that enclose the statement at hand.
    pub(super) labels: Vec<Label>,
    /// Labels given out so far.
    pub(super) n_labels: u16,
    /// Loops that enclose the statement at hand.
    pub(super) loops: u32,
    /// Switches that enclose the statement at hand.
    pub(super) switches: u32,
    /// For queries inside expressions.
    pub(super) collector: Collector,
    /// Every local that was read, in order.
    pub(super) touched: Vec<Slot>,
    /// For `is_pure`.
    pub(super) facts: Facts,
    /// Where a frame with too many variables began to overflow.
    pub(super) overflow: Option<Span>,
    /// Where the slots were declared, without those that the body began with.
    slot_spans: Vec<Span>,
    /// All variables with a name, for editors.
    pub(super) declared: Vec<Local>,
}

impl Context {
    /// The context of a body in `file`; with `this` in slot 0 if there is one, of the type that goes with it.
    pub(super) fn new(file: usize, this: Option<(TypeId, Type)>) -> Self {
        let owner = this.as_ref().map(|(id, _)| *id);
        Self {
            file,
            this: owner,
            owner,
            frame: this.into_iter().map(|(_, ty)| ty).collect(),
            layers: vec![Layer::Block(vec![])],
            ..Self::default()
        }
    }

    /// A new slot.
    pub(super) fn slot(&mut self, ty: Type, span: Span) -> Slot {
        let Ok(number) = u16::try_from(self.frame.len()) else {
            self.overflow.get_or_insert(span);
            return Slot(u16::MAX);
        };
        self.frame.push(ty);
        self.slot_spans.push(span);
        Slot(number)
    }

    /// Where a slot was declared; `None` for `this`.
    pub(super) fn slot_span(&self, slot: Slot) -> Option<Span> {
        let n_first = self.frame.len() - self.slot_spans.len();
        let at = usize::from(slot.0).checked_sub(n_first)?;
        self.slot_spans.get(at).copied()
    }

    /// Opens a block.
    pub(super) fn open(&mut self) {
        self.layers.push(Layer::Block(vec![]));
    }

    /// Leaves the innermost block or `.( … )`.
    pub(super) fn close(&mut self) {
        self.layers.pop();
    }

    /// A variable of this name in the innermost block itself.
    pub(super) fn local_here(&self, name: &str) -> Option<&Local> {
        match self.layers.last() {
            Some(Layer::Block(locals)) => locals.iter().rev().find(|l| l.name == name),
            _ => None,
        }
    }

    /// Adds a variable to the innermost block.
    pub(super) fn declare(&mut self, local: Local) {
        if !matches!(self.layers.last(), Some(Layer::Block(_))) {
            self.open();
        }
        self.declared.push(local.clone());
        if let Some(Layer::Block(locals)) = self.layers.last_mut() {
            locals.push(local);
        }
    }

    /// Whether a variable of this name can be seen.
    pub(super) fn has_local(&self, name: &str) -> bool {
        self.layers.iter().any(|layer| match layer {
            Layer::Block(locals) => locals.iter().any(|local| local.name == name),
            Layer::With(..) => false,
        })
    }

    /// The type of what the innermost `.( … )` speaks of.
    pub(super) fn innermost_with(&self) -> Option<&Type> {
        self.layers.iter().rev().find_map(|layer| match layer {
            Layer::With(_, ty) => Some(ty),
            Layer::Block(_) => None,
        })
    }

    /// Names of all variables that can be seen.
    pub(super) fn local_names(&self) -> Vec<String> {
        let blocks = self.layers.iter().rev().filter_map(|layer| match layer {
            Layer::Block(locals) => Some(locals),
            Layer::With(..) => None,
        });
        blocks.flatten().map(|l| l.name.clone()).collect()
    }
}
