//! A growing model ([`Sketch`]) as a source of drawings: its graph, its bodies, and what its shaders and lamps are.

use super::appearance::{Appearance, Lamp, LampKind, Purpose};
use super::failure::Failure;
use super::images::Finder;
use super::shaders;
use super::source::{Body, Source};
use crate::diag::Span;
use crate::eval::files::ModelFiles;
use crate::eval::freeform::{Freeform, Points};
use crate::eval::object::Data;
use crate::eval::{Purity, Value};
use crate::graph::{Graph, NodeId, TypeId};
use crate::growth::Sketch;
use crate::library::ClassId;
use crate::material::Material;
use crate::rewrite::Instantiated;

impl Source for Sketch<'_> {
    type Object = Value;

    fn graph(&self) -> &Graph<Value> {
        Self::graph(self)
    }

    fn body(&self, ty: TypeId) -> Option<Body> {
        let purity = self.instantiation(ty)?;
        Some(Body {
            is_pure: purity == Purity::Pure,
        })
    }

    fn instantiate(&mut self, node: NodeId) -> Result<Instantiated, Failure> {
        Self::instantiate(self, node)
    }

    fn release(&mut self, made: Instantiated) {
        self.free(made);
    }

    fn files(&self) -> &dyn ModelFiles {
        Self::files(self)
    }

    fn is_stopped(&self) -> bool {
        Self::is_stopped(self)
    }

    fn declared_at(&self, ty: TypeId) -> Option<Span> {
        Self::declared_at(self, ty)
    }

    fn made_at(&self, ty: TypeId) -> &[Span] {
        Self::made_at(self, ty)
    }
}

impl Appearance for Value {
    fn surface(&self, purpose: Purpose, pictures: &mut Finder<'_>) -> Option<Material> {
        shaders::surface(self, purpose, pictures)
    }

    fn freeform(&self) -> Option<Freeform> {
        if let Some(array) = self.as_array() {
            let data = (0..array.len()).filter_map(|i| array.get(i)?.as_double());
            return Some(Freeform::Points(Points {
                data: data.collect(),
                dimension: 4,
            }));
        }
        match &*self.as_object()?.lock() {
            Data::Freeform(form, _) => Some((**form).clone()),
            _ => None,
        }
    }

    fn words(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text.as_str()),
            _ => None,
        }
    }

    fn lamp(&self) -> Option<Lamp> {
        let object = self.as_object()?;
        let data = object.lock();
        let Data::Light(light) = &*data else {
            return None;
        };
        let kind = match object.class {
            ClassId::DirectionalLight => LampKind::Directional,
            ClassId::AreaLight => LampKind::Area {
                exponent: f64::from(light.exponent),
            },
            ClassId::SpotLight => LampKind::Spot {
                inner: f64::from(light.inner_angle),
                outer: f64::from(light.outer_angle),
            },
            _ => LampKind::Point,
        };
        Some(Lamp {
            kind,
            color: light.color.map(f64::from),
            power: f64::from(light.power),
        })
    }
}
