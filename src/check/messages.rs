//! Messages that several parts of the check give.

use super::Checker;
use super::model::Type;
use super::pattern::Builder;
use crate::diag::{Diagnostic, Span, nearest};
use crate::graph::TypeId;
use crate::library::{self, ClassId, FunctionId};
use crate::syntax::ast;

impl Checker<'_> {
    /// What follows a part that is searched apart.
    pub(super) fn report_row_after_choice(&mut self, builder: &mut Builder, span: Span) {
        builder.is_wrong = true;
        let message = "a part in `(: … )`, `(& … )` or `(? … )` ends its row";
        let fault = Diagnostic::error("misplaced-choice", span, message);
        self.report(fault.hint("write what follows as a part of its own, behind a comma"));
    }

    /// A part searched apart that cannot stand where it does.
    pub(super) fn report_misplaced_choice(
        &mut self,
        builder: &mut Builder,
        is_nested: bool,
        span: Span,
    ) {
        builder.is_wrong = true;
        let message = if is_nested {
            "a part in `(: … )`, `(& … )` or `(? … )` cannot hold another one"
        } else {
            "what may be missing cannot be replaced"
        };
        let hint = if is_nested {
            "put the two side by side: `A (: > B), (: +> C)`"
        } else {
            "put it into a context: `A (* (? > B) *)`"
        };
        self.report(Diagnostic::error("misplaced-choice", span, message).hint(hint));
    }

    /// Adds the nearest of the names that could have been meant.
    pub(super) fn did_you_mean<'n>(
        &self,
        fault: Diagnostic,
        name: &str,
        candidates: impl IntoIterator<Item = &'n str>,
    ) -> Diagnostic {
        // Short names are near to very many: of those only slips of case and of one letter in three are mended.
        let is_near = |c: &str| match name.chars().count() {
            0..=2 => c.eq_ignore_ascii_case(name),
            3 => strsim::damerau_levenshtein(name, c) <= 1 || c.eq_ignore_ascii_case(name),
            _ => true,
        };
        let is_candidate = |c: &&str| *c != name && !c.contains('.') && is_near(c);
        match nearest(name, candidates.into_iter().filter(is_candidate)) {
            Some(near) => fault.hint(format!("did you mean `{near}`?")),
            None => fault,
        }
    }

    /// A field that a node type does not have.
    pub(super) fn unknown_field(&self, ty: TypeId, name: &str, span: Span) -> Diagnostic {
        let message = format!("`{}` has no property `{name}`", self.types[ty].name);
        let fault = Diagnostic::error("unknown-property", span, message).label("no such property");
        let known: Vec<&str> = self.types[ty].fields.iter().map(|f| &*f.name).collect();
        self.did_you_mean(fault, name, known)
    }

    /// A value of a wrong type.
    pub(super) fn mismatch(&self, from: &Type, to: &Type, span: Span) -> Diagnostic {
        let (from_name, to_name) = (self.type_name(from), self.type_name(to));
        let message = format!("expected `{to_name}`, found `{from_name}`");
        let fault = Diagnostic::error("type-mismatch", span, message)
            .label(format!("this is `{from_name}`"));
        if *from != *to && self.is_castable(from, to) {
            return fault.hint(format!("write `({to_name})` in front to convert it"));
        }
        if *to == Type::Boolean && super::types::is_numeric(from) {
            return fault.hint("compare it with something, such as `!= 0`");
        }
        fault
    }

    /// Reports a method that objects of a type do not have.
    pub(super) fn report_unknown_method(&mut self, ty: &Type, member: &ast::Ident) {
        if let Type::Node(id) = ty
            && self.is_orphan(*id)
        {
            return;
        }
        self.probe_member(member, ty);
        let fault = self.unknown_method(ty, &member.name, member.span);
        self.report(fault);
    }

    /// The fault of a method that objects of a type do not have.
    fn unknown_method(&self, ty: &Type, name: &str, span: Span) -> Diagnostic {
        let message = format!("`{}` has no method `{name}`", self.type_name(ty));
        let fault = Diagnostic::error("unknown-method", span, message).label("no such method");
        if matches!(ty, Type::Array(_)) {
            return match name {
                "length" | "size" => fault.hint("write `.length` without parentheses"),
                "get" | "set" => fault.hint("write `a[i]`, and `a[i] = value` to set it"),
                "add" | "remove" => {
                    fault.hint("an array keeps its length: take an `ArrayList` for what grows")
                }
                _ => fault,
            };
        }
        let lineage: Vec<&str> = match ty {
            Type::Class(class) | Type::Generic(class, _) => {
                class.lineage().map(ClassId::name).collect()
            }
            Type::String => vec!["String"],
            _ => vec![],
        };
        let of_library = library::MethodId::ALL
            .iter()
            .filter(|m| !m.is_hidden())
            .map(|m| m.signature());
        let mut known: Vec<String> = of_library
            .filter(|row| lineage.contains(&row.owner))
            .map(|row| row.name.into())
            .collect();
        if let Type::Node(id) = ty {
            let is_own = |m: &&super::declaration::MethodInfo<'_>| {
                m.owner.is_some_and(|o| self.types.is_a(*id, o))
            };
            known.extend(self.methods.iter().filter(is_own).map(|m| m.name.into()));
            let visible = self.types[*id]
                .fields
                .iter()
                .map(|f| &*f.name)
                .filter(|n| !n.contains('.'));
            let prefix = if name.starts_with("set") {
                "set"
            } else {
                "get"
            };
            let accessor = |field: &str| {
                let mut letters = field.chars();
                let first = letters
                    .next()
                    .map(|c| c.to_uppercase().to_string())
                    .unwrap_or_default();
                format!("{prefix}{first}{}", letters.as_str())
            };
            known.extend(visible.map(accessor));
            if self.types.field(*id, "shader").is_some() {
                known.push("setColor".into());
            }
        }
        self.did_you_mean(fault, name, known.iter().map(String::as_str))
    }

    /// The fault of a call of something unknown; `None` if it was refused before.
    pub(super) fn unknown_function(&self, name: &str, span: Span) -> Option<Diagnostic> {
        self.probe(name);
        if self.refused.contains(name) || self.cx.this.is_some_and(|this| self.is_orphan(this)) {
            return None;
        }
        if name == "apply" {
            let fault = Diagnostic::error(
                "bad-apply",
                span,
                "`apply(n)` can stand only in the head of a `for`",
            );
            return Some(fault.hint("write `for (apply(n)) …`"));
        }
        if super::aggregate::NAMES.contains(&name) {
            let message = format!("`{name}` does not take these arguments");
            let fault = Diagnostic::error("wrong-arguments", span, message);
            return Some(fault.hint(if name.starts_with("selectWhere") {
                format!("it takes a query and what is asked of each: `{name}((* l:Leaf *), l[area])`")
            } else {
                format!("it takes the values alone, such as `{name}((* Leaf *)[area])`; a condition on them is written `(* l:Leaf, (l[area] > 1) *)` or, for `forall` and `exist`, `(* Leaf *)[area] > 1`")
            }));
        }
        if let Some(hint) = super::refuse::function_hint(name) {
            let message = format!("`{name}` is not supported");
            return Some(Diagnostic::error("unsupported-function", span, message).hint(hint));
        }
        // In `x.( … )` it is most often meant for `x`.
        let is_setter = name.starts_with("set") && !self.method_names.contains_key(name);
        if let Some(ty) = self.cx.innermost_with().filter(|_| is_setter) {
            return Some(self.unknown_method(ty, name, span));
        }
        let fault = Diagnostic::error(
            "unknown-function",
            span,
            format!("unknown function `{name}`"),
        );
        if self.node_type(name).is_some() {
            return Some(
                fault
                    .label("this is a module")
                    .hint(format!("write `new {name}(…)` outside of rules")),
            );
        }
        if ClassId::named(name).is_some() {
            return Some(
                fault
                    .label("this is a class")
                    .hint(format!("write `new {name}(…)`")),
            );
        }
        if !library::functions_named("Math", name).is_empty() {
            return Some(fault.hint(format!(
                "write `Math.{name}(…)`, or begin the file with `import static java.lang.Math.*;`"
            )));
        }
        let functions = FunctionId::ALL
            .iter()
            .map(|f| f.signature())
            .filter(|row| row.owner.is_empty());
        let known = self
            .methods
            .iter()
            .map(|m| m.name)
            .chain(functions.map(|row| row.name));
        Some(self.did_you_mean(
            fault.label("no such function"),
            name,
            known.chain(super::aggregate::NAMES.iter().copied()),
        ))
    }

    /// The fault of `owner.name(…)` that means nothing; `None` if the owner was refused before.
    pub(super) fn unknown_static_function(
        &self,
        owner: &str,
        owner_span: Span,
        member: &ast::Ident,
    ) -> Option<Diagnostic> {
        if self.refused.contains(owner) {
            return None;
        }
        if self.is_known_qualifier(owner) {
            if let Some(hint) = super::refuse::function_hint(&member.name) {
                let message = format!("`{owner}.{}` is not supported", member.name);
                let fault = Diagnostic::error("unsupported-function", member.span, message);
                return Some(fault.hint(hint));
            }
            let message = format!("`{owner}` has no function `{}`", member.name);
            let fault = Diagnostic::error("unknown-function", member.span, message);
            let rows = FunctionId::ALL.iter().map(|f| f.signature());
            let known = rows.filter(|row| row.owner == owner).map(|row| row.name);
            return Some(self.did_you_mean(fault, &member.name, known));
        }
        Some(self.unknown_owner(owner, owner_span))
    }

    /// The fault of what stands in front of a dot and is no variable, file or class.
    pub(super) fn unknown_owner(&self, owner: &str, span: Span) -> Diagnostic {
        if let Some(hint) = super::refuse::type_hint(owner) {
            let message = format!("`{owner}` is not supported");
            return Diagnostic::error("unsupported-type", span, message).hint(hint);
        }
        let message = format!("unknown variable `{owner}`");
        if let Some(class) = owner.strip_suffix(".out") {
            let fault = Diagnostic::error("unknown-name", span, format!("unknown `{class}`"));
            return fault.hint("write `System.out.println(…)`, or `println(…)` alone");
        }
        let fault = Diagnostic::error("unknown-name", span, message);
        let locals = self.cx.local_names();
        let statics = self.statics.iter().map(|s| s.name);
        let files = self.files.iter().map(|f| f.name.as_str());
        let classes = [
            "Math", "System", "Integer", "Long", "Float", "Double", "String",
        ];
        let known = locals
            .iter()
            .map(String::as_str)
            .chain(statics)
            .chain(files)
            .chain(classes);
        self.did_you_mean(fault.label("no such variable, file or class"), owner, known)
    }
}
