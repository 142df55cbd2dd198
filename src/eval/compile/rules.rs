//! Rules and the patterns of queries.

use super::Scope;
use super::places::with_kind;
use crate::check::model::{Arrow, Expr, Operator, Rule, Slot, Type};
use crate::diag::Span;
use crate::eval::access::Access;
use crate::eval::code::{Code, Exec, Flow, FromCode, Label, Source};
use crate::eval::machine::Machine;
use crate::eval::program::Program;
use crate::eval::stack::{Kind, Local};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::graph::pattern::{Candidate, Condition, Pattern, PatternArg, PatternNode};
use crate::graph::{FieldId, Graph, NodeId, TypeId};
use crate::rewrite::{self, Assignment, DeferredValue, MatchEnv, Plan, ScratchPool};

/// A pattern whose expressions are compiled.
pub(super) struct CompiledPattern {
    /// What it is a pattern of, in words.
    role: &'static str,
    pub(super) pattern: Pattern<PatternCode>,
    pub(super) plan: Plan,
    binders: Vec<Binder>,
}

/// An expression of a pattern.
pub(super) enum PatternCode {
    Condition(Source<bool>),
    Node(Source<Option<NodeId>>),
    Equal(FieldTest),
}

type FieldTest =
    Box<dyn Fn(&Program, &mut Machine, NodeId, FieldId) -> Result<bool, Trap> + Send + Sync>;
/// Stores a field of a matched node in a local variable.
type Binder = Box<dyn Fn(&mut Machine, NodeId, FieldId) -> Result<(), Trap> + Send + Sync>;

impl Scope<'_> {
    /// Compiles a pattern. Slots of labels become offsets of words, slots of parameters become numbers of binders.
    pub(super) fn pattern(&self, role: &'static str, pattern: &Pattern<Expr>) -> CompiledPattern {
        let mut binders = vec![];
        let nodes = pattern
            .nodes
            .iter()
            .map(|node| self.pattern_node(node, &mut binders))
            .collect();
        let condition = |c: &Condition<Expr>| Condition {
            expr: PatternCode::Condition(self.boolean(&c.expr)),
            needs: c.needs.clone(),
            choice: c.choice,
        };
        let related = |node: &Expr| PatternCode::Node(self.node(node));
        let pattern = Pattern {
            nodes,
            edges: pattern.edges.clone(),
            conditions: pattern.conditions.iter().map(condition).collect(),
            choices: pattern.choices.clone(),
            walks: pattern.walks.clone(),
            relations: pattern.relations.iter().map(related).collect(),
            first: pattern.first,
            last: pattern.last,
            span: pattern.span,
        };
        CompiledPattern {
            role,
            plan: Plan::new(&pattern),
            pattern,
            binders,
        }
    }

    fn pattern_node(
        &self,
        node: &PatternNode<Expr>,
        binders: &mut Vec<Binder>,
    ) -> PatternNode<PatternCode> {
        let ty = match &node.what {
            Candidate::Type(ty) => *ty,
            _ => TypeId(0),
        };
        let args = node.args.iter().map(|arg| match arg {
            PatternArg::Bind(field, slot) => {
                binders.push(self.binder(ty, *field, Slot(*slot)));
                PatternArg::Bind(*field, (binders.len() - 1) as u16)
            }
            PatternArg::Equal(field, value) => PatternArg::Equal(
                *field,
                PatternCode::Equal(with_kind!(&value.ty, self.field_test(value))),
            ),
        });
        let args = args.collect();
        let what = match &node.what {
            Candidate::Any => Candidate::Any,
            Candidate::Type(ty) => Candidate::Type(*ty),
            Candidate::Root => Candidate::Root,
            Candidate::Value(value) => Candidate::Value(PatternCode::Node(self.node(value))),
            Candidate::Same(i) => Candidate::Same(*i),
        };
        let slot = node.slot.map(|slot| match self.local(Slot(slot)) {
            Local::Word(at) | Local::Value(at) => at as u16,
        });
        PatternNode {
            what,
            slot,
            args,
            is_context: node.is_context,
            choice: node.choice,
            span: node.span,
        }
    }

    /// The binder of a field; what the local variable is decides how the field is read.
    fn binder(&self, ty: TypeId, field: FieldId, slot: Slot) -> Binder {
        use crate::graph::FieldKind;
        let kind = self.model.types[ty]
            .fields
            .get(usize::from(field.0))
            .map(|f| f.kind);
        match (self.local(slot), kind) {
            (Local::Word(at), Some(FieldKind::Boolean)) => bind::<bool>(at),
            (Local::Word(at), Some(FieldKind::Long)) => bind::<i64>(at),
            (Local::Word(at), Some(FieldKind::Float)) => bind::<f32>(at),
            (Local::Word(at), Some(FieldKind::Double)) => bind::<f64>(at),
            (Local::Word(at), Some(FieldKind::Object)) => bind::<Option<NodeId>>(at),
            (Local::Word(at), _) => bind::<i32>(at),
            (Local::Value(at), _) => bind::<Value>(at),
        }
    }

    fn field_test<T: Access>(&self, value: &Expr) -> FieldTest {
        let value = self.source::<T>(value);
        Box::new(move |p, m, node, field| {
            let wanted = value.get(p, m)?;
            let found = T::field(&m.graph, node, field)?;
            Ok(T::is_equal(&found, &wanted))
        })
    }

    /// A rule: all its matches are found and applied to the queue.
    pub(super) fn rule(&self, rule: &Rule) -> Exec {
        let compiled = self.pattern("rule", &rule.pattern);
        let (arrow, span) = (rule.arrow, rule.span);
        let plain = self.plain_rule(rule);
        let body = match &rule.exec {
            Some(statement) => self.statement(statement),
            None => self.productions(&rule.rhs),
        };
        Box::new(move |program, machine| {
            let mode = machine.mode();
            let plain = plain
                .as_ref()
                .filter(|plain| mode == rewrite::Mode::default() && plain.is_usable(machine));
            let mut left_by = Flow::Next;
            let mut env = Env {
                program,
                machine,
                compiled: &compiled,
                tried: None,
            };
            let mut is_applied = false;
            rewrite::search(
                &compiled.pattern,
                &compiled.plan,
                mode.excludes_consumed,
                &mut env,
                &mut |env, found| {
                    env.machine.tick(span)?;
                    is_applied = true;
                    let nodes = found.nodes();
                    if let Some(plain) = plain
                        && plain
                            .note(program, env.machine, nodes)
                            .map_err(|trap| env.note_match(trap, nodes, span))?
                    {
                        return Ok(rewrite::Flow::Continue);
                    }
                    // What `::>` runs queues nothing itself.
                    if arrow != Arrow::Execution || mode.derivation != rewrite::Derivation::Parallel
                    {
                        env.machine.settle(span)?;
                    }
                    if !env.admit(mode) {
                        return Ok(mode.after_match());
                    }
                    let flow = env
                        .apply(arrow, nodes, &body)
                        .map_err(|trap| env.note_match(trap, nodes, span))?;
                    Ok(match flow {
                        Flow::Next | Flow::Continue(Label::Innermost) => mode.after_match(),
                        // On a right-hand side it ends that of this match; in `::>` it leaves the loop over the matches.
                        Flow::Break(Label::Innermost) if arrow != Arrow::Execution => {
                            mode.after_match()
                        }
                        Flow::Break(Label::Innermost) => rewrite::Flow::Stop,
                        flow => {
                            left_by = flow;
                            rewrite::Flow::Stop
                        }
                    })
                },
            )?;
            if is_applied {
                machine.note_rule(span);
            }
            Ok(left_by)
        })
    }

    /// `field := value` and its kin: queued for the end of the step.
    pub(super) fn deferred_assignment(
        &self,
        node: &Expr,
        field: FieldId,
        op: Option<Operator>,
        value: &Expr,
        span: Span,
    ) -> Code {
        let (target, value) = (self.node(node), self.expr(value));
        Code::void(move |p: &Program, m: &mut Machine| {
            let Some(node) = target.get(p, m)? else {
                return Err(Trap::null("assign to a field of a node", span));
            };
            let value = deferred_value(&value, p, m)?;
            m.queue.defer(Assignment {
                node,
                field,
                op,
                value,
            });
            Ok(())
        })
    }
}

fn deferred_value(
    value: &Code,
    p: &Program,
    m: &mut Machine,
) -> Result<DeferredValue<Value>, Trap> {
    Ok(match value {
        Code::Void(code) => {
            code(p, m)?;
            DeferredValue::Object(Value::Null)
        }
        Code::Boolean(s) => DeferredValue::Int(i32::from(s.get(p, m)?)),
        Code::Int(s) => DeferredValue::Int(s.get(p, m)?),
        Code::Long(s) => DeferredValue::Long(s.get(p, m)?),
        Code::Float(s) => DeferredValue::Float(s.get(p, m)?),
        Code::Double(s) => DeferredValue::Double(s.get(p, m)?),
        Code::Node(s) => DeferredValue::Object(s.get(p, m)?.boxed()),
        Code::Value(s) => DeferredValue::Object(s.get(p, m)?),
    })
}

fn bind<T: Access>(at: u32) -> Binder {
    Box::new(move |m, node, field| {
        let value = T::field(&m.graph, node, field)?;
        value.store(&mut m.stack, at);
        Ok(())
    })
}

/// What a search needs of the machine.
pub(super) struct Env<'a> {
    pub(super) program: &'a Program,
    pub(super) machine: &'a mut Machine,
    pub(super) compiled: &'a CompiledPattern,
    /// The node that was looked at last.
    pub(super) tried: Option<NodeId>,
}

impl Env<'_> {
    /// What was being done when the rule at `span` failed for a match.
    #[cold]
    fn note_match(&self, trap: Trap, nodes: &[NodeId], span: Span) -> Trap {
        let of_pattern = self.compiled.pattern.nodes.iter().zip(nodes);
        let mut replaced = of_pattern.filter(|(node, _)| !node.is_context);
        let node = replaced.next().map(|(_, node)| node).or(nodes.first());
        let to = node.map_or(String::new(), |&node| {
            format!(" to {}", self.machine.graph.node_text(node))
        });
        trap.at(span).noting(span, "in this rule").during(
            format!("while applying the rule at {{place}}{to}"),
            Some(span),
        )
    }

    /// What was being done when a condition or a parameter of the pattern failed.
    #[cold]
    fn note_search(&self, trap: Trap) -> Trap {
        let (role, span) = (self.compiled.role, self.compiled.pattern.span);
        let at = self.tried.map_or(String::new(), |node| {
            format!(", trying {}", self.machine.graph.node_text(node))
        });
        trap.during(
            format!("while matching the {role} at {{place}}{at}"),
            Some(span),
        )
    }

    /// What was being done when something failed for a match of a query.
    #[cold]
    pub(super) fn note_found(&self, trap: Trap, node: Option<NodeId>) -> Trap {
        let node = node.map_or("nothing".to_owned(), |node| {
            self.machine.graph.node_text(node)
        });
        trap.during(
            format!("for {node}, found by the query at {{place}}"),
            Some(self.compiled.pattern.span),
        )
    }

    fn admit(&mut self, mode: rewrite::Mode) -> bool {
        let Machine {
            queue,
            graph,
            random,
            ..
        } = &mut *self.machine;
        queue.admit(graph, mode, |n| random.next_int_below(n).unwrap_or(0))
    }

    /// Runs the right-hand side of a match.
    fn apply(&mut self, arrow: Arrow, nodes: &[NodeId], body: &Exec) -> Result<Flow, Trap> {
        let (p, m) = (self.program, &mut *self.machine);
        if arrow == Arrow::Execution {
            return body(p, m);
        }
        m.queue.begin(
            &m.graph,
            &self.compiled.pattern,
            &self.compiled.plan,
            arrow,
            nodes,
        );
        match body(p, m) {
            Ok(flow) => {
                m.queue.end(&mut m.graph);
                Ok(flow)
            }
            Err(trap) => {
                m.queue.abort();
                Err(trap)
            }
        }
    }
}

impl MatchEnv<PatternCode> for Env<'_> {
    type Object = Value;
    type Error = Trap;

    fn graph(&self) -> &Graph<Value> {
        &self.machine.graph
    }

    fn spend(&mut self, n_visits: u32) -> Result<(), Trap> {
        self.machine
            .spend_visits(n_visits, self.compiled.pattern.span)
    }

    fn scratch(&mut self) -> &mut ScratchPool {
        &mut self.machine.scratch
    }

    fn bind_node(&mut self, slot: u16, node: Option<NodeId>) {
        self.tried = node.or(self.tried);
        node.store(&mut self.machine.stack, u32::from(slot));
    }

    fn bind_field(&mut self, slot: u16, node: NodeId, field: FieldId) -> Result<(), Trap> {
        self.tried = Some(node);
        (self.compiled.binders[usize::from(slot)])(self.machine, node, field)
    }

    fn field_equals(
        &mut self,
        node: NodeId,
        field: FieldId,
        value: &PatternCode,
    ) -> Result<bool, Trap> {
        match value {
            PatternCode::Equal(test) => {
                self.tried = Some(node);
                test(self.program, self.machine, node, field).map_err(|trap| self.note_search(trap))
            }
            PatternCode::Condition(_) | PatternCode::Node(_) => Ok(false),
        }
    }

    fn condition(&mut self, condition: &PatternCode) -> Result<bool, Trap> {
        match condition {
            PatternCode::Condition(source) => {
                self.machine.tick(self.compiled.pattern.span)?;
                source
                    .get(self.program, self.machine)
                    .map_err(|trap| self.note_search(trap))
            }
            PatternCode::Equal(_) | PatternCode::Node(_) => Ok(false),
        }
    }

    fn node_value(&mut self, value: &PatternCode) -> Result<Option<NodeId>, Trap> {
        match value {
            PatternCode::Node(source) => source
                .get(self.program, self.machine)
                .map_err(|trap| self.note_search(trap)),
            PatternCode::Equal(_) | PatternCode::Condition(_) => Ok(None),
        }
    }
}
