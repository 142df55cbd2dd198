//! What a built-in node does to the turtle, as data.

/// A number the turtle carries besides its frame. Each has a global value and a local one; a shoot copies the global
/// values over the local ones, so a local value holds for the next shoot only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    /// Length of shoots without one of their own, metres (`L`).
    Length,
    /// Diameter of shoots without one of their own, metres (`D`).
    Diameter,
    /// Colour number of shoots without one of their own, index into the EGA palette (`P`).
    Color,
    /// Strength of gravitropism for `RV0` (`V`).
    Tropism,
    /// A number for the model's own use (`N`).
    Parameter,
    /// Carbon content (`C`), for the model's own use.
    Carbon,
    /// Heartwood share (`H`), for the model's own use.
    Heartwood,
    /// Number of internodes of a shoot (`U`), for the model's own use.
    InternodeCount,
}

/// How many registers there are.
pub const N_REGISTERS: usize = 8;

/// What a register command does with its argument x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Register becomes x.
    Set,
    /// Register grows by x.
    Add,
    /// Register is multiplied by x.
    Mul,
    /// Register gets its first value again.
    Reset,
}

/// Whether a register command changes the local value only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// Global value, copied to the local one.
    Following,
    /// Local value: the next shoot only.
    Next,
}

/// Where the length of a step comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepLength {
    /// The node's own `length`.
    Own,
    /// The length register.
    Register,
    /// The length register plus `argument`.
    Plus,
    /// The length register times `argument`.
    Times,
    /// The length register times (`argument` - 1): from the end of the last shoot to the place at this share of it.
    Relative,
}

/// An axis of the turtle's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Local x.
    Left,
    /// Local y.
    Up,
    /// Local z, the way the turtle walks.
    Head,
}

/// What a tropism bends towards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// The direction in `direction`; its length counts as strength.
    Direction,
    /// The plane perpendicular to `direction`.
    Plane,
    /// The point in `target`.
    Point,
    /// The place of the node in `targetNode`.
    Node,
}

/// What is drawn where the turtle stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are the types' own")]
pub enum Primitive {
    Sphere,
    Box,
    Cylinder,
    Cone,
    Frustum,
    Parallelogram,
    Plane,
    Text,
    Light,
    Sky,
    Sensor,
    Mesh,
    Surface,
    Sweep,
    Polygons,
}

impl Primitive {
    /// Whether the turtle moves on by the primitive's `length`.
    pub fn moves(self) -> bool {
        match self {
            Self::Box | Self::Cylinder | Self::Cone | Self::Frustum | Self::Parallelogram => true,
            Self::Sphere
            | Self::Plane
            | Self::Text
            | Self::Light
            | Self::Sky
            | Self::Sensor
            | Self::Mesh
            | Self::Surface
            | Self::Sweep
            | Self::Polygons => false,
        }
    }
}

/// What a node of a built-in type does to the turtle and to the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Nothing.
    None,
    /// Moves along the head; a shoot also draws a cylinder and ends the life of the local registers.
    Step {
        /// How far.
        length: StepLength,
        /// Whether it is a shoot.
        is_shoot: bool,
    },
    /// Right-handed turn about an axis by `angle` degrees, times `sign`.
    Turn(Axis, i8),
    /// Turns the head in its vertical plane to `angle` degrees from straight up.
    SetInclination,
    /// Rolls about the head until local y points up as far as it can.
    AdjustUp,
    /// Turns the head straight down.
    HeadDown,
    /// Gravitropism of strength `strength`.
    Gravitropism,
    /// Gravitropism of the strength in the tropism register.
    RegisterGravitropism,
    /// Bends towards something by `strength`.
    Tropism(Target),
    /// Changes a register.
    Assign(Register, Change, Scope),
    /// Moves by `translateX`, `translateY`, `translateZ` in the local frame.
    Translate,
    /// Turns by `rotateX`, then `rotateY`, then `rotateZ` degrees about the local axes.
    Rotate,
    /// Scales what follows.
    Scale,
    /// Applies the node's own transformation, if one was set.
    Group,
    /// As [`Effect::Group`], and draws.
    Draw(Primitive),
    /// Draws again what hangs below another node.
    Instance,
    /// As [`Effect::Group`], and what follows is drawn in a grid of `xCount` times `yCount` copies.
    Grid,
}
