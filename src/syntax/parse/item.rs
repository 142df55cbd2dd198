//! Declarations: imports, modules, classes, methods, fields.

use super::grammar::Rule;
use super::{Reader, kids};
use crate::diag::{Diagnostic, Span};
use crate::syntax::ast::{
    Block, Class, EnumConstant, Expr, Extends, Field, Ident, Import, Item, Method, Modifiers,
    Module, ModuleParam, Param, Stmt, StmtKind, TypeRef,
};
use pest::iterators::Pair;

impl Reader<'_> {
    pub(super) fn import(&self, pair: Pair<'_, Rule>) -> Import {
        let span = self.span(&pair);
        let mut import = Import {
            path: vec![],
            is_static: false,
            is_wildcard: false,
            span,
        };
        for kid in pair.into_inner() {
            match kid.as_rule() {
                Rule::kw_static => import.is_static = true,
                Rule::ident => import.path.push(self.ident(&kid)),
                Rule::wildcard => import.is_wildcard = true,
                _ => {}
            }
        }
        import
    }

    /// Adds a declaration; one of several fields adds several.
    pub(super) fn item(&self, pair: Pair<'_, Rule>, into: &mut Vec<Item>) {
        let span = self.span(&pair);
        let mut modifiers = Modifiers::default();
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::modifier_word => self.modifier(&kid, &mut modifiers),
                Rule::module => {
                    let module = Module {
                        span,
                        ..self.module(kid, std::mem::take(&mut modifiers))
                    };
                    into.push(Item::Module(Box::new(module)));
                }
                Rule::class | Rule::enumeration => {
                    let class = Class {
                        span,
                        ..self.class(kid, std::mem::take(&mut modifiers))
                    };
                    into.push(Item::Class(Box::new(class)));
                }
                Rule::initializer => {
                    let body = kids(kid).map(|block| self.block(block)).next();
                    into.push(Item::Initializer {
                        is_static: modifiers.is_static,
                        body: body.unwrap_or_default(),
                    });
                }
                Rule::constructor => {
                    let method = Method {
                        span,
                        ..self.method(kid, None, std::mem::take(&mut modifiers))
                    };
                    into.push(Item::Method(Box::new(method)));
                }
                Rule::member => self.member(kid, std::mem::take(&mut modifiers), into),
                _ => {}
            }
        }
    }

    pub(super) fn modifier(&self, pair: &Pair<'_, Rule>, modifiers: &mut Modifiers) {
        match pair.as_str() {
            "static" => modifiers.is_static = true,
            "final" | "const" => modifiers.is_final = true,
            "abstract" => modifiers.is_abstract = true,
            "public" | "protected" | "private" => modifiers.visibility = Some(self.ident(pair)),
            _ => {}
        }
    }

    fn module(&self, pair: Pair<'_, Rule>, modifiers: Modifiers) -> Module {
        let mut module = Module {
            modifiers,
            name: self.first_ident(&pair),
            params: vec![],
            extends: None,
            implements: vec![],
            members: vec![],
            instantiation: None,
            span: self.span(&pair),
        };
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::module_params => {
                    module.params = kids(kid).map(|param| self.module_param(param)).collect();
                }
                Rule::extends => module.extends = Some(self.extends(kid)),
                Rule::implements => {
                    module.implements = kids(kid).map(|ty| self.type_ref(ty)).collect();
                }
                Rule::body => self.body(kid, &mut module.members),
                Rule::instantiation => module.instantiation = Some(self.rhs(kid)),
                _ => {}
            }
        }
        module
    }

    fn body(&self, pair: Pair<'_, Rule>, into: &mut Vec<Item>) {
        for kid in kids(pair) {
            self.item(kid, into);
        }
    }

    fn module_param(&self, pair: Pair<'_, Rule>) -> ModuleParam {
        let mut ty = None;
        let mut name = self.ident(&pair);
        let mut default = None;
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::super_param => return ModuleParam::Super(self.first_ident(&kid)),
                Rule::type_ref => ty = Some(self.type_ref(kid)),
                Rule::ident => name = self.ident(&kid),
                Rule::dim => ty = ty.map(|ty| with_dims(ty, 1)),
                Rule::expr => default = Some(self.expr(kid)),
                _ => {}
            }
        }
        let ty = ty.unwrap_or(TypeRef {
            path: vec![],
            args: vec![],
            dims: 0,
            span: name.span,
        });
        ModuleParam::Field { ty, name, default }
    }

    fn extends(&self, pair: Pair<'_, Rule>) -> Extends {
        let parent = TypeRef {
            path: vec![],
            args: vec![],
            dims: 0,
            span: self.span(&pair),
        };
        let mut extends = Extends {
            parent,
            args: None,
            with: vec![],
        };
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::type_ref => extends.parent = self.type_ref(kid),
                Rule::args => extends.args = Some(self.args(kid)),
                Rule::with_block => extends.with = self.with_block(kid),
                _ => {}
            }
        }
        extends
    }

    pub(super) fn class(&self, pair: Pair<'_, Rule>, modifiers: Modifiers) -> Class {
        let keyword = pair.clone().into_inner().next();
        let mut class = Class {
            keyword: self.ident(keyword.as_ref().unwrap_or(&pair)),
            modifiers,
            name: self.first_ident(&pair),
            type_params: vec![],
            extends: None,
            implements: vec![],
            constants: vec![],
            members: vec![],
            span: self.span(&pair),
        };
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::type_args => {
                    class.type_params = kids(kid).map(|p| self.type_param(p)).collect();
                }
                // An interface can extend several.
                Rule::class_parents => {
                    let mut parents = kids(kid).map(|ty| self.type_ref(ty));
                    class.extends = parents.next();
                    class.implements.extend(parents);
                }
                Rule::implements => {
                    class
                        .implements
                        .extend(kids(kid).map(|ty| self.type_ref(ty)));
                }
                Rule::enum_constant => class.constants.push(EnumConstant {
                    name: self.first_ident(&kid),
                    args: kids(kid)
                        .find(|part| part.as_rule() == Rule::args)
                        .map_or(vec![], |args| self.args(args)),
                }),
                Rule::item => self.item(kid, &mut class.members),
                Rule::body => self.body(kid, &mut class.members),
                _ => {}
            }
        }
        class
    }

    /// The name of a type parameter, `T` of `T` and of `T extends Node`.
    fn type_param(&self, pair: Pair<'_, Rule>) -> Ident {
        let of_bound = pair
            .clone()
            .into_inner()
            .find(|kid| kid.as_rule() == Rule::bound);
        self.first_ident(
            &of_bound
                .or_else(|| pair.clone().into_inner().next())
                .unwrap_or(pair),
        )
    }

    fn member(&self, pair: Pair<'_, Rule>, modifiers: Modifiers, into: &mut Vec<Item>) {
        let span = self.span(&pair);
        let name = self.first_ident(&pair);
        let mut ty = None;
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::type_ref if kid.as_str().trim_end() == "scaleclass" => {
                    self.refuse_scales(span);
                }
                Rule::type_ref => ty = Some(self.type_ref(kid)),
                Rule::method_rest => {
                    let method = Method {
                        name: name.clone(),
                        span,
                        ..self.method(kid, ty.take(), modifiers.clone())
                    };
                    into.push(Item::Method(Box::new(method)));
                }
                Rule::field_rest => {
                    if let Some(ty) = ty.take() {
                        self.fields(
                            kid,
                            &Field {
                                modifiers: modifiers.clone(),
                                ty,
                                name: name.clone(),
                                init: None,
                            },
                            into,
                        );
                    }
                }
                _ => {}
            }
        }
    }

    /// `scaleclass Plant;` looks like a field; nothing else in a model of several scales can be told so early.
    fn refuse_scales(&self, span: Span) {
        let message = "scales (`scaleclass`) are not supported";
        let hint =
            "write one module for each scale, and link their nodes by edges of their own kind";
        self.report(Diagnostic::error("unsupported", span, message).hint(hint));
    }

    /// Adds the fields of one declaration, of which `first` is the first without its dimensions and value.
    fn fields(&self, pair: Pair<'_, Rule>, first: &Field, into: &mut Vec<Item>) {
        let (mut dims, mut init, mut rest) = (0, None, vec![]);
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::dim => dims += 1,
                Rule::declarator => {
                    let (name, dims, init) = self.declarator(kid);
                    let ty = with_dims(first.ty.clone(), dims);
                    rest.push(Item::Field(Box::new(Field {
                        ty,
                        name,
                        init,
                        ..first.clone()
                    })));
                }
                _ => init = Some(self.initial(kid)),
            }
        }
        let ty = with_dims(first.ty.clone(), dims);
        into.push(Item::Field(Box::new(Field {
            ty,
            init,
            ..first.clone()
        })));
        into.append(&mut rest);
    }

    /// The name, dimensions and initial value of a variable.
    pub(super) fn declarator(&self, pair: Pair<'_, Rule>) -> (Ident, u8, Option<Expr>) {
        let name = self.first_ident(&pair);
        let (mut dims, mut init) = (0_u8, None);
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::ident => {}
                Rule::dim => dims = dims.saturating_add(1),
                _ => init = Some(self.initial(kid)),
            }
        }
        (name, dims, init)
    }

    fn method(
        &self,
        pair: Pair<'_, Rule>,
        result: Option<TypeRef>,
        modifiers: Modifiers,
    ) -> Method {
        let (name, span) = (self.first_ident(&pair), self.span(&pair));
        let mut method = Method {
            modifiers,
            result,
            name,
            params: vec![],
            body: None,
            span,
        };
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::params => method.params = kids(kid).map(|param| self.param(param)).collect(),
                Rule::block => method.body = Some(self.block(kid)),
                Rule::rules => {
                    let span = self.span(&kid);
                    let stmt = Stmt {
                        kind: StmtKind::Rules(self.rule_items(kid)),
                        span,
                    };
                    method.body = Some(Block {
                        stmts: vec![stmt],
                        span,
                    });
                }
                _ => {}
            }
        }
        method
    }

    pub(super) fn param(&self, pair: Pair<'_, Rule>) -> Param {
        let name = self.first_ident(&pair);
        let mut param = Param {
            ty: TypeRef {
                path: vec![],
                args: vec![],
                dims: 0,
                span: name.span,
            },
            name,
            is_varargs: false,
        };
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::type_ref => param.ty = self.type_ref(kid),
                Rule::ellipsis => param.is_varargs = true,
                Rule::dim => param.ty = with_dims(param.ty, 1),
                _ => {}
            }
        }
        param
    }
}

/// The array type with `more` further dimensions.
pub(super) fn with_dims(ty: TypeRef, more: u8) -> TypeRef {
    TypeRef {
        dims: ty.dims.saturating_add(more),
        ..ty
    }
}
