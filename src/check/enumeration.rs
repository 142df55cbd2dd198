//! Java enumerations, read as classes: each constant is an object of the class, kept in a static variable of its own.
//!
//! GroIMP refuses `enum`; models written with it in mind of Java lose nothing by it being understood here.

use crate::diag::Span;
use crate::syntax::ast;

/// The field that holds the place of a constant, from 0.
pub(super) const ORDINAL: &str = "$ordinal";
/// The field that holds its name.
const NAME: &str = "$name";

fn ident(name: &str, span: Span) -> ast::Ident {
    ast::Ident {
        name: name.into(),
        span,
    }
}

fn type_named(name: &str, dims: u8, span: Span) -> ast::TypeRef {
    ast::TypeRef {
        path: vec![ident(name, span)],
        args: vec![],
        dims,
        span,
    }
}

fn expr(kind: ast::ExprKind, span: Span) -> ast::Expr {
    ast::Expr { kind, span }
}

fn named(name: &str, span: Span) -> ast::Expr {
    expr(ast::ExprKind::Name(name.into()), span)
}

fn text(text: &str, span: Span) -> ast::Expr {
    let literal = ast::Literal::String(text.into());
    expr(ast::ExprKind::Literal(literal), span)
}

fn stmt(kind: ast::StmtKind, span: Span) -> ast::Stmt {
    ast::Stmt { kind, span }
}

fn call(object: ast::Expr, method: &str, args: Vec<ast::Expr>, span: Span) -> ast::Expr {
    let member = ast::ExprKind::Member(Box::new(object), ident(method, span));
    let callee = Box::new(expr(member, span));
    expr(ast::ExprKind::Call(callee, args), span)
}

fn field(
    modifiers: ast::Modifiers,
    ty: ast::TypeRef,
    name: &ast::Ident,
    init: Option<ast::Expr>,
) -> ast::Item {
    ast::Item::Field(Box::new(ast::Field {
        modifiers,
        ty,
        name: name.clone(),
        init,
    }))
}

/// A method of the enumeration with this result, these parameters and statements.
fn method(
    name: &str,
    is_static: bool,
    result: ast::TypeRef,
    param: Option<(ast::TypeRef, &str)>,
    stmts: Vec<ast::Stmt>,
) -> ast::Item {
    let span = result.span;
    let param = param.map(|(ty, name)| ast::Param {
        ty,
        name: ident(name, span),
        is_varargs: false,
    });
    ast::Item::Method(Box::new(ast::Method {
        modifiers: ast::Modifiers {
            is_static,
            ..ast::Modifiers::default()
        },
        result: Some(result),
        name: ident(name, span),
        params: param.into_iter().collect(),
        body: Some(ast::Block { stmts, span }),
        span,
    }))
}

fn returned(value: ast::Expr) -> ast::Stmt {
    let span = value.span;
    stmt(ast::StmtKind::Return(Some(value)), span)
}

/// The members that a class needs to be this enumeration, its own last.
pub(super) fn members(class: &ast::Class) -> Vec<ast::Item> {
    let (name, span) = (class.name.name.as_str(), class.name.span);
    let of = || type_named(name, 0, span);
    let mut all: Vec<ast::Item> = class
        .constants
        .iter()
        .enumerate()
        .map(|(place, constant)| self::constant(class, place, constant))
        .collect();
    let plain = ast::Modifiers::default;
    let string = || type_named("String", 0, span);
    let int = || type_named("int", 0, span);
    all.push(field(plain(), string(), &ident(NAME, span), None));
    all.push(field(plain(), int(), &ident(ORDINAL, span), None));
    let has = |wanted: &str| {
        class.members.iter().any(|item| {
            matches!(item, ast::Item::Method(m) if m.name.name == wanted && m.params.is_empty())
        })
    };
    all.push(method(
        "name",
        false,
        string(),
        None,
        vec![returned(named(NAME, span))],
    ));
    if !has("toString") {
        all.push(method(
            "toString",
            false,
            string(),
            None,
            vec![returned(named(NAME, span))],
        ));
    }
    all.push(method(
        "ordinal",
        false,
        int(),
        None,
        vec![returned(named(ORDINAL, span))],
    ));
    let other = expr(
        ast::ExprKind::Member(Box::new(named("$other", span)), ident(ORDINAL, span)),
        span,
    );
    let minus = ast::ExprKind::Binary(
        ast::BinaryOp::Sub,
        Box::new(named(ORDINAL, span)),
        Box::new(other),
    );
    let compared = vec![returned(expr(minus, span))];
    all.push(method(
        "compareTo",
        false,
        int(),
        Some((of(), "$other")),
        compared,
    ));
    let constants = class.constants.iter();
    let values = constants.map(|c| named(&c.name.name, span)).collect();
    let values = ast::ExprKind::ArrayLiteral(Some(type_named(name, 1, span)), values);
    let values = vec![returned(expr(values, span))];
    all.push(method(
        "values",
        true,
        type_named(name, 1, span),
        None,
        values,
    ));
    all.push(method(
        "valueOf",
        true,
        of(),
        Some((string(), "$wanted")),
        look_up(class),
    ));
    all.extend(class.members.iter().cloned());
    all
}

/// `static final E A = new E(args).($name = "A", $ordinal = 0);`
fn constant(class: &ast::Class, place: usize, constant: &ast::EnumConstant) -> ast::Item {
    let span = constant.name.span;
    let of = type_named(&class.name.name, 0, span);
    let new = ast::ExprKind::New(of.clone(), constant.args.clone());
    let set = |field: &str, value: ast::Expr| {
        let target = Box::new(named(field, span));
        let assign = ast::ExprKind::Assign(None, target, Box::new(value));
        stmt(ast::StmtKind::Expr(expr(assign, span)), span)
    };
    let place = ast::Literal::Int(i32::try_from(place).unwrap_or(i32::MAX));
    let settings = vec![
        set(NAME, text(&constant.name.name, span)),
        set(ORDINAL, expr(ast::ExprKind::Literal(place), span)),
    ];
    let made = ast::ExprKind::With(Box::new(expr(new, span)), settings);
    let modifiers = ast::Modifiers {
        is_static: true,
        is_final: true,
        ..ast::Modifiers::default()
    };
    field(modifiers, of, &constant.name, Some(expr(made, span)))
}

/// The statements of `valueOf`.
fn look_up(class: &ast::Class) -> Vec<ast::Stmt> {
    let span = class.name.span;
    let mut stmts: Vec<ast::Stmt> = class
        .constants
        .iter()
        .map(|constant| {
            let name = &constant.name.name;
            let is_it = call(
                text(name, span),
                "equals",
                vec![named("$wanted", span)],
                span,
            );
            let then = Box::new(returned(named(name, span)));
            stmt(ast::StmtKind::If(is_it, then, None), span)
        })
        .collect();
    let message = format!("No enum constant {}.", class.name.name);
    let message = ast::ExprKind::Binary(
        ast::BinaryOp::Add,
        Box::new(text(&message, span)),
        Box::new(named("$wanted", span)),
    );
    let class = type_named("IllegalArgumentException", 0, span);
    let thrown = ast::ExprKind::New(class, vec![expr(message, span)]);
    stmts.push(stmt(ast::StmtKind::Throw(expr(thrown, span)), span));
    stmts
}
