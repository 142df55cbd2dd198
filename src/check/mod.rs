//! From the syntax tree to the checked [`model`]: every name resolved, every expression typed, every slot numbered.
//!
//! [`check`] goes over the files twice: first all declarations ([`declare`]: modules, fields, methods, variables of all
//! files, so that their order does not matter), then all bodies. Everything that is wrong is collected, each fault once: an
//! expression that could not be typed is `None` from then on and what uses it is passed over.
//!
//! What the language has and this program has not is refused by name (`refuse`), never skipped silently.

mod aggregate;
mod arithmetic;
mod assign;
mod body;
mod call;
mod candidate;
mod class;
mod closure;
mod coerce;
mod constant;
mod construct;
mod context;
mod declaration;
mod declare;
mod edge;
mod enumeration;
mod expr;
mod lint;
mod member;
mod messages;
pub mod model;
mod module;
mod names;
mod overload;
mod pattern;
mod positional;
mod production;
mod purity;
mod refuse;
mod rule;
mod setter;
mod statics;
mod stmt;
mod survey;
mod switch;
mod types;

#[cfg(test)]
mod tests;

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

pub use survey::{LocalVariable, MARKER, Meaning, Probe, Survey};

/// Names of the functions over several values (`sum`, `count`, …).
pub use aggregate::NAMES as AGGREGATES;

use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::graph::{TypeId, TypeTable};
use crate::syntax::ast;
use crate::turtle;
use context::{Body, Context, Facts};
use declaration::{FieldInfo, FileInfo, MethodInfo, ModuleInfo, StaticInfo};
use model::{Constant, MethodId, Model, StaticId};

/// One file of a model.
#[derive(Clone, Debug)]
pub struct SourceModel {
    /// Its name, with or without folder and `.rgg`; other files refer to it by what is left without them.
    pub name: String,
    /// What stands in it.
    pub ast: ast::File,
}

/// Checks the files of one model together.
///
/// The model can be run only if there is no error among the diagnostics. Cost: linear in the size of the files.
pub fn check(files: &[SourceModel]) -> (Model, Diagnostics) {
    let classes = class::collect(files);
    let mut checker = Checker::new(files, &classes);
    checker.declare();
    let model = checker.bodies();
    let mut found = checker.diagnostics;
    if !found.has_errors() {
        found.append(lint::lint(&model));
    }
    (model, found)
}

/// As [`check()`], and tells what the names mean. Also of models with errors.
pub fn survey(files: &[SourceModel]) -> (Model, Diagnostics, Survey) {
    let classes = class::collect(files);
    let mut checker = Checker::new(files, &classes);
    checker.survey = Some(RefCell::default());
    checker.declare();
    let model = checker.bodies();
    let mut found = checker.diagnostics;
    if !found.has_errors() {
        found.append(lint::lint(&model));
    }
    let survey = checker.survey.map(RefCell::into_inner);
    (model, found, survey.unwrap_or_default())
}

/// The state of a check: what is declared, and the body at hand.
struct Checker<'a> {
    files: Vec<FileInfo<'a>>,
    types: TypeTable,
    /// The type that all nodes extend.
    node: TypeId,
    /// What modules extend that say nothing: like GroIMP's, they can be moved by `setTranslation`.
    default_parent: TypeId,
    /// Number of built-in types; they come first in the table.
    n_builtin: usize,
    /// Fields by type and number.
    fields: Vec<Vec<FieldInfo>>,
    /// Modules in order of their types.
    modules: Vec<ModuleInfo<'a>>,
    /// Modules and classes by name.
    module_names: HashMap<String, TypeId>,
    /// Classes of the model, in order of the files.
    classes: &'a [class::Declared],
    /// Constructors that modules and classes wrote themselves.
    constructors: HashMap<TypeId, Vec<MethodId>>,
    methods: Vec<MethodInfo<'a>>,
    method_names: HashMap<String, Vec<MethodId>>,
    /// Methods of each module.
    methods_of: HashMap<TypeId, Vec<MethodId>>,
    statics: Vec<StaticInfo<'a>>,
    static_names: HashMap<String, Vec<StaticId>>,
    /// Values of the variables that are constants.
    static_values: HashMap<StaticId, Constant>,
    /// Variables assigned somewhere besides their initializer.
    assigned: BTreeSet<StaticId>,
    /// Names of types that were refused where they are declared; their uses are passed over.
    refused: HashSet<String>,
    /// Functions as values; as methods they stand behind those that were declared.
    closures: Vec<model::Method>,
    /// Type parameters of the model's own classes; they stand for any object.
    type_params: HashSet<String>,
    /// Where nodes of each type are made.
    made_at: BTreeMap<TypeId, Vec<Span>>,
    /// What each body does.
    facts: BTreeMap<Body, Facts>,
    /// Whether any element of an array is ever assigned.
    writes_elements: bool,
    cx: Context,
    diagnostics: Diagnostics,
    /// What the names mean, if somebody wants to know.
    survey: Option<RefCell<Survey>>,
}

impl<'a> Checker<'a> {
    fn new(files: &'a [SourceModel], classes: &'a [class::Declared]) -> Self {
        let types = turtle::types();
        let node = types.find("Node").unwrap_or(TypeId(0));
        let default_parent = types.find("Null").unwrap_or(node);
        Self {
            default_parent,
            files: files.iter().map(FileInfo::new).collect(),
            n_builtin: types.len(),
            fields: declaration::builtin_fields(&types, node),
            types,
            node,
            modules: vec![],
            module_names: HashMap::new(),
            classes,
            constructors: HashMap::new(),
            methods: vec![],
            method_names: HashMap::new(),
            methods_of: HashMap::new(),
            statics: vec![],
            static_names: HashMap::new(),
            static_values: HashMap::new(),
            assigned: BTreeSet::new(),
            refused: HashSet::new(),
            closures: vec![],
            type_params: classes
                .iter()
                .flat_map(|class| class.type_params.iter().cloned())
                .collect(),
            made_at: BTreeMap::new(),
            facts: BTreeMap::new(),
            writes_elements: false,
            cx: Context::default(),
            diagnostics: Diagnostics::default(),
            survey: None,
        }
    }

    /// Notes a fault.
    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }
}
