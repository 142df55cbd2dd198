//! What ends an evaluation early: exceptions, which the model can catch, and limits, which it cannot.

use std::sync::Arc;

use super::memory::OverBudget;
use super::object::{Data, Object, qualified};
use super::text::Text;
use super::value::Value;
use crate::diag::{Diagnostic, Label, Span};
use crate::graph::GraphError;
use crate::library::ClassId;

/// Most lines of trace that are kept; a deep recursion has thousands of equal ones.
const MAX_TRACE: usize = 8;

/// The reason an evaluation ended early. Boxed, so that results of expressions stay small.
#[derive(Debug)]
pub struct Trap(Box<Fault>);

#[derive(Debug)]
struct Fault {
    cause: Cause,
    span: Option<Span>,
    notes: Vec<(Span, String)>,
    trace: Vec<String>,
    n_omitted: usize,
}

/// Why an evaluation ended.
#[derive(Debug)]
pub enum Cause {
    /// The model threw this, or the language did.
    Exception(Value),
    /// A budget is spent.
    Limit {
        /// Short stable name of the message.
        slug: &'static str,
        /// What happened.
        message: String,
        /// What to do about it.
        hint: String,
    },
    /// The user asked to stop.
    Cancelled,
}

impl Trap {
    /// Some end of an evaluation at `span`.
    pub fn new(cause: Cause, span: Option<Span>) -> Self {
        Self(Box::new(Fault {
            cause,
            span,
            notes: vec![],
            trace: vec![],
            n_omitted: 0,
        }))
    }

    /// An exception of the language.
    pub fn exception(class: ClassId, message: impl Into<Box<str>>, span: Span) -> Self {
        let text = Arc::new(Text::new(message, super::memory::Charge::none()));
        let object = Object::new(class, Data::Throwable(Some(text)));
        Self::new(
            Cause::Exception(Value::Object(Arc::new(object))),
            Some(span),
        )
    }

    /// `NullPointerException`: `what` was done to null.
    pub fn null(what: &str, span: Span) -> Self {
        Self::exception(
            ClassId::NullPointerException,
            format!("cannot {what} because it is null"),
            span,
        )
    }

    /// A spent budget.
    pub fn limit(slug: &'static str, message: String, hint: &str, span: Option<Span>) -> Self {
        Self::new(
            Cause::Limit {
                slug,
                message,
                hint: hint.to_owned(),
            },
            span,
        )
    }

    /// A spent memory budget.
    pub fn memory(over: OverBudget, span: Option<Span>) -> Self {
        let OverBudget { wanted, limit } = over;
        let message = format!(
            "the model's values need more memory than the {limit} bytes allowed ({wanted} bytes more were wanted)"
        );
        Self::limit(
            "memory-limit",
            message,
            "look for a text, array or list that grows without end, or raise `--max-memory`",
            span,
        )
    }

    /// Why it ended.
    pub fn cause(&self) -> &Cause {
        &self.0.cause
    }

    /// The value thrown, if the model can catch it.
    pub fn thrown(&self) -> Option<&Value> {
        match &self.0.cause {
            Cause::Exception(value) => Some(value),
            Cause::Limit { .. } | Cause::Cancelled => None,
        }
    }

    /// Gives a trap that has no place yet this one.
    #[must_use]
    pub fn at(mut self, span: Span) -> Self {
        self.0.span.get_or_insert(span);
        self
    }

    /// Adds what was being done, innermost first.
    #[must_use]
    pub fn during(mut self, line: impl FnOnce() -> String) -> Self {
        if self.0.trace.len() < MAX_TRACE {
            self.0.trace.push(line());
        } else {
            self.0.n_omitted += 1;
        }
        self
    }

    /// Adds another place, unless there is one already: the innermost rule explains most.
    #[must_use]
    pub fn noting(mut self, span: Span, text: impl FnOnce() -> String) -> Self {
        if self.0.notes.is_empty() {
            self.0.notes.push((span, text()));
        }
        self
    }

    /// The message for the user.
    pub fn into_diagnostic(self) -> Diagnostic {
        let Fault {
            cause,
            span,
            notes,
            trace,
            n_omitted,
        } = *self.0;
        let (slug, message, hint) = match cause {
            Cause::Exception(value) => ("exception", value.to_string(), None),
            Cause::Limit {
                slug,
                message,
                hint,
            } => (slug, message, Some(hint)),
            Cause::Cancelled => (
                "cancelled",
                "the model was stopped before it had finished".to_owned(),
                None,
            ),
        };
        let mut diagnostic = Diagnostic::error(slug, span.unwrap_or_default(), message);
        if span.is_none() {
            diagnostic.primary = None;
        }
        diagnostic
            .secondary
            .extend(notes.into_iter().map(|(span, text)| Label { span, text }));
        diagnostic.hints.extend(hint);
        diagnostic.trace = trace;
        if n_omitted > 0 {
            diagnostic.trace.push(format!("… {n_omitted} more"));
        }
        diagnostic
    }
}

impl From<GraphError> for Trap {
    /// What a fault of the graph means to the model.
    fn from(error: GraphError) -> Self {
        let (class, message) = match error {
            GraphError::DeletedNode => (
                ClassId::IllegalStateException,
                "the node was removed from the graph in an earlier step".to_owned(),
            ),
            GraphError::SelfEdge => (
                ClassId::IllegalArgumentException,
                "Cannot create an edge from a node to itself".to_owned(),
            ),
            GraphError::TooManyNodes { limit } => {
                let message = format!("the model grows beyond {limit} modules");
                return Self::limit(
                    "module-limit",
                    message,
                    "does a rule multiply without end? `--max-modules` allows more",
                    None,
                );
            }
        };
        let mut trap = Self::exception(class, message, Span::default());
        trap.0.span = None;
        trap
    }
}

/// Java's full name and message of something thrown, as at the head of a stack trace.
pub fn describe(thrown: &Value) -> String {
    match thrown.class() {
        Some(class) if class.is_a(ClassId::Throwable) => thrown.to_string(),
        Some(class) => format!("{}: {thrown}", qualified(class)),
        None => thrown.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::FileId;

    #[test]
    fn a_trap_is_one_word() {
        assert_eq!(size_of::<Trap>(), size_of::<usize>());
    }

    #[test]
    fn a_deep_trace_is_cut() {
        let span = Span::new(FileId(0), 3, 5);
        let mut trap = Trap::exception(ClassId::ArithmeticException, "/ by zero", span);
        for i in 0..20 {
            trap = trap.during(|| format!("in method `f{i}`"));
        }
        let diagnostic = trap.into_diagnostic();
        assert_eq!(
            diagnostic.message,
            "java.lang.ArithmeticException: / by zero"
        );
        assert_eq!(diagnostic.trace.len(), MAX_TRACE + 1);
        assert_eq!(diagnostic.trace[MAX_TRACE], "… 12 more");
    }
}
