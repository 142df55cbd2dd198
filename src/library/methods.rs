//! Methods and public fields of library objects and of `String`. Operators between vectors are methods named `+`, `-`, `*`.

use std::sync::LazyLock;

use super::ValueType::{
    Boolean, Char, CharArray, Class, Double, FileArray, Float, FloatArray, Int, IntArray, Long,
    Node, Object, ObjectArray, Objects, Same, String, StringArray, Text, Void,
};
use super::signature::{Index, index, signatures};
use super::{ClassId, Effect, Signature, ValueType};

const MATRIX: ValueType = Class(ClassId::Matrix);
const TUPLE: ValueType = Class(ClassId::Tuple3d);
const VECTOR: ValueType = Class(ClassId::Vector3d);
const POINT: ValueType = Class(ClassId::Point3d);
const MAP: ValueType = Class(ClassId::ChannelMap);
const COLLECTION: ValueType = Class(ClassId::Collection);
const COLOR: ValueType = Class(ClassId::RGBColor);
const SPECTRUM: ValueType = Class(ClassId::Spectrum3d);

/// What a collection holds, or the keys of a map.
const E: ValueType = ValueType::Argument(0);
/// What a map holds.
const V: ValueType = ValueType::Argument(1);
const COMPARATOR: ValueType = Class(ClassId::Comparator);

signatures! {
    /// A method of a library class: one per overload.
    MethodId;
    ObjectEquals = "Object"."equals"(Object other) -> Boolean, Pure, "", "Whether both are equal.";
    ObjectToString = "Object"."toString"() -> String, Pure, "", "Its text.";
    ObjectGetClass = "Object"."getClass"() -> Class(ClassId::Class), Pure, "", "Its class.";
    ClassSimpleName = "Class"."getSimpleName"() -> String, Pure, "", "Its name.";
    ClassName = "Class"."getName"() -> String, Pure, "", "Its name, of classes of Java with the package.";
    NodeId = "Node"."getId"() -> Long, Graph, "", "Number of the node.";
    NodeSuccessor = "Node"."getSuccessor"() -> Node, Graph, "", "The first node behind a successor edge, null if none.";
    NodePredecessor = "Node"."getPredecessor"() -> Node, Graph, "", "The node before it by a successor edge, null if none.";
    NodeBranch = "Node"."getBranch"() -> Node, Graph, "", "The first node behind a branch edge, null if none.";
    NodeAxisParent = "Node"."getAxisParent"() -> Node, Graph, "", "The node before it by a successor or branch edge, null if none.";
    NodeChildCount = "Node"."getDirectChildCount"() -> Int, Graph, "", "Number of edges that lead away from it.";
    NodeIsAncestorOf = "Node"."isAncestorOf"(Node node) -> Boolean, Graph, "", "Whether a way of successor and branch edges leads from it to another node.";
    ArrayClone = "Array"."clone"() -> Same, Pure, "", "A copy.";
    ObjectHashCode = "Object"."hashCode"() -> Int, Pure, "", "A number that equal objects share.";

    StringLength = "String"."length"() -> Int, Pure, "", "Number of UTF-16 units.";
    StringCharAt = "String"."charAt"(Int index) -> Char, Pure, "", "Character at an index from 0.";
    StringSubstring = "String"."substring"(Int begin) -> String, Pure, "", "From an index to the end.";
    StringSubstringTo = "String"."substring"(Int begin, Int end) -> String, Pure, "", "From an index up to another.";
    StringIndexOf = "String"."indexOf"(String text) -> Int, Pure, "", "First place of a text, -1 if none.";
    StringIndexOfFrom = "String"."indexOf"(String text, Int from) -> Int, Pure, "", "First place of a text from an index on, -1 if none.";
    StringIndexOfChar = "String"."indexOf"(Char c) -> Int, Pure, "", "First place of a character, -1 if none.";
    StringLastIndexOf = "String"."lastIndexOf"(String text) -> Int, Pure, "", "Last place of a text, -1 if none.";
    StringEqualsIgnoreCase = "String"."equalsIgnoreCase"(String other) -> Boolean, Pure, "", "Equal but for case.";
    StringCompareTo = "String"."compareTo"(String other) -> Int, Pure, "", "Below, at or above 0 as it stands before, at or after.";
    StringToUpperCase = "String"."toUpperCase"() -> String, Pure, "", "In capitals.";
    StringToLowerCase = "String"."toLowerCase"() -> String, Pure, "", "In small letters.";
    StringTrim = "String"."trim"() -> String, Pure, "", "Without white space at both ends.";
    StringStartsWith = "String"."startsWith"(String prefix) -> Boolean, Pure, "", "Whether it begins so.";
    StringEndsWith = "String"."endsWith"(String suffix) -> Boolean, Pure, "", "Whether it ends so.";
    StringContains = "String"."contains"(String text) -> Boolean, Pure, "", "Whether a text occurs in it.";
    StringReplace = "String"."replace"(String old, String replacement) -> String, Pure, "", "With every occurrence replaced.";
    StringReplaceChar = "String"."replace"(Char old, Char replacement) -> String, Pure, "", "With every occurrence replaced.";
    StringIsEmpty = "String"."isEmpty"() -> Boolean, Pure, "", "Whether its length is 0.";
    StringSplit = "String"."split"(String separator) -> StringArray, Pure, "", "Parts between occurrences of a separator.";
    StringConcat = "String"."concat"(String text) -> String, Pure, "", "With a text appended.";
    StringToCharArray = "String"."toCharArray"() -> CharArray, Pure, "", "Its characters.";

    StringStrip = "String"."strip"() -> String, Pure, "", "Without white space at both ends.";
    StringIsBlank = "String"."isBlank"() -> Boolean, Pure, "", "Whether there is nothing but white space.";
    StringRepeat = "String"."repeat"(Int n) -> String, Pure, "", "The text n times.";
    StringSplitLimit = "String"."split"(String separator, Int limit) -> StringArray, Pure, "", "At most so many parts between occurrences of a separator.";
    StringCompareToIgnoreCase = "String"."compareToIgnoreCase"(String text) -> Int, Pure, "", "As `compareTo`, without regard to case.";
    StringIntern = "String"."intern"() -> String, Pure, "", "The same text.";
    StringStartsWithAt = "String"."startsWith"(String prefix, Int index) -> Boolean, Pure, "", "Whether a text stands at an index.";
    StringReplaceAll = "String"."replaceAll"(Text pattern, Text replacement) -> String, Pure, "", "With every occurrence of a text replaced; of patterns only blanks are known.";
    StringReplaceFirst = "String"."replaceFirst"(Text pattern, Text replacement) -> String, Pure, "", "With the first occurrence replaced.";
    StringIndexOfCharFrom = "String"."indexOf"(Char c, Int from) -> Int, Pure, "", "First place of a character from an index on, -1 if none.";
    StringLastIndexOfChar = "String"."lastIndexOf"(Char c) -> Int, Pure, "", "Last place of a character, -1 if none.";

    TupleX = "Tuple3d"."x"() -> Double, Pure, "", "First coordinate.";
    TupleY = "Tuple3d"."y"() -> Double, Pure, "", "Second coordinate.";
    TupleZ = "Tuple3d"."z"() -> Double, Pure, "", "Third coordinate.";
    TupleSetX = "Tuple3d"."x="(Double value) -> Void, Writes, "", "Sets the first coordinate.";
    TupleSetY = "Tuple3d"."y="(Double value) -> Void, Writes, "", "Sets the second coordinate.";
    TupleSetZ = "Tuple3d"."z="(Double value) -> Void, Writes, "", "Sets the third coordinate.";
    TupleSet = "Tuple3d"."set"(Double x, Double y, Double z) -> Void, Writes, "", "Sets all three.";
    TupleSetTuple = "Tuple3d"."set"(TUPLE other) -> Void, Writes, "", "Copies.";
    TupleAdd = "Tuple3d"."add"(TUPLE other) -> Void, Writes, "", "Adds to it.";
    TupleAddOf = "Tuple3d"."add"(TUPLE a, TUPLE b) -> Void, Writes, "", "Becomes the sum.";
    TupleSub = "Tuple3d"."sub"(TUPLE other) -> Void, Writes, "", "Subtracts from it.";
    TupleSubOf = "Tuple3d"."sub"(TUPLE a, TUPLE b) -> Void, Writes, "", "Becomes the difference.";
    TupleScale = "Tuple3d"."scale"(Double factor) -> Void, Writes, "", "Multiplies it.";
    TupleScaleOf = "Tuple3d"."scale"(Double factor, TUPLE a) -> Void, Writes, "", "Becomes the multiple.";
    TupleScaleAdd = "Tuple3d"."scaleAdd"(Double s, TUPLE a, TUPLE b) -> Void, Writes, "", "Becomes s a + b.";
    TupleNegate = "Tuple3d"."negate"() -> Void, Writes, "", "Turns it round.";
    TupleInterpolate = "Tuple3d"."interpolate"(TUPLE target, Double fraction) -> Void, Writes, "", "Moves it towards another by a fraction.";
    VectorLength = "Vector3d"."length"() -> Double, Pure, "", "Its length.";
    VectorLengthSquared = "Vector3d"."lengthSquared"() -> Double, Pure, "", "Its length squared.";
    VectorNormalize = "Vector3d"."normalize"() -> Void, Writes, "", "Makes its length 1.";
    VectorNormalizeOf = "Vector3d"."normalize"(VECTOR other) -> Void, Writes, "", "Becomes another of length 1.";
    VectorDot = "Vector3d"."dot"(VECTOR other) -> Double, Pure, "", "Scalar product.";
    VectorCross = "Vector3d"."cross"(VECTOR a, VECTOR b) -> Void, Writes, "", "Becomes the vector product.";
    VectorAngle = "Vector3d"."angle"(VECTOR other) -> Double, Pure, "radians", "Angle between both, 0 to π.";
    PointDistance = "Point3d"."distance"(POINT other) -> Double, Pure, "m", "Distance.";
    PointDistanceSquared = "Point3d"."distanceSquared"(POINT other) -> Double, Pure, "m²", "Squared distance.";
    VectorPlus = "Vector3d"."+"(VECTOR other) -> VECTOR, Pure, "", "Sum.";
    PointPlus = "Point3d"."+"(VECTOR other) -> POINT, Pure, "", "The point moved.";
    VectorMinus = "Vector3d"."-"(VECTOR other) -> VECTOR, Pure, "", "Difference.";
    PointMinusPoint = "Point3d"."-"(POINT other) -> VECTOR, Pure, "", "Vector from the second to the first.";
    PointMinusVector = "Point3d"."-"(VECTOR other) -> POINT, Pure, "", "The point moved back.";
    VectorTimes = "Vector3d"."*"(Double value) -> VECTOR, Pure, "", "Multiple.";
    VectorTimesVector = "Vector3d"."*"(VECTOR other) -> Double, Pure, "", "Scalar product.";
    VectorOver = "Vector3d"."/"(Double value) -> VECTOR, Pure, "", "Fraction.";
    SpectrumIntegrate = "Spectrum3d"."integrate"() -> Double, Pure, "W", "Sum over red, green and blue.";

    Matrix00 = "Matrix"."m00"() -> Double, Pure, "", "Element in row 0, column 0.";
    MatrixSet00 = "Matrix"."m00="(Double value) -> Void, Writes, "", "Sets the element in row 0, column 0.";
    Matrix01 = "Matrix"."m01"() -> Double, Pure, "", "Element in row 0, column 1.";
    MatrixSet01 = "Matrix"."m01="(Double value) -> Void, Writes, "", "Sets the element in row 0, column 1.";
    Matrix02 = "Matrix"."m02"() -> Double, Pure, "", "Element in row 0, column 2.";
    MatrixSet02 = "Matrix"."m02="(Double value) -> Void, Writes, "", "Sets the element in row 0, column 2.";
    Matrix03 = "Matrix"."m03"() -> Double, Pure, "", "Element in row 0, column 3.";
    MatrixSet03 = "Matrix"."m03="(Double value) -> Void, Writes, "", "Sets the element in row 0, column 3.";
    Matrix10 = "Matrix"."m10"() -> Double, Pure, "", "Element in row 1, column 0.";
    MatrixSet10 = "Matrix"."m10="(Double value) -> Void, Writes, "", "Sets the element in row 1, column 0.";
    Matrix11 = "Matrix"."m11"() -> Double, Pure, "", "Element in row 1, column 1.";
    MatrixSet11 = "Matrix"."m11="(Double value) -> Void, Writes, "", "Sets the element in row 1, column 1.";
    Matrix12 = "Matrix"."m12"() -> Double, Pure, "", "Element in row 1, column 2.";
    MatrixSet12 = "Matrix"."m12="(Double value) -> Void, Writes, "", "Sets the element in row 1, column 2.";
    Matrix13 = "Matrix"."m13"() -> Double, Pure, "", "Element in row 1, column 3.";
    MatrixSet13 = "Matrix"."m13="(Double value) -> Void, Writes, "", "Sets the element in row 1, column 3.";
    Matrix20 = "Matrix"."m20"() -> Double, Pure, "", "Element in row 2, column 0.";
    MatrixSet20 = "Matrix"."m20="(Double value) -> Void, Writes, "", "Sets the element in row 2, column 0.";
    Matrix21 = "Matrix"."m21"() -> Double, Pure, "", "Element in row 2, column 1.";
    MatrixSet21 = "Matrix"."m21="(Double value) -> Void, Writes, "", "Sets the element in row 2, column 1.";
    Matrix22 = "Matrix"."m22"() -> Double, Pure, "", "Element in row 2, column 2.";
    MatrixSet22 = "Matrix"."m22="(Double value) -> Void, Writes, "", "Sets the element in row 2, column 2.";
    Matrix23 = "Matrix"."m23"() -> Double, Pure, "", "Element in row 2, column 3.";
    MatrixSet23 = "Matrix"."m23="(Double value) -> Void, Writes, "", "Sets the element in row 2, column 3.";
    Matrix30 = "Matrix"."m30"() -> Double, Pure, "", "Element in row 3, column 0.";
    MatrixSet30 = "Matrix"."m30="(Double value) -> Void, Writes, "", "Sets the element in row 3, column 0.";
    Matrix31 = "Matrix"."m31"() -> Double, Pure, "", "Element in row 3, column 1.";
    MatrixSet31 = "Matrix"."m31="(Double value) -> Void, Writes, "", "Sets the element in row 3, column 1.";
    Matrix32 = "Matrix"."m32"() -> Double, Pure, "", "Element in row 3, column 2.";
    MatrixSet32 = "Matrix"."m32="(Double value) -> Void, Writes, "", "Sets the element in row 3, column 2.";
    Matrix33 = "Matrix"."m33"() -> Double, Pure, "", "Element in row 3, column 3.";
    MatrixSet33 = "Matrix"."m33="(Double value) -> Void, Writes, "", "Sets the element in row 3, column 3.";
    MatrixSetIdentity = "Matrix"."setIdentity"() -> Void, Writes, "", "Becomes the identity.";
    MatrixSetZero = "Matrix"."setZero"() -> Void, Writes, "", "Becomes zero.";
    MatrixSetMatrix = "Matrix"."set"(MATRIX matrix) -> Void, Writes, "", "Copies.";
    MatrixSetScale = "Matrix"."set"(Double scale) -> Void, Writes, "", "Becomes a scaling.";
    MatrixSetMove = "Matrix4d"."set"(TUPLE move) -> Void, Writes, "", "Becomes a move.";
    MatrixSetTranslation = "Matrix4d"."setTranslation"(TUPLE move) -> Void, Writes, "", "Sets where it moves to; the rest stays.";
    MatrixGetTranslation = "Matrix4d"."get"(TUPLE result) -> Void, Writes, "", "The vector becomes what it moves by.";
    MatrixRotX = "Matrix"."rotX"(Double angle) -> Void, Writes, "radians", "Becomes a rotation about x.";
    MatrixRotY = "Matrix"."rotY"(Double angle) -> Void, Writes, "radians", "Becomes a rotation about y.";
    MatrixRotZ = "Matrix"."rotZ"(Double angle) -> Void, Writes, "radians", "Becomes a rotation about z.";
    MatrixMul = "Matrix"."mul"(MATRIX matrix) -> Void, Writes, "", "Becomes its product with another.";
    MatrixMulOf = "Matrix"."mul"(MATRIX a, MATRIX b) -> Void, Writes, "", "Becomes the product.";
    MatrixMulNumber = "Matrix"."mul"(Double factor) -> Void, Writes, "", "Multiplies all elements.";
    MatrixAdd = "Matrix"."add"(MATRIX matrix) -> Void, Writes, "", "Adds to it.";
    MatrixSub = "Matrix"."sub"(MATRIX matrix) -> Void, Writes, "", "Subtracts from it.";
    MatrixTranspose = "Matrix"."transpose"() -> Void, Writes, "", "Exchanges rows and columns.";
    MatrixTransposeOf = "Matrix"."transpose"(MATRIX matrix) -> Void, Writes, "", "Becomes another with rows and columns exchanged.";
    MatrixInvert = "Matrix"."invert"() -> Void, Writes, "", "Becomes its inverse.";
    MatrixInvertOf = "Matrix"."invert"(MATRIX matrix) -> Void, Writes, "", "Becomes the inverse of another.";
    MatrixDeterminant = "Matrix"."determinant"() -> Double, Pure, "", "Its determinant.";
    MatrixTransform = "Matrix"."transform"(TUPLE tuple) -> Void, Writes, "", "Turns and scales a vector; a point is moved too.";
    MatrixTransformInto = "Matrix"."transform"(TUPLE tuple, TUPLE result) -> Void, Writes, "", "The second becomes the first turned, scaled and, if it is a point, moved.";
    MatrixGetElement = "Matrix"."getElement"(Int row, Int column) -> Double, Pure, "", "An element.";
    MatrixSetElement = "Matrix"."setElement"(Int row, Int column, Double value) -> Void, Writes, "", "Sets an element.";

    ShaderAverageColor = "Shader"."getAverageColor"() -> Int, Pure, "", "Colour as `0xAARRGGBB`.";
    ShaderRed = "RGBAShader"."x"() -> Float, Pure, "0..=1", "Red.";
    ShaderGreen = "RGBAShader"."y"() -> Float, Pure, "0..=1", "Green.";
    ShaderBlue = "RGBAShader"."z"() -> Float, Pure, "0..=1", "Blue.";
    ShaderAlpha = "RGBAShader"."w"() -> Float, Pure, "0..=1", "Alpha.";
    ShaderSetRed = "RGBAShader"."x="(Float value) -> Void, Writes, "0..=1", "Sets red.";
    ShaderSetGreen = "RGBAShader"."y="(Float value) -> Void, Writes, "0..=1", "Sets green.";
    ShaderSetBlue = "RGBAShader"."z="(Float value) -> Void, Writes, "0..=1", "Sets blue.";
    ShaderSetAlpha = "RGBAShader"."w="(Float value) -> Void, Writes, "0..=1", "Sets alpha.";
    PhongSetDiffuse = "Phong"."setDiffuse"(MAP color) -> Void, Writes, "0..=1", "Diffuse reflectance.";
    PhongSetSpecular = "Phong"."setSpecular"(MAP color) -> Void, Writes, "0..=1", "Glossy reflectance; black unless set.";
    PhongSetShininess = "Phong"."setShininess"(MAP color) -> Void, Writes, "0..=1", "Sharpness of the gloss: with s = x (2 - x) the exponent is -2 / ln s; 1 is a mirror. Unless set the exponent is 4.";
    PhongSetShininessValue = "Phong"."setShininess"(Float value) -> Void, Writes, "0..=1", "Sharpness of the gloss, as a gray.";
    PhongSetTransparency = "Phong"."setTransparency"(MAP color) -> Void, Writes, "0..=1", "Fraction per colour that passes straight through.";
    PhongSetDiffuseTransparency = "Phong"."setDiffuseTransparency"(MAP color) -> Void, Writes, "0..=1", "Diffuse transmittance.";
    PhongSetTransparencyShininess = "Phong"."setTransparencyShininess"(MAP color) -> Void, Writes, "0..=1", "Sharpness of what passes; 1, as without it: straight through.";
    PhongSetInterpolatedTransparency = "Phong"."setInterpolatedTransparency"(Boolean value) -> Void, Writes, "", "Whether matt and glossy parts only get what does not pass (so it is unless set).";
    MetalSetRoughness = "Metal"."setRoughness"(Double value) -> Void, Writes, "0..=1", "How rough; 0 is polished.";
    GlassSetRoughness = "Glass"."setRoughness"(Double value) -> Void, Writes, "0..=1", "How rough the skin is; 0 is smooth.";
    GlassSetAbsorption = "Glass"."setAbsorption"(Double red, Double green, Double blue) -> Void, Writes, "1/m", "What the body absorbs: after d metres the part exp(-absorption d) is left.";
    PaneSetTint = "Pane"."setTint"(Double red, Double green, Double blue) -> Void, Writes, "0..=1", "The part of the light that is left after crossing the sheet at a right angle, reflections not counted.";
    PhongSetAmbient = "Phong"."setAmbient"(MAP color) -> Void, Writes, "0..=1", "Colour without light; used by fast previews only.";
    PhongSetEmissive = "Phong"."setEmissive"(MAP color) -> Void, Writes, "0..=1", "Radiance it shines with on both sides, W/(m² sr).";

    LightSetColor = "Light"."setColor"(Float red, Float green, Float blue) -> Void, Writes, "0..=1", "Colour of the light.";
    LightSetColorMap = "Light"."setColor"(COLOR color) -> Void, Writes, "0..=1", "Colour of the light.";
    LightSetShadowless = "Light"."setShadowless"(Boolean isShadowless) -> Void, Writes, "", "Whether it casts no shadows; used by fast previews only.";
    PointLightSetPower = "PointLight"."setPower"(Float power) -> Void, Writes, "W", "Power, the sum over red, green and blue.";
    SpotLightSetInnerAngle = "SpotLight"."setInnerAngle"(Float angle) -> Void, Writes, "radians", "Half angle of full brightness.";
    SpotLightSetOuterAngle = "SpotLight"."setOuterAngle"(Float angle) -> Void, Writes, "radians", "Half angle of the cone.";
    DirectionalLightSetPowerDensity = "DirectionalLight"."setPowerDensity"(Float density) -> Void, Writes, "W/m²", "Power per area, the sum over red, green and blue.";
    AreaLightSetPower = "AreaLight"."setPower"(Float power) -> Void, Writes, "W", "Power, the sum over red, green and blue.";
    AreaLightSetExponent = "AreaLight"."setExponent"(Float exponent) -> Void, Writes, "", "Exponent of the cosine by which it shines.";
    LightModelSetSeed = "LightModel"."setSeed"(Long seed) -> Void, Writes, "", "Seed of its rays.";
    LightModelSetRayCount = "LightModel"."setRayCount"(Int rays) -> Void, Writes, "", "Number of rays.";
    LightModelSetDepth = "LightModel"."setDepth"(Int depth) -> Void, Writes, "", "Number of reflections.";
    LightModelCompute = "LightModel"."compute"() -> Void, Writes, "", "Traces the light.";
    LightModelAbsorbedPower = "LightModel"."getAbsorbedPower"(Node node) -> SPECTRUM, Graph, "W", "Power that the node absorbs.";
    LightModelAbsorbedPower3d = "LightModel"."getAbsorbedPower3d"(Node node) -> SPECTRUM, Graph, "W", "Power that the node absorbs.";

    RandomSetSeed = "Random"."setSeed"(Long seed) -> Void, Writes, "", "Starts it anew.";
    RandomNextInt = "Random"."nextInt"() -> Int, Writes, "", "Any int.";
    RandomNextIntBelow = "Random"."nextInt"(Int n) -> Int, Writes, "", "Uniform in 0..n.";
    RandomNextLong = "Random"."nextLong"() -> Long, Writes, "", "Any long.";
    RandomNextFloat = "Random"."nextFloat"() -> Float, Writes, "", "Uniform in [0, 1).";
    RandomNextDouble = "Random"."nextDouble"() -> Double, Writes, "", "Uniform in [0, 1).";
    RandomNextBoolean = "Random"."nextBoolean"() -> Boolean, Writes, "", "True or false.";
    RandomNextGaussian = "Random"."nextGaussian"() -> Double, Writes, "", "Normal with mean 0 and standard deviation 1.";

    NumberIntValue = "Number"."intValue"() -> Int, Pure, "", "As int.";
    NumberLongValue = "Number"."longValue"() -> Long, Pure, "", "As long.";
    NumberFloatValue = "Number"."floatValue"() -> Float, Pure, "", "As float.";
    NumberDoubleValue = "Number"."doubleValue"() -> Double, Pure, "", "As double.";
    BooleanValue = "Boolean"."booleanValue"() -> Boolean, Pure, "", "Unboxed.";
    CharacterValue = "Character"."charValue"() -> Char, Pure, "", "Unboxed.";

    CollectionSize = "Collection"."size"() -> Int, Pure, "", "Number of elements.";
    CollectionIsEmpty = "Collection"."isEmpty"() -> Boolean, Pure, "", "Whether there is none.";
    CollectionContains = "Collection"."contains"(Object element) -> Boolean, Pure, "", "Whether an equal one is in it.";
    ListAdd = "List"."add"(E element) -> Boolean, Writes, "", "Appends.";
    ListInsert = "List"."add"(Int index, E element) -> Void, Writes, "", "Inserts at an index.";
    ListAddAll = "List"."addAll"(COLLECTION elements) -> Boolean, Writes, "", "Appends all.";
    ListGet = "List"."get"(Int index) -> E, Pure, "", "Element at an index from 0.";
    ListSet = "List"."set"(Int index, E element) -> E, Writes, "", "Replaces an element, gives the old one.";
    ListRemoveAt = "List"."remove"(Int index) -> E, Writes, "", "Removes and gives the element at an index.";
    ListRemove = "List"."remove"(Object element) -> Boolean, Writes, "", "Removes the first equal element.";
    ListIndexOf = "List"."indexOf"(Object element) -> Int, Pure, "", "Index of the first equal element, -1 if none.";
    ListClear = "List"."clear"() -> Void, Writes, "", "Removes all.";
    CollectionToArray = "Collection"."toArray"() -> ObjectArray, Pure, "", "Its elements as an array.";
    CollectionToArrayOf = "Collection"."toArray"(ObjectArray array) -> ObjectArray, Pure, "", "Its elements as an array.";
    CollectionContainsAll = "Collection"."containsAll"(COLLECTION values) -> Boolean, Pure, "", "Whether all are in it.";
    CollectionAddAll = "Collection"."addAll"(COLLECTION values) -> Boolean, Writes, "", "Adds all; whether anything changed.";
    CollectionRemoveAll = "Collection"."removeAll"(COLLECTION values) -> Boolean, Writes, "", "Removes all that are in another; whether anything changed.";
    CollectionRetainAll = "Collection"."retainAll"(COLLECTION values) -> Boolean, Writes, "", "Removes all that are not in another; whether anything changed.";
    ListInsertAll = "List"."addAll"(Int index, COLLECTION values) -> Boolean, Writes, "", "Inserts all at an index.";
    ListLastIndexOf = "List"."lastIndexOf"(Object value) -> Int, Pure, "", "Index of the last equal element, -1 if none.";
    ListSubList = "List"."subList"(Int from, Int to) -> Same, Pure, "", "A copy of the elements from an index up to another.";
    ListSortBy = "List"."sort"(COMPARATOR comparator) -> Void, Writes, "", "Sorts it by a comparison; by the natural order for null.";
    ListEnsureCapacity = "List"."ensureCapacity"(Int n) -> Void, Pure, "", "Nothing: there is always room.";
    ListTrimToSize = "List"."trimToSize"() -> Void, Pure, "", "Nothing.";
    VectorFirstElement = "Vector"."firstElement"() -> E, Pure, "", "The first element.";
    VectorLastElement = "Vector"."lastElement"() -> E, Pure, "", "The last element.";
    VectorInsertElementAt = "Vector"."insertElementAt"(E value, Int index) -> Void, Writes, "", "Inserts at an index.";
    VectorSetElementAt = "Vector"."setElementAt"(E value, Int index) -> Void, Writes, "", "Replaces the element at an index.";
    VectorRemoveElementAt = "Vector"."removeElementAt"(Int index) -> Void, Writes, "", "Removes the element at an index.";
    VectorRemoveElement = "Vector"."removeElement"(Object value) -> Boolean, Writes, "", "Removes the first equal element.";
    VectorRemoveAll = "Vector"."removeAllElements"() -> Void, Writes, "", "Removes all.";
    QueueOffer = "Queue"."offer"(E value) -> Boolean, Writes, "", "Appends.";
    QueuePoll = "Queue"."poll"() -> E, Writes, "", "Removes and gives the first element, null if there is none.";
    QueuePeek = "Queue"."peek"() -> E, Pure, "", "The first element, null if there is none.";
    QueueRemove = "Queue"."remove"() -> E, Writes, "", "Removes and gives the first element.";
    QueueElement = "Queue"."element"() -> E, Pure, "", "The first element.";
    DequePush = "Deque"."push"(E value) -> Void, Writes, "", "Inserts in front.";
    DequePop = "Deque"."pop"() -> E, Writes, "", "Removes and gives the first element.";
    DequeOfferFirst = "Deque"."offerFirst"(E value) -> Boolean, Writes, "", "Inserts in front.";
    DequeOfferLast = "Deque"."offerLast"(E value) -> Boolean, Writes, "", "Appends.";
    DequePollFirst = "Deque"."pollFirst"() -> E, Writes, "", "Removes and gives the first element, null if there is none.";
    DequePollLast = "Deque"."pollLast"() -> E, Writes, "", "Removes and gives the last element, null if there is none.";
    DequePeekFirst = "Deque"."peekFirst"() -> E, Pure, "", "The first element, null if there is none.";
    DequePeekLast = "Deque"."peekLast"() -> E, Pure, "", "The last element, null if there is none.";
    StackSearch = "Stack"."search"(Object value) -> Int, Pure, "", "Place of a value counted from the top, from 1; -1 if it is not there.";
    TreeSetFirst = "TreeSet"."first"() -> E, Pure, "", "The least element.";
    TreeSetLast = "TreeSet"."last"() -> E, Pure, "", "The greatest element.";
    IteratorRemove = "Iterator"."remove"() -> Void, Writes, "", "Removes the element that `next` gave.";
    ListAddElement = "List"."addElement"(E element) -> Void, Writes, "", "Appends.";
    ListElementAt = "List"."elementAt"(Int index) -> E, Pure, "", "Element at an index from 0.";
    ListFirst = "List"."getFirst"() -> E, Pure, "", "The first element.";
    ListLast = "List"."getLast"() -> E, Pure, "", "The last element.";
    ListAddFirst = "List"."addFirst"(E element) -> Void, Writes, "", "Inserts in front.";
    ListAddLast = "List"."addLast"(E element) -> Void, Writes, "", "Appends.";
    ListRemoveFirst = "List"."removeFirst"() -> E, Writes, "", "Removes and gives the first element.";
    ListRemoveLast = "List"."removeLast"() -> E, Writes, "", "Removes and gives the last element.";
    StackPush = "Stack"."push"(E element) -> E, Writes, "", "Appends.";
    StackPop = "Stack"."pop"() -> E, Writes, "", "Removes and gives the last element.";
    StackPeek = "Stack"."peek"() -> E, Pure, "", "The last element.";
    StackEmpty = "Stack"."empty"() -> Boolean, Pure, "", "Whether there is none.";
    CollectionIterator = "Collection"."iterator"() -> ValueType::Of(ClassId::Iterator, 0), Pure, "", "Goes through the elements.";
    IteratorHasNext = "Iterator"."hasNext"() -> Boolean, Pure, "", "Whether there is a further one.";
    IteratorNext = "Iterator"."next"() -> E, Writes, "", "The next one.";
    SetAdd = "Set"."add"(E element) -> Boolean, Writes, "", "Adds it if it is not there; whether it was not.";
    SetRemove = "Set"."remove"(Object element) -> Boolean, Writes, "", "Removes it; whether it was there.";
    SetClear = "Set"."clear"() -> Void, Writes, "", "Removes all.";
    TokensHasMore = "StringTokenizer"."hasMoreTokens"() -> Boolean, Pure, "", "Whether there is a further word.";
    TokensNext = "StringTokenizer"."nextToken"() -> String, Writes, "", "The next word.";
    TokensCount = "StringTokenizer"."countTokens"() -> Int, Pure, "", "Number of words left.";

    DatasetResolve = "DatasetRef"."resolve"() -> Class(ClassId::Dataset), Pure, "", "The table itself.";
    DatasetClear = "Dataset"."clear"() -> Void, Writes, "", "Removes all rows and names.";
    DatasetSetTitle = "Dataset"."setTitle"(String title) -> Class(ClassId::Dataset), Writes, "", "Name of the table; gives the table.";
    DatasetSetColumnKey = "Dataset"."setColumnKey"(Int column, Object key) -> Class(ClassId::Dataset), Writes, "", "Name of a column; gives the table.";
    DatasetColumnKey = "Dataset"."getColumnKey"(Int column) -> Object, Pure, "", "Name of a column.";
    DatasetSetRowKey = "Dataset"."setRowKey"(Int row, Object key) -> Class(ClassId::Dataset), Writes, "", "Name of a row; gives the table.";
    DatasetRowKey = "Dataset"."getRowKey"(Int row) -> Object, Pure, "", "Name of a row.";
    DatasetColumnCount = "Dataset"."getColumnCount"() -> Int, Pure, "", "Number of columns.";
    DatasetRowCount = "Dataset"."getRowCount"() -> Int, Pure, "", "Number of rows.";
    DatasetCell = "Dataset"."getCell"(Int row, Int column) -> Object, Pure, "", "Value in a row and a column.";
    DatasetSetCell = "Dataset"."set"(Int row, Int column, Object value) -> Void, Writes, "", "Sets the value in a row and a column.";
    DatasetAddRow = "Dataset"."addRow"() -> Class(ClassId::DatasetRow), Writes, "", "A new row.";
    DatasetGetRow = "Dataset"."getRow"(Int row) -> Class(ClassId::DatasetRow), Writes, "", "The row of a number; made if it is not there.";
    RowSet = "DatasetRow"."set"(Int column, Object value) -> Class(ClassId::DatasetRow), Writes, "", "Sets the value in a column.";
    RowGet = "DatasetRow"."get"(Int column) -> Object, Pure, "", "Value in a column.";
    RowSetKey = "DatasetRow"."setKey"(Object key) -> Void, Writes, "", "Name of the row.";
    RowAppend = "DatasetRow"."<<"(Object value) -> Class(ClassId::DatasetRow), Writes, "", "Appends a value.";

    FileName = "File"."getName"() -> String, Pure, "", "The name without folders.";
    FilePath = "File"."getPath"() -> String, Pure, "", "The path.";
    FileAbsolutePath = "File"."getAbsolutePath"() -> String, Pure, "", "The path.";
    FileExists = "File"."exists"() -> Boolean, Writes, "", "Whether it can be read.";
    ReaderReadLine = "Reader"."readLine"() -> String, Writes, "", "The next line, null at the end.";
    ReaderRead = "Reader"."read"() -> Int, Writes, "", "The next character, -1 at the end.";
    ReaderClose = "Reader"."close"() -> Void, Writes, "", "Ends reading.";
    ReaderReady = "Reader"."ready"() -> Boolean, Pure, "", "Whether there is more.";
    ScannerHasNextLine = "Scanner"."hasNextLine"() -> Boolean, Pure, "", "Whether there is a further line.";
    ScannerHasNext = "Scanner"."hasNext"() -> Boolean, Pure, "", "Whether there is a further word.";
    ScannerNextLine = "Scanner"."nextLine"() -> String, Writes, "", "The next line.";
    ScannerNext = "Scanner"."next"() -> String, Writes, "", "The next word.";
    ScannerNextInt = "Scanner"."nextInt"() -> Int, Writes, "", "The next word as a number.";
    ScannerNextDouble = "Scanner"."nextDouble"() -> Double, Writes, "", "The next word as a number.";
    WriterPrint = "Writer"."print"(Text value) -> Void, Writes, "", "Writes a value.";
    WriterPrintln = "Writer"."println"() -> Void, Writes, "", "Ends the line.";
    WriterPrintlnText = "Writer"."println"(Text value) -> Void, Writes, "", "Writes a value and ends the line.";
    WriterPrintf = "Writer"."printf"(String pattern, Objects values) -> Class(ClassId::Writer), Writes, "", "Writes values after a pattern such as `%.2f`.";
    WriterFormat = "Writer"."format"(String pattern, Objects values) -> Class(ClassId::Writer), Writes, "", "Writes values after a pattern such as `%.2f`.";
    WriterWrite = "Writer"."write"(String text) -> Void, Writes, "", "Writes a text.";
    WriterWriteChar = "Writer"."write"(Int code) -> Void, Writes, "", "Writes a character by its number.";
    WriterAppend = "Writer"."append"(Text value) -> Class(ClassId::Writer), Writes, "", "Writes a value.";
    WriterNewLine = "Writer"."newLine"() -> Void, Writes, "", "Ends the line.";
    WriterFlush = "Writer"."flush"() -> Void, Writes, "", "What is written so far is sure to appear.";
    WriterClose = "Writer"."close"() -> Void, Writes, "", "Ends writing.";
    ViewRepaint = "View3D"."repaint"() -> Void, Prints, "", "Nothing: there is no window.";

    ColorSet = "RGBColor"."set"(COLOR other) -> Void, Writes, "", "Copies.";
    ColorSetParts = "RGBColor"."set"(Float red, Float green, Float blue) -> Void, Writes, "0..=1", "Sets red, green and blue.";
    LightGetColor = "Light"."getColor"() -> COLOR, Pure, "0..=1", "Colour of the light; setting it changes the light.";
    LightSetVisualize = "Light"."setVisualize"(Boolean isShown) -> Void, Writes, "", "Whether a window shows its rays; nothing here.";
    LightSetRaylength = "Light"."setRaylength"(Float length) -> Void, Writes, "", "Length of rays in a window; nothing here.";
    LightSetIgnored = "Light"."setIgnoreShadows"(Boolean on) -> Void, Writes, "", "Whether fast previews draw its shadows; nothing here.";
    PointLightPower = "PointLight"."getPower"() -> Float, Pure, "W", "Power, the sum over red, green and blue.";
    PointLightSetExponent = "PointLight"."setAttenuationExponent"(Float exponent) -> Void, Writes, "", "How light fades in fast previews; nothing here: it fades with the square of the distance.";
    PointLightSetDistance = "PointLight"."setAttenuationDistance"(Float distance) -> Void, Writes, "m", "Where light has faded to a half in fast previews; nothing here.";
    SpotLightInnerAngle = "SpotLight"."getInnerAngle"() -> Float, Pure, "radians", "Half angle of full brightness.";
    SpotLightOuterAngle = "SpotLight"."getOuterAngle"() -> Float, Pure, "radians", "Half angle of the cone.";
    DirectionalLightPowerDensity = "DirectionalLight"."getPowerDensity"() -> Float, Pure, "W/m²", "Power per area, the sum over red, green and blue.";
    AreaLightPower = "AreaLight"."getPower"() -> Float, Pure, "W", "Power, the sum over red, green and blue.";
    AreaLightSetVisible = "AreaLight"."setVisible"(Boolean on) -> Void, Writes, "", "Whether windows show it; nothing here.";
    LightModelSetLayerVisible = "LightModel"."setLayerVisible"(Int layer, Boolean visible) -> Void, Writes, "", "Whether nodes of a layer take part in its light.";
    LightModelSetThreadCount = "LightModel"."setThreadCount"(Int n) -> Void, Writes, "", "Nothing: the number of threads is an option of the run.";
    LightModelSetMinPower = "LightModel"."setMinPower"(Double power) -> Void, Writes, "W", "Power below which rays end.";
    LightModelRayCount = "LightModel"."getRayCount"() -> Int, Pure, "", "Number of rays.";
    LightModelDepth = "LightModel"."getDepth"() -> Int, Pure, "", "Number of reflections.";
    LightModelComputeForced = "LightModel"."compute"(Boolean isForced) -> Void, Writes, "", "Traces the light.";
    LightModelSensed = "LightModel"."getSensedIrradiance"(Node node) -> SPECTRUM, Graph, "W/m²", "Power per area that a sensor receives.";
    LightModelSensed3d = "LightModel"."getSensedIrradiance3d"(Node node) -> SPECTRUM, Graph, "W/m²", "Power per area that a sensor receives.";

    MapPut = "Map"."put"(E key, V value) -> V, Writes, "", "Stores under a key, gives the old value.";
    MapGet = "Map"."get"(Object key) -> V, Pure, "", "Value of a key, null if none.";
    MapContainsKey = "Map"."containsKey"(Object key) -> Boolean, Pure, "", "Whether the key has a value.";
    MapRemove = "Map"."remove"(Object key) -> V, Writes, "", "Removes a key, gives its value.";
    MapSize = "Map"."size"() -> Int, Pure, "", "Number of keys.";
    MapIsEmpty = "Map"."isEmpty"() -> Boolean, Pure, "", "Whether there is no key.";
    MapClear = "Map"."clear"() -> Void, Writes, "", "Removes all.";
    MapKeySet = "Map"."keySet"() -> ValueType::Of(ClassId::Set, 0), Pure, "", "The keys, in Java's order.";
    MapValues = "Map"."values"() -> ValueType::Of(ClassId::Collection, 1), Pure, "", "The values, in the order of their keys.";
    MapEntrySet = "Map"."entrySet"() -> ValueType::Entries, Pure, "", "Keys with their values, in Java's order.";
    MapPutAll = "Map"."putAll"(Class(ClassId::Map) map) -> Void, Writes, "", "Stores all that is in another map.";
    MapPutIfAbsent = "Map"."putIfAbsent"(E key, V value) -> V, Writes, "", "Stores under a key that has no value; gives the value it had.";
    TreeMapFirstKey = "TreeMap"."firstKey"() -> E, Pure, "", "The least key.";
    TreeMapLastKey = "TreeMap"."lastKey"() -> E, Pure, "", "The greatest key.";
    EntryKey = "Entry"."getKey"() -> E, Pure, "", "The key.";
    EntryValue = "Entry"."getValue"() -> V, Pure, "", "The value.";
    EntrySetValue = "Entry"."setValue"(V value) -> V, Writes, "", "Stores another value under the key, gives the old one.";
    MapContainsValue = "Map"."containsValue"(Object value) -> Boolean, Pure, "", "Whether some key has an equal value.";
    MapGetOrDefault = "Map"."getOrDefault"(Object key, V fallback) -> V, Pure, "", "Value of a key, or another one if it has none.";

    BufferAppend = "StringBuffer"."append"(Text value) -> Same, Writes, "", "Appends the text of a value.";
    BufferLength = "StringBuffer"."length"() -> Int, Pure, "", "Number of UTF-16 units.";
    BufferCharAt = "StringBuffer"."charAt"(Int index) -> Char, Pure, "", "Character at an index from 0.";
    BufferInsert = "StringBuffer"."insert"(Int index, Text value) -> Same, Writes, "", "Inserts the text of a value at an index.";
    BufferReverse = "StringBuffer"."reverse"() -> Same, Writes, "", "Turns the text round.";
    BufferSetLength = "StringBuffer"."setLength"(Int length) -> Void, Writes, "", "Cuts the text off, or fills it up with characters 0.";
    BufferDeleteCharAt = "StringBuffer"."deleteCharAt"(Int index) -> Same, Writes, "", "Removes the character at an index.";
    BufferDelete = "StringBuffer"."delete"(Int from, Int to) -> Same, Writes, "", "Removes what stands from an index up to another.";
    BufferReplace = "StringBuffer"."replace"(Int from, Int to, String text) -> Same, Writes, "", "Replaces what stands from an index up to another.";
    BufferSetCharAt = "StringBuffer"."setCharAt"(Int index, Char c) -> Void, Writes, "", "Replaces the character at an index.";
    BufferIndexOf = "StringBuffer"."indexOf"(String text) -> Int, Pure, "", "First place of a text, -1 if none.";
    BufferLastIndexOf = "StringBuffer"."lastIndexOf"(String text) -> Int, Pure, "", "Last place of a text, -1 if none.";
    BufferSubstring = "StringBuffer"."substring"(Int from) -> String, Pure, "", "From an index to the end.";
    BufferSubstringTo = "StringBuffer"."substring"(Int from, Int to) -> String, Pure, "", "From an index up to another.";
    BufferIsEmpty = "StringBuffer"."isEmpty"() -> Boolean, Pure, "", "Whether its length is 0.";

    ComparatorCompare = "Comparator"."compare"(Object a, Object b) -> Int, Pure, "", "Below, at or above 0 as the first stands before, at or after the second.";
    ComparatorReversed = "Comparator"."reversed"() -> COMPARATOR, Pure, "", "The other way round.";
    ComparableCompareTo = "Comparable"."compareTo"(Object value) -> Int, Pure, "", "Below, at or above 0 as it stands before, at or after another.";
    NumberCompareTo = "Number"."compareTo"(Object value) -> Int, Pure, "", "-1, 0 or 1 as it is less, equal or greater.";
    DoubleIsNaNValue = "Number"."isNaN"() -> Boolean, Pure, "", "Whether it is not a number.";
    RuntimeTotalMemory = "Runtime"."totalMemory"() -> Long, Writes, "bytes", "What texts, arrays and collections may take.";
    RuntimeMaxMemory = "Runtime"."maxMemory"() -> Long, Writes, "bytes", "What texts, arrays and collections may take.";
    RuntimeFreeMemory = "Runtime"."freeMemory"() -> Long, Writes, "bytes", "What of it is left.";
    RuntimeProcessors = "Runtime"."availableProcessors"() -> Int, Pure, "", "1: a model runs in one thread.";
    RuntimeGc = "Runtime"."gc"() -> Void, Pure, "", "Nothing.";
    DateTime = "Date"."getTime"() -> Long, Pure, "ms", "Milliseconds since 1970.";
    DateFormat = "SimpleDateFormat"."format"(Class(ClassId::Date) date) -> String, Pure, "", "Text of a moment.";
    DecimalFormat = "DecimalFormat"."format"(Double x) -> String, Pure, "", "Text of a number.";

    FunctionEvaluate = "Function"."=evaluate"(Object value) -> Object, Writes, "", "The value for an argument.";
    ThrowableMessage = "Throwable"."getMessage"() -> String, Pure, "", "Its message.";
    ThrowableSetMessage = "Throwable"."=message"(String message) -> Void, Writes, "", "Sets its message.";
    ThrowableLocalizedMessage = "Throwable"."getLocalizedMessage"() -> String, Pure, "", "Its message.";
    FloatListAdd = "FloatList"."add"(Float value) -> Boolean, Writes, "", "Appends.";
    FloatListPush = "FloatList"."push"(Float value) -> Boolean, Writes, "", "Appends.";
    FloatListPush3 = "FloatList"."push"(Float x, Float y, Float z) -> Void, Writes, "", "Appends three numbers.";
    FloatListAddAll = "FloatList"."addAll"(FloatArray values, Int begin, Int n) -> Void, Writes, "", "Appends n numbers of an array from an index on.";
    FloatListGet = "FloatList"."get"(Int index) -> Float, Pure, "", "Number at an index from 0.";
    FloatListSize = "FloatList"."size"() -> Int, Pure, "", "How many numbers.";
    FloatListClear = "FloatList"."clear"() -> Void, Writes, "", "Removes all.";
    IntListAdd = "IntList"."add"(Int value) -> Boolean, Writes, "", "Appends.";
    IntListPush = "IntList"."push"(Int value) -> Boolean, Writes, "", "Appends.";
    IntListPush3 = "IntList"."push"(Int a, Int b, Int c) -> Void, Writes, "", "Appends three numbers.";
    IntListAddAll = "IntList"."addAll"(IntArray values, Int begin, Int n) -> Void, Writes, "", "Appends n numbers of an array from an index on.";
    IntListGet = "IntList"."get"(Int index) -> Int, Pure, "", "Number at an index from 0.";
    IntListSize = "IntList"."size"() -> Int, Pure, "", "How many numbers.";
    IntListClear = "IntList"."clear"() -> Void, Writes, "", "Removes all.";
    MeshSetVertexList = "PolygonMesh"."setVertexData"(Class(ClassId::FloatList) data) -> Void, Writes, "m", "x, y, z of each corner.";
    MeshSetIndexList = "PolygonMesh"."setIndexData"(Class(ClassId::IntList) data) -> Void, Writes, "", "Three corners of each triangle, counter-clockwise from its front.";
    MeshArea = "Node"."getSurfaceArea"() -> Double, Graph, "m²", "Area of the triangles of a `MeshNode`, one side; 0 for other nodes.";
    MeshSetVertices = "PolygonMesh"."setVertexData"(FloatArray data) -> Void, Writes, "m", "x, y, z of each corner.";
    MeshSetIndices = "PolygonMesh"."setIndexData"(IntArray data) -> Void, Writes, "", "Three corners of each triangle, counter-clockwise from its front.";
    MeshSetNormals = "PolygonMesh"."setNormalData"(FloatArray data) -> Void, Writes, "", "x, y, z of the normal at each corner.";
    MeshSetTextures = "PolygonMesh"."setTextureData"(FloatArray data) -> Void, Writes, "", "u, v at each corner.";
    ThrowablePrintStackTrace = "Throwable"."printStackTrace"() -> Void, Prints, "", "Prints it.";
    FileIsDirectory = "File"."isDirectory"() -> Boolean, Writes, "", "Whether it is a folder.";
    FileIsFile = "File"."isFile"() -> Boolean, Writes, "", "Whether it is a file.";
    FileList = "File"."list"() -> StringArray, Writes, "", "Names of what the folder holds, sorted; null if it is no folder.";
    FileListFiles = "File"."listFiles"() -> FileArray, Writes, "", "What the folder holds, sorted by name; null if it is no folder.";
    FileParent = "File"."getParent"() -> String, Pure, "", "The path of the folder it stands in; null if none is named.";
    FileMkdir = "File"."mkdir"() -> Boolean, Writes, "", "True: folders are made when a file is written.";
    FileMkdirs = "File"."mkdirs"() -> Boolean, Writes, "", "True: folders are made when a file is written.";
    FileCreate = "File"."createNewFile"() -> Boolean, Writes, "", "Whether it was not there yet; it is made when it is written.";
}

static BY_NAME: LazyLock<Index<MethodId>> =
    LazyLock::new(|| index(MethodId::ALL, MethodId::signature));

/// The overloads of a method that the class `owner` (or `String`, `Object`) declares itself; callers walk up the lineage.
pub fn methods_named(owner: &str, name: &str) -> &'static [MethodId] {
    BY_NAME.get(owner, name)
}

/// A public field of a library class.
#[derive(Clone, Copy, Debug)]
pub struct LibraryField {
    /// Reads it.
    pub getter: MethodId,
    /// Writes it.
    pub setter: MethodId,
}

/// The public field `name` of a class or of what it extends.
pub fn field_named(class: ClassId, name: &str) -> Option<LibraryField> {
    let &(_, getter, setter) = FIELDS
        .iter()
        .find(|(owner, getter, _)| class.is_a(*owner) && getter.signature().name == name)?;
    Some(LibraryField { getter, setter })
}

/// Class, getter, setter of every public field; the getter's name is the field's.
#[rustfmt::skip]
static FIELDS: &[(ClassId, MethodId, MethodId)] = &[
    (ClassId::Tuple3d, MethodId::TupleX, MethodId::TupleSetX), (ClassId::Tuple3d, MethodId::TupleY, MethodId::TupleSetY),
    (ClassId::Tuple3d, MethodId::TupleZ, MethodId::TupleSetZ), (ClassId::Matrix, MethodId::Matrix00, MethodId::MatrixSet00),
    (ClassId::Matrix, MethodId::Matrix01, MethodId::MatrixSet01), (ClassId::Matrix, MethodId::Matrix02, MethodId::MatrixSet02),
    (ClassId::Matrix, MethodId::Matrix03, MethodId::MatrixSet03), (ClassId::Matrix, MethodId::Matrix10, MethodId::MatrixSet10),
    (ClassId::Matrix, MethodId::Matrix11, MethodId::MatrixSet11), (ClassId::Matrix, MethodId::Matrix12, MethodId::MatrixSet12),
    (ClassId::Matrix, MethodId::Matrix13, MethodId::MatrixSet13), (ClassId::Matrix, MethodId::Matrix20, MethodId::MatrixSet20),
    (ClassId::Matrix, MethodId::Matrix21, MethodId::MatrixSet21), (ClassId::Matrix, MethodId::Matrix22, MethodId::MatrixSet22),
    (ClassId::Matrix, MethodId::Matrix23, MethodId::MatrixSet23), (ClassId::Matrix, MethodId::Matrix30, MethodId::MatrixSet30),
    (ClassId::Matrix, MethodId::Matrix31, MethodId::MatrixSet31), (ClassId::Matrix, MethodId::Matrix32, MethodId::MatrixSet32),
    (ClassId::Matrix, MethodId::Matrix33, MethodId::MatrixSet33), (ClassId::RGBAShader, MethodId::ShaderRed, MethodId::ShaderSetRed),
    (ClassId::RGBAShader, MethodId::ShaderGreen, MethodId::ShaderSetGreen), (ClassId::RGBAShader, MethodId::ShaderBlue, MethodId::ShaderSetBlue),
    (ClassId::RGBAShader, MethodId::ShaderAlpha, MethodId::ShaderSetAlpha),
];

impl MethodId {
    /// Whether it is a public field's getter or setter, or an operator: not callable by name.
    pub fn is_hidden(self) -> bool {
        let is_operator = !self
            .signature()
            .name
            .starts_with(|c: char| c.is_alphabetic());
        is_operator
            || FIELDS
                .iter()
                .any(|&(_, getter, setter)| self == getter || self == setter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_inherited() {
        let x = field_named(ClassId::Spectrum3d, "x").map(|f| f.getter);
        assert_eq!(x, Some(MethodId::TupleX));
        assert!(field_named(ClassId::Random, "x").is_none());
        assert!(
            MethodId::TupleX.is_hidden()
                && MethodId::VectorPlus.is_hidden()
                && !MethodId::ListAdd.is_hidden()
        );
    }
}
