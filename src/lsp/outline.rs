//! The declarations of a file as an editor's outline.

use super::symbols::{Symbol, SymbolKind};
use super::workspace::FileView;
use lsp_types::DocumentSymbol;

/// The outline: members below their modules.
pub fn outline(file: &FileView) -> Vec<DocumentSymbol> {
    let mut found: Vec<DocumentSymbol> = vec![];
    for symbol in &file.symbols {
        let entry = entry(file, symbol);
        let owner = symbol.owner.as_deref();
        let parent = found
            .iter_mut()
            .rev()
            .find(|parent| Some(parent.name.as_str()) == owner);
        match parent {
            Some(parent) => parent.children.get_or_insert_default().push(entry),
            None => found.push(entry),
        }
    }
    found
}

#[allow(
    deprecated,
    reason = "the protocol's type has a field that is no longer used"
)]
fn entry(file: &FileView, symbol: &Symbol) -> DocumentSymbol {
    let range = |span: crate::diag::Span| {
        file.lines
            .range(&file.text, span.start as usize..span.end as usize)
    };
    let kind = match symbol.kind {
        SymbolKind::Module | SymbolKind::Class => lsp_types::SymbolKind::CLASS,
        SymbolKind::Method if symbol.owner.is_some() => lsp_types::SymbolKind::METHOD,
        SymbolKind::Method => lsp_types::SymbolKind::FUNCTION,
        SymbolKind::Field => lsp_types::SymbolKind::FIELD,
        SymbolKind::Variable => lsp_types::SymbolKind::VARIABLE,
    };
    DocumentSymbol {
        name: symbol.name.clone(),
        detail: Some(symbol.signature.clone()),
        kind,
        tags: None,
        deprecated: None,
        range: range(symbol.span.to(symbol.name_span)),
        selection_range: range(symbol.name_span),
        children: None,
    }
}
