//! What can go wrong while drawing, in words.

use super::organs::Organs;
use crate::diag::{Diagnostic, Label, Severity, Span};
use crate::scene::SceneError;

/// Other places that a message shows, at most.
const MOST_PLACES: usize = 3;

/// Why a model cannot be drawn.
pub type Failure = Box<Diagnostic>;

/// A diagnostic about something that may have no place in the model's text, such as a built-in node.
pub(super) fn diagnostic(
    severity: Severity,
    slug: &'static str,
    message: String,
    span: Option<Span>,
) -> Diagnostic {
    let primary = span.map(|span| Label {
        span,
        text: String::new(),
    });
    Diagnostic {
        severity,
        slug,
        message,
        primary,
        secondary: vec![],
        hints: vec![],
        trace: vec![],
    }
}

/// Tells why the scene of a drawn model cannot be built, naming the organ at fault.
#[must_use]
pub fn explain(error: &SceneError, organs: &Organs) -> Diagnostic {
    let organ = error.organ();
    let name = organ.and_then(|organ| organs.type_name(organ));
    let message = match name {
        Some(name) => format!("`{name}` cannot be drawn: {error}"),
        None => format!("the model cannot be drawn: {error}"),
    };
    let span = organ.and_then(|organ| organs.declared_at(organ));
    let fault = diagnostic(Severity::Error, "scene", message, span);
    match organ {
        Some(organ) => made_at(fault, organs.made_at(organ)),
        None => fault,
    }
}

/// Adds where nodes of the kind at fault are made: which of the places made this very node is not remembered.
pub(super) fn made_at(mut fault: Diagnostic, places: &[Span]) -> Diagnostic {
    let text = if places.len() == 1 {
        "made here"
    } else {
        "perhaps made here"
    };
    let mut labels = places.iter().map(|&span| Label {
        span,
        text: text.to_owned(),
    });
    if fault.primary.is_none() {
        fault.primary = labels.next();
    }
    fault.secondary.extend(labels.by_ref().take(MOST_PLACES));
    match labels.len() {
        0 => fault,
        n => fault.hint(format!("nodes of this kind are made in {n} more places")),
    }
}

/// The user wants no more.
pub(super) fn stopped() -> Failure {
    let message = "the drawing was stopped before it had finished".to_owned();
    Box::new(diagnostic(Severity::Error, "cancelled", message, None))
}

/// A size or place that is no number.
pub(super) fn not_finite(name: &str, span: Option<Span>, made: &[Span]) -> Failure {
    let message = format!("{name} has a size or place that is not a finite number");
    let hint =
        "look for a division by 0, a root of a negative number or an overflow in its parameters";
    let fault = diagnostic(Severity::Error, "not-finite", message, span);
    Box::new(made_at(fault, made).hint(hint))
}

/// More geometry than fits.
pub(super) fn too_much(name: &str, limit: u64, span: Option<Span>) -> Failure {
    let message = format!("the geometry needs more than {limit} bytes; {name} was one too many");
    Box::new(
        diagnostic(Severity::Error, "geometry-limit", message, span)
            .hint("draw equal parts once and repeat them with `Instance`, or allow more memory"),
    )
}

/// A file of meshes that cannot be drawn.
pub(super) fn mesh_file(name: &str, file: &str, why: &str, made: &[Span]) -> Failure {
    let message = format!("{name} cannot draw `{file}`: {why}");
    let fault = diagnostic(Severity::Error, "mesh-file", message, None);
    Box::new(made_at(fault, made))
}

/// A picture that cannot be drawn.
pub(super) fn picture(
    name: &str,
    file: &str,
    why: &str,
    hint: Option<String>,
    made: &[Span],
) -> Failure {
    let message = format!("{name} wears the picture `{file}`, which cannot be used: {why}");
    let fault = made_at(diagnostic(Severity::Error, "picture", message, None), made);
    Box::new(match hint {
        Some(hint) => fault.hint(hint),
        None => fault,
    })
}

/// A curved surface that cannot be drawn.
pub(super) fn curved(name: &str, why: &str, made: &[Span]) -> Failure {
    let message = format!("{name} cannot be drawn: {why}");
    let fault = diagnostic(Severity::Error, "curved-surface", message, None);
    Box::new(made_at(fault, made))
}

/// A file that the model may not use.
pub(super) fn file_refused(message: String, hint: String, made: &[Span]) -> Failure {
    let fault = diagnostic(Severity::Error, "file-access", message, None);
    Box::new(made_at(fault, made).hint(hint))
}

/// Bodies nested without end.
pub(super) fn too_deep(name: &str, limit: usize, span: Option<Span>) -> Failure {
    let message = format!("the body of {name} stands in bodies {limit} deep");
    Box::new(
        diagnostic(Severity::Error, "body-depth", message, span)
            .hint("a body that makes its own module again needs an `if` that ends it"),
    )
}

/// Bodies that make nodes without end.
pub(super) fn too_many_body_nodes(name: &str, limit: u64, span: Option<Span>) -> Failure {
    let message = format!("bodies of modules make more than {limit} nodes; {name} was one of them");
    Box::new(
        diagnostic(Severity::Error, "body-limit", message, span)
            .hint("does a loop in a body make too many, or a body itself again?"),
    )
}

/// An instance within what it draws.
pub(super) fn endless_instance(span: Option<Span>) -> Failure {
    let message = "an `Instance` draws a part of the model that contains itself".to_owned();
    Box::new(
        diagnostic(Severity::Error, "instance-cycle", message, span)
            .hint("hang the prototype on a place of its own, such as a branch of the root"),
    )
}

/// Instances of instances without end.
pub(super) fn instances_too_deep(limit: usize, span: Option<Span>) -> Failure {
    let message = format!("instances are nested more than {limit} deep");
    Box::new(diagnostic(Severity::Error, "instance-depth", message, span))
}

/// An instance of a node that is gone.
pub(super) fn instance_of_nothing(span: Option<Span>) -> Failure {
    let message = "an `Instance` draws a node that is no longer part of the graph".to_owned();
    Box::new(
        diagnostic(Severity::Error, "instance-gone", message, span)
            .hint("link the prototype to the graph, for example `^ [Hidden prototype:Tree]`"),
    )
}
