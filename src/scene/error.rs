//! Why a description cannot become a scene.

use super::description::OrganId;
use crate::light::LightError;
use crate::material::MaterialError;

/// What is wrong with a [`SceneDescription`](super::description::SceneDescription), and with which organ of it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// A material that cannot exist.
    #[error("material {index}: {source}")]
    Material {
        /// Its number.
        index: usize,
        /// What is wrong with it.
        source: MaterialError,
    },
    /// A light source that cannot exist.
    #[error("light {index}: {source}")]
    Light {
        /// Its number.
        index: usize,
        /// What is wrong with it.
        source: LightError,
    },
    /// A sky or sun that cannot exist.
    #[error("sky or sun: {0}")]
    Environment(#[source] LightError),
    /// A shape or instance that cannot be placed.
    #[error("{problem}")]
    Organ {
        /// The organ it belongs to.
        organ: OrganId,
        /// What is wrong with it.
        problem: Problem,
    },
    /// The root group does not exist.
    #[error("the root is group {0}, which does not exist")]
    NoRoot(u32),
    /// More primitives, counting those of instances, than can be numbered.
    #[error("the scene has more than 2⁶² primitives, counting those of instances")]
    TooManyPrimitives,
    /// One group alone has more primitives, corners or instances than can be numbered.
    #[error("a group has {0} primitives, corners or instances, more than 2³⁰")]
    GroupTooLarge(usize),
    /// More shining primitives than can be listed.
    #[error("the scene has more than {limit} shining primitives, counting those of instances")]
    TooManyEmitters {
        /// How many there may be.
        limit: usize,
    },
    /// More infinite planes than can be tried one after the other.
    #[error("the scene has more than {limit} infinite planes, counting those of instances")]
    TooManyPlanes {
        /// How many there may be.
        limit: usize,
    },
    /// Groups nested too deeply.
    #[error("instances are nested more than {limit} deep")]
    TooDeep {
        /// How deep they may be.
        limit: usize,
    },
    /// Whoever wanted it wants it no more.
    #[error("the building was stopped before it had finished")]
    Stopped,
}

/// What is wrong with one shape or instance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// A coordinate or size is NaN or infinite.
    #[error("a coordinate or size is not a finite number")]
    NotFinite,
    /// A coordinate is beyond all reason.
    #[error("a coordinate is larger than {limit:e} m")]
    TooLarge {
        /// The largest allowed, in metres.
        limit: f64,
    },
    /// A size below 0.
    #[error("the {size} is {value}, less than 0")]
    Negative {
        /// Which size.
        size: &'static str,
        /// What was given.
        value: f64,
    },
    /// A placement that squeezes space flat.
    #[error("its placement has no inverse (a scale of 0, or axes in one plane)")]
    Singular,
    /// A material that is not in the list.
    #[error("it has material {0}, which does not exist")]
    NoMaterial(u32),
    /// A group that is not in the list.
    #[error("it is an instance of group {0}, which does not exist")]
    NoGroup(u32),
    /// A group inside itself.
    #[error("it is an instance of group {0}, which contains it")]
    Cycle(u32),
    /// A triangle whose corner is not in the list.
    #[error("triangle {0} of its mesh has a corner that does not exist")]
    NoCorner(usize),
    /// Normals or texture coordinates that do not match the corners.
    #[error("its mesh has {found} {what} for {corners} corners")]
    MeshLists {
        /// `normals` or `texture coordinates`.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many corners.
        corners: usize,
    },
}

impl SceneError {
    /// The organ at fault, if it is one's.
    #[must_use]
    pub fn organ(&self) -> Option<OrganId> {
        match self {
            Self::Organ { organ, .. } => Some(*organ),
            _ => None,
        }
    }
}
