//! Calls: of methods of the model, of getters and setters, of the library.

use super::Checker;
use super::context::{Body, Layer};
use super::model::{Expr, ExprKind, MethodId, Place, Slot, Type};
use super::overload::{Overload, Wanted};
use super::setter::Accessor;
use crate::diag::{Diagnostic, Span};
use crate::graph::TypeId;
use crate::library::{self, ClassId, FunctionId, ValueType};
use crate::syntax::ast;

/// What can be called.
#[derive(Clone, Copy, Debug)]
pub(super) enum Callee {
    /// A method of the model.
    Method(MethodId),
    /// A getter or setter of a node.
    Accessor(Accessor),
    /// A method of a library object.
    Library(library::MethodId),
    /// A function of the library.
    Function(FunctionId),
}

/// Overloads that are looked at together, and the object they are called on.
struct Group {
    receiver: Option<Expr>,
    overloads: Vec<Overload<Callee>>,
}

impl Checker<'_> {
    /// `f(args)`, `x.f(args)`.
    pub(super) fn call(
        &mut self,
        callee: &ast::Expr,
        args: &[ast::Expr],
        span: Span,
    ) -> Option<Expr> {
        match &callee.kind {
            ast::ExprKind::Name(name) => {
                let is_own = self.method_names.contains_key(name);
                if !is_own && let Some(aggregate) = self.aggregate_call(name, args, span) {
                    return aggregate;
                }
                let args = self.exprs(args)?;
                self.call_name(name, callee.span, args, span)
            }
            ast::ExprKind::Member(object, member) => self.call_member(object, member, args, span),
            ast::ExprKind::Super | ast::ExprKind::This => {
                let fault = Diagnostic::error(
                    "constructor-call",
                    span,
                    "constructors cannot be called like this",
                );
                self.report(fault.hint("give arguments to the parent with `extends Parent(args)`"));
                None
            }
            ast::ExprKind::Broken => None,
            _ => {
                self.report(Diagnostic::error(
                    "not-callable",
                    callee.span,
                    "this cannot be called",
                ));
                None
            }
        }
    }

    /// `f(args)`: looked for from the inside out.
    fn call_name(
        &mut self,
        name: &str,
        name_span: Span,
        args: Vec<Expr>,
        span: Span,
    ) -> Option<Expr> {
        let mut groups = self.groups(name, span);
        groups.retain(|group| !group.overloads.is_empty());
        let Some(first) = groups
            .iter()
            .position(|g| self.any_takes(&g.overloads, &args))
            .or((!groups.is_empty()).then_some(0))
        else {
            let fault = self.unknown_function(name, name_span)?;
            self.report(fault);
            return None;
        };
        let Group {
            receiver,
            overloads,
        } = groups.swap_remove(first);
        let (callee, args) = self.choose(name, span, &overloads, args)?;
        self.note_callee(callee, name_span);
        self.apply(callee, receiver, args, true, span)
    }

    /// What `name` could call, innermost first.
    fn groups(&self, name: &str, span: Span) -> Vec<Group> {
        let mut groups = vec![];
        let in_slot = |slot: Slot, ty: &Type| Expr {
            kind: ExprKind::Read(Place::Local(slot)),
            ty: ty.clone(),
            span,
        };
        for layer in self.cx.layers.iter().rev() {
            if let Layer::With(slot, ty) = layer {
                let overloads = self.object_overloads(ty, name);
                groups.push(Group {
                    receiver: Some(in_slot(*slot, ty)),
                    overloads,
                });
            }
        }
        if let Some(this) = self.cx.this {
            let ty = self.object_type(this);
            let overloads = self.object_overloads(&ty, name);
            groups.push(Group {
                receiver: Some(in_slot(Slot(0), &ty)),
                overloads,
            });
        }
        let of_files = self.method_names.get(name).map_or(&[][..], Vec::as_slice);
        let of_files = of_files
            .iter()
            .copied()
            .filter(|m| self.methods[m.0 as usize].owner.is_none());
        let (here, elsewhere): (Vec<_>, Vec<_>) =
            of_files.partition(|m| self.methods[m.0 as usize].file == self.cx.file);
        for methods in [here, elsewhere] {
            let overloads = methods
                .into_iter()
                .map(|m| self.method_overload(m))
                .collect();
            groups.push(Group {
                receiver: None,
                overloads,
            });
        }
        let imports = self
            .files
            .get(self.cx.file)
            .map_or(&[][..], |f| &f.static_imports);
        for owner in std::iter::once("").chain(imports.iter().copied()) {
            groups.push(Group {
                receiver: None,
                overloads: self.function_overloads(owner, name),
            });
        }
        groups
    }

    fn function_overloads(&self, owner: &str, name: &str) -> Vec<Overload<Callee>> {
        let owner = match owner {
            "Library" => "",
            "StrictMath" => "Math",
            owner => owner,
        };
        let all = library::functions_named(owner, name).iter();
        all.map(|&id| Overload::of_signature(Callee::Function(id), id.signature(), self, None))
            .collect()
    }

    fn method_overload(&self, id: MethodId) -> Overload<Callee> {
        let method = &self.methods[id.0 as usize];
        let wanted = |ty: &Option<Type>| ty.clone().map_or(Wanted::Unknown, Wanted::Value);
        let params = method.params.iter().map(wanted).collect();
        Overload {
            id: Callee::Method(id),
            params,
            names: method.param_names(),
            is_varargs: method.is_varargs,
        }
    }

    /// All that `object.name(…)` could mean, for an object of type `ty`.
    pub(super) fn object_overloads(&self, ty: &Type, name: &str) -> Vec<Overload<Callee>> {
        let mut found = vec![];
        let mut owners: Vec<&'static str> = vec![];
        match ty {
            Type::Node(id) | Type::Instance(id) => {
                if matches!(ty, Type::Node(_)) {
                    owners.push("Node");
                }
                let mut lineage: Vec<TypeId> =
                    std::iter::successors(Some(*id), |t| self.types[*t].parent).collect();
                lineage.extend(self.interfaces_of(*id));
                owners.extend(
                    self.library_class(*id)
                        .into_iter()
                        .flat_map(|class| class.lineage().map(ClassId::name)),
                );
                let own = self.method_names.get(name).map_or(&[][..], Vec::as_slice);
                for ancestor in lineage {
                    let of = own
                        .iter()
                        .filter(|m| self.methods[m.0 as usize].owner == Some(ancestor));
                    found.extend(of.map(|m| self.method_overload(*m)));
                }
                if matches!(ty, Type::Node(_)) {
                    found.extend(self.accessor_overloads(*id, name));
                }
            }
            Type::Class(class) | Type::Generic(class, _) => {
                owners.extend(class.lineage().map(ClassId::name));
            }
            Type::String => owners.push("String"),
            Type::Array(_) => owners.push("Array"),
            Type::Object => {}
            _ => return found,
        }
        owners.push("Object");
        for owner in owners {
            let all = library::methods_named(owner, name)
                .iter()
                .filter(|m| !m.is_hidden());
            found.extend(all.map(|&id| {
                Overload::of_signature(Callee::Library(id), id.signature(), self, Some(ty))
            }));
        }
        found
    }

    /// `x.f(args)`.
    fn call_member(
        &mut self,
        object: &ast::Expr,
        member: &ast::Ident,
        args: &[ast::Expr],
        span: Span,
    ) -> Option<Expr> {
        let name = member.name.as_str();
        if let Some(owner) = self.qualifier(object) {
            let args = self.exprs(args)?;
            return self.call_static(&owner, object.span, member, args, span);
        }
        let is_super = matches!(object.kind, ast::ExprKind::Super);
        if is_super && self.cx.owner.is_none() && ["startup", "shutdown", "init"].contains(&name) {
            // What GroIMP itself does there is not for the model to see.
            self.exprs(args)?;
            return Some(Expr {
                kind: ExprKind::Comma(vec![]),
                ty: Type::Void,
                span,
            });
        }
        let (object, args) = if is_super {
            let this = self.this_type(object.span)?;
            let this = self.parent_value(this, object.span);
            (Some(this), self.exprs(args))
        } else {
            (self.value(object), self.exprs(args))
        };
        let (object, args) = (object?, args?);
        if object.ty.class() == Some(ClassId::Function) && name.starts_with("evaluate") {
            return self.evaluate(object, member, args, span);
        }
        let overloads = self.object_overloads(&object.ty, name);
        if overloads.is_empty() {
            self.report_unknown_method(&object.ty, member);
            return None;
        }
        let (callee, args) = self.choose(name, span, &overloads, args)?;
        self.note_callee(callee, member.span);
        self.apply(callee, Some(object), args, !is_super, span)
    }

    /// `Math.f(args)`, `parameters.f(args)`, `Module.f(args)`.
    fn call_static(
        &mut self,
        owner: &str,
        owner_span: Span,
        member: &ast::Ident,
        args: Vec<Expr>,
        span: Span,
    ) -> Option<Expr> {
        let name = member.name.as_str();
        let mut overloads = self.function_overloads(owner, name);
        let (file, ty) = (self.file_named(owner), self.named_type(owner));
        for &id in self.method_names.get(name).map_or(&[][..], Vec::as_slice) {
            let method = &self.methods[id.0 as usize];
            let is_member = match (method.owner, &ty) {
                (None, _) => file == Some(method.file),
                (Some(module), Some(Type::Node(ty) | Type::Instance(ty))) => {
                    method.is_static && self.types.is_a(*ty, module)
                }
                _ => false,
            };
            if is_member {
                overloads.push(self.method_overload(id));
            }
        }
        if overloads.is_empty() {
            let fault = self.unknown_static_function(owner, owner_span, member)?;
            self.report(fault);
            return None;
        }
        let (callee, args) = self.choose(name, span, &overloads, args)?;
        self.note_callee(callee, member.span);
        self.apply(callee, None, args, true, span)
    }

    /// A call with converted arguments.
    fn apply(
        &mut self,
        callee: Callee,
        receiver: Option<Expr>,
        args: Vec<Expr>,
        is_virtual: bool,
        span: Span,
    ) -> Option<Expr> {
        match callee {
            Callee::Accessor(accessor) => self.apply_accessor(receiver?, accessor, args, span),
            Callee::Function(id) => {
                self.warn_of_nothing(id, span);
                self.note_effect(id.signature().effect);
                let result = id.signature().result;
                let ty = result.to_type(self.node, args.first().map(|arg| &arg.ty));
                Some(element_of(ExprKind::Library(id, args), ty, result, span))
            }
            Callee::Library(id) => {
                let (receiver, row) = (receiver?, id.signature());
                self.note_method_effect(&receiver, row.effect);
                let ty = row.result.to_type(self.node, Some(&receiver.ty));
                let kind = ExprKind::LibraryMethod(id, Box::new(receiver), args);
                Some(element_of(kind, ty, row.result, span))
            }
            Callee::Method(id) => self.apply_method(id, receiver, args, is_virtual, span),
        }
    }

    /// A call of a method of the model.
    fn apply_method(
        &mut self,
        id: MethodId,
        receiver: Option<Expr>,
        args: Vec<Expr>,
        is_virtual: bool,
        span: Span,
    ) -> Option<Expr> {
        let method = &self.methods[id.0 as usize];
        let (name, result, is_static) = (method.name, method.result.clone(), method.is_static);
        self.cx.facts.runs.push(Body::Method(id));
        if !is_virtual && self.is_abstract(id) {
            let message = format!("`{name}` is abstract in the parent");
            self.report(Diagnostic::error("abstract-method", span, message));
            return None;
        }
        let receiver = receiver.filter(|_| !is_static).map(Box::new);
        let is_virtual = is_virtual && !is_static;
        let kind = ExprKind::Call {
            method: id,
            receiver,
            args,
            is_virtual,
        };
        Some(Expr {
            kind,
            ty: result?,
            span,
        })
    }
}

/// The value of a call; what comes out of a collection is checked to be of the type that the collection was declared with.
fn element_of(kind: ExprKind, ty: Type, result: ValueType, span: Span) -> Expr {
    let is_element = matches!(result, ValueType::Argument(_)) && ty != Type::Object;
    let inner = Expr {
        kind,
        ty: if is_element { Type::Object } else { ty.clone() },
        span,
    };
    if is_element {
        let kind = ExprKind::Cast(Box::new(inner));
        Expr { kind, ty, span }
    } else {
        inner
    }
}
