//! Expressions: operators by precedence, and the operands they work on.

use super::grammar::Rule;
use super::item::with_dims;
use super::{Reader, kids};
use crate::diag::{Diagnostic, Span};
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Ident, Literal, Param, TypeRef, UnaryOp};
use pest::iterators::Pair;
use pest::pratt_parser::{Assoc, Op, PrattParser};
use std::sync::LazyLock;

/// Most operators in one expression. Trees of left-associative operators are as deep as they are long, and all that walks
/// a tree needs stack for its depth.
const MAX_OPERATORS: usize = 1000;

/// Most operators in one expression that are read from right to left, or stand in front of an operand.
const MAX_NESTED_OPERATORS: usize = 200;

/// Operators from the loosest to the tightest. That `**` is looser than the signs in front of its left operand is the
/// language's: `-2 ** 2` is 4.
static PRATT: LazyLock<PrattParser<Rule>> = LazyLock::new(|| {
    let left = |operator| Op::infix(operator, Assoc::Left);
    PrattParser::new()
        .op(Op::infix(Rule::op_assign, Assoc::Right))
        .op(Op::infix(Rule::op_choose, Assoc::Right))
        .op(left(Rule::op_or))
        .op(left(Rule::op_and))
        .op(left(Rule::op_bit_or))
        .op(left(Rule::op_bit_xor))
        .op(left(Rule::op_bit_and))
        .op(left(Rule::op_equal))
        .op(left(Rule::op_compare) | Op::postfix(Rule::instance_of))
        .op(left(Rule::op_shift))
        .op(left(Rule::op_add))
        .op(left(Rule::op_mul))
        .op(Op::infix(Rule::op_pow, Assoc::Right))
        .op(Op::prefix(Rule::sign) | Op::prefix(Rule::step) | Op::prefix(Rule::cast))
        .op(Op::postfix(Rule::with_block)
            | Op::postfix(Rule::member_access)
            | Op::postfix(Rule::index)
            | Op::postfix(Rule::step_after))
});

impl Reader<'_> {
    pub(super) fn expr(&self, pair: Pair<'_, Rule>) -> Expr {
        if self.is_too_long(&pair) {
            return Self::broken(self.span(&pair));
        }
        let mut parts = pair.into_inner();
        let expr = if parts.len() == 1
            && let Some(only) = parts.next()
        {
            self.primary(only)
        } else {
            PRATT
                .map_primary(|primary| self.primary(primary))
                .map_prefix(|operator, operand| self.prefix(operator, operand))
                .map_postfix(|operand, operator| self.postfix(operand, operator))
                .map_infix(|left, operator, right| self.infix(left, operator, right))
                .parse(parts)
        };
        self.refuse_lone_minimum();
        expr
    }

    /// An expression, or a range of two.
    pub(super) fn range(&self, pair: Pair<'_, Rule>) -> Expr {
        let span = self.span(&pair);
        let mut ends = kids(pair).map(|end| self.expr(end));
        match (ends.next(), ends.next()) {
            (Some(first), None) => first,
            (Some(first), Some(last)) => Expr {
                kind: ExprKind::Range(Box::new(first), Box::new(last)),
                span,
            },
            _ => Self::broken(span),
        }
    }

    /// An expression or the elements of an array.
    pub(super) fn initial(&self, pair: Pair<'_, Rule>) -> Expr {
        if pair.as_rule() == Rule::expr {
            self.expr(pair)
        } else {
            self.array_literal(pair, None)
        }
    }

    fn array_literal(&self, pair: Pair<'_, Rule>, ty: Option<TypeRef>) -> Expr {
        let span = self.span(&pair);
        let elements = kids(pair).map(|element| self.initial(element)).collect();
        Expr {
            kind: ExprKind::ArrayLiteral(ty, elements),
            span,
        }
    }

    /// Whether a tree of the parts of `pair` would be too deep; says so.
    pub(super) fn is_too_long(&self, pair: &Pair<'_, Rule>) -> bool {
        let (mut operators, mut nested) = (0, 0);
        for part in pair.clone().into_inner() {
            match part.as_rule() {
                Rule::op_assign
                | Rule::op_choose
                | Rule::op_pow
                | Rule::sign
                | Rule::step
                | Rule::cast => nested += 1,
                _ => operators += 1,
            }
        }
        // Operands count as well, so the limit on left-associative operators is about doubled here.
        let is_too_long = operators > 2 * MAX_OPERATORS || nested > MAX_NESTED_OPERATORS;
        if is_too_long {
            let message = "this expression has too many operators";
            let hint = format!(
                "compute it in parts: at most {MAX_OPERATORS} operators may stand in one expression"
            );
            self.report(
                Diagnostic::error("expression-too-long", self.span(pair), message).hint(hint),
            );
        }
        is_too_long
    }

    // ── operators ──

    fn prefix(&self, operator: Pair<'_, Rule>, operand: Expr) -> Expr {
        let span = self.span(&operator).to(operand.span);
        let kind = match (operator.as_rule(), operator.as_str()) {
            (Rule::cast, _) => return self.cast(operator, operand),
            (Rule::step, text) => return step(operand, text == "++", true, span),
            (_, "-") if self.lone_minimum.take() == Some(operand.span) => operand.kind,
            (_, text) => {
                let operator = match text {
                    "!" => UnaryOp::Not,
                    "~" => UnaryOp::Complement,
                    "+" => UnaryOp::Plus,
                    _ => UnaryOp::Minus,
                };
                ExprKind::Unary(operator, Box::new(operand))
            }
        };
        Expr { kind, span }
    }

    fn cast(&self, operator: Pair<'_, Rule>, operand: Expr) -> Expr {
        let start = self.span(&operator);
        let mut ty = TypeRef {
            path: vec![],
            args: vec![],
            dims: 0,
            span: start,
        };
        for kid in kids(operator) {
            match kid.as_rule() {
                Rule::type_ref => ty = self.type_ref(kid),
                Rule::primitive => ty = self.plain_type(kid),
                _ => ty = with_dims(ty, 1),
            }
        }
        Expr {
            span: start.to(operand.span),
            kind: ExprKind::Cast(ty, Box::new(operand)),
        }
    }

    pub(super) fn postfix(&self, operand: Expr, operator: Pair<'_, Rule>) -> Expr {
        let span = operand.span.to(self.span(&operator));
        let operand = Box::new(operand);
        let kind = match operator.as_rule() {
            Rule::member_access => return self.member_of(*operand, operator),
            Rule::step_after => return step(*operand, operator.as_str() == "++", false, span),
            Rule::with_block => ExprKind::With(operand, self.with_block(operator)),
            Rule::index => match kids(operator).next() {
                Some(index) => ExprKind::Index(operand, Box::new(self.range(index))),
                None => ExprKind::Broken,
            },
            _ => match kids(operator).next() {
                Some(ty) => ExprKind::InstanceOf(operand, self.type_ref(ty)),
                None => ExprKind::Broken,
            },
        };
        Expr { kind, span }
    }

    fn member_of(&self, object: Expr, pair: Pair<'_, Rule>) -> Expr {
        let mut parts = kids(pair);
        let Some(name) = parts.next() else {
            return object;
        };
        let name = self.ident(&name);
        let span = object.span.to(name.span);
        let member = Expr {
            kind: ExprKind::Member(Box::new(object), name),
            span,
        };
        self.call(member, parts.next())
    }

    /// `callee` with arguments where there are any.
    fn call(&self, callee: Expr, args: Option<Pair<'_, Rule>>) -> Expr {
        let Some(args) = args else { return callee };
        let span = callee.span.to(self.span(&args));
        Expr {
            kind: ExprKind::Call(Box::new(callee), self.args(args)),
            span,
        }
    }

    fn infix(&self, left: Expr, operator: Pair<'_, Rule>, right: Expr) -> Expr {
        let span = left.span.to(right.span);
        let (left, right) = (Box::new(left), Box::new(right));
        let kind = match operator.as_rule() {
            Rule::op_assign => {
                let text = operator.as_str();
                let (is_deferred, sign) = match text.strip_prefix(':') {
                    Some(rest) => (true, rest.trim_end_matches('=')),
                    None => (false, text.trim_end_matches('=')),
                };
                let build = if is_deferred {
                    ExprKind::Deferred
                } else {
                    ExprKind::Assign
                };
                build(binary_op(sign), left, right)
            }
            Rule::op_choose => match kids(operator).next() {
                Some(middle) => ExprKind::Conditional(left, Box::new(self.expr(middle)), right),
                None => ExprKind::Broken,
            },
            _ => match binary_op(operator.as_str()) {
                Some(sign) => ExprKind::Binary(sign, left, right),
                None => ExprKind::Broken,
            },
        };
        Expr { kind, span }
    }

    // ── operands ──

    pub(super) fn primary(&self, pair: Pair<'_, Rule>) -> Expr {
        let span = self.span(&pair);
        let kind = match pair.as_rule() {
            Rule::int | Rule::float | Rule::string | Rule::character | Rule::literal_word => {
                self.literal(&pair)
            }
            Rule::query => match kids(pair).next() {
                Some(pattern) => ExprKind::Query(Box::new(self.pattern(pattern))),
                None => ExprKind::Broken,
            },
            Rule::paren => return self.paren(pair),
            Rule::new_value => return self.new_value(pair),
            Rule::typed_lambda => return self.typed_lambda(pair),
            Rule::name => return self.name(pair),
            Rule::this_word | Rule::super_word => {
                let is_this = pair.as_rule() == Rule::this_word;
                let word = pair
                    .clone()
                    .into_inner()
                    .next()
                    .map_or(span, |word| self.span(&word));
                let kind = if is_this {
                    ExprKind::This
                } else {
                    ExprKind::Super
                };
                return self.call(Expr { kind, span: word }, kids(pair).next());
            }
            _ => ExprKind::Broken,
        };
        Expr { kind, span }
    }

    fn paren(&self, pair: Pair<'_, Rule>) -> Expr {
        let span = self.span(&pair);
        let mut parts: Vec<Expr> = kids(pair).map(|part| self.range(part)).collect();
        match parts.pop() {
            Some(only) if parts.is_empty() => Expr { span, ..only },
            Some(last) => {
                parts.push(last);
                Expr {
                    kind: ExprKind::Comma(parts),
                    span,
                }
            }
            None => Self::broken(span),
        }
    }

    fn name(&self, pair: Pair<'_, Rule>) -> Expr {
        let mut parts = kids(pair);
        match parts.next() {
            Some(name) => self.name_of(self.ident(&name), parts.next()),
            None => Self::broken(Span::default()),
        }
    }

    /// A name with what stands behind it.
    pub(super) fn name_of(&self, name: Ident, rest: Option<Pair<'_, Rule>>) -> Expr {
        match rest {
            Some(tail) if tail.as_rule() == Rule::lambda_tail => {
                let ty = TypeRef {
                    args: vec![],
                    dims: 0,
                    span: name.span,
                    path: vec![name],
                };
                self.lambda(ty, tail)
            }
            args => self.call(
                Expr {
                    span: name.span,
                    kind: ExprKind::Name(name.name),
                },
                args,
            ),
        }
    }

    fn typed_lambda(&self, pair: Pair<'_, Rule>) -> Expr {
        let mut ty = TypeRef {
            path: vec![],
            args: vec![],
            dims: 0,
            span: self.span(&pair),
        };
        let mut lambda = Self::broken(ty.span);
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::primitive => ty = self.plain_type(kid),
                Rule::dim => ty = with_dims(ty, 1),
                _ => lambda = self.lambda(ty.clone(), kid),
            }
        }
        lambda
    }

    /// A function value; a type in front of its body, `float t => float t * t`, is the body's conversion to that type.
    fn lambda(&self, ty: TypeRef, tail: Pair<'_, Rule>) -> Expr {
        let span = ty.span.to(self.span(&tail));
        let name: Ident = self.first_ident(&tail);
        let (mut result, mut body) = (None, Self::broken(span));
        for kid in kids(tail) {
            match kid.as_rule() {
                Rule::result_type => result = kids(kid).next().map(|ty| self.plain_type(ty)),
                Rule::expr => body = self.expr(kid),
                _ => {}
            }
        }
        if let Some(result) = result {
            body = Expr {
                span: body.span,
                kind: ExprKind::Cast(result, Box::new(body)),
            };
        }
        let param = Param {
            ty,
            name,
            is_varargs: false,
        };
        Expr {
            kind: ExprKind::Lambda(Box::new(param), Box::new(body)),
            span,
        }
    }

    fn new_value(&self, pair: Pair<'_, Rule>) -> Expr {
        let span = self.span(&pair);
        let mut ty = TypeRef {
            path: vec![],
            args: vec![],
            dims: 0,
            span,
        };
        let (mut lengths, mut dims, mut args) = (vec![], 0_u8, None);
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::primitive | Rule::qualified => ty = self.plain_type(kid),
                Rule::type_args => ty.args = self.type_args(kid),
                Rule::args => args = Some(self.args(kid)),
                Rule::dim => dims = dims.saturating_add(1),
                Rule::length => lengths.extend(kids(kid).next().map(|length| self.expr(length))),
                Rule::array_literal => {
                    return Expr {
                        span,
                        ..self.array_literal(kid, Some(with_dims(ty, dims)))
                    };
                }
                _ => {}
            }
        }
        let kind = match args {
            Some(args) => ExprKind::New(ty, args),
            None => ExprKind::NewArray(ty, lengths, dims),
        };
        Expr { kind, span }
    }

    fn refuse_lone_minimum(&self) {
        if let Some(span) = self.lone_minimum.take() {
            self.report(super::literal::out_of_range(span, "int"));
        }
    }

    fn literal(&self, value: &Pair<'_, Rule>) -> ExprKind {
        let span = self.span(value);
        let text = value.as_str().trim_end();
        let literal = match value.as_rule() {
            Rule::int
                if text == "2147483648" || text.eq_ignore_ascii_case("9223372036854775808l") =>
            {
                self.lone_minimum.set(Some(span));
                let is_int = text.len() == 10;
                Ok(if is_int {
                    Literal::Int(i32::MIN)
                } else {
                    Literal::Long(i64::MIN)
                })
            }
            Rule::int => super::literal::int(text, span),
            Rule::float => super::literal::float(text, span),
            Rule::string => super::literal::string(text, span),
            Rule::character => super::literal::character(text, span),
            _ => Ok(match text {
                "true" => Literal::Boolean(true),
                "false" => Literal::Boolean(false),
                _ => Literal::Null,
            }),
        };
        literal.map_or_else(
            |diagnostic| {
                self.report(*diagnostic);
                ExprKind::Broken
            },
            ExprKind::Literal,
        )
    }
}

fn step(target: Expr, is_increment: bool, is_prefix: bool, span: Span) -> Expr {
    Expr {
        kind: ExprKind::IncDec {
            target: Box::new(target),
            is_increment,
            is_prefix,
        },
        span,
    }
}

fn binary_op(text: &str) -> Option<BinaryOp> {
    Some(match text {
        "+" => BinaryOp::Add,
        "-" => BinaryOp::Sub,
        "*" => BinaryOp::Mul,
        "/" => BinaryOp::Div,
        "%" => BinaryOp::Rem,
        "**" => BinaryOp::Pow,
        "<<" => BinaryOp::Shl,
        ">>" => BinaryOp::Shr,
        ">>>" => BinaryOp::UShr,
        "&" => BinaryOp::BitAnd,
        "|" => BinaryOp::BitOr,
        "^" => BinaryOp::BitXor,
        "&&" => BinaryOp::And,
        "||" => BinaryOp::Or,
        "==" => BinaryOp::Eq,
        "!=" => BinaryOp::Ne,
        "<" => BinaryOp::Lt,
        "<=" => BinaryOp::Le,
        ">" => BinaryOp::Gt,
        ">=" => BinaryOp::Ge,
        _ => return None,
    })
}
