//! Second pass: the bodies of everything that was declared.

use super::Checker;
use super::context::{Body, Context};
use super::declaration::{MethodInfo, MethodSource};
use super::model::{Method, MethodId, Model, StaticId, Type};
use crate::diag::Diagnostic;

/// `startup`, `init`, and the methods that can be called by name.
type Entries = (Option<MethodId>, Option<MethodId>, Vec<(String, MethodId)>);

impl Checker<'_> {
    /// Checks all bodies and puts the model together.
    pub(super) fn bodies(&mut self) -> Model {
        let mut statics = self.statics();
        let mut modules = self.modules();
        let mut methods: Vec<Method> = (0..self.methods.len())
            .map(|index| self.method(MethodId(index as u32)))
            .collect();
        methods.append(&mut self.closures);
        self.decide_purity(&mut modules);
        for (index, variable) in statics.iter_mut().enumerate() {
            variable.is_constant = !self.assigned.contains(&StaticId(index as u32));
        }
        let ids: Vec<_> = modules.iter().map(|module| module.type_id).collect();
        let with_interfaces = ids.iter().map(|&id| (id, self.interfaces_of(id)));
        let interfaces = with_interfaces.filter(|(_, all)| !all.is_empty()).collect();
        let types = std::mem::take(&mut self.types);
        let (startup, init, entries) = self.entries();
        Model {
            types,
            interfaces,
            modules,
            methods,
            statics,
            startup,
            init,
            entries,
            made_at: std::mem::take(&mut self.made_at),
        }
    }

    fn method(&mut self, id: MethodId) -> Method {
        let MethodInfo {
            name,
            file,
            owner,
            ref params,
            is_static,
            ref result,
            source,
            ..
        } = self.methods[id.0 as usize];
        let (name, params, result) = (name.to_owned(), params.clone(), result.clone());
        let this = owner.filter(|_| !is_static);
        self.cx = Context::new(file, this.map(|id| (id, self.object_type(id))));
        self.cx.owner = owner;
        self.cx.result.clone_from(&result);
        let body = match source {
            MethodSource::Written(method) => {
                for (param, ty) in method.params.iter().zip(&params) {
                    self.declare_local(&param.name, ty.clone(), false, None);
                }
                self.check_method_form(method, owner.is_some());
                // A method of a module that has no body and is not abstract does nothing, as in GroIMP.
                let empty = || (!self.is_abstract(id)).then(Vec::new);
                match &method.body {
                    Some(body) => Some(self.stmts(&body.stmts)),
                    None => empty(),
                }
            }
            MethodSource::Constructor(method) => {
                for (param, ty) in method.params.iter().zip(&params) {
                    self.declare_local(&param.name, ty.clone(), false, None);
                }
                owner.map(|owner| self.constructor_body(owner, method))
            }
            MethodSource::Initializer(block) => Some(self.stmts(&block.stmts)),
        };
        let (span, name_span) = match source {
            MethodSource::Written(method) | MethodSource::Constructor(method) => {
                (method.span, method.name.span)
            }
            MethodSource::Initializer(block) => (block.span, block.span),
        };
        let frame = self.finish(Body::Method(id));
        let params = params
            .into_iter()
            .map(|ty| ty.unwrap_or(Type::Object))
            .collect();
        Method {
            name,
            this,
            params,
            result: result.unwrap_or(Type::Void),
            frame,
            body,
            span,
            name_span,
        }
    }

    /// `init` must be visible, and only abstract methods lack a body.
    fn check_method_form(&mut self, method: &crate::syntax::ast::Method, is_of_module: bool) {
        let name = &method.name;
        let visibility = method
            .modifiers
            .visibility
            .as_ref()
            .map(|v| v.name.as_str());
        if !is_of_module
            && name.name == "init"
            && method.params.is_empty()
            && !matches!(visibility, Some("public" | "protected"))
        {
            let fault = Diagnostic::error(
                "init-visibility",
                name.span,
                "`init` must be `protected` or `public`",
            );
            self.report(fault.hint("write `protected void init()`"));
        }
        if method.body.is_none() && !is_of_module {
            let fault = Diagnostic::error(
                "missing-body",
                name.span,
                format!("method `{}` has no body", name.name),
            );
            self.report(fault.hint("write `{ … }` or `[ … ]`"));
        }
    }

    /// Ends a body: keeps what it does, gives its frame.
    pub(super) fn finish(&mut self, body: Body) -> Vec<Type> {
        self.check_frame();
        self.facts.insert(body, std::mem::take(&mut self.cx.facts));
        std::mem::take(&mut self.cx.frame)
    }

    /// Reports a body with too many variables.
    pub(super) fn check_frame(&mut self) {
        self.note_locals();
        if let Some(span) = self.cx.overflow.take() {
            let fault =
                Diagnostic::error("too-large", span, "this body has more than 65535 variables");
            self.report(fault.hint("split it into several methods"));
        }
    }

    /// `init`, and the methods that can be called by name.
    fn entries(&self) -> Entries {
        let (mut startup, mut init, mut entries) = (None, None, vec![]);
        for (index, method) in self.methods.iter().enumerate() {
            let MethodSource::Written(written) = method.source else {
                continue;
            };
            let is_private = written
                .modifiers
                .visibility
                .as_ref()
                .is_some_and(|v| v.name == "private");
            if method.owner.is_some()
                || !method.params.is_empty()
                || method.result != Some(Type::Void)
                || is_private
            {
                continue;
            }
            let id = MethodId(index as u32);
            if method.name == "init" {
                init = init.or(Some(id));
            } else if method.name == "startup" {
                startup = startup.or(Some(id));
            } else if !entries.iter().any(|(name, _)| name == method.name) {
                entries.push((method.name.to_owned(), id));
            }
        }
        (startup, init, entries)
    }
}
