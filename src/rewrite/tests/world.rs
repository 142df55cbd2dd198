//! A tiny stand-in for the language: letters with one int, `x*10+y` as expressions, `(x > 4)` as conditions, `$A` for the
//! first A as a known node.

use crate::check::model::Arrow;
use crate::diag::Span;
use crate::graph::pattern::{
    Candidate, Condition, EdgeKind, EdgeWay, Pattern, PatternArg, PatternEdge, PatternNode,
};
use crate::graph::testing::{self, V, graph, new_node, split};
use crate::graph::{FieldId, Graph, NodeId};
use crate::rewrite::*;

/// An expression over the variables of a rule.
pub(super) type Expr = String;

#[derive(Clone, Copy, Debug)]
enum Variable {
    Int(i32),
    Node(NodeId),
}

pub(super) struct World {
    pub(super) graph: Graph<()>,
    pub(super) queue: Queue<()>,
    pub(super) mode: Mode,
    pool: ScratchPool,
    names: Vec<String>,
    values: Vec<Option<Variable>>,
    /// Nodes that searches have tried.
    n_visits: u64,
}

impl World {
    pub(super) fn new(start: &str) -> Self {
        Self {
            graph: graph(start),
            queue: Queue::default(),
            mode: Mode::default(),
            pool: ScratchPool::default(),
            names: vec![],
            values: vec![],
            n_visits: 0,
        }
    }

    fn variable(&self, name: &str) -> Option<Variable> {
        let slot = self.names.iter().position(|n| n == name)?;
        self.values[slot]
    }

    fn slot(&mut self, name: &str) -> u16 {
        let found = self.names.iter().position(|n| n == name);
        found.unwrap_or_else(|| {
            self.names.push(name.to_owned());
            self.values.push(None);
            self.names.len() - 1
        }) as u16
    }

    fn value(&self, expr: &str) -> i32 {
        let atom = |text: &str| match self.variable(text.trim()) {
            Some(Variable::Int(value)) => value,
            Some(Variable::Node(node)) => self.graph.get_i32(node, V).expect("exists"),
            None => text
                .trim()
                .parse()
                .unwrap_or_else(|_| panic!("value of `{text}`")),
        };
        let product = |text: &str| text.split('*').map(atom).product::<i32>();
        expr.split('+').map(product).sum()
    }

    fn holds(&self, condition: &str) -> bool {
        condition.split("&&").all(|part| {
            let mut words = part.split_whitespace();
            let mut word = || words.next().unwrap_or_default();
            let (left, op, right) = (self.value(word()), word(), self.value(word()));
            match op {
                ">" => left > right,
                "<" => left < right,
                "==" => left == right,
                other => panic!("operator {other}"),
            }
        })
    }

    /// Applies rules such as `A(x) B ==> C(x)`, one step.
    pub(super) fn step(&mut self, rules: &[&str]) -> Result<(), RewriteError> {
        for rule in rules {
            self.rule(rule)?;
        }
        self.queue.apply(&mut self.graph)
    }

    fn rule(&mut self, rule: &str) -> Result<(), RewriteError> {
        let (left, right, arrow) = match rule.split_once("==>>") {
            Some((left, right)) => (left, right, Arrow::Spo),
            None => {
                let (left, right) = rule.split_once("==>").expect("an arrow");
                (left, right, Arrow::Lindenmayer)
            }
        };
        (self.names, self.values) = (vec![], vec![]);
        let pattern = self.pattern(left, false);
        let plan = Plan::new(&pattern);
        let excludes = self.mode.excludes_consumed;
        search(&pattern, &plan, excludes, self, &mut |world, found| {
            let Self {
                graph, queue, mode, ..
            } = world;
            if queue.admit(graph, *mode, |_| 1) {
                queue.begin(graph, &pattern, &plan, arrow, found.nodes());
                world.produce(right)?;
                world.queue.end(&mut world.graph);
            }
            Ok(world.mode.after_match())
        })
    }

    fn produce(&mut self, right: &str) -> Result<(), RewriteError> {
        for token in tokens(right) {
            match token.as_str() {
                "[" => self.queue.push(),
                "]" => self.queue.pop(),
                "," => self.queue.separator(),
                "+>" => self.queue.edge(EdgeKind::Branch, EdgeWay::Forward),
                name => {
                    let (name, arg) = split(name);
                    let node = match self.variable(name) {
                        Some(Variable::Node(node)) => node,
                        _ if name == "^" => self.graph.root(),
                        _ => {
                            let arg = arg
                                .map(|arg| format!("({})", self.value(arg)))
                                .unwrap_or_default();
                            new_node(&mut self.graph, &format!("{name}{arg}"))?
                        }
                    };
                    self.queue.node(&mut self.graph, node)?;
                }
            }
        }
        Ok(())
    }

    pub(super) fn pattern(&mut self, text: &str, is_query: bool) -> Pattern<Expr> {
        let mut pattern = Pattern {
            nodes: vec![],
            edges: vec![],
            conditions: vec![],
            choices: vec![],
            walks: vec![],
            relations: vec![],
            first: None,
            last: None,
            span: Span::default(),
        };
        let mut previous: Option<usize> = None;
        let (mut stack, mut is_context) = (vec![], is_query);
        let mut edge = None;
        for token in tokens(text) {
            match token.as_str() {
                "(*" => is_context = true,
                "*)" => is_context = false,
                "," => previous = None,
                "[" => {
                    stack.push(previous);
                    edge = Some(edge_of("+>"));
                }
                "]" => previous = stack.pop().expect("balanced"),
                condition if condition.starts_with('(') && condition.contains(' ') => {
                    let expr = condition[1..condition.len() - 1].to_owned();
                    let needs = vec![pattern.nodes.len() - 1];
                    let choice = None;
                    pattern.conditions.push(Condition {
                        expr,
                        needs,
                        choice,
                    });
                }
                operator
                    if !operator.starts_with(|c: char| c.is_alphabetic() || "^$".contains(c)) =>
                {
                    edge = Some(edge_of(operator));
                }
                node => {
                    let node = self.pattern_node(node, is_context, &pattern);
                    pattern.nodes.push(node);
                    let to = pattern.nodes.len() - 1;
                    let link = edge.take().unwrap_or(edge_of(">"));
                    if let Some(from) = previous {
                        pattern.edges.push(PatternEdge { from, to, ..link });
                    }
                    if !is_context {
                        pattern.first = pattern.first.or(Some(to));
                        if stack.is_empty() {
                            pattern.last = Some(to);
                        }
                    }
                    previous = Some(to);
                }
            }
        }
        pattern
    }

    fn pattern_node(
        &mut self,
        text: &str,
        is_context: bool,
        pattern: &Pattern<Expr>,
    ) -> PatternNode<Expr> {
        let (label, rest) = text
            .split_once(':')
            .map_or((None, text), |(l, r)| (Some(l), r));
        let (name, arg) = split(rest);
        let slot = label.map(|label| self.slot(label));
        let earlier = self.names.iter().position(|n| n == name).map(|i| i as u16);
        let same = pattern
            .nodes
            .iter()
            .position(|n| earlier.is_some() && n.slot == earlier);
        let what = match same {
            _ if name == "^" => Candidate::Root,
            _ if name.starts_with('$') => Candidate::Value(name[1..].to_owned()),
            Some(same) => Candidate::Same(same),
            None => Candidate::Type(testing::type_named(&self.graph, name)),
        };
        let arg = arg.map(|arg| match arg.parse::<i32>() {
            Ok(_) => PatternArg::Equal(V, arg.to_owned()),
            Err(_) => PatternArg::Bind(V, self.slot(arg)),
        });
        PatternNode {
            what,
            slot,
            args: arg.into_iter().collect(),
            is_context,
            choice: None,
            span: Span::default(),
        }
    }

    /// Values of the nodes labelled `b` in all matches, as the golden models print them.
    pub(super) fn query(&mut self, text: &str) -> String {
        (self.names, self.values) = (vec![], vec![]);
        let pattern = self.pattern(text, true);
        let plan = Plan::new(&pattern);
        let mut found = vec![];
        search::<_, Self>(&pattern, &plan, false, self, &mut |world, _| {
            found.push(world.value("b").to_string());
            Ok(Flow::Continue)
        })
        .expect("no errors in queries");
        found.join(" ")
    }

    /// As the golden models print it: `SA1[B2](C3)(D4)`, what hangs below the S.
    pub(super) fn show(&self) -> String {
        fn chain(graph: &Graph<()>, node: NodeId) -> String {
            use crate::graph::EdgeBits;
            let ty = graph.type_of(node).expect("exists");
            let mut text = graph.types()[ty].name.to_string();
            if !graph.types()[ty].fields.is_empty() {
                text += &graph.get_i32(node, V).expect("exists").to_string();
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
            let successors = children(EdgeBits::SUCCESSOR);
            for successor in &successors {
                let wrapped = format!("({successor})");
                text += if successors.len() > 1 {
                    &wrapped
                } else {
                    successor
                };
            }
            text
        }
        let s = testing::type_named(&self.graph, "S");
        self.graph
            .extent(s)
            .map(|node| chain(&self.graph, node))
            .collect::<Vec<_>>()
            .join(" ")
    }
}

impl MatchEnv<Expr> for World {
    type Object = ();
    type Error = RewriteError;

    fn graph(&self) -> &Graph<()> {
        &self.graph
    }

    fn spend(&mut self, n_visits: u32) -> Result<(), RewriteError> {
        self.n_visits += u64::from(n_visits);
        Ok(())
    }

    fn scratch(&mut self) -> &mut ScratchPool {
        &mut self.pool
    }

    fn bind_node(&mut self, slot: u16, node: Option<NodeId>) {
        self.values[usize::from(slot)] = node.map(Variable::Node);
    }

    fn bind_field(&mut self, slot: u16, node: NodeId, field: FieldId) -> Result<(), RewriteError> {
        let value = self.graph.get_i32(node, field)?;
        self.values[usize::from(slot)] = Some(Variable::Int(value));
        Ok(())
    }

    fn field_equals(
        &mut self,
        node: NodeId,
        field: FieldId,
        value: &Expr,
    ) -> Result<bool, RewriteError> {
        Ok(self.graph.get_i32(node, field)? == self.value(value))
    }

    fn condition(&mut self, condition: &Expr) -> Result<bool, RewriteError> {
        Ok(self.holds(condition))
    }

    fn node_value(&mut self, name: &Expr) -> Result<Option<NodeId>, RewriteError> {
        let ty = testing::type_named(&self.graph, name);
        Ok(self.graph.extent(ty).next())
    }
}

/// Splits at blanks that stand in no parentheses; brackets and commas are words.
fn tokens(text: &str) -> Vec<String> {
    let mut found = vec![];
    let (mut word, mut depth) = (String::new(), 0);
    let spaced = text.replace("(*", " \u{1} ").replace("*)", " \u{2} ");
    for c in spaced.chars() {
        depth += i32::from(matches!(c, '(' | '{')) - i32::from(matches!(c, ')' | '}'));
        if depth == 0 && matches!(c, ' ' | '[' | ']' | ',') {
            found.extend((!word.is_empty()).then(|| std::mem::take(&mut word)));
            found.extend((c != ' ').then(|| c.to_string()));
        } else {
            word.push(c);
        }
    }
    found.extend((!word.is_empty()).then_some(word));
    found
        .iter()
        .map(|t| t.replace('\u{1}', "(*").replace('\u{2}', "*)"))
        .collect()
}

fn edge_of(text: &str) -> PatternEdge {
    let once = (1, Some(1));
    let plain = |kind, way| PatternEdge {
        from: 0,
        to: 0,
        kind,
        way,
        repeat: once,
        is_minimal: false,
        choice: None,
    };
    let closure = |repeat| PatternEdge {
        repeat,
        ..plain(EdgeKind::Any, EdgeWay::Forward)
    };
    match text {
        ">" => plain(EdgeKind::Successor, EdgeWay::Forward),
        "<" => plain(EdgeKind::Successor, EdgeWay::Backward),
        "---" => plain(EdgeKind::Successor, EdgeWay::Undirected),
        "+>" => plain(EdgeKind::Branch, EdgeWay::Forward),
        "<+" => plain(EdgeKind::Branch, EdgeWay::Backward),
        "-->" => plain(EdgeKind::Any, EdgeWay::Forward),
        "<--" => plain(EdgeKind::Any, EdgeWay::Backward),
        "--" => plain(EdgeKind::Any, EdgeWay::Undirected),
        "-minDescendants->" => plain(EdgeKind::MinDescendants, EdgeWay::Forward),
        "<-minDescendants-" => plain(EdgeKind::MinDescendants, EdgeWay::Backward),
        "-ancestor->" => plain(EdgeKind::Ancestor, EdgeWay::Forward),
        "-descendants->" => plain(EdgeKind::Descendants, EdgeWay::Forward),
        "(-->)+" => closure((1, None)),
        "(-->)*" => closure((0, None)),
        "(-->)?" => closure((0, Some(1))),
        "(-->){2}" => closure((2, Some(2))),
        "(-->){1,3}" => closure((1, Some(3))),
        "(--)+" => PatternEdge {
            way: EdgeWay::Undirected,
            ..closure((1, None))
        },
        "(<--)+" => PatternEdge {
            way: EdgeWay::Backward,
            ..closure((1, None))
        },
        "(>)+" => PatternEdge {
            kind: EdgeKind::Successor,
            ..closure((1, None))
        },
        other => panic!("edge {other}"),
    }
}
