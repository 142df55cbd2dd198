//! Arrays that are read and written where a variable holds them, without counting references.

use super::Scope;
use crate::check::model::{Expr, ExprKind, Place, StaticId};
use crate::eval::machine::Machine;
use crate::eval::stack::Local;
use crate::eval::value::Value;

/// The variable that holds an array.
#[derive(Clone, Copy)]
pub(super) enum Held {
    Local(u32),
    Static(u32),
}

impl Held {
    /// The array where it stands; no reference is counted.
    #[inline]
    pub(super) fn array(self, m: &Machine) -> &Value {
        match self {
            Self::Local(at) => m.stack.value(at),
            Self::Static(at) => &m.statics.values[at as usize],
        }
    }
}

impl Scope<'_> {
    /// The variable that an expression reads an object from.
    pub(super) fn held(&self, e: &Expr) -> Option<Held> {
        let ExprKind::Read(place) = &e.kind else {
            return None;
        };
        match place {
            Place::Local(slot) => match self.local(*slot) {
                Local::Value(at) => Some(Held::Local(at)),
                Local::Word(_) => None,
            },
            Place::Static(StaticId(id)) => match self.static_local(*id) {
                Local::Value(at) => Some(Held::Static(at)),
                Local::Word(_) => None,
            },
            Place::Field(..) | Place::Element(..) | Place::Member(..) => None,
        }
    }
}

/// Whether the evaluation of an expression changes no variable.
pub(super) fn is_still(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Constant(_) => true,
        ExprKind::Read(place) => match place {
            Place::Local(_) | Place::Static(_) => true,
            Place::Field(of, _) | Place::Member(of, ..) => is_still(of),
            Place::Element(array, index) => is_still(array) && is_still(index),
        },
        ExprKind::Convert(e)
        | ExprKind::Negate(e)
        | ExprKind::Complement(e)
        | ExprKind::Not(e)
        | ExprKind::ArrayLength(e) => is_still(e),
        ExprKind::Binary {
            left: a, right: b, ..
        }
        | ExprKind::AndThen(a, b)
        | ExprKind::OrElse(a, b) => is_still(a) && is_still(b),
        ExprKind::Conditional(a, b, c) => is_still(a) && is_still(b) && is_still(c),
        _ => false,
    }
}
