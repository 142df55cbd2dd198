//! A compiled model.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::code::{Exec, Flow};
use super::compile::Scope;
use super::hooks::Hooks;
use super::machine::{Machine, Statics};
use super::stack::{Kind, Layout, Local, Mark};
use super::trap::Trap;
use super::value::Value;
use crate::check::model::{Expr, MethodId, Model, Slot, Stmt, StmtKind, Type};
use crate::diag::Span;
use crate::graph::{NodeId, TypeId, TypeTable};
use crate::rewrite::Instantiated;

mod calls;

/// Variables of the model as code refers to them.
#[derive(Debug, Default)]
pub struct Outline {
    /// Where they live.
    pub statics: Layout,
}

/// A model as closures; built once, run by any number of machines.
pub struct Program {
    types: Arc<TypeTable>,
    outline: Outline,
    methods: Vec<Method>,
    /// By node type; `None` for built-in types.
    modules: Vec<Option<Module>>,
    /// Initializers of the variables of the model, in order, with their numbers.
    statics: Vec<(u32, Body)>,
    startup: Option<MethodId>,
    init: Option<MethodId>,
    entries: Vec<(String, MethodId)>,
    made_at: BTreeMap<TypeId, Vec<Span>>,
    /// The interfaces of each module and class that has any.
    interfaces: BTreeMap<TypeId, Vec<TypeId>>,
    /// By node type; empty if no type of the model has any.
    pub(super) hooks: Vec<Hooks>,
}

/// A method.
struct Method {
    name: String,
    /// The name in its declaration.
    name_span: Span,
    this: Option<TypeId>,
    params: Vec<Type>,
    result: Type,
    layout: Layout,
    /// `None` if it is abstract.
    body: Option<Exec>,
}

/// A module.
struct Module {
    constructor: Body,
    instantiation: Option<Body>,
    is_pure: bool,
    span: Span,
}

/// Code with its own frame.
struct Body {
    layout: Layout,
    code: Exec,
}

impl Program {
    /// Compiles a checked model.
    pub fn new(model: &Model) -> Self {
        let types: Vec<Type> = model.statics.iter().map(|s| s.ty.clone()).collect();
        let outline = Outline {
            statics: Layout::new(&types),
        };
        let compiler = Compiler {
            model,
            outline: &outline,
        };
        let mut modules: Vec<Option<Module>> = model.types.iter().map(|_| None).collect();
        for module in &model.modules {
            modules[usize::from(module.type_id.0)] = Some(compiler.module(module));
        }
        let methods = model
            .methods
            .iter()
            .map(|method| compiler.method(method))
            .collect();
        let statics = model.statics.iter().enumerate().filter_map(|(i, s)| {
            let init = s.init.as_ref()?;
            let local = outline.statics.local_at(i);
            Some((i as u32, compiler.initializer(local, &s.ty, init, &s.frame)))
        });
        let statics = statics.collect();
        let (types, init, entries) = (
            Arc::new(model.types.clone()),
            model.init,
            model.entries.clone(),
        );
        Self {
            types,
            methods,
            modules,
            statics,
            startup: model.startup,
            init,
            entries,
            made_at: model.made_at.clone(),
            interfaces: model.interfaces.clone(),
            hooks: Hooks::of(model),
            outline,
        }
    }

    /// The node types of the model.
    pub fn types(&self) -> &Arc<TypeTable> {
        &self.types
    }

    /// Methods that can be chosen as the step, with their names.
    pub fn entries(&self) -> &[(String, MethodId)] {
        &self.entries
    }

    /// Number of its methods.
    pub fn n_methods(&self) -> usize {
        self.methods.len()
    }

    /// Whether the model has an `init`.
    pub fn has_init(&self) -> bool {
        self.init.is_some()
    }

    /// Variables of the model before their initializers have run.
    pub fn new_statics(&self) -> Statics {
        let (n_words, n_values) = self.outline.statics.size();
        Statics {
            words: vec![0; n_words as usize],
            values: vec![Value::Null; n_values as usize],
        }
    }

    /// Where a module is declared; `None` for built-in types.
    pub fn declared_at(&self, ty: TypeId) -> Option<Span> {
        self.modules
            .get(usize::from(ty.0))?
            .as_ref()
            .map(|module| module.span)
    }

    /// Where nodes of a type are made; empty if nowhere.
    pub fn made_at(&self, ty: TypeId) -> &[Span] {
        self.made_at.get(&ty).map_or(&[], Vec::as_slice)
    }

    /// Whether a type has an instantiation body, and whether that depends on nothing but the node's fields.
    pub fn instantiation(&self, ty: TypeId) -> Option<Purity> {
        let module = self.instantiating(ty)?;
        Some(if module.is_pure {
            Purity::Pure
        } else {
            Purity::Impure
        })
    }

    /// The nearest type that has an instantiation body.
    fn instantiating(&self, ty: TypeId) -> Option<&Module> {
        let lineage = std::iter::successors(Some(ty), |&t| self.types[t].parent);
        let mut modules = lineage.filter_map(|t| self.modules.get(usize::from(t.0))?.as_ref());
        modules.find(|module| module.instantiation.is_some())
    }

    /// Runs the initializers of the variables of the model.
    pub fn initialize(&self, machine: &mut Machine) -> Result<(), Trap> {
        machine.statics = self.new_statics();
        self.initialize_some(machine, &|_| true)
    }

    /// Runs the initializers of some variables of the model, in order.
    pub fn initialize_some(
        &self,
        machine: &mut Machine,
        is_wanted: &dyn Fn(u32) -> bool,
    ) -> Result<(), Trap> {
        let mut wanted = self.statics.iter().filter(|(number, _)| is_wanted(*number));
        wanted.try_for_each(|(_, body)| self.run(body, machine, machine.stack.mark()).map(drop))
    }

    /// Runs `startup`, if there is one, and applies what it has queued.
    pub fn run_startup(&self, machine: &mut Machine) -> Result<(), Trap> {
        match self.startup {
            Some(startup) => self.run_entry(startup, machine),
            None => Ok(()),
        }
    }

    /// Runs `init`, if there is one, and applies what it has queued.
    pub fn run_init(&self, machine: &mut Machine) -> Result<(), Trap> {
        if let Some(init) = self.init {
            self.run_entry(init, machine)?;
        }
        Ok(())
    }

    /// Runs a method without parameters and applies what it has queued.
    pub fn run_entry(&self, method: MethodId, machine: &mut Machine) -> Result<(), Trap> {
        let span = self.methods[method.0 as usize].name_span;
        let mark = machine.stack.mark();
        self.run_method(method, machine, mark, span)?;
        machine.derive(span)?;
        machine.take_failure()
    }

    /// Runs a method whose arguments were pushed since `mark`; its result is left in the stack.
    pub(super) fn run_method(
        &self,
        id: MethodId,
        m: &mut Machine,
        mark: Mark,
        span: Span,
    ) -> Result<(), Trap> {
        let method = &self.methods[id.0 as usize];
        let Some(body) = &method.body else {
            m.stack.release(mark);
            let message = format!("the method `{}` is abstract", method.name);
            return Err(Trap::exception(
                crate::library::ClassId::UnsupportedOperationException,
                message,
                span,
            ));
        };
        m.enter_call(&method.name, span)?;
        m.trace.call(id);
        m.stack.enter(mark, &method.layout);
        // A method that ends without `return` gives zero.
        m.stack.result_word = 0;
        m.stack.result_value = Value::Null;
        let result = body(self, m);
        m.stack.release(mark);
        match result {
            Ok(_) => Ok(()),
            Err(trap) => Err(self.trace_method(trap, method, span)),
        }
    }

    #[cold]
    fn trace_method(&self, trap: Trap, method: &Method, called_at: Span) -> Trap {
        let owner = match method.this {
            Some(ty) => format!("{}.", self.types[ty].name),
            None => String::new(),
        };
        let text = format!("in method `{owner}{}`", method.name);
        // Nothing in the model calls the entry method.
        if called_at == method.name_span {
            trap.during(text, None)
        } else {
            trap.during(format!("{text}, called at {{place}}"), Some(called_at))
        }
    }

    /// Whether a method has a `this`.
    pub(super) fn has_this(&self, id: MethodId) -> bool {
        self.methods[id.0 as usize].this.is_some()
    }

    /// Runs the constructor of a module; the node and its arguments were pushed since `mark`.
    pub(super) fn run_constructor(
        &self,
        ty: TypeId,
        m: &mut Machine,
        mark: Mark,
        span: Span,
    ) -> Result<(), Trap> {
        let Some(Some(module)) = self.modules.get(usize::from(ty.0)) else {
            m.stack.release(mark);
            return Ok(());
        };
        m.enter_call(&self.types[ty].name, span)?;
        self.run(&module.constructor, m, mark)
            .map(drop)
            .map_err(|trap| {
                let name = &self.types[ty].name;
                trap.during(format!("while making a `{name}` at {{place}}"), Some(span))
            })
    }

    /// Makes what the instantiation body of a node draws.
    pub fn instantiate(&self, node: NodeId, m: &mut Machine) -> Result<Instantiated, Trap> {
        let ty = m.graph.type_of(node)?;
        let Some(module) = self.instantiating(ty) else {
            return Ok(Instantiated::default());
        };
        let Some(body) = &module.instantiation else {
            return Ok(Instantiated::default());
        };
        let mark = m.stack.mark();
        m.trace.has_drawn = true;
        m.enter_call(&self.types[ty].name, module.span)?;
        Some(node).push(&mut m.stack);
        m.queue.begin_instantiation();
        let result = self.run(body, m, mark);
        let mut made = m.queue.end_instantiation();
        if let Err(trap) = result {
            m.queue.free_instantiated(&mut m.graph, &mut made);
            let what = format!(
                "while drawing {} with the body at {{place}}",
                m.graph.node_text(node)
            );
            return Err(trap.at(module.span).during(what, Some(module.span)));
        }
        Ok(made)
    }

    fn run(&self, body: &Body, m: &mut Machine, mark: Mark) -> Result<Flow, Trap> {
        m.stack.enter(mark, &body.layout);
        let result = (body.code)(self, m);
        m.stack.release(mark);
        result
    }
}

/// Whether an instantiation body depends on nothing but the fields of its node: equal fields then give equal geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purity {
    /// Only on those.
    Pure,
    /// On the graph, the generator or the variables of the model as well.
    Impure,
}

/// Makes bodies from parts of the model.
struct Compiler<'m> {
    model: &'m Model,
    outline: &'m Outline,
}

impl Compiler<'_> {
    fn method(&self, method: &crate::check::model::Method) -> Method {
        let scope = Scope::new(self.model, self.outline, &method.frame, &method.result);
        let body = method.body.as_ref().map(|body| scope.body(body));
        Method {
            name: method.name.clone(),
            name_span: method.name_span,
            this: method.this,
            params: method.params.clone(),
            result: method.result.clone(),
            layout: scope.into_layout(),
            body,
        }
    }

    fn module(&self, module: &crate::check::model::Module) -> Module {
        let scope = Scope::new(
            self.model,
            self.outline,
            &module.constructor.frame,
            &Type::Void,
        );
        let code = scope.body(&module.constructor.body);
        let constructor = Body {
            layout: scope.into_layout(),
            code,
        };
        let instantiation = module.instantiation.as_ref().map(|instantiation| {
            let scope = Scope::new(self.model, self.outline, &instantiation.frame, &Type::Void);
            let code = scope.instantiation(&instantiation.body);
            Body {
                layout: scope.into_layout(),
                code,
            }
        });
        let is_pure = module.instantiation.as_ref().is_some_and(|i| i.is_pure);
        Module {
            constructor,
            instantiation,
            is_pure,
            span: module.span,
        }
    }

    fn initializer(&self, to: Local, ty: &Type, value: &Expr, frame: &[Type]) -> Body {
        // The value is returned into a slot of its own and stored from there.
        let mut frame = frame.to_vec();
        frame.push(ty.clone());
        let slot = Slot((frame.len() - 1) as u16);
        let scope = Scope::new(self.model, self.outline, &frame, &Type::Void);
        let local = Stmt {
            kind: StmtKind::Local(slot, Some(value.clone())),
            span: value.span,
        };
        let code = scope.body(std::slice::from_ref(&local));
        let from = Layout::new(&frame).local(slot);
        let code: Exec = Box::new(move |p, m| {
            code(p, m)?;
            match (from, to) {
                (Local::Word(from), _) => {
                    let word = i64::load(&m.stack, from);
                    m.statics.write(to, word);
                }
                (Local::Value(from), _) => {
                    let value = Value::load(&m.stack, from);
                    m.statics.write(to, value);
                }
            }
            Ok(Flow::Next)
        });
        Body {
            layout: scope.into_layout(),
            code,
        }
    }
}
