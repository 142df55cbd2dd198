//! Methods of the model that Java calls by itself: `toString`, `equals`, `hashCode`, `compareTo`, `compare`.
//!
//! The library works on boxed values and meets objects of the model inside of collections and arrays, or as `Object`; here
//! it finds what the class of such an object says about it.

use std::cmp::Ordering;

use super::machine::Machine;
use super::object::Data;
use super::program::Program;
use super::trap::Trap;
use super::value::{MAX_NESTING, Value};
use crate::check::model::{MethodId, Model, Type};
use crate::diag::Span;
use crate::library::ClassId;

/// The methods of one type that are called by Java itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hooks {
    to_string: Option<MethodId>,
    equals: Option<MethodId>,
    hash_code: Option<MethodId>,
    compare_to: Option<MethodId>,
    compare: Option<MethodId>,
}

impl Hooks {
    /// Those of each type of a model, inherited ones included; empty if no type has any.
    pub fn of(model: &Model) -> Vec<Self> {
        let find = |ty, name: &str, fits: &dyn Fn(&[Type]) -> bool| {
            let own = |wanted| {
                model.methods.iter().position(|method| {
                    let is_own = method.this == Some(wanted) && method.body.is_some();
                    is_own && method.name == name && fits(&method.params)
                })
            };
            let mut lineage = std::iter::successors(Some(ty), |&t| model.types[t].parent);
            let found = lineage.find_map(own)?;
            u32::try_from(found).ok().map(MethodId)
        };
        let is_object = |params: &[Type]| params == [Type::Object];
        let all: Vec<Self> = model
            .types
            .iter()
            .map(|(ty, _)| Self {
                to_string: find(ty, "toString", &<[Type]>::is_empty),
                equals: find(ty, "equals", &is_object),
                hash_code: find(ty, "hashCode", &<[Type]>::is_empty),
                compare_to: find(ty, "compareTo", &|params| params.len() == 1),
                compare: find(ty, "compare", &|params| params.len() == 2),
            })
            .collect();
        let has_any = |hooks: &Self| {
            let methods = [
                hooks.to_string,
                hooks.equals,
                hooks.hash_code,
                hooks.compare_to,
                hooks.compare,
            ];
            methods.iter().any(Option::is_some)
        };
        if all.iter().any(has_any) { all } else { vec![] }
    }
}

impl Program {
    /// What the type of a node or an object of the model says about it.
    fn hooks_of(&self, m: &Machine, value: &Value) -> Hooks {
        if self.hooks.is_empty() {
            return Hooks::default();
        }
        let hooks = value
            .type_in(&m.graph)
            .and_then(|ty| self.hooks.get(usize::from(ty.0)));
        hooks.copied().unwrap_or_default()
    }

    /// Appends the text of a value, at any depth of collections by the `toString()` of the model's own classes.
    pub(super) fn tell(
        &self,
        m: &mut Machine,
        value: &Value,
        out: &mut String,
        span: Span,
    ) -> Result<(), Trap> {
        if self.hooks.is_empty() {
            m.append_text(value, out);
            return Ok(());
        }
        self.tell_nested(m, value, out, span, 0)
    }

    fn tell_nested(
        &self,
        m: &mut Machine,
        value: &Value,
        out: &mut String,
        span: Span,
        depth: usize,
    ) -> Result<(), Trap> {
        m.check_text(out.len()).map_err(|trap| trap.at(span))?;
        if let Some(method) = self.hooks_of(m, value).to_string {
            let text = self.call_method(m, method, value, &[], span)?;
            m.append_text(&text, out);
            return Ok(());
        }
        let Some(parts) = Parts::of(value).filter(|_| depth < MAX_NESTING) else {
            m.append_text(value, out);
            return Ok(());
        };
        out.push(parts.open);
        for (i, (key, value)) in parts.values.iter().enumerate() {
            if i > 0 {
                out.push_str(", ");
            }
            self.tell_nested(m, key, out, span, depth + 1)?;
            if let Some(value) = value {
                out.push('=');
                self.tell_nested(m, value, out, span, depth + 1)?;
            }
        }
        out.push(parts.close);
        Ok(())
    }

    /// `a.equals(b)`
    pub(super) fn equal(
        &self,
        m: &mut Machine,
        a: &Value,
        b: &Value,
        span: Span,
    ) -> Result<bool, Trap> {
        match self.hooks_of(m, a).equals {
            Some(method) => {
                let args = [b.clone()];
                Ok(self.call_method(m, method, a, &args, span)?.as_boolean() == Some(true))
            }
            None => Ok(a.equals(b)),
        }
    }

    /// `a.hashCode()`
    pub(super) fn hash(&self, m: &mut Machine, a: &Value, span: Span) -> Result<i32, Trap> {
        match self.hooks_of(m, a).hash_code {
            Some(method) => {
                let hash = self.call_method(m, method, a, &[], span)?;
                Ok(hash.as_int().unwrap_or(0))
            }
            None => Ok(a.hash_code()),
        }
    }

    /// Whether keys of a map are compared by methods of the model.
    pub(super) fn has_own_keys(&self, m: &Machine, key: &Value) -> bool {
        let hooks = self.hooks_of(m, key);
        hooks.equals.is_some() || hooks.hash_code.is_some()
    }

    /// How two values stand to each other: by a comparator that is not null, else by their natural order.
    pub(super) fn order(
        &self,
        m: &mut Machine,
        [a, b]: [&Value; 2],
        comparator: &Value,
        span: Span,
    ) -> Result<Ordering, Trap> {
        let answer = |value: &Value| value.as_int().unwrap_or(0).cmp(&0);
        if let Some(compare) = self.hooks_of(m, comparator).compare {
            let args = [a.clone(), b.clone()];
            let found = self.call_method(m, compare, comparator, &args, span)?;
            return Ok(answer(&found));
        }
        if let Value::Object(object) = comparator {
            let inner = match &*object.lock() {
                Data::Reversed(inner) => Some(inner.clone()),
                _ => None,
            };
            return match inner {
                Some(inner) => self.order(m, [b, a], &inner, span),
                None => Err(Trap::exception(
                    ClassId::ClassCastException,
                    "this is no comparator",
                    span,
                )),
            };
        }
        if let Some(compare_to) = self.hooks_of(m, a).compare_to {
            let args = [b.clone()];
            let found = self.call_method(m, compare_to, a, &args, span)?;
            return Ok(answer(&found));
        }
        natural(a, b).ok_or_else(|| {
            let (mut left, mut right) = (String::new(), String::new());
            m.append_text(a, &mut left);
            m.append_text(b, &mut right);
            let message = format!("`{left}` and `{right}` have no order");
            Trap::exception(ClassId::ClassCastException, message, span)
        })
    }

    /// A stable sort by [`order`](Self::order).
    pub(super) fn sorted(
        &self,
        m: &mut Machine,
        mut values: Vec<Value>,
        comparator: &Value,
        span: Span,
    ) -> Result<Vec<Value>, Trap> {
        let is_plain = comparator.is_null()
            && values
                .windows(2)
                .all(|pair| natural(&pair[0], &pair[1]).is_some());
        if is_plain {
            values.sort_by(|a, b| natural(a, b).unwrap_or(Ordering::Equal));
            return Ok(values);
        }
        if values.len() < 2 {
            return Ok(values);
        }
        let right = values.split_off(values.len() / 2);
        let left = self.sorted(m, values, comparator, span)?;
        let right = self.sorted(m, right, comparator, span)?;
        let mut merged = Vec::with_capacity(left.len() + right.len());
        let (mut left, mut right) = (left.into_iter().peekable(), right.into_iter().peekable());
        while let (Some(a), Some(b)) = (left.peek(), right.peek()) {
            m.tick(span)?;
            let is_after = self.order(m, [a, b], comparator, span)? == Ordering::Greater;
            merged.extend(if is_after { right.next() } else { left.next() });
        }
        merged.extend(left);
        merged.extend(right);
        Ok(merged)
    }
}

/// What stands in a collection: its values, of maps with what belongs to them, between two signs.
struct Parts {
    open: char,
    close: char,
    values: Vec<(Value, Option<Value>)>,
}

impl Parts {
    fn of(value: &Value) -> Option<Self> {
        let list = |values: Vec<(Value, Option<Value>)>| Self {
            open: '[',
            close: ']',
            values,
        };
        match &*value.as_object()?.lock() {
            Data::List(found) => {
                let values = found.values.iter();
                Some(list(values.map(|value| (value.clone(), None)).collect()))
            }
            Data::Set(found) => {
                let entries = found.entries().into_iter();
                Some(list(entries.map(|(key, _)| (key.clone(), None)).collect()))
            }
            Data::Map(found) => {
                let entries = found.entries().into_iter();
                let entries = entries.map(|(key, value)| (key.clone(), Some(value.clone())));
                Some(Self {
                    open: '{',
                    close: '}',
                    values: entries.collect(),
                })
            }
            _ => None,
        }
    }
}

/// Java's natural order of numbers of one kind, texts, characters and truth values; `None` for others.
pub(super) fn natural(a: &Value, b: &Value) -> Option<Ordering> {
    if let (Some(a), Some(b)) = (a.as_text(), b.as_text()) {
        return Some(a.as_str().encode_utf16().cmp(b.as_str().encode_utf16()));
    }
    let is_whole = |v: &Value| !matches!(v, Value::Float(_) | Value::Double(_));
    match (a.as_long(), b.as_long(), a.as_double(), b.as_double()) {
        (Some(x), Some(y), ..) if is_whole(a) && is_whole(b) => Some(x.cmp(&y)),
        (.., Some(x), Some(y)) => Some(java_order(x, y)),
        _ => a.as_boolean().zip(b.as_boolean()).map(|(a, b)| a.cmp(&b)),
    }
}

/// `Double.compare`: -0 before 0, NaN behind all.
pub(super) fn java_order(x: f64, y: f64) -> Ordering {
    let canonical = |v: f64| if v.is_nan() { f64::NAN.abs() } else { v };
    canonical(x).total_cmp(&canonical(y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_javas_order() {
        assert_eq!(java_order(-0.0, 0.0), Ordering::Less);
        assert_eq!(java_order(-f64::NAN, f64::INFINITY), Ordering::Greater);
        assert_eq!(
            natural(&Value::Int(3), &Value::Int(2)),
            Some(Ordering::Greater)
        );
        assert_eq!(natural(&Value::Null, &Value::Int(2)), None);
    }
}
