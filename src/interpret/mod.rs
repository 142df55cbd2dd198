//! From a grown graph to a scene: what the turtle draws on its way from the root.
//!
//! ```text
//! Source (graph + bodies of modules) → interpret → Interpretation { scene, organs, summary, warnings }
//!   grown       a growing model as a source
//!   source      what is asked of a grown model
//!   walk        the turtle's way through the graph, without recursion
//!   body        instantiation bodies and their prototypes
//!   instance    `Instance(node)`: groups drawn again
//!   grid        `GridClonerNode`: groups drawn in a grid
//!   shapes      one node → one shape
//!   meshes      meshes from files
//!   curved      curved surfaces and meshes that the model describes
//!   surfaces    shader, colour or lamp of a node
//!   images      pictures from files
//!   materials   shaders and colours → materials, each once
//!   lamps       lights → sources, emission
//!   blame       which node is at fault, and where it was made
//!   canvas      what has been drawn so far
//!   sensors     what measures light without being there
//!   organs      which node a primitive belongs to
//! ```
//! A node inherits the frame of the source of its first successor or branch edge, so each node is drawn once even where
//! several edges lead to it. Drawing is a pure function of the graph: no order of threads or of hashing shows in it.

mod appearance;
mod blame;
mod body;
mod canvas;
mod curved;
mod failure;
mod grid;
mod grown;
mod images;
mod instance;
mod lamps;
mod materials;
mod meshes;
mod organs;
mod sensors;
mod shaders;
mod shapes;
mod source;
mod surfaces;
mod walk;

pub use appearance::{Appearance, Lamp, LampKind, Purpose};
pub use failure::{Failure, explain};
pub use images::{DecodedPictures, Finder};
pub use organs::{Organ, Organs};
pub use sensors::Sensor;
pub use source::{Body, Source};

use crate::diag::Diagnostics;
use crate::math::Bounds3;
use crate::scene::description::SceneDescription;
use crate::turtle::Layers;

/// What drawing may cost, and what is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes that shapes and instances may take.
    pub memory: u64,
    /// How deep bodies may stand in bodies.
    pub body_depth: usize,
    /// Nodes that all bodies together may make.
    pub body_nodes: u64,
    /// Layers that are not drawn.
    pub hidden: Layers,
    /// What is drawn for.
    pub purpose: Purpose,
}

impl Default for Limits {
    /// Room for some twenty million shapes; bodies that no sensible model nests deeper.
    fn default() -> Self {
        Self {
            memory: 4 << 30,
            body_depth: 200,
            body_nodes: 1 << 30,
            hidden: Layers::default(),
            purpose: Purpose::Picture,
        }
    }
}

/// A drawn model.
#[derive(Debug)]
pub struct Interpretation {
    /// What light sees.
    pub scene: SceneDescription,
    /// What its organ numbers mean.
    pub organs: Organs,
    /// What later stages ask first.
    pub summary: Summary,
    /// What measures light without being there.
    pub sensors: Vec<Sensor>,
    /// What was drawn otherwise than the model says.
    pub warnings: Diagnostics,
}

/// What later stages ask first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Whether anything shines: a lamp, a surface, the sky.
    pub has_light: bool,
    /// Whether there is an endless plane.
    pub has_plane: bool,
    /// Bounds of all but endless planes and lamps, metres; empty if nothing is drawn.
    pub bounds: Bounds3,
}

/// Draws a model.
///
/// # Errors
/// The first organ that cannot be drawn, a body that fails, or drawing beyond the limits.
pub fn interpret<S: Source>(source: &mut S, limits: Limits) -> Result<Interpretation, Failure> {
    interpret_again(source, limits, &mut DecodedPictures::default())
}

/// Draws a model whose pictures may have been decoded for an earlier drawing, and keeps those of this one.
///
/// # Errors
/// As [`interpret`]; the pictures are then forgotten.
pub fn interpret_again<S: Source>(
    source: &mut S,
    limits: Limits,
    pictures: &mut DecodedPictures,
) -> Result<Interpretation, Failure> {
    let mut painter = walk::Painter::new(source, limits);
    painter.images = images::Images::with(std::mem::take(pictures));
    painter.draw_world()?;
    *pictures = std::mem::take(&mut painter.images).into_decoded();
    Ok(painter.finish())
}

#[cfg(test)]
mod tests;
