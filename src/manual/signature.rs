//! How something is called, as one line of text.

use crate::library::{ClassId, ConstantValue, LibraryConstant, Signature, ValueType};
use crate::turtle::{BuiltinField, BuiltinType, FieldType};

/// The name of a type of the library's tables.
pub fn type_name(ty: ValueType) -> &'static str {
    match ty {
        ValueType::Void => "void",
        ValueType::Boolean => "boolean",
        ValueType::Char => "char",
        ValueType::Int => "int",
        ValueType::Long => "long",
        ValueType::Float => "float",
        ValueType::Double => "double",
        ValueType::String => "String",
        ValueType::Text => "any",
        ValueType::Object => "Object",
        ValueType::Node => "Node",
        ValueType::Class(class) => class.name(),
        ValueType::CharArray => "char[]",
        ValueType::FloatArray => "float[]",
        ValueType::IntArray => "int[]",
        ValueType::StringArray => "String[]",
        ValueType::FileArray => "File[]",
        ValueType::ObjectArray => "Object[]",
        ValueType::Objects => "Object...",
        ValueType::Same => "the same type",
        ValueType::Argument(0) => "its element type",
        ValueType::Argument(_) => "its value type",
        ValueType::Of(class, _) => class.name(),
        ValueType::Entries => "Set",
    }
}

/// The name of the type of a built-in property.
pub fn field_type_name(ty: FieldType) -> &'static str {
    match ty {
        FieldType::Boolean => "boolean",
        FieldType::Int => "int",
        FieldType::Float => "float",
        FieldType::Double => "double",
        FieldType::String => "String",
        FieldType::Vector => "Vector3d",
        FieldType::Transformation => "transformation",
        FieldType::Shader => "Shader",
        FieldType::Light => "Light",
        FieldType::Surface => "BSplineSurface",
        FieldType::Polygons => "Polygons",
        FieldType::Floats => "float[]",
        FieldType::Node => "Node",
    }
}

/// The name by which a property is spoken of: constructors also fill properties that have none in the language.
pub fn field_name(name: &str) -> &str {
    match name {
        "width.full" => "width",
        _ => name.strip_prefix("transform.").unwrap_or(name),
    }
}

/// The parameters of a call, one by one: `double angle`.
pub fn params(row: &Signature) -> Vec<String> {
    let named = |(ty, name): (&ValueType, &&str)| format!("{} {name}", type_name(*ty));
    row.params.iter().zip(row.names).map(named).collect()
}

/// `float random(float a, float b)`, `double Math.sin(double angle)`, `new Vector3d(double x, double y, double z)`.
pub fn call(row: &Signature) -> String {
    let params = params(row).join(", ");
    if row.name == "new" {
        return format!("new {}({params})", row.owner);
    }
    let owner = if row.owner.is_empty() {
        String::new()
    } else {
        format!("{}.", row.owner)
    };
    format!("{} {owner}{}({params})", type_name(row.result), row.name)
}

/// The ways of making a node: `F`, `F(length)`, `F(length, diameter)`.
pub fn constructors(row: &BuiltinType) -> Vec<String> {
    let form = |names: &&[&str]| {
        let names: Vec<&str> = names.iter().map(|name| field_name(name)).collect();
        if names.is_empty() {
            row.name.to_owned()
        } else {
            format!("{}({})", row.name, names.join(", "))
        }
    };
    row.constructors.iter().map(form).collect()
}

/// The properties that each way of making a node fills, in order.
pub fn constructor_fields(row: &'static BuiltinType) -> Vec<Vec<&'static BuiltinField>> {
    let lineage = || std::iter::successors(Some(row), |row| builtin_named(row.parent));
    let field = |name: &&str| {
        let mut fields = lineage().flat_map(|row| row.fields);
        fields.find(|field| field.name == *name)
    };
    let fields = |names: &&[&str]| names.iter().filter_map(field).collect();
    row.constructors.iter().map(fields).collect()
}

/// The value that a property begins with: `0.5`, `true`, `null`.
pub fn default_value(field: &BuiltinField) -> String {
    match field.ty {
        FieldType::Boolean => (field.default > 0.0).to_string(),
        FieldType::Int | FieldType::Float | FieldType::Double => field.default.to_string(),
        FieldType::String
        | FieldType::Vector
        | FieldType::Transformation
        | FieldType::Shader
        | FieldType::Light
        | FieldType::Surface
        | FieldType::Polygons
        | FieldType::Floats
        | FieldType::Node => "null".into(),
    }
}

/// `float length = 1 m`
pub fn property(field: &BuiltinField) -> String {
    let unit = if field.unit.is_empty() {
        String::new()
    } else {
        format!(" {}", field.unit)
    };
    format!(
        "{} {} = {}{unit}",
        field_type_name(field.ty),
        field_name(field.name),
        default_value(field)
    )
}

/// `double Math.PI = 3.141592653589793`
pub fn constant(row: &LibraryConstant) -> String {
    let owner = if row.owner.is_empty() {
        String::new()
    } else {
        format!("{}.", row.owner)
    };
    let (ty, value) = match row.value {
        ConstantValue::Null(class) => (class.name(), "null".into()),
        ConstantValue::Int(v) => ("int", v.to_string()),
        ConstantValue::Long(v) => ("long", v.to_string()),
        ConstantValue::Float(v) => ("float", format!("{v:?}")),
        ConstantValue::Double(v) => ("double", format!("{v:?}")),
        ConstantValue::Shader([r, g, b]) => ("RGBAShader", format!("rgb({r}, {g}, {b})")),
    };
    format!("{ty} {owner}{} = {value}", row.name)
}

/// `Spectrum3d extends Vector3d`
pub fn class(class: ClassId) -> String {
    match class.parent() {
        Some(parent) => format!("{} extends {}", class.name(), parent.name()),
        None => class.name().into(),
    }
}

/// The built-in type of this name.
pub fn builtin_named(name: &str) -> Option<&'static BuiltinType> {
    crate::turtle::builtin_types().find(|row| row.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::{ConstructorId, FunctionId};

    #[test]
    fn signatures_are_written_as_in_java() {
        assert_eq!(
            call(FunctionId::Sin.signature()),
            "double Math.sin(double angle)"
        );
        assert_eq!(
            call(FunctionId::PrintText.signature()),
            "void print(any value)"
        );
        assert_eq!(
            call(ConstructorId::TupleOf.signature()),
            "new Tuple3d(double x, double y, double z)"
        );
        let f = builtin_named("F").unwrap();
        assert_eq!(constructors(f)[..2], ["F", "F(length)"]);
        assert_eq!(property(&f.fields[0]), "float length = 1 m");
        let leaf = builtin_named("Parallelogram").unwrap();
        assert_eq!(constructors(leaf)[1], "Parallelogram(length, width)");
    }
}
