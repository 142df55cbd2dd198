//! The words and signs of the syntax with their meanings.

/// A word or sign and what it means.
#[derive(Clone, Copy, Debug)]
pub struct Word {
    /// As it is written.
    pub name: &'static str,
    /// How it is used.
    pub form: &'static str,
    /// What it means, one sentence.
    pub doc: &'static str,
}

const fn word(name: &'static str, form: &'static str, doc: &'static str) -> Word {
    Word { name, form, doc }
}

/// The words that cannot be names.
pub const KEYWORDS: &[Word] = &[
    word(
        "module",
        "module Leaf(float size) extends Null { … } ==> … ;",
        "Declares a kind of node: parameters, fields, methods, and the geometry it is drawn as.",
    ),
    word(
        "extends",
        "module A extends B(args)",
        "Names the module or built-in type whose fields, methods and geometry are inherited.",
    ),
    word("implements", "module A implements B", "Read and ignored."),
    word(
        "abstract",
        "abstract module Organ;",
        "Only modules that extend it have nodes; of a method: it has no body.",
    ),
    word(
        "super",
        "super.length",
        "As a parameter of a module: fills an inherited property; before a method: the parent's one.",
    ),
    word(
        "this",
        "this",
        "The node whose method, constructor or instantiation runs.",
    ),
    word(
        "new",
        "new Vector3d(0, 0, 1)",
        "Makes an object, an array or, outside of rules, a node.",
    ),
    word(
        "instanceof",
        "x instanceof Leaf",
        "Whether a node or object is of a type.",
    ),
    word(
        "if",
        "if (a > b) … else …",
        "A choice; on a right-hand side its parts stand in parentheses.",
    ),
    word("else", "if (a > b) … else …", "What happens otherwise."),
    word(
        "for",
        "for (int i : 1:n) (F(1) RH(90))",
        "A loop: classic, over a range `1:n` (both ends included), over a query, an array or a list.",
    ),
    word(
        "while",
        "while (a < b) …",
        "A loop, tested before each turn.",
    ),
    word(
        "do",
        "do … while (a < b);",
        "A loop, tested after each turn.",
    ),
    word(
        "switch",
        "switch (n) { case 1: … break; default: … }",
        "A choice by a whole number or a text.",
    ),
    word("case", "case 1:", "One value of a `switch`."),
    word(
        "default",
        "default:",
        "What a `switch` does with all other values.",
    ),
    word(
        "assert",
        "assert n > 0;",
        "What the writer is sure of; not looked at, as in Java if nobody asks for it.",
    ),
    word(
        "break",
        "break;",
        "Leaves the innermost loop or `switch`, or the one with the label.",
    ),
    word(
        "continue",
        "continue;",
        "Goes on with the next turn of the loop.",
    ),
    word(
        "return",
        "return x;",
        "Ends the method and gives its value.",
    ),
    word(
        "throw",
        "throw new Exception(\"why\");",
        "Ends what is being done with an exception.",
    ),
    word("throws", "void f() throws IOException", "Read and ignored."),
    word(
        "try",
        "try { … } catch (Exception e) { … } finally { … }",
        "Runs statements that may throw.",
    ),
    word(
        "catch",
        "catch (Exception e) { … }",
        "What is done about an exception.",
    ),
    word("finally", "finally { … }", "What is done in any case."),
    word(
        "import",
        "import static parameters.*;",
        "Makes the names of another file or of a class known without their prefix.",
    ),
    word("package", "package crops;", "Read and ignored."),
    word(
        "static",
        "static int count = 0;",
        "Belongs to the model, not to a node.",
    ),
    word("final", "final int a = 1;", "Must not be assigned again."),
    word(
        "const",
        "const float PHYLLOCHRON = 42;",
        "A constant of the model.",
    ),
    word(
        "public",
        "public void run() [ … ]",
        "Can be called from everywhere, and stepped if it has no parameters.",
    ),
    word(
        "protected",
        "protected void init() [ … ]",
        "As `public`, but `init` is usually written so.",
    ),
    word(
        "private",
        "private int n;",
        "Seen in its own file or module only; methods so marked are not offered as steps.",
    ),
    word("class", "class Crop { … }", "A Java class."),
    word("interface", "interface Grows { … }", "A Java interface."),
    word("enum", "enum Stage { SEED, LEAF }", "A Java enumeration."),
    word(
        "void",
        "void grow()",
        "The result type of a method that gives no value.",
    ),
    word("boolean", "boolean", "`true` or `false`."),
    word("byte", "byte", "Whole number, 8 bits."),
    word("short", "short", "Whole number, 16 bits."),
    word("char", "char", "A character (a UTF-16 unit)."),
    word(
        "int",
        "int",
        "Whole number, 32 bits; division drops the remainder: `7 / 2` is 3.",
    ),
    word("long", "long", "Whole number, 64 bits: `5L`."),
    word(
        "float",
        "float",
        "Number with 24 bits of precision: `0.5f`; the type of most properties of nodes.",
    ),
    word(
        "double",
        "double",
        "Number with 53 bits of precision: `0.5`.",
    ),
    word("true", "true", "The boolean value."),
    word("false", "false", "The boolean value."),
    word("null", "null", "No object."),
    word("transient", "transient", "Read and ignored."),
    word("volatile", "volatile", "Read and ignored."),
    word("synchronized", "synchronized", "Read and ignored."),
    word("native", "native", "Read and ignored."),
];

/// Signs of rules.
pub const ARROWS: &[Word] = &[
    word(
        "==>",
        "A(x) ==> B(x) C;",
        "Replaces what is matched and links the new nodes in its place (L-system rule).",
    ),
    word(
        "==>>",
        "A ==>> ;",
        "Replaces what is matched and links nothing: what hung below is lost unless it is named again.",
    ),
    word(
        "::>",
        "x:A ::> x[n]++;",
        "Runs code for each match; replaces nothing.",
    ),
    word("^", "^ ==>> ^ A;", "The root of the graph."),
    word(
        "(* … *)",
        "sum((* Leaf *)[area])",
        "A query: all matches of a pattern. On a left-hand side: context, matched but kept.",
    ),
    word(
        "[ … ]",
        "F(1) [RU(30) F(1)] F(1)",
        "A branch: what follows goes on from the node before it.",
    ),
    word(
        "%",
        "A ==> B %;",
        "Cuts off what followed the replaced part.",
    ),
    word(
        ":=",
        "x[n] := 3;",
        "Assigns at the end of the step; also `:+=`, `:-=`, `:*=`.",
    ),
    word("**", "2 ** 3", "Power."),
    word(
        "1:n",
        "for (int i : 1:n)",
        "A range of whole numbers, both ends included.",
    ),
];

/// Edges of patterns and right-hand sides.
pub const EDGES: &[Word] = &[
    word(">", "A > B", "A successor edge; the same as `A B`."),
    word("+>", "A +> B", "A branch edge; the same as `A [B]`."),
    word("/>", "A /> B", "A refinement edge."),
    word("-->", "A --> B", "An edge of any kind."),
    word(
        "<",
        "A < B",
        "Against the direction; also `<+`, `</`, `<--`.",
    ),
    word(
        "---",
        "A --- B",
        "A successor edge, either way; `--` one of any kind, `-+-` a branch, `-/-` a refinement.",
    ),
    word(
        "(-->)*",
        "A (-->)* B",
        "Any number of edges, none included; `+` at least one, `?` at most one, `{n}`, `{n,m}`.",
    ),
    word(
        "((>)* +>)+",
        "A ((>)* +>)+ B",
        "A way of several edges, repeated; types of nodes may stand between them.",
    ),
    word(
        "(:",
        "A (: > B)",
        "Only the first match of this part; `(& … )` looks for it last, `(? … )` allows that it is missing.",
    ),
    word(
        "ancestor",
        "A -ancestor-> B",
        "The nearest nodes of that type against the edges.",
    ),
    word(
        "minDescendants",
        "A -minDescendants-> B",
        "The nearest nodes of that type along the edges.",
    ),
    word(
        "descendants",
        "A -descendants-> B",
        "All nodes of that type along the edges.",
    ),
    word(
        "EDGE_0",
        "A -EDGE_0-> B",
        "A user's own edge, `EDGE_0` to `EDGE_20`.",
    ),
];

/// Functions over several values: queries, ranges, arrays and lists.
pub const AGGREGATES: &[Word] = &[
    word(
        "sum",
        "sum((* Leaf *)[area])",
        "Sum of the values, 0 of none.",
    ),
    word("prod", "prod(1:5)", "Product of the values, 1 of none."),
    word("count", "count((* Leaf *))", "How many there are."),
    word("mean", "mean((* Leaf *)[area])", "Mean of the values."),
    word("min", "min((* Leaf *)[area])", "Least of the values."),
    word("max", "max((* Leaf *)[area])", "Greatest of the values."),
    word(
        "first",
        "first((* Leaf *))",
        "The first, in order of the graph.",
    ),
    word(
        "last",
        "last((* Leaf *))",
        "The last, in order of the graph.",
    ),
    word("empty", "empty((* Leaf *))", "Whether there is none."),
    word(
        "exist",
        "exist((* Leaf *)[area] > 1)",
        "Whether the condition holds for at least one.",
    ),
    word(
        "forall",
        "forall((* Leaf *)[area] > 1)",
        "Whether the condition holds for all.",
    ),
    word(
        "selectRandomly",
        "selectRandomly((* Leaf *))",
        "One of them by chance, all alike.",
    ),
    word(
        "array",
        "array((* Leaf *)[area])",
        "All of them as an array.",
    ),
    word(
        "string",
        "string((* Leaf *)[area])",
        "All of them as one text.",
    ),
    word(
        "selectWhere",
        "selectWhere((* l:Leaf *), l[rank] == 3)",
        "The first for which the second argument is true, null if there is none.",
    ),
    word(
        "selectWhereMin",
        "selectWhereMin((* l:Leaf *), l[area])",
        "The one whose second argument is least.",
    ),
    word(
        "selectWhereMax",
        "selectWhereMax((* l:Leaf *), l[area])",
        "The one whose second argument is greatest.",
    ),
];

/// The word or sign of this name.
pub fn word_named(name: &str) -> Option<&'static Word> {
    [KEYWORDS, AGGREGATES, EDGES, ARROWS]
        .into_iter()
        .flatten()
        .find(|word| word.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// The words that the grammar reserves, as its file lists them.
    fn reserved() -> BTreeSet<String> {
        let grammar = include_str!("../../grammar/rgg.pest");
        let names = grammar
            .lines()
            .filter_map(|line| line.strip_prefix("kw_")?.split(' ').next())
            .map(str::to_owned);
        names.collect()
    }

    #[test]
    fn every_keyword_of_the_grammar_has_a_meaning() {
        let known: BTreeSet<&str> = KEYWORDS.iter().map(|word| word.name).collect();
        let missing: Vec<String> = reserved()
            .into_iter()
            .filter(|name| !known.contains(name.as_str()))
            .collect();
        assert!(reserved().len() > 20 && missing.is_empty(), "{missing:?}");
    }

    #[test]
    fn every_aggregate_has_a_meaning() {
        let known: Vec<&str> = AGGREGATES.iter().map(|word| word.name).collect();
        assert_eq!(known, crate::check::AGGREGATES);
    }

    #[test]
    fn meanings_are_sentences() {
        for word in [KEYWORDS, AGGREGATES, EDGES, ARROWS].into_iter().flatten() {
            assert!(
                word.doc.ends_with('.') && !word.form.is_empty(),
                "{}",
                word.name
            );
        }
    }
}
