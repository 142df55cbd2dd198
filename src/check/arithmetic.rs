//! Operators: arithmetic, comparison, logic, text, and those between vectors.

use super::Checker;
use super::model::{Constant, Expr, ExprKind, Operator, Type};
use super::overload::Overload;
use super::types::{is_integral, is_numeric, is_reference, promote, promote_both};
use crate::diag::{Diagnostic, Span};
use crate::library::{self, ClassId, MethodId};
use crate::syntax::ast::{self, BinaryOp, UnaryOp};

/// The sign of an operator.
pub(super) fn sign(op: BinaryOp) -> &'static str {
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

/// The operator of the model; `&&` and `||` have none.
fn operator(op: BinaryOp) -> Option<Operator> {
    Some(match op {
        BinaryOp::Add => Operator::Add,
        BinaryOp::Sub => Operator::Sub,
        BinaryOp::Mul => Operator::Mul,
        BinaryOp::Div => Operator::Div,
        BinaryOp::Rem => Operator::Rem,
        BinaryOp::Pow => Operator::Pow,
        BinaryOp::Shl => Operator::Shl,
        BinaryOp::Shr => Operator::Shr,
        BinaryOp::UShr => Operator::UShr,
        BinaryOp::BitAnd => Operator::And,
        BinaryOp::BitOr => Operator::Or,
        BinaryOp::BitXor => Operator::Xor,
        BinaryOp::Eq => Operator::Eq,
        BinaryOp::Ne => Operator::Ne,
        BinaryOp::Lt => Operator::Lt,
        BinaryOp::Le => Operator::Le,
        BinaryOp::Gt => Operator::Gt,
        BinaryOp::Ge => Operator::Ge,
        BinaryOp::And | BinaryOp::Or => return None,
    })
}

/// How a pair of operand types is computed.
pub(super) struct Computed {
    pub(super) op: Operator,
    /// Type of both operands (shifts: of the left one; the right is `int`).
    pub(super) operands: Type,
    /// Type of the result.
    pub(super) result: Type,
}

/// How `op` works on primitive operands; `None` if it does not.
pub(super) fn computed(op: BinaryOp, left: &Type, right: &Type) -> Option<Computed> {
    use BinaryOp as B;
    let kind = operator(op)?;
    let both = |test: fn(&Type) -> bool| test(left) && test(right);
    let booleans = *left == Type::Boolean && *right == Type::Boolean;
    let of = |operands: Type, result: Type| {
        Some(Computed {
            op: kind,
            operands,
            result,
        })
    };
    match op {
        B::Add | B::Sub | B::Mul | B::Div | B::Rem if both(is_numeric) => {
            let ty = promote_both(left, right);
            of(ty.clone(), ty)
        }
        B::Pow if both(is_numeric) => {
            let is_double = *left == Type::Double || *right == Type::Double;
            let ty = if is_double { Type::Double } else { Type::Float };
            of(ty.clone(), ty)
        }
        B::Shl | B::Shr | B::UShr if both(is_integral) => of(promote(left), promote(left)),
        B::BitAnd | B::BitOr | B::BitXor if booleans => of(Type::Boolean, Type::Boolean),
        B::BitAnd | B::BitOr | B::BitXor if both(is_integral) => {
            let ty = promote_both(left, right);
            of(ty.clone(), ty)
        }
        B::Lt | B::Le | B::Gt | B::Ge | B::Eq | B::Ne if both(is_numeric) => {
            of(promote_both(left, right), Type::Boolean)
        }
        B::Eq | B::Ne if booleans => of(Type::Boolean, Type::Boolean),
        _ => None,
    }
}

impl Checker<'_> {
    /// A chain of infix operators. Its left side is walked in a loop, because chains grow long (`"a" + b + c + …`).
    pub(super) fn binary(&mut self, e: &ast::Expr) -> Option<Expr> {
        let (mut chain, mut at) = (vec![], e);
        while let ast::ExprKind::Binary(op, left, right) = &at.kind {
            chain.push((*op, right, at.span));
            at = left;
        }
        let mut left = self.value(at);
        while let Some((op, right, span)) = chain.pop() {
            let right = self.value(right);
            left = match (left, right) {
                (Some(left), Some(right)) => self.binary_values(op, left, right, span),
                _ => None,
            };
        }
        left
    }

    /// `left op right` of checked operands.
    fn binary_values(&mut self, op: BinaryOp, left: Expr, right: Expr, span: Span) -> Option<Expr> {
        match op {
            BinaryOp::And | BinaryOp::Or => {
                let (left, right) = (self.boolean(left), self.boolean(right));
                let (left, right) = (Box::new(left?), Box::new(right?));
                let kind = if op == BinaryOp::And {
                    ExprKind::AndThen(left, right)
                } else {
                    ExprKind::OrElse(left, right)
                };
                Some(Expr {
                    kind,
                    ty: Type::Boolean,
                    span,
                })
            }
            BinaryOp::Add if left.ty == Type::String || right.ty == Type::String => {
                Some(concat(left, right, span))
            }
            _ => self.arithmetic(op, left, right, span),
        }
    }

    fn arithmetic(&mut self, op: BinaryOp, left: Expr, right: Expr, span: Span) -> Option<Expr> {
        let is_equality = matches!(op, BinaryOp::Eq | BinaryOp::Ne);
        if is_equality && is_reference(&left.ty) && is_reference(&right.ty) {
            return self.identity(op, left, right, span);
        }
        let (left, right) = (self.unbox(left), self.unbox(right));
        if let Some(Computed {
            op: kind,
            operands,
            result,
        }) = computed(op, &left.ty, &right.ty)
        {
            let is_shift = matches!(op, BinaryOp::Shl | BinaryOp::Shr | BinaryOp::UShr);
            let right_ty = if is_shift {
                Type::Int
            } else {
                operands.clone()
            };
            let (left, right) = (
                self.convert(left, &operands),
                self.convert(right, &right_ty),
            );
            let kind = ExprKind::Binary {
                op: kind,
                operands,
                left: Box::new(left),
                right: Box::new(right),
            };
            return Some(Expr {
                kind,
                ty: result,
                span,
            });
        }
        self.vector_operator(op, left, right, span)
    }

    /// `==` and `!=` of objects.
    fn identity(&mut self, op: BinaryOp, left: Expr, right: Expr, span: Span) -> Option<Expr> {
        let related =
            self.is_castable(&left.ty, &right.ty) || self.is_castable(&right.ty, &left.ty);
        if !related {
            let (a, b) = (self.type_name(&left.ty), self.type_name(&right.ty));
            let message = format!("`{a}` and `{b}` can never be equal");
            self.report(Diagnostic::error("never-equal", span, message));
            return None;
        }
        let op = if op == BinaryOp::Eq {
            Operator::Eq
        } else {
            Operator::Ne
        };
        let kind = ExprKind::Binary {
            op,
            operands: Type::Object,
            left: Box::new(left),
            right: Box::new(right),
        };
        Some(Expr {
            kind,
            ty: Type::Boolean,
            span,
        })
    }

    /// Operators between vectors, which are methods of the library.
    fn vector_operator(
        &mut self,
        op: BinaryOp,
        left: Expr,
        right: Expr,
        span: Span,
    ) -> Option<Expr> {
        // `2 * v` is `v * 2`.
        let is_swapped =
            op == BinaryOp::Mul && is_numeric(&left.ty) && matches!(right.ty, Type::Class(_));
        let (object, arg) = if is_swapped {
            (right, left)
        } else {
            (left, right)
        };
        if let Type::Class(class) = object.ty {
            let mut lineage = class
                .lineage()
                .map(|c| library::methods_named(c.name(), sign(op)));
            let found: &[MethodId] = lineage.find(|found| !found.is_empty()).unwrap_or_default();
            let overloads: Vec<_> = found
                .iter()
                .map(|&id| Overload::of_signature(id, id.signature(), self, None))
                .collect();
            let args = vec![arg];
            if self.any_takes(&overloads, &args) {
                let (id, args) = self.choose(sign(op), span, &overloads, args)?;
                let ty = id.signature().result.to_type(self.node, Some(&object.ty));
                return Some(Expr {
                    kind: ExprKind::LibraryMethod(id, Box::new(object), args),
                    ty,
                    span,
                });
            }
            let arg = args.into_iter().next()?;
            let (left, right) = if is_swapped {
                (arg, object)
            } else {
                (object, arg)
            };
            self.report_operands(op, &left, &right, span);
        } else {
            self.report_operands(op, &object, &arg, span);
        }
        None
    }

    pub(super) fn report_operands(&mut self, op: BinaryOp, left: &Expr, right: &Expr, span: Span) {
        let (a, b) = (self.type_name(&left.ty), self.type_name(&right.ty));
        let message = format!("`{}` does not work on `{a}` and `{b}`", sign(op));
        let mut fault = Diagnostic::error("bad-operands", span, message)
            .also(left.span, format!("this is `{a}`"));
        fault = fault.also(right.span, format!("this is `{b}`"));
        if left.ty == Type::Object || right.ty == Type::Object {
            fault = fault.hint("cast the `Object` to what it is, such as `(Integer) x`");
        }
        self.report(fault);
    }

    /// Prefix operators.
    pub(super) fn unary(&mut self, op: UnaryOp, operand: &ast::Expr, span: Span) -> Option<Expr> {
        let operand = self.value(operand)?;
        if op == UnaryOp::Not {
            let operand = self.boolean(operand)?;
            return Some(Expr {
                kind: ExprKind::Not(Box::new(operand)),
                ty: Type::Boolean,
                span,
            });
        }
        if let (UnaryOp::Minus, Type::Class(ClassId::Vector3d)) = (op, &operand.ty) {
            let minus_one = Expr {
                kind: ExprKind::Constant(Constant::Double(-1.0)),
                ty: Type::Double,
                span,
            };
            let ty = operand.ty.clone();
            let kind =
                ExprKind::LibraryMethod(MethodId::VectorTimes, Box::new(operand), vec![minus_one]);
            return Some(Expr { kind, ty, span });
        }
        let operand = self.unbox(operand);
        let works = if op == UnaryOp::Complement {
            is_integral(&operand.ty)
        } else {
            is_numeric(&operand.ty)
        };
        if !works {
            let sign = match op {
                UnaryOp::Plus => "+",
                UnaryOp::Minus => "-",
                UnaryOp::Not => "!",
                UnaryOp::Complement => "~",
            };
            let message = format!(
                "`{sign}` does not work on `{}`",
                self.type_name(&operand.ty)
            );
            self.report(Diagnostic::error("bad-operands", span, message));
            return None;
        }
        let ty = promote(&operand.ty);
        let operand = self.convert(operand, &ty);
        let kind = match op {
            UnaryOp::Minus => ExprKind::Negate(Box::new(operand)),
            UnaryOp::Complement => ExprKind::Complement(Box::new(operand)),
            UnaryOp::Plus | UnaryOp::Not => return Some(operand),
        };
        Some(Expr { kind, ty, span })
    }
}

/// Text of both, with the parts of either side in one row.
fn concat(left: Expr, right: Expr, span: Span) -> Expr {
    let mut parts = match left.kind {
        ExprKind::Concat(parts) => parts,
        kind => vec![Expr { kind, ..left }],
    };
    match right.kind {
        ExprKind::Concat(more) => parts.extend(more),
        kind => parts.push(Expr { kind, ..right }),
    }
    Expr {
        kind: ExprKind::Concat(parts),
        ty: Type::String,
        span,
    }
}
