//! Which parts of its text a step of a model has used.

use std::collections::BTreeSet;

use crate::check::model::MethodId;
use crate::diag::Span;

/// What a step has used of the text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Trace {
    /// By number of the method, whether it was called; later ones were not.
    methods: Vec<bool>,
    /// Rules that found a match.
    pub rules: BTreeSet<Span>,
    /// Whether an instantiation body was drawn, for a light model.
    pub has_drawn: bool,
}

impl Trace {
    /// Nothing of a text with so many methods.
    pub fn new(n_methods: usize) -> Self {
        Self {
            methods: vec![false; n_methods],
            ..Self::default()
        }
    }

    /// Notes that a method is called.
    #[inline]
    pub fn call(&mut self, method: MethodId) {
        if let Some(is_called) = self.methods.get_mut(method.0 as usize) {
            *is_called = true;
        }
    }

    /// Whether a method was called.
    pub fn has_called(&self, method: usize) -> bool {
        self.methods.get(method).copied().unwrap_or(false)
    }

    /// What was used so far; from here on, nothing is.
    pub fn take(&mut self) -> Self {
        let fresh = Self::new(self.methods.len());
        std::mem::replace(self, fresh)
    }
}
