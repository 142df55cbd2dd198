//! Loops.

use super::Scope;
use super::sequences::Turn;
use crate::check::model::{Sequence, Slot, Stmt, StmtKind};
use crate::diag::Span;
use crate::eval::code::{Eval, Exec, Flow};

impl Scope<'_> {
    /// `while`, `do` and `for (;;)`.
    pub(super) fn counted_loop(&self, s: &Stmt) -> Exec {
        let StmtKind::Loop {
            label,
            init,
            cond,
            is_do,
            update,
            body,
        } = &s.kind
        else {
            return Box::new(|_, _| Ok(Flow::Next));
        };
        let (own, is_do, span) = (*label, *is_do, s.span);
        let init = self.block(init);
        let cond = cond.as_ref().map(|c| self.boolean(c));
        let update: Vec<Eval<()>> = update.iter().map(|e| self.effect(e).into_void()).collect();
        let body = self.statement(body);
        Box::new(move |p, m| {
            init(p, m)?;
            let mut is_untested = is_do;
            loop {
                if !std::mem::take(&mut is_untested)
                    && let Some(cond) = &cond
                    && !cond.get(p, m)?
                {
                    return Ok(Flow::Next);
                }
                match body(p, m)? {
                    Flow::Next => {}
                    Flow::Continue(label) if label.means(own) => {}
                    Flow::Break(label) if label.means(own) => return Ok(Flow::Next),
                    flow => return Ok(flow),
                }
                for effect in &update {
                    effect(p, m)?;
                }
                m.tick(span)?;
            }
        })
    }

    /// `for (x : sequence)`.
    pub(super) fn for_each(
        &self,
        label: Option<u16>,
        slot: Option<Slot>,
        sequence: &Sequence,
        body: &Stmt,
        span: Span,
    ) -> Exec {
        let sequence = self.sequence(sequence, slot.map(|s| self.local(s)));
        let body = self.statement(body);
        Box::new(move |p, m| {
            let mut left_by = Flow::Next;
            sequence(p, m, &mut |p, m| {
                m.tick(span)?;
                match body(p, m)? {
                    Flow::Next => Ok(Turn::Next),
                    Flow::Continue(to) if to.means(label) => Ok(Turn::Next),
                    Flow::Break(to) if to.means(label) => Ok(Turn::Stop),
                    flow => {
                        left_by = flow;
                        Ok(Turn::Stop)
                    }
                }
            })?;
            Ok(left_by)
        })
    }
}
