//! What ends an evaluation early: exceptions, which the model can catch, and limits, which it cannot.

use std::collections::VecDeque;
use std::sync::Arc;

use super::memory::OverBudget;
use super::object::{Data, Object, qualified};
use super::text::Text;
use super::value::Value;
use crate::diag::{Diagnostic, Doing, Label, Span};
use crate::graph::GraphError;
use crate::library::ClassId;

/// Most lines of trace that are kept of the innermost and of the outermost; a deep recursion has thousands.
const MAX_INNER: usize = 6;
const MAX_OUTER: usize = 4;

/// The reason an evaluation ended early. Boxed, so that results of expressions stay small.
#[derive(Debug)]
pub struct Trap(Box<Fault>);

#[derive(Debug)]
struct Fault {
    cause: Cause,
    span: Option<Span>,
    notes: Vec<(Span, String)>,
    /// What to do about an exception of the language.
    hint: Option<&'static str>,
    inner: Vec<Traced>,
    outer: VecDeque<Traced>,
    n_omitted: usize,
}

/// A line of the trace, and how often it came in a row.
#[derive(Debug)]
struct Traced {
    doing: Doing,
    times: usize,
}

impl Traced {
    fn line(self) -> Doing {
        let Self { mut doing, times } = self;
        if times > 1 {
            doing.text.push_str(&format!(" ({times} times)"));
        }
        doing
    }
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
            hint: None,
            inner: vec![],
            outer: VecDeque::new(),
            n_omitted: 0,
        }))
    }

    /// An exception of the language.
    pub fn exception(class: ClassId, message: impl Into<Box<str>>, span: Span) -> Self {
        let text = Arc::new(Text::new(message, super::memory::Charge::none()));
        let object = Object::new(class, Data::Throwable(Some(text)));
        let thrown = Value::Object(Arc::new(object));
        let mut trap = Self::new(Cause::Exception(thrown), Some(span));
        trap.0.hint = advice(class);
        trap
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

    /// What stopped something that the model asked for at `span` and that has a message of its own.
    pub fn of_diagnostic(fault: Diagnostic, span: Span) -> Self {
        if fault.slug == "cancelled" {
            return Self::new(Cause::Cancelled, Some(span));
        }
        let place = fault.primary.map_or(span, |label| label.span);
        let hint = fault.hints.join("; ");
        let trap = Self::limit(fault.slug, fault.message, &hint, Some(place));
        let trap = fault
            .secondary
            .into_iter()
            .fold(trap, |trap, label| trap.pointing(label.span, &label.text));
        let trap = fault
            .trace
            .into_iter()
            .fold(trap, |trap, doing| trap.during(doing.text, doing.at));
        if place == span {
            trap
        } else {
            trap.pointing(span, "asked for here")
        }
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

    /// Adds what was being done, innermost first; `{place}` in the text stands for the place.
    #[must_use]
    pub fn during(mut self, text: String, at: Option<Span>) -> Self {
        let fault = &mut *self.0;
        let doing = Doing { text, at };
        let last = fault.outer.back_mut().or(fault.inner.last_mut());
        if let Some(last) = last.filter(|last| last.doing == doing) {
            last.times += 1;
            return self;
        }
        let traced = Traced { doing, times: 1 };
        if fault.inner.len() < MAX_INNER {
            fault.inner.push(traced);
            return self;
        }
        fault.outer.push_back(traced);
        if fault.outer.len() > MAX_OUTER {
            let omitted = fault.outer.pop_front();
            fault.n_omitted += omitted.map_or(0, |traced| traced.times);
        }
        self
    }

    /// Adds another place, unless there is one already or the fault lies in it: the innermost rule explains most.
    #[must_use]
    pub fn noting(self, span: Span, text: &str) -> Self {
        let is_inside = self.0.span.is_some_and(|own| {
            own.file == span.file && span.start <= own.start && own.end <= span.end
        });
        if is_inside || !self.0.notes.is_empty() {
            return self;
        }
        self.pointing(span, text)
    }

    /// Adds another place.
    #[must_use]
    pub fn pointing(mut self, span: Span, text: &str) -> Self {
        self.0.notes.push((span, text.to_owned()));
        self
    }

    /// The message for the user.
    pub fn into_diagnostic(self) -> Diagnostic {
        let Fault {
            cause,
            span,
            notes,
            hint: advice,
            inner,
            outer,
            n_omitted,
        } = *self.0;
        let (slug, message, hint) = match cause {
            Cause::Exception(value) => {
                let advice = advice.map(str::to_owned);
                ("exception", value.to_string(), advice)
            }
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
        diagnostic
            .hints
            .extend(hint.filter(|hint| !hint.is_empty()));
        let lines = |traced: Vec<Traced>| traced.into_iter().map(Traced::line);
        diagnostic.trace.extend(lines(inner));
        if n_omitted > 0 {
            diagnostic = diagnostic.during(format!("… {n_omitted} more"));
        }
        diagnostic.trace.extend(lines(outer.into()));
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
        let is_loop = class == ClassId::IllegalArgumentException;
        let mut trap = Self::exception(class, message, Span::default());
        trap.0.span = None;
        if is_loop {
            trap.0.hint = Some(
                "does a label stand twice in a row on the right-hand side, or `^` behind `==>` (there `==>>` is meant)? \
                 the whole step is dropped",
            );
        }
        trap
    }
}

/// What a modeller can do about an exception that the language threw.
fn advice(class: ClassId) -> Option<&'static str> {
    Some(match class {
        ClassId::NullPointerException => {
            "test it with `!= null` before: a variable without a value, and `first` or `selectWhere` of nothing, are null"
        }
        ClassId::ArithmeticException => {
            "whole numbers cannot be divided by 0: test the divisor, or divide as `double`: `1.0 * a / b`"
        }
        ClassId::ArrayIndexOutOfBoundsException
        | ClassId::IndexOutOfBoundsException
        | ClassId::StringIndexOutOfBoundsException => "indices go from 0 to the length less 1",
        ClassId::ClassCastException => "test it with `instanceof` before",
        ClassId::NumberFormatException => {
            "a number has a point and no unit, such as `1.5`: `replace(',', '.')` and `trim()` mend a text"
        }
        ClassId::NoSuchElementException => "ask whether there is one more before",
        _ => return None,
    })
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
            trap = trap.during(format!("in method `f{i}`"), None);
            trap = trap.during(format!("in method `f{i}`"), None);
        }
        let diagnostic = trap.into_diagnostic();
        assert_eq!(
            diagnostic.message,
            "java.lang.ArithmeticException: / by zero"
        );
        let lines: Vec<&str> = diagnostic.trace.iter().map(|d| d.text.as_str()).collect();
        assert_eq!(lines.len(), MAX_INNER + 1 + MAX_OUTER);
        assert_eq!(lines[0], "in method `f0` (2 times)");
        assert_eq!(lines[MAX_INNER], "… 20 more");
        assert_eq!(lines[MAX_INNER + MAX_OUTER], "in method `f19` (2 times)");
    }
}
