//! Constructors of library classes. A class without rows of its own takes its parent's: the type of the `new` expression
//! tells which class is made.

use std::sync::LazyLock;

use super::ValueType::{
    Boolean, Char, CharArray, Class, Double, Float, FloatArray, Int, IntArray, Long, String, Text,
    Void,
};
use super::signature::{Index, index, signatures};
use super::{ClassId, Effect, Signature, ValueType};

const SHADER: ValueType = Class(ClassId::Shader);
const MAP: ValueType = Class(ClassId::ChannelMap);

signatures! {
    /// A constructor of a library class: one per overload.
    ConstructorId;
    Tuple = "Tuple3d"."new"() -> Void, Pure, "", "All zero.";
    TupleOf = "Tuple3d"."new"(Double x, Double y, Double z) -> Void, Pure, "", "From x, y, z.";
    TupleCopy = "Tuple3d"."new"(Class(ClassId::Tuple3d) other) -> Void, Pure, "", "A copy.";
    Matrix = "Matrix"."new"() -> Void, Pure, "", "All zero.";
    MatrixCopy = "Matrix"."new"(Class(ClassId::Matrix) matrix) -> Void, Pure, "", "A copy.";
    Matrix3d = "Matrix3d"."new"() -> Void, Pure, "", "All zero.";
    Matrix3dCopy = "Matrix3d"."new"(Class(ClassId::Matrix) matrix) -> Void, Pure, "", "A copy.";
    Matrix3dOf = "Matrix3d"."new"(Double m00, Double m01, Double m02, Double m10, Double m11, Double m12, Double m20, Double m21, Double m22) -> Void, Pure, "", "Row by row.";
    RgbColor = "RGBColor"."new"(Float red, Float green, Float blue) -> Void, Pure, "0..=1", "From red, green, blue.";
    Graytone = "Graytone"."new"(Float value) -> Void, Pure, "0..=1", "A gray.";
    Shader = "RGBAShader"."new"() -> Void, Pure, "", "Half gray, opaque.";
    ShaderRgb = "RGBAShader"."new"(Float red, Float green, Float blue) -> Void, Pure, "0..=1", "From red, green, blue; opaque.";
    ShaderBits = "RGBAShader"."new"(Int rgb) -> Void, Pure, "", "From the bits 0xRRGGBB; opaque.";
    ShaderRgba = "RGBAShader"."new"(Float red, Float green, Float blue, Float alpha) -> Void, Pure, "0..=1", "From red, green, blue, alpha.";
    Phong = "Phong"."new"() -> Void, Pure, "", "Half gray, matt.";
    Mirror = "Mirror"."new"() -> Void, Pure, "", "Reflects all light.";
    MirrorPart = "Mirror"."new"(Double reflectance) -> Void, Pure, "0..=1", "Reflects this part of the light.";
    MirrorColor = "Mirror"."new"(Double red, Double green, Double blue) -> Void, Pure, "0..=1", "Reflects these parts of red, green, blue.";
    Metal = "Metal"."new"(Double red, Double green, Double blue) -> Void, Pure, "0..=1", "Polished, of this colour.";
    MetalRough = "Metal"."new"(Double red, Double green, Double blue, Double roughness) -> Void, Pure, "0..=1", "Of this colour; roughness 0 is polished.";
    Glass = "Glass"."new"() -> Void, Pure, "", "Clear and smooth, index of refraction 1.5.";
    GlassOf = "Glass"."new"(Double ior) -> Void, Pure, "", "Clear and smooth, with an index of refraction relative to what is around: water 1.33, glass 1.5, an air bubble in glass 0.667.";
    Pane = "Pane"."new"() -> Void, Pure, "", "Clear, index of refraction 1.5.";
    PaneOf = "Pane"."new"(Double ior) -> Void, Pure, "", "Clear, with an index of refraction.";
    Leaf = "LeafShader"."new"(Double red, Double green, Double blue, Double redThrough, Double greenThrough, Double blueThrough) -> Void, Pure, "0..=1", "From the parts of red, green, blue that are scattered back and those that are scattered through.";
    LeafColors = "LeafShader"."new"(MAP reflectance, MAP transmittance) -> Void, Pure, "", "From what is scattered back and what is scattered through: colours or pictures.";
    LeafLook = "LeafShader"."new"(MAP look, Double through) -> Void, Pure, "0..=1", "From a colour or picture of the light that a leaf does not swallow, and the part of that light that it scatters through.";
    ImageMap = "ImageMap"."new"() -> Void, Pure, "", "Half gray, until `setImageAdapter`.";
    ImageMapOf = "ImageMap"."new"(String file) -> Void, Pure, "", "From a PNG or JPEG file, by its name relative to the folder of the model.";
    Checker = "Checker"."new"() -> Void, Pure, "", "White and black.";
    CheckerOf = "Checker"."new"(MAP first, MAP second) -> Void, Pure, "", "Of two colours.";
    Placement = "AffineUVTransformation"."new"() -> Void, Pure, "", "As the texture coordinates are.";
    ShaderNamed = "ShaderRef"."new"(String name) -> Void, Pure, "", "As `shader(name)`.";
    Mix = "MixShader"."new"(SHADER first, SHADER second, Double share) -> Void, Pure, "0..=1", "The share of the second, and the rest of the first.";
    PointLight = "PointLight"."new"() -> Void, Pure, "", "White, 100 W.";
    SpotLight = "SpotLight"."new"() -> Void, Pure, "", "White, 100 W.";
    DirectionalLight = "DirectionalLight"."new"() -> Void, Pure, "", "White, 1 W/m².";
    AreaLight = "AreaLight"."new"() -> Void, Pure, "", "White, 100 W.";
    LightModel = "LightModel"."new"() -> Void, Pure, "", "Default numbers of rays and reflections.";
    LightModelOf = "LightModel"."new"(Int rays, Int depth) -> Void, Pure, "", "From numbers of rays and of reflections.";
    Random = "Random"."new"() -> Void, Random, "", "Seeded from the model's generator.";
    RandomSeed = "Random"."new"(Long seed) -> Void, Pure, "", "With this seed.";
    Integer = "Integer"."new"(Int n) -> Void, Pure, "", "Boxed.";
    Long = "Long"."new"(Long n) -> Void, Pure, "", "Boxed.";
    Float = "Float"."new"(Double value) -> Void, Pure, "", "Boxed.";
    Double = "Double"."new"(Double value) -> Void, Pure, "", "Boxed.";
    Boolean = "Boolean"."new"(Boolean value) -> Void, Pure, "", "Boxed.";
    Character = "Character"."new"(Char c) -> Void, Pure, "", "Boxed.";
    List = "List"."new"() -> Void, Pure, "", "Empty.";
    ListCapacity = "List"."new"(Int capacity) -> Void, Pure, "", "Empty, with room.";
    ListCopy = "List"."new"(Class(ClassId::Collection) elements) -> Void, Pure, "", "The same elements.";
    Map = "Map"."new"() -> Void, Pure, "", "Empty.";
    Set = "HashSet"."new"() -> Void, Pure, "", "Empty.";
    SetCopy = "HashSet"."new"(Class(ClassId::Collection) elements) -> Void, Pure, "", "The same elements.";
    MapCapacity = "HashMap"."new"(Int capacity) -> Void, Pure, "", "Empty, with room.";
    MapEmpty = "HashMap"."new"() -> Void, Pure, "", "Empty.";
    Tokens = "StringTokenizer"."new"(String text) -> Void, Pure, "", "The words between white space.";
    TokensBetween = "StringTokenizer"."new"(String text, Text separators) -> Void, Pure, "", "The words between any of these characters.";
    Dataset = "Dataset"."new"() -> Void, Writes, "", "The table without a name.";
    DatasetNamed = "Dataset"."new"(String name) -> Void, Writes, "", "The table of this name; empty if it is new.";
    File = "File"."new"(String path) -> Void, Pure, "", "From a path.";
    FileIn = "File"."new"(String folder, String name) -> Void, Pure, "", "From a folder and a name.";
    ReaderPath = "Reader"."new"(String path) -> Void, Writes, "", "Opens a file to read.";
    ReaderFile = "Reader"."new"(Class(ClassId::File) file) -> Void, Writes, "", "Opens a file to read.";
    ReaderOf = "BufferedReader"."new"(Class(ClassId::Reader) reader) -> Void, Pure, "", "Reads from another reader.";
    ScannerPath = "Scanner"."new"(Class(ClassId::File) file) -> Void, Writes, "", "Opens a file to read.";
    ScannerOf = "Scanner"."new"(Class(ClassId::Reader) reader) -> Void, Pure, "", "Reads from a reader.";
    WriterPath = "Writer"."new"(String path) -> Void, Writes, "", "Begins a file.";
    WriterFile = "Writer"."new"(Class(ClassId::File) file) -> Void, Writes, "", "Begins a file.";
    WriterAppend = "Writer"."new"(String path, Boolean isAppended) -> Void, Writes, "", "Begins a file, or goes on behind what is there.";
    WriterFileAppend = "Writer"."new"(Class(ClassId::File) file, Boolean isAppended) -> Void, Writes, "", "Begins a file, or goes on behind what is there.";
    WriterOf = "Writer"."new"(Class(ClassId::Writer) writer) -> Void, Pure, "", "Writes to another writer.";
    WriterOfFlushed = "Writer"."new"(Class(ClassId::Writer) writer, Boolean isFlushed) -> Void, Pure, "", "Writes to another writer.";
    SwitchShader2 = "AlgorithmSwitchShader"."new"(SHADER view, SHADER light) -> Void, Pure, "", "For pictures and for light models.";
    SwitchShader3 = "AlgorithmSwitchShader"."new"(SHADER window, SHADER view, SHADER light) -> Void, Pure, "", "For the window, for pictures and for light models.";
    SideShaderFront = "SideSwitchShader"."new"(SHADER front) -> Void, Pure, "", "For both sides.";
    SideShader = "SideSwitchShader"."new"(SHADER front, SHADER back) -> Void, Pure, "", "For the front and the back.";
    RgbColorZero = "RGBColor"."new"() -> Void, Pure, "", "Black.";
    ShaderOfColor = "RGBAShader"."new"(Class(ClassId::RGBColor) color) -> Void, Pure, "", "Of one colour, opaque.";
    LightModelLeast = "LightModel"."new"(Int rays, Int depth, Double minPower) -> Void, Pure, "", "From numbers of rays and of reflections; `minPower` has no effect.";
    Flux = "FluxLightModel"."new"() -> Void, Pure, "", "Default numbers of rays and reflections.";
    FluxOf = "FluxLightModel"."new"(Int rays, Int depth) -> Void, Pure, "", "From numbers of rays and of reflections.";
    FluxLeast = "FluxLightModel"."new"(Int rays, Int depth, Double minPower) -> Void, Pure, "", "From numbers of rays and of reflections; `minPower` has no effect.";
    FluxOfSensors = "FluxLightModel"."new"(Int rays, Int depth, Double minPower, Boolean sensors) -> Void, Pure, "", "And whether `SensorNode`s are looked at.";
    Buffer = "StringBuffer"."new"() -> Void, Pure, "", "Empty.";
    BufferText = "StringBuffer"."new"(String text) -> Void, Pure, "", "With this text.";
    BufferCapacity = "StringBuffer"."new"(Int n) -> Void, Pure, "", "Empty, with room.";
    Date = "Date"."new"() -> Void, Writes, "", "The moment of the step.";
    DateOf = "Date"."new"(Long millis) -> Void, Pure, "ms", "Milliseconds since 1970.";
    SimpleDateFormat = "SimpleDateFormat"."new"(String pattern) -> Void, Pure, "", "From a pattern of `yyyy MM dd HH mm ss SSS`.";
    DecimalFormat = "DecimalFormat"."new"(String pattern) -> Void, Pure, "", "From a pattern such as `0.00` or `#,##0.#`.";
    Throwable = "Throwable"."new"() -> Void, Pure, "", "Without a message.";
    ThrowableText = "Throwable"."new"(String message) -> Void, Pure, "", "With a message.";
    String = "String"."new"() -> Void, Pure, "", "Empty text.";
    StringOfChars = "String"."new"(CharArray chars) -> Void, Pure, "", "Of characters.";
    TreeSet = "TreeSet"."new"() -> Void, Pure, "", "Empty.";
    TreeSetCopy = "TreeSet"."new"(Class(ClassId::Collection) values) -> Void, Pure, "", "The same elements.";
    MapCopy = "HashMap"."new"(Class(ClassId::Map) map) -> Void, Pure, "", "The same keys and values.";
    MapLoad = "HashMap"."new"(Int n, Float load) -> Void, Pure, "", "Empty, with room.";
    TreeMapCopy = "TreeMap"."new"(Class(ClassId::Map) map) -> Void, Pure, "", "The same keys and values.";
    TreeMap = "TreeMap"."new"() -> Void, Pure, "", "Empty.";
    SetCapacity = "HashSet"."new"(Int n) -> Void, Pure, "", "Empty, with room.";
    StringCopy = "String"."new"(String text) -> Void, Pure, "", "The same text.";
    VertexListImpl = "VertexListImpl"."new"(FloatArray data, Int dimension) -> Void, Pure, "m", "From coordinates: 2 of each point, 3, or 4 with its weight (x, y, z times it).";
    CircleUnit = "Circle"."new"() -> Void, Pure, "", "Of radius 1.";
    CircleOf = "Circle"."new"(Float radius) -> Void, Pure, "m", "Of this radius.";
    RegularHexagon = "RegularPolygon"."new"() -> Void, Pure, "", "A hexagon of radius 1.";
    RegularPolygonOf = "RegularPolygon"."new"(Int sideCount) -> Void, Pure, "", "With so many sides and radius 1.";
    BSplineOfVertices = "BSplineOfVertices"."new"(Class(ClassId::VertexList) vertices, Int degree, Boolean periodic, Boolean bezier) -> Void, Pure, "", "From control points; closed if `periodic`, of Bézier pieces if `bezier`, else held by its ends.";
    InterpolatedCurve = "InterpolatedCurve"."new"(FloatArray points) -> Void, Pure, "m", "Through points: x, y, z of each; closed if the last is the first.";
    BezierSurface = "BezierSurface"."new"(FloatArray data, Int dimension, Int uCount) -> Void, Pure, "m", "From control points, `uCount` in a row.";
    BSplineGrid = "BSplineGrid"."new"(FloatArray data, Int dimension, Int uCount, Int uDegree, Int vDegree) -> Void, Pure, "m", "From control points, `uCount` in a row, and degrees; held by its corners.";
    ProfileSweep = "ProfileSweep"."new"(Class(ClassId::BSplineCurve) profile, Class(ClassId::BSplineCurve) trajectory) -> Void, Pure, "", "The profile stands at right angles to the trajectory.";
    SkinnedSweep = "SkinnedSurface"."new"(Class(ClassId::BSplineSurface) sweep) -> Void, Pure, "", "The same surface.";
    SkinnedSurface = "SkinnedSurface"."new"(Class(ClassId::Collection) curves) -> Void, Pure, "", "Over the curves of a list, which have the same degree and number of points.";
    SurfaceOfRevolution = "SurfaceOfRevolution"."new"(Class(ClassId::BSplineCurve) profile) -> Void, Pure, "", "From a curve in the plane of x and z.";
    FloatList = "FloatList"."new"() -> Void, Pure, "", "Empty.";
    FloatListOf = "FloatList"."new"(FloatArray values) -> Void, Pure, "", "The same numbers.";
    IntList = "IntList"."new"() -> Void, Pure, "", "Empty.";
    IntListOf = "IntList"."new"(IntArray values) -> Void, Pure, "", "The same numbers.";
    PolygonMesh = "PolygonMesh"."new"() -> Void, Pure, "", "Empty.";
}

static BY_NAME: LazyLock<Index<ConstructorId>> =
    LazyLock::new(|| index(ConstructorId::ALL, ConstructorId::signature));

/// The constructors of a class, its parent's where it has none of its own; empty for what only others make.
pub fn constructors_of(class: ClassId) -> &'static [ConstructorId] {
    if [
        ClassId::List,
        ClassId::Queue,
        ClassId::Matrix,
        ClassId::Deque,
        ClassId::Collection,
        ClassId::Map,
        ClassId::Set,
        ClassId::Reader,
        ClassId::Writer,
        ClassId::VertexList,
        ClassId::BSplineCurve,
        ClassId::BSplineSurface,
        ClassId::Polygons,
        ClassId::View3D,
        ClassId::Tuple3d,
        ClassId::Spectrum,
    ]
    .contains(&class)
    {
        return &[];
    }
    // A `BufferedReader` and a `Scanner` can also be made from what a plain reader is made from.
    class
        .lineage()
        .map(|c| BY_NAME.get(c.name(), "new"))
        .find(|found| !found.is_empty())
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_without_rows_takes_its_parents() {
        assert_eq!(constructors_of(ClassId::Vector3d).len(), 3);
        assert_eq!(constructors_of(ClassId::ArithmeticException).len(), 2);
        assert_eq!(
            constructors_of(ClassId::SpotLight),
            [ConstructorId::SpotLight]
        );
        assert!(constructors_of(ClassId::Shader).is_empty());
    }
}
