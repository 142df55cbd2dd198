//! First pass: modules with their fields, methods and variables of all files.

use std::collections::HashMap;

use super::class::ClassInfo;
use super::declaration::{
    FieldInfo, MethodInfo, MethodSource, ModuleInfo, StaticInfo, StaticSource,
};
use super::model::{MethodId, StaticId, Type};
use super::{Checker, constant};
use crate::diag::{Diagnostic, Span};
use crate::graph::{FieldId, FieldKind, NewField, TypeId};
use crate::library::ClassId;
use crate::syntax::ast;

/// More fields in one module are taken for a fault: field numbers are small.
const MAX_FIELDS: usize = 4096;
/// More types are taken for a fault: type numbers are small.
const MAX_TYPES: usize = 60_000;

/// A module or class as it was found in a file.
#[derive(Clone, Copy)]
struct Found<'a> {
    file: usize,
    module: &'a ast::Module,
    /// Of a class whether it is an interface; `None` for modules.
    is_interface: Option<bool>,
}

/// How the graph keeps a field of this type; the type need not be known for that.
fn field_kind(ty: &ast::TypeRef) -> FieldKind {
    let primitive = if ty.dims == 0 && ty.path.len() == 1 {
        ty.path[0].name.as_str()
    } else {
        ""
    };
    match primitive {
        "boolean" => FieldKind::Boolean,
        "byte" => FieldKind::Byte,
        "short" => FieldKind::Short,
        "char" => FieldKind::Char,
        "int" => FieldKind::Int,
        "long" => FieldKind::Long,
        "float" => FieldKind::Float,
        "double" => FieldKind::Double,
        _ => FieldKind::Object,
    }
}

/// Own fields of a module: parameters first, then the fields of its body.
pub(super) fn own_fields(
    module: &ast::Module,
) -> impl Iterator<Item = (&ast::TypeRef, &ast::Ident, bool)> {
    let params = module.params.iter().filter_map(|param| match param {
        ast::ModuleParam::Field { ty, name, .. } => Some((ty, name, false)),
        ast::ModuleParam::Super(_) => None,
    });
    let members = module.members.iter().filter_map(|item| match item {
        ast::Item::Field(field) if !field.modifiers.is_static => Some((
            &field.ty,
            &field.name,
            field.modifiers.is_final && field.init.is_some(),
        )),
        _ => None,
    });
    params.chain(members)
}

impl<'a> Checker<'a> {
    /// Declares everything of all files.
    pub(super) fn declare(&mut self) {
        self.declare_modules();
        self.resolve_fields();
        // What the variables of the files begin with may be a constant of an enumeration.
        let classes = self.classes.iter().filter(|class| class.is_enumeration);
        let enumerations: Vec<&str> = classes.map(|class| &*class.module.name.name).collect();
        let is_enumeration = |module: &ModuleInfo<'_>| {
            module.class.is_some() && enumerations.contains(&module.ast.name.name.as_str())
        };
        let (first, rest): (Vec<usize>, Vec<usize>) =
            (0..self.modules.len()).partition(|&i| is_enumeration(&self.modules[i]));
        self.declare_members(first);
        for file in self.file_order() {
            let ast = self.files[file].ast;
            self.cx.file = file;
            for item in &ast.items {
                self.declare_member(item, None);
            }
        }
        self.declare_members(rest);
        self.check_overrides();
    }

    /// Declares the members of these modules and classes.
    fn declare_members(&mut self, modules: Vec<usize>) {
        for module in modules {
            let (ast, owner) = (self.modules[module].ast, self.modules[module].type_id);
            self.cx.file = self.modules[module].file;
            for item in &ast.members {
                self.declare_member(item, Some(owner));
            }
        }
    }

    /// The files in order of initialization: as given, but what a file imports comes before it, as where Java loads classes.
    fn file_order(&self) -> Vec<usize> {
        let (mut order, mut seen) = (vec![], vec![false; self.files.len()]);
        for first in 0..self.files.len() {
            let mut path = vec![(first, 0)];
            while let Some((file, next)) = path.pop() {
                if next == 0 && std::mem::replace(&mut seen[file], true) {
                    continue;
                }
                if let Some(import) = self.files[file].static_imports.get(next) {
                    path.push((file, next + 1));
                    let imported = self
                        .files
                        .iter()
                        .position(|f| f.name == *import && !f.name.is_empty());
                    path.extend(imported.filter(|&i| !seen[i]).map(|i| (i, 0)));
                } else {
                    order.push(file);
                }
            }
        }
        order
    }

    /// Adds all modules and classes to the table, each after the one it extends, else in textual order.
    fn declare_modules(&mut self) {
        let mut found: HashMap<&'a str, Found<'a>> = HashMap::new();
        let mut order: Vec<Found<'a>> = vec![];
        let modules = self.files.iter().enumerate().flat_map(|(file, info)| {
            info.ast.items.iter().filter_map(move |item| match item {
                ast::Item::Module(module) => Some((file, &**module, None)),
                _ => None,
            })
        });
        let classes = self
            .classes
            .iter()
            .map(|class| (class.file, &class.module, Some(class.is_interface)));
        for (file, module, is_interface) in modules.chain(classes) {
            let new = Found {
                file,
                module,
                is_interface,
            };
            if let Some(first) = found.get(module.name.name.as_str()) {
                let message = format!("module `{}` is declared twice", module.name.name);
                let fault = Diagnostic::error("duplicate-module", module.name.span, message);
                self.diagnostics
                    .push(fault.also(first.module.name.span, "first here"));
                continue;
            }
            found.insert(&module.name.name, new);
            order.push(new);
        }
        for new in order {
            self.declare_lineage(new, &found);
        }
    }

    /// Adds a module after those it extends.
    fn declare_lineage(&mut self, new: Found<'a>, found: &HashMap<&'a str, Found<'a>>) {
        // Walk up to what is known already, then add on the way back.
        let mut waiting = vec![new];
        let mut names = vec![new.module.name.name.as_str()];
        while let Some(parent) = waiting
            .last()
            .and_then(|found| found.module.extends.as_ref())
            .and_then(|e| e.parent.path.last())
        {
            let name = parent.name.as_str();
            if self.module_names.contains_key(name) {
                break;
            }
            let Some(&next) = found.get(name) else { break };
            if names.contains(&name) {
                // A module that extends a built-in type of its own name is no cycle.
                if names.last() != Some(&name) || self.types.find(name).is_none() {
                    let message = format!("module `{name}` extends itself");
                    let hint = "a module can extend only modules that do not extend it";
                    self.report(
                        Diagnostic::error("inheritance-cycle", parent.span, message).hint(hint),
                    );
                }
                self.refused.insert(name.into());
                break;
            }
            names.push(name);
            waiting.push(next);
        }
        while let Some(new) = waiting.pop() {
            if !self.module_names.contains_key(&new.module.name.name) {
                self.add_module(new);
            }
        }
    }

    fn add_module(&mut self, new: Found<'a>) {
        let Found {
            file,
            module,
            is_interface,
        } = new;
        let extends = module.extends.as_ref().map(|extends| &extends.parent);
        let (parent, is_orphan, class) = match is_interface {
            None => {
                let parent = extends.map(|parent| self.parent_type(parent));
                let is_orphan = parent.is_some_and(|p| p.is_none());
                (
                    Some(parent.flatten().unwrap_or(self.default_parent)),
                    is_orphan,
                    None,
                )
            }
            Some(is_interface) => {
                let (parent, library) = self.class_parent(extends);
                let class = ClassInfo {
                    library,
                    is_interface,
                };
                (parent, false, Some(class))
            }
        };
        let mut own: Vec<NewField> = own_fields(module)
            .map(|(ty, name, _)| NewField::new(&name.name, field_kind(ty)))
            .collect();
        let n_inherited = parent.map_or(0, |parent| self.types[parent].fields.len());
        if own.len() + n_inherited > MAX_FIELDS || self.types.len() >= MAX_TYPES {
            let message = format!(
                "module `{}` is one too many or has too many fields",
                module.name.name
            );
            self.report(Diagnostic::error("too-large", module.name.span, message));
            own.clear();
            if self.types.len() >= MAX_TYPES {
                return;
            }
        }
        let (name, is_abstract) = (&module.name.name, module.modifiers.is_abstract);
        let type_id = match parent {
            Some(parent) if class.is_none() => {
                self.types.add_module(name, parent, is_abstract, &own)
            }
            parent => self.types.add_class(name, parent, is_abstract, &own),
        };
        self.module_names.insert(module.name.name.clone(), type_id);
        self.modules.push(ModuleInfo {
            ast: module,
            file,
            type_id,
            params: vec![],
            defaults: vec![],
            is_orphan,
            class,
        });
    }

    /// What a class extends: a class of the model, and the library class behind it.
    fn class_parent(&mut self, parent: Option<&ast::TypeRef>) -> (Option<TypeId>, Option<ClassId>) {
        let Some(name) = parent.and_then(|parent| parent.path.last()) else {
            return (None, None);
        };
        match self.module_names.get(&name.name).copied() {
            Some(id) if self.class_info(id).is_some() => (Some(id), self.library_class(id)),
            Some(_) => {
                let message = format!("a class cannot extend the module `{}`", name.name);
                let fault = Diagnostic::error("bad-extends", name.span, message);
                self.report(fault.hint("write `module` instead of `class`"));
                (None, None)
            }
            None => (None, self.library_parent(&name.name, name.span)),
        }
    }

    /// The node type that a module extends.
    fn parent_type(&mut self, parent: &ast::TypeRef) -> Option<TypeId> {
        let name = parent.path.last()?.name.as_str();
        let found = self.node_type(name);
        if found.is_none() && !self.refused.contains(name) {
            let fault = self.unknown_node_type(name, parent.span);
            self.report(fault);
        }
        found
    }

    /// Finds the types of all fields and the fields that parameters fill.
    fn resolve_fields(&mut self) {
        for index in 0..self.modules.len() {
            let ModuleInfo {
                ast, file, type_id, ..
            } = self.modules[index];
            self.cx.file = file;
            let parent = self.types[type_id].parent;
            let inherited = parent.map(|parent| self.fields[usize::from(parent.0)].clone());
            let mut fields = inherited.unwrap_or_default();
            let n_inherited = fields.len();
            let mut names: HashMap<&str, Span> = HashMap::new();
            for (ty, name, is_final) in own_fields(ast) {
                fields.push(FieldInfo {
                    ty: self.resolve_value_type(ty),
                    is_final,
                });
                if let Some(first) = names.insert(&name.name, name.span) {
                    let message = format!("field `{}` is declared twice", name.name);
                    self.report(
                        Diagnostic::error("duplicate-field", name.span, message)
                            .also(first, "first here"),
                    );
                }
            }
            self.fields.push(fields);
            self.resolve_params(index, parent.unwrap_or(self.node), n_inherited);
        }
    }

    fn resolve_params(&mut self, index: usize, parent: TypeId, n_inherited: usize) {
        let ast = self.modules[index].ast;
        let (mut params, mut defaults, mut own) = (vec![], vec![], n_inherited);
        for param in &ast.params {
            match param {
                ast::ModuleParam::Field { default, name, .. } => {
                    params.push(FieldId(own as u16));
                    own += 1;
                    let value = default.as_ref().map(|e| (e, constant::of_literal(e)));
                    if let Some((e, None)) = value {
                        let message = format!(
                            "the default of parameter `{}` must be a number or text",
                            name.name
                        );
                        self.report(Diagnostic::error("parameter-default", e.span, message));
                    }
                    defaults.push(value.and_then(|(_, value)| value));
                }
                ast::ModuleParam::Super(name) => {
                    defaults.push(None);
                    match self.visible_field(parent, &name.name) {
                        Some(field) => params.push(field),
                        None if self.modules[index].is_orphan => {}
                        None => {
                            let fault = self.unknown_field(parent, &name.name, name.span);
                            self.report(fault);
                        }
                    }
                }
            }
        }
        let type_id = self.modules[index].type_id;
        self.types.set_constructors(type_id, vec![params.clone()]);
        (self.modules[index].params, self.modules[index].defaults) = (params, defaults);
    }

    /// Adds a method or variable; modules were added before, and instance fields belong to their module.
    fn declare_member(&mut self, item: &'a ast::Item, owner: Option<TypeId>) {
        match item {
            ast::Item::Module(module) if owner.is_some() => self.refuse_nested_module(module),
            ast::Item::Module(_) | ast::Item::Class(_) => {}
            ast::Item::Method(method) => self.declare_method(method, owner),
            ast::Item::Field(field) if owner.is_none() || field.modifiers.is_static => {
                self.declare_static(field, owner);
            }
            ast::Item::Initializer { body, is_static } if owner.is_none() || *is_static => {
                self.declare_initializer(body, owner);
            }
            ast::Item::Field(_) | ast::Item::Initializer { .. } => {}
        }
    }

    fn declare_method(&mut self, method: &'a ast::Method, owner: Option<TypeId>) {
        if method.name.name.starts_with("operator$") {
            self.refuse_operator(method);
            return;
        }
        let is_constructor = self.is_constructor(method, owner);
        let result = match &method.result {
            Some(result) => self.resolve_type(result),
            None if is_constructor => Some(Type::Void),
            None => {
                self.refuse_constructor(method);
                return;
            }
        };
        let params: Vec<_> = method.params.iter().map(|p| self.param_type(p)).collect();
        let id = MethodId(self.methods.len() as u32);
        let name = method.name.name.as_str();
        let same = match owner {
            Some(owner) if is_constructor => self.constructors.entry(owner).or_default(),
            _ => self.method_names.entry(name.into()).or_default(),
        };
        let twin = same.iter().find(|other| {
            let other = &self.methods[other.0 as usize];
            other.owner == owner
                && other.params == params
                && (owner.is_some() || other.file == self.cx.file)
        });
        if let Some(twin) = twin {
            let message = format!("method `{name}` is declared twice with the same parameters");
            let mut fault = Diagnostic::error("duplicate-method", method.name.span, message);
            let twin = *twin;
            if let Some(first) = self.written(twin) {
                fault = fault.also(first.name.span, "first here");
            }
            self.report(fault);
            return;
        }
        same.push(id);
        if let Some(owner) = owner.filter(|_| !is_constructor) {
            self.methods_of.entry(owner).or_default().push(id);
        }
        let source = if is_constructor {
            MethodSource::Constructor(method)
        } else {
            MethodSource::Written(method)
        };
        let is_varargs = method.params.last().is_some_and(|p| p.is_varargs);
        let is_static = method.modifiers.is_static || owner.is_none();
        self.methods.push(MethodInfo {
            name,
            file: self.cx.file,
            owner,
            params,
            is_varargs,
            is_static,
            result,
            source,
        });
    }

    fn param_type(&mut self, param: &ast::Param) -> Option<Type> {
        let ty = self.resolve_value_type(&param.ty)?;
        Some(if param.is_varargs {
            Type::Array(Box::new(ty))
        } else {
            ty
        })
    }

    fn declare_static(&mut self, field: &'a ast::Field, owner: Option<TypeId>) {
        let ty = self.resolve_value_type(&field.ty);
        let name = field.name.name.as_str();
        let same = self.static_names.entry(name.into()).or_default();
        let twin = same
            .iter()
            .map(|id| &self.statics[id.0 as usize])
            .find(|s| s.owner == owner && s.file == self.cx.file);
        if let Some(twin) = twin {
            let message = format!("variable `{name}` is declared twice");
            let fault = Diagnostic::error("duplicate-variable", field.name.span, message)
                .also(twin.span, "first here");
            self.report(fault);
            return;
        }
        same.push(StaticId(self.statics.len() as u32));
        let is_final = field.modifiers.is_final && field.init.is_some();
        let source = StaticSource::Written(field);
        self.statics.push(StaticInfo {
            name,
            file: self.cx.file,
            owner,
            ty,
            is_final,
            source,
            span: field.name.span,
        });
    }

    fn declare_initializer(&mut self, body: &'a ast::Block, owner: Option<TypeId>) {
        let (file, name) = (self.cx.file, "{…}");
        let id = MethodId(self.methods.len() as u32);
        self.methods.push(MethodInfo {
            name,
            file,
            owner,
            params: vec![],
            is_varargs: false,
            is_static: true,
            result: Some(Type::Void),
            source: MethodSource::Initializer(body),
        });
        let source = StaticSource::Initializer(id);
        self.statics.push(StaticInfo {
            name,
            file,
            owner,
            ty: Some(Type::Int),
            is_final: true,
            source,
            span: body.span,
        });
    }
}
