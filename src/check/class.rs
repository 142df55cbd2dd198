//! Java classes: declared like modules, but their objects are no nodes and stand in no graph.
//!
//! A class becomes a type of the table with fields, methods and overrides as a module does; its values have the type
//! [`Type::Instance`]. What a class extends is a class of the model or, for exceptions, one of the library.

use super::Checker;
use super::SourceModel;
use super::context::Body;
use super::declaration::MethodSource;
use super::enumeration;
use super::model::{Expr, ExprKind, MethodId, NewNode, Place, Slot, Stmt, StmtKind, Type};
use super::overload::{Overload, Wanted};
use crate::diag::{Diagnostic, Span};
use crate::graph::TypeId;
use crate::library::{self, ClassId};
use crate::syntax::ast;

/// A class as a module: what both have in common.
pub(super) struct Declared {
    /// The file it stands in.
    pub(super) file: usize,
    /// Its fields, methods and parent.
    pub(super) module: ast::Module,
    /// `<T>`
    pub(super) type_params: Vec<String>,
    /// Whether it is an interface.
    pub(super) is_interface: bool,
    /// Whether it is an enumeration.
    pub(super) is_enumeration: bool,
}

/// What is known of a class besides what modules have too.
#[derive(Clone, Debug, Default)]
pub(super) struct ClassInfo {
    /// The library class that it extends, directly or not.
    pub(super) library: Option<ClassId>,
    /// Whether it is an interface.
    pub(super) is_interface: bool,
}

/// All classes and interfaces of the files, also those inside modules and other classes.
pub(super) fn collect(files: &[SourceModel]) -> Vec<Declared> {
    let mut found = vec![];
    for (file, source) in files.iter().enumerate() {
        collect_items(&source.ast.items, file, &mut found);
    }
    found
}

fn collect_items(items: &[ast::Item], file: usize, found: &mut Vec<Declared>) {
    for item in items {
        match item {
            ast::Item::Class(class) => {
                found.push(Declared {
                    file,
                    module: as_module(class),
                    type_params: class.type_params.iter().map(|p| p.name.clone()).collect(),
                    is_interface: class.keyword.name == "interface",
                    is_enumeration: class.keyword.name == "enum",
                });
                collect_items(&class.members, file, found);
            }
            ast::Item::Module(module) => collect_items(&module.members, file, found),
            _ => {}
        }
    }
}

fn as_module(class: &ast::Class) -> ast::Module {
    let mut modifiers = class.modifiers.clone();
    let is_interface = class.keyword.name == "interface";
    modifiers.is_abstract |= is_interface;
    let mut implements = class.implements.clone();
    // An interface that extends another one is of its type as one that implements it.
    let parent = if is_interface {
        implements.extend(class.extends.clone());
        None
    } else {
        class.extends.clone()
    };
    ast::Module {
        modifiers,
        name: class.name.clone(),
        params: vec![],
        extends: parent.map(|parent| ast::Extends {
            parent,
            args: None,
            with: vec![],
        }),
        implements,
        members: match class.keyword.name.as_str() {
            "enum" => enumeration::members(class),
            "interface" => class.members.iter().map(of_interface).collect(),
            _ => class.members.clone(),
        },
        instantiation: None,
        span: class.span,
    }
}

/// A member of an interface: its fields are constants.
fn of_interface(item: &ast::Item) -> ast::Item {
    let mut item = item.clone();
    if let ast::Item::Field(field) = &mut item {
        field.modifiers.is_static = true;
        field.modifiers.is_final = true;
    }
    item
}

impl Checker<'_> {
    /// What is known of a type as a class; `None` for modules and built-in types.
    pub(super) fn class_info(&self, id: TypeId) -> Option<&ClassInfo> {
        let index = usize::from(id.0).checked_sub(self.n_builtin)?;
        self.modules.get(index)?.class.as_ref()
    }

    /// The type of values that are of the type `id`.
    pub(super) fn object_type(&self, id: TypeId) -> Type {
        if self.class_info(id).is_some() {
            Type::Instance(id)
        } else {
            Type::Node(id)
        }
    }

    /// The library class whose members objects of a class have besides their own.
    pub(super) fn library_class(&self, id: TypeId) -> Option<ClassId> {
        self.class_info(id)?.library
    }

    /// `this` in slot 0.
    pub(super) fn this_value(&self, this: TypeId, span: Span) -> Expr {
        Expr {
            kind: ExprKind::Read(Place::Local(Slot(0))),
            ty: self.object_type(this),
            span,
        }
    }

    /// `this` as `super.method()` sees it.
    pub(super) fn parent_value(&self, this: TypeId, span: Span) -> Expr {
        let mut value = self.this_value(this, span);
        value.ty = match (self.types[this].parent, self.library_class(this)) {
            (Some(parent), _) => self.object_type(parent),
            (None, Some(class)) => Type::Class(class),
            (None, None) => Type::Object,
        };
        value
    }

    /// Whether `a` is `b`, or extends or implements it.
    pub(super) fn is_kind_of(&self, a: TypeId, b: TypeId) -> bool {
        self.types.is_a(a, b) || self.interfaces_of(a).contains(&b)
    }

    /// All interfaces of a module or class, inherited ones included.
    pub(super) fn interfaces_of(&self, id: TypeId) -> Vec<TypeId> {
        let (mut found, mut open) = (vec![], vec![id]);
        while let Some(id) = open.pop() {
            open.extend(self.types[id].parent);
            let Some(index) = usize::from(id.0).checked_sub(self.n_builtin) else {
                continue;
            };
            for name in self
                .modules
                .get(index)
                .map_or(&[][..], |m| &m.ast.implements)
            {
                let named = name
                    .path
                    .last()
                    .and_then(|n| self.module_names.get(&n.name));
                if let Some(&interface) = named
                    && !found.contains(&interface)
                {
                    found.push(interface);
                    open.push(interface);
                }
            }
        }
        found
    }

    /// Whether a type, or one that it extends or implements, is said to implement an interface of the library.
    pub(super) fn implements_library(&self, id: TypeId, wanted: ClassId) -> bool {
        let mut all: Vec<TypeId> =
            std::iter::successors(Some(id), |&t| self.types[t].parent).collect();
        all.extend(self.interfaces_of(id));
        all.into_iter().any(|id| {
            let index = usize::from(id.0).checked_sub(self.n_builtin);
            let module = index.and_then(|index| self.modules.get(index));
            let names = module.map_or(&[][..], |module| &module.ast.implements);
            let mut last = names.iter().filter_map(|name| name.path.last());
            last.any(|name| ClassId::named(&name.name) == Some(wanted))
        })
    }

    /// The library class that a class extends by name; reported if it cannot be extended.
    pub(super) fn library_parent(&mut self, name: &str, span: Span) -> Option<ClassId> {
        let found = ClassId::named(name).filter(|class| class.is_a(ClassId::Throwable));
        if found.is_none() && name != "Object" && !self.refused.contains(name) {
            let fault = match self.named_type(name) {
                Some(_) => Diagnostic::error(
                    "bad-extends",
                    span,
                    format!("a class of the model cannot extend `{name}`"),
                )
                .hint("of the library only exceptions can be extended; keep the object in a field"),
                None => self.unknown_type(name, span),
            };
            self.report(fault);
        }
        found
    }

    /// The constructors that a module or class wrote itself.
    pub(super) fn constructors_of(&self, id: TypeId) -> &[MethodId] {
        self.constructors.get(&id).map_or(&[][..], Vec::as_slice)
    }

    /// The call of a constructor that was written as one; `None` if there is none that takes the arguments.
    pub(super) fn written_constructor_call(
        &mut self,
        id: TypeId,
        args: Vec<Expr>,
        span: Span,
    ) -> Option<NewNode> {
        let overloads: Vec<Overload<MethodId>> = self
            .constructors_of(id)
            .iter()
            .map(|&method| {
                let info = &self.methods[method.0 as usize];
                let wanted = |ty: &Option<Type>| ty.clone().map_or(Wanted::Unknown, Wanted::Value);
                Overload {
                    id: method,
                    params: info.params.iter().map(wanted).collect(),
                    names: info.param_names(),
                    is_varargs: info.is_varargs,
                }
            })
            .collect();
        let name = self.types[id].name.to_string();
        let (method, args) = self.choose(&name, span, &overloads, args)?;
        self.cx.facts.runs.push(Body::Method(method));
        Some(NewNode {
            type_id: id,
            constructor: Some(method),
            fields: vec![],
            args,
        })
    }

    /// The statements of a constructor: the parent's first, then the initializers of the fields, then its own.
    pub(super) fn constructor_body(&mut self, owner: TypeId, method: &ast::Method) -> Vec<Stmt> {
        let stmts = method
            .body
            .as_ref()
            .map_or(&[][..], |body| body.stmts.as_slice());
        let call = stmts.first().and_then(explicit_call);
        let (first, rest) = match call {
            Some(_) => (true, &stmts[1..]),
            None => (false, stmts),
        };
        let mut body = vec![];
        match call {
            Some((args, span, true)) if first => body.extend(self.this_call(owner, args, span)),
            Some((args, span, _)) => {
                body.extend(self.super_call(owner, Some(args), span));
                body.extend(self.initializers(owner));
            }
            None => {
                body.extend(self.super_call(owner, None, method.name.span));
                body.extend(self.initializers(owner));
            }
        }
        body.extend(self.stmts(rest));
        body
    }

    /// `this(args);` as the first statement of a constructor.
    fn this_call(&mut self, owner: TypeId, args: &[ast::Expr], span: Span) -> Option<Stmt> {
        let args = self.exprs(args)?;
        let call = self.written_constructor_call(owner, args, span)?;
        Some(Stmt {
            kind: StmtKind::SuperConstructor(Box::new(call)),
            span,
        })
    }

    /// `super(args);` as the first statement of a constructor, or what stands for it.
    pub(super) fn super_call(
        &mut self,
        owner: TypeId,
        args: Option<&[ast::Expr]>,
        span: Span,
    ) -> Option<Stmt> {
        let index = usize::from(owner.0).checked_sub(self.n_builtin)?;
        let info = &self.modules[index];
        let (ast, is_class) = (info.ast, info.class.is_some());
        let of_extends = || ast.extends.as_ref().and_then(|e| e.args.as_deref());
        let args = self.exprs(args.or_else(of_extends).unwrap_or_default())?;
        let Some(parent) = self.types[owner].parent else {
            return self.library_super_call(owner, args, span);
        };
        self.cx.facts.runs.push(Body::Constructor(parent));
        let is_plain = args.is_empty() && usize::from(parent.0) < self.n_builtin;
        let call = if is_plain {
            NewNode {
                type_id: parent,
                constructor: None,
                fields: vec![],
                args,
            }
        } else if is_class || !self.constructors_of(parent).is_empty() {
            self.instance_constructor_call(parent, args, span)?
        } else {
            self.constructor_call(parent, args, span)?
        };
        Some(Stmt {
            kind: StmtKind::SuperConstructor(Box::new(call)),
            span,
        })
    }

    /// `super("text")` of a class that extends an exception of the library.
    fn library_super_call(
        &mut self,
        owner: TypeId,
        mut args: Vec<Expr>,
        span: Span,
    ) -> Option<Stmt> {
        if args.is_empty() {
            return None;
        }
        let text = args.remove(0);
        if self.library_class(owner).is_none() || text.ty != Type::String {
            let fault = Diagnostic::error("wrong-arguments", span, "the parent takes no arguments");
            self.report(fault.hint("an exception takes one text"));
            return None;
        }
        let this = Box::new(self.this_value(owner, span));
        let kind =
            ExprKind::LibraryMethod(library::MethodId::ThrowableSetMessage, this, vec![text]);
        Some(Stmt {
            kind: StmtKind::Expr(Expr {
                kind,
                ty: Type::Void,
                span,
            }),
            span,
        })
    }

    /// The call of a constructor of a class.
    pub(super) fn instance_constructor_call(
        &mut self,
        id: TypeId,
        args: Vec<Expr>,
        span: Span,
    ) -> Option<NewNode> {
        if !self.constructors_of(id).is_empty() {
            return self.written_constructor_call(id, args, span);
        }
        if let Some(first) = args.first() {
            let name = self.types[id].name.to_string();
            let message = format!("`{name}` has no constructor with arguments");
            let fault = Diagnostic::error("wrong-arguments", first.span, message);
            self.report(fault.hint(format!("write `{name}(…) {{ … }}` in the class")));
            return None;
        }
        Some(NewNode {
            type_id: id,
            constructor: None,
            fields: vec![],
            args,
        })
    }

    /// `new C(args)` of a class of the model.
    pub(super) fn new_instance(&mut self, id: TypeId, args: Vec<Expr>, span: Span) -> Option<Expr> {
        if self.types[id].is_abstract {
            let name = &self.types[id].name;
            let message = format!("`{name}` is abstract and cannot be made");
            let fault = Diagnostic::error("abstract-module", span, message);
            self.report(fault.hint("make a class that extends it"));
            return None;
        }
        let new = self.instance_constructor_call(id, args, span)?;
        // What its constructor does is its own matter, but it may read and change anything.
        self.cx.facts.is_impure = true;
        Some(Expr {
            kind: ExprKind::NewNode(Box::new(new)),
            ty: Type::Instance(id),
            span,
        })
    }

    /// Whether a method has no body because its class is an interface.
    pub(super) fn is_of_interface(&self, id: MethodId) -> bool {
        self.methods[id.0 as usize]
            .owner
            .and_then(|owner| self.class_info(owner))
            .is_some_and(|class| class.is_interface)
    }

    /// Declares a constructor.
    pub(super) fn is_constructor(&self, method: &ast::Method, owner: Option<TypeId>) -> bool {
        method.result.is_none()
            && owner.is_some_and(|owner| *self.types[owner].name == *method.name.name)
    }

    /// The declaration behind a method, if it was written as one.
    pub(super) fn written(&self, id: MethodId) -> Option<&ast::Method> {
        match self.methods[id.0 as usize].source {
            MethodSource::Written(method) | MethodSource::Constructor(method) => Some(method),
            MethodSource::Initializer(_) => None,
        }
    }
}

/// The arguments of `this(…);` (true) or `super(…);` (false).
fn explicit_call(stmt: &ast::Stmt) -> Option<(&[ast::Expr], Span, bool)> {
    let ast::StmtKind::Expr(e) = &stmt.kind else {
        return None;
    };
    let ast::ExprKind::Call(callee, args) = &e.kind else {
        return None;
    };
    match callee.kind {
        ast::ExprKind::This => Some((args, e.span, true)),
        ast::ExprKind::Super => Some((args, e.span, false)),
        _ => None,
    }
}
