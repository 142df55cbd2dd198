//! A model as it stands at one moment, for whoever draws it: between two steps, or in the midst of one.

use crate::diag::{Diagnostic, Span};
use crate::eval::files::ModelFiles;
use crate::eval::{Machine, Program, Purity, Value};
use crate::graph::{Graph, NodeId, TypeId};
use crate::rewrite::Instantiated;

/// A model as it stands.
pub struct Sketch<'a> {
    program: &'a Program,
    machine: &'a mut Machine,
    /// Bytes of stack that an instantiation body may use; what is left to the running step, if `None`.
    body_stack: Option<usize>,
    /// When this is, for messages.
    moment: String,
}

impl<'a> Sketch<'a> {
    /// A model in the midst of a step, whose bodies share the budgets of the step.
    pub fn within_step(program: &'a Program, machine: &'a mut Machine) -> Self {
        let moment = match machine.step {
            0 => "during `init`".to_owned(),
            step => format!("during step {step}"),
        };
        Self {
            program,
            machine,
            body_stack: None,
            moment,
        }
    }

    /// A model after so many steps, whose bodies may each use so many bytes of stack.
    pub(super) fn after_step(
        program: &'a Program,
        machine: &'a mut Machine,
        step: u64,
        body_stack: usize,
    ) -> Self {
        Self {
            program,
            machine,
            body_stack: Some(body_stack),
            moment: format!("after step {step}"),
        }
    }

    /// The graph.
    pub fn graph(&self) -> &Graph<Value> {
        &self.machine.graph
    }

    /// The files that the model may use.
    pub fn files(&self) -> &dyn ModelFiles {
        &*self.machine.files
    }

    /// Whether the user wants the model to stop.
    pub fn is_stopped(&self) -> bool {
        self.machine.is_stopped()
    }

    /// Whether nodes of a type have an instantiation body, and whether equal fields then give equal geometry.
    pub fn instantiation(&self, ty: TypeId) -> Option<Purity> {
        self.program.instantiation(ty)
    }

    /// Where a module is declared; `None` for built-in types.
    pub fn declared_at(&self, ty: TypeId) -> Option<Span> {
        self.program.declared_at(ty)
    }

    /// Where in the model's text nodes of a type are made.
    pub fn made_at(&self, ty: TypeId) -> &[Span] {
        self.program.made_at(ty)
    }

    /// Makes the floating nodes that the instantiation body of `node` draws (none, if it has none); give them back to
    /// [`Sketch::free`]. Nodes among them may have bodies of their own.
    ///
    /// # Errors
    /// What went wrong in the body.
    pub fn instantiate(&mut self, node: NodeId) -> Result<Instantiated, Box<Diagnostic>> {
        if let Some(bytes) = self.body_stack {
            self.machine.stand(bytes);
        }
        self.program
            .instantiate(node, self.machine)
            .map_err(|trap| Box::new(trap.into_diagnostic().during(self.moment.clone())))
    }

    /// Frees what [`Sketch::instantiate`] made.
    pub fn free(&mut self, mut made: Instantiated) {
        let machine = &mut *self.machine;
        machine
            .queue
            .free_instantiated(&mut machine.graph, &mut made);
    }
}
