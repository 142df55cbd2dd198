//! Getters and setters of nodes that no table lists: `getX()`, `isX()`, `setX(v)` of every property, and a few that set
//! several properties at once.

use super::Checker;
use super::call::Callee;
use super::model::{Constant, Expr, ExprKind, Operator, Place, Stmt, StmtKind, Type};
use super::names::Target;
use super::overload::{Overload, Wanted};
use crate::diag::Span;
use crate::graph::{FieldId, TypeId};
use crate::library::{ClassId, ConstructorId};
use std::borrow::Cow;

/// A getter or setter.
#[derive(Clone, Copy, Debug)]
pub(super) enum Accessor {
    Get(FieldId),
    Set(FieldId),
    /// Sets these from as many numbers.
    SetAll(&'static [&'static str]),
    /// `setColor(r, g, b)`: a new shader of that colour.
    SetColor,
    /// `setColor(0xRRGGBB)`: likewise.
    SetColorBits,
    /// `setAxis(x, y, z)` of a parallelogram: half its width as three numbers.
    SetAxis,
    /// `getAxis()` of a parallelogram: half its width as a vector.
    GetAxis,
}

const TRANSLATION: &[&str] = &["transform.x", "transform.y", "transform.z"];

/// `getLength` → `length`; `None` if it does not begin with the prefix.
fn property_name(name: &str, prefix: &str) -> Option<String> {
    let rest = name.strip_prefix(prefix)?;
    let mut letters = rest.chars();
    let first = letters.next().filter(|c| c.is_uppercase())?;
    Some(first.to_lowercase().chain(letters).collect())
}

impl Checker<'_> {
    /// The getters and setters of a node type by this name.
    pub(super) fn accessor_overloads(&self, id: TypeId, name: &str) -> Vec<Overload<Callee>> {
        self.accessors(id, name)
            .into_iter()
            .map(|accessor| self.accessor_overload(id, accessor))
            .collect()
    }

    fn accessors(&self, id: TypeId, name: &str) -> Vec<Accessor> {
        let mut found = vec![];
        let field = |property: Option<String>| self.visible_field(id, &property?);
        let is_boolean = |field: FieldId| {
            self.fields[usize::from(id.0)][usize::from(field.0)].ty == Some(Type::Boolean)
        };
        found.extend(field(property_name(name, "get")).map(Accessor::Get));
        found.extend(
            field(property_name(name, "is"))
                .filter(|f| is_boolean(*f))
                .map(Accessor::Get),
        );
        found.extend(field(property_name(name, "set")).map(Accessor::Set));
        let has = |hidden: &str| self.types.field(id, hidden).is_some();
        match name {
            "setTransform" | "setTranslation" if has("transform.x") => {
                found.push(Accessor::SetAll(TRANSLATION));
            }
            "setColor" if has("shader") => {
                found.push(Accessor::SetColor);
                // The colour of a shoot is a number of the EGA palette.
                if self.visible_field(id, "color").is_none() {
                    found.push(Accessor::SetColorBits);
                }
            }
            "getAxis" if has("width.full") => found.push(Accessor::GetAxis),
            "setAxis" if has("width.full") => found.push(Accessor::SetAxis),
            "setOpen" if has("baseOpen") && !has("topOpen") => {
                found.push(Accessor::SetAll(&["baseOpen"]));
            }
            "setOpen" if has("baseOpen") && has("topOpen") => {
                found.push(Accessor::SetAll(&["baseOpen", "topOpen"]));
            }
            _ => {}
        }
        found
    }

    fn accessor_overload(&self, id: TypeId, accessor: Accessor) -> Overload<Callee> {
        let fields = &self.fields[usize::from(id.0)];
        let wanted = |field: FieldId| match &fields[usize::from(field.0)].ty {
            Some(ty) => Wanted::Value(ty.clone()),
            None => Wanted::Unknown,
        };
        let params = match accessor {
            Accessor::Get(_) | Accessor::GetAxis => vec![],
            Accessor::Set(field) => vec![wanted(field)],
            Accessor::SetAll(names) => names
                .iter()
                .filter_map(|n| self.types.field(id, n))
                .map(wanted)
                .collect(),
            Accessor::SetColor | Accessor::SetAxis => vec![Wanted::Value(Type::Float); 3],
            Accessor::SetColorBits => vec![Wanted::Value(Type::Int)],
        };
        let names = match accessor {
            Accessor::Set(field) => self.field_names(id, &[field]),
            Accessor::SetAll(names) => names
                .iter()
                .filter_map(|n| Some(self.field_names(id, &[self.types.field(id, n)?])))
                .flatten()
                .collect(),
            Accessor::SetColor => ["red", "green", "blue"].map(Cow::Borrowed).to_vec(),
            Accessor::SetColorBits => vec![Cow::Borrowed("rgb")],
            Accessor::SetAxis => ["x", "y", "z"].map(Cow::Borrowed).to_vec(),
            Accessor::Get(_) | Accessor::GetAxis => vec![],
        };
        Overload {
            id: Callee::Accessor(accessor),
            params,
            names,
            is_varargs: false,
        }
    }

    /// The call of a getter or setter with converted arguments.
    pub(super) fn apply_accessor(
        &mut self,
        object: Expr,
        accessor: Accessor,
        args: Vec<Expr>,
        span: Span,
    ) -> Option<Expr> {
        let Type::Node(id) = object.ty else {
            return None;
        };
        match accessor {
            Accessor::Get(field) => {
                let target = self.field_target(object, id, field)?;
                Some(self.read(target, span))
            }
            Accessor::Set(field) => {
                let mut set = self.set_field(object, id, field, args.into_iter().next()?, span)?;
                set.ty = Type::Void;
                Some(set)
            }
            Accessor::SetAll(names) => {
                let fields: Vec<FieldId> = names
                    .iter()
                    .filter_map(|name| self.types.field(id, name))
                    .collect();
                self.set_several(object, id, &fields, args, span)
            }
            Accessor::SetColor | Accessor::SetColorBits => {
                let constructor = match accessor {
                    Accessor::SetColorBits => ConstructorId::ShaderBits,
                    _ => ConstructorId::ShaderRgb,
                };
                let ty = Type::Class(ClassId::RGBAShader);
                let shader = Expr {
                    kind: ExprKind::NewObject(constructor, args),
                    ty,
                    span,
                };
                let field = self.types.field(id, "shader")?;
                let mut set = self.set_field(object, id, field, shader, span)?;
                set.ty = Type::Void;
                Some(set)
            }
            Accessor::GetAxis => self.axis(object, id, span),
            Accessor::SetAxis => self.set_axis(object, id, args, span),
        }
    }

    fn set_axis(
        &mut self,
        object: Expr,
        id: TypeId,
        mut args: Vec<Expr>,
        span: Span,
    ) -> Option<Expr> {
        let two = Expr {
            kind: ExprKind::Constant(Constant::Float(2.0)),
            ty: Type::Float,
            span,
        };
        let half = args.first_mut()?;
        let full = ExprKind::Binary {
            op: Operator::Mul,
            operands: Type::Float,
            left: Box::new(half.clone()),
            right: Box::new(two),
        };
        half.kind = full;
        let fields = ["width.full", "axis.y", "axis.z"];
        let fields: Option<Vec<FieldId>> = fields
            .iter()
            .map(|name| self.types.field(id, name))
            .collect();
        self.set_several(object, id, &fields?, args, span)
    }

    /// `object.field = value`, giving the value.
    fn set_field(
        &mut self,
        object: Expr,
        id: TypeId,
        field: FieldId,
        value: Expr,
        span: Span,
    ) -> Option<Expr> {
        let Target { place, ty, .. } = self.field_target(object, id, field)?;
        self.note_write(&place);
        Some(Expr {
            kind: ExprKind::Assign(place, Box::new(value)),
            ty,
            span,
        })
    }

    /// Sets several fields of an object that is evaluated once.
    fn set_several(
        &mut self,
        object: Expr,
        id: TypeId,
        fields: &[FieldId],
        args: Vec<Expr>,
        span: Span,
    ) -> Option<Expr> {
        let ty = object.ty.clone();
        let slot = self.cx.slot(ty.clone(), span);
        let mut body = vec![];
        for (&field, value) in fields.iter().zip(args) {
            let object = Expr {
                kind: ExprKind::Read(Place::Local(slot)),
                ty: ty.clone(),
                span,
            };
            let set = self.set_field(object, id, field, value, span)?;
            body.push(Stmt {
                kind: StmtKind::Expr(set),
                span,
            });
        }
        Some(Expr {
            kind: ExprKind::With {
                object: Box::new(object),
                slot,
                body,
            },
            ty,
            span,
        })
    }

    /// A property that is computed from others, such as `axis` of a parallelogram.
    pub(super) fn derived_property(
        &mut self,
        object: &Expr,
        id: TypeId,
        name: &str,
        span: Span,
    ) -> Option<Expr> {
        let is_axis = name == "axis" && self.types.field(id, "width.full").is_some();
        if is_axis {
            self.axis(object.clone(), id, span)
        } else {
            None
        }
    }

    /// Half the width of a parallelogram, as a vector.
    fn axis(&mut self, object: Expr, id: TypeId, span: Span) -> Option<Expr> {
        let ty = object.ty.clone();
        let slot = self.cx.slot(ty.clone(), span);
        let keep = ExprKind::Assign(Place::Local(slot), Box::new(object));
        let keep = Expr {
            kind: keep,
            ty: ty.clone(),
            span,
        };
        let mut parts = vec![];
        for name in ["width.full", "axis.y", "axis.z"] {
            let object = Expr {
                kind: ExprKind::Read(Place::Local(slot)),
                ty: ty.clone(),
                span,
            };
            let field = self.types.field(id, name)?;
            let target = self.field_target(object, id, field)?;
            let value = self.read(target, span);
            parts.push(self.convert(value, &Type::Double));
        }
        let half = Expr {
            kind: ExprKind::Constant(Constant::Double(0.5)),
            ty: Type::Double,
            span,
        };
        let (left, right) = (Box::new(parts.remove(0)), Box::new(half));
        let x = ExprKind::Binary {
            op: Operator::Mul,
            operands: Type::Double,
            left,
            right,
        };
        parts.insert(
            0,
            Expr {
                kind: x,
                ty: Type::Double,
                span,
            },
        );
        let vector = Type::Class(ClassId::Vector3d);
        let made = Expr {
            kind: ExprKind::NewObject(ConstructorId::TupleOf, parts),
            ty: vector.clone(),
            span,
        };
        Some(Expr {
            kind: ExprKind::Comma(vec![keep, made]),
            ty: vector,
            span,
        })
    }
}
