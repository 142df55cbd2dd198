//! Functions: those of the language's own library, and the static methods of Java classes that models use.

use std::sync::LazyLock;

use super::ValueType::{
    Argument, Boolean, Char, CharArray, Class, Double, Float, FloatArray, Int, Long, Node, Object,
    Objects, Same, String, Text, Void,
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
    PrintlnText = ""."println"(Text value) -> Void, Prints, "", "Prints a value and ends the line.";
    PrintText = ""."print"(Text value) -> Void, Prints, "", "Prints a value.";
    ClearConsole = ""."clearConsole"() -> Void, Prints, "", "Empties the console of a window; nothing where there is none.";

    Random = ""."random"(Float a, Float b) -> Float, Random, "", "Uniform in [a, b): `nextFloat() * (b - a) + a`.";
    Irandom = ""."irandom"(Int a, Int b) -> Int, Random, "", "Uniform integer, both ends included: `nextInt(b + 1 - a) + a`.";
    NormalFloat = ""."normal"(Float mean, Float deviation) -> Float, Random, "", "Normal with mean and standard deviation, from `nextGaussian()` rounded to float.";
    NormalDouble = ""."normal"(Double mean, Double deviation) -> Double, Random, "", "Normal with mean and standard deviation.";
    Lognormal = ""."lognormal"(Double mean, Double deviation) -> Double, Random, "", "Log-normal with mean and standard deviation of the variable itself.";
    Probability = ""."probability"(Float p) -> Boolean, Random, "", "True with this probability; draws nothing where it is at least 1.";
    Distribution = ""."distribution"(FloatArray weights) -> Int, Random, "", "Index i with probability `p[i]`.";
    SetSeed = ""."setSeed"(Long seed) -> Void, Random, "", "Starts the model's generator anew.";

    Derive = ""."derive"() -> Void, Writes, "", "Applies what the rules have queued: one step.";
    Reset = ""."reset"() -> Void, Writes, "", "Starts again: empty graph, then `init()`.";
    SetDerivationMode = ""."setDerivationMode"(Int mode) -> Void, Writes, "", "Chooses how rules are applied from here on.";
    GetDerivationMode = ""."getDerivationMode"() -> Int, Writes, "", "How rules are applied.";

    Location = ""."location"(Node node) -> POINT, Graph, "m", "Origin of the node's local coordinates.";
    Endlocation = ""."endlocation"(Node node) -> POINT, Graph, "m", "Origin of the local coordinates of the node's children.";
    Direction = ""."direction"(Node node) -> VECTOR, Graph, "", "Direction of growth (local z) at the node.";
    Enddirection = ""."enddirection"(Node node) -> VECTOR, Graph, "", "Direction of growth at the node's children.";
    Transformation = ""."transformation"(Node node) -> Class(ClassId::Matrix34d), Graph, "m", "What makes the node's local coordinates those of the world.";
    DistanceNodes = ""."distance"(Node a, Node b) -> Double, Graph, "m", "Distance between the origins of two nodes.";
    DistanceSquaredNodes = ""."distanceSquared"(Node a, Node b) -> Double, Graph, "m²", "Squared distance between the origins of two nodes.";
    DistancePoints = ""."distance"(TUPLE a, TUPLE b) -> Double, Pure, "m", "Distance between two points.";
    AngleNode = ""."angle"(Node node) -> Double, Graph, "degrees", "Angle of the rotation that the node itself makes.";
    SqrInt = ""."sqr"(Int n) -> Int, Pure, "", "Square.";
    SqrFloat = ""."sqr"(Float x) -> Float, Pure, "", "Square.";
    SqrDouble = ""."sqr"(Double x) -> Double, Pure, "", "Square.";

    Chart = ""."chart"(Class(ClassId::Dataset) table, Int kind) -> Void, Prints, "", "Draws a table: `XY_PLOT`, `SCATTER_PLOT`, `BAR_PLOT`.";
    ChartNamed = ""."chart"(Class(ClassId::Dataset) table, Int kind, String title) -> Void, Prints, "", "Draws a table.";
    ShaderNamed = ""."shader"(String name) -> Class(ClassId::ShaderRef), Pure, "", "A matt surface with a picture: with a name such as `leaf.png` that file, relative to the folder of the model; with one such as `leaf`, as in GroIMP, `leaf.png`, `leaf.jpg` or `leaf.jpeg` there or in `images` or `textures`, and gray without such a file.";
    ImageNamed = ""."image"(String name) -> Class(ClassId::ImageRef), Pure, "", "A picture, by a name as in `shader`: `new Phong().(setDiffuse(image(\"leaf.png\")))`.";
    Export3d = ""."export3DScene"(String path, String format) -> Void, Prints, "", "Nothing: export with `understory export`.";
    Snapshot = ""."makeSnapshot"(String path) -> Void, Prints, "", "Nothing: make pictures with `understory render`.";
    SnapshotSized = ""."makeSnapshot"(String path, Int width, Int height) -> Void, Prints, "", "Nothing: make pictures with `understory render`.";
    SaveGraph = ""."saveGraph"(String path) -> Void, Prints, "", "Nothing: `understory derive --json` tells what a graph holds.";
    RunLater = ""."runLater"(Object argument) -> Void, Prints, "", "Nothing: there is no window.";
    Workbench = ""."workbench"() -> Object, Pure, "", "Null: there is no window.";
    RepaintView = ""."repaintView3D"() -> Void, Prints, "", "Nothing: there is no window.";
    DefaultView = "View3D"."getDefaultView"(Object graph) -> Class(ClassId::View3D), Pure, "", "A window that does nothing.";
    Gc = "System"."gc"() -> Void, Pure, "", "Nothing.";
    Exit = "System"."exit"(Int code) -> Void, Writes, "", "Ends the run.";
    ArraysToString = "Arrays"."toString"(Object array) -> String, Pure, "", "The elements of an array as text.";
    ArraysSort = "Arrays"."sort"(Object array) -> Void, Writes, "", "Sorts an array.";
    ArraysFill = "Arrays"."fill"(Object array, Object value) -> Void, Writes, "", "Sets all elements of an array.";
    ArraysAsList = "Arrays"."asList"(Objects array) -> Class(ClassId::List), Pure, "", "Values, or the elements of an array, as a list.";
    ArraysSortBy = "Arrays"."sort"(Object array, Class(ClassId::Comparator) comparator) -> Void, Writes, "", "Sorts an array by a comparison.";
    ArraysSortPart = "Arrays"."sort"(Object array, Int from, Int to) -> Void, Writes, "", "Sorts the elements from an index up to another.";
    ArraysFillPart = "Arrays"."fill"(Object array, Int from, Int to, Object value) -> Void, Writes, "", "Sets the elements from an index up to another.";
    ArraysCopyOf = "Arrays"."copyOf"(Object array, Int length) -> Same, Pure, "", "The first elements, filled up with zeros.";
    ArraysCopyOfRange = "Arrays"."copyOfRange"(Object array, Int from, Int to) -> Same, Pure, "", "The elements from an index up to another, filled up with zeros.";
    ArraysEquals = "Arrays"."equals"(Object a, Object b) -> Boolean, Pure, "", "Whether both arrays hold equal elements.";
    ArraysHashCode = "Arrays"."hashCode"(Object array) -> Int, Pure, "", "A number that arrays of equal elements share.";
    ArraysDeepToString = "Arrays"."deepToString"(Object array) -> String, Pure, "", "The elements of an array of arrays as text.";
    ArraysBinarySearch = "Arrays"."binarySearch"(Object array, Object value) -> Int, Pure, "", "Index of a value in a sorted array, -(place) - 1 if it is not there.";
    CollectionsSort = "Collections"."sort"(Class(ClassId::List) list) -> Void, Writes, "", "Sorts a list.";
    CollectionsSortBy = "Collections"."sort"(Class(ClassId::List) list, Class(ClassId::Comparator) comparator) -> Void, Writes, "", "Sorts a list by a comparison.";
    CollectionsReverseOrder = "Collections"."reverseOrder"() -> Class(ClassId::Comparator), Pure, "", "Compares the other way round.";
    CollectionsSwap = "Collections"."swap"(Class(ClassId::List) list, Int i, Int j) -> Void, Writes, "", "Exchanges two elements.";
    CollectionsFrequency = "Collections"."frequency"(Class(ClassId::Collection) values, Object value) -> Int, Pure, "", "Number of equal elements.";
    CollectionsAddAll = "Collections"."addAll"(Class(ClassId::Collection) collection, Objects values) -> Boolean, Writes, "", "Adds values.";
    CollectionsUnmodifiable = "Collections"."unmodifiableList"(Class(ClassId::List) list) -> Same, Pure, "", "The same list.";
    CollectionsEmptyList = "Collections"."emptyList"() -> Class(ClassId::List), Pure, "", "An empty list.";
    CollectionsNCopies = "Collections"."nCopies"(Int n, Object value) -> Class(ClassId::List), Pure, "", "A list of the same value n times.";
    CollectionsReverse = "Collections"."reverse"(Class(ClassId::List) list) -> Void, Writes, "", "Turns a list round.";
    CollectionsShuffle = "Collections"."shuffle"(Class(ClassId::List) list) -> Void, Random, "", "Mixes a list.";
    CollectionsShuffleBy = "Collections"."shuffle"(Class(ClassId::List) list, Class(ClassId::Random) random) -> Void, Writes, "", "Mixes a list by a generator of its own.";
    CollectionsMin = "Collections"."min"(Class(ClassId::Collection) values) -> Argument(0), Pure, "", "The least element.";
    CollectionsMax = "Collections"."max"(Class(ClassId::Collection) values) -> Argument(0), Pure, "", "The greatest element.";

    AttributeRadius = "Attributes"."RADIUS"(Node node) -> Float, Graph, "m", "Radius with which the node is drawn, from its own diameter or the turtle's.";
    AttributeDtgColor = "Attributes"."DTG_COLOR"(Node node) -> Int, Graph, "", "EGA colour with which the node is drawn, its own or the turtle's.";
    AttributeShader = "Attributes"."SHADER"(Node node) -> SHADER, Graph, "", "Shader with which the node is drawn, its own or the turtle's.";
    AttributeOrder = "Attributes"."ORDER"(Node node) -> Int, Graph, "", "Number of branch edges between the root and the node.";

    AbsInt = "Math"."abs"(Int n) -> Int, Pure, "", "Absolute value.";
    AbsLong = "Math"."abs"(Long n) -> Long, Pure, "", "Absolute value.";
    AbsFloat = "Math"."abs"(Float x) -> Float, Pure, "", "Absolute value.";
    AbsDouble = "Math"."abs"(Double x) -> Double, Pure, "", "Absolute value.";
    MinInt = "Math"."min"(Int a, Int b) -> Int, Pure, "", "Lesser of two.";
    MinLong = "Math"."min"(Long a, Long b) -> Long, Pure, "", "Lesser of two.";
    MinFloat = "Math"."min"(Float a, Float b) -> Float, Pure, "", "Lesser of two.";
    MinDouble = "Math"."min"(Double a, Double b) -> Double, Pure, "", "Lesser of two.";
    MaxInt = "Math"."max"(Int a, Int b) -> Int, Pure, "", "Greater of two.";
    MaxLong = "Math"."max"(Long a, Long b) -> Long, Pure, "", "Greater of two.";
    MaxFloat = "Math"."max"(Float a, Float b) -> Float, Pure, "", "Greater of two.";
    MaxDouble = "Math"."max"(Double a, Double b) -> Double, Pure, "", "Greater of two.";
    RoundFloat = "Math"."round"(Float x) -> Int, Pure, "", "Nearest integer, halves upwards.";
    RoundDouble = "Math"."round"(Double x) -> Long, Pure, "", "Nearest integer, halves upwards.";
    Rint = "Math"."rint"(Double x) -> Double, Pure, "", "Nearest integer, halves to even.";
    Floor = "Math"."floor"(Double x) -> Double, Pure, "", "Greatest integer not above.";
    Ceil = "Math"."ceil"(Double x) -> Double, Pure, "", "Least integer not below.";
    Sqrt = "Math"."sqrt"(Double x) -> Double, Pure, "", "Square root.";
    Cbrt = "Math"."cbrt"(Double x) -> Double, Pure, "", "Cube root.";
    Pow = "Math"."pow"(Double base, Double exponent) -> Double, Pure, "", "Power.";
    Exp = "Math"."exp"(Double x) -> Double, Pure, "", "Exponential.";
    Expm1 = "Math"."expm1"(Double x) -> Double, Pure, "", "Exponential minus one.";
    Log = "Math"."log"(Double x) -> Double, Pure, "", "Natural logarithm.";
    Log10 = "Math"."log10"(Double x) -> Double, Pure, "", "Decimal logarithm.";
    Log1p = "Math"."log1p"(Double x) -> Double, Pure, "", "Natural logarithm of one plus the argument.";
    Sin = "Math"."sin"(Double angle) -> Double, Pure, "radians", "Sine.";
    Cos = "Math"."cos"(Double angle) -> Double, Pure, "radians", "Cosine.";
    Tan = "Math"."tan"(Double angle) -> Double, Pure, "radians", "Tangent.";
    Asin = "Math"."asin"(Double x) -> Double, Pure, "radians", "Arc sine.";
    Acos = "Math"."acos"(Double x) -> Double, Pure, "radians", "Arc cosine.";
    Atan = "Math"."atan"(Double x) -> Double, Pure, "radians", "Arc tangent.";
    Atan2 = "Math"."atan2"(Double y, Double x) -> Double, Pure, "radians", "Angle of the point (x, y), given as y, x.";
    Sinh = "Math"."sinh"(Double x) -> Double, Pure, "", "Hyperbolic sine.";
    Cosh = "Math"."cosh"(Double x) -> Double, Pure, "", "Hyperbolic cosine.";
    Tanh = "Math"."tanh"(Double x) -> Double, Pure, "", "Hyperbolic tangent.";
    Hypot = "Math"."hypot"(Double x, Double y) -> Double, Pure, "", "Length of (x, y).";
    ToRadians = "Math"."toRadians"(Double degrees) -> Double, Pure, "degrees to radians", "Degrees as radians.";
    ToDegrees = "Math"."toDegrees"(Double radians) -> Double, Pure, "radians to degrees", "Radians as degrees.";
    SignumFloat = "Math"."signum"(Float x) -> Float, Pure, "", "Sign: -1, 0 or 1.";
    SignumDouble = "Math"."signum"(Double x) -> Double, Pure, "", "Sign: -1, 0 or 1.";
    FloorDivInt = "Math"."floorDiv"(Int a, Int divisor) -> Int, Pure, "", "Quotient rounded down.";
    FloorModInt = "Math"."floorMod"(Int a, Int divisor) -> Int, Pure, "", "Remainder with the divisor's sign.";
    FloorDivLong = "Math"."floorDiv"(Long a, Long b) -> Long, Pure, "", "Quotient rounded down.";
    FloorModLong = "Math"."floorMod"(Long a, Long b) -> Long, Pure, "", "Remainder with the divisor's sign.";
    AddExactInt = "Math"."addExact"(Int a, Int b) -> Int, Pure, "", "Sum; an exception if it is no int.";
    AddExactLong = "Math"."addExact"(Long a, Long b) -> Long, Pure, "", "Sum; an exception if it is no long.";
    SubtractExactInt = "Math"."subtractExact"(Int a, Int b) -> Int, Pure, "", "Difference; an exception if it is no int.";
    SubtractExactLong = "Math"."subtractExact"(Long a, Long b) -> Long, Pure, "", "Difference; an exception if it is no long.";
    MultiplyExactInt = "Math"."multiplyExact"(Int a, Int b) -> Int, Pure, "", "Product; an exception if it is no int.";
    MultiplyExactLong = "Math"."multiplyExact"(Long a, Long b) -> Long, Pure, "", "Product; an exception if it is no long.";
    ToIntExact = "Math"."toIntExact"(Long n) -> Int, Pure, "", "The same number; an exception if it is no int.";
    Fma = "Math"."fma"(Double a, Double b, Double c) -> Double, Pure, "", "a b + c, rounded once.";
    Ulp = "Math"."ulp"(Double x) -> Double, Pure, "", "Distance to the next greater number in size.";
    NextUp = "Math"."nextUp"(Double x) -> Double, Pure, "", "The next greater number.";
    NextDown = "Math"."nextDown"(Double x) -> Double, Pure, "", "The next lesser number.";
    CopySign = "Math"."copySign"(Double size, Double sign) -> Double, Pure, "", "The first with the sign of the second.";
    IeeeRemainder = "Math"."IEEEremainder"(Double x, Double y) -> Double, Pure, "", "Remainder after the nearest quotient.";
    MathRandom = "Math"."random"() -> Double, Random, "", "Uniform in [0, 1), from the model's generator.";

    ParseInt = "Integer"."parseInt"(String text) -> Int, Pure, "", "Number in a text.";
    IntegerValueOf = "Integer"."valueOf"(Int n) -> Class(ClassId::Integer), Pure, "", "Boxed.";
    IntegerValueOfText = "Integer"."valueOf"(String text) -> Class(ClassId::Integer), Pure, "", "Number in a text, boxed.";
    IntegerToString = "Integer"."toString"(Int n) -> String, Pure, "", "Decimal text.";
    IntegerToHexString = "Integer"."toHexString"(Int n) -> String, Pure, "", "Hexadecimal text of the 32 bits.";
    IntegerToBinaryString = "Integer"."toBinaryString"(Int n) -> String, Pure, "", "Binary text of the 32 bits.";
    ParseIntRadix = "Integer"."parseInt"(String text, Int base) -> Int, Pure, "", "Number in a text of a base 2 to 36.";
    IntegerToStringRadix = "Integer"."toString"(Int n, Int base) -> String, Pure, "", "Text in a base 2 to 36.";
    IntegerToOctalString = "Integer"."toOctalString"(Int n) -> String, Pure, "", "Octal text of the 32 bits.";
    IntegerCompare = "Integer"."compare"(Int a, Int b) -> Int, Pure, "", "-1, 0 or 1 as the first is less, equal or greater.";
    IntegerSignum = "Integer"."signum"(Int n) -> Int, Pure, "", "Sign: -1, 0 or 1.";
    IntegerBitCount = "Integer"."bitCount"(Int n) -> Int, Pure, "", "Number of bits that are set.";
    IntegerMax = "Integer"."max"(Int a, Int b) -> Int, Pure, "", "Greater of two.";
    IntegerMin = "Integer"."min"(Int a, Int b) -> Int, Pure, "", "Lesser of two.";
    IntegerSum = "Integer"."sum"(Int a, Int b) -> Int, Pure, "", "Sum of two.";
    LongCompare = "Long"."compare"(Long a, Long b) -> Int, Pure, "", "-1, 0 or 1 as the first is less, equal or greater.";
    LongMax = "Long"."max"(Long a, Long b) -> Long, Pure, "", "Greater of two.";
    LongMin = "Long"."min"(Long a, Long b) -> Long, Pure, "", "Lesser of two.";
    LongToHexString = "Long"."toHexString"(Long n) -> String, Pure, "", "Hexadecimal text of the 64 bits.";
    LongToBinaryString = "Long"."toBinaryString"(Long n) -> String, Pure, "", "Binary text of the 64 bits.";
    LongValueOfText = "Long"."valueOf"(String text) -> Class(ClassId::Long), Pure, "", "Number in a text, boxed.";
    FloatCompare = "Float"."compare"(Float a, Float b) -> Int, Pure, "", "-1, 0 or 1 as the first is less, equal or greater.";
    FloatMax = "Float"."max"(Float a, Float b) -> Float, Pure, "", "Greater of two.";
    FloatMin = "Float"."min"(Float a, Float b) -> Float, Pure, "", "Lesser of two.";
    FloatIsFinite = "Float"."isFinite"(Float x) -> Boolean, Pure, "", "Whether it is a number and not infinite.";
    FloatToIntBits = "Float"."floatToIntBits"(Float x) -> Int, Pure, "", "Its 32 bits.";
    IntBitsToFloat = "Float"."intBitsToFloat"(Int n) -> Float, Pure, "", "The number of 32 bits.";
    DoubleMax = "Double"."max"(Double a, Double b) -> Double, Pure, "", "Greater of two.";
    DoubleMin = "Double"."min"(Double a, Double b) -> Double, Pure, "", "Lesser of two.";
    DoubleSum = "Double"."sum"(Double a, Double b) -> Double, Pure, "", "Sum of two.";
    DoubleIsFinite = "Double"."isFinite"(Double x) -> Boolean, Pure, "", "Whether it is a number and not infinite.";
    DoubleToLongBits = "Double"."doubleToLongBits"(Double x) -> Long, Pure, "", "Its 64 bits.";
    LongBitsToDouble = "Double"."longBitsToDouble"(Long n) -> Double, Pure, "", "The number of 64 bits.";
    BooleanValueOf = "Boolean"."valueOf"(Boolean value) -> Class(ClassId::Boolean), Pure, "", "Boxed.";
    BooleanValueOfText = "Boolean"."valueOf"(String text) -> Class(ClassId::Boolean), Pure, "", "Whether the text is `true`, boxed.";
    CharacterValueOf = "Character"."valueOf"(Char c) -> Class(ClassId::Character), Pure, "", "Boxed.";
    IsUpperCase = "Character"."isUpperCase"(Char c) -> Boolean, Pure, "", "Whether it is a capital.";
    IsLowerCase = "Character"."isLowerCase"(Char c) -> Boolean, Pure, "", "Whether it is a small letter.";
    IsLetterOrDigit = "Character"."isLetterOrDigit"(Char c) -> Boolean, Pure, "", "Whether it is a letter or a digit.";
    CharToUpperCase = "Character"."toUpperCase"(Char c) -> Char, Pure, "", "The capital.";
    CharToLowerCase = "Character"."toLowerCase"(Char c) -> Char, Pure, "", "The small letter.";
    GetNumericValue = "Character"."getNumericValue"(Char c) -> Int, Pure, "", "Value of a digit or letter, -1 if none.";
    ObjectsEquals = "Objects"."equals"(Object a, Object b) -> Boolean, Pure, "", "Whether both are equal; null is equal to null.";
    ParseLong = "Long"."parseLong"(String text) -> Long, Pure, "", "Number in a text.";
    LongValueOf = "Long"."valueOf"(Long n) -> Class(ClassId::Long), Pure, "", "Boxed.";
    LongToString = "Long"."toString"(Long n) -> String, Pure, "", "Decimal text.";
    ParseFloat = "Float"."parseFloat"(String text) -> Float, Pure, "", "Number in a text.";
    FloatValueOf = "Float"."valueOf"(Float x) -> Class(ClassId::Float), Pure, "", "Boxed.";
    FloatValueOfText = "Float"."valueOf"(String text) -> Class(ClassId::Float), Pure, "", "Number in a text, boxed.";
    FloatIsNaN = "Float"."isNaN"(Float x) -> Boolean, Pure, "", "Whether it is not a number.";
    FloatIsInfinite = "Float"."isInfinite"(Float x) -> Boolean, Pure, "", "Whether it is infinite.";
    FloatToString = "Float"."toString"(Float x) -> String, Pure, "", "Decimal text.";
    ParseDouble = "Double"."parseDouble"(String text) -> Double, Pure, "", "Number in a text.";
    DoubleValueOf = "Double"."valueOf"(Double x) -> Class(ClassId::Double), Pure, "", "Boxed.";
    DoubleValueOfText = "Double"."valueOf"(String text) -> Class(ClassId::Double), Pure, "", "Number in a text, boxed.";
    DoubleIsNaN = "Double"."isNaN"(Double x) -> Boolean, Pure, "", "Whether it is not a number.";
    DoubleIsInfinite = "Double"."isInfinite"(Double x) -> Boolean, Pure, "", "Whether it is infinite.";
    DoubleToString = "Double"."toString"(Double x) -> String, Pure, "", "Decimal text.";
    DoubleCompare = "Double"."compare"(Double a, Double b) -> Int, Pure, "", "-1, 0 or 1 as the first is less, equal or greater.";
    ParseBoolean = "Boolean"."parseBoolean"(String text) -> Boolean, Pure, "", "Whether the text is `true`.";
    BooleanToString = "Boolean"."toString"(Boolean value) -> String, Pure, "", "`true` or `false`.";
    IsDigit = "Character"."isDigit"(Char c) -> Boolean, Pure, "", "Whether it is a digit.";
    IsLetter = "Character"."isLetter"(Char c) -> Boolean, Pure, "", "Whether it is a letter.";
    IsWhitespace = "Character"."isWhitespace"(Char c) -> Boolean, Pure, "", "Whether it is white space.";
    CharacterToString = "Character"."toString"(Char c) -> String, Pure, "", "Text of one character.";
    StringValueOf = "String"."valueOf"(Text value) -> String, Pure, "", "Text of a value.";
    StringFormat = "String"."format"(String pattern, Objects values) -> String, Pure, "", "Text of values after a pattern such as `%.2f`.";
    StringFormatLocale = "String"."format"(Class(ClassId::Locale) locale, String pattern, Objects values) -> String, Pure, "", "Text of values after a pattern; numbers are written the English way.";
    StringValueOfChars = "String"."valueOf"(CharArray chars) -> String, Pure, "", "Text of characters.";
    StringJoin = "String"."join"(Text between, Objects values) -> String, Pure, "", "Texts with another one between them.";
    StringJoinAll = "String"."join"(Text between, Class(ClassId::Collection) values) -> String, Pure, "", "The elements of a collection with a text between them.";
    CurrentTimeMillis = "System"."currentTimeMillis"() -> Long, Writes, "ms", "Time since 1970.";
    NanoTime = "System"."nanoTime"() -> Long, Writes, "ns", "Time since some moment.";
    ArrayCopy = "System"."arraycopy"(Object source, Int from, Object target, Int to, Int n) -> Void, Writes, "", "Copies elements: from an array at an index into another at an index, so many.";
    LineSeparator = "System"."lineSeparator"() -> String, Pure, "", "The end of a line, `\\n`.";
    MainProperty = "Main"."getProperty"(String name) -> String, Pure, "", "Null: GroIMP's own settings; there is no `headless`.";
    MainArgument = "Main"."getArg"(Int index) -> String, Pure, "", "Null: the command line has no arguments for the model.";
    SystemProperty = "System"."getProperty"(String name) -> String, Pure, "", "`line.separator`, `file.separator`, `path.separator` and `user.dir`; null for others.";
    Sleep = "Thread"."sleep"(Long millis) -> Void, Prints, "ms", "Nothing: growth waits for nobody.";
    SetDefaultLocale = "Locale"."setDefault"(Class(ClassId::Locale) locale) -> Void, Prints, "", "Nothing: numbers are always written the English way.";
    GetRuntime = "Runtime"."getRuntime"() -> Class(ClassId::Runtime), Pure, "", "What the model may use.";
    SystemOutPrintf = "System.out"."printf"(String pattern, Objects values) -> Void, Prints, "", "Prints values after a pattern such as `%.2f`.";
    SystemOutPrintfLocale = "System.out"."printf"(Class(ClassId::Locale) locale, String pattern, Objects values) -> Void, Prints, "", "Prints values after a pattern.";
    SystemOutFormat = "System.out"."format"(String pattern, Objects values) -> Void, Prints, "", "Prints values after a pattern such as `%.2f`.";
    SystemOutPrintln = "System.out"."println"() -> Void, Prints, "", "Ends the line.";
    SystemOutPrintlnText = "System.out"."println"(Text value) -> Void, Prints, "", "Prints a value and ends the line.";
    SystemOutPrintText = "System.out"."print"(Text value) -> Void, Prints, "", "Prints a value.";
    Stop = ""."stop"() -> Void, Writes, "", "Ends the growth after this step.";
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
