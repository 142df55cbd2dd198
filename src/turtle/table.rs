//! The table of built-in node types: the one source for the checker, the interpreter and the language reference.

use super::effect::{Axis, Change, Effect, Primitive, Register, Scope, StepLength, Target};
use crate::graph::FieldKind;

/// What a field of a built-in type holds, in the terms of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are the language's own")]
pub enum FieldType {
    Boolean,
    Int,
    Float,
    Double,
    String,
    /// `Vector3d` or `Point3d`, also `float` versions and tuples.
    Vector,
    /// Anything that can be a transformation: `Matrix4d`, `TMatrix4d`, `TVector3d` …
    Transformation,
    Shader,
    Light,
    /// A curved surface.
    Surface,
    /// Triangles.
    Polygons,
    /// An array of `float`.
    Floats,
    Node,
}

impl FieldType {
    /// How the graph keeps it.
    pub fn kind(self) -> FieldKind {
        match self {
            Self::Boolean => FieldKind::Boolean,
            Self::Int => FieldKind::Int,
            Self::Float => FieldKind::Float,
            Self::Double => FieldKind::Double,
            Self::String
            | Self::Vector
            | Self::Transformation
            | Self::Shader
            | Self::Light
            | Self::Surface
            | Self::Polygons
            | Self::Floats
            | Self::Node => FieldKind::Object,
        }
    }
}

/// A field of a built-in type.
#[derive(Clone, Copy, Debug)]
pub struct BuiltinField {
    /// Name in the language. Names with a dot are not visible there; constructors and setters fill them.
    pub name: &'static str,
    /// What it holds.
    pub ty: FieldType,
    /// Its first value; objects begin as null.
    pub default: f64,
    /// Its unit, or an empty string.
    pub unit: &'static str,
    /// Whether few nodes set it (kept aside, see [`crate::graph::Storage::Side`]).
    pub is_rare: bool,
    /// What it means.
    pub doc: &'static str,
}

impl BuiltinField {
    const fn rare(mut self) -> Self {
        self.is_rare = true;
        self
    }
}

const fn field(
    name: &'static str,
    ty: FieldType,
    default: f64,
    unit: &'static str,
    doc: &'static str,
) -> BuiltinField {
    BuiltinField {
        name,
        ty,
        default,
        unit,
        is_rare: false,
        doc,
    }
}

/// A built-in node type.
#[derive(Clone, Copy, Debug)]
pub struct BuiltinType {
    /// Name in the language.
    pub name: &'static str,
    /// The type it extends (stands earlier in the table); empty for the topmost.
    pub parent: &'static str,
    /// Whether only types that extend it have nodes.
    pub is_abstract: bool,
    /// What a node of it does.
    pub effect: Effect,
    /// Own fields.
    pub fields: &'static [BuiltinField],
    /// Constructors: the fields their arguments fill, in order. Patterns with positional parameters use the same lists.
    pub constructors: &'static [&'static [&'static str]],
    /// What it is for.
    pub doc: &'static str,
}

const NO_ARGUMENTS: &[&[&str]] = &[&[]];
const ONE_ARGUMENT: &[&[&str]] = &[&["argument"]];
const ARGUMENT_OR_NOT: &[&[&str]] = &[&[], &["argument"]];
const ANGLE_OR_NOT: &[&[&str]] = &[&[], &["angle"]];

const ARGUMENT: &[BuiltinField] = &[field(
    "argument",
    FieldType::Float,
    1.0,
    "",
    "The command's number.",
)];
const ANGLE: &[BuiltinField] = &[field(
    "angle",
    FieldType::Float,
    0.0,
    "degrees",
    "How far to turn.",
)];
const STRENGTH: BuiltinField = field(
    "strength",
    FieldType::Float,
    0.01,
    "",
    "How strongly to bend; negative bends away.",
);
const LENGTH: BuiltinField = field(
    "length",
    FieldType::Float,
    1.0,
    "m",
    "Extent along the head (local z).",
);
const RADIUS: BuiltinField = field("radius", FieldType::Float, 1.0, "m", "Radius.");
const BASE_OPEN: BuiltinField = field(
    "baseOpen",
    FieldType::Boolean,
    0.0,
    "",
    "Whether the disk at the base is missing.",
)
.rare();
const TOP_OPEN: BuiltinField = field(
    "topOpen",
    FieldType::Boolean,
    0.0,
    "",
    "Whether the disk at the top is missing.",
)
.rare();

const fn ty(
    name: &'static str,
    parent: &'static str,
    effect: Effect,
    fields: &'static [BuiltinField],
    constructors: &'static [&'static [&'static str]],
    doc: &'static str,
) -> BuiltinType {
    BuiltinType {
        name,
        parent,
        is_abstract: false,
        effect,
        fields,
        constructors,
        doc,
    }
}

const fn base(
    name: &'static str,
    parent: &'static str,
    effect: Effect,
    fields: &'static [BuiltinField],
    doc: &'static str,
) -> BuiltinType {
    BuiltinType {
        name,
        parent,
        is_abstract: true,
        effect,
        fields,
        constructors: &[],
        doc,
    }
}

const fn step(
    name: &'static str,
    length: StepLength,
    is_shoot: bool,
    doc: &'static str,
) -> BuiltinType {
    let parent = if is_shoot { "Shoot" } else { "Node" };
    let (fields, constructors) = match length {
        StepLength::Register => (&[] as &[_], NO_ARGUMENTS),
        StepLength::Own | StepLength::Plus | StepLength::Times | StepLength::Relative => {
            (ARGUMENT, ARGUMENT_OR_NOT)
        }
    };
    ty(
        name,
        parent,
        Effect::Step { length, is_shoot },
        fields,
        constructors,
        doc,
    )
}

const fn turn(name: &'static str, axis: Axis, sign: i8, doc: &'static str) -> BuiltinType {
    ty(
        name,
        "Node",
        Effect::Turn(axis, sign),
        ANGLE,
        ANGLE_OR_NOT,
        doc,
    )
}

const fn assign(
    name: &'static str,
    register: Register,
    change: Change,
    scope: Scope,
    doc: &'static str,
) -> BuiltinType {
    let (fields, constructors) = match change {
        Change::Reset => (&[] as &[_], NO_ARGUMENTS),
        Change::Set | Change::Add | Change::Mul => (ARGUMENT, ONE_ARGUMENT),
    };
    ty(
        name,
        "Node",
        Effect::Assign(register, change, scope),
        fields,
        constructors,
        doc,
    )
}

/// The seven commands of one register: set, add, multiply, reset, and the first three for the next shoot only.
macro_rules! register {
    ($register:ident, $what:literal, $($name:literal $change:ident $scope:ident),*) => {
        [$(assign($name, Register::$register, Change::$change, Scope::$scope,
            register_doc!($change $scope $what))),*]
    };
}

/// The text of a register command.
macro_rules! register_doc {
    (Set Following $what:literal) => {
        concat!("Sets the turtle's ", $what, " to `argument`.")
    };
    (Add Following $what:literal) => {
        concat!("Adds `argument` to the turtle's ", $what, ".")
    };
    (Mul Following $what:literal) => {
        concat!("Multiplies the turtle's ", $what, " by `argument`.")
    };
    (Reset Following $what:literal) => {
        concat!("Gives the turtle's ", $what, " its first value again.")
    };
    (Set Next $what:literal) => {
        concat!("Sets the ", $what, " of the next shoot only to `argument`.")
    };
    (Add Next $what:literal) => {
        concat!("Adds `argument` to the ", $what, " of the next shoot only.")
    };
    (Mul Next $what:literal) => {
        concat!(
            "Multiplies the ",
            $what,
            " of the next shoot only by `argument`."
        )
    };
}

/// All built-in types, parents before the types that extend them.
pub fn builtin_types() -> impl Iterator<Item = &'static BuiltinType> {
    BASIC
        .iter()
        .chain(STEPS)
        .chain(TURNS)
        .chain(&GROUPS)
        .chain(&SOLIDS)
        .chain(REGISTERS.iter().copied().flatten())
}

const BASIC: &[BuiltinType] = &[
    ty(
        "Node",
        "",
        Effect::None,
        &[
            field("name", FieldType::String, 0.0, "", "A name, for messages.").rare(),
            field(
                "layer",
                FieldType::Int,
                0.0,
                "",
                "Number of the layer it is drawn in.",
            )
            .rare(),
        ],
        NO_ARGUMENTS,
        "Any node; by itself it does nothing.",
    ),
    ty(
        "RGGRoot",
        "Node",
        Effect::None,
        &[],
        &[],
        "The root of the graph, `^`.",
    ),
    ty(
        "Axiom",
        "Node",
        Effect::None,
        &[],
        NO_ARGUMENTS,
        "What stands below the root before the first rule.",
    ),
    ty(
        "Null",
        "Node",
        Effect::Group,
        &[
            field(
                "transform",
                FieldType::Transformation,
                0.0,
                "",
                "Transformation of this node and all that follows.",
            )
            .rare(),
            field(
                "transform.x",
                FieldType::Double,
                0.0,
                "m",
                "Translation along local x.",
            )
            .rare(),
            field(
                "transform.y",
                FieldType::Double,
                0.0,
                "m",
                "Translation along local y.",
            )
            .rare(),
            field(
                "transform.z",
                FieldType::Double,
                0.0,
                "m",
                "Translation along local z.",
            )
            .rare(),
            field(
                "transforming",
                FieldType::Boolean,
                1.0,
                "",
                "Whether what follows is moved along; if not, it begins where this node would have begun.",
            )
            .rare(),
        ],
        &[&[], &["transform.x", "transform.y", "transform.z"]],
        "Groups what follows, at an offset if one is given.",
    ),
    ty(
        "ShadedNull",
        "Null",
        Effect::Group,
        &[
            field(
            "shader",
            FieldType::Shader,
            0.0,
            "",
            "How it and what follows look; null: as the last node before that has a shader, or that of a shoot's colour.",
        )
        .rare(),
            field(
                "treatedAsInfinite",
                FieldType::Boolean,
                0.0,
                "",
                "Whether GroIMP leaves it out of the bounds of the scene; no effect here.",
            )
            .rare(),
            field(
                "renderAsWireframe",
                FieldType::Boolean,
                0.0,
                "",
                "Whether windows draw its edges only; no effect here.",
            )
            .rare(),
        ],
        NO_ARGUMENTS,
        "Everything that has a surface.",
    ),
    base(
        "AxisBase",
        "ShadedNull",
        Effect::Group,
        &[
            LENGTH,
            field(
                "startPosition",
                FieldType::Float,
                0.0,
                "",
                "Where the turtle stands on it, as a share of the length: it is drawn from there on.",
            )
            .rare(),
            field(
                "endPosition",
                FieldType::Float,
                1.0,
                "",
                "Share of the length after which what follows stands, measured from the turtle's old place.",
            )
            .rare(),
            field(
                "scaleV",
                FieldType::Boolean,
                0.0,
                "",
                "Whether textures keep their scale along the length; no effect here.",
            )
            .rare(),
            field(
                "shiftPivot",
                FieldType::Boolean,
                0.0,
                "",
                "Whether a `Box` is drawn half its width further back; what follows stands where it would.",
            )
            .rare(),
        ],
        "Primitives along the head.",
    ),
    base(
        "Shoot",
        "ShadedNull",
        Effect::Group,
        &[],
        "Cylinders that the turtle draws while it walks.",
    ),
];

const STEPS: &[BuiltinType] = &[
    ty(
        "F",
        "Shoot",
        Effect::Step {
            length: StepLength::Own,
            is_shoot: true,
        },
        &[
            LENGTH,
            field(
                "diameter",
                FieldType::Float,
                -1.0,
                "m",
                "Diameter; negative takes the turtle's.",
            ),
            field(
                "color",
                FieldType::Int,
                -1.0,
                "",
                "EGA colour 0..15; negative takes the turtle's.",
            ),
        ],
        &[
            &[],
            &["length"],
            &["length", "diameter"],
            &["length", "diameter", "color"],
        ],
        "Draws a cylinder of this length and walks along it.",
    ),
    step(
        "F0",
        StepLength::Register,
        true,
        "Draws a cylinder of the turtle's length.",
    ),
    step(
        "FAdd",
        StepLength::Plus,
        true,
        "Draws a cylinder of the turtle's length plus `argument`.",
    ),
    step(
        "FMul",
        StepLength::Times,
        true,
        "Draws a cylinder of the turtle's length times `argument`.",
    ),
    step(
        "FRel",
        StepLength::Relative,
        true,
        "Draws a cylinder of the turtle's length times (`argument` - 1).",
    ),
    ty(
        "M",
        "Node",
        Effect::Step {
            length: StepLength::Own,
            is_shoot: false,
        },
        &[LENGTH],
        &[&[], &["length"]],
        "Walks without drawing.",
    ),
    step(
        "M0",
        StepLength::Register,
        false,
        "Walks by the turtle's length.",
    ),
    step(
        "MAdd",
        StepLength::Plus,
        false,
        "Walks by the turtle's length plus `argument`.",
    ),
    step(
        "MMul",
        StepLength::Times,
        false,
        "Walks by the turtle's length times `argument`.",
    ),
    step(
        "MRel",
        StepLength::Relative,
        false,
        "Walks by the turtle's length times (`argument` - 1).",
    ),
];

const DIRECTION: BuiltinField = field(
    "direction",
    FieldType::Vector,
    0.0,
    "",
    "Where to, in the world's frame.",
);
const BY_DIRECTION: &[&[&str]] = &[&["direction"], &["direction", "strength"]];

const TURNS: &[BuiltinType] = &[
    turn(
        "RU",
        Axis::Up,
        1,
        "Turns about local y: the head goes towards local +x.",
    ),
    turn(
        "RL",
        Axis::Left,
        1,
        "Turns about local x: the head goes towards local -y.",
    ),
    turn("RH", Axis::Head, 1, "Rolls about the head."),
    ty(
        "Plus",
        "Node",
        Effect::Turn(Axis::Up, 1),
        ANGLE,
        &[&["angle"]],
        "As `RU(angle)`.",
    ),
    ty(
        "Minus",
        "Node",
        Effect::Turn(Axis::Up, -1),
        ANGLE,
        &[&["angle"]],
        "As `RU(-angle)`.",
    ),
    ty(
        "HDir",
        "Node",
        Effect::SetInclination,
        ANGLE,
        ANGLE_OR_NOT,
        "Turns the head, in the vertical plane it lies in, to `angle` from straight up.",
    ),
    ty(
        "AdjustLU",
        "Node",
        Effect::AdjustUp,
        &[],
        NO_ARGUMENTS,
        "Rolls about the head until local y points up as far as it can; local x is then level.",
    ),
    ty(
        "RG",
        "Node",
        Effect::HeadDown,
        &[],
        NO_ARGUMENTS,
        "Turns the head straight down.",
    ),
    ty(
        "RV",
        "Node",
        Effect::Gravitropism,
        &[STRENGTH],
        &[&["strength"]],
        "Gravitropism: the new head is head + strength · (0, 0, -1), normalized.",
    ),
    ty(
        "RV0",
        "Node",
        Effect::RegisterGravitropism,
        &[],
        NO_ARGUMENTS,
        "As `RV` with the turtle's tropism.",
    ),
    ty(
        "RD",
        "Node",
        Effect::Tropism(Target::Direction),
        &[DIRECTION, STRENGTH],
        BY_DIRECTION,
        "Bends towards a direction d, by strength · |head × d| radians.",
    ),
    ty(
        "RO",
        "Node",
        Effect::Tropism(Target::Plane),
        &[DIRECTION, STRENGTH],
        BY_DIRECTION,
        "Bends towards the plane perpendicular to a direction d, by strength · head·d radians.",
    ),
    ty(
        "RP",
        "Node",
        Effect::Tropism(Target::Point),
        &[
            field(
                "target",
                FieldType::Vector,
                0.0,
                "m",
                "Where to, in the world's frame.",
            ),
            STRENGTH,
        ],
        &[&["target"], &["target", "strength"]],
        "Bends towards a point, as `RD` with the unit vector to it.",
    ),
    ty(
        "RN",
        "Node",
        Effect::Tropism(Target::Node),
        &[
            field(
                "targetNode",
                FieldType::Node,
                0.0,
                "",
                "The node to bend to.",
            ),
            STRENGTH,
        ],
        &[&["targetNode"], &["targetNode", "strength"]],
        "Bends towards the place of a node, as `RP`.",
    ),
];

const GROUPS: [BuiltinType; 4] = [
    ty(
        "Translate",
        "Node",
        Effect::Translate,
        &[
            field("translateX", FieldType::Float, 0.0, "m", "Along local x."),
            field("translateY", FieldType::Float, 0.0, "m", "Along local y."),
            field("translateZ", FieldType::Float, 0.0, "m", "Along local z."),
        ],
        &[&[], &["translateX", "translateY", "translateZ"]],
        "Moves in the local frame.",
    ),
    ty(
        "Rotate",
        "Node",
        Effect::Rotate,
        &[
            field(
                "rotateX",
                FieldType::Float,
                0.0,
                "degrees",
                "About local x, first.",
            ),
            field(
                "rotateY",
                FieldType::Float,
                0.0,
                "degrees",
                "About local y, second.",
            ),
            field(
                "rotateZ",
                FieldType::Float,
                0.0,
                "degrees",
                "About local z, third.",
            ),
        ],
        &[&[], &["rotateX", "rotateY", "rotateZ"]],
        "Turns about the local axes.",
    ),
    ty(
        "Scale",
        "Node",
        Effect::Scale,
        &[
            field("scaleX", FieldType::Float, 1.0, "", "Along local x."),
            field("scaleY", FieldType::Float, 1.0, "", "Along local y."),
            field("scaleZ", FieldType::Float, 1.0, "", "Along local z."),
            field(
                "scale",
                FieldType::Float,
                1.0,
                "",
                "In all directions, on top of the others.",
            ),
        ],
        &[&[], &["scale"], &["scaleX", "scaleY", "scaleZ"]],
        "Scales all that follows.",
    ),
    ty(
        "Instance",
        "Node",
        Effect::Instance,
        &[field(
            "prototype",
            FieldType::Node,
            0.0,
            "",
            "What is drawn again: all that hangs below this node.",
        )],
        &[&["prototype"]],
        "Draws what hangs below another node once more at this place (not in GroIMP): forests from few trees.",
    ),
];

const SOLIDS: [BuiltinType; 17] = [
    ty(
        "Sphere",
        "ShadedNull",
        Effect::Draw(Primitive::Sphere),
        &[RADIUS],
        &[&[], &["radius"]],
        "A ball round the turtle.",
    ),
    ty(
        "Box",
        "AxisBase",
        Effect::Draw(Primitive::Box),
        &[
            field("width", FieldType::Float, 1.0, "m", "Extent along local x."),
            field(
                "height",
                FieldType::Float,
                1.0,
                "m",
                "Extent along local y.",
            ),
        ],
        &[
            &[],
            &["length"],
            &["length", "shiftPivot"],
            &["length", "width", "height"],
        ],
        "A box that stands on the turtle's place.",
    ),
    ty(
        "Cylinder",
        "AxisBase",
        Effect::Draw(Primitive::Cylinder),
        &[RADIUS, BASE_OPEN, TOP_OPEN],
        &[&[], &["length", "radius"]],
        "A cylinder along the head.",
    ),
    ty(
        "Cone",
        "AxisBase",
        Effect::Draw(Primitive::Cone),
        &[RADIUS, BASE_OPEN],
        &[&[], &["length", "radius"]],
        "A cone along the head, apex at the far end.",
    ),
    ty(
        "Frustum",
        "AxisBase",
        Effect::Draw(Primitive::Frustum),
        &[
            field(
                "baseRadius",
                FieldType::Float,
                1.0,
                "m",
                "Radius at the turtle's place.",
            ),
            field(
                "topRadius",
                FieldType::Float,
                0.5,
                "m",
                "Radius at the far end.",
            ),
            BASE_OPEN,
            TOP_OPEN,
        ],
        &[&[], &["length", "baseRadius", "topRadius"]],
        "A cone without its top.",
    ),
    ty(
        "Parallelogram",
        "AxisBase",
        Effect::Draw(Primitive::Parallelogram),
        &[
            field(
                "width.full",
                FieldType::Float,
                2.0,
                "m",
                "Extent along local x; `axis` is half of it.",
            ),
            field(
                "axis.y",
                FieldType::Float,
                0.0,
                "m",
                "Slant of half the width along local y.",
            )
            .rare(),
            field(
                "axis.z",
                FieldType::Float,
                0.0,
                "m",
                "Slant of half the width along local z.",
            )
            .rare(),
            field(
                "light",
                FieldType::Light,
                0.0,
                "",
                "An area light: it shines to the local +y side.",
            )
            .rare(),
        ],
        &[&[], &["length", "width.full"]],
        "A flat leaf: length along the head, width centred on local x, two-sided.",
    ),
    ty(
        "Plane",
        "ShadedNull",
        Effect::Draw(Primitive::Plane),
        &[],
        NO_ARGUMENTS,
        "The endless plane through the turtle, perpendicular to its head.",
    ),
    ty(
        "Mesh",
        "ShadedNull",
        Effect::Draw(Primitive::Mesh),
        &[field(
            "file",
            FieldType::String,
            0.0,
            "",
            "Name of the file, beside the model.",
        )],
        &[&[], &["file"]],
        "Triangles from a `.obj`, `.glb` or `.gltf` file, in metres at the turtle's place; with a shader of its own it takes that \
         for all of it (not in GroIMP). `.glb` and `.gltf` are turned so that their up is the head; a `.obj` stands as it is.",
    ),
    base(
        "CurvedBase",
        "ShadedNull",
        Effect::Group,
        &[
            field(
                "error",
                FieldType::Float,
                0.0,
                "m",
                "How far its triangles may be from it; 0 is a thousandth of its size.",
            )
            .rare(),
            BASE_OPEN,
            TOP_OPEN,
            field(
                "flatness",
                FieldType::Float,
                1.0,
                "",
                "Kept for models that set it; no effect.",
            )
            .rare(),
            field(
                "visibleSides",
                FieldType::Int,
                2.0,
                "",
                "Kept for models that set it; no effect.",
            )
            .rare(),
        ],
        "Curved surfaces and meshes.",
    ),
    ty(
        "NURBSSurface",
        "CurvedBase",
        Effect::Draw(Primitive::Surface),
        &[field(
            "surface",
            FieldType::Surface,
            0.0,
            "",
            "The surface, such as a `BezierSurface` or a `ProfileSweep`.",
        )],
        &[&[], &["surface"]],
        "A curved surface, in metres at the turtle's place; two-sided.",
    ),
    ty(
        "Sweep",
        "CurvedBase",
        Effect::Draw(Primitive::Sweep),
        &[field(
            "points",
            FieldType::Floats,
            0.0,
            "m",
            "x, y, z and radius of each point.",
        )],
        &[&[], &["points"]],
        "A round stem along the smooth curve through points, from the first to the last, with a radius at each (not in GroIMP); \
         its ends are closed, or open with `baseOpen` and `topOpen`.",
    ),
    ty(
        "MeshNode",
        "CurvedBase",
        Effect::Draw(Primitive::Polygons),
        &[field(
            "polygons",
            FieldType::Polygons,
            0.0,
            "",
            "The triangles: a `PolygonMesh`.",
        )],
        &[&[], &["polygons"]],
        "Triangles that the model gives, in metres at the turtle's place; two-sided.",
    ),
    ty(
        "TextLabel",
        "Null",
        Effect::Draw(Primitive::Text),
        &[
            field("caption", FieldType::String, 0.0, "", "The text."),
            field(
                "height",
                FieldType::Float,
                1.0,
                "m",
                "Height of its letters; no effect here.",
            )
            .rare(),
        ],
        &[&[], &["caption"]],
        "A text; not drawn.",
    ),
    ty(
        "LightNode",
        "Null",
        Effect::Draw(Primitive::Light),
        &[field(
            "light",
            FieldType::Light,
            0.0,
            "",
            "The lamp; shines along the head.",
        )],
        NO_ARGUMENTS,
        "A lamp at the turtle's place.",
    ),
    ty(
        "Sky",
        "ShadedNull",
        Effect::Draw(Primitive::Sky),
        &[field(
            "powerDensity",
            FieldType::Float,
            50.0,
            "W/m²",
            "Power on a level square metre, the sum over red, green and blue.",
        )],
        NO_ARGUMENTS,
        "A sky of the colour of its own shader (white without one) that shines evenly from all sides. In GroIMP only a \
         `SunSkyLight` makes it shine; for such a sky there are `--sun` and `--turbidity`.",
    ),
    ty(
        "SensorNode",
        "ShadedNull",
        Effect::Draw(Primitive::Sensor),
        &[
            field(
                "radius",
                FieldType::Float,
                0.1,
                "m",
                "Radius of the disc that senses, in the plane of local x and y.",
            ),
            field(
                "twoSided",
                FieldType::Boolean,
                0.0,
                "",
                "Whether both sides sense, not only the one that looks along the head.",
            ),
            field(
                "exponent",
                FieldType::Float,
                1.0,
                "",
                "Exponent of the cosine by which it senses; with 1 it reads the irradiance on its plane.",
            ),
        ],
        &[&[], &["radius"]],
        "Measures the light that passes it (`getSensedIrradiance` of a `LightModel`), in the bands of its colour; not drawn.",
    ),
    ty(
        "GridClonerNode",
        "Null",
        Effect::Grid,
        &[
            field("xCount", FieldType::Int, 10.0, "", "Copies along local x."),
            field("yCount", FieldType::Int, 10.0, "", "Copies along local y."),
            field(
                "xDistance",
                FieldType::Float,
                10.0,
                "m",
                "Distance of copies along local x.",
            ),
            field(
                "yDistance",
                FieldType::Float,
                10.0,
                "m",
                "Distance of copies along local y.",
            ),
        ],
        &[&[], &["xCount", "xDistance", "yCount", "yDistance"]],
        "Repeats all that follows in a grid: copy (0, 0) stands where it would, copy (i, j) at `i * xDistance`, `j * yDistance`. \
         GroIMP does so in its flux light model only; here pictures show the copies too.",
    ),
];

const REGISTERS: [&[BuiltinType]; 8] = [
    &register!(Length, "shoot length", "L" Set Following, "LAdd" Add Following, "LMul" Mul Following,
        "L0" Reset Following, "Ll" Set Next, "LlAdd" Add Next, "LlMul" Mul Next),
    &register!(Diameter, "shoot diameter", "D" Set Following, "DAdd" Add Following, "DMul" Mul Following,
        "D0" Reset Following, "Dl" Set Next, "DlAdd" Add Next, "DlMul" Mul Next),
    &register!(Color, "shoot colour", "P" Set Following, "P0" Reset Following, "Pl" Set Next),
    &register!(Tropism, "tropism", "V" Set Following, "VAdd" Add Following, "VMul" Mul Following,
        "V0" Reset Following, "Vl" Set Next, "VlAdd" Add Next, "VlMul" Mul Next),
    &register!(Parameter, "parameter", "N" Set Following, "NAdd" Add Following, "NMul" Mul Following,
        "N0" Reset Following, "Nl" Set Next, "NlAdd" Add Next, "NlMul" Mul Next),
    &register!(Carbon, "carbon", "C" Set Following, "CAdd" Add Following, "CMul" Mul Following,
        "C0" Reset Following, "Cl" Set Next, "ClAdd" Add Next, "ClMul" Mul Next),
    &register!(Heartwood, "heartwood", "H" Set Following, "HAdd" Add Following, "HMul" Mul Following,
        "H0" Reset Following, "Hl" Set Next, "HlAdd" Add Next, "HlMul" Mul Next),
    &register!(InternodeCount, "internode count", "U" Set Following, "UAdd" Add Following, "UMul" Mul Following,
        "U0" Reset Following, "Ul" Set Next, "UlAdd" Add Next, "UlMul" Mul Next),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_unique_and_parents_come_first() {
        let mut seen = BTreeSet::new();
        for ty in builtin_types() {
            assert!(
                ty.parent.is_empty() || seen.contains(ty.parent),
                "parent of {}",
                ty.name
            );
            assert!(seen.insert(ty.name), "{} twice", ty.name);
            assert!(ty.doc.ends_with('.'), "doc of {}", ty.name);
        }
    }
}
