//! Finding what a name stands for: types, fields, variables, constants.

use super::context::Layer;
use super::model::{Constant, Expr, ExprKind, Place, Slot, StaticId, Type};
use super::types::is_primitive;
use super::{Checker, refuse};
use crate::diag::{Diagnostic, Span};
use crate::graph::{FieldId, TypeId};
use crate::library::{self, ClassId, ConstantValue, ConstructorId};
use crate::syntax::ast;

/// A place with what is known of it.
#[derive(Clone, Debug)]
pub(super) struct Target {
    pub(super) place: Place,
    pub(super) ty: Type,
    /// Whether it must not be assigned.
    pub(super) is_final: bool,
}

/// What a simple name stands for.
#[derive(Clone, Debug)]
pub(super) enum Binding {
    /// Something that has a place.
    Target(Target),
    /// A constant of the model or of the library.
    Value(Expr),
    /// Something wrongly declared; reported there.
    Poisoned,
}

impl Checker<'_> {
    /// The type written here; reported if there is none.
    pub(super) fn resolve_type(&mut self, ty: &ast::TypeRef) -> Option<Type> {
        let last = ty.path.last()?;
        let base = match self.named_type(&last.name) {
            Some(Type::Class(class)) if !ty.args.is_empty() => {
                let args = ty.args.iter().map(|arg| self.type_argument(arg));
                Type::generic(class, args.collect::<Option<_>>()?)
            }
            Some(base) => base,
            None => {
                if !self.refused.contains(&last.name) {
                    let fault = self.unknown_type(&last.name, ty.span);
                    self.report(fault);
                }
                return None;
            }
        };
        let base = (0..ty.dims).fold(base, |element, _| Type::Array(Box::new(element)));
        Some(base)
    }

    /// An argument of a generic type; a wildcard without a bound is `Object`.
    fn type_argument(&mut self, ty: &ast::TypeRef) -> Option<Type> {
        if ty.path.is_empty() {
            return Some(Type::Object);
        }
        let found = self.resolve_type(ty)?;
        if is_primitive(&found) || found == Type::Void {
            let boxed = super::types::boxed(&found).map_or("Object", ClassId::name);
            let name = self.type_name(&found);
            let message = format!("a collection cannot hold the plain type `{name}`");
            let fault = Diagnostic::error("bad-type-argument", ty.span, message);
            self.report(fault.hint(format!("write `{boxed}`")));
            return None;
        }
        Some(found)
    }

    /// As [`resolve_type`](Self::resolve_type), for something that holds a value: not `void`.
    pub(super) fn resolve_value_type(&mut self, ty: &ast::TypeRef) -> Option<Type> {
        let found = self.resolve_type(ty)?;
        let mut element = &found;
        while let Type::Array(inner) = element {
            element = inner;
        }
        if *element == Type::Void {
            self.report(Diagnostic::error(
                "void-value",
                ty.span,
                "nothing can have the type `void` but a method",
            ));
            return None;
        }
        Some(found)
    }

    /// The type of this simple name.
    pub(super) fn named_type(&self, name: &str) -> Option<Type> {
        Some(match name {
            "void" => Type::Void,
            "boolean" => Type::Boolean,
            "byte" => Type::Byte,
            "short" => Type::Short,
            "char" => Type::Char,
            "int" => Type::Int,
            "long" => Type::Long,
            "float" => Type::Float,
            "double" => Type::Double,
            "String" => Type::String,
            "Object" => Type::Object,
            _ => match (self.node_type(name), self.module_names.get(name)) {
                (Some(id), _) => Type::Node(id),
                (None, Some(&class)) => Type::Instance(class),
                (None, None) if self.refused.contains(name) => return None,
                (None, None) if self.type_params.contains(name) => Type::Object,
                (None, None) => match super::closure::named(name) {
                    Some(function) => function,
                    None => Type::Class(ClassId::named(name)?),
                },
            },
        })
    }

    /// The node type of this name: a module, else a built-in type.
    pub(super) fn node_type(&self, name: &str) -> Option<TypeId> {
        match self.module_names.get(name) {
            Some(&id) => self.class_info(id).is_none().then_some(id),
            None if self.refused.contains(name) => None,
            None => self
                .types
                .find(name)
                .filter(|id| usize::from(id.0) < self.n_builtin),
        }
    }

    /// The field of this name that can be written in a model.
    pub(super) fn visible_field(&self, ty: TypeId, name: &str) -> Option<FieldId> {
        if name.contains('.') {
            None
        } else {
            self.types.field(ty, name)
        }
    }

    /// Whether members of this type may be unknown because what it extends is.
    pub(super) fn is_orphan(&self, ty: TypeId) -> bool {
        let lineage = std::iter::successors(Some(ty), |t| self.types[*t].parent);
        let mut modules = lineage.filter_map(|t| usize::from(t.0).checked_sub(self.n_builtin));
        modules.any(|module| self.modules.get(module).is_some_and(|m| m.is_orphan))
    }

    /// What `name` stands for, looked for from the inside out; `None` if nothing.
    pub(super) fn lookup(&mut self, name: &str, span: Span) -> Option<Binding> {
        self.probe(name);
        for at in (0..self.cx.layers.len()).rev() {
            let found = match &self.cx.layers[at] {
                Layer::Block(locals) => {
                    let local = locals.iter().rev().find(|local| local.name == name);
                    local.map(|local| {
                        self.note_local(local, span);
                        local_binding(local, span)
                    })
                }
                Layer::With(slot, ty) => {
                    let (slot, ty) = (*slot, ty.clone());
                    self.member_of_slot(slot, &ty, name, span)
                }
            };
            if let Some(found) = found {
                if let Binding::Target(Target {
                    place: Place::Local(slot),
                    ..
                }) = &found
                {
                    self.cx.touched.push(*slot);
                }
                return Some(found);
            }
        }
        if let Some(this) = self.cx.this
            && let Some(found) = self.member_of_slot(Slot(0), &self.object_type(this), name, span)
        {
            return Some(found);
        }
        self.find_static(name, None)
            .map(|id| {
                self.note_static(id, span);
                self.static_binding(id, span)
            })
            .or_else(|| self.library_constant("", name, span))
    }

    /// The field `name` of the object in a slot.
    fn member_of_slot(&mut self, slot: Slot, ty: &Type, name: &str, span: Span) -> Option<Binding> {
        let object = Expr {
            kind: ExprKind::Read(Place::Local(slot)),
            ty: ty.clone(),
            span,
        };
        match ty {
            Type::Node(id) | Type::Instance(id) => {
                let field = self.visible_field(*id, name)?;
                self.note_field(*id, field, name, span);
                self.cx.touched.push(slot);
                Some(
                    self.field_target(object, *id, field)
                        .map_or(Binding::Poisoned, Binding::Target),
                )
            }
            Type::Class(class) | Type::Generic(class, _) => self
                .library_field(object, *class, name)
                .map(Binding::Target),
            _ => None,
        }
    }

    /// A field as a place; `None` if its type could not be read.
    pub(super) fn field_target(
        &mut self,
        object: Expr,
        ty: TypeId,
        field: FieldId,
    ) -> Option<Target> {
        let info = self.fields[usize::from(ty.0)]
            .get(usize::from(field.0))?
            .clone();
        let place = Place::Field(Box::new(object), field);
        Some(Target {
            place,
            ty: info.ty?,
            is_final: info.is_final,
        })
    }

    /// A public field of a library object as a place.
    pub(super) fn library_field(&self, object: Expr, class: ClassId, name: &str) -> Option<Target> {
        let field = library::field_named(class, name)?;
        let ty = field.getter.signature().result.to_type(self.node, None);
        let place = Place::Member(Box::new(object), field.getter, field.setter);
        Some(Target {
            place,
            ty,
            is_final: false,
        })
    }

    /// The variable `name`: of the module at hand, of the file at hand, of any other file; or of `file` only.
    pub(super) fn find_static(&self, name: &str, file: Option<usize>) -> Option<StaticId> {
        let all = self.static_names.get(name)?;
        let of = |id: &StaticId| &self.statics[id.0 as usize];
        if let Some(file) = file {
            return all
                .iter()
                .copied()
                .find(|id| of(id).file == file && of(id).owner.is_none());
        }
        let is_own = |id: &StaticId| {
            let (at, owner) = (self.cx.owner, of(id).owner);
            at.zip(owner)
                .is_some_and(|(at, owner)| self.is_kind_of(at, owner))
        };
        let own = all.iter().copied().find(|id| is_own(id));
        let here = || {
            all.iter()
                .copied()
                .find(|id| of(id).file == self.cx.file && of(id).owner.is_none())
        };
        own.or_else(here)
            .or_else(|| all.iter().copied().find(|id| of(id).owner.is_none()))
    }

    /// What a variable of the model stands for.
    pub(super) fn static_binding(&mut self, id: StaticId, span: Span) -> Binding {
        let info = &self.statics[id.0 as usize];
        let (ty, is_final) = (info.ty.clone(), info.is_final);
        self.cx.facts.reads.push(id);
        match (ty, self.static_values.get(&id)) {
            (None, _) => Binding::Poisoned,
            (Some(ty), Some(value)) if is_final => Binding::Value(Expr {
                kind: ExprKind::Constant(value.clone()),
                ty,
                span,
            }),
            (Some(ty), _) => Binding::Target(Target {
                place: Place::Static(id),
                ty,
                is_final,
            }),
        }
    }

    /// A constant of the library; for an empty owner also those of the classes that the file imports statically.
    pub(super) fn library_constant(&self, owner: &str, name: &str, span: Span) -> Option<Binding> {
        let imported = || {
            let owners = self.files.get(self.cx.file)?.static_imports.iter();
            owners
                .filter(|_| owner.is_empty())
                .find_map(|owner| library::constant(owner, name))
        };
        // Derivation modes are written with and without their class.
        let of_graph = || library::constant("Graph", name).filter(|_| owner.is_empty());
        let constant = library::constant(owner, name)
            .or_else(imported)
            .or_else(of_graph)?;
        Some(Binding::Value(constant_expr(constant.value, span)))
    }

    /// The fault of a type name that means nothing.
    pub(super) fn unknown_type(&self, name: &str, span: Span) -> Diagnostic {
        if let Some(hint) = refuse::type_hint(name) {
            let message = format!("type `{name}` is not supported");
            return Diagnostic::error("unsupported-type", span, message).hint(hint);
        }
        let fault = Diagnostic::error("unknown-type", span, format!("unknown type `{name}`"))
            .label("no such type");
        let java = [
            "boolean", "byte", "short", "char", "int", "long", "float", "double", "String",
            "Object",
        ];
        // Where a declaration begins, a word may have been meant that is no type.
        let words = [
            "module",
            "import",
            "static",
            "public",
            "protected",
            "private",
            "abstract",
        ];
        let nodes = self.types.iter().map(|(_, ty)| &*ty.name);
        let classes = ClassId::ALL.iter().map(|class| class.name());
        self.did_you_mean(fault, name, nodes.chain(classes).chain(java).chain(words))
    }

    /// The fault of a name that stands where a module must.
    pub(super) fn unknown_node_type(&self, name: &str, span: Span) -> Diagnostic {
        self.probe(name);
        if let Some(hint) = refuse::type_hint(name) {
            let message = format!("`{name}` is not supported");
            return Diagnostic::error("unsupported-type", span, message).hint(hint);
        }
        let fault = Diagnostic::error("unknown-module", span, format!("unknown module `{name}`"))
            .label("no such module or turtle command");
        if self.method_names.contains_key(name) {
            return fault.hint(format!(
                "`{name}` is a method; a condition stands in parentheses: `({name}(x))`"
            ));
        }
        if let Some(command) = foreign_command(name) {
            return fault.hint(format!("write {command}"));
        }
        let labels = self.cx.local_names();
        let nodes = self.types.iter().map(|(_, ty)| &*ty.name);
        self.did_you_mean(fault, name, nodes.chain(labels.iter().map(String::as_str)))
    }
}

/// What other turtles call a command, in the words of this one.
fn foreign_command(name: &str) -> Option<&'static str> {
    Some(match name.to_lowercase().as_str() {
        "$" => "`AdjustLU`",
        "forward" | "fd" | "draw" | "line" => "`F(length)` to draw and walk",
        "move" | "walk" | "jump" => "`M(length)` to walk without drawing",
        "turn" | "yaw" | "left" | "right" | "rt" | "lt" => "`RU(degrees)` to turn",
        "pitch" => "`RL(degrees)` to pitch",
        "roll" => "`RH(degrees)` to roll",
        "push" => "`[` to begin a branch",
        "pop" => "`]` to end a branch",
        _ => return None,
    })
}

fn local_binding(local: &super::context::Local, span: Span) -> Binding {
    match (&local.ty, &local.value) {
        (None, _) => Binding::Poisoned,
        (Some(ty), Some(value)) => Binding::Value(Expr {
            kind: ExprKind::Constant(value.clone()),
            ty: ty.clone(),
            span,
        }),
        (Some(ty), None) => {
            let place = Place::Local(local.slot);
            Binding::Target(Target {
                place,
                ty: ty.clone(),
                is_final: local.is_final,
            })
        }
    }
}

/// A constant of the library as an expression.
fn constant_expr(value: ConstantValue, span: Span) -> Expr {
    let (constant, ty) = match value {
        ConstantValue::Int(v) => (Constant::Int(v), Type::Int),
        ConstantValue::Long(v) => (Constant::Long(v), Type::Long),
        ConstantValue::Float(v) => (Constant::Float(v), Type::Float),
        ConstantValue::Double(v) => (Constant::Double(v), Type::Double),
        ConstantValue::Null(class) => (Constant::Null, Type::Class(class)),
        ConstantValue::Shader(rgb) => {
            let channel = |c: u8| {
                let kind = ExprKind::Constant(Constant::Float(f32::from(c) / 255.0));
                Expr {
                    kind,
                    ty: Type::Float,
                    span,
                }
            };
            let kind = ExprKind::NewObject(ConstructorId::ShaderRgb, rgb.map(channel).to_vec());
            return Expr {
                kind,
                ty: Type::Class(ClassId::RGBAShader),
                span,
            };
        }
    };
    Expr {
        kind: ExprKind::Constant(constant),
        ty,
        span,
    }
}
