//! `a.b` and `a[b]`: members of nodes and objects, properties, array elements, and names with dots.

use super::Checker;
use super::model::{Expr, ExprKind, Place, Type};
use super::names::{Binding, Target};
use crate::diag::{Diagnostic, Span};
use crate::library::{self, ClassId, FunctionId};
use crate::syntax::ast;

/// What `a[b]` or `a.b` is.
pub(super) enum Indexed {
    /// Something that can be assigned to.
    Target(Target),
    /// A value that is only read.
    Value(Expr),
}

/// The names of `a.b.c`, outermost first; `None` if it is not made of names only.
pub(super) fn dotted(e: &ast::Expr) -> Option<Vec<&str>> {
    match &e.kind {
        ast::ExprKind::Name(name) => Some(vec![name]),
        ast::ExprKind::Member(object, member) => {
            let mut names = dotted(object)?;
            names.push(&member.name);
            Some(names)
        }
        _ => None,
    }
}

impl Checker<'_> {
    /// The class or file that the names in front of a member mean, if they mean no variable.
    pub(super) fn qualifier(&mut self, object: &ast::Expr) -> Option<String> {
        // `this` of a file, like its `INSTANCE`, is the model itself: what follows is a variable or method of the file.
        if matches!(object.kind, ast::ExprKind::This) && self.cx.owner.is_none() {
            return Some(self.files.get(self.cx.file)?.name.clone());
        }
        let names = dotted(object)?;
        if self.lookup(names[0], object.span).is_some() {
            return None;
        }
        let last = names.len() - 1;
        if names[last] == "INSTANCE" {
            return match last.checked_sub(1) {
                Some(before) => Some(names[before].trim().into()),
                None => Some(self.files.get(self.cx.file)?.name.clone()),
            };
        }
        // `Stage.LEAF.w`, `parameters.widths.length`: what stands in front of the last member is a value.
        if last > 0 && self.is_static_of(names[last - 1], names[last]) {
            return None;
        }
        if ["out", "err"].contains(&names[last]) && last > 0 && names[last - 1] == "System" {
            return Some("System.out".into());
        }
        if names[last] == "out" && last > 0 {
            return Some(names[last - 1..].join("."));
        }
        Some(names[last].trim().into())
    }

    /// Whether a file, module or class has a static variable of this name.
    fn is_static_of(&self, owner: &str, name: &str) -> bool {
        let of_file = self.file_named(owner);
        let of_type = match self.named_type(owner) {
            Some(Type::Node(id) | Type::Instance(id)) => self.static_of(id, name),
            _ => None,
        };
        of_type.is_some() || of_file.is_some_and(|f| self.find_static(name, Some(f)).is_some())
    }

    /// Whether a qualifier names something: a file, a module, a class of the library.
    pub(super) fn is_known_qualifier(&self, name: &str) -> bool {
        let is_owner = [
            "Math",
            "System",
            "System.out",
            "Attributes",
            "Graph",
            "Color",
            "String",
            "Library",
        ]
        .contains(&name);
        let has_functions = || FunctionId::ALL.iter().any(|f| f.signature().owner == name);
        is_owner
            || has_functions()
            || self.file_named(name).is_some()
            || self.named_type(name).is_some()
    }

    /// The file of this name.
    pub(super) fn file_named(&self, name: &str) -> Option<usize> {
        self.files.iter().position(|file| file.name == name)
    }

    /// `a.b` as a value.
    pub(super) fn member(
        &mut self,
        object: &ast::Expr,
        member: &ast::Ident,
        span: Span,
    ) -> Option<Expr> {
        match self.member_target(object, member, span)? {
            Indexed::Target(target) => Some(self.read(target, span)),
            Indexed::Value(value) => Some(value),
        }
    }

    /// `a.b` as a place, if it is one.
    pub(super) fn member_target(
        &mut self,
        object: &ast::Expr,
        member: &ast::Ident,
        span: Span,
    ) -> Option<Indexed> {
        let name = member.name.as_str();
        if let Some(owner) = self.qualifier(object) {
            return self.static_member(&owner, member, object.span, span);
        }
        if let ast::ExprKind::Super = object.kind {
            let this = self.this_type(object.span)?;
            let object = self.this_value(this, span);
            return self.node_member(object, name, member.span);
        }
        let object = self.value(object)?;
        self.probe_member(member, &object.ty);
        match object.ty.clone() {
            Type::Node(_) | Type::Instance(_) => self.node_member(object, name, member.span),
            Type::Array(_) if name == "length" => {
                let kind = ExprKind::ArrayLength(Box::new(object));
                Some(Indexed::Value(Expr {
                    kind,
                    ty: Type::Int,
                    span,
                }))
            }
            Type::Class(class) if library::field_named(class, name).is_some() => {
                self.library_field(object, class, name).map(Indexed::Target)
            }
            ty => {
                let message = format!("`{}` has no member `{name}`", self.type_name(&ty));
                let fault = Diagnostic::error("unknown-member", member.span, message);
                let is_method = !self.object_overloads(&ty, name).is_empty();
                let fault = if is_method {
                    fault.hint(format!("write `{name}()` to call it"))
                } else if name == "length" && !self.object_overloads(&ty, "size").is_empty() {
                    fault.hint("write `size()`: only arrays have a `length`")
                } else {
                    fault
                };
                self.report(fault);
                None
            }
        }
    }

    /// The type of `this`; reported if there is none.
    pub(super) fn this_type(&mut self, span: Span) -> Option<crate::graph::TypeId> {
        if self.cx.this.is_none() {
            let fault = Diagnostic::error("no-this", span, "`super` has no meaning here");
            self.report(fault.hint("`super` is for methods of modules"));
        }
        self.cx.this
    }

    /// The static variable `name` of a module or class, or of what it extends or implements.
    fn static_of(&self, id: crate::graph::TypeId, name: &str) -> Option<super::model::StaticId> {
        let all = self.static_names.get(name)?;
        let owner = |id: &super::model::StaticId| self.statics[id.0 as usize].owner;
        all.iter()
            .copied()
            .find(|variable| owner(variable).is_some_and(|o| self.is_kind_of(id, o)))
    }

    /// A property of a node, or a field of an object of a class.
    fn node_member(&mut self, object: Expr, name: &str, span: Span) -> Option<Indexed> {
        let (Type::Node(id) | Type::Instance(id)) = object.ty else {
            return None;
        };
        self.probe_object(name, Some(&object.ty));
        if let Some(field) = self.visible_field(id, name) {
            self.note_field(id, field, name, span);
            return self.field_target(object, id, field).map(Indexed::Target);
        }
        if let Some(own) = self.static_of(id, name) {
            self.note_static(own, span);
            return match self.static_binding(own, span) {
                Binding::Target(target) => Some(Indexed::Target(target)),
                Binding::Value(value) => Some(Indexed::Value(value)),
                Binding::Poisoned => None,
            };
        }
        if let Some(value) = self.derived_property(&object, id, name, span) {
            return Some(Indexed::Value(value));
        }
        if !self.is_orphan(id) {
            let fault = self.unknown_field(id, name, span);
            self.report(fault);
        }
        None
    }

    /// `Math.PI`, `parameters.x`, `Integer.MAX_VALUE`, `Graph.SEQUENTIAL_MODE`.
    fn static_member(
        &mut self,
        owner: &str,
        member: &ast::Ident,
        owner_span: Span,
        span: Span,
    ) -> Option<Indexed> {
        let name = member.name.as_str();
        let mut found = self.library_constant(owner, name, span);
        if found.is_none()
            && let Some(file) = self.file_named(owner)
            && let Some(id) = self.find_static(name, Some(file))
        {
            self.note_static(id, member.span);
            found = Some(self.static_binding(id, span));
        }
        if found.is_none()
            && let Some(Type::Node(module) | Type::Instance(module)) = self.named_type(owner)
        {
            let own = self.static_of(module, name);
            found = own.map(|id| {
                self.note_static(id, member.span);
                self.static_binding(id, span)
            });
        }
        match found {
            Some(Binding::Target(target)) => Some(Indexed::Target(target)),
            Some(Binding::Value(value)) => Some(Indexed::Value(value)),
            Some(Binding::Poisoned) => None,
            None => {
                let fault = self.unknown_static(owner, name, owner_span, member.span);
                self.report(fault?);
                None
            }
        }
    }

    /// The fault of `owner.name` that means nothing; `None` if the owner was refused before.
    fn unknown_static(
        &self,
        owner: &str,
        name: &str,
        owner_span: Span,
        span: Span,
    ) -> Option<Diagnostic> {
        if self.refused.contains(owner) {
            return None;
        }
        if !self.is_known_qualifier(owner) {
            return Some(self.unknown_owner(owner, owner_span));
        }
        let fault = Diagnostic::error(
            "unknown-member",
            span,
            format!("`{owner}` has no member `{name}`"),
        );
        if !library::functions_named(owner, name).is_empty() {
            return Some(fault.hint(format!("write `{name}()` to call it")));
        }
        let constants = library::constants()
            .iter()
            .filter(|c| c.owner == owner)
            .map(|c| c.name);
        let file = self.file_named(owner);
        let statics = self
            .statics
            .iter()
            .filter(|s| Some(s.file) == file)
            .map(|s| s.name);
        Some(self.did_you_mean(fault, name, constants.chain(statics)))
    }

    /// `a[b]`: an element of an array, or a property of a node.
    pub(super) fn index_target(
        &mut self,
        object: &ast::Expr,
        index: &ast::Expr,
        span: Span,
    ) -> Option<Indexed> {
        let object = self.value(object)?;
        match object.ty.clone() {
            Type::Array(element) => {
                let index = self.value(index)?;
                let index = self.unbox(index);
                if !Self::is_index(&index.ty) {
                    let fault = self.mismatch(&index.ty, &Type::Int, index.span);
                    self.report(fault);
                    return None;
                }
                let index = self.convert(index, &Type::Int);
                let place = Place::Element(Box::new(object), Box::new(index));
                Some(Indexed::Target(Target {
                    place,
                    ty: *element,
                    is_final: false,
                }))
            }
            Type::Node(_) | Type::Instance(_) => self.property(object, index),
            ty => {
                let message = format!(
                    "`[ ]` needs an array or a node, found `{}`",
                    self.type_name(&ty)
                );
                let fault = Diagnostic::error("bad-index", span, message);
                let is_list = matches!(ty, Type::Class(class) if class.is_a(ClassId::List));
                self.report(if is_list {
                    fault.hint("write `.get(i)`")
                } else {
                    fault
                });
                None
            }
        }
    }

    /// `node[property]`; the property may be a name or `…Attributes.RADIUS`.
    fn property(&mut self, object: Expr, index: &ast::Expr) -> Option<Indexed> {
        let Some(names) = dotted(index) else {
            let message = "a property of a node must be written as its name";
            self.report(Diagnostic::error("bad-property", index.span, message));
            return None;
        };
        let name = *names.last()?;
        if names.len() > 1 && names[names.len() - 2] == "Attributes" {
            return self.attribute(object, name, index.span);
        }
        self.node_member(object, name, index.span)
    }

    /// `node[…Attributes.NAME]`.
    fn attribute(&mut self, object: Expr, name: &str, span: Span) -> Option<Indexed> {
        let Some(&id) = library::functions_named("Attributes", name).first() else {
            let fault = Diagnostic::error(
                "unknown-property",
                span,
                format!("unknown attribute `{name}`"),
            );
            let known = FunctionId::ALL
                .iter()
                .map(|f| f.signature())
                .filter(|row| row.owner == "Attributes");
            let fault = self.did_you_mean(fault, name, known.map(|row| row.name));
            self.report(fault);
            return None;
        };
        self.cx.facts.is_impure = true;
        let ty = id.signature().result.to_type(self.node, None);
        Some(Indexed::Value(Expr {
            kind: ExprKind::Library(id, vec![object]),
            ty,
            span,
        }))
    }
}
