//! Which instantiation bodies depend on their node's own fields alone.
//!
//! While bodies are checked, what they read and run is noted in [`Facts`](super::context::Facts); afterwards
//! impurity is carried backwards along "runs". The answer errs on the side of "impure", which only costs time.

use std::collections::{BTreeMap, BTreeSet};

use super::Checker;
use super::context::{Body, Layer};
use super::model::{Expr, ExprKind, Module, Place, Slot, Type};
use crate::graph::TypeId;
use crate::library::{ClassId, Effect};

/// Whether a field or variable of this type may show something that others change.
fn is_shared(ty: &Type) -> bool {
    match ty {
        Type::Node(_) | Type::Instance(_) | Type::Array(_) | Type::Object => true,
        Type::Class(class) => !class.is_a(ClassId::Shader) && !class.is_a(ClassId::Number),
        Type::Generic(..) => true,
        _ => false,
    }
}

impl Checker<'_> {
    /// Notes the read of a place of type `ty`.
    pub(super) fn note_read(&mut self, place: &Place, ty: &Type) {
        let Place::Field(object, _) = place else {
            return;
        };
        let is_own = match object.kind {
            ExprKind::Read(Place::Local(Slot(0))) if self.cx.this.is_some() => !is_shared(ty),
            ExprKind::Read(Place::Local(slot)) => self
                .cx
                .layers
                .iter()
                .any(|layer| matches!(layer, Layer::With(s, _) if *s == slot)),
            _ => false,
        };
        self.cx.facts.is_impure |= !is_own;
    }

    /// Notes the write of a place.
    pub(super) fn note_write(&mut self, place: &Place) {
        match place {
            Place::Static(id) => {
                self.assigned.insert(*id);
                self.cx.facts.is_impure = true;
            }
            Place::Field(object, _) => {
                let is_new =
                    matches!(object.kind, ExprKind::Read(Place::Local(slot)) if slot != Slot(0));
                self.cx.facts.is_impure |= !is_new;
            }
            Place::Element(..) => self.writes_elements = true,
            Place::Local(_) | Place::Member(..) => {}
        }
    }

    /// Notes the call of a library function.
    pub(super) fn note_effect(&mut self, effect: Effect) {
        self.cx.facts.is_impure |= effect != Effect::Pure;
    }

    /// Notes the call of a method of a library object.
    pub(super) fn note_method_effect(&mut self, receiver: &Expr, effect: Effect) {
        let is_local = matches!(
            receiver.kind,
            ExprKind::Read(Place::Local(_)) | ExprKind::NewObject(..)
        );
        self.cx.facts.is_impure |= match effect {
            Effect::Pure => false,
            Effect::Writes => !is_local,
            Effect::Random | Effect::Graph | Effect::Prints => true,
        };
    }

    /// Notes the making of a node.
    pub(super) fn note_new(&mut self, id: TypeId) {
        self.cx
            .facts
            .runs
            .extend([Body::Constructor(id), Body::Instantiation(id)]);
    }

    /// Decides `is_pure` of all instantiation bodies.
    pub(super) fn decide_purity(&self, modules: &mut [Module]) {
        let impure = self.impure_bodies(modules);
        for module in modules {
            let body = Body::Instantiation(module.type_id);
            if let Some(instantiation) = &mut module.instantiation {
                instantiation.is_pure = !impure.contains(&body);
            }
        }
    }

    fn impure_bodies(&self, modules: &[Module]) -> BTreeSet<Body> {
        let mut run_by: BTreeMap<Body, Vec<Body>> = BTreeMap::new();
        for (&body, facts) in &self.facts {
            for &run in &facts.runs {
                run_by.entry(run).or_default().push(body);
            }
        }
        for module in modules {
            // A call may reach any override; a module without an instantiation body of its own has its parent's.
            for &(old, new) in &module.overrides {
                run_by
                    .entry(Body::Method(new))
                    .or_default()
                    .push(Body::Method(old));
            }
            if let (None, Some(parent)) = (&module.instantiation, self.types[module.type_id].parent)
            {
                let inherited = Body::Instantiation(parent);
                run_by
                    .entry(inherited)
                    .or_default()
                    .push(Body::Instantiation(module.type_id));
            }
        }
        let mut waiting: Vec<Body> = self
            .facts
            .iter()
            .filter(|(_, facts)| self.is_impure(facts))
            .map(|(body, _)| *body)
            .collect();
        let mut impure = BTreeSet::new();
        while let Some(body) = waiting.pop() {
            if impure.insert(body) {
                waiting.extend(run_by.get(&body).into_iter().flatten());
            }
        }
        impure
    }

    fn is_impure(&self, facts: &super::context::Facts) -> bool {
        let changes = |id: &super::model::StaticId| {
            let ty = self.statics[id.0 as usize].ty.as_ref();
            let is_shared = match ty {
                Some(Type::Array(_)) => self.writes_elements,
                Some(ty) => is_shared(ty),
                None => true,
            };
            self.assigned.contains(id) || is_shared
        };
        facts.is_impure || facts.reads.iter().any(changes)
    }
}
