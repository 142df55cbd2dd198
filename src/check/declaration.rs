//! What the first pass knows of each declaration.

use super::SourceModel;
use super::class::ClassInfo;
use super::model::{Constant, MethodId, Type};
use crate::diag::Span;
use crate::graph::{FieldId, TypeId, TypeTable};
use crate::library::ClassId;
use crate::syntax::ast;
use crate::turtle::{self, FieldType};
use std::borrow::Cow;

/// A file.
pub(super) struct FileInfo<'a> {
    /// Name by which other files refer to it.
    pub(super) name: String,
    pub(super) ast: &'a ast::File,
    /// Classes whose static members it imports by `.*`, by simple name.
    pub(super) static_imports: Vec<&'a str>,
}

impl<'a> FileInfo<'a> {
    pub(super) fn new(source: &'a SourceModel) -> Self {
        let name = source.name.rsplit(['/', '\\']).next().unwrap_or_default();
        let name = name.strip_suffix(".rgg").unwrap_or(name).trim();
        let imports = source.ast.imports.iter().filter(|import| import.is_static);
        // `import static a.B.*` and `import static a.B.c` both make members of `B` known.
        let class = imports.filter_map(|import| {
            let from_end = if import.is_wildcard { 1 } else { 2 };
            let at = import.path.len().checked_sub(from_end)?;
            Some(import.path[at].name.trim())
        });
        Self {
            name: name.into(),
            ast: &source.ast,
            static_imports: class.collect(),
        }
    }
}

/// A field of a node type.
#[derive(Clone, Debug)]
pub(super) struct FieldInfo {
    /// `None` where it could not be read.
    pub(super) ty: Option<Type>,
    pub(super) is_final: bool,
}

/// A module or class.
pub(super) struct ModuleInfo<'a> {
    pub(super) ast: &'a ast::Module,
    pub(super) file: usize,
    pub(super) type_id: TypeId,
    /// Fields that the constructor's arguments fill, in order; also the positions of patterns.
    pub(super) params: Vec<FieldId>,
    /// Values of parameters that are left out.
    pub(super) defaults: Vec<Option<Constant>>,
    /// Whether its parent could not be found: nothing can be said about inherited members.
    pub(super) is_orphan: bool,
    /// If it is a class.
    pub(super) class: Option<ClassInfo>,
}

/// A method.
pub(super) struct MethodInfo<'a> {
    pub(super) name: &'a str,
    pub(super) file: usize,
    /// The module it belongs to.
    pub(super) owner: Option<TypeId>,
    pub(super) params: Vec<Option<Type>>,
    pub(super) is_varargs: bool,
    pub(super) is_static: bool,
    /// `None` where it could not be read.
    pub(super) result: Option<Type>,
    pub(super) source: MethodSource<'a>,
}

impl MethodInfo<'_> {
    /// Names of its parameters.
    pub(super) fn param_names(&self) -> Vec<Cow<'static, str>> {
        match self.source {
            MethodSource::Written(method) | MethodSource::Constructor(method) => {
                let names = method.params.iter().map(|param| &param.name.name);
                names.map(|name| Cow::Owned(name.clone())).collect()
            }
            MethodSource::Initializer(_) => vec![],
        }
    }
}

/// Where the body of a method comes from.
#[derive(Clone, Copy)]
pub(super) enum MethodSource<'a> {
    Written(&'a ast::Method),
    Constructor(&'a ast::Method),
    /// `{ … }` or `static { … }` at the top of a file.
    Initializer(&'a ast::Block),
}

/// A variable of the model.
pub(super) struct StaticInfo<'a> {
    pub(super) name: &'a str,
    pub(super) file: usize,
    /// The module it is a static member of.
    pub(super) owner: Option<TypeId>,
    /// `None` where it could not be read.
    pub(super) ty: Option<Type>,
    pub(super) is_final: bool,
    pub(super) source: StaticSource<'a>,
    pub(super) span: Span,
}

/// Where a variable comes from.
#[derive(Clone, Copy)]
pub(super) enum StaticSource<'a> {
    Written(&'a ast::Field),
    /// Stands for an initializer block among the variables, so that it runs in its place.
    Initializer(MethodId),
}

/// The fields of the built-in types, by type and number.
pub(super) fn builtin_fields(types: &TypeTable, node: TypeId) -> Vec<Vec<FieldInfo>> {
    let mut all: Vec<Vec<FieldInfo>> = vec![];
    for (id, ty) in types.iter() {
        let mut fields = ty
            .parent
            .map_or(vec![], |parent| all[usize::from(parent.0)].clone());
        let own = turtle::builtin(id).map_or(&[][..], |row| row.fields);
        fields.extend(own.iter().map(|field| FieldInfo {
            ty: Some(builtin_type(field.ty, node)),
            is_final: false,
        }));
        all.push(fields);
    }
    all
}

fn builtin_type(ty: FieldType, node: TypeId) -> Type {
    match ty {
        FieldType::Boolean => Type::Boolean,
        FieldType::Int => Type::Int,
        FieldType::Float => Type::Float,
        FieldType::Double => Type::Double,
        FieldType::String => Type::String,
        FieldType::Vector => Type::Class(ClassId::Tuple3d),
        FieldType::Transformation => Type::Object,
        FieldType::Shader => Type::Class(ClassId::Shader),
        FieldType::Light => Type::Class(ClassId::Light),
        FieldType::Surface => Type::Class(ClassId::BSplineSurface),
        FieldType::Polygons => Type::Class(ClassId::Polygons),
        FieldType::Floats => Type::Array(Box::new(Type::Float)),
        FieldType::Node => Type::Node(node),
    }
}
