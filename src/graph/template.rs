//! Replacing many nodes by copies of one small tree at once.
//!
//! A [`Template`] is what a right-hand side without code makes for every match; a [`Batch`] holds the matches and the
//! numbers that differ between them. All that one step makes is then known before anything is written: how many nodes of
//! which type, and which node gets which place. So new nodes are written in bulk, in parallel, and the result is the same
//! for any number of threads, and the same as that of making node by node.

use super::links::{flags_bits, link_flags};
use super::store::{INSERTED, LIVE};
use super::{EdgeBits, FieldId, NodeId, Storage, TypeId, TypeTable};
use std::sync::Arc;

/// A word of a new node.
#[derive(Clone, Copy, Debug)]
pub(super) enum Word {
    /// The same in all copies.
    Fixed(u32),
    /// Number of the word among those that a match gives.
    Given(u32),
}

/// A node of a template.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) type_id: TypeId,
    /// Flags of the header, those of the incoming edge included.
    pub(super) flags: u16,
    /// The node it hangs on; none for the first.
    pub(super) parent: Option<u32>,
    pub(super) first_out: Option<u32>,
    pub(super) next_out: Option<u32>,
    /// The last child of the same parent for the first one, else the one before.
    pub(super) previous_out: u32,
    /// Where its words begin among those of the template.
    pub(super) first_word: u32,
    pub(super) n_words: u32,
    /// Entry of [`Template::by_type`], and which of the nodes there it is.
    pub(super) entry: u32,
    pub(super) rank: u32,
}

/// A tree that takes the place of a node: what led to that leads to its first node then, and what that led to hangs on
/// its last one.
#[derive(Clone, Debug)]
pub struct Template {
    pub(super) parts: Vec<Part>,
    words: Vec<Word>,
    /// Each type with its nodes, in order.
    pub(super) by_type: Vec<(TypeId, Vec<u32>)>,
    pub(super) last: u32,
    n_given: u32,
}

impl Template {
    /// A template of one node of type `ty`.
    pub fn new(types: &TypeTable, ty: TypeId) -> Self {
        let mut template = Self {
            parts: vec![],
            words: vec![],
            by_type: vec![],
            last: 0,
            n_given: 0,
        };
        template.push_part(types, ty, None, LIVE | INSERTED);
        template
    }

    /// Hangs another node on an earlier one and returns its number; `None` for kinds of edges that have no short form.
    pub fn add(
        &mut self,
        types: &TypeTable,
        ty: TypeId,
        parent: u32,
        bits: EdgeBits,
    ) -> Option<u32> {
        let flags = LIVE | INSERTED | link_flags(bits)?;
        let new = self.parts.len() as u32;
        self.push_part(types, ty, Some(parent), flags);
        match self.parts[parent as usize].first_out {
            None => self.parts[parent as usize].first_out = Some(new),
            Some(first) => {
                let first = &mut self.parts[first as usize];
                let before = std::mem::replace(&mut first.previous_out, new);
                self.parts[new as usize].previous_out = before;
                self.parts[before as usize].next_out = Some(new);
            }
        }
        Some(new)
    }

    fn push_part(&mut self, types: &TypeTable, ty: TypeId, parent: Option<u32>, flags: u16) {
        let new = self.parts.len() as u32;
        let known = self.by_type.iter().position(|(known, _)| *known == ty);
        let entry = known.unwrap_or_else(|| {
            self.by_type.push((ty, vec![]));
            self.by_type.len() - 1
        });
        let same = &mut self.by_type[entry].1;
        let template = types[ty].template();
        self.parts.push(Part {
            type_id: ty,
            flags,
            parent,
            first_out: None,
            next_out: None,
            previous_out: new,
            first_word: self.words.len() as u32,
            n_words: template.len() as u32,
            entry: entry as u32,
            rank: same.len() as u32,
        });
        same.push(new);
        self.words
            .extend(template.iter().map(|&word| Word::Fixed(word)));
    }

    /// Says on which node hangs what the replaced node led to.
    pub fn set_last(&mut self, last: u32) {
        self.last = last;
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.parts.len()
    }

    /// Words that each match gives.
    pub fn n_given(&self) -> usize {
        self.n_given as usize
    }

    /// Words of a copy.
    pub fn n_words(&self) -> usize {
        self.words.len()
    }

    /// Type of a node.
    pub(crate) fn type_of(&self, node: u32) -> TypeId {
        self.parts[node as usize].type_id
    }

    /// The node it hangs on, and by what edge.
    pub(crate) fn parent(&self, node: u32) -> Option<(u32, EdgeBits)> {
        let part = &self.parts[node as usize];
        let bits = flags_bits(part.flags);
        part.parent.map(|parent| (parent, bits))
    }

    /// The node on which hangs what the replaced node led to.
    pub(crate) fn last(&self) -> u32 {
        self.last
    }

    fn field_words(&self, types: &TypeTable, node: u32, field: FieldId) -> Option<(usize, usize)> {
        let part = &self.parts[node as usize];
        let declared = types[part.type_id].fields.get(usize::from(field.0))?;
        match declared.storage {
            Storage::Words(offset) => Some((
                part.first_word as usize + usize::from(offset),
                declared.kind.words(),
            )),
            Storage::Side => None,
        }
    }

    /// Fills a field with the same words in all copies; `None` for rare fields.
    pub fn fix(
        &mut self,
        types: &TypeTable,
        node: u32,
        field: FieldId,
        words: [u32; 2],
    ) -> Option<()> {
        let (at, n) = self.field_words(types, node, field)?;
        for (i, &word) in words[..n].iter().enumerate() {
            self.words[at + i] = Word::Fixed(word);
        }
        Some(())
    }

    /// Fills a field with words that each match gives; returns the number of the first. `None` for rare fields.
    pub fn give(&mut self, types: &TypeTable, node: u32, field: FieldId) -> Option<usize> {
        let (at, n) = self.field_words(types, node, field)?;
        let first = self.n_given;
        for i in 0..n {
            self.words[at + i] = Word::Given(self.n_given);
            self.n_given += 1;
        }
        Some(first as usize)
    }

    /// A word of a copy.
    pub(super) fn word(&self, at: usize, given: &[u32]) -> u32 {
        match self.words[at] {
            Word::Fixed(word) => word,
            Word::Given(number) => given[number as usize],
        }
    }
}

/// Matches whose nodes a template replaces, in order.
#[derive(Clone, Debug)]
pub struct Batch {
    /// What comes in their place.
    pub template: Arc<Template>,
    /// The nodes that are replaced.
    pub matched: Vec<NodeId>,
    /// The words that each gives, [`Template::n_given`] in a row.
    pub given: Vec<u32>,
}

impl Batch {
    /// A batch without matches.
    pub fn new(template: Arc<Template>) -> Self {
        Self {
            template,
            matched: vec![],
            given: vec![],
        }
    }

    /// Number of new nodes.
    pub fn n_nodes(&self) -> usize {
        self.matched.len() * self.template.n_nodes()
    }

    /// The words that a match gives.
    pub fn given(&self, number: usize) -> &[u32] {
        let n = self.template.n_given();
        &self.given[number * n..][..n]
    }
}
