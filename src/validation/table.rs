//! Reading the published numbers: comma-separated text, comments after `#`, one line of headings.

/// The rows of a table, without comments and headings, each with its fields.
pub(super) fn rows(text: &'static str) -> impl Iterator<Item = Vec<&'static str>> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines.skip(1).map(fields)
}

/// The fields of a line; commas within quotation marks are part of a field.
fn fields(line: &'static str) -> Vec<&'static str> {
    let mut is_quoted = false;
    let parts = line.split(move |c| {
        is_quoted ^= c == '"';
        c == ',' && !is_quoted
    });
    parts.map(|field| field.trim_matches('"')).collect()
}

/// The number in a field; NaN, which no check passes, if there is none.
pub(super) fn number(row: &[&str], field: usize) -> f64 {
    let text = row.get(field).copied().unwrap_or_default();
    text.trim().parse().unwrap_or(f64::NAN)
}

/// The number after `name=` in a list such as `r1=1 r2=0.5`; NaN if it is not there.
pub(super) fn parameter(list: &str, name: &str) -> f64 {
    let mut parts = list.split_whitespace();
    let value = parts.find_map(|part| part.strip_prefix(name)?.strip_prefix('='));
    value.and_then(|text| text.parse().ok()).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_and_parameters() {
        let text = "# note\nconfiguration,parameters,F\n\"disks, coaxial\",\"r1=1 r=0.5\",0.25\n";
        let rows: Vec<_> = rows(text).collect();
        assert_eq!(rows, [["disks, coaxial", "r1=1 r=0.5", "0.25"]]);
        assert_eq!(number(&rows[0], 2), 0.25);
        assert_eq!(
            (parameter(rows[0][1], "r"), parameter(rows[0][1], "r1")),
            (0.5, 1.0)
        );
        assert!(number(&rows[0], 0).is_nan() && parameter(rows[0][1], "h").is_nan());
    }
}
