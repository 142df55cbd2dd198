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
    Spectrum3d: Vector3d, "Power or colour in red, green and blue, as x, y, z.";
    ChannelMap, "A value over a surface: a colour or a gray tone.";
    RGBColor: ChannelMap, "A colour, linear red, green, blue in 0..=1.";
    Graytone: ChannelMap, "A gray tone.";
    Shader, "What a surface looks like.";
    RGBAShader: Shader, "A matt (Lambertian) surface of one colour; the fraction 1 - alpha passes straight through.";
    Phong: Shader, "A surface with diffuse, glossy and transmitted parts.";
    Light, "What shines from a `LightNode`.";
    PointLight: Light, "Shines from a point into all directions.";
    SpotLight: PointLight, "Shines from a point into a cone along local z.";
    DirectionalLight: Light, "Parallel light along local z over all that lies downstream.";
    AreaLight: Light, "Makes the `Parallelogram` that carries it shine.";
    Sky: Light, "Light from all directions of the sky.";
    LightModel, "Traces light through the scene and tells what each node absorbs.";
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
    ArrayList: List, "Values in order, by index.";
    LinkedList: List, "Values in order, by index.";
    Vector: List, "Values in order, by index.";
    Map, "Values by key.";
    HashMap: Map, "Values by key.";
    StringBuffer, "Text that can be appended to.";
    StringBuilder, "Text that can be appended to.";
    Instance, "An object of a class of the model.";
    Throwable, "What can be thrown.";
    Error: Throwable, "A serious fault.";
    Exception: Throwable, "What can be thrown and is usually caught.";
    IOException: Exception, "A file that cannot be read or written.";
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
        assert_eq!(names, ["Spectrum3d", "Vector3d", "Tuple3d"]);
        assert!(ClassId::ArithmeticException.is_a(ClassId::Throwable));
        assert!(!ClassId::Point3d.is_a(ClassId::Vector3d));
        assert_eq!(ClassId::named("HashMap"), Some(ClassId::HashMap));
    }
}
