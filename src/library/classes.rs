//! The classes of the library and how they extend each other.

use std::collections::HashMap;
use std::sync::LazyLock;

macro_rules! classes {
    ($($variant:ident $(: $parent:ident)?, $doc:literal;)*) => {
        /// A class of the library.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum ClassId { $(#[doc = $doc] $variant,)* }

        impl ClassId {
            /// All of them, in order.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// Its name.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => stringify!($variant),)* }
            }

            /// The class it extends, `None` for `Object`.
            pub fn parent(self) -> Option<Self> {
                match self { $(Self::$variant => classes!(@parent $($parent)?),)* }
            }

            /// What it is, one sentence.
            pub fn doc(self) -> &'static str {
                match self { $(Self::$variant => $doc,)* }
            }
        }
    };
    (@parent) => { None };
    (@parent $parent:ident) => { Some(Self::$parent) };
}

classes! {
    Tuple3d, "Three doubles x, y, z.";
    Point3d: Tuple3d, "A point.";
    Vector3d: Tuple3d, "A vector.";
    Spectrum: Vector3d, "Power or colour in red, green and blue, as x, y, z.";
    Spectrum3d: Spectrum, "Power or colour in red, green and blue, as x, y, z.";
    Matrix, "A square matrix of doubles; element `m01` stands in row 0, column 1.";
    Matrix3d: Matrix, "3 × 3 doubles.";
    Matrix4d: Matrix, "4 × 4 doubles: turns, scales and moves points.";
    Matrix34d: Matrix4d, "A place: turns, scales and moves points.";
    TMatrix4d: Matrix4d, "A place: turns, scales and moves points.";
    ChannelMap, "A value over a surface: a colour or a gray tone.";
    RGBColor: ChannelMap, "A colour, linear red, green, blue in 0..=1.";
    Graytone: ChannelMap, "A gray tone.";
    SurfaceMap: ChannelMap, "A picture over a surface.";
    ImageMap: SurfaceMap, "A picture from a PNG or JPEG file. Where it is transparent, the surface has holes.";
    ImageRef: ImageMap, "A picture by its name.";
    Checker: SurfaceMap, "Two by two fields of two colours, and so on.";
    UVTransformation: ChannelMap, "How a picture lies on a surface.";
    AffineUVTransformation: UVTransformation, "How a picture lies on a surface: moved, turned, scaled and slanted.";
    Shader, "What a surface looks like.";
    RGBAShader: Shader, "A matt (Lambertian) surface of one colour; the fraction 1 - alpha passes straight through.";
    Phong: Shader, "A surface with matt, glossy and transmitting parts, which add up.";
    Mirror: Shader, "A mirror; it reflects the same part of the light at every angle.";
    Metal: Shader, "A metal; at grazing angles it reflects all light.";
    Glass: Shader, "The skin of a clear body (glass, water): reflects and refracts. For closed shapes.";
    Pane: Shader, "A thin flat sheet of glass, as in a greenhouse: light goes straight on behind it. For single faces.";
    LeafShader: Shader, "A matt leaf that scatters light back and through, the same on both sides.";
    MixShader: Shader, "Two shaders, mixed finely.";
    VertexList, "Points.";
    VertexListImpl: VertexList, "Points, given by their coordinates.";
    BSplineCurve, "A smooth curve.";
    Circle: BSplineCurve, "A circle round the origin in the plane of x and y.";
    RegularPolygon: BSplineCurve, "A regular polygon round the origin in the plane of x and y.";
    BSplineOfVertices: BSplineCurve, "A B-spline of control points.";
    InterpolatedCurve: BSplineCurve, "The smooth curve through points (not in GroIMP).";
    BSplineSurface, "A curved surface; `NURBSSurface` draws it.";
    BezierSurface: BSplineSurface, "One Bézier piece over a grid of control points.";
    BSplineGrid: BSplineSurface, "A B-spline surface over a grid of control points (not in GroIMP, whose class for it wants knots among the points).";
    ProfileSweep: BSplineSurface, "A profile carried along a curve; the surface between.";
    SkinnedSurface: BSplineSurface, "A smooth skin over curves.";
    SurfaceOfRevolution: BSplineSurface, "A curve in the plane of x and z, turned once round z (not in GroIMP).";
    Polygons, "Triangles; `MeshNode` draws them.";
    PolygonMesh: Polygons, "Triangles by their corners.";
    Light, "What shines from a `LightNode`.";
    PointLight: Light, "Shines from a point into all directions.";
    SpotLight: PointLight, "Shines from a point into a cone along local z.";
    DirectionalLight: Light, "Parallel light along local z over all that lies downstream.";
    AreaLight: Light, "Makes the `Parallelogram` that carries it shine.";
    LightModel, "Traces the light of the lamps through the model as it stands and tells what each node gets of it.";
    Random, "A generator of its own (`java.util.Random`).";
    Number, "A boxed number.";
    Byte: Number, "A boxed byte.";
    Short: Number, "A boxed short.";
    Integer: Number, "A boxed int.";
    Long: Number, "A boxed long.";
    Float: Number, "A boxed float.";
    Double: Number, "A boxed double.";
    Boolean, "A boxed boolean.";
    Character, "A boxed char.";
    Collection, "Several values.";
    List: Collection, "Values in order, by index.";
    Set: Collection, "Different values.";
    HashSet: Set, "Different values, in Java's order of their hash codes.";
    TreeSet: Set, "Different values, in their order.";
    LinkedHashSet: HashSet, "Different values, in order of insertion.";
    ArrayList: List, "Values in order, by index.";
    Queue: List, "Values in order, of which the first is taken first.";
    Deque: Queue, "Values in order, taken from both ends.";
    LinkedList: Deque, "Values in order, by index and from both ends.";
    ArrayDeque: Deque, "Values in order, taken from both ends.";
    Vector: List, "Values in order, by index.";
    Map, "Values by key.";
    Entry, "A key of a map with its value.";
    Stack: Vector, "Values of which the last is taken first.";
    TreeMap: Map, "Values by key, in order of the keys.";
    HashMap: Map, "Values by key, in Java's order of the keys' hash codes.";
    LinkedHashMap: HashMap, "Values by key, in order of insertion.";
    Hashtable: HashMap, "Values by key.";
    Iterator, "Goes through the elements of a collection.";
    StringTokenizer, "Goes through the words of a text.";
    Dataset, "A table: rows of values, with names of columns.";
    DatasetRef: Dataset, "A table by its name.";
    DatasetRow, "A row of a table.";
    FloatList, "Floats in order, such as the coordinates of a `PolygonMesh`.";
    IntList, "Whole numbers in order, such as the corners of the triangles of a `PolygonMesh`.";
    File, "The path of a file.";
    Reader, "A text file that is read.";
    FileReader: Reader, "A text file that is read.";
    BufferedReader: Reader, "A text file that is read line by line.";
    Scanner: Reader, "A text file that is read line by line or word by word.";
    Writer, "A text file that is written; it appears when the run is over.";
    FileWriter: Writer, "A text file that is written.";
    BufferedWriter: Writer, "A text file that is written.";
    PrintWriter: Writer, "A text file that is written.";
    View3D, "A window; there is none.";
    ShaderRef: Shader, "A matt surface with a picture, by its name.";
    AlgorithmSwitchShader: Shader, "One shader for pictures, another for light models.";
    SideSwitchShader: Shader, "One shader for each side of a surface.";
    FluxLightModel: LightModel, "A light model; the same one, with the names of GroIMP's other one.";
    StringBuffer, "Text that can be changed.";
    StringBuilder: StringBuffer, "Text that can be changed.";
    Function, "A function as a value.";
    Comparator, "Compares two values.";
    Comparable, "What can be compared with others of its kind.";
    Locale, "A country's way to write numbers; all write them the English way.";
    Runtime, "What the model may use.";
    Date, "A moment; growth knows no clock, so it is the number of the step in milliseconds.";
    SimpleDateFormat, "Writes moments after a pattern.";
    DecimalFormat, "Writes numbers after a pattern.";
    Class, "The class of a value.";
    Instance, "An object of a class of the model.";
    Throwable, "What can be thrown.";
    Error: Throwable, "A serious fault.";
    Exception: Throwable, "What can be thrown and is usually caught.";
    IOException: Exception, "A file that cannot be read or written.";
    FileNotFoundException: IOException, "There is no such file.";
    RuntimeException: Exception, "A fault of the model.";
    ArithmeticException: RuntimeException, "Integer division by zero.";
    ArrayStoreException: RuntimeException, "A value of a wrong type stored in an array.";
    ClassCastException: RuntimeException, "A cast to a type that the value does not have.";
    IllegalArgumentException: RuntimeException, "An argument out of range.";
    NumberFormatException: IllegalArgumentException, "Text that is no number.";
    IllegalStateException: RuntimeException, "A call at a wrong time.";
    IndexOutOfBoundsException: RuntimeException, "An index below 0 or beyond the end.";
    ArrayIndexOutOfBoundsException: IndexOutOfBoundsException, "An array index below 0 or beyond the end.";
    StringIndexOutOfBoundsException: IndexOutOfBoundsException, "A string index below 0 or beyond the end.";
    NoSuchElementException: RuntimeException, "There is no further element.";
    NegativeArraySizeException: RuntimeException, "An array of negative length.";
    NullPointerException: RuntimeException, "A member of null.";
    UnsupportedOperationException: RuntimeException, "Something that cannot be done.";
}

static BY_NAME: LazyLock<HashMap<&'static str, ClassId>> = LazyLock::new(|| {
    ClassId::ALL
        .iter()
        .map(|&class| (class.name(), class))
        .collect()
});

impl ClassId {
    /// The class with this simple name.
    pub fn named(name: &str) -> Option<Self> {
        let found = BY_NAME.get(name).copied();
        found.filter(|class| *class != Self::Instance)
    }

    /// The class itself, its parent, its parent's parent, ….
    pub fn lineage(self) -> impl Iterator<Item = Self> {
        std::iter::successors(Some(self), |class| class.parent())
    }

    /// Whether it is `other` or extends it.
    pub fn is_a(self, other: Self) -> bool {
        self.lineage().any(|class| class == other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lineage_ends_at_the_top() {
        let names: Vec<_> = ClassId::Spectrum3d.lineage().map(ClassId::name).collect();
        assert_eq!(names, ["Spectrum3d", "Spectrum", "Vector3d", "Tuple3d"]);
        assert!(ClassId::ArithmeticException.is_a(ClassId::Throwable));
        assert!(!ClassId::Point3d.is_a(ClassId::Vector3d));
        assert_eq!(ClassId::named("HashMap"), Some(ClassId::HashMap));
    }
}
