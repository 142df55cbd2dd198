//! The checked model: every name resolved, every expression typed, every slot numbered. What [`check`](super) makes and
//! `eval` compiles; nothing here can be misspelt any more.

use std::collections::BTreeMap;

use crate::diag::Span;
use crate::graph::pattern::{EdgeKind, EdgeWay, Pattern};
use crate::graph::{FieldId, TypeId, TypeTable};
use crate::library::{ClassId, ConstructorId, FunctionId, MethodId as LibraryMethodId};

pub use crate::library::Type;

/// Number of a local variable in its frame. Slot 0 is `this` where there is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Slot(pub u16);

/// Index into [`Model::statics`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StaticId(pub u32);

/// Index into [`Model::methods`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MethodId(pub u32);

/// A whole model, ready to run.
#[derive(Debug, Default)]
pub struct Model {
    /// Built-in node types first, then the model's modules.
    pub types: TypeTable,
    /// The model's modules and classes, in order of their types.
    pub modules: Vec<Module>,
    /// The interfaces of each module and class that has any, inherited ones included.
    pub interfaces: BTreeMap<TypeId, Vec<TypeId>>,
    /// All methods: of files, of modules.
    pub methods: Vec<Method>,
    /// Fields of the files (variables of the model), all static in effect; initialized in this order. An initializer
    /// block of a file stands among them as the variable `{…}` of type `int`, which nothing reads.
    pub statics: Vec<Static>,
    /// `startup`, if the model has one: runs once, before anything else.
    pub startup: Option<MethodId>,
    /// `init`, if the model has one.
    pub init: Option<MethodId>,
    /// Public methods without parameters that can be stepped (`--entry`), with their names.
    pub entries: Vec<(String, MethodId)>,
    /// Where in the text nodes of each type are made, in the order of checking.
    pub made_at: BTreeMap<TypeId, Vec<Span>>,
}

impl Model {
    /// Whether an object of type `a` is one of type `b`: the same, or one that extends or implements it.
    pub fn is_a(&self, a: TypeId, b: TypeId) -> bool {
        self.types.is_a(a, b) || self.interfaces.get(&a).is_some_and(|all| all.contains(&b))
    }
}

/// A module or class of the model.
#[derive(Debug)]
pub struct Module {
    /// Its type.
    pub type_id: TypeId,
    /// Of a class: what library class its objects are, the nearest that it extends.
    pub class: Option<ClassId>,
    /// Runs on a new node: calls the parent's constructor, stores parameters, runs initializers.
    pub constructor: Constructor,
    /// The geometry made when the graph is traversed; slot 0 is the module's node.
    pub instantiation: Option<Instantiation>,
    /// From each method of a parent that is replaced here or in a module between to what replaces it: a virtual call
    /// looks here, in the module of its receiver, and nowhere else.
    pub overrides: Vec<(MethodId, MethodId)>,
    /// Its declaration.
    pub span: Span,
    /// Its name in the declaration.
    pub name_span: Span,
}

/// How a new node of a module is filled. Slot 0 is the node.
#[derive(Debug, Default)]
pub struct Constructor {
    /// Types of the parameters; they arrive in slots 1, 2, ….
    pub params: Vec<Type>,
    /// Types of all slots, parameters included.
    pub frame: Vec<Type>,
    /// `Stmt::SuperConstructor` first, then assignments and initializers in order.
    pub body: Vec<Stmt>,
}

/// The right-hand side of a module's `==>`.
#[derive(Debug)]
pub struct Instantiation {
    /// Types of all slots; slot 0 is the module's node.
    pub frame: Vec<Type>,
    /// What is drawn.
    pub body: Vec<Production>,
    /// Whether it depends on nothing but the node's own fields (no generator, no graph, no statics that change, no turtle
    /// position): equal fields then give equal geometry, and one prototype serves all.
    pub is_pure: bool,
}

/// A method.
#[derive(Debug)]
pub struct Method {
    /// Its name, for messages.
    pub name: String,
    /// The type of `this`, for methods of modules and classes.
    pub this: Option<TypeId>,
    /// Types of the parameters; they arrive in slots 1, 2, … with `this` in slot 0, or in 0, 1, … without.
    pub params: Vec<Type>,
    /// Its result.
    pub result: Type,
    /// Types of all slots.
    pub frame: Vec<Type>,
    /// `None` for abstract methods.
    pub body: Option<Vec<Stmt>>,
    /// Its declaration.
    pub span: Span,
    /// Its name in the declaration.
    pub name_span: Span,
}

/// A variable of the model.
#[derive(Debug)]
pub struct Static {
    /// Its name, for messages.
    pub name: String,
    /// Its type.
    pub ty: Type,
    /// Its initializer (frame of its own: `frame`).
    pub init: Option<Expr>,
    /// Slots its initializer needs.
    pub frame: Vec<Type>,
    /// Whether nothing ever assigns to it after initialization.
    pub is_constant: bool,
}

/// A statement.
#[derive(Debug, Clone)]
pub struct Stmt {
    /// What it is.
    pub kind: StmtKind,
    /// Its place.
    pub span: Span,
}

/// What a statement is.
#[derive(Debug, Clone)]
pub enum StmtKind {
    /// Evaluates and drops.
    Expr(Expr),
    /// Declares (or re-enters the declaration of) a local: stores the value, or the type's zero.
    Local(Slot, Option<Expr>),
    /// In order.
    Block(Vec<Stmt>),
    /// Condition is boolean.
    If(Expr, Box<Stmt>, Option<Box<Stmt>>),
    /// All loops but those over sequences; `update` runs after the body and on `continue`.
    Loop {
        /// Label, for `break label`.
        label: Option<u16>,
        /// Runs once before.
        init: Vec<Stmt>,
        /// Tested before each turn (after the first turn, for `do`); `None` is true.
        cond: Option<Expr>,
        /// Whether the first turn runs untested.
        is_do: bool,
        /// Runs after each turn.
        update: Vec<Expr>,
        /// The body.
        body: Box<Stmt>,
    },
    /// `for (x : seq)`: each value goes to `slot`, where there is one.
    ForEach {
        /// Label.
        label: Option<u16>,
        /// Where the value goes (converted to the slot's type already).
        slot: Option<Slot>,
        /// What is gone through.
        sequence: Sequence,
        /// The body.
        body: Box<Stmt>,
    },
    /// `switch` with fall-through: first matching case, else `default`.
    Switch {
        /// `int` (or `String`).
        value: Expr,
        /// Constant and index into `body` where it starts.
        cases: Vec<(Constant, usize)>,
        /// Where `default` starts.
        default: Option<usize>,
        /// All statements in order.
        body: Vec<Stmt>,
    },
    /// Value already converted to the method's result type.
    Return(Option<Expr>),
    /// Innermost loop or switch, or that label.
    Break(Option<u16>),
    /// Innermost loop, or that label.
    Continue(Option<u16>),
    /// A labelled statement that is no loop.
    Labeled(u16, Box<Stmt>),
    /// `throw e`: any value, shown as text.
    Throw(Expr),
    /// `try/catch/finally`; catches match by the class of the exception, `Exception` and `Throwable` match all.
    Try {
        /// The body.
        body: Vec<Stmt>,
        /// What is caught, slot of the variable, handler.
        catches: Vec<(Vec<Type>, Slot, Vec<Stmt>)>,
        /// Runs always.
        finally: Vec<Stmt>,
    },
    /// A rule: matched and applied to the queue where it stands.
    Rule(Box<Rule>),
    /// Calls the constructor of the parent type on slot 0 (first statement of a constructor).
    SuperConstructor(Box<NewNode>),
}

/// A typed expression.
#[derive(Debug, Clone)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Its type.
    pub ty: Type,
    /// Its place.
    pub span: Span,
}

/// A constant.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are Java's own")]
pub enum Constant {
    Null,
    Boolean(bool),
    /// Also byte, short and char, by the expression's type.
    Int(i32),
    Long(i64),
    Float(f32),
    Double(f64),
    String(String),
}

/// Operators after overload resolution: both operands have the type `operands` (after promotion).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are the operators' own")]
pub enum Operator {
    Add,
    Sub,
    Mul,
    Div,
    Rem,
    /// `**`: float for int, long and float operands, double if one is double.
    Pow,
    Shl,
    Shr,
    UShr,
    And,
    Or,
    Xor,
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

/// Where a value can be stored.
#[derive(Debug, Clone)]
pub enum Place {
    /// A local.
    Local(Slot),
    /// A variable of the model.
    Static(StaticId),
    /// A field of a node, or of an object of a class of the model, by the type of the expression.
    Field(Box<Expr>, FieldId),
    /// An element of an array.
    Element(Box<Expr>, Box<Expr>),
    /// A public member of a library object (`v.x` of a `Vector3d`).
    Member(Box<Expr>, LibraryMethodId, LibraryMethodId),
}

/// What an expression is. Implicit conversions are explicit `Convert`s here.
#[derive(Debug, Clone)]
pub enum ExprKind {
    /// A constant.
    Constant(Constant),
    /// Reads a place.
    Read(Place),
    /// Numeric conversion or boxing/unboxing from the operand's type to this expression's type, by Java's rules.
    Convert(Box<Expr>),
    /// Checked reference cast; a wrong type is a run-time error.
    Cast(Box<Expr>),
    /// `instanceof`
    InstanceOf(Box<Expr>, Type),
    /// `-x` of the expression's type.
    Negate(Box<Expr>),
    /// `~x`
    Complement(Box<Expr>),
    /// `!x`
    Not(Box<Expr>),
    /// Both operands of type `operands`; the shift distance of shifts is `Int`.
    Binary {
        /// Which.
        op: Operator,
        /// Promoted type of the operands.
        operands: Type,
        /// Left.
        left: Box<Expr>,
        /// Right.
        right: Box<Expr>,
    },
    /// Short circuit `&&`.
    AndThen(Box<Expr>, Box<Expr>),
    /// Short circuit `||`.
    OrElse(Box<Expr>, Box<Expr>),
    /// `a + b` where one is a string: all parts, left to right, as Java prints them.
    Concat(Vec<Expr>),
    /// `c ? a : b`
    Conditional(Box<Expr>, Box<Expr>, Box<Expr>),
    /// `p = v`; value already converted.
    Assign(Place, Box<Expr>),
    /// `p op= v`: computed in `operands`, narrowed to the place's type.
    Compound {
        /// Target; its sub-expressions are evaluated once.
        place: Place,
        /// Which; `None` is string concatenation.
        op: Option<Operator>,
        /// Type in which it is computed.
        operands: Type,
        /// Right operand, converted to `operands`.
        value: Box<Expr>,
    },
    /// `++p` and its kin.
    IncDec {
        /// Target.
        place: Place,
        /// +1 or -1.
        by: i8,
        /// Whether the new value is the result.
        is_prefix: bool,
    },
    /// `p := v`, `p :+= v` of a node's field: queued for the end of the step.
    Deferred {
        /// The node.
        node: Box<Expr>,
        /// Its field.
        field: FieldId,
        /// `None` for `:=`.
        op: Option<Operator>,
        /// The value, converted to the field's type.
        value: Box<Expr>,
    },
    /// A method of the model; `receiver` goes to slot 0. `is_virtual`: look for an override by the receiver's type.
    Call {
        /// Which.
        method: MethodId,
        /// `this` of a module's method.
        receiver: Option<Box<Expr>>,
        /// Converted to the parameters' types.
        args: Vec<Expr>,
        /// Whether overrides count.
        is_virtual: bool,
    },
    /// A library function.
    Library(FunctionId, Vec<Expr>),
    /// A method of a library object or of `String`.
    LibraryMethod(LibraryMethodId, Box<Expr>, Vec<Expr>),
    /// `new Vector3d(1, 2, 3)`
    NewObject(ConstructorId, Vec<Expr>),
    /// `new F(1)`, or `F(1)` in a right-hand side; of a class an object that is no node.
    NewNode(Box<NewNode>),
    /// `x.(a = 1, setB(2))`: runs the statements with the object in `slot`, gives the object.
    With {
        /// The object.
        object: Box<Expr>,
        /// Where it stands meanwhile.
        slot: Slot,
        /// What is done to it.
        body: Vec<Stmt>,
    },
    /// `new T[n][m]`: element type after the given lengths is derived from this expression's type.
    NewArray(Vec<Expr>),
    /// `{ a, b, c }`
    ArrayLiteral(Vec<Expr>),
    /// `a.length`
    ArrayLength(Box<Expr>),
    /// `sum(seq)` and its kin.
    Aggregate(Aggregate, Box<Sequence>),
    /// `selectWhereMin(seq, key)` and its kin: one element by its key; `slot` holds the element while `key` is evaluated.
    SelectWhere {
        /// Which element.
        selection: Selection,
        /// What is gone through.
        sequence: Box<Sequence>,
        /// Holds the element.
        slot: Slot,
        /// Its key.
        key: Box<Expr>,
    },
    /// The root node, `^`.
    Root,
    /// A function as a value: a method, and what stands before its argument (its `this` first, if it has one).
    Function(MethodId, Vec<Expr>),
    /// `(a, b)`: all evaluated, the last is the value.
    Comma(Vec<Expr>),
}

/// Which element of several is selected by its key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selection {
    /// The first with the least number.
    Least,
    /// The first with the greatest number.
    Greatest,
    /// The first for which the key is true (`selectWhere`).
    First,
}

/// A constructor call.
#[derive(Debug, Clone)]
pub struct NewNode {
    /// What is made.
    pub type_id: TypeId,
    /// The constructor that the module or class wrote itself, if it is called; it takes the arguments.
    pub constructor: Option<MethodId>,
    /// Built-in types: which fields the arguments fill, in order. Modules: empty, the constructor's parameters are used.
    pub fields: Vec<FieldId>,
    /// Arguments, converted. Fewer than parameters: the rest is zero (modules), or the type's defaults (built-in types).
    pub args: Vec<Expr>,
}

/// Functions over sequences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are XL's own")]
pub enum Aggregate {
    Sum,
    Prod,
    Count,
    Mean,
    Min,
    Max,
    First,
    Last,
    Empty,
    Exist,
    Forall,
    SelectRandomly,
    /// `array(seq)`
    Array,
    /// `string(seq)`
    String,
}

/// Several values, one after the other.
#[derive(Debug, Clone)]
pub enum Sequence {
    /// Matches of a pattern; the value is the node of pattern node `result`.
    Query {
        /// What is looked for; label and parameter slots are filled before each turn.
        pattern: Box<Pattern<Expr>>,
        /// Which pattern node is the value.
        result: usize,
    },
    /// `from:to`, both included.
    Range(Box<Expr>, Box<Expr>),
    /// Elements of an array.
    Elements(Box<Expr>),
    /// Elements of a library list.
    List(Box<Expr>),
    /// `apply(n)`: n turns, each followed by `derive()`.
    Apply(Box<Expr>),
    /// `source`'s values, each in `slot`, turned into `body`.
    Map {
        /// Where they come from.
        source: Box<Sequence>,
        /// Where each stands.
        slot: Slot,
        /// What becomes of it.
        body: Box<Expr>,
    },
    /// A single value.
    One(Box<Expr>),
}

/// Which arrow a rule has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrow {
    /// `==>`: replaces and embeds.
    Lindenmayer,
    /// `==>>`: replaces without embedding.
    Spo,
    /// `::>`: runs code.
    Execution,
}

/// A rule.
#[derive(Debug, Clone)]
pub struct Rule {
    /// What it looks for.
    pub pattern: Pattern<Expr>,
    /// Its arrow.
    pub arrow: Arrow,
    /// What comes in its place (empty for `::>`).
    pub rhs: Vec<Production>,
    /// What is run (`::>` only).
    pub exec: Option<Stmt>,
    /// The whole rule.
    pub span: Span,
}

/// A piece of a right-hand side.
#[derive(Debug, Clone)]
pub enum Production {
    /// A node: new (`NewNode`, `With`), or one that exists already (a label, `^`, a variable). Goes to `slot` if labelled.
    Node {
        /// The node.
        node: Expr,
        /// Its label's slot.
        slot: Option<Slot>,
    },
    /// The next node is linked by this edge instead of the standard one.
    Edge(EdgeKind, EdgeWay),
    /// `[ … ]`
    Branch(Vec<Production>),
    /// `( … )`
    Group(Vec<Production>),
    /// `,`
    Separator,
    /// `for (x : seq) ( … )`
    ForEach(Option<Slot>, Sequence, Vec<Production>),
    /// `for (;;) ( … )`, `while (c) ( … )` and `do ( … ) while (c)`
    Loop {
        /// Runs once before.
        init: Vec<Stmt>,
        /// Tested before each turn.
        cond: Option<Expr>,
        /// Whether the first turn is made without a test: `do ( … ) while (c)`.
        is_first_free: bool,
        /// Runs after each turn.
        update: Vec<Expr>,
        /// Produced each turn.
        body: Vec<Production>,
    },
    /// `if (c) ( … ) else ( … )`
    If(Expr, Vec<Production>, Vec<Production>),
    /// `{ … }`
    Code(Vec<Stmt>),
    /// Leaves the innermost loop.
    Break,
    /// `%`
    Cut,
}
