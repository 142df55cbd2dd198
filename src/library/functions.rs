//! Functions: those of the language's own library, and the static methods of Java classes that models use.

use std::sync::LazyLock;

use super::ValueType::{
    Boolean, Char, Class, Double, Float, FloatArray, Int, Long, Node, Object, String, Text, Void,
};
use super::signature::{Index, index, signatures};
use super::{ClassId, Effect, Signature, ValueType};

const POINT: ValueType = Class(ClassId::Point3d);
const VECTOR: ValueType = Class(ClassId::Vector3d);
const TUPLE: ValueType = Class(ClassId::Tuple3d);
const SHADER: ValueType = Class(ClassId::Shader);

signatures! {
    /// A function of the language: one per overload.
    FunctionId;
    Println = ""."println"() -> Void, Prints, "", "Ends the line.";
    PrintlnText = ""."println"(Text) -> Void, Prints, "", "Prints a value and ends the line.";
    PrintText = ""."print"(Text) -> Void, Prints, "", "Prints a value.";
    ClearConsole = ""."clearConsole"() -> Void, Prints, "", "Empties the console of a window; nothing where there is none.";

    Random = ""."random"(Float, Float) -> Float, Random, "", "Uniform in [a, b): `nextFloat() * (b - a) + a`.";
    Irandom = ""."irandom"(Int, Int) -> Int, Random, "", "Uniform integer, both ends included: `nextInt(b + 1 - a) + a`.";
    NormalFloat = ""."normal"(Float, Float) -> Float, Random, "", "Normal with mean and standard deviation, from `nextGaussian()` rounded to float.";
    NormalDouble = ""."normal"(Double, Double) -> Double, Random, "", "Normal with mean and standard deviation.";
    Lognormal = ""."lognormal"(Double, Double) -> Double, Random, "", "Log-normal with mean and standard deviation of the variable itself.";
    Probability = ""."probability"(Float) -> Boolean, Random, "", "True with this probability; draws nothing where it is at least 1.";
    Distribution = ""."distribution"(FloatArray) -> Int, Random, "", "Index i with probability `p[i]`.";
    SetSeed = ""."setSeed"(Long) -> Void, Random, "", "Starts the model's generator anew.";

    Derive = ""."derive"() -> Void, Writes, "", "Applies what the rules have queued: one step.";
    Reset = ""."reset"() -> Void, Writes, "", "Starts again: empty graph, then `init()`.";
    SetDerivationMode = ""."setDerivationMode"(Int) -> Void, Writes, "", "Chooses how rules are applied from here on.";
    GetDerivationMode = ""."getDerivationMode"() -> Int, Writes, "", "How rules are applied.";

    Location = ""."location"(Node) -> POINT, Graph, "m", "Origin of the node's local coordinates.";
    Endlocation = ""."endlocation"(Node) -> POINT, Graph, "m", "Origin of the local coordinates of the node's children.";
    Direction = ""."direction"(Node) -> VECTOR, Graph, "", "Direction of growth (local z) at the node.";
    Enddirection = ""."enddirection"(Node) -> VECTOR, Graph, "", "Direction of growth at the node's children.";
    DistanceNodes = ""."distance"(Node, Node) -> Double, Graph, "m", "Distance between the origins of two nodes.";
    DistanceSquaredNodes = ""."distanceSquared"(Node, Node) -> Double, Graph, "m²", "Squared distance between the origins of two nodes.";
    DistancePoints = ""."distance"(TUPLE, TUPLE) -> Double, Pure, "m", "Distance between two points.";
    AngleNode = ""."angle"(Node) -> Double, Graph, "degrees", "Angle of the rotation that the node itself makes.";
    SqrInt = ""."sqr"(Int) -> Int, Pure, "", "Square.";
    SqrFloat = ""."sqr"(Float) -> Float, Pure, "", "Square.";
    SqrDouble = ""."sqr"(Double) -> Double, Pure, "", "Square.";

    Chart = ""."chart"(Class(ClassId::Dataset), Int) -> Void, Prints, "", "Draws a table: `XY_PLOT`, `SCATTER_PLOT`, `BAR_PLOT`.";
    ChartNamed = ""."chart"(Class(ClassId::Dataset), Int, String) -> Void, Prints, "", "Draws a table.";
    ShaderNamed = ""."shader"(String) -> Class(ClassId::ShaderRef), Pure, "", "A shader of a GroIMP project; gray here.";
    Export3d = ""."export3DScene"(String, String) -> Void, Prints, "", "Nothing: export with `understory export`.";
    Snapshot = ""."makeSnapshot"(String) -> Void, Prints, "", "Nothing: make pictures with `understory render`.";
    RunLater = ""."runLater"(Object) -> Void, Prints, "", "Nothing: there is no window.";
    Workbench = ""."workbench"() -> Object, Pure, "", "Null: there is no window.";
    RepaintView = ""."repaintView3D"() -> Void, Prints, "", "Nothing: there is no window.";
    DefaultView = "View3D"."getDefaultView"(Object) -> Class(ClassId::View3D), Pure, "", "A window that does nothing.";
    Gc = "System"."gc"() -> Void, Pure, "", "Nothing.";
    Exit = "System"."exit"(Int) -> Void, Writes, "", "Ends the run.";
    ArraysToString = "Arrays"."toString"(Object) -> String, Pure, "", "The elements of an array as text.";
    ArraysSort = "Arrays"."sort"(Object) -> Void, Writes, "", "Sorts an array.";
    ArraysFill = "Arrays"."fill"(Object, Object) -> Void, Writes, "", "Sets all elements of an array.";
    ArraysAsList = "Arrays"."asList"(Object) -> Class(ClassId::List), Pure, "", "The elements of an array as a list.";
    CollectionsSort = "Collections"."sort"(Class(ClassId::List)) -> Void, Writes, "", "Sorts a list.";
    CollectionsReverse = "Collections"."reverse"(Class(ClassId::List)) -> Void, Writes, "", "Turns a list round.";
    CollectionsShuffle = "Collections"."shuffle"(Class(ClassId::List)) -> Void, Random, "", "Mixes a list.";
    CollectionsMin = "Collections"."min"(Class(ClassId::Collection)) -> Object, Pure, "", "The least element.";
    CollectionsMax = "Collections"."max"(Class(ClassId::Collection)) -> Object, Pure, "", "The greatest element.";

    AttributeRadius = "Attributes"."RADIUS"(Node) -> Float, Graph, "m", "Radius with which the node is drawn, from its own diameter or the turtle's.";
    AttributeDtgColor = "Attributes"."DTG_COLOR"(Node) -> Int, Graph, "", "EGA colour with which the node is drawn, its own or the turtle's.";
    AttributeShader = "Attributes"."SHADER"(Node) -> SHADER, Graph, "", "Shader with which the node is drawn, its own or the turtle's.";
    AttributeOrder = "Attributes"."ORDER"(Node) -> Int, Graph, "", "Number of branch edges between the root and the node.";

    AbsInt = "Math"."abs"(Int) -> Int, Pure, "", "Absolute value.";
    AbsLong = "Math"."abs"(Long) -> Long, Pure, "", "Absolute value.";
    AbsFloat = "Math"."abs"(Float) -> Float, Pure, "", "Absolute value.";
    AbsDouble = "Math"."abs"(Double) -> Double, Pure, "", "Absolute value.";
    MinInt = "Math"."min"(Int, Int) -> Int, Pure, "", "Lesser of two.";
    MinLong = "Math"."min"(Long, Long) -> Long, Pure, "", "Lesser of two.";
    MinFloat = "Math"."min"(Float, Float) -> Float, Pure, "", "Lesser of two.";
    MinDouble = "Math"."min"(Double, Double) -> Double, Pure, "", "Lesser of two.";
    MaxInt = "Math"."max"(Int, Int) -> Int, Pure, "", "Greater of two.";
    MaxLong = "Math"."max"(Long, Long) -> Long, Pure, "", "Greater of two.";
    MaxFloat = "Math"."max"(Float, Float) -> Float, Pure, "", "Greater of two.";
    MaxDouble = "Math"."max"(Double, Double) -> Double, Pure, "", "Greater of two.";
    RoundFloat = "Math"."round"(Float) -> Int, Pure, "", "Nearest integer, halves upwards.";
    RoundDouble = "Math"."round"(Double) -> Long, Pure, "", "Nearest integer, halves upwards.";
    Rint = "Math"."rint"(Double) -> Double, Pure, "", "Nearest integer, halves to even.";
    Floor = "Math"."floor"(Double) -> Double, Pure, "", "Greatest integer not above.";
    Ceil = "Math"."ceil"(Double) -> Double, Pure, "", "Least integer not below.";
    Sqrt = "Math"."sqrt"(Double) -> Double, Pure, "", "Square root.";
    Cbrt = "Math"."cbrt"(Double) -> Double, Pure, "", "Cube root.";
    Pow = "Math"."pow"(Double, Double) -> Double, Pure, "", "Power.";
    Exp = "Math"."exp"(Double) -> Double, Pure, "", "Exponential.";
    Expm1 = "Math"."expm1"(Double) -> Double, Pure, "", "Exponential minus one.";
    Log = "Math"."log"(Double) -> Double, Pure, "", "Natural logarithm.";
    Log10 = "Math"."log10"(Double) -> Double, Pure, "", "Decimal logarithm.";
    Log1p = "Math"."log1p"(Double) -> Double, Pure, "", "Natural logarithm of one plus the argument.";
    Sin = "Math"."sin"(Double) -> Double, Pure, "radians", "Sine.";
    Cos = "Math"."cos"(Double) -> Double, Pure, "radians", "Cosine.";
    Tan = "Math"."tan"(Double) -> Double, Pure, "radians", "Tangent.";
    Asin = "Math"."asin"(Double) -> Double, Pure, "radians", "Arc sine.";
    Acos = "Math"."acos"(Double) -> Double, Pure, "radians", "Arc cosine.";
    Atan = "Math"."atan"(Double) -> Double, Pure, "radians", "Arc tangent.";
    Atan2 = "Math"."atan2"(Double, Double) -> Double, Pure, "radians", "Angle of the point (x, y), given as y, x.";
    Sinh = "Math"."sinh"(Double) -> Double, Pure, "", "Hyperbolic sine.";
    Cosh = "Math"."cosh"(Double) -> Double, Pure, "", "Hyperbolic cosine.";
    Tanh = "Math"."tanh"(Double) -> Double, Pure, "", "Hyperbolic tangent.";
    Hypot = "Math"."hypot"(Double, Double) -> Double, Pure, "", "Length of (x, y).";
    ToRadians = "Math"."toRadians"(Double) -> Double, Pure, "degrees to radians", "Degrees as radians.";
    ToDegrees = "Math"."toDegrees"(Double) -> Double, Pure, "radians to degrees", "Radians as degrees.";
    SignumFloat = "Math"."signum"(Float) -> Float, Pure, "", "Sign: -1, 0 or 1.";
    SignumDouble = "Math"."signum"(Double) -> Double, Pure, "", "Sign: -1, 0 or 1.";
    FloorDivInt = "Math"."floorDiv"(Int, Int) -> Int, Pure, "", "Quotient rounded down.";
    FloorModInt = "Math"."floorMod"(Int, Int) -> Int, Pure, "", "Remainder with the divisor's sign.";
    MathRandom = "Math"."random"() -> Double, Random, "", "Uniform in [0, 1), from the model's generator.";

    ParseInt = "Integer"."parseInt"(String) -> Int, Pure, "", "Number in a text.";
    IntegerValueOf = "Integer"."valueOf"(Int) -> Class(ClassId::Integer), Pure, "", "Boxed.";
    IntegerValueOfText = "Integer"."valueOf"(String) -> Class(ClassId::Integer), Pure, "", "Number in a text, boxed.";
    IntegerToString = "Integer"."toString"(Int) -> String, Pure, "", "Decimal text.";
    IntegerToHexString = "Integer"."toHexString"(Int) -> String, Pure, "", "Hexadecimal text of the 32 bits.";
    IntegerToBinaryString = "Integer"."toBinaryString"(Int) -> String, Pure, "", "Binary text of the 32 bits.";
    ParseLong = "Long"."parseLong"(String) -> Long, Pure, "", "Number in a text.";
    LongValueOf = "Long"."valueOf"(Long) -> Class(ClassId::Long), Pure, "", "Boxed.";
    LongToString = "Long"."toString"(Long) -> String, Pure, "", "Decimal text.";
    ParseFloat = "Float"."parseFloat"(String) -> Float, Pure, "", "Number in a text.";
    FloatValueOf = "Float"."valueOf"(Float) -> Class(ClassId::Float), Pure, "", "Boxed.";
    FloatValueOfText = "Float"."valueOf"(String) -> Class(ClassId::Float), Pure, "", "Number in a text, boxed.";
    FloatIsNaN = "Float"."isNaN"(Float) -> Boolean, Pure, "", "Whether it is not a number.";
    FloatIsInfinite = "Float"."isInfinite"(Float) -> Boolean, Pure, "", "Whether it is infinite.";
    FloatToString = "Float"."toString"(Float) -> String, Pure, "", "Decimal text.";
    ParseDouble = "Double"."parseDouble"(String) -> Double, Pure, "", "Number in a text.";
    DoubleValueOf = "Double"."valueOf"(Double) -> Class(ClassId::Double), Pure, "", "Boxed.";
    DoubleValueOfText = "Double"."valueOf"(String) -> Class(ClassId::Double), Pure, "", "Number in a text, boxed.";
    DoubleIsNaN = "Double"."isNaN"(Double) -> Boolean, Pure, "", "Whether it is not a number.";
    DoubleIsInfinite = "Double"."isInfinite"(Double) -> Boolean, Pure, "", "Whether it is infinite.";
    DoubleToString = "Double"."toString"(Double) -> String, Pure, "", "Decimal text.";
    DoubleCompare = "Double"."compare"(Double, Double) -> Int, Pure, "", "-1, 0 or 1 as the first is less, equal or greater.";
    ParseBoolean = "Boolean"."parseBoolean"(String) -> Boolean, Pure, "", "Whether the text is `true`.";
    BooleanToString = "Boolean"."toString"(Boolean) -> String, Pure, "", "`true` or `false`.";
    IsDigit = "Character"."isDigit"(Char) -> Boolean, Pure, "", "Whether it is a digit.";
    IsLetter = "Character"."isLetter"(Char) -> Boolean, Pure, "", "Whether it is a letter.";
    IsWhitespace = "Character"."isWhitespace"(Char) -> Boolean, Pure, "", "Whether it is white space.";
    CharacterToString = "Character"."toString"(Char) -> String, Pure, "", "Text of one character.";
    StringValueOf = "String"."valueOf"(Text) -> String, Pure, "", "Text of a value.";
    StringFormat1 = "String"."format"(String, Object) -> String, Pure, "", "Text of values after a pattern such as `%.2f`.";
    StringFormat2 = "String"."format"(String, Object, Object) -> String, Pure, "", "Text of values after a pattern such as `%.2f`.";
    StringFormat3 = "String"."format"(String, Object, Object, Object) -> String, Pure, "", "Text of values after a pattern such as `%.2f`.";
    StringFormat4 = "String"."format"(String, Object, Object, Object, Object) -> String, Pure, "", "Text of values after a pattern such as `%.2f`.";
    StringFormat5 = "String"."format"(String, Object, Object, Object, Object, Object) -> String, Pure, "", "Text of values after a pattern such as `%.2f`.";
    StringFormat6 = "String"."format"(String, Object, Object, Object, Object, Object, Object) -> String, Pure, "", "Text of values after a pattern such as `%.2f`.";
    StringFormat7 = "String"."format"(String, Object, Object, Object, Object, Object, Object, Object) -> String, Pure, "", "Text of values after a pattern such as `%.2f`.";
    StringFormat8 = "String"."format"(String, Object, Object, Object, Object, Object, Object, Object, Object) -> String, Pure, "", "Text of values after a pattern such as `%.2f`.";
    CurrentTimeMillis = "System"."currentTimeMillis"() -> Long, Writes, "ms", "Time since 1970.";
    NanoTime = "System"."nanoTime"() -> Long, Writes, "ns", "Time since some moment.";
    SystemOutPrintln = "System.out"."println"() -> Void, Prints, "", "Ends the line.";
    SystemOutPrintlnText = "System.out"."println"(Text) -> Void, Prints, "", "Prints a value and ends the line.";
    SystemOutPrintText = "System.out"."print"(Text) -> Void, Prints, "", "Prints a value.";
}

static BY_NAME: LazyLock<Index<FunctionId>> =
    LazyLock::new(|| index(FunctionId::ALL, FunctionId::signature));

/// The overloads of `owner.name`, or of `name` for an empty owner.
pub fn functions_named(owner: &str, name: &str) -> &'static [FunctionId] {
    BY_NAME.get(owner, name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overloads_are_found_in_order() {
        let abs: Vec<_> = functions_named("Math", "abs")
            .iter()
            .map(|f| f.signature().result)
            .collect();
        assert_eq!(abs, [Int, Long, Float, Double]);
        assert!(functions_named("", "abs").is_empty());
        assert_eq!(functions_named("", "println").len(), 2);
    }
}
