//! Expressions: the dispatch, and the kinds that need no file of their own.

use super::model::{Constant, Expr, ExprKind, Type};
use super::names::{Binding, Target};
use super::types::{is_integral, is_numeric, is_primitive, is_reference, promote_both};
use super::{Checker, constant};
use crate::diag::{Diagnostic, Span};
use crate::graph::TypeId;
use crate::library::{self, ClassId};
use crate::syntax::ast;

impl Checker<'_> {
    /// The expression, checked; `None` if it is wrong, which is reported already.
    pub(super) fn expr(&mut self, e: &ast::Expr) -> Option<Expr> {
        let span = e.span;
        match &e.kind {
            ast::ExprKind::Literal(literal) => {
                let kind = ExprKind::Constant(constant::literal_value(literal));
                Some(Expr {
                    kind,
                    ty: constant::literal_type(literal),
                    span,
                })
            }
            ast::ExprKind::Name(name) => self.name(name, span),
            ast::ExprKind::This => self.this(span),
            ast::ExprKind::Super => {
                self.report(Diagnostic::error(
                    "bare-super",
                    span,
                    "`super` must be followed by a member",
                ));
                None
            }
            ast::ExprKind::Member(object, member) => self.member(object, member, span),
            ast::ExprKind::Call(callee, args) => self.call(callee, args, span),
            ast::ExprKind::New(ty, args) => self.new_object(ty, args, span),
            ast::ExprKind::NewArray(ty, lengths, more) => self.new_array(ty, lengths, *more, span),
            ast::ExprKind::ArrayLiteral(ty, elements) => {
                self.array_literal(ty.as_ref(), elements, span)
            }
            ast::ExprKind::Index(object, index) => self.index(object, index, span),
            ast::ExprKind::With(object, body) => {
                let object = self.expr(object)?;
                self.with(object, body, span)
            }
            ast::ExprKind::Unary(op, operand) => self.unary(*op, operand, span),
            ast::ExprKind::IncDec {
                target,
                is_increment,
                is_prefix,
            } => self.inc_dec(target, if *is_increment { 1 } else { -1 }, *is_prefix, span),
            ast::ExprKind::Binary(..) => self.binary(e),
            ast::ExprKind::Conditional(cond, yes, no) => self.conditional(cond, yes, no, span),
            ast::ExprKind::Assign(op, target, value) => self.assign(*op, target, value, span),
            ast::ExprKind::Deferred(op, target, value) => self.deferred(*op, target, value, span),
            ast::ExprKind::Cast(ty, value) => self.cast(ty, value, span),
            ast::ExprKind::InstanceOf(value, ty) => self.instance_of(value, ty, span),
            ast::ExprKind::Range(from, to) => self.range(from, to, span),
            ast::ExprKind::Query(pattern) => self.query(pattern, span),
            ast::ExprKind::Comma(all) => self.comma(all, span),
            ast::ExprKind::Lambda(param, value) => self.closure(param, value, span),
            ast::ExprKind::Broken => None,
        }
    }

    /// All of them; `None` if one is wrong, after all have been looked at.
    pub(super) fn exprs(&mut self, all: &[ast::Expr]) -> Option<Vec<Expr>> {
        let checked: Vec<Option<Expr>> = all.iter().map(|e| self.value(e)).collect();
        checked.into_iter().collect()
    }

    /// An expression that must have a value.
    pub(super) fn value(&mut self, e: &ast::Expr) -> Option<Expr> {
        let checked = self.expr(e)?;
        if checked.ty == Type::Void {
            self.report(
                Diagnostic::error("void-value", e.span, "this gives no value").label("is `void`"),
            );
            return None;
        }
        Some(checked)
    }

    fn name(&mut self, name: &str, span: Span) -> Option<Expr> {
        if name == "^" {
            return Some(Expr {
                kind: ExprKind::Root,
                ty: Type::Node(self.root_type()),
                span,
            });
        }
        match self.lookup(name, span) {
            Some(Binding::Target(target)) => Some(self.read(target, span)),
            Some(Binding::Value(value)) => Some(value),
            Some(Binding::Poisoned) => None,
            None => {
                let fault = self.unknown_variable(name, span)?;
                self.report(fault);
                None
            }
        }
    }

    /// The type of the root node.
    pub(super) fn root_type(&self) -> TypeId {
        self.types
            .iter()
            .find(|(_, ty)| &*ty.name == "RGGRoot")
            .map_or(self.node, |(id, _)| id)
    }

    /// The value at a place.
    pub(super) fn read(&mut self, target: Target, span: Span) -> Expr {
        self.note_read(&target.place, &target.ty);
        Expr {
            kind: ExprKind::Read(target.place),
            ty: target.ty,
            span,
        }
    }

    /// The first module that declares a field of this name.
    fn owner_of_field(&self, name: &str) -> Option<String> {
        let mut modules = self.modules.iter().filter(|module| module.class.is_none());
        let owner = modules.find(|module| {
            super::declare::own_fields(module.ast).any(|(_, ident, _)| ident.name == name)
        })?;
        Some(owner.ast.name.name.clone())
    }

    /// The fault of a name that is no variable; `None` if it is one of a thing refused before.
    fn unknown_variable(&self, name: &str, span: Span) -> Option<Diagnostic> {
        if self.refused.contains(name) || self.cx.this.is_some_and(|this| self.is_orphan(this)) {
            return None;
        }
        let fault = Diagnostic::error("unknown-name", span, format!("unknown variable `{name}`"));
        if self.node_type(name).is_some() || ClassId::named(name).is_some() {
            return Some(
                fault
                    .label("this is a type")
                    .hint(match self.node_type(name) {
                        Some(_) => format!(
                            "write `(* {name} *)` for all there are, `new {name}(…)` for a new one"
                        ),
                        None => format!("write `new {name}(…)` to make one"),
                    }),
            );
        }
        if let Some(owner) = self.owner_of_field(name) {
            let letter = owner.chars().next().map_or('x', |c| c.to_ascii_lowercase());
            return Some(fault.label("no such variable here").hint(format!(
                "`{name}` belongs to `{owner}`: match a node, `{letter}:{owner}`, and write `{letter}[{name}]`"
            )));
        }
        if self.method_names.contains_key(name) || !library::functions_named("", name).is_empty() {
            return Some(
                fault
                    .label("this is a function")
                    .hint(format!("write `{name}()` to call it")),
            );
        }
        if library::constant("Math", name).is_some() {
            return Some(fault.hint(format!("write `Math.{name}`")));
        }
        let locals = self.cx.local_names();
        let statics = self.statics.iter().map(|s| s.name);
        let fields: Vec<&str> = match self.cx.this {
            Some(this) => self.types[this].fields.iter().map(|f| &*f.name).collect(),
            None => vec![],
        };
        let constants = library::constants()
            .iter()
            .filter(|c| c.owner.is_empty())
            .map(|c| c.name);
        let all = locals
            .iter()
            .map(String::as_str)
            .chain(fields)
            .chain(statics)
            .chain(constants);
        Some(self.did_you_mean(fault.label("no such variable"), name, all))
    }

    fn this(&mut self, span: Span) -> Option<Expr> {
        let Some(this) = self.cx.this else {
            let fault = Diagnostic::error("no-this", span, "`this` has no meaning here");
            self.report(fault.hint("`this` is the node inside methods and bodies of modules"));
            return None;
        };
        Some(self.this_value(this, span))
    }

    /// `x.( … )` after `x` has been checked.
    pub(super) fn with(&mut self, object: Expr, body: &[ast::Stmt], span: Span) -> Option<Expr> {
        if !matches!(
            object.ty,
            Type::Node(_) | Type::Instance(_) | Type::Class(_) | Type::Generic(..)
        ) {
            let message = format!(
                "`.( … )` needs an object, found `{}`",
                self.type_name(&object.ty)
            );
            self.report(Diagnostic::error("with-object", object.span, message));
            return None;
        }
        let (ty, slot) = (object.ty.clone(), self.cx.slot(object.ty.clone(), span));
        self.cx
            .layers
            .push(super::context::Layer::With(slot, ty.clone()));
        self.cx.open();
        let body = self.stmts(body);
        self.cx.close();
        self.cx.close();
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

    fn conditional(
        &mut self,
        cond: &ast::Expr,
        yes: &ast::Expr,
        no: &ast::Expr,
        span: Span,
    ) -> Option<Expr> {
        let (cond, yes, no) = (self.value(cond), self.value(yes), self.value(no));
        let cond = cond.and_then(|c| self.boolean(c));
        let (cond, yes, no) = (cond?, yes?, no?);
        let ty = self.conditional_type(&yes, &no)?;
        let (yes, no) = (
            Box::new(self.convert(yes, &ty)),
            Box::new(self.convert(no, &ty)),
        );
        Some(Expr {
            kind: ExprKind::Conditional(Box::new(cond), yes, no),
            ty,
            span,
        })
    }

    /// The type of `c ? yes : no` (JLS §15.25); reported if the two do not go together.
    fn conditional_type(&mut self, yes: &Expr, no: &Expr) -> Option<Type> {
        let (a, b) = (&yes.ty, &no.ty);
        if a == b {
            return Some(a.clone());
        }
        let plain = |ty: &Type| super::types::unboxed(ty).unwrap_or_else(|| ty.clone());
        let (x, y) = (plain(a), plain(b));
        if x == y && is_primitive(&x) {
            return Some(x);
        }
        if is_numeric(&x) && is_numeric(&y) {
            // A constant int takes the smaller type of the other side if it fits there: `false ? 1 : 'a'` is a char.
            let fits = |value: &Expr, small: &Type| {
                let Some(Constant::Int(v)) = constant::value_of(value) else {
                    return false;
                };
                value.ty == Type::Int
                    && constant::convert(&Constant::Int(v), small) == Some(Constant::Int(v))
            };
            let is_small = |ty: &Type| matches!(ty, Type::Byte | Type::Short | Type::Char);
            return Some(match () {
                () if is_small(&y) && fits(yes, &y) => y,
                () if is_small(&x) && fits(no, &x) => x,
                () => promote_both(&x, &y),
            });
        }
        if is_reference(a) && self.is_subtype(b, a) {
            return Some(a.clone());
        }
        if is_reference(b) && self.is_subtype(a, b) {
            return Some(b.clone());
        }
        if let (Type::Node(_), Type::Node(_)) = (a, b) {
            return Some(Type::Node(self.node));
        }
        if is_reference(a) && is_reference(b) {
            return Some(Type::Object);
        }
        let fault = self.mismatch(b, a, no.span);
        self.report(fault.also(yes.span, format!("this is `{}`", self.type_name(a))));
        None
    }

    fn cast(&mut self, ty: &ast::TypeRef, value: &ast::Expr, span: Span) -> Option<Expr> {
        let (ty, value) = (self.resolve_value_type(ty), self.value(value));
        let (ty, value) = (ty?, value?);
        if !self.is_castable(&value.ty, &ty) {
            let message = format!(
                "`{}` cannot be cast to `{}`",
                self.type_name(&value.ty),
                self.type_name(&ty)
            );
            self.report(Diagnostic::error("bad-cast", span, message));
            return None;
        }
        if is_primitive(&ty) {
            // From `Object` and `Number` by way of the boxed type.
            let is_open = value.ty == Type::Object || value.ty == Type::Class(ClassId::Number);
            if let (true, Some(class)) = (is_open, super::types::boxed(&ty)) {
                let boxed = Type::Class(class);
                let value = Expr {
                    kind: ExprKind::Cast(Box::new(value)),
                    ty: boxed,
                    span,
                };
                return Some(self.convert(value, &ty));
            }
            let mut value = self.convert(value, &ty);
            value.span = span;
            return Some(value);
        }
        if is_primitive(&value.ty) {
            return Some(self.convert(value, &ty));
        }
        if self.is_subtype(&value.ty, &ty) {
            // Only the static type changes; overloads and members are then those of `ty`.
            return Some(Expr { ty, span, ..value });
        }
        Some(Expr {
            kind: ExprKind::Cast(Box::new(value)),
            ty,
            span,
        })
    }

    fn instance_of(&mut self, value: &ast::Expr, ty: &ast::TypeRef, span: Span) -> Option<Expr> {
        let (ty, value) = (self.resolve_value_type(ty), self.value(value));
        let (ty, value) = (ty?, value?);
        if !is_reference(&value.ty) || !is_reference(&ty) {
            let message = format!(
                "`instanceof` needs objects, found `{}`",
                self.type_name(&value.ty)
            );
            self.report(Diagnostic::error("bad-instanceof", span, message));
            return None;
        }
        Some(Expr {
            kind: ExprKind::InstanceOf(Box::new(value), ty),
            ty: Type::Boolean,
            span,
        })
    }

    fn comma(&mut self, all: &[ast::Expr], span: Span) -> Option<Expr> {
        let (last, first) = all.split_last()?;
        let first: Vec<Option<Expr>> = first.iter().map(|e| self.expr(e)).collect();
        let last = self.expr(last);
        let mut all: Vec<Expr> = first.into_iter().collect::<Option<_>>()?;
        let last = last?;
        let ty = last.ty.clone();
        all.push(last);
        Some(Expr {
            kind: ExprKind::Comma(all),
            ty,
            span,
        })
    }

    fn new_array(
        &mut self,
        ty: &ast::TypeRef,
        lengths: &[ast::Expr],
        more: u8,
        span: Span,
    ) -> Option<Expr> {
        let (ty, lengths) = (self.resolve_value_type(ty), self.exprs(lengths));
        let (ty, lengths) = (ty?, lengths?);
        let n_dims = lengths.len() + usize::from(more);
        let lengths: Option<Vec<Expr>> =
            lengths.into_iter().map(|length| self.int(length)).collect();
        let ty = (0..n_dims).fold(ty, |element, _| Type::Array(Box::new(element)));
        Some(Expr {
            kind: ExprKind::NewArray(lengths?),
            ty,
            span,
        })
    }

    fn array_literal(
        &mut self,
        ty: Option<&ast::TypeRef>,
        elements: &[ast::Expr],
        span: Span,
    ) -> Option<Expr> {
        let Some(ty) = ty else {
            let fault =
                Diagnostic::error("bare-array", span, "the type of this array is not known");
            self.report(fault.hint("write `new T[] { … }`"));
            return None;
        };
        let ty = self.resolve_value_type(ty)?;
        self.array_of(&ty, elements, span)
    }

    /// `{ a, b, c }` as an array of type `ty`.
    fn array_of(&mut self, ty: &Type, elements: &[ast::Expr], span: Span) -> Option<Expr> {
        let Type::Array(element) = ty else {
            let message = format!("expected `{}`, found an array", self.type_name(ty));
            self.report(Diagnostic::error("type-mismatch", span, message));
            return None;
        };
        let elements: Vec<Option<Expr>> = elements
            .iter()
            .map(|e| self.initial_value(e, element))
            .collect();
        let elements = elements.into_iter().collect::<Option<Vec<Expr>>>()?;
        Some(Expr {
            kind: ExprKind::ArrayLiteral(elements),
            ty: ty.clone(),
            span,
        })
    }

    /// A value for a variable of type `ty`; a bare `{ … }` is an array of that type.
    pub(super) fn initial_value(&mut self, e: &ast::Expr, ty: &Type) -> Option<Expr> {
        if let ast::ExprKind::ArrayLiteral(None, elements) = &e.kind {
            return self.array_of(ty, elements, e.span);
        }
        let value = self.value(e)?;
        self.assign_value(value, ty)
    }

    fn new_object(&mut self, ty: &ast::TypeRef, args: &[ast::Expr], span: Span) -> Option<Expr> {
        let (ty, args) = (self.resolve_value_type(ty), self.exprs(args));
        match (ty?, args?) {
            (Type::Node(id), args) => self.new_node(id, args, span),
            (Type::Instance(id), args) => self.new_instance(id, args, span),
            (Type::Class(class), args) => self.new_library_object(class, args, span),
            (Type::Generic(class, of), args) => {
                let made = self.new_library_object(class, args, span)?;
                let ty = Type::Generic(class, of);
                Some(Expr { ty, ..made })
            }
            (Type::String, args) => self.new_string(args, span),
            (ty, _) => {
                let message = format!("`{}` cannot be made with `new`", self.type_name(&ty));
                self.report(Diagnostic::error("bad-new", span, message));
                None
            }
        }
    }

    /// A new node of a type, from constructor arguments that are checked already.
    pub(super) fn new_node(&mut self, id: TypeId, args: Vec<Expr>, span: Span) -> Option<Expr> {
        if self.types[id].is_abstract {
            let message = format!("`{}` is abstract and cannot be made", self.types[id].name);
            self.report(
                Diagnostic::error("abstract-module", span, message)
                    .hint("make a module that extends it"),
            );
            return None;
        }
        let node = self.constructor_call(id, args, span)?;
        self.note_new(id);
        self.made_at.entry(id).or_default().push(span);
        Some(Expr {
            kind: ExprKind::NewNode(Box::new(node)),
            ty: Type::Node(id),
            span,
        })
    }

    /// `object[index]`: an array element or a property.
    fn index(&mut self, object: &ast::Expr, index: &ast::Expr, span: Span) -> Option<Expr> {
        let target = match self.index_target(object, index, span)? {
            super::member::Indexed::Target(target) => target,
            super::member::Indexed::Value(value) => return Some(value),
        };
        Some(self.read(target, span))
    }

    /// Whether an index type is allowed.
    pub(super) fn is_index(ty: &Type) -> bool {
        is_integral(ty) && *ty != Type::Long
    }
}
