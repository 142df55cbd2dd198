//! What a check learns of names and where they are declared, for editors.
//!
//! A [`Survey`] is made only on request ([`survey`](fn@super::survey)); it also answers what could stand at a place: there the
//! editor puts the name [`MARKER`] into the text, which nothing is called, and the check notes what it knows when it
//! meets it.

use super::Checker;
use super::call::Callee;
use super::context::{Layer, Local};
use super::model::{StaticId, Type};
use super::setter::Accessor;
use crate::diag::Span;
use crate::graph::{FieldId, TypeId};
use crate::library::Signature;
use crate::syntax::ast;
use crate::turtle::{self, BuiltinField};

/// The name that stands for what is being typed.
pub const MARKER: &str = "$cursor$";

/// What names mean and where they were declared.
#[derive(Clone, Debug, Default)]
pub struct Survey {
    /// Uses of names: where, and what is meant. Modules, which have one name each, are not among them.
    pub uses: Vec<(Span, Meaning)>,
    /// Local variables, parameters, labels, and what patterns bind.
    pub locals: Vec<LocalVariable>,
    /// What is known at the [`MARKER`], if there was one.
    pub probe: Option<Probe>,
}

/// What a name means.
#[derive(Clone, Copy, Debug)]
pub enum Meaning {
    /// What was declared by the name in this place.
    Declared(Span),
    /// A function or method of the library.
    Library(&'static Signature),
    /// A property of a built-in type.
    Property(&'static BuiltinField),
}

/// A local variable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LocalVariable {
    /// Its name.
    pub name: String,
    /// The name of its type.
    pub ty: String,
    /// The name in its declaration.
    pub declared: Span,
}

/// What is known at a place in the text.
#[derive(Clone, Debug, Default)]
pub struct Probe {
    /// Local variables that can be seen, innermost first: name and type.
    pub locals: Vec<(String, String)>,
    /// The type of `this`.
    pub this: Option<TypeId>,
    /// The type of what stands in front of the dot or bracket.
    pub object: Option<Type>,
    /// Types of the objects whose `.( … )` surrounds the place, innermost first.
    pub with: Vec<Type>,
}

impl Checker<'_> {
    fn note(&self, span: Span, meaning: Meaning) {
        if let Some(survey) = &self.survey {
            survey.borrow_mut().uses.push((span, meaning));
        }
    }

    /// Notes that `name`, which begins where `span` does, means what was declared at `declared`.
    pub(super) fn note_use(&self, name: &str, span: Span, declared: Span) {
        let end = span.start as usize + name.len();
        let span = Span::new(span.file, span.start as usize, end);
        self.note(span, Meaning::Declared(declared));
    }

    /// Notes the use of a local variable.
    pub(super) fn note_local(&self, local: &Local, span: Span) {
        if self.survey.is_some()
            && let Some(declared) = self.cx.slot_span(local.slot)
        {
            self.note_use(&local.name, span, declared);
        }
    }

    /// Notes the use of a variable of the model.
    pub(super) fn note_static(&self, id: StaticId, span: Span) {
        let info = &self.statics[id.0 as usize];
        self.note_use(info.name, span, info.span);
    }

    /// Notes the use of a field of a node.
    pub(super) fn note_field(&self, ty: TypeId, field: FieldId, name: &str, span: Span) {
        if self.survey.is_none() {
            return;
        }
        let lineage = std::iter::successors(Some(ty), |t| self.types[*t].parent);
        let owner = lineage
            .take_while(|t| self.types[*t].fields.len() > usize::from(field.0))
            .last();
        let Some(owner) = owner else { return };
        match usize::from(owner.0).checked_sub(self.n_builtin) {
            Some(module) => {
                let mut own = super::declare::own_fields(self.modules[module].ast);
                if let Some((_, declared, _)) = own.find(|(_, ident, _)| ident.name == name) {
                    self.note_use(name, span, declared.span);
                }
            }
            None => {
                let fields = turtle::builtin(owner).map_or(&[][..], |row| row.fields);
                if let Some(field) = fields.iter().find(|f| f.name == name) {
                    self.note(span, Meaning::Property(field));
                }
            }
        }
    }

    /// Notes what a call calls.
    pub(super) fn note_callee(&self, callee: Callee, span: Span) {
        if self.survey.is_none() {
            return;
        }
        match callee {
            Callee::Method(id) => {
                if let super::declaration::MethodSource::Written(method) =
                    self.methods[id.0 as usize].source
                {
                    self.note(span, Meaning::Declared(method.name.span));
                }
            }
            Callee::Library(id) => self.note(span, Meaning::Library(id.signature())),
            Callee::Function(id) => self.note(span, Meaning::Library(id.signature())),
            Callee::Accessor(
                Accessor::Get(_)
                | Accessor::Set(_)
                | Accessor::SetAll(_)
                | Accessor::SetColor
                | Accessor::SetColorBits
                | Accessor::GetAxis
                | Accessor::SetAxis,
            ) => {}
        }
    }

    /// Keeps the locals of a body that has been checked.
    pub(super) fn note_locals(&mut self) {
        let declared = std::mem::take(&mut self.cx.declared);
        let Some(survey) = &self.survey else { return };
        let named = declared.into_iter().filter(|local| local.name != MARKER);
        let locals = named.filter_map(|local| {
            let ty = local
                .ty
                .as_ref()
                .map_or_else(String::new, |ty| self.type_name(ty));
            Some(LocalVariable {
                declared: self.cx.slot_span(local.slot)?,
                name: local.name,
                ty,
            })
        });
        survey.borrow_mut().locals.extend(locals);
    }

    /// Notes what is known here, if `name` is the marker.
    pub(super) fn probe(&self, name: &str) {
        self.probe_object(name, None);
    }

    /// Notes what is known here, if `name` is the marker; it follows an object of type `object`.
    pub(super) fn probe_object(&self, name: &str, object: Option<&Type>) {
        let Some(survey) = self.survey.as_ref().filter(|_| name == MARKER) else {
            return;
        };
        let mut survey = survey.borrow_mut();
        if survey
            .probe
            .as_ref()
            .is_some_and(|probe| probe.object.is_some() || object.is_none())
        {
            return;
        }
        let (mut locals, mut with) = (vec![], vec![]);
        for layer in self.cx.layers.iter().rev() {
            match layer {
                Layer::Block(block) => {
                    let named = |local: &Local| {
                        let ty = local
                            .ty
                            .as_ref()
                            .map_or_else(String::new, |ty| self.type_name(ty));
                        (local.name.clone(), ty)
                    };
                    locals.extend(block.iter().rev().map(named));
                }
                Layer::With(_, ty) => with.push(ty.clone()),
            }
        }
        let (this, object) = (self.cx.this, object.cloned());
        survey.probe = Some(Probe {
            locals,
            this,
            object,
            with,
        });
    }

    /// As [`probe_object`](Self::probe_object), for a member.
    pub(super) fn probe_member(&self, member: &ast::Ident, object: &Type) {
        self.probe_object(&member.name, Some(object));
    }
}
