//! Where the turtle stands and what it carries.

use super::effect::{Change, N_REGISTERS, Register, Scope, StepLength};
use crate::graph::NodeId;
use glam::{DAffine3, DVec3};

/// First values of the registers, in the order of [`Register`]: GroIMP's.
const FIRST: [f32; N_REGISTERS] = [100.0, 0.1, 14.0, 0.0, 0.0, 0.0, 0.0, 0.0];

/// The numbers the turtle carries, each with a value for all that follows and one for the next shoot only.
///
/// They are `f32` because GroIMP computes them as Java's `float`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Registers {
    global: [f32; N_REGISTERS],
    local: [f32; N_REGISTERS],
}

impl Default for Registers {
    fn default() -> Self {
        Self {
            global: FIRST,
            local: FIRST,
        }
    }
}

impl Registers {
    /// The value for all that follows.
    #[must_use]
    pub const fn global(&self, register: Register) -> f32 {
        self.global[register as usize]
    }

    /// The value the next shoot sees.
    #[must_use]
    pub const fn local(&self, register: Register) -> f32 {
        self.local[register as usize]
    }

    /// The colour index the next shoot sees; only its low four bits choose a colour.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a colour index beyond i32 saturates, NaN becomes 0"
    )]
    pub fn color_index(&self) -> i32 {
        self.local(Register::Color).round() as i32
    }

    /// Bit patterns of all values: equal keys mean registers that behave alike.
    #[must_use]
    pub fn key(&self) -> [u32; 2 * N_REGISTERS] {
        let both = [self.global, self.local];
        std::array::from_fn(|i| both[i / N_REGISTERS][i % N_REGISTERS].to_bits())
    }

    pub(super) fn change(&mut self, register: Register, change: Change, scope: Scope, x: f32) {
        let at = register as usize;
        let values = match scope {
            Scope::Following => &mut self.global,
            Scope::Next => &mut self.local,
        };
        values[at] = match change {
            Change::Set => x,
            Change::Add => values[at] + x,
            Change::Mul => values[at] * x,
            Change::Reset => FIRST[at],
        };
        if scope == Scope::Following {
            self.local[at] = self.global[at];
        }
    }

    /// What a shoot does after it is drawn: the local values end.
    const fn end_shoot(&mut self) {
        self.local = self.global;
    }
}

/// Whose surface a node has, unless it has a shader of its own: as in GroIMP, that of the nearest node on the way to the
/// root that has one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Look {
    /// Nobody's: grey.
    #[default]
    Grey,
    /// That of a shoot of this colour, an index into the EGA palette.
    Ega(i32),
    /// That of a node with a shader.
    Of(NodeId),
}

/// The turtle: a frame that walks through space and the registers it carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurtleState {
    /// From the turtle's frame to the world (or to the group that is drawn): x left, y up, z head; metres.
    pub transform: DAffine3,
    /// What it carries.
    pub registers: Registers,
    /// Number of branch edges on the way from the root.
    pub order: u32,
    /// 1 + number of shoots on the way from the root.
    pub generative_distance: u32,
    /// How what it draws looks.
    pub look: Look,
}

impl Default for TurtleState {
    /// At the origin, head up, with the first values.
    fn default() -> Self {
        Self {
            transform: DAffine3::IDENTITY,
            registers: Registers::default(),
            order: 0,
            generative_distance: 1,
            look: Look::Grey,
        }
    }
}

impl TurtleState {
    /// The same turtle at the origin of a frame of its own: what a prototype is drawn with.
    #[must_use]
    pub const fn at_origin(mut self) -> Self {
        self.transform = DAffine3::IDENTITY;
        self
    }

    /// Where it stands.
    #[must_use]
    pub const fn position(&self) -> DVec3 {
        self.transform.translation
    }

    /// Unit vector it looks along (local z); zero if the frame is squashed to nothing.
    #[must_use]
    pub fn head(&self) -> DVec3 {
        self.transform.matrix3.z_axis.normalize_or_zero()
    }

    /// Radius in metres of a shoot whose own diameter is this; a negative one takes the turtle's.
    #[must_use]
    pub fn shoot_radius(&self, own_diameter: f32) -> f64 {
        let diameter = if own_diameter < 0.0 {
            self.registers.local(Register::Diameter)
        } else {
            own_diameter
        };
        f64::from(diameter) / 2.0
    }

    /// Colour index of a shoot whose own is this; a negative one takes the turtle's.
    #[must_use]
    pub fn shoot_color(&self, own_index: i32) -> i32 {
        if own_index < 0 {
            self.registers.color_index()
        } else {
            own_index
        }
    }

    /// Length in metres of a step with this number of its own. Shoots see the local length, moves the global one.
    #[must_use]
    pub fn step_length(&self, length: StepLength, own: f32, is_shoot: bool) -> f64 {
        let register = if is_shoot {
            self.registers.local(Register::Length)
        } else {
            self.registers.global(Register::Length)
        };
        f64::from(match length {
            StepLength::Own => own,
            StepLength::Register => register,
            StepLength::Plus => register + own,
            StepLength::Times => register * own,
            StepLength::Relative => register * (own - 1.0),
        })
    }

    /// Walks along the head, by so many metres of its own frame.
    pub fn walk(&mut self, length: f64) {
        self.transform.translation += self.transform.matrix3.z_axis * length;
    }

    /// Counts a shoot and ends the life of the local values.
    pub const fn end_shoot(&mut self) {
        self.registers.end_shoot();
        self.generative_distance = self.generative_distance.saturating_add(1);
    }

    /// Counts a branch edge.
    pub const fn enter_branch(&mut self) {
        self.order = self.order.saturating_add(1);
    }
}
