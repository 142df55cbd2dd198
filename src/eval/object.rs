//! Library objects: vectors, shaders, lights, collections, exceptions and the like.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::{DMat4, DVec3};

use super::decimal::{java_double_to_string, java_float_to_string};
use super::freeform::Freeform;
use super::library::data::Table;
use super::library::files::{TextReader, TextWriter};
use super::library::more::Tokens;
use super::light_model::LightModel;
use super::map::JavaMap;
use super::memory::Charge;
use super::picture::{Paint, Picture, Placement};
use super::random::JavaRandom;
use super::text::Text;
use super::value::{Value, free};
use crate::check::model::MethodId;
use crate::graph::TypeId;
use crate::library::ClassId;

/// An object of a library class.
#[derive(Debug)]
pub struct Object {
    /// Its class.
    pub class: ClassId,
    data: Mutex<Data>,
}

/// What a library object holds.
#[derive(Clone, Debug)]
pub enum Data {
    /// A point, a vector, a spectrum.
    Tuple(DVec3),
    /// A colour map; linear red, green, blue.
    Color([f64; 3]),
    /// An `RGBAShader`: red, green, blue, alpha.
    Shader([f32; 4]),
    /// An `ImageMap` or `Checker`.
    Picture(Box<Picture>),
    /// An `AffineUVTransformation`.
    Placement(Placement),
    /// A `Phong` shader.
    Phong(Box<Phong>),
    /// A `Mirror`, `Metal`, `Glass`, `Pane` or `LeafShader`.
    Finish(Box<Finish>),
    /// A `SideSwitchShader`, `MixShader` or `AlgorithmSwitchShader`.
    Shaders(Box<Shaders>),
    /// A source of light.
    Light(Light),
    /// A light model.
    LightModel(Box<LightModel>),
    /// A generator of its own.
    Random(Box<JavaRandom>),
    /// A list.
    List(List),
    /// A map.
    Map(Box<JavaMap>),
    /// A `StringBuffer` or `StringBuilder`.
    Buffer(String, Charge),
    /// Something thrown.
    Throwable(Option<Arc<Text>>),
    /// An object of a class of the model.
    Instance(Box<Instance>),
    /// A `HashSet`: the keys of a map.
    Set(Box<JavaMap>),
    /// Elements or words that come one after the other.
    Tokens(Box<Tokens>),
    /// A table.
    Table(Box<Table>),
    /// A row of a table.
    Row(Arc<Object>, usize),
    /// The colour of a light, which changes with it.
    LightColor(Arc<Object>),
    /// The path of a file.
    File(String),
    /// A curve, a curved surface or a mesh, and its share of the memory budget.
    Freeform(Box<Freeform>, Charge),
    /// A text that is read.
    Reader(Box<TextReader>),
    /// A text that is written.
    Writer(Box<TextWriter>),
    /// A key of a map with its value, and the map.
    Entry(Box<(Value, Value)>, Arc<Object>),
    /// Compares the other way round than this comparator, or than the natural order for null.
    Reversed(Value),
    /// A function as a value: a method of the model and what stands before its arguments.
    Function(MethodId, Vec<Value>),
    /// A pattern of numbers or moments.
    Pattern(Box<str>),
    /// A moment, in milliseconds since 1970.
    Moment(i64),
    /// A matrix.
    Matrix(Box<DMat4>),
    /// Nothing that can be told.
    Opaque,
}

/// An object of a class of the model.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Its class.
    pub ty: TypeId,
    /// The name of its class.
    pub name: Arc<str>,
    /// Its fields.
    pub fields: Vec<Value>,
    /// The message of what can be thrown.
    pub message: Option<Arc<Text>>,
    /// What it takes of the memory budget.
    pub charge: Charge,
}

/// Elements of a list, and the share of the memory budget they take.
#[derive(Clone, Debug, Default)]
pub struct List {
    /// The elements.
    pub values: Vec<Value>,
    /// What they take.
    pub charge: Charge,
}

/// What a `Phong` shader was given.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are those of its setters")]
pub struct Phong {
    pub diffuse: Paint,
    pub diffuse_transparency: Paint,
    pub specular: Paint,
    pub transparency: Paint,
    pub emissive: Paint,
    pub ambient: Paint,
    /// Sharpness of the gloss, 0..=1.
    pub shininess: Option<f64>,
    /// Sharpness of what passes, 0..=1.
    pub transparency_shininess: Option<f64>,
    /// Whether the matt and the glossy part only get what does not pass.
    pub is_interpolated: bool,
}

/// What a `Mirror`, `Metal`, `Glass`, `Pane` or `LeafShader` was given; its class says which.
#[derive(Clone, Debug, PartialEq)]
pub struct Finish {
    /// Red, green, blue: reflectance; of a pane, its tint; of glass, its absorption in 1/m.
    pub color: [f64; 3],
    /// What a leaf scatters through.
    pub through: [f64; 3],
    /// Index of refraction.
    pub ior: f64,
    /// 0 (smooth) to 1.
    pub roughness: f64,
}

/// Two shaders in one; its class says how they share the surface.
#[derive(Clone, Debug)]
pub struct Shaders {
    /// The front one; the one for pictures.
    pub first: Value,
    /// The back one; the one for light models.
    pub second: Value,
    /// The second's share of a mixture, 0..=1.
    pub share: f64,
}

impl Default for Phong {
    fn default() -> Self {
        let black = || Paint::Plain([0.0; 3]);
        Self {
            diffuse: Paint::Plain([0.5; 3]),
            diffuse_transparency: black(),
            specular: black(),
            transparency: black(),
            emissive: black(),
            ambient: black(),
            shininess: None,
            transparency_shininess: None,
            is_interpolated: true,
        }
    }
}

/// A source of light as the model described it; its class says which kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Red, green, blue of the light.
    pub color: [f32; 3],
    /// Watts (point, spot, area) or watts per square metre (directional, sky), summed over red, green and blue.
    pub power: f32,
    /// Half angle of a spot's full brightness, radians.
    pub inner_angle: f32,
    /// Half angle of a spot's cone, radians.
    pub outer_angle: f32,
    /// Exponent of the cosine by which an area shines.
    pub exponent: f32,
}

impl Light {
    /// White light of this power; spots with GroIMP's cone.
    pub fn new(power: f32) -> Self {
        let degrees = |d: f32| d / 180.0 * std::f32::consts::PI;
        let (inner_angle, outer_angle) = (degrees(22.5), degrees(30.0));
        Self {
            color: [1.0; 3],
            power,
            inner_angle,
            outer_angle,
            exponent: 1.0,
        }
    }
}

impl Object {
    /// A new object.
    pub fn new(class: ClassId, data: Data) -> Self {
        Self {
            class,
            data: Mutex::new(data),
        }
    }

    /// Access to what it holds. Never hold it while anything else is evaluated: the same object may be asked again.
    pub fn lock(&self) -> MutexGuard<'_, Data> {
        self.data.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The coordinates of a tuple (or of a colour); `None` for other objects.
    pub fn tuple(&self) -> Option<DVec3> {
        match &*self.lock() {
            Data::Tuple(v) => Some(*v),
            _ => None,
        }
    }

    /// The class of the model that it is an object of, if it is one.
    pub fn instance_type(&self) -> Option<TypeId> {
        match &*self.lock() {
            Data::Instance(instance) => Some(instance.ty),
            _ => None,
        }
    }

    /// `equals` for two different objects that stand in so many collections.
    pub(super) fn equals(a: &Arc<Self>, b: &Arc<Self>, depth: usize) -> bool {
        let (left, right) = (a.lock().clone(), b.lock().clone());
        match (left, right) {
            (Data::Tuple(a), Data::Tuple(b)) => a == b,
            (Data::Color(a), Data::Color(b)) => a == b,
            (Data::Shader(a), Data::Shader(b)) => a == b,
            (Data::Moment(a), Data::Moment(b)) => a == b,
            (Data::Matrix(a), Data::Matrix(b)) => a == b,
            (Data::Map(a), Data::Map(b)) | (Data::Set(a), Data::Set(b)) => a.holds_same(&b, depth),
            (Data::List(a), Data::List(b)) => {
                let mut pairs = a.values.iter().zip(&b.values);
                a.values.len() == b.values.len() && pairs.all(|(a, b)| a.equals_nested(b, depth))
            }
            _ => false,
        }
    }

    /// Moves the values that it holds to `parts`.
    pub(super) fn take_parts(&mut self, parts: &mut Vec<Value>) {
        match self.data.get_mut().unwrap_or_else(PoisonError::into_inner) {
            Data::List(list) => parts.append(&mut list.values),
            Data::Map(map) => parts.extend(std::mem::take(&mut **map).into_parts()),
            Data::Instance(instance) => parts.append(&mut instance.fields),
            Data::Set(map) => parts.extend(std::mem::take(&mut **map).into_parts()),
            Data::Table(table) => table.take_parts(parts),
            Data::Entry(entry, _) => {
                parts.push(std::mem::take(&mut entry.0));
                parts.push(std::mem::take(&mut entry.1));
            }
            Data::Reversed(value) => parts.push(std::mem::take(value)),
            Data::Function(_, captured) => parts.append(captured),
            Data::Shaders(pair) => {
                parts.push(std::mem::take(&mut pair.first));
                parts.push(std::mem::take(&mut pair.second));
            }
            _ => {}
        }
    }

    /// A number that equal objects share.
    pub fn hash_code(&self) -> i32 {
        match &*self.lock() {
            Data::Tuple(v) => v.to_array().iter().fold(1, |hash, x| {
                let bits = if *x == 0.0 { 0 } else { x.to_bits() };
                hash.wrapping_mul(31)
                    .wrapping_add((bits ^ (bits >> 32)) as i32)
            }),
            Data::List(list) => list.values.len() as i32,
            _ => 1,
        }
    }

    /// Appends its text, as its `toString()` gives it; it stands in so many collections.
    pub(super) fn append_nested(&self, out: &mut String, depth: usize) {
        // A copy, so that a list that contains itself can be asked again.
        let data = self.lock().clone();
        match data {
            Data::Tuple(v) => push_all(out, ["(", ")"], v.to_array(), |out, x| {
                out.push_str(&java_double_to_string(x));
            }),
            Data::Color(c) => push_all(out, ["(", ")"], c, |out, x| {
                out.push_str(&java_double_to_string(x));
            }),
            Data::Shader(c) => push_all(out, ["(", ")"], c, |out, x| {
                out.push_str(&java_float_to_string(x));
            }),
            Data::List(list) => push_all(out, ["[", "]"], &list.values, |out, v| {
                v.append_nested(out, depth);
            }),
            Data::Map(map) => push_all(
                out,
                ["{", "}"],
                map.entries(),
                |out, (key, value): &(Value, Value)| {
                    key.append_nested(out, depth);
                    out.push('=');
                    value.append_nested(out, depth);
                },
            ),
            Data::Buffer(text, _) => out.push_str(&text),
            Data::Throwable(message) => {
                out.push_str(&qualified(self.class));
                if let Some(message) = message {
                    out.push_str(": ");
                    out.push_str(message.as_str());
                }
            }
            Data::Instance(instance) => {
                out.push_str(&instance.name);
                if let Some(message) = instance.message {
                    out.push_str(": ");
                    out.push_str(message.as_str());
                }
            }
            Data::Set(set) => {
                push_all(
                    out,
                    ["[", "]"],
                    set.entries(),
                    |out, (key, _): &(Value, Value)| {
                        key.append_nested(out, depth);
                    },
                );
            }
            Data::Table(table) => out.push_str(&table.title),
            Data::File(path) => out.push_str(&path),
            Data::Tokens(_)
            | Data::Row(..)
            | Data::LightColor(_)
            | Data::Finish(_)
            | Data::Shaders(_) => {
                out.push_str(self.class.name());
            }
            Data::Entry(entry, _) => {
                entry.0.append_nested(out, depth);
                out.push('=');
                entry.1.append_nested(out, depth);
            }
            Data::Matrix(matrix) => {
                let is_small = self.class.is_a(ClassId::Matrix3d);
                out.push_str(&super::library::matrices::text_of(&matrix, is_small));
            }
            Data::Moment(millis) => out.push_str(&super::library::moments::text_of(millis)),
            Data::Reversed(_) | Data::Function(..) | Data::Pattern(_) | Data::Opaque => {
                out.push_str(self.class.name());
            }
            Data::Reader(_) | Data::Writer(_) | Data::Freeform(..) => {
                out.push_str(self.class.name());
            }
            Data::Picture(_) | Data::Placement(_) => out.push_str(self.class.name()),
            Data::Phong(_) | Data::Light(_) | Data::LightModel(_) | Data::Random(_) => {
                out.push_str(self.class.name());
            }
        }
    }
}

impl Drop for Object {
    fn drop(&mut self) {
        let mut parts = vec![];
        self.take_parts(&mut parts);
        free(parts);
    }
}

fn push_all<T>(
    out: &mut String,
    [open, close]: [&str; 2],
    parts: impl IntoIterator<Item = T>,
    mut push: impl FnMut(&mut String, T),
) {
    out.push_str(open);
    for (i, part) in parts.into_iter().enumerate() {
        if i > 0 {
            out.push_str(", ");
        }
        push(out, part);
    }
    out.push_str(close);
}

/// Java's full name of a class that can be thrown.
pub fn qualified(class: ClassId) -> String {
    let package = match class {
        ClassId::IOException | ClassId::FileNotFoundException => "java.io",
        ClassId::NoSuchElementException => "java.util",
        _ => "java.lang",
    };
    format!("{package}.{}", class.name())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_print_as_in_java() {
        let text = |class, data| Value::Object(Arc::new(Object::new(class, data))).to_string();
        assert_eq!(
            text(ClassId::Vector3d, Data::Tuple(DVec3::new(1.0, 0.0, -2.5))),
            "(1.0, 0.0, -2.5)"
        );
        let list = List {
            values: vec![Value::Int(3), Value::text("x")],
            charge: Charge::none(),
        };
        assert_eq!(text(ClassId::ArrayList, Data::List(list)), "[3, x]");
        let message = Some(Arc::new(Text::new("/ by zero", Charge::none())));
        let thrown = text(ClassId::ArithmeticException, Data::Throwable(message));
        assert_eq!(thrown, "java.lang.ArithmeticException: / by zero");
    }

    #[test]
    fn tuples_are_equal_by_value() {
        let point = |x| {
            Arc::new(Object::new(
                ClassId::Point3d,
                Data::Tuple(DVec3::new(x, 0.0, 0.0)),
            ))
        };
        assert!(Object::equals(&point(1.0), &point(1.0), 0));
        assert!(!Object::equals(&point(1.0), &point(2.0), 0));
        assert_eq!(point(0.0).hash_code(), point(-0.0).hash_code());
    }
}
