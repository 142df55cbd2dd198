//! Models written as text, grown, and what came of it.
#![allow(dead_code, reason = "each test binary uses a part of it")]

use std::sync::{Arc, Mutex};

use understory::check::{SourceModel, check};
use understory::diag::{Diagnostic, Severity, SourceMap};
use understory::eval::{StopSign, Value};
use understory::graph::{EdgeBits, Graph, NodeId};
use understory::growth::{Growth, GrowthOptions};
use understory::syntax::parse;

/// A model that can run, and what it prints.
pub(crate) struct Model {
    pub(crate) growth: Growth,
    printed: Arc<Mutex<String>>,
    sources: SourceMap,
}

impl Model {
    /// A model of one file, before `init`; the errors of one that is refused.
    pub(crate) fn new(text: &str) -> Result<Self, Vec<String>> {
        Self::of_files(&[("model.rgg", text)])
    }

    /// A model of several files.
    pub(crate) fn of_files(files: &[(&str, &str)]) -> Result<Self, Vec<String>> {
        Self::with(files, GrowthOptions::default(), Box::new(|| false))
    }

    /// A model with its options and its stop sign.
    pub(crate) fn with(
        files: &[(&str, &str)],
        options: GrowthOptions,
        stop: StopSign,
    ) -> Result<Self, Vec<String>> {
        let mut sources = SourceMap::default();
        let (mut models, mut errors) = (vec![], vec![]);
        let mut note = |found: &understory::diag::Diagnostics, sources: &SourceMap| {
            let found = found.sorted().into_iter();
            let wrong = found.filter(|d| d.severity == Severity::Error);
            errors.extend(wrong.map(|d| line_and_text(d, sources)));
        };
        for (name, text) in files {
            let file = sources.add(*name, *text);
            let (ast, read) = parse(file, text);
            note(&read, &sources);
            let name = (*name).into();
            models.push(SourceModel { name, ast });
        }
        let (model, checked) = check(&models);
        note(&checked, &sources);
        if !errors.is_empty() {
            return Err(errors);
        }
        let printed = Arc::new(Mutex::new(String::new()));
        let sink = Arc::clone(&printed);
        let output =
            Box::new(move |text: &str| sink.lock().expect("no panic before").push_str(text));
        let growth = Growth::new(&model, options, output, stop).expect("root and axiom fit");
        Ok(Self {
            growth,
            printed,
            sources,
        })
    }

    /// Runs `init` and so many steps.
    pub(crate) fn grown(mut self, steps: u64) -> Result<Self, String> {
        let done = self.growth.init().and_then(|()| self.growth.run(steps));
        match done {
            Ok(()) => Ok(self),
            Err(fault) => Err(line_and_text(&fault, &self.sources)),
        }
    }

    /// All that was printed.
    pub(crate) fn printed(&self) -> String {
        self.printed.lock().expect("no panic before").clone()
    }

    /// What hangs below the `S`, as the golden models print it: branches in `[ ]`, successors in `( )` if there are several,
    /// both in the order of the edges; behind each name its field `v`, if it has one.
    pub(crate) fn shown(&self) -> String {
        let graph = self.growth.graph();
        let anchor = graph.types().find("S").expect("the model has a module S");
        let shown: Vec<String> = graph.extent(anchor).map(|s| chain(graph, s)).collect();
        shown.join(" ")
    }
}

/// `line: message (hint; hint)`
fn line_and_text(fault: &Diagnostic, sources: &SourceMap) -> String {
    let line = fault
        .primary
        .as_ref()
        .map_or(0, |label| sources.line_column(label.span).0);
    let hints = match fault.hints.as_slice() {
        [] => String::new(),
        hints => format!(" ({})", hints.join("; ")),
    };
    format!("{line}: {}{hints}", fault.message)
}

fn chain(graph: &Graph<Value>, node: NodeId) -> String {
    let ty = graph.type_of(node).expect("exists");
    let mut text = graph.types()[ty].name.to_string();
    if let Some(field) = graph.types().field(ty, "v") {
        text += &graph.get_i32(node, field).expect("an int").to_string();
    }
    let children = |bits: EdgeBits| {
        let found = graph
            .out_edges(node)
            .filter(move |(_, b)| b.intersects(bits));
        found
            .map(|(child, _)| chain(graph, child))
            .collect::<Vec<_>>()
    };
    for branch in children(EdgeBits::BRANCH) {
        text += &format!("[{branch}]");
    }
    for refined in children(EdgeBits::REFINEMENT) {
        text += &format!("/{refined}/");
    }
    let successors = children(EdgeBits::SUCCESSOR);
    for successor in &successors {
        text += &match successors.len() {
            1 => successor.clone(),
            _ => format!("({successor})"),
        };
    }
    text
}
