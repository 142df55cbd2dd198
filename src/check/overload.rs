//! Choosing among overloads, by Java's phases: first without, then with `double` for `float` and boxing, then as text.

use super::Checker;
use super::model::{Expr, ExprKind, Type};
use super::types::{Fit, is_primitive, unboxed};
use crate::diag::{Diagnostic, Span};
use crate::graph::{FieldId, TypeId};
use crate::library::{Signature, ValueType};
use std::borrow::Cow;

/// What one parameter takes.
#[derive(Clone, Debug)]
pub(super) enum Wanted {
    Value(Type),
    /// What a boxed type can hold, or such a number that can become one: `add(1)` of an `ArrayList<Float>`.
    Boxed(Type),
    /// Anything, as its text.
    Text,
    /// Its type could not be read; anything fits.
    Unknown,
}

/// An overload.
#[derive(Clone, Debug)]
pub(super) struct Overload<Id> {
    pub(super) id: Id,
    pub(super) params: Vec<Wanted>,
    /// Names of the parameters, for messages.
    pub(super) names: Vec<Cow<'static, str>>,
    /// Whether the last parameter is an array that may be given element by element.
    pub(super) is_varargs: bool,
}

impl<Id: Copy> Overload<Id> {
    /// The row of a library table as an overload; of a method with the type of its receiver.
    pub(super) fn of_signature(
        id: Id,
        row: &Signature,
        checker: &Checker<'_>,
        of: Option<&Type>,
    ) -> Self {
        let params = row.params.iter().map(|param| match param {
            ValueType::Text => Wanted::Text,
            value => match value.to_type(checker.node, of) {
                ty if matches!(value, ValueType::Argument(_)) && unboxed(&ty).is_some() => {
                    Wanted::Boxed(ty)
                }
                ty => Wanted::Value(ty),
            },
        });
        Self {
            id,
            params: params.collect(),
            names: row.names.iter().map(|&name| Cow::Borrowed(name)).collect(),
            is_varargs: row.params.last() == Some(&ValueType::Objects),
        }
    }
}

impl Checker<'_> {
    /// Names of fields as people speak of them.
    pub(super) fn field_names(&self, ty: TypeId, fields: &[FieldId]) -> Vec<Cow<'static, str>> {
        let name = |field: &FieldId| match &*self.types[ty].fields[usize::from(field.0)].name {
            "width.full" => Cow::Borrowed("width"),
            name => Cow::Owned(name.rsplit('.').next().unwrap_or(name).to_owned()),
        };
        fields.iter().map(name).collect()
    }

    /// The overload that suits the arguments best, with the arguments converted; reported if there is none.
    pub(super) fn choose<Id: Copy>(
        &mut self,
        name: &str,
        span: Span,
        overloads: &[Overload<Id>],
        args: Vec<Expr>,
    ) -> Option<(Id, Vec<Expr>)> {
        for phase in [Fit::Direct, Fit::Loose, Fit::Text] {
            let fitting: Vec<&Overload<Id>> = overloads
                .iter()
                .filter(|o| self.takes(o, &args).is_some_and(|worst| worst <= phase))
                .collect();
            if let Some(best) = self.most_specific(&fitting) {
                let args = self.pass(best, args);
                return Some((best.id, args));
            }
        }
        let fault = self.no_overload(name, span, overloads, &args);
        self.report(fault);
        None
    }

    /// Whether some overload takes these arguments.
    pub(super) fn any_takes<Id>(&self, overloads: &[Overload<Id>], args: &[Expr]) -> bool {
        overloads.iter().any(|o| self.takes(o, args).is_some())
    }

    /// How well the worst argument fits; `None` if the overload does not take them.
    fn takes<Id>(&self, overload: &Overload<Id>, args: &[Expr]) -> Option<Fit> {
        if overload.params.len() == args.len() {
            let mut fits = overload
                .params
                .iter()
                .zip(args)
                .map(|(param, arg)| self.param_fit(param, &arg.ty));
            let worst = fits.try_fold(Fit::Direct, |worst, fit| Some(worst.max(fit?)));
            if worst.is_some() {
                return worst;
            }
        }
        self.spread(overload, args).then_some(Fit::Text)
    }

    /// Whether the last arguments are the elements of the last parameter.
    fn spread<Id>(&self, overload: &Overload<Id>, args: &[Expr]) -> bool {
        let Some((Wanted::Value(Type::Array(element)), first)) = overload.params.split_last()
        else {
            return false;
        };
        overload.is_varargs
            && args.len() >= first.len()
            && first
                .iter()
                .zip(args)
                .all(|(param, arg)| match self.param_fit(param, &arg.ty) {
                    // A value is not made a text where another overload may take it as it is.
                    Some(Fit::Text) => matches!(param, Wanted::Text),
                    fit => fit.is_some(),
                })
            && args[first.len()..]
                .iter()
                .all(|arg| self.fit(&arg.ty, element).is_some())
    }

    fn param_fit(&self, param: &Wanted, arg: &Type) -> Option<Fit> {
        match param {
            // As in GroIMP, any value can be passed where a text is wanted.
            Wanted::Value(Type::String) if *arg != Type::Void => {
                Some(self.fit(arg, &Type::String).unwrap_or(Fit::Text))
            }
            Wanted::Value(ty) => self.fit(arg, ty),
            Wanted::Boxed(ty) => self.fit(arg, ty).or_else(|| self.fit(arg, &unboxed(ty)?)),
            Wanted::Text if *arg == Type::Void => None,
            Wanted::Text => Some(Fit::Text),
            Wanted::Unknown => Some(Fit::Direct),
        }
    }

    /// The overload whose parameters all fit those of every other; else the first.
    fn most_specific<'o, Id>(&self, fitting: &[&'o Overload<Id>]) -> Option<&'o Overload<Id>> {
        let beats = |a: &Overload<Id>, b: &Overload<Id>| {
            a.params.len() == b.params.len()
                && a.params.iter().zip(&b.params).all(|(x, y)| match (x, y) {
                    (Wanted::Value(x), Wanted::Value(y)) => self.fit(x, y) == Some(Fit::Direct),
                    (Wanted::Text, Wanted::Value(_)) => false,
                    _ => true,
                })
        };
        let best = fitting.iter().find(|a| fitting.iter().all(|b| beats(a, b)));
        best.or(fitting.first()).copied()
    }

    /// The arguments as the overload wants them.
    fn pass<Id>(&self, overload: &Overload<Id>, mut args: Vec<Expr>) -> Vec<Expr> {
        let is_spread = overload.is_varargs
            && !(args.len() == overload.params.len()
                && overload
                    .params
                    .iter()
                    .zip(&args)
                    .all(|(param, arg)| self.param_fit(param, &arg.ty).is_some()));
        if is_spread
            && let Some((Wanted::Value(ty @ Type::Array(element)), first)) =
                overload.params.split_last()
        {
            let rest = args.split_off(first.len());
            let span = rest.first().map_or_else(Span::default, |e| e.span);
            let rest = rest
                .into_iter()
                .map(|arg| self.convert(arg, element))
                .collect();
            args.push(Expr {
                kind: ExprKind::ArrayLiteral(rest),
                ty: ty.clone(),
                span,
            });
        }
        let pass_one = |(param, arg): (&Wanted, Expr)| match param {
            Wanted::Value(Type::String) if self.fit(&arg.ty, &Type::String).is_none() => {
                self.text(arg)
            }
            Wanted::Value(ty) => self.convert(arg, ty),
            Wanted::Boxed(ty) => match unboxed(ty) {
                Some(number) if is_primitive(&arg.ty) => {
                    let number = self.convert(arg, &number);
                    self.convert(number, ty)
                }
                _ => self.convert(arg, ty),
            },
            Wanted::Text => self.text(arg),
            Wanted::Unknown => arg,
        };
        overload.params.iter().zip(args).map(pass_one).collect()
    }

    /// Why no overload fits, said as closely as can be.
    fn no_overload<Id>(
        &self,
        name: &str,
        span: Span,
        overloads: &[Overload<Id>],
        args: &[Expr],
    ) -> Diagnostic {
        let mut of_this_length = overloads.iter().filter(|o| o.params.len() == args.len());
        let (candidate, is_clear) = (of_this_length.next(), of_this_length.next().is_none());
        if let Some(only) = candidate.filter(|_| is_clear) {
            let mut pairs = only.params.iter().zip(args).enumerate();
            let bad = pairs.find(|(_, (param, arg))| self.param_fit(param, &arg.ty).is_none());
            if let Some((at, (Wanted::Value(ty) | Wanted::Boxed(ty), arg))) = bad {
                let fault = self.mismatch(&arg.ty, ty, arg.span);
                return match only.names.get(at) {
                    Some(param) => fault.hint(format!(
                        "it is the `{param}` of `{}`",
                        self.form(name, only)
                    )),
                    None => fault,
                };
            }
        }
        let message = if args.is_empty() {
            format!("`{name}` needs arguments")
        } else if candidate.is_none() {
            wrong_count(name, overloads, args.len())
        } else {
            let given = self.type_names(args.iter().map(|a| &a.ty));
            format!("`{name}` does not take ({given})")
        };
        let forms: Vec<String> = overloads
            .iter()
            .take(8)
            .map(|o| format!("`{}`", self.form(name, o)))
            .collect();
        Diagnostic::error("wrong-arguments", span, message)
            .hint(format!("it can be called as {}", forms.join(", ")))
    }

    /// An overload as it is declared: `F(float length, float diameter)`.
    fn form<Id>(&self, name: &str, overload: &Overload<Id>) -> String {
        let ty = |param: &Wanted| match param {
            Wanted::Value(ty) | Wanted::Boxed(ty) => self.type_name(ty),
            Wanted::Text => "any".into(),
            Wanted::Unknown => "?".into(),
        };
        let named = |(at, param)| match overload.names.get(at) {
            Some(name) => format!("{} {name}", ty(param)),
            None => ty(param),
        };
        let params = overload.params.iter().enumerate().map(named);
        format!("{name}({})", params.collect::<Vec<_>>().join(", "))
    }
}

/// `F` takes 0 to 3 arguments, 4 are given.
fn wrong_count<Id>(name: &str, overloads: &[Overload<Id>], given: usize) -> String {
    let counts = || overloads.iter().map(|o| o.params.len());
    let (least, most) = (
        counts().min().unwrap_or_default(),
        counts().max().unwrap_or_default(),
    );
    let takes = match (least, most) {
        (0, 0) => "no arguments".to_owned(),
        (1, 1) => "1 argument".to_owned(),
        (least, most) if least == most => format!("{least} arguments"),
        (0, 1) => "at most 1 argument".to_owned(),
        (least, most) if counts().all(|n| n == least || n == most) => {
            format!("{least} or {most} arguments")
        }
        (0, most) => format!("at most {most} arguments"),
        (least, most) => format!("{least} to {most} arguments"),
    };
    let given = match given {
        1 => "1 is given".to_owned(),
        n => format!("{n} are given"),
    };
    format!("`{name}` takes {takes}, {given}")
}
