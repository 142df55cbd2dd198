//! Rules and the blocks they stand in.

use super::Checker;
use super::model::{Arrow, Rule, Stmt, StmtKind};
use crate::syntax::ast::{self, RuleItem};

impl Checker<'_> {
    /// `[ … ]`: rules and code. Variables that code in braces declares can be used by what follows in the block.
    pub(super) fn rules(&mut self, items: &[RuleItem]) -> Vec<Stmt> {
        self.cx.facts.is_impure = true;
        self.cx.open();
        let mut checked = vec![];
        for item in items {
            match item {
                RuleItem::Rule(rule) => checked.extend(self.rule(rule)),
                RuleItem::Stmt(stmt) => match &stmt.kind {
                    ast::StmtKind::Block(block) => checked.extend(self.stmts(&block.stmts)),
                    _ => checked.extend(self.stmt(stmt)),
                },
            }
        }
        self.cx.close();
        checked
    }

    fn rule(&mut self, rule: &ast::Rule) -> Option<Stmt> {
        self.cx.open();
        let pattern = self.rule_pattern(&rule.lhs);
        let arrow = match rule.arrow {
            ast::Arrow::Lindenmayer => Arrow::Lindenmayer,
            ast::Arrow::Spo => Arrow::Spo,
            ast::Arrow::Execution => Arrow::Execution,
        };
        let rhs = self.whole_production(&rule.rhs);
        let exec = rule.exec.as_deref().and_then(|stmt| self.stmt(stmt));
        self.cx.close();
        let rule = Rule {
            pattern: pattern?.pattern,
            arrow,
            rhs,
            exec,
            span: rule.span,
        };
        let span = rule.span;
        Some(Stmt {
            kind: StmtKind::Rule(Box::new(rule)),
            span,
        })
    }
}
