//! Functions as values: `FloatToFloat f = float t => float t * t;`, called by `f.evaluateFloat(3)`.
//!
//! A function value becomes a method whose first parameters are the variables that can be seen where it stands; what they
//! hold there is kept with the value. They cannot be assigned inside of it.

use super::Checker;
use super::context::{Context, Layer, Local};
use super::model::{Expr, ExprKind, Method, MethodId, Place, Slot, Stmt, StmtKind, Type};
use super::types::is_primitive;
use crate::diag::{Diagnostic, Span};
use crate::library::{self, ClassId};
use crate::syntax::ast;

/// The types that the names of functions are made of.
const PARTS: &[(&str, Type)] = &[
    ("Boolean", Type::Boolean),
    ("Byte", Type::Byte),
    ("Short", Type::Short),
    ("Char", Type::Char),
    ("Int", Type::Int),
    ("Long", Type::Long),
    ("Float", Type::Float),
    ("Double", Type::Double),
    ("Object", Type::Object),
];

/// A function from one type to another.
fn function(from: Type, to: Type) -> Type {
    Type::Generic(ClassId::Function, Box::new([from, to]))
}

/// The function type of this name: `FloatToFloat`, `ObjectToInt`.
pub(super) fn named(name: &str) -> Option<Type> {
    let (from, to) = name.split_once("To")?;
    let part = |name: &str| {
        let found = PARTS.iter().find(|(part, _)| *part == name);
        found.map(|(_, ty)| ty.clone())
    };
    Some(function(part(from)?, part(to)?))
}

/// The name of a function type, if it is one.
pub(super) fn name_of(class: ClassId, args: &[Type]) -> Option<String> {
    let part = |ty: &Type| {
        PARTS
            .iter()
            .find(|(_, part)| part == ty)
            .map(|(name, _)| *name)
    };
    match args {
        [from, to] if class == ClassId::Function => Some(format!("{}To{}", part(from)?, part(to)?)),
        _ => None,
    }
}

impl Checker<'_> {
    /// `T x => value`
    pub(super) fn closure(
        &mut self,
        param: &ast::Param,
        value: &ast::Expr,
        span: Span,
    ) -> Option<Expr> {
        let wanted = self.resolve_value_type(&param.ty);
        let this = self.cx.this.map(|id| (id, self.object_type(id)));
        let inner = Context::new(self.cx.file, this.clone());
        let outer = std::mem::replace(&mut self.cx, inner);
        self.cx.owner = outer.owner;
        let mut captured: Vec<Expr> = this
            .map(|_| self.this_value_at(span))
            .into_iter()
            .flatten()
            .collect();
        let mut params = vec![];
        for local in visible(&outer.layers) {
            let Some(ty) = local.ty.clone() else { continue };
            let slot = self.cx.slot(ty.clone(), span);
            captured.push(Expr {
                kind: ExprKind::Read(Place::Local(local.slot)),
                ty: ty.clone(),
                span,
            });
            params.push(ty);
            self.cx.declare(Local {
                slot,
                is_final: true,
                ..local.clone()
            });
        }
        self.cx.open();
        self.declare_local(&param.name, wanted.clone(), false, None);
        let value = self.value(value);
        self.check_frame();
        let frame = std::mem::take(&mut self.cx.frame);
        let this = self.cx.this;
        self.cx = outer;
        // What it reads and does is not followed any further.
        self.cx.facts.is_impure = true;
        let (wanted, value) = (wanted?, value?);
        let result = value.ty.clone();
        params.push(wanted.clone());
        let method = MethodId((self.methods.len() + self.closures.len()) as u32);
        let returned = Stmt {
            kind: StmtKind::Return(Some(value)),
            span,
        };
        self.closures.push(Method {
            name: "function value".into(),
            this,
            params,
            result: result.clone(),
            frame,
            body: Some(vec![returned]),
            span,
            name_span: span,
        });
        let part = |ty: Type| if is_primitive(&ty) { ty } else { Type::Object };
        Some(Expr {
            kind: ExprKind::Function(method, captured),
            ty: function(part(wanted), part(result)),
            span,
        })
    }

    /// `this` of the body at hand.
    fn this_value_at(&self, span: Span) -> Option<Expr> {
        self.cx.this.map(|this| self.this_value(this, span))
    }

    /// `f.evaluateFloat(x)` of a function; `None` if the method is not that of its type, which is reported.
    pub(super) fn evaluate(
        &mut self,
        function: Expr,
        member: &ast::Ident,
        mut args: Vec<Expr>,
        span: Span,
    ) -> Option<Expr> {
        let (from, to) = (function.ty.argument(0), function.ty.argument(1));
        let part = PARTS.iter().find(|(_, ty)| *ty == to);
        let wanted = format!("evaluate{}", part.map_or("Object", |(name, _)| name));
        if member.name != wanted || args.len() != 1 {
            let name = self.type_name(&function.ty);
            let message = format!("`{name}` has no method `{}` that takes this", member.name);
            let fault = Diagnostic::error("unknown-method", member.span, message);
            let argument = self.type_name(&from);
            self.report(fault.hint(format!("write `{wanted}(x)` with one `{argument}`")));
            return None;
        }
        let arg = self.assign_value(args.remove(0), &from)?;
        self.cx.facts.is_impure = true;
        let id = library::MethodId::FunctionEvaluate;
        Some(Expr {
            kind: ExprKind::LibraryMethod(id, Box::new(function), vec![arg]),
            ty: to,
            span,
        })
    }
}

/// The variables that can be seen, those of inner blocks before those that they hide left out.
fn visible(layers: &[Layer]) -> Vec<&Local> {
    let mut found: Vec<&Local> = vec![];
    for layer in layers.iter().rev() {
        if let Layer::Block(locals) = layer {
            for local in locals.iter().rev() {
                let is_hidden = found.iter().any(|known| known.name == local.name);
                if !is_hidden && local.slot != Slot(u16::MAX) {
                    found.push(local);
                }
            }
        }
    }
    found
}
