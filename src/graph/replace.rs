//! Putting copies of templates in the place of nodes, for all matches of a step at once.

use super::arena::{MIN_SHARE, NIL, extend};
use super::extents::Extents;
use super::links::{Link, Links};
use super::store::{CONSUMED, Graph, GraphError, Header, INSERTED, MOST_NODES, MOST_WORDS};
use super::template::{Batch, Template};
use super::{NodeId, Payload, TypeId};

/// Which places new nodes get: vacant ones first, those vacated last first, then new ones.
struct Places {
    free: Vec<u32>,
    n_nodes: usize,
}

impl Places {
    /// The place of a node by its number among all new ones.
    fn of(&self, number: usize) -> u32 {
        match self.free.len().checked_sub(number + 1) {
            Some(at) => self.free[at],
            None => (self.n_nodes + number - self.free.len()) as u32,
        }
    }
}

/// A batch under way.
struct Copying<'a> {
    batch: &'a Batch,
    /// Number of its first node among all new ones.
    first: usize,
    /// The template's nodes, made ready.
    parts: Vec<Part>,
}

/// A node of a template, made ready for copying. Other nodes are told by their numbers in the template.
struct Part {
    type_id: TypeId,
    flags: u16,
    /// Where its words begin in those of the template; [`NIL`] if it has none.
    first_word: u32,
    first_out: u32,
    link: Link,
    /// Place in the extent of the copy for the first match, and how far before it the one for the next match is.
    extent_place: u32,
    extent_stride: u32,
}

impl Copying<'_> {
    fn template(&self) -> &Template {
        &self.batch.template
    }

    /// The header of node `part` of match `number`; `place` tells the places of the nodes of this match.
    #[inline]
    fn header(&self, number: usize, part: usize, words: u32, place: impl Fn(u32) -> u32) -> Header {
        let part = &self.parts[part];
        let placed = |part: u32| if part == NIL { NIL } else { place(part) };
        Header {
            type_id: part.type_id,
            flags: part.flags,
            generation: 0,
            words,
            first_out: placed(part.first_out),
            link: Link {
                from: placed(part.link.from),
                next_out: placed(part.link.next_out),
                previous_out: place(part.link.previous_out),
            },
            extent_place: part.extent_place - number as u32 * part.extent_stride,
        }
    }
}

/// The nodes of a template for `n_matches` matches, made ready; `starts` tells where the copies of each type begin in
/// its extent.
fn ready(template: &Template, n_matches: usize, starts: &[usize]) -> Vec<Part> {
    let or_nil = |part: Option<u32>| part.unwrap_or(NIL);
    let parts = template.parts.iter().map(|part| {
        let entry = part.entry as usize;
        let n_same = template.by_type[entry].1.len();
        let last = (n_matches * n_same).saturating_sub(1 + part.rank as usize);
        Part {
            type_id: part.type_id,
            flags: part.flags,
            first_word: if part.n_words == 0 {
                NIL
            } else {
                part.first_word
            },
            first_out: or_nil(part.first_out),
            link: Link {
                from: or_nil(part.parent),
                next_out: or_nil(part.next_out),
                previous_out: part.previous_out,
            },
            extent_place: (starts[entry] + last) as u32,
            extent_stride: n_same as u32,
        }
    });
    parts.collect()
}

impl<O: Payload> Graph<O> {
    /// Whether [`Graph::replace`] can do these batches: all that is replaced is still there and has a parent, and the graph
    /// is a forest in which everything hangs on the root.
    pub(crate) fn can_replace(&self, batches: &[Batch]) -> bool {
        let is_fit = |node: &NodeId| {
            self.live_index(*node).is_ok_and(|index| {
                let header = &self.nodes[index];
                header.flags & (INSERTED | CONSUMED) == INSERTED | CONSUMED
                    && header.link.from != NIL
            })
        };
        let mut matched = batches.iter().flat_map(|batch| &batch.matched);
        self.candidates.is_empty() && self.is_forest() && matched.all(is_fit)
    }

    /// Replaces all matched nodes, see [`Graph::can_replace`]. They count as consumed.
    ///
    /// The lists of edges become what making edge by edge gives: a new node has what its predecessor led to, last child
    /// first, before its own branches; a node that stays gets its new children at the end, those of the last match first.
    pub(crate) fn replace(&mut self, batches: &[Batch]) {
        let places = Places {
            free: std::mem::take(&mut self.free_nodes),
            n_nodes: self.nodes.len(),
        };
        self.leave_extents(batches);
        let copyings = self.plan_copies(batches);
        for copying in &copyings {
            self.copy(copying, &places);
        }
        let n_new: usize = batches.iter().map(Batch::n_nodes).sum();
        let (nodes, links, extents) = (&mut self.nodes, &mut self.links, &mut self.extents);
        let mut link = || embed(nodes, links, &copyings, &places);
        let mut enter = || enter_extents(extents, &copyings, &places);
        if n_new < MIN_SHARE {
            link();
            enter();
        } else {
            rayon::join(link, enter);
        }
        self.free_nodes = places.free;
        let n_left = self.free_nodes.len().saturating_sub(n_new);
        self.free_nodes.truncate(n_left);
        for batch in batches {
            for node in &batch.matched {
                self.bury(node.index());
            }
        }
        self.touch(true);
    }

    /// Takes all that is replaced out of the extents; instead of its place there each node knows its number then.
    fn leave_extents(&mut self, batches: &[Batch]) {
        let matched = batches.iter().flat_map(|batch| &batch.matched);
        for (number, node) in matched.enumerate() {
            let header = &mut self.nodes[node.index()];
            self.extents.vacate(header.type_id, header.extent_place);
            header.extent_place = number as u32;
        }
        self.extents.close_gaps(&mut self.nodes);
    }

    /// Gives each batch its numbers and its places in the extents: the last batch enters them first.
    fn plan_copies<'a>(&self, batches: &'a [Batch]) -> Vec<Copying<'a>> {
        let mut ends = vec![0; self.types().len()];
        let mut copyings: Vec<Copying<'a>> = Vec::with_capacity(batches.len());
        let mut after = batches.iter().map(Batch::n_nodes).sum::<usize>();
        for batch in batches.iter().rev() {
            after -= batch.n_nodes();
            let n_matches = batch.matched.len();
            let starts = batch.template.by_type.iter().map(|(ty, same)| {
                let end = &mut ends[usize::from(ty.0)];
                let start = self.extents.n_places_of(*ty) + *end;
                *end += same.len() * n_matches;
                start
            });
            let starts: Vec<usize> = starts.collect();
            copyings.push(Copying {
                batch,
                first: after,
                parts: ready(&batch.template, n_matches, &starts),
            });
        }
        copyings.reverse();
        copyings
    }

    /// Writes the nodes of a batch: those that get vacant places one by one, the others in parallel.
    fn copy(&mut self, copying: &Copying<'_>, places: &Places) {
        let template = copying.template();
        let (n_parts, n_words) = (template.n_nodes(), template.n_words());
        let n_matches = copying.batch.matched.len();
        let n_vacant = places.free.len().saturating_sub(copying.first);
        let n_single = n_vacant.div_ceil(n_parts).min(n_matches);
        for number in 0..n_single {
            self.copy_one(copying, number, places);
        }
        let n_bulk = n_matches - n_single;
        let given = |number: usize| copying.batch.given(n_single + number);
        let first_word = self.words.append(n_bulk, n_words, |number, word| {
            template.word(word, given(number))
        });
        let first_node = self.nodes.len() as u32;
        extend(&mut self.nodes, n_bulk, n_parts, |number, part| {
            let base = first_node + (number * n_parts) as u32;
            let words = match copying.parts[part].first_word {
                NIL => 0,
                word => first_word + (number * n_words) as u32 + word,
            };
            copying.header(n_single + number, part, words, |part| base + part)
        });
    }

    /// Writes the nodes of one match.
    fn copy_one(&mut self, copying: &Copying<'_>, number: usize, places: &Places) {
        let template = copying.template();
        let first = copying.first + number * template.n_nodes();
        let given = copying.batch.given(number);
        let mut block = vec![];
        for (index, part) in template.parts.iter().enumerate() {
            block.clear();
            let words = part.first_word..part.first_word + part.n_words;
            block.extend(words.map(|word| template.word(word as usize, given)));
            let words = self.words.allocate(&block);
            let mut header = copying.header(number, index, words, |part| {
                places.of(first + part as usize)
            });
            let place = places.of(first + index) as usize;
            if place == self.nodes.len() {
                self.nodes.push(header);
            } else {
                header.generation = self.nodes[place].generation;
                self.nodes[place] = header;
            }
        }
    }

    /// Frees a node whose edges and place in the extent are others' already.
    fn bury(&mut self, index: usize) {
        self.release_fields(index);
        let header = &mut self.nodes[index];
        let n_words = self.types[header.type_id].template().len();
        self.words.release(header.words, n_words);
        *header = Header {
            generation: header.generation.wrapping_add(1),
            ..Header::VACANT
        };
        self.free_nodes.push(index as u32);
    }

    /// Whether so many more nodes and words have room.
    pub(crate) fn has_room(&self, n_nodes: usize, n_words: usize) -> bool {
        self.n_nodes() + n_nodes <= self.limit().min(MOST_NODES)
            && self.words.len() + n_words <= MOST_WORDS
    }

    /// A new node like a node of a template; queries do not find it yet.
    pub(crate) fn create_part(
        &mut self,
        template: &Template,
        part: u32,
        given: &[u32],
    ) -> Result<NodeId, GraphError> {
        let part = &template.parts[part as usize];
        let node = self.create(part.type_id)?;
        let words = self.nodes[node.index()].words;
        for i in 0..part.n_words {
            let word = template.word((part.first_word + i) as usize, given);
            self.words.set(words + i, word);
        }
        Ok(node)
    }
}

/// Adds the copies to the extents, those of the last batch first.
fn enter_extents(extents: &mut Extents, copyings: &[Copying<'_>], places: &Places) {
    for copying in copyings.iter().rev() {
        let (n_parts, n_matches) = (copying.template().n_nodes(), copying.batch.matched.len());
        for (ty, same) in &copying.template().by_type {
            extents.append(*ty, n_matches, same.len(), |before, rank| {
                let (number, rank) = (n_matches - 1 - before, same.len() - 1 - rank);
                places.of(copying.first + number * n_parts + same[rank] as usize)
            });
        }
    }
}

/// Links the copies to what surrounds them, and to each other.
fn embed(nodes: &mut [Header], links: &mut Links, copyings: &[Copying<'_>], places: &Places) {
    let mut ends = vec![];
    for copying in copyings {
        let (n_parts, last) = (copying.template().n_nodes(), copying.template().last);
        ends.extend((0..copying.batch.matched.len()).map(|number| {
            let first = copying.first + number * n_parts;
            (places.of(first), places.of(first + last as usize))
        }));
        links.n_edges += copying.batch.n_nodes() - copying.batch.matched.len();
    }
    let matched = || copyings.iter().flat_map(|copying| &copying.batch.matched);
    for (node, &(_, last)) in matched().zip(&ends) {
        let mut at = nodes[node.index()].first_out;
        while at != NIL {
            let Header {
                flags,
                link,
                extent_place,
                ..
            } = nodes[at as usize];
            let child = if flags & CONSUMED == 0 {
                at
            } else {
                let child = ends[extent_place as usize].0;
                links.move_bits(nodes, at, child);
                child
            };
            Links::prepend(nodes, last, child);
            at = link.next_out;
        }
    }
    let matched = copyings
        .iter()
        .rev()
        .flat_map(|copying| copying.batch.matched.iter().rev());
    for (node, &(first, _)) in matched.zip(ends.iter().rev()) {
        let at = node.index() as u32;
        let parent = nodes[node.index()].link.from;
        if nodes[parent as usize].flags & CONSUMED == 0 {
            links.leave_out_list(nodes, at);
            links.move_bits(nodes, at, first);
            links.enter_out_list(nodes, parent, first);
        }
    }
}
