//! Java's rules about types: promotion, boxing, and what fits where.

use super::Checker;
use super::model::Type;
use crate::library::ClassId;

/// How well a value fits a place, best first. Overloads are chosen in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Fit {
    /// The same type, or a subtype, or a wider number.
    Direct,
    /// `double` for `float` (the language's own leniency), boxing and unboxing.
    Loose,
    /// Any value for a text.
    Text,
}

/// Place of a numeric type in the order of widening; `char` stands beside `short`.
fn rank(ty: &Type) -> Option<u8> {
    Some(match ty {
        Type::Byte => 1,
        Type::Short | Type::Char => 2,
        Type::Int => 3,
        Type::Long => 4,
        Type::Float => 5,
        Type::Double => 6,
        _ => return None,
    })
}

/// Whether it is a number (`char` included).
pub(super) fn is_numeric(ty: &Type) -> bool {
    rank(ty).is_some()
}

/// Whether it is a whole number (`char` included).
pub(super) fn is_integral(ty: &Type) -> bool {
    rank(ty).is_some_and(|r| r <= 4)
}

/// Whether it is a number or `boolean`.
pub(super) fn is_primitive(ty: &Type) -> bool {
    is_numeric(ty) || *ty == Type::Boolean
}

/// Whether `null` can stand for it.
pub(super) fn is_reference(ty: &Type) -> bool {
    !is_primitive(ty) && *ty != Type::Void
}

/// The type of a number after unary promotion.
pub(super) fn promote(ty: &Type) -> Type {
    match rank(ty) {
        Some(..=3) => Type::Int,
        _ => ty.clone(),
    }
}

/// The type in which two numbers are computed.
pub(super) fn promote_both(a: &Type, b: &Type) -> Type {
    if rank(a) < rank(b) {
        promote(b)
    } else {
        promote(a)
    }
}

/// Whether every value of `from` is one of `to` by Java's widening of numbers.
fn widens(from: &Type, to: &Type) -> bool {
    match (from, to) {
        (Type::Char, Type::Short) | (_, Type::Char) => false,
        _ => rank(from).zip(rank(to)).is_some_and(|(a, b)| a < b),
    }
}

/// What a boxed type holds.
pub(super) fn unboxed(ty: &Type) -> Option<Type> {
    let Type::Class(class) = ty else { return None };
    Some(match class {
        ClassId::Boolean => Type::Boolean,
        ClassId::Byte => Type::Byte,
        ClassId::Short => Type::Short,
        ClassId::Character => Type::Char,
        ClassId::Integer => Type::Int,
        ClassId::Long => Type::Long,
        ClassId::Float => Type::Float,
        ClassId::Double => Type::Double,
        _ => return None,
    })
}

/// The class that boxes a primitive type.
pub(super) fn boxed(ty: &Type) -> Option<ClassId> {
    Some(match ty {
        Type::Boolean => ClassId::Boolean,
        Type::Byte => ClassId::Byte,
        Type::Short => ClassId::Short,
        Type::Char => ClassId::Character,
        Type::Int => ClassId::Integer,
        Type::Long => ClassId::Long,
        Type::Float => ClassId::Float,
        Type::Double => ClassId::Double,
        _ => return None,
    })
}

impl Checker<'_> {
    /// Whether a reference of type `from` is always one of type `to`.
    pub(super) fn is_subtype(&self, from: &Type, to: &Type) -> bool {
        match (from, to) {
            (Type::Null, to) => is_reference(to),
            (from, Type::Object) => is_reference(from),
            (Type::Node(a), Type::Node(b)) => self.types.is_a(*a, *b),
            (Type::Node(a) | Type::Instance(a), Type::Instance(b)) => self.is_kind_of(*a, *b),
            (Type::Node(a) | Type::Instance(a), Type::Class(b) | Type::Generic(b, _)) => {
                let library = self.library_class(*a);
                library.is_some_and(|class| class.is_a(*b)) || self.implements_library(*a, *b)
            }
            (Type::Array(a), Type::Array(b)) => a == b || is_reference(a) && self.is_subtype(a, b),
            (Type::Generic(ClassId::Function, a), Type::Generic(ClassId::Function, b)) => a == b,
            // Of types of which one does not say what it holds, only the classes count.
            (Type::Generic(a, of_a), Type::Generic(b, of_b)) => {
                let is_open = |ty: &Type| *ty == Type::Object;
                let mut pairs = of_a.iter().zip(of_b.iter());
                a.is_a(*b)
                    && pairs
                        .all(|(x, y)| x == y || is_open(x) || is_open(y) || self.is_subtype(x, y))
            }
            (Type::Class(a) | Type::Generic(a, _), Type::Class(b) | Type::Generic(b, _)) => {
                a.is_a(*b)
            }
            (from, to) => from == to,
        }
    }

    /// How a value of type `from` fits where `to` is wanted, if it does.
    pub(super) fn fit(&self, from: &Type, to: &Type) -> Option<Fit> {
        if from == to || widens(from, to) || self.is_subtype(from, to) {
            return Some(Fit::Direct);
        }
        let is_loose = match (from, to) {
            (Type::Double, Type::Float) => true,
            (from, to) if is_primitive(from) => boxed(from).is_some_and(|class| {
                *to == Type::Object || self.is_subtype(&Type::Class(class), to)
            }),
            (from, to) => unboxed(from).is_some_and(|inner| inner == *to || widens(&inner, to)),
        };
        is_loose.then_some(Fit::Loose)
    }

    /// Whether `(to) value` can make sense.
    pub(super) fn is_castable(&self, from: &Type, to: &Type) -> bool {
        if is_primitive(from) && is_primitive(to) {
            return (*from == Type::Boolean) == (*to == Type::Boolean);
        }
        if self.fit(from, to).is_some() {
            return true;
        }
        match (from, to) {
            (Type::Object, _) => *to != Type::Void,
            (Type::Instance(a), Type::Node(_) | Type::Instance(_))
                if self.class_info(*a).is_some_and(|class| class.is_interface) =>
            {
                true
            }
            (Type::Class(ClassId::Number), to) => is_numeric(to) || self.is_subtype(to, from),
            _ => is_reference(from) && self.is_subtype(to, from),
        }
    }

    /// The type as the user writes it.
    pub(super) fn type_name(&self, ty: &Type) -> String {
        match ty {
            Type::Void => "void".into(),
            Type::Null => "null".into(),
            Type::Boolean => "boolean".into(),
            Type::Byte => "byte".into(),
            Type::Short => "short".into(),
            Type::Char => "char".into(),
            Type::Int => "int".into(),
            Type::Long => "long".into(),
            Type::Float => "float".into(),
            Type::Double => "double".into(),
            Type::String => "String".into(),
            Type::Node(id) | Type::Instance(id) => self.types[*id].name.to_string(),
            Type::Class(class) => class.name().into(),
            Type::Generic(class, args) => super::closure::name_of(*class, args)
                .unwrap_or_else(|| format!("{}<{}>", class.name(), self.type_names(args))),
            Type::Array(element) => format!("{}[]", self.type_name(element)),
            Type::Object => "Object".into(),
        }
    }

    /// Several types, as in the head of a method.
    pub(super) fn type_names<'t>(&self, types: impl IntoIterator<Item = &'t Type>) -> String {
        let names: Vec<String> = types.into_iter().map(|ty| self.type_name(ty)).collect();
        names.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn promotion_follows_java() {
        assert_eq!(promote_both(&Type::Byte, &Type::Char), Type::Int);
        assert_eq!(promote_both(&Type::Long, &Type::Int), Type::Long);
        assert_eq!(promote_both(&Type::Long, &Type::Float), Type::Float);
        assert_eq!(promote_both(&Type::Float, &Type::Double), Type::Double);
    }

    #[test]
    fn widening_is_one_way_and_char_stands_alone() {
        assert!(widens(&Type::Char, &Type::Int) && widens(&Type::Long, &Type::Float));
        assert!(!widens(&Type::Byte, &Type::Char) && !widens(&Type::Char, &Type::Short));
        assert!(!widens(&Type::Double, &Type::Float));
    }
}
