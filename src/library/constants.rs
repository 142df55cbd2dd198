//! Named constants: `Math.PI`, `Integer.MAX_VALUE`, `RED`, the bits of `setDerivationMode`.

use super::ClassId;

/// The value of a constant.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are Java's own")]
pub enum ConstantValue {
    Int(i32),
    Long(i64),
    Float(f32),
    Double(f64),
    /// Null, of this class.
    Null(ClassId),
    /// An opaque `RGBAShader` of this red, green and blue (0..=255, as GroIMP gives them).
    Shader([u8; 3]),
}

/// A named constant.
#[derive(Clone, Copy, Debug)]
pub struct LibraryConstant {
    /// Class in front of the dot; empty: none.
    pub owner: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: ConstantValue,
    /// What it means.
    pub doc: &'static str,
}

use ConstantValue::{Double, Float, Int, Long, Null, Shader};

const fn row(
    owner: &'static str,
    name: &'static str,
    value: ConstantValue,
    doc: &'static str,
) -> LibraryConstant {
    LibraryConstant {
        owner,
        name,
        value,
        doc,
    }
}

static CONSTANTS: &[LibraryConstant] = &[
    row(
        "Math",
        "PI",
        Double(std::f64::consts::PI),
        "Half the circumference of the unit circle.",
    ),
    row(
        "Math",
        "E",
        Double(std::f64::consts::E),
        "Base of the natural logarithm.",
    ),
    row(
        "MeasureMode",
        "RGB",
        Int(0),
        "A light model measures red, green and blue.",
    ),
    row(
        "MeasureMode",
        "FULL_SPECTRUM",
        Int(1),
        "A light model measures spectra: not possible here.",
    ),
    row(
        "MeasureMode",
        "INTEGRATED_SPECTRUM",
        Int(2),
        "A light model measures weighted spectra: not possible here.",
    ),
    row("", "XY_PLOT", Int(0), "A chart of lines."),
    row("", "SCATTER_PLOT", Int(1), "A chart of points."),
    row("", "BAR_PLOT", Int(2), "A chart of bars."),
    row(
        "Locale",
        "US",
        Null(ClassId::Locale),
        "Numbers are written the English way.",
    ),
    row(
        "Locale",
        "ENGLISH",
        Null(ClassId::Locale),
        "Numbers are written the English way.",
    ),
    row(
        "Locale",
        "UK",
        Null(ClassId::Locale),
        "Numbers are written the English way.",
    ),
    row(
        "Locale",
        "ROOT",
        Null(ClassId::Locale),
        "Numbers are written the English way.",
    ),
    row("Byte", "MAX_VALUE", Int(127), "Greatest byte."),
    row("Byte", "MIN_VALUE", Int(-128), "Least byte."),
    row("Short", "MAX_VALUE", Int(32767), "Greatest short."),
    row("Short", "MIN_VALUE", Int(-32768), "Least short."),
    row("Integer", "MAX_VALUE", Int(i32::MAX), "Greatest int."),
    row("Integer", "MIN_VALUE", Int(i32::MIN), "Least int."),
    row("Long", "MAX_VALUE", Long(i64::MAX), "Greatest long."),
    row("Long", "MIN_VALUE", Long(i64::MIN), "Least long."),
    row(
        "Float",
        "MAX_VALUE",
        Float(f32::MAX),
        "Greatest finite float.",
    ),
    row(
        "Float",
        "MIN_VALUE",
        Float(f32::from_bits(1)),
        "Least float above 0.",
    ),
    row("Float", "NaN", Float(f32::NAN), "Not a number."),
    row(
        "Float",
        "POSITIVE_INFINITY",
        Float(f32::INFINITY),
        "Infinity.",
    ),
    row(
        "Float",
        "NEGATIVE_INFINITY",
        Float(f32::NEG_INFINITY),
        "Minus infinity.",
    ),
    row(
        "Double",
        "MAX_VALUE",
        Double(f64::MAX),
        "Greatest finite double.",
    ),
    row(
        "Double",
        "MIN_VALUE",
        Double(f64::from_bits(1)),
        "Least double above 0.",
    ),
    row("Double", "NaN", Double(f64::NAN), "Not a number."),
    row(
        "Double",
        "POSITIVE_INFINITY",
        Double(f64::INFINITY),
        "Infinity.",
    ),
    row(
        "Double",
        "NEGATIVE_INFINITY",
        Double(f64::NEG_INFINITY),
        "Minus infinity.",
    ),
    row(
        "Graph",
        "PARALLEL_MODE",
        Int(0),
        "All matches of all rules in one step.",
    ),
    row(
        "Graph",
        "PARALLEL_NON_DETERMINISTIC_MODE",
        Int(1),
        "As parallel, one rule chosen per node at random.",
    ),
    row(
        "Graph",
        "SEQUENTIAL_MODE",
        Int(2),
        "One rule application per step: the first match of the first rule that has one.",
    ),
    row(
        "Graph",
        "SEQUENTIAL_NON_DETERMINISTIC_MODE",
        Int(3),
        "One rule application per step, chosen at random.",
    ),
    row(
        "Graph",
        "INTERPRETIVE_FLAG",
        Int(4),
        "Rules are interpretive.",
    ),
    row(
        "Graph",
        "EXCLUDE_DELETED_FLAG",
        Int(8),
        "Nodes consumed in this step are matched no more.",
    ),
    row("", "BLACK", Shader([0, 0, 0]), "Matt black."),
    row("", "BLUE", Shader([0, 0, 255]), "Matt blue."),
    row("", "CYAN", Shader([0, 255, 255]), "Matt cyan."),
    row("", "DARK_GRAY", Shader([64, 64, 64]), "Matt dark gray."),
    row("", "GRAY", Shader([128, 128, 128]), "Matt gray."),
    row("", "GREEN", Shader([0, 255, 0]), "Matt green."),
    row(
        "",
        "LIGHT_GRAY",
        Shader([192, 192, 192]),
        "Matt light gray.",
    ),
    row("", "MAGENTA", Shader([255, 0, 255]), "Matt magenta."),
    row("", "ORANGE", Shader([255, 200, 0]), "Matt orange."),
    row("", "PINK", Shader([255, 175, 175]), "Matt pink."),
    row("", "RED", Shader([255, 0, 0]), "Matt red."),
    row("", "YELLOW", Shader([255, 255, 0]), "Matt yellow."),
    row("", "WHITE", Shader([255, 255, 255]), "Matt white."),
    row("", "EGA_0", Shader([0x00, 0x00, 0x00]), "EGA colour 0."),
    row("", "EGA_1", Shader([0x00, 0x00, 0xAA]), "EGA colour 1."),
    row("", "EGA_2", Shader([0x00, 0xAA, 0x00]), "EGA colour 2."),
    row("", "EGA_3", Shader([0x00, 0xAA, 0xAA]), "EGA colour 3."),
    row("", "EGA_4", Shader([0xAA, 0x00, 0x00]), "EGA colour 4."),
    row("", "EGA_5", Shader([0xAA, 0x00, 0xAA]), "EGA colour 5."),
    row("", "EGA_6", Shader([0xAA, 0x55, 0x00]), "EGA colour 6."),
    row("", "EGA_7", Shader([0xAA, 0xAA, 0xAA]), "EGA colour 7."),
    row("", "EGA_8", Shader([0x55, 0x55, 0x55]), "EGA colour 8."),
    row("", "EGA_9", Shader([0x55, 0x55, 0xFF]), "EGA colour 9."),
    row("", "EGA_10", Shader([0x55, 0xFF, 0x55]), "EGA colour 10."),
    row("", "EGA_11", Shader([0x55, 0xFF, 0xFF]), "EGA colour 11."),
    row("", "EGA_12", Shader([0xFF, 0x55, 0x55]), "EGA colour 12."),
    row("", "EGA_13", Shader([0xFF, 0x55, 0xFF]), "EGA colour 13."),
    row("", "EGA_14", Shader([0xFF, 0xFF, 0x55]), "EGA colour 14."),
    row("", "EGA_15", Shader([0xFF, 0xFF, 0xFF]), "EGA colour 15."),
    row(
        "",
        "EDGE_0",
        Int(1 << 0),
        "A user's own edge, as in `A -EDGE_0-> B`.",
    ),
    row(
        "",
        "EDGE_1",
        Int(1 << 1),
        "A user's own edge, as in `A -EDGE_1-> B`.",
    ),
    row(
        "",
        "EDGE_2",
        Int(1 << 2),
        "A user's own edge, as in `A -EDGE_2-> B`.",
    ),
    row(
        "",
        "EDGE_3",
        Int(1 << 3),
        "A user's own edge, as in `A -EDGE_3-> B`.",
    ),
    row(
        "",
        "EDGE_4",
        Int(1 << 4),
        "A user's own edge, as in `A -EDGE_4-> B`.",
    ),
    row(
        "",
        "EDGE_5",
        Int(1 << 5),
        "A user's own edge, as in `A -EDGE_5-> B`.",
    ),
    row(
        "",
        "EDGE_6",
        Int(1 << 6),
        "A user's own edge, as in `A -EDGE_6-> B`.",
    ),
    row(
        "",
        "EDGE_7",
        Int(1 << 7),
        "A user's own edge, as in `A -EDGE_7-> B`.",
    ),
    row(
        "",
        "EDGE_8",
        Int(1 << 8),
        "A user's own edge, as in `A -EDGE_8-> B`.",
    ),
    row(
        "",
        "EDGE_9",
        Int(1 << 9),
        "A user's own edge, as in `A -EDGE_9-> B`.",
    ),
    row(
        "",
        "EDGE_10",
        Int(1 << 10),
        "A user's own edge, as in `A -EDGE_10-> B`.",
    ),
    row(
        "",
        "EDGE_11",
        Int(1 << 11),
        "A user's own edge, as in `A -EDGE_11-> B`.",
    ),
    row(
        "",
        "EDGE_12",
        Int(1 << 12),
        "A user's own edge, as in `A -EDGE_12-> B`.",
    ),
    row(
        "",
        "EDGE_13",
        Int(1 << 13),
        "A user's own edge, as in `A -EDGE_13-> B`.",
    ),
    row(
        "",
        "EDGE_14",
        Int(1 << 14),
        "A user's own edge, as in `A -EDGE_14-> B`.",
    ),
    row(
        "",
        "EDGE_15",
        Int(1 << 15),
        "A user's own edge, as in `A -EDGE_15-> B`.",
    ),
    row(
        "",
        "EDGE_16",
        Int(1 << 16),
        "A user's own edge, as in `A -EDGE_16-> B`.",
    ),
    row(
        "",
        "EDGE_17",
        Int(1 << 17),
        "A user's own edge, as in `A -EDGE_17-> B`.",
    ),
    row(
        "",
        "EDGE_18",
        Int(1 << 18),
        "A user's own edge, as in `A -EDGE_18-> B`.",
    ),
    row(
        "",
        "EDGE_19",
        Int(1 << 19),
        "A user's own edge, as in `A -EDGE_19-> B`.",
    ),
    row(
        "",
        "EDGE_20",
        Int(1 << 20),
        "A user's own edge, as in `A -EDGE_20-> B`.",
    ),
];

/// All constants, in order of the table.
pub fn constants() -> &'static [LibraryConstant] {
    CONSTANTS
}

/// The constant `owner.name`, or `name` for an empty owner. The colours also answer to `RGBAShader` and `Color` as owners.
pub fn constant(owner: &str, name: &str) -> Option<&'static LibraryConstant> {
    let owner = if ["RGBAShader", "Color"].contains(&owner) {
        ""
    } else {
        owner
    };
    CONSTANTS
        .iter()
        .find(|c| c.owner == owner && c.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_are_found_by_owner() {
        assert_eq!(
            constant("Math", "PI").map(|c| c.value),
            Some(Double(std::f64::consts::PI))
        );
        assert_eq!(
            constant("", "RED").map(|c| c.value),
            Some(Shader([255, 0, 0]))
        );
        assert_eq!(
            constant("RGBAShader", "RED").map(|c| c.value),
            Some(Shader([255, 0, 0]))
        );
        assert!(constant("", "PI").is_none());
    }
}
