//! The syntax tree as one line of text, for tests: operators are bracketed, so that the tree shows.

use super::ast::{
    Arrow, BinaryOp, Block, Choice, EdgeDirection, EdgeKind, EdgePattern, Expr, ExprKind, File,
    ForHead, Ident, Item, Literal, LocalVar, Modifiers, ModuleParam, NodePattern, Param, Pattern,
    PatternItem, PatternPart, RhsItem, Rule, RuleItem, Stmt, StmtKind, TypeRef, UnaryOp, WalkItem,
};

/// Imports and declarations, one per line.
pub(super) fn file(file: &File) -> String {
    let imports = file.imports.iter().map(|import| {
        let keyword = if import.is_static {
            "import static "
        } else {
            "import "
        };
        let star = if import.is_wildcard { ".*" } else { "" };
        format!("{keyword}{}{star};", names(&import.path))
    });
    imports
        .chain(file.items.iter().map(item))
        .collect::<Vec<_>>()
        .join("\n")
}

fn join<T>(items: &[T], separator: &str, show: impl Fn(&T) -> String) -> String {
    items.iter().map(show).collect::<Vec<_>>().join(separator)
}

fn names(path: &[Ident]) -> String {
    join(path, ".", |part| part.name.clone())
}

pub(super) fn ty(ty: &TypeRef) -> String {
    let args = if ty.args.is_empty() {
        String::new()
    } else {
        format!("<{}>", join(&ty.args, ", ", self::ty))
    };
    format!(
        "{}{args}{}",
        names(&ty.path),
        "[]".repeat(usize::from(ty.dims))
    )
}

fn modifiers(modifiers: &Modifiers) -> String {
    let mut text = modifiers
        .visibility
        .as_ref()
        .map_or_else(String::new, |word| format!("{} ", word.name));
    for (is_there, word) in [
        (modifiers.is_static, "static "),
        (modifiers.is_final, "final "),
        (modifiers.is_abstract, "abstract "),
    ] {
        if is_there {
            text.push_str(word);
        }
    }
    text
}

fn init(init: Option<&Expr>) -> String {
    init.map_or_else(String::new, |value| format!(" = {}", expr(value)))
}

pub(super) fn item(item: &Item) -> String {
    match item {
        Item::Module(module) => {
            let params = join(&module.params, ", ", |param| match param {
                ModuleParam::Field {
                    ty: t,
                    name,
                    default,
                } => format!("{} {}{}", ty(t), name.name, init(default.as_ref())),
                ModuleParam::Super(name) => format!("super.{}", name.name),
            });
            let mut text = format!(
                "{}module {}({params})",
                modifiers(&module.modifiers),
                module.name.name
            );
            if let Some(parent) = &module.extends {
                let args = parent
                    .args
                    .as_ref()
                    .map_or_else(String::new, |args| format!("({})", exprs(args)));
                text += &format!(" extends {}{args}", ty(&parent.parent));
                if !parent.with.is_empty() {
                    text += &format!(".({})", join(&parent.with, " ", stmt));
                }
            }
            if !module.implements.is_empty() {
                text += &format!(" implements {}", join(&module.implements, ", ", ty));
            }
            if !module.members.is_empty() {
                text += &format!(" {{ {} }}", join(&module.members, " ", self::item));
            }
            text + &module
                .instantiation
                .as_ref()
                .map_or_else(String::new, |rhs| format!(" ==> {}", rhs_items(rhs)))
                + ";"
        }
        Item::Class(class) => {
            let parent = class
                .extends
                .as_ref()
                .map_or_else(String::new, |parent| format!(" extends {}", ty(parent)));
            let constants = join(&class.constants, ", ", |constant| {
                let args = exprs(&constant.args);
                let args = if args.is_empty() {
                    args
                } else {
                    format!("({args})")
                };
                format!("{}{args}", constant.name.name)
            });
            let members = join(&class.members, " ", self::item);
            let head = format!(
                "{}{} {}",
                modifiers(&class.modifiers),
                class.keyword.name,
                class.name.name
            );
            format!("{head}{parent} {{ {constants}; {members} }}")
        }
        Item::Method(method) => {
            let result = method
                .result
                .as_ref()
                .map_or_else(String::new, |result| ty(result) + " ");
            let head = format!(
                "{}{result}{}({})",
                modifiers(&method.modifiers),
                method.name.name,
                join(&method.params, ", ", param)
            );
            head + &method
                .body
                .as_ref()
                .map_or_else(|| ";".to_owned(), |body| format!(" {}", block(body)))
        }
        Item::Field(field) => {
            format!(
                "{}{} {}{};",
                modifiers(&field.modifiers),
                ty(&field.ty),
                field.name.name,
                init(field.init.as_ref())
            )
        }
        Item::Initializer { is_static, body } => {
            format!("{}{}", if *is_static { "static " } else { "" }, block(body))
        }
    }
}

fn param(param: &Param) -> String {
    format!(
        "{}{} {}",
        ty(&param.ty),
        if param.is_varargs { "..." } else { "" },
        param.name.name
    )
}

fn block(block: &Block) -> String {
    format!("{{ {} }}", join(&block.stmts, " ", stmt))
}

fn local(local: &LocalVar) -> String {
    let word = if local.is_final { "final " } else { "" };
    format!(
        "{word}{} {}{}",
        ty(&local.ty),
        local.name.name,
        init(local.init.as_ref())
    )
}

pub(super) fn stmt(stmt: &Stmt) -> String {
    let label = |label: &Option<Ident>| {
        label
            .as_ref()
            .map_or_else(String::new, |label| format!(" {}", label.name))
    };
    match &stmt.kind {
        StmtKind::Empty => ";".to_owned(),
        StmtKind::Block(body) => block(body),
        StmtKind::Rules(rules) => format!("[ {} ]", join(rules, " ", rule_item)),
        StmtKind::Local(vars) => join(vars, ", ", local) + ";",
        StmtKind::Expr(value) => expr(value) + ";",
        StmtKind::If(cond, then, other) => {
            let other = other
                .as_ref()
                .map_or_else(String::new, |other| format!(" else {}", self::stmt(other)));
            format!("if ({}) {}{other}", expr(cond), self::stmt(then))
        }
        StmtKind::While(cond, body) => format!("while ({}) {}", expr(cond), self::stmt(body)),
        StmtKind::DoWhile(body, cond) => format!("do {} while ({});", self::stmt(body), expr(cond)),
        StmtKind::For(head, body) => format!("for ({}) {}", for_head(head), self::stmt(body)),
        StmtKind::Switch(value, cases) => {
            let cases = join(cases, " ", |case| {
                let value = case.value.as_ref().map_or_else(
                    || "default".to_owned(),
                    |value| format!("case {}", expr(value)),
                );
                format!("{value}: {}", join(&case.body, " ", self::stmt))
            });
            format!("switch ({}) {{ {cases} }}", expr(value))
        }
        StmtKind::Return(value) => format!(
            "return{};",
            value
                .as_ref()
                .map_or_else(String::new, |value| format!(" {}", expr(value)))
        ),
        StmtKind::Break(to) => format!("break{};", label(to)),
        StmtKind::Continue(to) => format!("continue{};", label(to)),
        StmtKind::Labeled(name, body) => format!("{}: {}", name.name, self::stmt(body)),
        StmtKind::Throw(value) => format!("throw {};", expr(value)),
        StmtKind::Try {
            body,
            catches,
            finally,
        } => {
            let catches = join(catches, "", |catch| {
                let types = join(&catch.types, " | ", ty);
                format!(
                    " catch ({types} {}) {}",
                    catch.name.name,
                    block(&catch.body)
                )
            });
            let finally = finally
                .as_ref()
                .map_or_else(String::new, |body| format!(" finally {}", block(body)));
            format!("try {}{catches}{finally}", block(body))
        }
        StmtKind::Class(class) => item(&Item::Class(class.clone())),
        StmtKind::Broken => "<broken>".to_owned(),
    }
}

fn for_head(head: &ForHead) -> String {
    match head {
        ForHead::Classic { init, cond, update } => {
            let cond = cond.as_ref().map_or_else(String::new, expr);
            format!("{} | {cond} | {}", join(init, " ", stmt), exprs(update))
        }
        ForHead::Each { var, sequence } => format!("{} : {}", local(var), expr(sequence)),
        ForHead::Sequence(sequence) => expr(sequence),
    }
}

fn exprs(list: &[Expr]) -> String {
    join(list, ", ", expr)
}

pub(super) fn expr(value: &Expr) -> String {
    match &value.kind {
        ExprKind::Literal(value) => literal(value),
        ExprKind::Name(name) => name.clone(),
        ExprKind::This => "this".to_owned(),
        ExprKind::Super => "super".to_owned(),
        ExprKind::Member(object, name) => format!("{}.{}", expr(object), name.name),
        ExprKind::Call(callee, args) => format!("{}({})", expr(callee), exprs(args)),
        ExprKind::New(class, args) => format!("new {}({})", ty(class), exprs(args)),
        ExprKind::NewArray(of, lengths, dims) => {
            let lengths = join(lengths, "", |length| format!("[{}]", expr(length)));
            format!("new {}{lengths}{}", ty(of), "[]".repeat(usize::from(*dims)))
        }
        ExprKind::ArrayLiteral(of, elements) => {
            format!(
                "{}{{{}}}",
                of.as_ref()
                    .map_or_else(String::new, |of| format!("new {}", ty(of))),
                exprs(elements)
            )
        }
        ExprKind::Index(object, index) => format!("{}[{}]", expr(object), expr(index)),
        ExprKind::With(object, settings) => {
            format!("{}.({})", expr(object), join(settings, " ", stmt))
        }
        ExprKind::Unary(op, operand) => {
            let op = match op {
                UnaryOp::Plus => '+',
                UnaryOp::Minus => '-',
                UnaryOp::Not => '!',
                UnaryOp::Complement => '~',
            };
            format!("({op}{})", expr(operand))
        }
        ExprKind::IncDec {
            target,
            is_increment,
            is_prefix,
        } => {
            let op = if *is_increment { "++" } else { "--" };
            let target = expr(target);
            if *is_prefix {
                format!("({op}{target})")
            } else {
                format!("({target}{op})")
            }
        }
        ExprKind::Binary(op, left, right) => {
            format!("({} {} {})", expr(left), sign(*op), expr(right))
        }
        ExprKind::Conditional(cond, yes, no) => {
            format!("({} ? {} : {})", expr(cond), expr(yes), expr(no))
        }
        ExprKind::Assign(op, left, right) => {
            format!("({} {}= {})", expr(left), op.map_or("", sign), expr(right))
        }
        ExprKind::Deferred(op, left, right) => {
            format!("({} :{}= {})", expr(left), op.map_or("", sign), expr(right))
        }
        ExprKind::Cast(to, operand) => format!("(({}) {})", ty(to), expr(operand)),
        ExprKind::InstanceOf(operand, class) => {
            format!("({} instanceof {})", expr(operand), ty(class))
        }
        ExprKind::Range(first, last) => format!("({}:{})", expr(first), expr(last)),
        ExprKind::Query(query) => format!("(* {} *)", pattern(query)),
        ExprKind::Comma(parts) => format!("comma({})", exprs(parts)),
        ExprKind::Lambda(of, body) => format!("({} => {})", param(of), expr(body)),
        ExprKind::Broken => "<broken>".to_owned(),
    }
}

fn literal(value: &Literal) -> String {
    match value {
        Literal::Int(value) => value.to_string(),
        Literal::Long(value) => format!("{value}L"),
        Literal::Float(value) => format!("{value:?}f"),
        Literal::Double(value) => format!("{value:?}"),
        Literal::Boolean(value) => value.to_string(),
        Literal::Char(unit) => format!("'\\u{unit:04x}'"),
        Literal::String(text) => format!("{text:?}"),
        Literal::Null => "null".to_owned(),
    }
}

fn sign(op: BinaryOp) -> &'static str {
    match op {
        BinaryOp::Add => "+",
        BinaryOp::Sub => "-",
        BinaryOp::Mul => "*",
        BinaryOp::Div => "/",
        BinaryOp::Rem => "%",
        BinaryOp::Pow => "**",
        BinaryOp::Shl => "<<",
        BinaryOp::Shr => ">>",
        BinaryOp::UShr => ">>>",
        BinaryOp::BitAnd => "&",
        BinaryOp::BitOr => "|",
        BinaryOp::BitXor => "^",
        BinaryOp::And => "&&",
        BinaryOp::Or => "||",
        BinaryOp::Eq => "==",
        BinaryOp::Ne => "!=",
        BinaryOp::Lt => "<",
        BinaryOp::Le => "<=",
        BinaryOp::Gt => ">",
        BinaryOp::Ge => ">=",
    }
}

fn rule_item(item: &RuleItem) -> String {
    match item {
        RuleItem::Rule(rule) => self::rule(rule),
        RuleItem::Stmt(statement) => stmt(statement),
    }
}

fn rule(rule: &Rule) -> String {
    let lhs = pattern(&rule.lhs);
    match (rule.arrow, &rule.exec) {
        (Arrow::Execution, Some(statement)) => format!("{lhs} ::> {}", stmt(statement)),
        (Arrow::Spo, _) => format!("{lhs} ==>> {};", rhs_items(&rule.rhs)),
        _ => format!("{lhs} ==> {};", rhs_items(&rule.rhs)),
    }
}

fn pattern(pattern: &Pattern) -> String {
    pattern_parts(&pattern.parts)
}

fn pattern_parts(parts: &[PatternPart]) -> String {
    join(parts, ", ", |part| match part {
        PatternPart::Path(items) => pattern_items(items),
        PatternPart::Condition(cond) => format!("?{}", expr(cond)),
    })
}

fn pattern_items(items: &[PatternItem]) -> String {
    join(items, " ", |item| match item {
        PatternItem::Node(node) if node.is_nearest => format!(":({})", pattern_node(node)),
        PatternItem::Node(node) => pattern_node(node),
        PatternItem::Edge(found) => edge(found),
        PatternItem::Branch(items) => format!("[{}]", pattern_items(items)),
        PatternItem::Context(items) => format!("(* {} *)", pattern_items(items)),
        PatternItem::Choice(choice, parts, _) => {
            let mark = match choice {
                Choice::First => ':',
                Choice::Late => '&',
                Choice::Optional => '?',
            };
            format!("({mark} {})", pattern_parts(parts))
        }
    })
}

fn pattern_node(node: &NodePattern) -> String {
    let label = node
        .label
        .as_ref()
        .map_or_else(String::new, |label| format!("{}:", label.name));
    let args = node.args.as_ref().map_or_else(String::new, |args| {
        format!(
            "({})",
            join(args, ", ", |arg| arg
                .as_ref()
                .map_or_else(|| "_".to_owned(), expr))
        )
    });
    format!("{label}{}{args}", ty(&node.name))
}

fn walk_item(item: &WalkItem) -> String {
    match item {
        WalkItem::Edge(found) => edge(found),
        WalkItem::Node(node) => pattern_node(node),
        WalkItem::Condition(cond) => format!("?{}", expr(cond)),
    }
}

fn edge(edge: &EdgePattern) -> String {
    let kind = match &edge.kind {
        EdgeKind::Any => "any".to_owned(),
        EdgeKind::Successor => "succ".to_owned(),
        EdgeKind::Branch => "branch".to_owned(),
        EdgeKind::Refinement => "refine".to_owned(),
        EdgeKind::Named(name, args) if args.is_empty() => name.clone(),
        EdgeKind::Named(name, args) => format!("{name}({})", exprs(args)),
        EdgeKind::Walk(items) => format!("({})", join(items, " ", walk_item)),
    };
    let (left, right) = match edge.direction {
        EdgeDirection::Forward => ("-", "->"),
        EdgeDirection::Backward => ("<-", "-"),
        EdgeDirection::Both => ("<-", "->"),
        EdgeDirection::Undirected => ("-", "-"),
    };
    let repeat = edge.repeat.map_or_else(String::new, |(least, most)| {
        format!(
            "{{{least},{}}}",
            most.map_or_else(String::new, |most| most.to_string())
        )
    });
    format!("{left}{kind}{right}{repeat}")
}

fn rhs_items(items: &[RhsItem]) -> String {
    join(items, " ", |item| match item {
        RhsItem::Node(node) => {
            format!(
                "{}{}",
                node.label
                    .as_ref()
                    .map_or_else(String::new, |label| format!("{}:", label.name)),
                expr(&node.expr)
            )
        }
        RhsItem::Edge(found) => edge(found),
        RhsItem::Branch(items, _) => format!("[{}]", rhs_items(items)),
        RhsItem::Group(items, _) => format!("({})", rhs_items(items)),
        RhsItem::Separator(_) => ",".to_owned(),
        RhsItem::For(head, items, _) => format!("for ({}) ({})", for_head(head), rhs_items(items)),
        RhsItem::While(cond, items, _) => format!("while ({}) ({})", expr(cond), rhs_items(items)),
        RhsItem::DoWhile(items, cond, _) => {
            format!("do ({}) while ({})", rhs_items(items), expr(cond))
        }
        RhsItem::If(cond, yes, no, _) => format!(
            "if ({}) ({}) else ({})",
            expr(cond),
            rhs_items(yes),
            rhs_items(no)
        ),
        RhsItem::Code(body) => block(body),
        RhsItem::Break(_) => "break".to_owned(),
        RhsItem::Cut(_) => "%".to_owned(),
    })
}
