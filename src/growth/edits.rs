//! What an edit of a model changes: which step is the first that can be another.
//!
//! The checked models are compared part by part, places in the text aside. Whatever has no part of its own here (types,
//! constructors, variables, names of methods) changes the whole growth. A method counts from the step that first called it, the
//! right-hand side of a rule from the step in which the rule first found a match, its left-hand side from the step by whose
//! end there was a node that it could look at. A constant counts wherever it is read.
//!
//! Why that is right: up to the first step in which a changed part could run, both models run the same parts on the same
//! state, hence are in the same state; so what the old model did tells what the new one would.

use std::collections::BTreeSet;
use std::fmt::Debug;
use std::hash::{DefaultHasher, Hasher};

use crate::check::model::{Expr, ExprKind, Model, Place, Rule, Static, Stmt, StmtKind, Type};
use crate::eval::Trace;
use crate::graph::TypeId;
use crate::graph::pattern::Candidate;
use crate::library::ClassId;

/// A checked model in parts that can be compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outline {
    /// What every step depends on.
    frame: u64,
    /// What nodes draw.
    drawing: u64,
    /// By number of the variable, of those that are simple constants.
    constants: Vec<Option<u64>>,
    methods: Vec<MethodPart>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct MethodPart {
    /// All but its rules.
    body: u64,
    rules: Vec<RulePart>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct RulePart {
    left: u64,
    right: u64,
    /// The types of all nodes that it looks for, with those that extend them; `None` if it can do something without any.
    types: Option<Vec<TypeId>>,
}

/// What a step of a model has used.
#[derive(Clone, Debug, Default)]
pub struct StepTrace {
    methods: Vec<bool>,
    /// Numbers of methods and of rules in them.
    rules: BTreeSet<(usize, usize)>,
    has_drawn: bool,
    /// By type, whether there was a node of it until the end of the step.
    types: Vec<bool>,
    /// What it has printed.
    pub printed: String,
}

impl Outline {
    /// The parts of a model.
    pub fn of(model: &Model) -> Self {
        let constants = constants(model);
        let print = |part: &dyn Debug| digest(&format!("{part:?}"), &constants);
        let instantiations = model.modules.iter().map(|m| {
            let body = m.instantiation.as_ref();
            body.map(|i| (print(&i.body), i.is_pure))
        });
        Self {
            frame: frame(model, &constants),
            drawing: print(&instantiations.collect::<Vec<_>>()),
            methods: model
                .methods
                .iter()
                .map(|m| method_part(model, m.body.as_deref(), &constants))
                .collect(),
            constants,
        }
    }

    /// Of the steps that `self` has made (`init` counts as one), how many the model `other` makes alike.
    pub fn unchanged(&self, other: &Self, steps: &[StepTrace]) -> usize {
        if self.frame != other.frame || !self.has_same_constants(other) {
            return 0;
        }
        let mut first = steps.len();
        let mut used_by = |uses: &dyn Fn(&StepTrace) -> bool| {
            first = first.min(steps.iter().position(uses).unwrap_or(steps.len()));
        };
        if self.drawing != other.drawing {
            used_by(&|step| step.has_drawn);
        }
        for (number, (old, new)) in self.methods.iter().zip(&other.methods).enumerate() {
            let calls = |step: &StepTrace| step.methods.get(number).copied().unwrap_or(false);
            if old.body != new.body || old.rules.len() != new.rules.len() {
                used_by(&calls);
                continue;
            }
            for (place, (old, new)) in old.rules.iter().zip(&new.rules).enumerate() {
                if old.left != new.left {
                    used_by(&|step| calls(step) && (old.could_run(step) || new.could_run(step)));
                } else if old.right != new.right {
                    used_by(&|step| step.rules.contains(&(number, place)));
                }
            }
        }
        first
    }

    /// Whether the same variables are simple constants.
    fn has_same_constants(&self, other: &Self) -> bool {
        let simple = |outline: &Self| -> Vec<bool> {
            outline.constants.iter().map(Option::is_some).collect()
        };
        simple(self) == simple(other)
    }

    /// The values of the constants that can be set again at any time, by number of the variable; `None` for other variables.
    pub fn constants(&self) -> &[Option<u64>] {
        &self.constants
    }

    /// What a step has used, from the machine's notes, the types there were until its end, and what it printed.
    pub fn step(model: &Model, trace: &Trace, types: Vec<bool>, printed: String) -> StepTrace {
        let n_methods = model.methods.len();
        let mut rules = BTreeSet::new();
        for (number, method) in model.methods.iter().enumerate() {
            let mut own = vec![];
            rules_of(method.body.as_deref().unwrap_or_default(), &mut own);
            let found = own.iter().enumerate();
            let found = found.filter(|(_, rule)| trace.rules.contains(&rule.span));
            rules.extend(found.map(|(place, _)| (number, place)));
        }
        StepTrace {
            methods: (0..n_methods)
                .map(|number| trace.has_called(number))
                .collect(),
            rules,
            has_drawn: trace.has_drawn,
            types,
            printed,
        }
    }
}

impl RulePart {
    /// Whether anything of the rule could be evaluated in a step with these nodes.
    fn could_run(&self, step: &StepTrace) -> bool {
        let is_there = |ty: &TypeId| step.types.get(usize::from(ty.0)).copied().unwrap_or(true);
        self.types
            .as_ref()
            .is_none_or(|types| types.iter().any(is_there))
    }
}

/// A number for what every step of a model depends on.
fn frame(model: &Model, constants: &[Option<u64>]) -> u64 {
    let print = |part: &dyn Debug| digest(&format!("{part:?}"), constants);
    let statics = model.statics.iter().zip(constants);
    let statics: Vec<_> = statics
        .map(|(s, simple)| {
            let init = s.init.as_ref().filter(|_| simple.is_none());
            print(&(&s.name, &s.ty, s.is_constant, init))
        })
        .collect();
    // Built-in types are the same in all models.
    let own = model.types.iter().filter(|(id, ty)| ty.builtin != *id);
    let types: Vec<_> = own.map(|(_, ty)| print(ty)).collect();
    let modules = model.modules.iter().map(|module| {
        let constructor = print(&(&module.constructor.params, &module.constructor.body));
        print(&(constructor, module.type_id, module.class, &module.overrides))
    });
    let signatures = model.methods.iter().map(|method| {
        let has_body = method.body.is_some();
        print(&(
            &method.name,
            method.this,
            &method.params,
            &method.result,
            has_body,
        ))
    });
    let starts = (model.startup, model.init, &model.entries);
    let (modules, signatures): (Vec<_>, Vec<_>) = (modules.collect(), signatures.collect());
    let interfaces = &model.interfaces;
    print(&(types, statics, interfaces, modules, signatures, starts))
}

fn method_part(model: &Model, body: Option<&[Stmt]>, constants: &[Option<u64>]) -> MethodPart {
    let body = body.unwrap_or_default();
    let mut text = String::new();
    skeleton(body, &mut text);
    let mut rules = vec![];
    rules_of(body, &mut rules);
    let print = |part: &dyn Debug| digest(&format!("{part:?}"), constants);
    let part = |rule: &&Rule| RulePart {
        left: print(&(&rule.pattern, rule.arrow)),
        right: print(&(&rule.rhs, &rule.exec)),
        types: types_of(model, rule),
    };
    MethodPart {
        body: digest(&text, constants),
        rules: rules.iter().map(part).collect(),
    }
}

/// The statements of a method as a text, rules that stand in no loop and under no condition left out.
fn skeleton(statements: &[Stmt], text: &mut String) {
    use std::fmt::Write;
    for statement in statements {
        match &statement.kind {
            StmtKind::Rule(_) => text.push_str("a rule;"),
            StmtKind::Block(inner) => {
                text.push('{');
                skeleton(inner, text);
                text.push('}');
            }
            kind => {
                // Writing into a text does not fail.
                let _ = write!(text, "{kind:?};");
            }
        }
    }
}

/// The rules that [`skeleton`] leaves out, in order.
fn rules_of<'m>(statements: &'m [Stmt], rules: &mut Vec<&'m Rule>) {
    for statement in statements {
        match &statement.kind {
            StmtKind::Rule(rule) => rules.push(rule),
            StmtKind::Block(inner) => rules_of(inner, rules),
            _ => {}
        }
    }
}

/// See [`RulePart::types`].
fn types_of(model: &Model, rule: &Rule) -> Option<Vec<TypeId>> {
    let pattern = &rule.pattern;
    let is_plain = pattern.choices.is_empty()
        && pattern.walks.is_empty()
        && pattern.relations.is_empty()
        && !pattern.nodes.is_empty()
        && pattern
            .conditions
            .iter()
            .all(|condition| !condition.needs.is_empty());
    let mut types = vec![];
    for node in pattern.nodes.iter().filter(|_| is_plain) {
        match &node.what {
            Candidate::Type(ty) => types.extend_from_slice(model.types[*ty].descendants()),
            Candidate::Same(_) => {}
            Candidate::Any | Candidate::Root | Candidate::Value(_) => return None,
        }
    }
    is_plain.then_some(types)
}

/// Of each constant whose value is plain arithmetic, what it is.
fn constants(model: &Model) -> Vec<Option<u64>> {
    let mut known: Vec<Option<u64>> = vec![];
    for constant in &model.statics {
        let value = constant
            .init
            .as_ref()
            .filter(|init| is_simple(constant, init, &known));
        let print = value.map(|init| digest(&format!("{init:?}"), &known));
        known.push(print);
    }
    known
}

/// Whether a variable never changes and its value is made of numbers, colours and earlier such constants alone, so that it can
/// be made at any time.
fn is_simple(constant: &Static, init: &Expr, known: &[Option<u64>]) -> bool {
    constant.is_constant && is_plain(init, known)
}

/// Whether an expression gives the same whenever it is evaluated and does nothing else; `known` constants may stand in it.
fn is_plain(expr: &Expr, known: &[Option<u64>]) -> bool {
    let all = |parts: &[Expr]| parts.iter().all(|part| is_plain(part, known));
    match &expr.kind {
        ExprKind::Constant(_) => true,
        ExprKind::Read(Place::Static(id)) => known.get(id.0 as usize).is_some_and(Option::is_some),
        ExprKind::Convert(of) | ExprKind::Negate(of) => is_plain(of, known),
        ExprKind::Binary { left, right, .. } => is_plain(left, known) && is_plain(right, known),
        ExprKind::NewObject(_, args) => is_look(&expr.ty) && all(args),
        // `new Phong().(setDiffuse(…), …)`
        ExprKind::With { object, slot, body } => {
            let sets = |statement: &Stmt| match &statement.kind {
                StmtKind::Expr(call) => match &call.kind {
                    ExprKind::LibraryMethod(_, on, args) => {
                        matches!(on.kind, ExprKind::Read(Place::Local(of)) if of == *slot)
                            && all(args)
                    }
                    _ => false,
                },
                _ => false,
            };
            is_look(&expr.ty) && is_plain(object, known) && body.iter().all(sets)
        }
        _ => false,
    }
}

/// Whether it is a colour or a shader, whose making depends on its arguments alone.
fn is_look(ty: &Type) -> bool {
    const LOOKS: [ClassId; 4] = [
        ClassId::RGBColor,
        ClassId::RGBAShader,
        ClassId::Phong,
        ClassId::SideSwitchShader,
    ];
    matches!(ty, Type::Class(class) if LOOKS.contains(class))
}

/// A number that equal texts share: those of [`Debug`] without the places in the source, and with the values of the constants
/// that they name.
fn digest(text: &str, constants: &[Option<u64>]) -> u64 {
    const PLACE: &str = "Span {";
    const CONSTANT: &str = "StaticId(";
    let mut hash = DefaultHasher::new();
    let (mut rest, mut is_quoted) = (text, false);
    while let Some(at) = rest.find(['"', '\\', 'S']) {
        let (before, from) = rest.split_at(at);
        hash.write(before.as_bytes());
        let length = if is_quoted && from.starts_with('\\') {
            // What is escaped neither ends the text nor begins anything.
            1 + from[1..].chars().next().map_or(0, char::len_utf8)
        } else if from.starts_with('"') {
            is_quoted = !is_quoted;
            1
        } else if !is_quoted && from.starts_with(PLACE) {
            rest = from.find('}').map_or("", |end| &from[end + 1..]);
            continue;
        } else {
            if !is_quoted && let Some(named) = from.strip_prefix(CONSTANT) {
                let number = named
                    .split(')')
                    .next()
                    .and_then(|number| number.parse().ok());
                let value =
                    number.and_then(|number: usize| constants.get(number).copied().flatten());
                hash.write_u64(value.unwrap_or(0));
            }
            1
        };
        hash.write(&from.as_bytes()[..length]);
        rest = &from[length..];
    }
    hash.write(rest.as_bytes());
    hash.finish()
}
