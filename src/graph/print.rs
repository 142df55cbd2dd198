//! Texts and digests of a graph for `derive`.

use super::walk::Event;
use super::{EdgeBits, FieldId, FieldKind, Graph, NodeId, Payload};
use std::fmt::Write as _;

impl<O: Payload> Graph<O> {
    /// The graph as a bracketed string, as in the literature on L-systems: `F(1)[RU(30)A(2)]A(3)`.
    ///
    /// A blank keeps two names apart that would run together. Branches stand in `[ ]`. Where a node has several successors each stands in `( )`; what hangs by another edge
    /// stands in `{ }`. A node with several parents is written where it is first met, afterwards as its name and `'`.
    /// The root itself is left out. Parameters are those of the constructor.
    pub fn string_text(&self) -> String {
        let mut text = String::new();
        let mut open = vec![];
        self.walk(self.root(), |event| match event {
            Event::Node(node) if node == self.root() => {}
            Event::Node(node) => {
                separate(&mut text);
                self.write_node(node, &mut text);
            }
            Event::Again(node) => {
                separate(&mut text);
                self.write_name(node, &mut text);
                text.push('\'');
            }
            Event::Open(bits) => {
                let (left, right) = brackets(bits);
                text.push(left);
                open.push(right);
            }
            Event::Close => text.extend(open.pop()),
        });
        text
    }

    /// The graph one node per line: an axis straight down, what branches off indented under its node and marked `+`
    /// (further successors `>`, other edges `/`).
    pub fn tree_text(&self) -> String {
        let mut text = String::new();
        let mut depth = 0usize;
        let mut mark = ' ';
        self.walk(self.root(), |event| match event {
            Event::Node(node) | Event::Again(node) => {
                let indent = 2 * depth.min(DEEPEST_INDENT);
                if indent > 0 {
                    let _ = write!(text, "{:1$}{mark} ", "", indent - 2);
                }
                mark = ' ';
                self.write_node(node, &mut text);
                text.push_str(if matches!(event, Event::Again(_)) {
                    "'\n"
                } else {
                    "\n"
                });
            }
            Event::Open(bits) => {
                depth += 1;
                mark = match brackets(bits).0 {
                    '[' => '+',
                    '(' => '>',
                    _ => '/',
                };
            }
            Event::Close => depth -= 1,
        });
        text
    }

    /// Number of nodes of each type that has any, by name, in table order; the root is left out.
    pub fn counts(&self) -> Vec<(String, usize)> {
        let root_type = self.type_of(self.root()).ok();
        let types = self.types().iter().filter(|&(ty, _)| Some(ty) != root_type);
        let counted = types.map(|(ty, t)| (t.name.to_string(), self.count_exactly(ty)));
        counted.filter(|&(_, n)| n > 0).collect()
    }

    /// A number that two graphs share if they have the same nodes, fields and edges in the same order, wherever their
    /// nodes lie in memory, on any machine.
    pub fn digest(&self) -> u64 {
        let mut number_of = vec![0u64; self.nodes.len()];
        let mut next = 1;
        self.walk(self.root(), |event| {
            if let Event::Node(node) = event {
                number_of[node.index()] = next;
                next += 1;
            }
        });
        let mut digest = Digest(0);
        self.walk(self.root(), |event| match event {
            Event::Node(node) => self.digest_node(node, &number_of, &mut digest),
            Event::Again(node) => digest.number(number_of[node.index()]),
            Event::Open(bits) => digest.number(u64::from(bits.number())),
            Event::Close => digest.number(u64::MAX),
        });
        digest.0
    }

    fn digest_node(&self, node: NodeId, number_of: &[u64], digest: &mut Digest) {
        let Ok(ty) = self.type_of(node) else { return };
        let ty = &self.types()[ty];
        digest.text(&ty.name);
        for (i, field) in ty.fields.iter().enumerate() {
            let id = FieldId(i as u16);
            match (field.kind, self.peek_object(node, id)) {
                (FieldKind::Object, Ok(Some(object))) => match object.as_node() {
                    Some(other) if self.exists(other) => digest.number(number_of[other.index()]),
                    Some(_) | None => digest.text(&object.text()),
                },
                (FieldKind::Object, _) => digest.number(0),
                (FieldKind::Long, _) => digest.number(self.get_i64(node, id).unwrap_or(0) as u64),
                _ => digest.number(self.get_f64(node, id).unwrap_or(0.0).to_bits()),
            }
        }
    }

    fn write_name(&self, node: NodeId, text: &mut String) {
        if let Ok(ty) = self.type_of(node) {
            text.push_str(&self.types()[ty].name);
        }
    }

    /// Name and constructor arguments of a node: `F(1,0.1)`.
    pub fn node_text(&self, node: NodeId) -> String {
        let mut text = String::new();
        self.write_node(node, &mut text);
        text
    }

    /// Name and constructor arguments.
    fn write_node(&self, node: NodeId, text: &mut String) {
        self.write_name(node, text);
        let mut left = '(';
        for &field in self.shown_fields(node) {
            text.push(left);
            text.push_str(&self.field_text(node, field));
            left = ',';
        }
        if left == ',' {
            text.push(')');
        }
    }

    /// Fields of the shortest constructor that tells all: every field of the others has its first value.
    fn shown_fields(&self, node: NodeId) -> &[FieldId] {
        let Ok(ty) = self.type_of(node) else {
            return &[];
        };
        let constructors = &self.types()[ty].constructors;
        let tells_all = |shown: &[FieldId]| {
            let hidden = constructors
                .iter()
                .flatten()
                .filter(|field| !shown.contains(field));
            hidden.copied().all(|field| self.is_default(node, field))
        };
        let chosen = constructors.iter().find(|shown| tells_all(shown));
        chosen.or(constructors.last()).map_or(&[], Vec::as_slice)
    }

    fn is_default(&self, node: NodeId, field: FieldId) -> bool {
        let Ok(index) = self.live_index(node) else {
            return true;
        };
        let declared = self.field_of(index, field);
        match declared.kind {
            FieldKind::Object => matches!(self.peek_object(node, field), Ok(None)),
            _ => self
                .get_f64(node, field)
                .is_ok_and(|value| value == declared.default),
        }
    }

    /// The value of a field, as short as it can be said.
    fn field_text(&self, node: NodeId, field: FieldId) -> String {
        let Ok(index) = self.live_index(node) else {
            return String::new();
        };
        match self.field_of(index, field).kind {
            FieldKind::Boolean => self.get_bool(node, field).map(|v| v.to_string()),
            FieldKind::Char => self
                .get_i32(node, field)
                .map(|v| char::from_u32(v as u32).unwrap_or('?').to_string()),
            FieldKind::Byte | FieldKind::Short | FieldKind::Int | FieldKind::Long => {
                self.get_i64(node, field).map(|v| v.to_string())
            }
            FieldKind::Float => self.get_f32(node, field).map(|v| v.to_string()),
            FieldKind::Double => self.get_f64(node, field).map(|v| v.to_string()),
            FieldKind::Object => self.peek_object(node, field).map(|object| match object {
                Some(object) => match object.as_node() {
                    Some(other) => {
                        let mut name = String::new();
                        self.write_name(other, &mut name);
                        name
                    }
                    None => object.text(),
                },
                None => "null".to_owned(),
            }),
        }
        .unwrap_or_default()
    }
}

/// Deeper branches are not indented any further.
const DEEPEST_INDENT: usize = 40;

fn brackets(bits: EdgeBits) -> (char, char) {
    if bits.intersects(EdgeBits::SUCCESSOR) {
        ('(', ')')
    } else if bits.intersects(EdgeBits::BRANCH) {
        ('[', ']')
    } else {
        ('{', '}')
    }
}

/// A running digest: every number is mixed into the whole state (the finalizer of `SplitMix64`).
struct Digest(u64);

impl Digest {
    fn number(&mut self, number: u64) {
        let mut z = (self.0.rotate_left(23) ^ number).wrapping_add(0x9E37_79B9_7F4A_7C15);
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        self.0 = z ^ (z >> 31);
    }

    fn text(&mut self, text: &str) {
        self.number(text.len() as u64);
        for byte in text.bytes() {
            self.number(u64::from(byte));
        }
    }
}

/// A blank after a name without parameters, so that the next name does not run into it.
fn separate(text: &mut String) {
    if text.ends_with(|last: char| last.is_alphanumeric() || last == '_') {
        text.push(' ');
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{V, graph, grow, type_named};

    #[test]
    fn strings_and_trees() {
        let mut graph = graph("S A(1) [B(2) C(3)] [D(9)] D(4)");
        assert_eq!(graph.string_text(), "S A(1)[B(2)C(3)][D(9)]D(4)");
        assert_eq!(
            graph.tree_text(),
            "RGGRoot\nS\nA(1)\n+ B(2)\n  C(3)\n+ D(9)\nD(4)\n"
        );
        grow(&mut graph, "E(5)").expect("room");
        assert_eq!(graph.string_text(), "(S A(1)[B(2)C(3)][D(9)]D(4))(E(5))");
        let counts: Vec<String> = graph
            .counts()
            .into_iter()
            .map(|(name, n)| format!("{name} {n}"))
            .collect();
        assert_eq!(counts.join(", "), "S 1, A 1, B 1, C 1, D 2, E 1");
    }

    #[test]
    fn the_digest_knows_order_and_values_but_not_places() {
        let mut other = graph("S A(7)");
        let s = other.extent(type_named(&other, "S")).next().expect("one");
        other.remove(s);
        other.end_of_step();
        grow(&mut other, "S A(1) [B(2)] C(3)").expect("room");
        let mut same = graph("S A(1) [B(2)] C(3)");
        assert_eq!(other.digest(), same.digest());
        assert_ne!(graph("S A(1) B(2) C(3)").digest(), same.digest());
        let c = same.extent(type_named(&same, "C")).next().expect("one");
        same.set_i32(c, V, 4).expect("exists");
        assert_ne!(other.digest(), same.digest());
    }

    #[test]
    fn a_long_chain_is_no_recursion() {
        let text = format!("S {}", "A(1) ".repeat(5000));
        assert_eq!(graph(&text).string_text().len(), 2 + 5000 * 4);
    }
}
