//! Behaviour of every method.

use super::Behaviour::{self, Native};
use super::{
    Arguments, Context, arrays, buffers, collections, data, deques, files, freeform, getter, keyed,
    light, moments, more, numbers, ordering, random, setter, shaders, strings, surfaces, system,
    values, vectors,
};
use crate::eval::object::Data;
use crate::eval::trap::{Trap, describe};
use crate::eval::value::Value;
use crate::library::MethodId as M;

/// What a method does; the receiver is its first argument. One arm per row of the table, in its order.
pub fn method(id: M) -> Behaviour {
    Native(match id {
        M::ObjectEquals => equals,
        M::ObjectToString => strings::to_string,
        M::ObjectGetClass => values::class_of,
        M::ArrayClone => arrays::copy,
        M::ClassSimpleName => values::simple_name,
        M::ClassName => values::full_name,
        M::NodeId => values::id,
        M::NodeSuccessor => values::successor,
        M::NodePredecessor => values::predecessor,
        M::NodeBranch => values::branch,
        M::NodeAxisParent => values::axis_parent,
        M::NodeChildCount => values::n_children,
        M::NodeIsAncestorOf => values::is_ancestor,
        M::ObjectHashCode => hash_code,
        M::StringLength => strings::length,
        M::StringCharAt => strings::char_at,
        M::StringSubstring => strings::substring,
        M::StringSubstringTo => strings::substring_to,
        M::StringIndexOf => strings::index_of,
        M::StringIndexOfFrom => strings::index_of_from,
        M::StringIndexOfChar => strings::index_of_char,
        M::StringLastIndexOf => strings::last_index_of,
        M::StringEqualsIgnoreCase => strings::equals_ignore_case,
        M::StringCompareTo => strings::compare_to,
        M::StringToUpperCase => strings::to_upper_case,
        M::StringToLowerCase => strings::to_lower_case,
        M::StringTrim => strings::trim,
        M::StringStartsWith => strings::starts_with,
        M::StringEndsWith => strings::ends_with,
        M::StringContains => strings::contains,
        M::StringReplace => strings::replace,
        M::StringReplaceChar => strings::replace_char,
        M::StringIsEmpty => strings::is_empty,
        M::StringSplit => strings::split,
        M::StringSplitLimit => strings::split_limit,
        M::StringConcat => strings::concat,
        M::StringToCharArray => strings::to_char_array,
        M::TupleX => |cx, args| get(cx, args, M::TupleX),
        M::TupleY => |cx, args| get(cx, args, M::TupleY),
        M::TupleZ => |cx, args| get(cx, args, M::TupleZ),
        M::TupleSetX => |cx, args| set(cx, args, M::TupleSetX),
        M::TupleSetY => |cx, args| set(cx, args, M::TupleSetY),
        M::TupleSetZ => |cx, args| set(cx, args, M::TupleSetZ),
        M::TupleSet => vectors::set,
        M::TupleSetTuple => vectors::set_tuple,
        M::TupleAdd => vectors::add,
        M::TupleAddOf => vectors::add_of,
        M::TupleSub => vectors::sub,
        M::TupleSubOf => vectors::sub_of,
        M::TupleScale => vectors::scale,
        M::TupleScaleOf => vectors::scale_of,
        M::TupleScaleAdd => vectors::scale_add,
        M::TupleNegate => vectors::negate,
        M::TupleInterpolate => vectors::interpolate,
        M::VectorLength => vectors::length,
        M::VectorLengthSquared => vectors::length_squared,
        M::VectorNormalize => vectors::normalize,
        M::VectorNormalizeOf => vectors::normalize_of,
        M::VectorDot | M::VectorTimesVector => vectors::dot,
        M::VectorCross => vectors::cross,
        M::VectorAngle => vectors::angle,
        M::PointDistance => vectors::distance,
        M::PointDistanceSquared => vectors::distance_squared,
        M::VectorPlus => vectors::vector_plus,
        M::PointPlus => vectors::point_plus,
        M::VectorMinus | M::PointMinusPoint => vectors::vector_minus,
        M::PointMinusVector => vectors::point_minus,
        M::VectorTimes => vectors::times,
        M::VectorOver => vectors::over,
        M::SpectrumIntegrate => vectors::integrate,
        M::ShaderAverageColor => shaders::average_color,
        M::ShaderRed => |cx, args| get(cx, args, M::ShaderRed),
        M::ShaderGreen => |cx, args| get(cx, args, M::ShaderGreen),
        M::ShaderBlue => |cx, args| get(cx, args, M::ShaderBlue),
        M::ShaderAlpha => |cx, args| get(cx, args, M::ShaderAlpha),
        M::ShaderSetRed => |cx, args| set(cx, args, M::ShaderSetRed),
        M::ShaderSetGreen => |cx, args| set(cx, args, M::ShaderSetGreen),
        M::ShaderSetBlue => |cx, args| set(cx, args, M::ShaderSetBlue),
        M::ShaderSetAlpha => |cx, args| set(cx, args, M::ShaderSetAlpha),
        M::PhongSetDiffuse => shaders::set_diffuse,
        M::PhongSetSpecular => shaders::set_specular,
        M::PhongSetShininess => shaders::set_shininess_map,
        M::PhongSetShininessValue => shaders::set_shininess,
        M::PhongSetTransparency => shaders::set_transparency,
        M::PhongSetDiffuseTransparency => shaders::set_diffuse_transparency,
        M::PhongSetTransparencyShininess => shaders::set_transparency_shininess,
        M::PhongSetInterpolatedTransparency => shaders::set_interpolated,
        M::MetalSetRoughness | M::GlassSetRoughness => surfaces::set_roughness,
        M::GlassSetAbsorption | M::PaneSetTint => surfaces::set_color,
        M::PhongSetAmbient => shaders::set_ambient,
        M::PhongSetEmissive => shaders::set_emissive,
        M::LightSetColor => light::set_color,
        M::LightSetColorMap => light::set_color_map,
        M::LightSetShadowless => system::nothing,
        M::PointLightSetPower | M::DirectionalLightSetPowerDensity | M::AreaLightSetPower => {
            light::set_power
        }
        M::SpotLightSetInnerAngle => light::set_inner_angle,
        M::SpotLightSetOuterAngle => light::set_outer_angle,
        M::AreaLightSetExponent => light::set_exponent,
        M::LightModelSetSeed => light::set_seed,
        M::LightModelSetRayCount => light::set_ray_count,
        M::LightModelSetDepth => light::set_depth,
        M::LightModelCompute | M::LightModelAbsorbedPower | M::LightModelAbsorbedPower3d => {
            light::unsupported
        }
        M::RandomSetSeed => random::own_set_seed,
        M::RandomNextInt => random::own_int,
        M::RandomNextIntBelow => random::own_int_below,
        M::RandomNextLong => random::own_long,
        M::RandomNextFloat => random::own_float,
        M::RandomNextDouble => random::own_double,
        M::RandomNextBoolean => random::own_boolean,
        M::RandomNextGaussian => random::own_gaussian,
        M::NumberIntValue => numbers::int_value,
        M::NumberLongValue => numbers::long_value,
        M::NumberFloatValue => numbers::float_value,
        M::NumberDoubleValue => numbers::double_value,
        M::BooleanValue | M::CharacterValue => numbers::same,
        M::CollectionSize => collections::size,
        M::CollectionIsEmpty => collections::is_empty,
        M::CollectionContains => collections::contains,
        M::ListAdd => collections::add,
        M::ListInsert => collections::insert,
        M::ListAddAll => collections::add_all,
        M::ListGet => collections::get,
        M::ListSet => collections::set,
        M::ListRemoveAt => collections::remove_at,
        M::ListRemove => collections::remove,
        M::ListIndexOf => collections::index_of,
        M::ListClear => collections::clear,
        M::StringStrip => strings::strip,
        M::StringIsBlank => strings::is_blank,
        M::StringRepeat => strings::repeat,
        M::StringCompareToIgnoreCase => strings::compare_ignoring_case,
        M::StringIntern => numbers::same,
        M::StringStartsWithAt => strings::starts_with_at,
        M::CollectionToArray | M::CollectionToArrayOf => deques::to_array,
        M::CollectionContainsAll => deques::contains_all,
        M::CollectionAddAll => deques::add_all,
        M::CollectionRemoveAll => deques::remove_all,
        M::CollectionRetainAll => deques::retain_all,
        M::CollectionForEach => deques::for_each,
        M::ListInsertAll => deques::insert_all,
        M::ListLastIndexOf => deques::last_index_of,
        M::ListSubList => deques::sub_list,
        M::ListSortBy => ordering::sort,
        M::ListEnsureCapacity | M::ListTrimToSize | M::RuntimeGc => system::nothing,
        M::VectorFirstElement | M::QueueElement => collections::first,
        M::VectorLastElement => collections::last,
        M::VectorInsertElementAt => deques::insert_element,
        M::VectorSetElementAt => deques::set_element,
        M::VectorRemoveElementAt => collections::remove_at,
        M::VectorRemoveElement => collections::remove,
        M::VectorRemoveAll => collections::clear,
        M::QueueOffer | M::DequeOfferLast => collections::add,
        M::QueuePoll | M::DequePollFirst => deques::poll_first,
        M::QueuePeek | M::DequePeekFirst => deques::peek_first,
        M::QueueRemove | M::DequePop => collections::remove_first,
        M::DequePush | M::DequeOfferFirst => deques::offer_first,
        M::DequePollLast => deques::poll_last,
        M::DequePeekLast => deques::peek_last,
        M::StackSearch => deques::search,
        M::TreeSetFirst | M::TreeMapFirstKey => keyed::first_key,
        M::TreeSetLast | M::TreeMapLastKey => keyed::last_key,
        M::IteratorRemove => more::remove,
        M::StringReplaceAll => strings::replace_all,
        M::StringReplaceFirst => strings::replace_first,
        M::StringIndexOfCharFrom => strings::index_of_char_from,
        M::StringLastIndexOfChar => strings::last_index_of_char,
        M::ListAddElement | M::ListAddLast => collections::add,
        M::StackPush => collections::push,
        M::ListElementAt => collections::get,
        M::ListFirst => collections::first,
        M::ListLast | M::StackPeek => collections::last,
        M::ListAddFirst => collections::add_first,
        M::ListRemoveFirst => collections::remove_first,
        M::ListRemoveLast | M::StackPop => collections::remove_last,
        M::StackEmpty => collections::is_empty,
        M::CollectionIterator => more::iterator,
        M::IteratorHasNext | M::TokensHasMore => more::has_next,
        M::IteratorNext | M::TokensNext => more::next,
        M::TokensCount => more::count_tokens,
        M::SetAdd => keyed::set_add,
        M::SetRemove => keyed::set_remove,
        M::SetClear => keyed::map_clear,
        M::DatasetResolve => data::same,
        M::DatasetClear => data::clear,
        M::DatasetSetTitle => data::set_title,
        M::DatasetSetColumnKey => data::set_column_key,
        M::DatasetColumnKey => data::column_key,
        M::DatasetSetRowKey => data::set_row_key,
        M::DatasetRowKey => data::row_key,
        M::DatasetColumnCount => data::n_columns,
        M::DatasetRowCount => data::n_rows,
        M::DatasetCell => data::cell,
        M::DatasetSetCell => data::set_cell,
        M::DatasetAddRow => data::add_row,
        M::DatasetGetRow => data::row,
        M::RowSet => data::row_set,
        M::RowGet => data::row_get,
        M::RowSetKey => data::row_set_key,
        M::RowAppend => data::row_append,
        M::FileName => files::name,
        M::FilePath | M::FileAbsolutePath => files::path,
        M::FileExists => files::exists,
        M::FileIsDirectory => files::is_folder,
        M::FileIsFile => files::is_file,
        M::FileList => files::list,
        M::FileListFiles => files::list_files,
        M::FileParent => files::parent,
        M::FileMkdir | M::FileMkdirs => files::make_folder,
        M::FileCreate => files::create,
        M::ReaderReadLine => files::read_line,
        M::ReaderRead => files::read_char,
        M::ReaderClose | M::WriterClose => files::close,
        M::ReaderReady | M::ScannerHasNextLine => files::has_line,
        M::ScannerHasNext => files::has_word,
        M::ScannerNextLine => files::scan_line,
        M::ScannerNext => files::scan_word,
        M::ScannerNextInt => files::scan_int,
        M::ScannerNextDouble => files::scan_double,
        M::WriterPrint | M::WriterWrite => files::print,
        M::WriterAppend => files::print_chain,
        M::WriterPrintln | M::WriterPrintlnText | M::WriterNewLine => files::println,
        M::WriterWriteChar => files::write_char,
        M::WriterFlush => files::flush,
        M::ViewRepaint
        | M::LightSetVisualize
        | M::LightSetRaylength
        | M::LightSetIgnored
        | M::PointLightSetExponent
        | M::PointLightSetDistance
        | M::AreaLightSetVisible
        | M::LightModelSetThreadCount => system::nothing,
        M::PointLightPower | M::DirectionalLightPowerDensity | M::AreaLightPower => light::power,
        M::SpotLightInnerAngle => light::inner_angle,
        M::SpotLightOuterAngle => light::outer_angle,
        M::LightModelSetLayerVisible => light::set_layer_visible,
        M::LightModelSetMinPower => light::set_min_power,
        M::LightModelRayCount => light::ray_count,
        M::LightModelDepth => light::depth,
        M::ColorSet | M::ColorSetParts => shaders::set_rgb,
        M::LightGetColor => shaders::light_color,
        M::LightModelComputeForced | M::LightModelSensed | M::LightModelSensed3d => {
            light::unsupported
        }
        M::MapContainsValue => keyed::contains_value,
        M::MapGetOrDefault => keyed::get_or_default,
        M::MapPut => keyed::put,
        M::MapGet => keyed::get,
        M::MapContainsKey => keyed::contains,
        M::MapRemove => keyed::remove,
        M::MapSize => keyed::map_size,
        M::MapIsEmpty => keyed::map_is_empty,
        M::MapClear => keyed::map_clear,
        M::MapKeySet => keyed::key_set,
        M::MapValues => keyed::map_values,
        M::MapEntrySet => keyed::entry_set,
        M::MapPutAll => keyed::put_all,
        M::MapPutIfAbsent => keyed::put_if_absent,
        M::EntryKey => keyed::entry_key,
        M::EntryValue => keyed::entry_value,
        M::EntrySetValue => keyed::entry_set_value,
        M::BufferAppend => buffers::append,
        M::BufferLength => buffers::length,
        M::BufferCharAt => buffers::char_at,
        M::BufferInsert => buffers::insert,
        M::BufferReverse => buffers::reverse,
        M::BufferSetLength => buffers::set_length,
        M::BufferDeleteCharAt => buffers::delete_char_at,
        M::BufferDelete => buffers::delete,
        M::BufferReplace => buffers::replace,
        M::BufferSetCharAt => buffers::set_char_at,
        M::BufferIndexOf => buffers::index_of,
        M::BufferLastIndexOf => buffers::last_index_of,
        M::BufferSubstring => buffers::substring,
        M::BufferSubstringTo => buffers::substring_to,
        M::BufferIsEmpty => buffers::is_empty,
        M::ComparatorCompare => ordering::compare,
        M::ComparatorReversed => ordering::reversed,
        M::ComparableCompareTo | M::NumberCompareTo => ordering::compare_to,
        M::DoubleIsNaNValue => numbers::is_nan,
        M::RuntimeTotalMemory | M::RuntimeMaxMemory => moments::total_memory,
        M::RuntimeFreeMemory => moments::free_memory,
        M::RuntimeProcessors => moments::n_processors,
        M::DateTime => moments::time,
        M::DateFormat => moments::format_date,
        M::DecimalFormat => moments::format_number,
        M::FunctionEvaluate => values::evaluate,
        M::WriterPrintf | M::WriterFormat => files::print_formatted,
        M::ThrowableMessage | M::ThrowableLocalizedMessage => message,
        M::ThrowableSetMessage => set_message,
        M::MeshSetVertices => freeform::set_vertices,
        M::MeshSetIndices => freeform::set_indices,
        M::MeshSetNormals => freeform::set_normals,
        M::MeshSetTextures => freeform::set_textures,
        M::ThrowablePrintStackTrace => print_stack_trace,
    })
}

fn get(cx: &Context<'_>, args: &[Value], id: M) -> Result<Value, Trap> {
    Ok(getter(id)(&cx.object(args, 0)?.lock()))
}

fn set(cx: &Context<'_>, args: &[Value], id: M) -> Result<Value, Trap> {
    setter(id)(&mut cx.object(args, 0)?.lock(), args.at(1));
    Ok(Value::Null)
}

fn equals(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    if matches!(args.at(0), Value::Null) {
        return Err(Trap::null("call `equals` of an object", cx.span));
    }
    Ok(Value::Boolean(cx.equal(args.at(0), args.at(1))?))
}

fn hash_code(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    if matches!(args.at(0), Value::Null) {
        return Err(Trap::null("call `hashCode` of an object", cx.span));
    }
    Ok(Value::Int(cx.program.hash(
        cx.machine,
        args.at(0),
        cx.span,
    )?))
}

/// The message of an exception, null if it has none.
fn message(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(match &*cx.object(args, 0)?.lock() {
        Data::Throwable(Some(text)) => Value::Text(text.clone()),
        Data::Instance(instance) => match &instance.message {
            Some(text) => Value::Text(text.clone()),
            None => Value::Null,
        },
        _ => Value::Null,
    })
}

/// The message that a class of the model gives to the exception it extends.
fn set_message(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    if let (Data::Instance(instance), Value::Text(text)) =
        (&mut *cx.object(args, 0)?.lock(), args.at(1))
    {
        instance.message = Some(text.clone());
    }
    Ok(Value::Null)
}

fn print_stack_trace(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let line = describe(args.at(0)) + "\n";
    cx.machine.print(&line);
    Ok(Value::Null)
}
