//! Variables of the model and their initializers.

use super::Checker;
use super::coerce::int_constant;
use super::constant;
use super::context::{Body, Context};
use super::declaration::StaticSource;
use super::model::{Expr, ExprKind, Static, StaticId, Type};

impl Checker<'_> {
    /// The variables in order of initialization. Whether they are constant is known only after all bodies.
    pub(super) fn statics(&mut self) -> Vec<Static> {
        (0..self.statics.len())
            .map(|index| self.static_variable(index))
            .collect()
    }

    fn static_variable(&mut self, index: usize) -> Static {
        let info = &self.statics[index];
        let (name, ty, source, is_final) = (
            info.name.to_owned(),
            info.ty.clone(),
            info.source,
            info.is_final,
        );
        let (file, owner, span) = (info.file, info.owner, info.span);
        self.cx = Context::new(file, None);
        self.cx.owner = owner;
        let init = match source {
            StaticSource::Written(field) => field.init.as_ref().and_then(|init| match &ty {
                Some(ty) => self.initial_value(init, ty),
                None => self.expr(init).and(None),
            }),
            StaticSource::Initializer(method) => {
                // The block runs for its effect; the variable that stands for it is never read.
                let kind = ExprKind::Call {
                    method,
                    receiver: None,
                    args: vec![],
                    is_virtual: false,
                };
                let call = Expr {
                    kind,
                    ty: Type::Void,
                    span,
                };
                let kind = ExprKind::Comma(vec![call, int_constant(0, span)]);
                self.cx.facts.runs.push(Body::Method(method));
                Some(Expr {
                    kind,
                    ty: Type::Int,
                    span,
                })
            }
        };
        if is_final && let Some(value) = init.as_ref().and_then(constant::value_of) {
            self.static_values.insert(StaticId(index as u32), value);
        }
        self.check_frame();
        let frame = std::mem::take(&mut self.cx.frame);
        Static {
            name,
            ty: ty.unwrap_or(Type::Object),
            init,
            frame,
            is_constant: false,
        }
    }
}
