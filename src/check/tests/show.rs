//! Checked expressions as short text: conversions are visible as `(type)`, slots as `#n`, variables of the model as `@n`.

use crate::check::model::{Constant, Expr, ExprKind, Model, Place, Sequence, Stmt, StmtKind, Type};
use crate::graph::pattern::{Candidate, Pattern, PatternArg};

/// Shows parts of one model.
pub(super) struct Show<'m>(pub(super) &'m Model);

impl Show<'_> {
    pub(super) fn ty(&self, ty: &Type) -> String {
        match ty {
            Type::Node(id) => self.0.types[*id].name.to_string(),
            Type::Class(class) => class.name().into(),
            Type::Array(element) => format!("{}[]", self.ty(element)),
            other => format!("{other:?}").to_lowercase(),
        }
    }

    fn place(&self, place: &Place) -> String {
        match place {
            Place::Local(slot) => format!("#{}", slot.0),
            Place::Static(id) => format!("@{}", id.0),
            Place::Field(object, field) => {
                let Type::Node(id) = object.ty else {
                    panic!("field of no node")
                };
                format!(
                    "{}.{}",
                    self.expr(object),
                    self.0.types[id].fields[usize::from(field.0)].name
                )
            }
            Place::Element(array, index) => format!("{}[{}]", self.expr(array), self.expr(index)),
            Place::Member(object, getter, _) => {
                format!("{}.{}", self.expr(object), getter.signature().name)
            }
        }
    }

    fn all(&self, all: &[Expr]) -> String {
        all.iter()
            .map(|e| self.expr(e))
            .collect::<Vec<_>>()
            .join(", ")
    }

    pub(super) fn expr(&self, e: &Expr) -> String {
        match &e.kind {
            ExprKind::Constant(Constant::String(v)) => format!("{v:?}"),
            ExprKind::Constant(Constant::Int(v)) if e.ty != Type::Int => {
                format!("{v}:{}", self.ty(&e.ty))
            }
            ExprKind::Constant(Constant::Int(v)) => v.to_string(),
            ExprKind::Constant(Constant::Long(v)) => format!("{v}L"),
            ExprKind::Constant(Constant::Float(v)) => format!("{v:?}f"),
            ExprKind::Constant(Constant::Double(v)) => format!("{v:?}"),
            ExprKind::Constant(Constant::Boolean(v)) => v.to_string(),
            ExprKind::Constant(Constant::Null) => "null".into(),
            ExprKind::Read(place) => self.place(place),
            ExprKind::Convert(x) => format!("({}){}", self.ty(&e.ty), self.expr(x)),
            ExprKind::Cast(x) => format!("cast({}){}", self.ty(&e.ty), self.expr(x)),
            ExprKind::InstanceOf(x, ty) => format!("{} is {}", self.expr(x), self.ty(ty)),
            ExprKind::Negate(x) => format!("-{}", self.expr(x)),
            ExprKind::Complement(x) => format!("~{}", self.expr(x)),
            ExprKind::Not(x) => format!("!{}", self.expr(x)),
            ExprKind::Binary {
                op,
                operands,
                left,
                right,
            } => {
                format!(
                    "({} {op:?}:{} {})",
                    self.expr(left),
                    self.ty(operands),
                    self.expr(right)
                )
            }
            ExprKind::AndThen(a, b) => format!("({} && {})", self.expr(a), self.expr(b)),
            ExprKind::OrElse(a, b) => format!("({} || {})", self.expr(a), self.expr(b)),
            ExprKind::Concat(parts) => format!("concat({})", self.all(parts)),
            ExprKind::Conditional(c, a, b) => {
                format!("({} ? {} : {})", self.expr(c), self.expr(a), self.expr(b))
            }
            ExprKind::Assign(place, v) => format!("{} = {}", self.place(place), self.expr(v)),
            ExprKind::Compound {
                place,
                op,
                operands,
                value,
            } => {
                format!(
                    "{} {op:?}:{}= {}",
                    self.place(place),
                    self.ty(operands),
                    self.expr(value)
                )
            }
            ExprKind::IncDec {
                place,
                by,
                is_prefix,
            } => format!("incdec({}, {by}, {is_prefix})", self.place(place)),
            ExprKind::Deferred {
                node,
                field,
                op,
                value,
            } => {
                let Type::Node(id) = node.ty else {
                    panic!("field of no node")
                };
                let name = &self.0.types[id].fields[usize::from(field.0)].name;
                format!("{}.{name} :{op:?}= {}", self.expr(node), self.expr(value))
            }
            ExprKind::Call {
                method,
                receiver,
                args,
                is_virtual,
            } => {
                let method = &self.0.methods[method.0 as usize];
                let receiver = receiver
                    .as_ref()
                    .map_or(String::new(), |r| format!("{}.", self.expr(r)));
                let how = if *is_virtual { "virtual " } else { "" };
                let params: Vec<String> = method.params.iter().map(|p| self.ty(p)).collect();
                format!(
                    "{how}{receiver}{}<{}>({})",
                    method.name,
                    params.join(","),
                    self.all(args)
                )
            }
            ExprKind::Library(id, args) => format!("{id:?}({})", self.all(args)),
            ExprKind::LibraryMethod(id, object, args) => {
                format!("{}.{id:?}({})", self.expr(object), self.all(args))
            }
            ExprKind::NewObject(id, args) => {
                format!("new {}:{id:?}({})", self.ty(&e.ty), self.all(args))
            }
            ExprKind::NewNode(node) => {
                let fields = &self.0.types[node.type_id].fields;
                let names: Vec<&str> = node
                    .fields
                    .iter()
                    .map(|f| &*fields[usize::from(f.0)].name)
                    .collect();
                format!(
                    "new {}<{}>({})",
                    self.0.types[node.type_id].name,
                    names.join(","),
                    self.all(&node.args)
                )
            }
            ExprKind::With { object, slot, body } => {
                format!(
                    "with #{} = {} {{ {} }}",
                    slot.0,
                    self.expr(object),
                    self.stmts(body)
                )
            }
            ExprKind::NewArray(lengths) => format!("new {}({})", self.ty(&e.ty), self.all(lengths)),
            ExprKind::ArrayLiteral(all) => format!("{}{{{}}}", self.ty(&e.ty), self.all(all)),
            ExprKind::ArrayLength(a) => format!("{}.length", self.expr(a)),
            ExprKind::Aggregate(which, seq) => {
                format!("{which:?}:{}({})", self.ty(&e.ty), self.sequence(seq))
            }
            ExprKind::SelectWhere {
                selection,
                sequence,
                key,
                ..
            } => {
                format!(
                    "select({selection:?}, {}, {})",
                    self.sequence(sequence),
                    self.expr(key)
                )
            }
            ExprKind::Root => "^".into(),
            ExprKind::Function(method, captured) => {
                format!("function({}, {})", method.0, self.all(captured))
            }
            ExprKind::Comma(all) => format!("comma({})", self.all(all)),
        }
    }

    pub(super) fn sequence(&self, s: &Sequence) -> String {
        match s {
            Sequence::Query { pattern, result } => {
                format!("query[{}]#{result}", self.pattern(pattern))
            }
            Sequence::Range(a, b) => format!("{}:{}", self.expr(a), self.expr(b)),
            Sequence::Elements(a) => format!("elements {}", self.expr(a)),
            Sequence::List(a) => format!("list {}", self.expr(a)),
            Sequence::Apply(n) => format!("apply {}", self.expr(n)),
            Sequence::Map { source, slot, body } => {
                format!(
                    "map #{} in {}: {}",
                    slot.0,
                    self.sequence(source),
                    self.expr(body)
                )
            }
            Sequence::One(e) => format!("one {}", self.expr(e)),
        }
    }

    pub(super) fn pattern(&self, pattern: &Pattern<Expr>) -> String {
        let mut parts = vec![];
        for node in &pattern.nodes {
            let what = match &node.what {
                Candidate::Any => ".".into(),
                Candidate::Type(id) => self.0.types[*id].name.to_string(),
                Candidate::Root => "^".into(),
                Candidate::Value(e) => format!("={}", self.expr(e)),
                Candidate::Same(n) => format!("same {n}"),
            };
            let field = |field: crate::graph::FieldId| match &node.what {
                Candidate::Type(id) => self.0.types[*id].fields[usize::from(field.0)]
                    .name
                    .to_string(),
                _ => field.0.to_string(),
            };
            let arg = |arg: &PatternArg<Expr>| match arg {
                PatternArg::Bind(f, slot) => format!("{}->#{slot}", field(*f)),
                PatternArg::Equal(f, e) => format!("{}=={}", field(*f), self.expr(e)),
            };
            let args: Vec<String> = node.args.iter().map(arg).collect();
            let label = node.slot.map_or(String::new(), |slot| format!("#{slot}:"));
            let context = if node.is_context { "*" } else { "" };
            let args = if args.is_empty() {
                String::new()
            } else {
                format!("({})", args.join(", "))
            };
            parts.push(format!("{label}{what}{args}{context}"));
        }
        for edge in &pattern.edges {
            let way = format!("{:?}", edge.way).chars().next().unwrap();
            let repeat = if edge.repeat == (1, Some(1)) {
                String::new()
            } else {
                format!("{:?}", edge.repeat)
            };
            parts.push(format!(
                "{}-{:?}{way}{repeat}-{}",
                edge.from, edge.kind, edge.to
            ));
        }
        for condition in &pattern.conditions {
            parts.push(format!(
                "if {:?} {}",
                condition.needs.iter().max(),
                self.expr(&condition.expr)
            ));
        }
        parts.join(" ")
    }

    pub(super) fn stmts(&self, stmts: &[Stmt]) -> String {
        stmts
            .iter()
            .map(|s| self.stmt(s))
            .collect::<Vec<_>>()
            .join("; ")
    }

    pub(super) fn stmt(&self, stmt: &Stmt) -> String {
        match &stmt.kind {
            StmtKind::Expr(e) => self.expr(e),
            StmtKind::Local(slot, None) => format!("let #{}", slot.0),
            StmtKind::Local(slot, Some(e)) => format!("let #{} = {}", slot.0, self.expr(e)),
            StmtKind::Block(stmts) => format!("{{ {} }}", self.stmts(stmts)),
            StmtKind::Return(Some(e)) => format!("return {}", self.expr(e)),
            StmtKind::ForEach {
                slot,
                sequence,
                body,
                ..
            } => {
                let slot = slot.map_or(String::new(), |s| format!("#{} in ", s.0));
                format!("for {slot}{} {}", self.sequence(sequence), self.stmt(body))
            }
            StmtKind::Rule(rule) => {
                format!("rule {} {:?}", self.pattern(&rule.pattern), rule.arrow)
            }
            StmtKind::SuperConstructor(call) => {
                format!(
                    "super {}({})",
                    self.0.types[call.type_id].name,
                    self.all(&call.args)
                )
            }
            other => format!("{:?}", std::mem::discriminant(other)),
        }
    }
}
