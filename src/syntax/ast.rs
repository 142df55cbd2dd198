//! The syntax tree of `.rgg` files: what was written, with its place, and nothing of what it means.

use crate::diag::Span;

/// A name as written, with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ident {
    /// The name.
    pub name: String,
    /// Its place.
    pub span: Span,
}

/// One `.rgg` file.
#[derive(Clone, Debug, Default)]
pub struct File {
    /// `import …;` lines.
    pub imports: Vec<Import>,
    /// Declarations in textual order.
    pub items: Vec<Item>,
}

/// `import a.b.C;`, `import a.b.*;`, `import static a.B.*;`
#[derive(Clone, Debug)]
pub struct Import {
    /// `a`, `b`, `C`; a trailing `*` is not included.
    pub path: Vec<Ident>,
    /// Whether `static` stood there.
    pub is_static: bool,
    /// Whether it ends in `.*`.
    pub is_wildcard: bool,
    /// The whole line.
    pub span: Span,
}

/// A declaration at the top level of a file, or inside a module or class body.
#[derive(Clone, Debug)]
pub enum Item {
    /// `module …`
    Module(Box<Module>),
    /// `class …`, `interface …`, `enum …` (tier 3; parsed so that the checker can refuse it by name or accept it later)
    Class(Box<Class>),
    /// A method or constructor.
    Method(Box<Method>),
    /// A field, one per declarator.
    Field(Box<Field>),
    /// `{ … }` run at construction; `static { … }` where `is_static`.
    Initializer {
        /// Whether `static` stood there.
        is_static: bool,
        /// The statements.
        body: Block,
    },
}

/// `public static final …` in front of a declaration; annotations are skipped.
#[derive(Clone, Debug, Default)]
pub struct Modifiers {
    /// `static`
    pub is_static: bool,
    /// `final` or `const`
    pub is_final: bool,
    /// `abstract`
    pub is_abstract: bool,
    /// `public`, `protected`, `private` as written.
    pub visibility: Option<Ident>,
}

/// `module M(int a, super.length) extends B(args).(stmts) { fields, methods, initializers } ==> body;`
#[derive(Clone, Debug)]
pub struct Module {
    /// What stood in front.
    pub modifiers: Modifiers,
    /// Its name.
    pub name: Ident,
    /// Parameters in order.
    pub params: Vec<ModuleParam>,
    /// `extends B(args).(stmts)`.
    pub extends: Option<Extends>,
    /// `implements` names (parsed, ignored).
    pub implements: Vec<TypeRef>,
    /// Body in `{ }`.
    pub members: Vec<Item>,
    /// `==> …`: the geometry made when the graph is traversed.
    pub instantiation: Option<Vec<RhsItem>>,
    /// The whole declaration.
    pub span: Span,
}

/// One parameter of a module.
#[derive(Clone, Debug)]
pub enum ModuleParam {
    /// `int a`
    Field {
        /// Its type.
        ty: TypeRef,
        /// Its name.
        name: Ident,
        /// `= value`
        default: Option<Expr>,
    },
    /// `super.length`
    Super(Ident),
}

/// `extends B(args).(stmts)`
#[derive(Clone, Debug)]
pub struct Extends {
    /// The parent type.
    pub parent: TypeRef,
    /// Constructor arguments; `None` without parentheses.
    pub args: Option<Vec<Expr>>,
    /// Statements of `.( … )`.
    pub with: Vec<Stmt>,
}

/// A Java class, interface or enum.
#[derive(Clone, Debug)]
pub struct Class {
    /// `class`, `interface` or `enum`.
    pub keyword: Ident,
    /// What stood in front.
    pub modifiers: Modifiers,
    /// Its name.
    pub name: Ident,
    /// `<T, U extends V>`: the names of its type parameters.
    pub type_params: Vec<Ident>,
    /// `extends`
    pub extends: Option<TypeRef>,
    /// `implements`
    pub implements: Vec<TypeRef>,
    /// Enum constants.
    pub constants: Vec<EnumConstant>,
    /// Body.
    pub members: Vec<Item>,
    /// The whole declaration.
    pub span: Span,
}

/// `LEAF(0.5)` of an enum.
#[derive(Clone, Debug)]
pub struct EnumConstant {
    /// Its name.
    pub name: Ident,
    /// What its constructor is given.
    pub args: Vec<Expr>,
}

/// A method, or a constructor (no `result`).
#[derive(Clone, Debug)]
pub struct Method {
    /// What stood in front.
    pub modifiers: Modifiers,
    /// Result type; `None` for a constructor.
    pub result: Option<TypeRef>,
    /// Its name.
    pub name: Ident,
    /// Parameters.
    pub params: Vec<Param>,
    /// `None` for `abstract` methods. A `[ … ]` body is one `StmtKind::Rules`.
    pub body: Option<Block>,
    /// The whole declaration.
    pub span: Span,
}

/// A method parameter.
#[derive(Clone, Debug)]
pub struct Param {
    /// Its type.
    pub ty: TypeRef,
    /// Its name.
    pub name: Ident,
    /// `T... xs`
    pub is_varargs: bool,
}

/// A field with at most one initializer (`int a, b = 2;` gives two).
#[derive(Clone, Debug)]
pub struct Field {
    /// What stood in front.
    pub modifiers: Modifiers,
    /// Its type.
    pub ty: TypeRef,
    /// Its name.
    pub name: Ident,
    /// `= value`
    pub init: Option<Expr>,
}

/// A type as written: `int`, `float[]`, `de.grogra.rgg.LightModel`, `ArrayList<Integer>`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TypeRef {
    /// `a.b.C` as its parts.
    pub path: Vec<Ident>,
    /// `<A, B>`; a wildcard is its bound, or has no path.
    pub args: Vec<TypeRef>,
    /// Number of `[]`.
    pub dims: u8,
    /// Its place.
    pub span: Span,
}

/// `{ … }`
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// Its statements.
    pub stmts: Vec<Stmt>,
    /// With the braces.
    pub span: Span,
}

/// A statement.
#[derive(Clone, Debug)]
pub struct Stmt {
    /// What it is.
    pub kind: StmtKind,
    /// Its place.
    pub span: Span,
}

/// What a statement is.
#[derive(Clone, Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "the heads of `for` are large and rare, and bodies are short"
)]
pub enum StmtKind {
    /// `;`
    Empty,
    /// `{ … }`
    Block(Block),
    /// `[ … ]`: rules, and code in braces between them.
    Rules(Vec<RuleItem>),
    /// `int a = 1, b;` one entry per declarator.
    Local(Vec<LocalVar>),
    /// `e;`
    Expr(Expr),
    /// `if (c) a else b`
    If(Expr, Box<Stmt>, Option<Box<Stmt>>),
    /// `while (c) s`
    While(Expr, Box<Stmt>),
    /// `do s while (c);`
    DoWhile(Box<Stmt>, Expr),
    /// Any `for`.
    For(ForHead, Box<Stmt>),
    /// `switch (e) { … }`
    Switch(Expr, Vec<SwitchCase>),
    /// `return e;`
    Return(Option<Expr>),
    /// `break label;`
    Break(Option<Ident>),
    /// `continue label;`
    Continue(Option<Ident>),
    /// `label: s`
    Labeled(Ident, Box<Stmt>),
    /// `throw e;`
    Throw(Expr),
    /// `try { } catch (T e) { } finally { }`
    Try {
        /// `try { }`
        body: Block,
        /// `catch (T e) { }`, in order.
        catches: Vec<Catch>,
        /// `finally { }`
        finally: Option<Block>,
    },
    /// A local class (tier 3).
    Class(Box<Class>),
    /// Text that could not be read; its diagnostic has been given already.
    Broken,
}

/// `catch (T | U e) { }`
#[derive(Clone, Debug)]
pub struct Catch {
    /// What is caught.
    pub types: Vec<TypeRef>,
    /// The variable that holds it.
    pub name: Ident,
    /// What is done about it.
    pub body: Block,
}

/// `final? T name = init`
#[derive(Clone, Debug)]
pub struct LocalVar {
    /// Whether `final` stood there.
    pub is_final: bool,
    /// Its type.
    pub ty: TypeRef,
    /// Its name.
    pub name: Ident,
    /// `= value`
    pub init: Option<Expr>,
}

/// What stands in the parentheses of a `for`.
#[derive(Clone, Debug)]
pub enum ForHead {
    /// `for (init; cond; update)`
    Classic {
        /// Declarations or expressions.
        init: Vec<Stmt>,
        /// `None` means true.
        cond: Option<Expr>,
        /// Expressions.
        update: Vec<Expr>,
    },
    /// `for (T x : seq)`, `for (int i : 1:n)`
    Each {
        /// The loop variable.
        var: LocalVar,
        /// A range, query, array or list.
        sequence: Expr,
    },
    /// `for (seq)`: `for (1:3)`, `for ((* x:T *))`, `for (apply(n))`; query labels are in scope of the body.
    Sequence(Expr),
}

/// `case 1: case 2: … ` or `default: …`
#[derive(Clone, Debug)]
pub struct SwitchCase {
    /// `None` for `default`.
    pub value: Option<Expr>,
    /// Statements up to the next case.
    pub body: Vec<Stmt>,
}

/// An expression.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Its place.
    pub span: Span,
}

/// What an expression is.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// A literal.
    Literal(Literal),
    /// A name on its own; `^` is the name `^`.
    Name(String),
    /// `this`
    This,
    /// `super`
    Super,
    /// `a.b`
    Member(Box<Expr>, Ident),
    /// `f(args)`, `x.f(args)`: the callee is a `Name` or `Member`.
    Call(Box<Expr>, Vec<Expr>),
    /// `new T(args)`
    New(TypeRef, Vec<Expr>),
    /// `new T[n][m]`, `new T[n][]`: the given lengths, then the number of further `[]`.
    NewArray(TypeRef, Vec<Expr>, u8),
    /// `new T[] {…}` (with the type) or a bare `{…}` initializer.
    ArrayLiteral(Option<TypeRef>, Vec<Expr>),
    /// `x[i]` with one expression: array element, or attribute where `i` names one (`x[length]`, `(* F *)[length]`).
    Index(Box<Expr>, Box<Expr>),
    /// `x.(a = 1, setB(2))`: evaluates to `x`.
    With(Box<Expr>, Vec<Stmt>),
    /// Prefix operator.
    Unary(UnaryOp, Box<Expr>),
    /// `++x`, `x--`
    IncDec {
        /// Operand.
        target: Box<Expr>,
        /// Whether it adds one (else it subtracts one).
        is_increment: bool,
        /// Whether the operator stands in front.
        is_prefix: bool,
    },
    /// Infix operator.
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `c ? a : b`
    Conditional(Box<Expr>, Box<Expr>, Box<Expr>),
    /// `x = v`, `x += v`
    Assign(Option<BinaryOp>, Box<Expr>, Box<Expr>),
    /// `x := v`, `x :+= v`: done at the end of the step.
    Deferred(Option<BinaryOp>, Box<Expr>, Box<Expr>),
    /// `(T) e`
    Cast(TypeRef, Box<Expr>),
    /// `e instanceof T`
    InstanceOf(Box<Expr>, TypeRef),
    /// `a:b`, a range of integers, both ends included.
    Range(Box<Expr>, Box<Expr>),
    /// `(* pattern *)`
    Query(Box<Pattern>),
    /// `(a, b)`: the value of the last.
    Comma(Vec<Expr>),
    /// `float t => e` or `T t => { … }` (tier 3)
    Lambda(Box<Param>, Box<Expr>),
    /// Text that could not be read; its diagnostic has been given already.
    Broken,
}

/// A literal.
#[derive(Clone, Debug, PartialEq)]
pub enum Literal {
    /// `1`, `0xFF`, `017`
    Int(i32),
    /// `5L`
    Long(i64),
    /// `3f`
    Float(f32),
    /// `1.5`, `1e-3`, `2d`
    Double(f64),
    /// `true`
    Boolean(bool),
    /// `'a'` as its UTF-16 unit
    Char(u16),
    /// `"text"`, escapes resolved
    String(String),
    /// `null`
    Null,
}

/// Prefix operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnaryOp {
    /// `+`
    Plus,
    /// `-`
    Minus,
    /// `!`
    Not,
    /// `~`
    Complement,
}

/// Infix operators, and the operators inside compound assignments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are the operators' own")]
pub enum BinaryOp {
    Add,
    Sub,
    Mul,
    Div,
    Rem,
    /// `**`
    Pow,
    Shl,
    Shr,
    /// `>>>`
    UShr,
    BitAnd,
    BitOr,
    BitXor,
    And,
    Or,
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

/// Something inside `[ … ]` of a rule block.
#[derive(Clone, Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "both are as frequent, and rule blocks are short"
)]
pub enum RuleItem {
    /// `lhs ==> rhs;`
    Rule(Box<Rule>),
    /// A Java statement or `{ … }` between the rules.
    Stmt(Stmt),
}

/// The arrow of a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrow {
    /// `==>`: with embedding.
    Lindenmayer,
    /// `==>>`: without.
    Spo,
    /// `::>`: runs code, changes no structure by itself.
    Execution,
}

/// `lhs ==> rhs;`
#[derive(Clone, Debug)]
pub struct Rule {
    /// Left-hand side.
    pub lhs: Pattern,
    /// Which arrow.
    pub arrow: Arrow,
    /// Right-hand side of `==>` and `==>>`.
    pub rhs: Vec<RhsItem>,
    /// Right-hand side of `::>`.
    pub exec: Option<Box<Stmt>>,
    /// The whole rule.
    pub span: Span,
}

/// A left-hand side or the inside of a query: parts joined by commas.
#[derive(Clone, Debug)]
pub struct Pattern {
    /// The parts; conditions in parentheses are parts of their own.
    pub parts: Vec<PatternPart>,
    /// Its place.
    pub span: Span,
}

/// One comma part of a pattern.
#[derive(Clone, Debug)]
pub enum PatternPart {
    /// Nodes and edges in a row.
    Path(Vec<PatternItem>),
    /// `(condition)`
    Condition(Expr),
}

/// Something in a row of a pattern; between two adjacent nodes without an edge stands the standard (successor) edge.
#[derive(Clone, Debug)]
pub enum PatternItem {
    /// `label:Type(args)`, `Type`, `label`, `.` (any node), `^` (the root), `this`
    Node(NodePattern),
    /// `-->`, `>`, `(-->)+` …
    Edge(EdgePattern),
    /// `[ … ]`: a branch at the previous node.
    Branch(Vec<PatternItem>),
    /// `(* … *)` inside a left-hand side: context, matched but kept.
    Context(Vec<PatternItem>),
    /// `(: … )`, `(& … )`, `(? … )`: a part that is searched apart from the rest.
    Choice(Choice, Vec<PatternPart>, Span),
}

/// How a part of a pattern is searched that is set apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// `(: … )`: only its first match counts.
    First,
    /// `(& … )`: after all other parts.
    Late,
    /// `(? … )`: it may be missing.
    Optional,
}

/// A node of a pattern.
#[derive(Clone, Debug)]
pub struct NodePattern {
    /// `label:`
    pub label: Option<Ident>,
    /// The type or the name of a variable that holds a node; `.`, `^` and `this` as such names; `None` for a bare `label:`.
    pub name: TypeRef,
    /// `(a, , 3)`: `None` without parentheses; an entry is `None` for a gap.
    pub args: Option<Vec<Option<Expr>>>,
    /// Whether it is written `:( … )`: the closure before it goes no further where a match was found.
    pub is_nearest: bool,
    /// Its place.
    pub span: Span,
}

/// An edge of a pattern.
#[derive(Clone, Debug)]
pub struct EdgePattern {
    /// What edge.
    pub kind: EdgeKind,
    /// Which way, seen from the node before it.
    pub direction: EdgeDirection,
    /// `*`, `+`, `?`, `{n}`, `{n,m}` of a closure, as minimum and maximum.
    pub repeat: Option<(u32, Option<u32>)>,
    /// Its place.
    pub span: Span,
}

/// Kinds of edges in patterns and right-hand sides.
#[derive(Clone, Debug)]
pub enum EdgeKind {
    /// `-->`
    Any,
    /// `>`
    Successor,
    /// `+>`
    Branch,
    /// `/>`
    Refinement,
    /// `-name->`: `ancestor`, `minDescendants`, `descendants`, a constant, or a method with its further arguments.
    Named(String, Vec<Expr>),
    /// `(> B +>)`: several in a row, of a closure.
    Walk(Vec<WalkItem>),
}

/// A part of a way that consists of several edges.
#[derive(Clone, Debug)]
pub enum WalkItem {
    /// An edge, or a closure inside the closure.
    Edge(EdgePattern),
    /// A node on the way.
    Node(NodePattern),
    /// A condition.
    Condition(Expr),
}

/// The way of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeDirection {
    /// `-->`
    Forward,
    /// `<--`
    Backward,
    /// `<->`: both edges.
    Both,
    /// `--`, `---`: either.
    Undirected,
}

/// Something in a row of a right-hand side.
#[derive(Clone, Debug)]
pub enum RhsItem {
    /// `label:Node(args).( … )`, `label`, `^`
    Node(RhsNode),
    /// An explicit edge to the next node.
    Edge(EdgePattern),
    /// `[ … ]`
    Branch(Vec<RhsItem>, Span),
    /// `( … )`
    Group(Vec<RhsItem>, Span),
    /// `,`
    Separator(Span),
    /// `for (…) (…)`
    For(Box<ForHead>, Vec<RhsItem>, Span),
    /// `while (c) (…)`
    While(Box<Expr>, Vec<RhsItem>, Span),
    /// `do (…) while (c)`
    DoWhile(Vec<RhsItem>, Box<Expr>, Span),
    /// `if (c) (…) else (…)`
    If(Box<Expr>, Vec<RhsItem>, Vec<RhsItem>, Span),
    /// `{ … }`: Java code.
    Code(Block),
    /// `break`
    Break(Span),
    /// `%`: cut off what follows the matched part.
    Cut(Span),
}

/// A node of a right-hand side: `F(1)`, `a:Apex(2).(x = 1)`, a re-used label, `^`, or an expression giving a node.
#[derive(Clone, Debug)]
pub struct RhsNode {
    /// `label:`
    pub label: Option<Ident>,
    /// `Name`, `Call(Name, args)`, `With(…)`, `New(…)`, `Member(…)`
    pub expr: Expr,
    /// Its place.
    pub span: Span,
}
