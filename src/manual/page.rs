//! The page `grammar/REFERENCE.md`, made from the tables.

use super::signature::{self, builtin_named};
use super::words::{AGGREGATES, ARROWS, EDGES, KEYWORDS, Word};
use crate::library::{
    ClassId, ConstantValue, ConstructorId, Effect as CallEffect, FunctionId, LibraryConstant,
    MethodId, Signature, constants,
};
use crate::turtle::effect::{Change, Effect, Primitive, Register, Scope};
use crate::turtle::{BuiltinType, Registers, builtin_types};

const INTRODUCTION: &str = "# The language: reference

Every word that `understory` knows: how it is written, what it takes, what it means. This page is made from the tables of
the program itself (`src/turtle/table.rs`, `src/library/`); `UPDATE=1 cargo test --test manual` writes it anew.

Metres, watts, z up. Angles of turtle commands are degrees, angles of lights and of `Math` are radians. The turtle walks
along its local +z (\"head\"); local x is \"left\", local y is \"up\".
";

/// The whole page as markdown.
pub fn markdown() -> String {
    let mut page = INTRODUCTION.to_owned();
    syntax(&mut page);
    turtle_commands(&mut page);
    geometry(&mut page);
    shaders_and_lights(&mut page);
    functions(&mut page);
    classes(&mut page);
    colors(&mut page);
    page
}

fn heading(page: &mut String, title: &str) {
    page.truncate(page.trim_end().len());
    page.push_str(&format!("\n\n{title}\n\n"));
}

/// A table; nothing if there are no rows.
fn table(page: &mut String, head: &[&str], rows: &[Vec<String>]) {
    if rows.is_empty() {
        return;
    }
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = head.iter().map(|&cell| cell.to_owned()).collect();
    page.push_str(&line(&head));
    page.push_str(&format!("|{}\n", "---|".repeat(head.len())));
    for row in rows {
        page.push_str(&line(row));
    }
}

/// A text as code, safe inside a table.
fn code(text: &str) -> String {
    format!("`{}`", text.replace('|', "\\|"))
}

fn plain(text: &str) -> String {
    text.replace('|', "\\|")
}

fn words(page: &mut String, words: &[Word]) {
    let row = |word: &Word| vec![code(word.name), code(word.form), plain(word.doc)];
    let rows: Vec<Vec<String>> = words.iter().map(row).collect();
    table(page, &["word", "for example", "meaning"], &rows);
}

fn syntax(page: &mut String) {
    heading(page, "## Rules and queries");
    words(page, ARROWS);
    heading(page, "### Edges");
    words(page, EDGES);
    heading(page, "### Functions over several values");
    page.push_str("Of queries, ranges, arrays and lists.\n\n");
    words(page, AGGREGATES);
    heading(page, "## Words");
    words(page, KEYWORDS);
}

/// Built-in types with their constructors and properties.
fn types<'t>(page: &mut String, rows: impl IntoIterator<Item = &'t BuiltinType>) {
    let rows: Vec<Vec<String>> = rows.into_iter().map(type_row).collect();
    table(
        page,
        &["written", "parameters and properties", "meaning"],
        &rows,
    );
}

fn type_row(row: &BuiltinType) -> Vec<String> {
    let forms = signature::constructors(row);
    let written: Vec<String> = if forms.is_empty() {
        vec![format!(
            "{} (only to extend or to look for)",
            code(row.name)
        )]
    } else {
        forms.iter().map(|form| code(form)).collect()
    };
    let is_shown =
        |name: &str| !name.contains('.') || name.starts_with("transform.") || name == "width.full";
    let properties: Vec<String> = row
        .fields
        .iter()
        .filter(|field| is_shown(field.name))
        .map(|field| {
            format!(
                "{}: {}",
                code(&signature::property(field)),
                sentence_part(field.doc)
            )
        })
        .collect();
    let extends = match row.parent {
        "" | "Node" | "Shoot" => String::new(),
        parent => format!(" Extends {}.", code(parent)),
    };
    vec![
        written.join("<br>"),
        properties.join("<br>"),
        format!("{}{extends}", plain(row.doc)),
    ]
}

/// A sentence without its period, to stand in a list.
fn sentence_part(doc: &str) -> String {
    plain(doc.trim_end_matches('.'))
}

fn of_effect(is_wanted: impl Fn(Effect) -> bool) -> Vec<&'static BuiltinType> {
    builtin_types()
        .filter(|row| is_wanted(row.effect))
        .collect()
}

fn turtle_commands(page: &mut String) {
    heading(page, "## Turtle commands");
    heading(page, "### Walking and drawing");
    types(page, of_effect(|e| matches!(e, Effect::Step { .. })));
    heading(page, "### Turning");
    let is_turn = |effect| {
        matches!(
            effect,
            Effect::Turn(..)
                | Effect::SetInclination
                | Effect::AdjustUp
                | Effect::HeadDown
                | Effect::Gravitropism
                | Effect::RegisterGravitropism
                | Effect::Tropism(_)
        )
    };
    types(page, of_effect(is_turn));
    heading(page, "### Moving the frame");
    let is_frame = |e| {
        matches!(
            e,
            Effect::Translate | Effect::Rotate | Effect::Scale | Effect::Instance
        )
    };
    types(page, of_effect(is_frame));
    heading(page, "### Numbers the turtle carries");
    page.push_str(
        "Shoots without a number of their own take the turtle's. `D(x)` holds for all that follows, `Dl(x)` for the next shoot only.\n\n",
    );
    let rows: Vec<Vec<String>> = REGISTERS
        .iter()
        .map(|&(register, what)| register_row(register, what))
        .collect();
    let head = [
        "number",
        "at first",
        "set",
        "add",
        "multiply",
        "as at first",
        "for the next shoot only",
    ];
    table(page, &head, &rows);
}

/// The turtle's numbers with what they are.
const REGISTERS: [(Register, &str); 8] = [
    (Register::Length, "shoot length, m"),
    (Register::Diameter, "shoot diameter, m"),
    (Register::Color, "shoot colour, EGA 0..15"),
    (Register::Tropism, "tropism, for `RV0`"),
    (Register::Parameter, "parameter, for the model's own use"),
    (Register::Carbon, "carbon, for the model's own use"),
    (Register::Heartwood, "heartwood, for the model's own use"),
    (
        Register::InternodeCount,
        "internode count, for the model's own use",
    ),
];

fn register_row(register: Register, what: &str) -> Vec<String> {
    let commands = |is_wanted: &dyn Fn(Change, Scope) -> bool| {
        let rows = builtin_types().filter(|row| match row.effect {
            Effect::Assign(of, change, scope) => of == register && is_wanted(change, scope),
            _ => false,
        });
        let argument = |row: &BuiltinType| if row.fields.is_empty() { "" } else { "(x)" };
        let written: Vec<String> = rows
            .map(|row| code(&format!("{}{}", row.name, argument(row))))
            .collect();
        written.join(" ")
    };
    let following =
        |wanted: Change| commands(&|change, scope| scope == Scope::Following && change == wanted);
    vec![
        what.to_owned(),
        Registers::default().global(register).to_string(),
        following(Change::Set),
        following(Change::Add),
        following(Change::Mul),
        following(Change::Reset),
        commands(&|_, scope| scope == Scope::Next),
    ]
}

fn geometry(page: &mut String) {
    heading(page, "## Geometry");
    page.push_str(
        "Every property can be set after the constructor: `Box(1, 0.2, 0.3).(setShader(GREEN), setLayer(2))`, and read as `x[length]`.\n\n",
    );
    let is_solid = |e| matches!(e, Effect::Draw(primitive) if !matches!(primitive, Primitive::Light | Primitive::Sky | Primitive::Sensor));
    types(page, of_effect(is_solid));
    heading(page, "### Nodes that draw nothing, and what others extend");
    types(
        page,
        of_effect(|e| matches!(e, Effect::None | Effect::Group | Effect::Grid)),
    );
}

fn shaders_and_lights(page: &mut String) {
    heading(page, "## Light");
    types(
        page,
        ["LightNode", "Sky", "SensorNode"]
            .into_iter()
            .filter_map(builtin_named),
    );
    page.push('\n');
    members_of(page, |class| {
        class.is_a(ClassId::Light) || class.is_a(ClassId::LightModel)
    });
    heading(page, "## Shaders");
    members_of(page, is_appearance);
}

fn is_appearance(class: ClassId) -> bool {
    class.is_a(ClassId::Shader) || class.is_a(ClassId::ChannelMap)
}

fn functions(page: &mut String) {
    let all: Vec<&Signature> = FunctionId::ALL.iter().map(|f| f.signature()).collect();
    let own = |effects: &[CallEffect]| -> Vec<&Signature> {
        let rows = all
            .iter()
            .filter(|row| row.owner.is_empty() && effects.contains(&row.effect));
        rows.copied().collect()
    };
    heading(page, "## Functions");
    for (title, effects) in [
        ("### Steps", &[CallEffect::Writes][..]),
        ("### Chance", &[CallEffect::Random]),
        (
            "### Places in space and other numbers",
            &[CallEffect::Graph, CallEffect::Pure],
        ),
        ("### Printing", &[CallEffect::Prints]),
    ] {
        heading(page, title);
        calls(page, &own(effects));
    }
    heading(page, "### Edges");
    constants_of(page, "");
    let mut owners: Vec<&str> = all
        .iter()
        .map(|row| row.owner)
        .filter(|o| !o.is_empty())
        .collect();
    owners.dedup();
    let mut seen = vec![];
    for owner in owners {
        if seen.contains(&owner) {
            continue;
        }
        seen.push(owner);
        heading(page, &format!("### `{owner}`"));
        let rows: Vec<&Signature> = all
            .iter()
            .copied()
            .filter(|row| row.owner == owner)
            .collect();
        calls(page, &rows);
        constants_of(page, owner);
    }
    let others: Vec<&str> = constants().iter().map(|c| c.owner).collect();
    for (at, owner) in others.iter().enumerate() {
        if !owner.is_empty() && !seen.contains(owner) && !others[..at].contains(owner) {
            heading(page, &format!("### `{owner}`"));
            constants_of(page, owner);
        }
    }
}

fn calls(page: &mut String, rows: &[&Signature]) {
    let row = |row: &&Signature| {
        vec![
            code(&signature::call(row)),
            row.unit.to_owned(),
            plain(row.doc),
        ]
    };
    let rows: Vec<Vec<String>> = rows.iter().map(row).collect();
    table(page, &["function", "unit", "meaning"], &rows);
}

fn constants_of(page: &mut String, owner: &str) {
    let is_color = |c: &LibraryConstant| matches!(c.value, ConstantValue::Shader(_));
    let rows = constants()
        .iter()
        .filter(|c| c.owner == owner && !is_color(c));
    let rows: Vec<Vec<String>> = rows
        .map(|c| vec![code(&signature::constant(c)), plain(c.doc)])
        .collect();
    if !rows.is_empty() {
        page.push('\n');
    }
    table(page, &["constant", "meaning"], &rows);
}

fn classes(page: &mut String) {
    heading(page, "## Classes");
    let is_light = |class: ClassId| class.is_a(ClassId::Light) || class.is_a(ClassId::LightModel);
    members_of(page, |class| !is_light(class) && !is_appearance(class));
    for owner in ["String", "Object", "Array", "Node"] {
        let rows = own_calls(owner);
        if !rows.is_empty() {
            page.push_str(&format!("\n#### `{owner}`\n\n"));
            calls(page, &rows);
        }
    }
}

/// Constructors and methods that a class declares itself.
fn own_calls(owner: &str) -> Vec<&'static Signature> {
    let constructors = ConstructorId::ALL.iter().map(|id| id.signature());
    let methods = MethodId::ALL
        .iter()
        .filter(|id| !id.is_hidden())
        .map(|id| id.signature());
    constructors
        .chain(methods)
        .filter(|row| row.owner == owner)
        .collect()
}

fn members_of(page: &mut String, is_wanted: impl Fn(ClassId) -> bool) {
    for &class in ClassId::ALL.iter().filter(|class| is_wanted(**class)) {
        page.push_str(&format!(
            "\n#### `{}`\n\n{}\n",
            signature::class(class),
            plain(class.doc())
        ));
        let rows = own_calls(class.name());
        if !rows.is_empty() {
            page.push('\n');
        }
        calls(page, &rows);
    }
}

fn colors(page: &mut String) {
    heading(page, "## Colours");
    page.push_str(
        "Shaders, for `setShader(GREEN)`; also as `RGBAShader.GREEN` and `Color.GREEN`.\n\n",
    );
    let shaders = constants()
        .iter()
        .filter(|c| matches!(c.value, ConstantValue::Shader(_)));
    let rows: Vec<Vec<String>> = shaders
        .map(|c| vec![code(&signature::constant(c)), plain(c.doc)])
        .collect();
    table(page, &["constant", "meaning"], &rows);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_of_the_tables_is_on_the_page() {
        let page = markdown();
        let names = builtin_types()
            .map(|row| row.name)
            .chain(FunctionId::ALL.iter().map(|f| f.signature().name))
            .chain(
                MethodId::ALL
                    .iter()
                    .filter(|m| !m.is_hidden())
                    .map(|m| m.signature().name),
            )
            .chain(ClassId::ALL.iter().map(|class| class.name()))
            .chain(constants().iter().map(|c| c.name));
        let is_shown = |name: &str| {
            [format!("{name}`"), format!("{name}("), format!("{name} ")]
                .iter()
                .any(|end| page.contains(end.as_str()))
        };
        let missing: Vec<&str> = names.filter(|name| !is_shown(name)).collect();
        assert!(missing.is_empty(), "{missing:?}");
    }

    #[test]
    fn rows_have_as_many_cells_as_their_heads() {
        let mut wanted = 0;
        for line in markdown().lines() {
            let n_cells = line.replace("\\|", "").matches('|').count();
            if !line.starts_with('|') {
                wanted = 0;
            } else if wanted == 0 {
                wanted = n_cells;
            } else {
                assert_eq!(n_cells, wanted, "{line}");
            }
        }
    }
}
