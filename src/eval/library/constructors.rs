//! Behaviour of every constructor.

use std::sync::Arc;

use super::{
    Arguments, Context, Maker, buffers, collections, data, files, freeform, light, light_models,
    lists, matrices, moments, more, new_object, pictures, random, shaders, strings, surfaces,
    vectors,
};
use crate::eval::object::Data;
use crate::eval::text::Text;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::{ClassId, ConstructorId as C};

/// What a constructor makes. One arm per row of the table, in its order.
pub fn constructor(id: C) -> Maker {
    match id {
        C::Tuple => vectors::make_zero,
        C::TupleOf => vectors::make,
        C::TupleCopy => vectors::make_copy,
        C::Matrix | C::Matrix3d => matrices::make,
        C::MatrixCopy | C::Matrix3dCopy => matrices::make_copy,
        C::Matrix3dOf => matrices::make_rows,
        C::RgbColor => shaders::make_color,
        C::Graytone => shaders::make_graytone,
        C::Shader => shaders::make_gray,
        C::ShaderRgb => shaders::make_rgb,
        C::ShaderBits => shaders::make_bits,
        C::ShaderRgba => shaders::make_rgba,
        C::Phong => shaders::make_phong,
        C::Mirror => surfaces::make_mirror,
        C::MirrorPart => surfaces::make_gray,
        C::MirrorColor | C::Metal | C::MetalRough => surfaces::make_colored,
        C::Glass | C::GlassOf | C::Pane | C::PaneOf => surfaces::make_clear,
        C::Leaf => surfaces::make_leaf,
        C::LeafColors => surfaces::make_leaf_of_colors,
        C::LeafLook => surfaces::make_leaf_of_look,
        C::ImageMap | C::ImageMapOf => pictures::make_image,
        C::Checker | C::CheckerOf => pictures::make_checker,
        C::Placement => pictures::make_placement,
        C::ShaderNamed => pictures::make_shader,
        C::Mix => surfaces::make_mix,
        C::PointLight | C::SpotLight | C::AreaLight => light::make_lamp,
        C::DirectionalLight => light::make_directional,
        C::LightModel | C::LightModelOf | C::LightModelLeast => light_models::make,
        C::Flux | C::FluxOf | C::FluxLeast | C::FluxOfSensors => light_models::make,
        C::Random => random::make,
        C::RandomSeed => random::make_seeded,
        C::Integer | C::Long | C::Double | C::Boolean | C::Character => boxed,
        C::Float => boxed_float,
        C::List | C::ListCapacity => collections::make_list,
        C::ListCopy => collections::make_list_copy,
        C::Map => collections::make_map,
        C::Set => collections::make_map_set,
        C::SetCopy => collections::make_set_copy,
        C::MapCapacity | C::MapEmpty => collections::make_map,
        C::Tokens | C::TokensBetween => more::make_tokens,
        C::Dataset | C::DatasetNamed => data::make,
        C::File | C::FileIn => files::make_file,
        C::ReaderPath | C::ReaderFile | C::ScannerPath => files::make_reader,
        C::ReaderOf | C::ScannerOf | C::WriterOf | C::WriterOfFlushed => files::make_same,
        C::WriterPath | C::WriterFile | C::WriterAppend | C::WriterFileAppend => files::make_writer,
        C::SwitchShader2 => surfaces::make_switch,
        C::SwitchShader3 => surfaces::make_switch_of_three,
        C::SideShaderFront => first_of,
        C::SideShader => surfaces::make_sides,
        C::RgbColorZero => shaders::make_color,
        C::ShaderOfColor => shaders::make_of_color,
        C::Buffer | C::BufferText | C::BufferCapacity => buffers::make,
        C::Date | C::DateOf => moments::make_date,
        C::SimpleDateFormat | C::DecimalFormat => moments::make_pattern,
        C::StringOfChars => strings::make_of_chars,
        C::TreeSet | C::SetCapacity => collections::make_map_set,
        C::TreeSetCopy => collections::make_set_copy,
        C::MapCopy | C::TreeMapCopy => collections::make_map_copy,
        C::MapLoad | C::TreeMap => collections::make_map,
        C::Throwable => throwable,
        C::ThrowableText => throwable_with_text,
        C::String => strings::make_empty,
        C::StringCopy => strings::make_copy,
        C::VertexListImpl => freeform::make_points,
        C::CircleUnit | C::CircleOf => freeform::make_circle,
        C::RegularHexagon | C::RegularPolygonOf => freeform::make_polygon,
        C::BSplineOfVertices => freeform::make_spline,
        C::InterpolatedCurve => freeform::make_through,
        C::BezierSurface | C::BSplineGrid => freeform::make_grid,
        C::ProfileSweep => freeform::make_sweep,
        C::SkinnedSweep => files::make_same,
        C::SkinnedSurface => freeform::make_skin,
        C::SurfaceOfRevolution => freeform::make_revolution,
        C::FloatList | C::IntList => collections::make_list,
        C::FloatListOf | C::IntListOf => lists::make_list_of,
        C::PolygonMesh => freeform::make_mesh,
    }
}

/// One shader for both sides.
fn first_of(_: &mut Context<'_>, _: ClassId, args: &[Value]) -> Result<Value, Trap> {
    Ok(args.at(0).clone())
}

fn boxed(_: &mut Context<'_>, _: ClassId, args: &[Value]) -> Result<Value, Trap> {
    Ok(args.at(0).clone())
}

fn boxed_float(_: &mut Context<'_>, _: ClassId, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Float(args.float(0)))
}

fn throwable(_: &mut Context<'_>, class: ClassId, _: &[Value]) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Throwable(None)))
}

fn throwable_with_text(_: &mut Context<'_>, class: ClassId, args: &[Value]) -> Result<Value, Trap> {
    let message = match args.at(0) {
        Value::Text(text) => Some(Arc::<Text>::clone(text)),
        _ => None,
    };
    Ok(new_object(class, Data::Throwable(message)))
}
