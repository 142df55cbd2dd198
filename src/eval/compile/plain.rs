//! Rules whose right-hand side is a template: new nodes, brackets and edges, with arguments that are numbers.
//!
//! Nothing on such a right-hand side can see or change the graph or the queue (drawing random numbers is all it may do
//! besides arithmetic), so its nodes need not be made match by match; see [`crate::graph::Template`].

use std::sync::Arc;

use super::Scope;
use crate::check::model::{
    Arrow, Expr, ExprKind, Module, NewNode, Place, Production, Rule, Slot, Stmt, StmtKind, Type,
};
use crate::diag::Span;
use crate::eval::code::{Code, Source};
use crate::eval::library::{Behaviour, function};
use crate::eval::machine::Machine;
use crate::eval::program::Program;
use crate::eval::trap::Trap;
use crate::graph::pattern::{Candidate, EdgeKind, EdgeWay};
use crate::graph::{EdgeBits, FieldId, FieldKind, NodeId, Template, TypeId};
use crate::library::FunctionId;

/// Most words that a match may give.
const MOST_GIVEN: usize = 64;

/// A right-hand side as a template, and the code of what differs between matches.
pub(super) struct Plain {
    template: Arc<Template>,
    values: Vec<Given>,
    /// The constructor calls that count as turns.
    calls: Vec<Span>,
    /// How deep constructors call each other.
    depth: u32,
    /// The pattern node that is replaced.
    replaced: usize,
}

/// A number that each match gives, and where it goes.
struct Given {
    value: Code,
    targets: Vec<(usize, FieldKind)>,
}

/// What a constructor puts into a field.
#[derive(Clone)]
enum Origin {
    /// The same number in all matches.
    Fixed(Number),
    /// One of the values, converted to a type first.
    Value(usize, Option<Type>),
}

/// A number of the language.
#[derive(Clone, Copy)]
enum Number {
    Int(i32),
    Long(i64),
    Double(f64),
}

impl Number {
    fn encode(self, kind: FieldKind) -> [u32; 2] {
        match self {
            Self::Int(x) => kind.encode_i32(x),
            Self::Long(x) => kind.encode_i64(x),
            Self::Double(x) => kind.encode(x),
        }
    }

    /// The number, if the code is a constant one.
    fn constant(code: &Code) -> Option<Self> {
        Some(match code {
            Code::Boolean(Source::Constant(x)) => Self::Int(i32::from(*x)),
            Code::Int(Source::Constant(x)) => Self::Int(*x),
            Code::Long(Source::Constant(x)) => Self::Long(*x),
            Code::Float(Source::Constant(x)) => Self::Double(f64::from(*x)),
            Code::Double(Source::Constant(x)) => Self::Double(*x),
            _ => return None,
        })
    }

    #[inline]
    fn of(code: &Code, p: &Program, m: &mut Machine) -> Result<Self, Trap> {
        Ok(match code {
            Code::Boolean(s) => Self::Int(i32::from(s.get(p, m)?)),
            Code::Int(s) => Self::Int(s.get(p, m)?),
            Code::Long(s) => Self::Long(s.get(p, m)?),
            Code::Float(s) => Self::Double(f64::from(s.get(p, m)?)),
            Code::Double(s) => Self::Double(s.get(p, m)?),
            Code::Void(_) | Code::Node(_) | Code::Value(_) => Self::Int(0),
        })
    }
}

impl Plain {
    /// Whether this machine may now note matches in bulk.
    pub(super) fn is_usable(&self, m: &Machine) -> bool {
        m.uses_templates && m.stack.depth.saturating_add(self.depth) <= m.limits().depth
    }

    /// Notes a match; `false` if it must be queued as any other.
    pub(super) fn note(
        &self,
        p: &Program,
        m: &mut Machine,
        nodes: &[NodeId],
    ) -> Result<bool, Trap> {
        if !m.queue.has_room_for(&m.graph, &self.template) {
            return Ok(false);
        }
        for &span in &self.calls {
            m.tick(span)?;
        }
        let mut words = [0; MOST_GIVEN];
        for given in &self.values {
            let value = Number::of(&given.value, p, m)?;
            for &(at, kind) in &given.targets {
                let encoded = value.encode(kind);
                words[at..at + kind.words()].copy_from_slice(&encoded[..kind.words()]);
            }
        }
        let given = &words[..self.template.n_given()];
        m.queue
            .note_match(&mut m.graph, &self.template, nodes[self.replaced], given);
        Ok(true)
    }
}

impl Scope<'_> {
    /// The right-hand side of a rule as a template, if it is one.
    pub(super) fn plain_rule(&self, rule: &Rule) -> Option<Plain> {
        let pattern = &rule.pattern;
        let replaced = pattern.first.filter(|_| pattern.first == pattern.last)?;
        let Candidate::Type(ty) = pattern.nodes.get(replaced)?.what else {
            return None;
        };
        let types = &self.model.types;
        let may_be_root = types[ty]
            .descendants()
            .iter()
            .any(|&t| &*types[t].name == "RGGRoot");
        let is_one = pattern.nodes.iter().enumerate().all(|(i, node)| {
            let is_new = !matches!(node.what, Candidate::Same(_));
            is_new && node.is_context == (i != replaced)
        });
        if rule.arrow != Arrow::Lindenmayer || rule.exec.is_some() || may_be_root || !is_one {
            return None;
        }
        let slots = pattern.nodes.iter().filter_map(|node| node.slot);
        let mut builder = Builder {
            scope: self,
            labels: slots.map(Slot).collect(),
            template: None,
            values: vec![],
            calls: vec![],
            depth: 0,
            previous: None,
            standard: EdgeBits::SUCCESSOR,
            explicit: None,
            n_brackets: 0,
        };
        builder.pieces(&rule.rhs)?;
        let template = builder.template?;
        (template.n_given() <= MOST_GIVEN).then_some(Plain {
            template: Arc::new(template),
            values: builder.values,
            calls: builder.calls,
            depth: builder.depth,
            replaced,
        })
    }

    fn module_of(&self, ty: TypeId) -> Option<&Module> {
        let mut modules = self.model.modules.iter();
        modules.find(|module| module.type_id == ty)
    }
}

/// Makes a template of a right-hand side; every method gives up with `None`.
struct Builder<'a> {
    scope: &'a Scope<'a>,
    /// Slots of the nodes of the left-hand side.
    labels: Vec<Slot>,
    template: Option<Template>,
    values: Vec<Given>,
    calls: Vec<Span>,
    depth: u32,
    // As in the frame of a right-hand side, see `rewrite::producer`.
    previous: Option<u32>,
    standard: EdgeBits,
    explicit: Option<EdgeBits>,
    n_brackets: usize,
}

impl Builder<'_> {
    fn pieces(&mut self, pieces: &[Production]) -> Option<()> {
        pieces.iter().try_for_each(|piece| self.piece(piece))
    }

    fn piece(&mut self, piece: &Production) -> Option<()> {
        match piece {
            Production::Node { node, .. } => match &node.kind {
                ExprKind::NewNode(new) => self.node(new, node.span),
                _ => None,
            },
            Production::Group(pieces) => self.pieces(pieces),
            Production::Branch(pieces) => {
                let saved = (self.previous?, self.standard);
                self.standard = EdgeBits::BRANCH;
                self.n_brackets += 1;
                self.pieces(pieces)?;
                self.n_brackets -= 1;
                (self.previous, self.standard) = (Some(saved.0), saved.1);
                Some(())
            }
            Production::Edge(
                kind @ (EdgeKind::Successor | EdgeKind::Branch | EdgeKind::Refinement),
                EdgeWay::Forward,
            ) => {
                self.explicit = Some(EdgeBits::of(*kind));
                Some(())
            }
            _ => None,
        }
    }

    fn node(&mut self, new: &NewNode, span: Span) -> Option<()> {
        let types = &self.scope.model.types;
        let bits = self.explicit.take().unwrap_or(self.standard);
        let part = match (&mut self.template, self.previous) {
            (Some(template), Some(previous)) => template.add(types, new.type_id, previous, bits)?,
            (none @ None, None) => {
                *none = Some(Template::new(types, new.type_id));
                0
            }
            _ => return None,
        };
        if self.n_brackets == 0 {
            self.template.as_mut()?.set_last(part);
        }
        (self.previous, self.standard) = (Some(part), EdgeBits::SUCCESSOR);
        self.fill(part, new, span)
    }

    /// Fills a new node with what its constructor is called with.
    fn fill(&mut self, part: u32, new: &NewNode, span: Span) -> Option<()> {
        // A constructor that the model wrote is code of its own.
        if new.constructor.is_some() || !new.args.iter().all(|arg| self.is_plain(arg)) {
            return None;
        }
        let Some(module) = self.scope.module_of(new.type_id) else {
            for (&field, arg) in new.fields.iter().zip(&new.args) {
                let origin = self.origin(self.scope.expr(arg));
                self.put(part, field, &origin)?;
            }
            return Some(());
        };
        let params = &module.constructor.params;
        if !params.iter().all(super::convert::is_primitive) {
            return None;
        }
        let mut origins = vec![];
        for (arg, ty) in new.args.iter().zip(params) {
            origins.push(self.origin(self.scope.as_type(arg, ty)));
        }
        origins.resize(params.len(), Origin::Fixed(Number::Int(0)));
        self.construct(part, module, &origins, span, 1)
    }

    fn origin(&mut self, code: Code) -> Origin {
        if let Some(number) = Number::constant(&code) {
            return Origin::Fixed(number);
        }
        self.values.push(Given {
            value: code,
            targets: vec![],
        });
        Origin::Value(self.values.len() - 1, None)
    }

    /// Does what the constructor of a module does, if that only stores its parameters and constants.
    fn construct(
        &mut self,
        part: u32,
        module: &Module,
        params: &[Origin],
        span: Span,
        depth: u32,
    ) -> Option<()> {
        self.calls.push(span);
        self.depth = self.depth.max(depth);
        module
            .constructor
            .body
            .iter()
            .try_for_each(|stmt| self.construct_by(part, stmt, params, depth))
    }

    fn construct_by(
        &mut self,
        part: u32,
        stmt: &Stmt,
        params: &[Origin],
        depth: u32,
    ) -> Option<()> {
        match &stmt.kind {
            StmtKind::Block(body) => body
                .iter()
                .try_for_each(|stmt| self.construct_by(part, stmt, params, depth)),
            StmtKind::SuperConstructor(new) if new.constructor.is_none() => {
                let args: Option<Vec<Origin>> = new
                    .args
                    .iter()
                    .map(|arg| self.stored(arg, params))
                    .collect();
                let mut args = args?;
                match self.scope.module_of(new.type_id) {
                    Some(parent) => {
                        let types = &parent.constructor.params;
                        if !types.iter().all(super::convert::is_primitive) {
                            return None;
                        }
                        args.resize(types.len(), Origin::Fixed(Number::Int(0)));
                        self.construct(part, parent, &args, stmt.span, depth + 1)
                    }
                    None => {
                        let mut fields = new.fields.iter().zip(&args);
                        fields.try_for_each(|(&field, arg)| self.put(part, field, arg))
                    }
                }
            }
            StmtKind::Expr(Expr {
                kind: ExprKind::Assign(Place::Field(node, field), value),
                ..
            }) if is_local(node, Slot(0)) => {
                let origin = self.stored(value, params)?;
                self.put(part, *field, &origin)
            }
            _ => None,
        }
    }

    /// What an expression of a constructor is: a parameter or a constant, perhaps converted.
    fn stored(&self, e: &Expr, params: &[Origin]) -> Option<Origin> {
        match &e.kind {
            ExprKind::Constant(_) => self.constant(e),
            ExprKind::Read(Place::Local(slot)) => {
                params.get(usize::from(slot.0).checked_sub(1)?).cloned()
            }
            ExprKind::Convert(inner) => match &inner.kind {
                ExprKind::Constant(_) => self.constant(e),
                _ => match self.stored(inner, params)? {
                    Origin::Value(value, None) => Some(Origin::Value(value, Some(e.ty.clone()))),
                    _ => None,
                },
            },
            ExprKind::Negate(inner) if matches!(inner.kind, ExprKind::Constant(_)) => {
                self.constant(e)
            }
            _ => None,
        }
    }

    fn constant(&self, e: &Expr) -> Option<Origin> {
        Number::constant(&self.scope.expr(e)).map(Origin::Fixed)
    }

    fn put(&mut self, part: u32, field: FieldId, origin: &Origin) -> Option<()> {
        let types = &self.scope.model.types;
        let template = self.template.as_mut()?;
        let declared = &types[template.type_of(part)].fields;
        let kind = declared.get(usize::from(field.0))?.kind;
        if kind == FieldKind::Object {
            return None;
        }
        match origin {
            Origin::Fixed(number) => template.fix(types, part, field, number.encode(kind)),
            Origin::Value(_, Some(ty)) if natural_kind(ty) != Some(kind) => None,
            Origin::Value(value, _) => {
                let at = template.give(types, part, field)?;
                self.values[*value].targets.push((at, kind));
                Some(())
            }
        }
    }

    /// Whether an expression is a number and does nothing but arithmetic, reading and drawing.
    fn is_plain(&self, e: &Expr) -> bool {
        let plain = |e: &Expr| self.is_plain(e);
        if !super::convert::is_primitive(&e.ty) {
            return false;
        }
        match &e.kind {
            ExprKind::Constant(_) | ExprKind::Read(Place::Local(_) | Place::Static(_)) => true,
            ExprKind::Read(Place::Field(node, _)) => {
                self.labels.iter().any(|&label| is_local(node, label))
            }
            ExprKind::Convert(e)
            | ExprKind::Negate(e)
            | ExprKind::Complement(e)
            | ExprKind::Not(e) => plain(e),
            ExprKind::Binary { left, right, .. } => plain(left) && plain(right),
            ExprKind::AndThen(a, b) | ExprKind::OrElse(a, b) => plain(a) && plain(b),
            ExprKind::Conditional(a, b, c) => plain(a) && plain(b) && plain(c),
            ExprKind::Library(id, args) => {
                let only_draws = matches!(
                    id,
                    FunctionId::Random
                        | FunctionId::Irandom
                        | FunctionId::NormalFloat
                        | FunctionId::NormalDouble
                        | FunctionId::Lognormal
                        | FunctionId::Probability
                        | FunctionId::MathRandom
                );
                let only_computes = !matches!(function(*id), Behaviour::Native(_));
                (only_draws || only_computes) && args.iter().all(plain)
            }
            _ => false,
        }
    }
}

fn is_local(e: &Expr, slot: Slot) -> bool {
    matches!(&e.kind, ExprKind::Read(Place::Local(s)) if *s == slot)
}

/// The kind of field that holds exactly the values of a type.
fn natural_kind(ty: &Type) -> Option<FieldKind> {
    Some(match ty {
        Type::Boolean => FieldKind::Boolean,
        Type::Byte => FieldKind::Byte,
        Type::Short => FieldKind::Short,
        Type::Char => FieldKind::Char,
        Type::Int => FieldKind::Int,
        Type::Long => FieldKind::Long,
        Type::Float => FieldKind::Float,
        Type::Double => FieldKind::Double,
        _ => return None,
    })
}
