//! Light models as the language sees them: their settings, and what they found out. Who runs a model decides how the light
//! is traced ([`LightSolver`]), since a growing model knows nothing of scenes.

use super::machine::Machine;
use super::memory::Charge;
use super::program::Program;
use crate::diag::Diagnostic;
use crate::graph::NodeId;
use crate::turtle::Layers;
use std::collections::HashMap;
use std::sync::Arc;

/// A light model: its settings and, once it has been computed, what it found.
#[derive(Clone, Debug)]
pub struct LightModel {
    /// Its settings.
    pub settings: LightSettings,
    /// What the last `compute()` found, and its share of the memory budget.
    pub solution: Option<(Arc<LightSolution>, Charge)>,
    /// Whether the model has been told that nothing was computed yet.
    pub has_warned: bool,
}

/// Settings of a light model.
#[derive(Clone, Debug, PartialEq)]
pub struct LightSettings {
    /// Number of rays, at least 1.
    pub rays: i32,
    /// Greatest number of reflections, at least 1.
    pub depth: i32,
    /// Seed of its generator.
    pub seed: i64,
    /// Power in W below which rays end in GroIMP; here they end by chance, which loses no power.
    pub min_power: f64,
    /// Layers whose nodes take no part.
    pub hidden: Layers,
    /// Whether `SensorNode`s are looked at.
    pub has_sensors: bool,
}

/// The light on one node, by red, green and blue.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NodeLight {
    /// Power that its surface keeps, W.
    pub absorbed: [f64; 3],
    /// Power that its surface sends back, W.
    pub reflected: [f64; 3],
    /// Power that its surface sends through, W.
    pub transmitted: [f64; 3],
    /// Power that meets its surface, the sum of the three, W.
    pub received: [f64; 3],
    /// Power per area that its sensor receives, W/m².
    pub sensed: [f64; 3],
    /// Rays that met its surface.
    pub hits: u64,
}

/// The light on all nodes that have a surface or a sensor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightSolution {
    /// By node. Looked up only, never iterated.
    nodes: HashMap<NodeId, NodeLight>,
}

impl LightSolution {
    /// Bytes that a solution for so many nodes takes.
    #[must_use]
    pub const fn bytes(n_nodes: usize) -> u64 {
        // A hash table keeps a part of its places free.
        (n_nodes as u64).saturating_mul((size_of::<(NodeId, NodeLight)>() as u64) * 2)
    }

    /// The solution in which these nodes have this light; the light on a node that comes twice is added up.
    #[must_use]
    pub fn of(nodes: impl IntoIterator<Item = (NodeId, NodeLight)>) -> Self {
        let mut all = HashMap::new();
        for (node, light) in nodes {
            all.entry(node)
                .and_modify(|known: &mut NodeLight| known.add(&light))
                .or_insert(light);
        }
        Self { nodes: all }
    }

    /// The light on a node: none on those that were not there, or had no surface, when the light was traced.
    #[must_use]
    pub fn get(&self, node: NodeId) -> NodeLight {
        self.nodes.get(&node).copied().unwrap_or_default()
    }

    /// Number of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are no nodes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
}

impl NodeLight {
    fn add(&mut self, other: &Self) {
        let sums = [
            (&mut self.absorbed, &other.absorbed),
            (&mut self.reflected, &other.reflected),
            (&mut self.transmitted, &other.transmitted),
            (&mut self.received, &other.received),
            (&mut self.sensed, &other.sensed),
        ];
        for (sum, more) in sums {
            for (a, b) in sum.iter_mut().zip(more) {
                *a += b;
            }
        }
        self.hits += other.hits;
    }
}

/// What traces light through a model while it grows.
pub trait LightSolver: Send {
    /// The light in the graph as it is, from the sources in it alone; all is dark without any.
    ///
    /// Equal graphs and settings give equal solutions, and the generator of the model is left as it was.
    ///
    /// # Errors
    /// What cannot be drawn, or that there is no room or no wish to go on.
    fn solve(
        &mut self,
        program: &Program,
        machine: &mut Machine,
        settings: &LightSettings,
    ) -> Result<LightSolution, Box<Diagnostic>>;
}

/// No light at all can be traced.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoSolver;

impl LightSolver for NoSolver {
    fn solve(
        &mut self,
        _: &Program,
        _: &mut Machine,
        _: &LightSettings,
    ) -> Result<LightSolution, Box<Diagnostic>> {
        let message = "the model traces light, but this run has no renderer".to_owned();
        let mut fault = Diagnostic::error("no-light-solver", crate::diag::Span::default(), message);
        fault.primary = None;
        Err(Box::new(fault.hint(
            "run it with `understory derive`, `render` or `light`",
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_on_a_node_drawn_twice_is_added_up() {
        let node = NodeId::from_bits(7).unwrap();
        let light = NodeLight {
            absorbed: [1.0, 2.0, 3.0],
            hits: 5,
            ..NodeLight::default()
        };
        let solution = LightSolution::of([(node, light), (node, light)]);
        assert_eq!(solution.len(), 1);
        assert_eq!(solution.get(node).absorbed, [2.0, 4.0, 6.0]);
        assert_eq!(solution.get(node).hits, 10);
        let other = NodeId::from_bits(8).unwrap();
        assert_eq!(solution.get(other), NodeLight::default());
    }
}
