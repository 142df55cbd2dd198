//! What a node does to the turtle once its numbers are read, and doing it.

use super::effect::{Axis, Change, Register, Scope, StepLength};
use super::state::TurtleState;
use crate::math::functions::sin_cos;
use glam::{DMat3, DVec3};

/// What a node does to the turtle on the way to the node's children, with its numbers. Angles are degrees, lengths metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Nothing.
    None,
    /// A turtle step: moves, and a shoot ends the life of the local registers.
    Step {
        /// Where the length comes from.
        length: StepLength,
        /// The node's own number.
        own: f32,
        /// Whether it is a shoot.
        is_shoot: bool,
    },
    /// Moves along the head, as primitives do.
    Walk(f64),
    /// Turns about a local axis.
    Turn(Axis, f64),
    /// `HDir`: head at so many degrees from straight up.
    SetInclination(f64),
    /// `AdjustLU`.
    AdjustUp,
    /// `RG`.
    HeadDown,
    /// `RV` of this strength.
    Gravitropism(f64),
    /// `RV0`.
    RegisterGravitropism,
    /// `RD`: a direction of the world and a strength.
    BendTowards(DVec3, f64),
    /// `RO`: a direction of the world and a strength.
    BendAcross(DVec3, f64),
    /// `RP` and `RN`: a point of the world and a strength.
    BendToPoint(DVec3, f64),
    /// Changes a register.
    Assign(Register, Change, Scope, f32),
    /// Moves in the local frame.
    Translate(DVec3),
    /// Turns about local x, then y, then z.
    Rotate(DVec3),
    /// Scales along the local axes.
    Scale(DVec3),
}

impl TurtleState {
    /// Does what a node does: turns the state at the node into the one its children start from.
    pub fn execute(&mut self, action: &Action) {
        match *action {
            Action::None => {}
            Action::Step {
                length,
                own,
                is_shoot,
            } => {
                self.walk(self.step_length(length, own, is_shoot));
                if is_shoot {
                    self.end_shoot();
                }
            }
            Action::Walk(length) => self.walk(length),
            Action::Turn(axis, degrees) => turn(&mut self.transform.matrix3, axis, degrees),
            Action::SetInclination(degrees) => self.incline(degrees.to_radians()),
            Action::AdjustUp => self.roll_up(),
            Action::HeadDown => self.look_down(),
            Action::Gravitropism(strength) => self.bend_down(strength),
            Action::RegisterGravitropism => {
                self.bend_down(f64::from(self.registers.local(Register::Tropism)));
            }
            Action::BendTowards(direction, strength) => self.bend_towards(direction, strength),
            Action::BendAcross(direction, strength) => self.bend_across(direction, strength),
            Action::BendToPoint(target, strength) => self.bend_to_point(target, strength),
            Action::Assign(register, change, scope, x) => {
                self.registers.change(register, change, scope, x);
            }
            Action::Translate(by) => {
                self.transform.translation += self.transform.matrix3 * by;
            }
            Action::Rotate(degrees) => {
                let m = &mut self.transform.matrix3;
                turn(m, Axis::Left, degrees.x);
                turn(m, Axis::Up, degrees.y);
                turn(m, Axis::Head, degrees.z);
            }
            Action::Scale(by) => {
                let m = &mut self.transform.matrix3;
                *m = DMat3::from_cols(m.x_axis * by.x, m.y_axis * by.y, m.z_axis * by.z);
            }
        }
    }
}

/// Turns a frame right-handed about one of its own axes.
fn turn(m: &mut DMat3, axis: Axis, degrees: f64) {
    let (s, c) = sin_cos_degrees(degrees);
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    match axis {
        Axis::Left => (m.y_axis, m.z_axis) = (y * c + z * s, z * c - y * s),
        Axis::Up => (m.z_axis, m.x_axis) = (z * c + x * s, x * c - z * s),
        Axis::Head => (m.x_axis, m.y_axis) = (x * c + y * s, y * c - x * s),
    }
}

/// Sine and cosine of an angle in degrees, exact at the quarters of the circle: what is built at right angles stays so.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turned = degrees % 360.0;
    let quarter = |at: f64| turned == at || turned == at - 360.0;
    if turned == 0.0 {
        (0.0, 1.0)
    } else if quarter(90.0) {
        (1.0, 0.0)
    } else if quarter(180.0) {
        (0.0, -1.0)
    } else if quarter(270.0) {
        (-1.0, 0.0)
    } else {
        sin_cos(turned.to_radians())
    }
}

#[cfg(test)]
mod tests;
