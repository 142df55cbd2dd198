//! Modules: constructors, instantiation bodies, overrides, and calls of constructors.

use super::Checker;
use super::context::{Body, Context, Local};
use super::declaration::MethodSource;
use super::model::{
    Constant, Constructor, Expr, ExprKind, Instantiation, MethodId, Module, NewNode, Place, Slot,
    Stmt, StmtKind, Type,
};
use super::overload::{Overload, Wanted};
use super::types::is_reference;
use crate::diag::{Diagnostic, Span};
use crate::graph::{FieldId, TypeId};
use crate::library::ClassId;
use crate::syntax::ast;

impl Checker<'_> {
    /// The checked modules, in order of their types. Purity is decided later.
    pub(super) fn modules(&mut self) -> Vec<Module> {
        let mut all: Vec<Module> = vec![];
        for index in 0..self.modules.len() {
            let info = &self.modules[index];
            let (ast, type_id) = (info.ast, info.type_id);
            let class = info
                .class
                .as_ref()
                .map(|class| class.library.unwrap_or(ClassId::Instance));
            let constructor = self.constructor(index);
            let instantiation = ast
                .instantiation
                .as_ref()
                .map(|body| self.instantiation(index, body));
            let parent = self.types[type_id]
                .parent
                .and_then(|p| usize::from(p.0).checked_sub(self.n_builtin));
            let mut overrides = parent
                .and_then(|p| all.get(p))
                .map_or(vec![], |parent| parent.overrides.clone());
            for (old, new) in self.own_overrides(type_id) {
                overrides.retain(|(method, _)| *method != old);
                overrides.push((old, new));
            }
            all.push(Module {
                type_id,
                class,
                constructor,
                instantiation,
                overrides,
                span: ast.span,
                name_span: ast.name.span,
            });
        }
        all
    }

    fn constructor(&mut self, index: usize) -> Constructor {
        let info = &self.modules[index];
        let (ast, file, type_id, fields) = (info.ast, info.file, info.type_id, info.params.clone());
        self.cx = Context::new(file, Some((type_id, self.object_type(type_id))));
        self.cx.result = Some(Type::Void);
        let mut params = vec![];
        self.cx.open();
        for (field, param) in fields.iter().zip(&ast.params) {
            let (ast::ModuleParam::Field { name, .. } | ast::ModuleParam::Super(name)) = param;
            let ty = self.fields[usize::from(type_id.0)]
                .get(usize::from(field.0))
                .and_then(|f| f.ty.clone());
            if matches!(param, ast::ModuleParam::Super(_)) {
                self.note_field(type_id, *field, &name.name, name.span);
            }
            params.push(ty.clone().unwrap_or(Type::Object));
            let slot = self.cx.slot(ty.clone().unwrap_or(Type::Object), name.span);
            self.cx.declare(Local {
                name: name.name.clone(),
                ty,
                slot,
                is_final: false,
                value: None,
            });
        }
        let span = ast
            .extends
            .as_ref()
            .map_or(ast.name.span, |e| e.parent.span);
        let mut body: Vec<Stmt> = self.super_call(type_id, None, span).into_iter().collect();
        // From here on the names of parameters mean the fields.
        self.cx.close();
        for (at, &field) in fields.iter().enumerate() {
            body.extend(self.store_param(type_id, field, at + 1, ast.name.span));
        }
        body.extend(self.initializers(type_id));
        let frame = self.finish(Body::Constructor(type_id));
        Constructor {
            params,
            frame,
            body,
        }
    }

    /// What a new object runs after its parent's constructor: `.( … )` of `extends`, initial values, blocks.
    pub(super) fn initializers(&mut self, type_id: TypeId) -> Vec<Stmt> {
        let Some(index) = usize::from(type_id.0).checked_sub(self.n_builtin) else {
            return vec![];
        };
        let ast = self.modules[index].ast;
        let mut body = vec![];
        if let Some(extends) = &ast.extends {
            self.cx.open();
            body.extend(self.stmts(&extends.with));
            self.cx.close();
        }
        for item in &ast.members {
            body.extend(self.field_initializer(type_id, item));
        }
        body
    }

    /// `this.field = parameter`.
    fn store_param(
        &mut self,
        type_id: TypeId,
        field: FieldId,
        slot: usize,
        span: Span,
    ) -> Option<Stmt> {
        let this = self.this_value(type_id, span);
        let target = self.field_target(this, type_id, field)?;
        let slot = Slot(u16::try_from(slot).ok()?);
        let value = Expr {
            kind: ExprKind::Read(Place::Local(slot)),
            ty: target.ty.clone(),
            span,
        };
        let kind = ExprKind::Assign(target.place, Box::new(value));
        Some(Stmt {
            kind: StmtKind::Expr(Expr {
                kind,
                ty: target.ty,
                span,
            }),
            span,
        })
    }

    /// `float age = 3;` and `{ … }` of a module's body.
    fn field_initializer(&mut self, type_id: TypeId, item: &ast::Item) -> Option<Stmt> {
        match item {
            ast::Item::Field(field) if !field.modifiers.is_static => {
                let init = field.init.as_ref()?;
                let span = field.name.span;
                let this = self.this_value(type_id, span);
                let Some(id) = self.types.field(type_id, &field.name.name) else {
                    return self.expr(init).and(None);
                };
                let Some(target) = self.field_target(this, type_id, id) else {
                    return self.expr(init).and(None);
                };
                let value = self.initial_value(init, &target.ty)?;
                let kind = ExprKind::Assign(target.place, Box::new(value));
                Some(Stmt {
                    kind: StmtKind::Expr(Expr {
                        kind,
                        ty: target.ty,
                        span,
                    }),
                    span,
                })
            }
            ast::Item::Initializer {
                is_static: false,
                body,
            } => Some(Stmt {
                kind: StmtKind::Block(self.block(body)),
                span: body.span,
            }),
            _ => None,
        }
    }

    fn instantiation(&mut self, index: usize, body: &[ast::RhsItem]) -> Instantiation {
        let (file, type_id) = (self.modules[index].file, self.modules[index].type_id);
        self.cx = Context::new(file, Some((type_id, Type::Node(type_id))));
        self.cx.result = Some(Type::Void);
        let body = self.whole_production(body);
        let frame = self.finish(Body::Instantiation(type_id));
        Instantiation {
            frame,
            body,
            is_pure: false,
        }
    }

    /// The call of a constructor with checked arguments.
    pub(super) fn constructor_call(
        &mut self,
        id: TypeId,
        args: Vec<Expr>,
        span: Span,
    ) -> Option<NewNode> {
        match usize::from(id.0).checked_sub(self.n_builtin) {
            Some(module) => self.module_constructor_call(module, args, span),
            None => self.builtin_constructor_call(id, args, span),
        }
    }

    fn builtin_constructor_call(
        &mut self,
        id: TypeId,
        args: Vec<Expr>,
        span: Span,
    ) -> Option<NewNode> {
        let constructors = crate::turtle::builtin(id).map_or(&[][..], |row| row.constructors);
        let name = self.types[id].name.to_string();
        if constructors.is_empty() {
            self.report(Diagnostic::error(
                "bad-new",
                span,
                format!("a node `{name}` cannot be made"),
            ));
            return None;
        }
        let fields_of = |names: &[&str]| {
            names
                .iter()
                .filter_map(|n| self.types.field(id, n))
                .collect::<Vec<_>>()
        };
        let overloads: Vec<_> = constructors
            .iter()
            .map(|names| {
                let fields = fields_of(names);
                let ty = |field: &FieldId| {
                    self.fields[usize::from(id.0)][usize::from(field.0)]
                        .ty
                        .clone()
                };
                let params = fields
                    .iter()
                    .map(|f| ty(f).map_or(Wanted::Unknown, Wanted::Value))
                    .collect();
                Overload {
                    id: *names,
                    params,
                    names: self.field_names(id, &fields),
                    is_varargs: false,
                }
            })
            .collect();
        let (names, args) = self.choose(&name, span, &overloads, args)?;
        let fields = names
            .iter()
            .filter_map(|n| self.types.field(id, n))
            .collect();
        Some(NewNode {
            type_id: id,
            constructor: None,
            fields,
            args,
        })
    }

    fn module_constructor_call(
        &mut self,
        module: usize,
        mut args: Vec<Expr>,
        span: Span,
    ) -> Option<NewNode> {
        let info = &self.modules[module];
        let (type_id, defaults) = (info.type_id, info.defaults.clone());
        if !self.constructors_of(type_id).is_empty()
            && (defaults.is_empty() || self.is_for_constructor(type_id, &args))
        {
            return self.written_constructor_call(type_id, args, span);
        }
        if info.is_orphan && info.params.len() != defaults.len() {
            return None;
        }
        let fields = &self.fields[usize::from(type_id.0)];
        let types: Vec<Option<Type>> = info
            .params
            .iter()
            .map(|f| fields.get(usize::from(f.0)).and_then(|f| f.ty.clone()))
            .collect();
        // Parameters that are left out take their defaults; without any argument also zero, as in GroIMP.
        let missing = defaults.get(args.len()..).unwrap_or_default();
        if !missing.is_empty() && (args.is_empty() || missing.iter().all(Option::is_some)) {
            if missing.iter().all(Option::is_none) {
                return Some(NewNode {
                    type_id,
                    constructor: None,
                    fields: vec![],
                    args,
                });
            }
            let filled = missing
                .iter()
                .zip(&types[args.len()..])
                .map(|(value, ty)| default_value(value, ty.as_ref(), span));
            args.extend(filled.collect::<Vec<_>>());
        }
        let params = types
            .into_iter()
            .map(|ty| ty.map_or(Wanted::Unknown, Wanted::Value))
            .collect();
        let names = self.field_names(type_id, &self.modules[module].params);
        let name = self.types[type_id].name.to_string();
        let ((), args) = self.choose(
            &name,
            span,
            &[Overload {
                id: (),
                params,
                names,
                is_varargs: false,
            }],
            args,
        )?;
        Some(NewNode {
            type_id,
            constructor: None,
            fields: vec![],
            args,
        })
    }

    /// Methods of parents that this module's own methods replace.
    fn own_overrides(&self, type_id: TypeId) -> Vec<(MethodId, MethodId)> {
        let mut found = vec![];
        let lineage = std::iter::successors(self.types[type_id].parent, |t| self.types[*t].parent);
        let mut lineage: Vec<TypeId> = lineage
            .take_while(|t| usize::from(t.0) >= self.n_builtin)
            .collect();
        lineage.extend(self.interfaces_of(type_id));
        if lineage.is_empty() {
            return found;
        }
        let own = self.methods_of.get(&type_id).map_or(&[][..], Vec::as_slice);
        for &new in own {
            let method = &self.methods[new.0 as usize];
            for ancestor in &lineage {
                let of = self.methods_of.get(ancestor).map_or(&[][..], Vec::as_slice);
                let replaced = of.iter().filter(|old| {
                    let old = &self.methods[old.0 as usize];
                    old.name == method.name
                        && old.params == method.params
                        && !old.is_static
                        && !method.is_static
                });
                found.extend(replaced.map(|old| (*old, new)));
            }
        }
        found
    }

    /// Whether the arguments are those of a constructor that the module wrote itself.
    fn is_for_constructor(&self, id: TypeId, args: &[Expr]) -> bool {
        self.constructors_of(id).iter().any(|method| {
            let params = &self.methods[method.0 as usize].params;
            let fits = |(param, arg): (&Option<Type>, &Expr)| {
                param
                    .as_ref()
                    .is_none_or(|ty| self.fit(&arg.ty, ty).is_some())
            };
            params.len() == args.len() && params.iter().zip(args).all(fits)
        })
    }

    /// Whether a method has no body because it is abstract.
    pub(super) fn is_abstract(&self, id: MethodId) -> bool {
        match self.methods[id.0 as usize].source {
            MethodSource::Written(method) => {
                method.body.is_none() && (method.modifiers.is_abstract || self.is_of_interface(id))
            }
            MethodSource::Constructor(_) | MethodSource::Initializer(_) => false,
        }
    }

    /// Overrides must give the same type, and what is not abstract must have all methods.
    pub(super) fn check_overrides(&mut self) {
        for index in 0..self.modules.len() {
            let (ast, type_id) = (self.modules[index].ast, self.modules[index].type_id);
            for (old, new) in self.own_overrides(type_id) {
                let (old, new) = (&self.methods[old.0 as usize], &self.methods[new.0 as usize]);
                let (Some(wanted), Some(found), MethodSource::Written(method)) =
                    (&old.result, &new.result, new.source)
                else {
                    continue;
                };
                if wanted != found && !(is_reference(wanted) && self.is_subtype(found, wanted)) {
                    let (wanted, found) = (self.type_name(wanted), self.type_name(found));
                    let message = format!(
                        "`{}` must give `{wanted}` as in the parent, not `{found}`",
                        new.name
                    );
                    self.report(Diagnostic::error("bad-override", method.name.span, message));
                }
            }
            if !ast.modifiers.is_abstract {
                self.check_complete(type_id, ast);
            }
        }
    }

    /// Reports abstract methods that a module leaves open.
    fn check_complete(&mut self, type_id: TypeId, ast: &ast::Module) {
        let mut lineage: Vec<TypeId> =
            std::iter::successors(Some(type_id), |t| self.types[*t].parent).collect();
        lineage.extend(self.interfaces_of(type_id));
        let mut done: Vec<(&str, &[Option<Type>])> = vec![];
        let mut open = vec![];
        for ancestor in &lineage {
            for id in self.methods_of.get(ancestor).map_or(&[][..], Vec::as_slice) {
                let method = &self.methods[id.0 as usize];
                let key = (method.name, method.params.as_slice());
                if !self.is_abstract(*id) {
                    done.push(key);
                } else if !done.contains(&key) {
                    open.push(method.name.to_owned());
                }
            }
        }
        for name in open {
            let message = format!(
                "`{}` lacks the method `{name}` of its parent",
                ast.name.name
            );
            let fault = Diagnostic::error("missing-method", ast.name.span, message);
            self.report(fault.hint("write it, or put `abstract` in front of the declaration"));
        }
    }
}

/// The value of a parameter that is left out.
fn default_value(value: &Option<Constant>, ty: Option<&Type>, span: Span) -> Expr {
    let constant = |kind: Constant, ty: Type| Expr {
        kind: ExprKind::Constant(kind),
        ty,
        span,
    };
    match value {
        Some(Constant::Int(v)) => constant(Constant::Int(*v), Type::Int),
        Some(Constant::Long(v)) => constant(Constant::Long(*v), Type::Long),
        Some(Constant::Float(v)) => constant(Constant::Float(*v), Type::Float),
        Some(Constant::Double(v)) => constant(Constant::Double(*v), Type::Double),
        Some(Constant::Boolean(v)) => constant(Constant::Boolean(*v), Type::Boolean),
        Some(Constant::String(v)) => constant(Constant::String(v.clone()), Type::String),
        Some(Constant::Null) => constant(Constant::Null, Type::Null),
        None => match ty {
            Some(Type::Boolean) => constant(Constant::Boolean(false), Type::Boolean),
            Some(ty) if !is_reference(ty) => super::constant::convert(&Constant::Int(0), ty)
                .map_or(constant(Constant::Int(0), Type::Int), |zero| {
                    constant(zero, ty.clone())
                }),
            _ => constant(Constant::Null, Type::Null),
        },
    }
}
