//! Behaviour of every function.

use super::Behaviour::{
    self, Double1, Double2, DoubleToLong, Float1, Float2, FloatToInt, Int1, Int2, Long1, Long2,
    Native,
};
use super::{data, format, more, numbers, places, precise, random, shaders, strings, system};
use crate::library::FunctionId as F;
use crate::math::functions as math;

/// What a function does. One arm per row of the table, in its order.
pub fn function(id: F) -> Behaviour {
    match id {
        F::Println | F::SystemOutPrintln => Native(system::println),
        F::PrintlnText | F::SystemOutPrintlnText => Native(system::println_text),
        F::PrintText | F::SystemOutPrintText => Native(system::print_text),
        F::ClearConsole => Native(system::nothing),
        F::Random => Native(random::random),
        F::Irandom => Native(random::irandom),
        F::NormalFloat => Native(random::normal_float),
        F::NormalDouble => Native(random::normal_double),
        F::Lognormal => Native(random::lognormal),
        F::Probability => Native(random::probability),
        F::Distribution => Native(random::distribution),
        F::SetSeed => Native(random::set_seed),
        F::Derive => Native(system::derive),
        F::Reset => Native(system::reset),
        F::SetDerivationMode => Native(system::set_derivation_mode),
        F::GetDerivationMode => Native(system::derivation_mode),
        F::Location => Native(places::location),
        F::Endlocation => Native(places::end_location),
        F::Direction => Native(places::direction),
        F::Enddirection => Native(places::end_direction),
        F::DistanceNodes => Native(places::distance),
        F::DistanceSquaredNodes => Native(places::distance_squared),
        F::DistancePoints => Native(places::distance_of_points),
        F::AngleNode => Native(places::angle),
        F::Chart | F::ChartNamed => Native(data::chart),
        F::ShaderNamed => Native(shaders::named),
        F::Export3d | F::Snapshot | F::RunLater | F::Workbench | F::RepaintView | F::Gc => {
            Native(system::nothing)
        }
        F::DefaultView => Native(system::view),
        F::Stop => Native(system::stop),
        F::Exit => Native(system::exit),
        F::ArraysToString => Native(more::array_text),
        F::ArraysSort => Native(more::sort_array),
        F::ArraysFill => Native(more::fill_array),
        F::ArraysAsList => Native(more::as_list),
        F::CollectionsSort => Native(more::sort),
        F::CollectionsReverse => Native(more::reverse),
        F::CollectionsShuffle => Native(more::shuffle),
        F::CollectionsMin => Native(more::least),
        F::CollectionsMax => Native(more::greatest),
        F::AttributeRadius => Native(places::radius),
        F::AttributeDtgColor => Native(places::color_index),
        F::AttributeShader => Native(places::shader),
        F::AttributeOrder => Native(places::order),
        F::SqrInt => Int1(|x| x.wrapping_mul(x)),
        F::SqrFloat => Float1(|x| x * x),
        F::SqrDouble => Double1(|x| x * x),
        F::AbsInt => Int1(i32::wrapping_abs),
        F::AbsLong => Long1(i64::wrapping_abs),
        F::AbsFloat => Float1(f32::abs),
        F::AbsDouble => Double1(f64::abs),
        F::MinInt => Int2(i32::min),
        F::MinLong => Long2(i64::min),
        F::MinFloat => Float2(numbers::min_float),
        F::MinDouble => Double2(numbers::min_double),
        F::MaxInt => Int2(i32::max),
        F::MaxLong => Long2(i64::max),
        F::MaxFloat => Float2(numbers::max_float),
        F::MaxDouble => Double2(numbers::max_double),
        F::RoundFloat => FloatToInt(numbers::round_float),
        F::RoundDouble => DoubleToLong(numbers::round_double),
        F::Rint => Double1(f64::round_ties_even),
        F::Floor => Double1(f64::floor),
        F::Ceil => Double1(f64::ceil),
        F::Sqrt => Double1(f64::sqrt),
        F::Cbrt => Double1(math::cbrt),
        F::Pow => Double2(precise::pow),
        F::Exp => Double1(precise::exp),
        F::Expm1 => Double1(libm::expm1),
        F::Log => Double1(precise::ln),
        F::Log10 => Double1(precise::log10),
        F::Log1p => Double1(libm::log1p),
        F::Sin => Double1(math::sin),
        F::Cos => Double1(math::cos),
        F::Tan => Double1(math::tan),
        F::Asin => Double1(math::asin),
        F::Acos => Double1(math::acos),
        F::Atan => Double1(math::atan),
        F::Atan2 => Double2(math::atan2),
        F::Sinh => Double1(libm::sinh),
        F::Cosh => Double1(libm::cosh),
        F::Tanh => Double1(libm::tanh),
        F::Hypot => Double2(libm::hypot),
        F::ToRadians => Double1(numbers::to_radians),
        F::ToDegrees => Double1(numbers::to_degrees),
        F::SignumFloat => Float1(numbers::signum_float),
        F::SignumDouble => Double1(numbers::signum_double),
        F::FloorDivInt => Native(numbers::floor_div),
        F::FloorModInt => Native(numbers::floor_mod),
        F::MathRandom => Native(random::uniform_double),
        F::ParseInt | F::IntegerValueOfText => Native(numbers::parse_int),
        F::ParseLong => Native(numbers::parse_long),
        F::ParseFloat | F::FloatValueOfText => Native(numbers::parse_float),
        F::ParseDouble | F::DoubleValueOfText => Native(numbers::parse_double),
        F::ParseBoolean => Native(numbers::parse_boolean),
        F::IntegerValueOf | F::LongValueOf | F::FloatValueOf | F::DoubleValueOf => {
            Native(numbers::same)
        }
        F::IntegerToHexString => Native(numbers::to_hex),
        F::IntegerToBinaryString => Native(numbers::to_binary),
        F::FloatIsNaN | F::DoubleIsNaN => Native(numbers::is_nan),
        F::FloatIsInfinite | F::DoubleIsInfinite => Native(numbers::is_infinite),
        F::DoubleCompare => Native(numbers::compare),
        F::IsDigit => Native(strings::is_digit),
        F::IsLetter => Native(strings::is_letter),
        F::IsWhitespace => Native(strings::is_whitespace),
        F::IntegerToString
        | F::LongToString
        | F::FloatToString
        | F::DoubleToString
        | F::BooleanToString
        | F::CharacterToString
        | F::StringValueOf => Native(strings::value_of),
        F::StringFormat1
        | F::StringFormat2
        | F::StringFormat3
        | F::StringFormat4
        | F::StringFormat5
        | F::StringFormat6
        | F::StringFormat7
        | F::StringFormat8 => Native(format::format),
        F::CurrentTimeMillis | F::NanoTime => Native(system::time),
    }
}
