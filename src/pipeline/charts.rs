//! Tables that a model draws by `chart`: as comma-separated values, and as a picture.

use std::fmt::Write;

use crate::eval::Value;
use crate::eval::library::data::Table;

/// Size of a picture, and of the margins round its plot.
const SIZE: [f64; 2] = [720.0, 440.0];
const MARGINS: [f64; 4] = [70.0, 30.0, 30.0, 50.0];
/// Colours of the columns, in turn.
const COLORS: &[&str] = &[
    "#1b9e77", "#d95f02", "#7570b3", "#e7298a", "#66a61e", "#e6ab02", "#a6761d", "#666666",
];
/// Number of marks on an axis, about.
const N_MARKS: f64 = 6.0;

/// The name of a file for a table: what can stand in file names everywhere.
pub fn file_name(title: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() { c } else { '-' };
    let name: String = title.chars().map(plain).collect();
    let words: Vec<&str> = name.split('-').filter(|word| !word.is_empty()).collect();
    if words.is_empty() {
        "chart".to_owned()
    } else {
        words.join("-")
    }
}

/// The table as comma-separated values: a line of names, then a line for each row.
pub fn csv(table: &Table) -> String {
    let n = table.n_columns();
    let mut out = String::from("row");
    for i in 0..n {
        let name = table.columns.get(i).map_or(String::new(), column_name);
        let name = if name.is_empty() {
            format!("column {i}")
        } else {
            name
        };
        out.push(',');
        out.push_str(&quoted(&name));
    }
    out.push('\n');
    for (i, row) in table.rows.iter().enumerate() {
        let key = if row.key.is_null() {
            i.to_string()
        } else {
            row.key.to_string()
        };
        out.push_str(&quoted(&key));
        for column in 0..n {
            out.push(',');
            if let Some(value) = row.cells.get(column).filter(|v| !v.is_null()) {
                out.push_str(&quoted(&value.to_string()));
            }
        }
        out.push('\n');
    }
    out
}

fn column_name(key: &Value) -> String {
    if key.is_null() {
        String::new()
    } else {
        key.to_string()
    }
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// Points of one column.
struct Series {
    name: String,
    points: Vec<[f64; 2]>,
}

fn series(table: &Table) -> Vec<Series> {
    let one = |column: usize| {
        let number = |value: &Value| value.as_double().filter(|y| y.is_finite());
        let points = table.rows.iter().enumerate().filter_map(|(i, row)| {
            let x = number(&row.key).unwrap_or(i as f64);
            Some([x, number(row.cells.get(column)?)?])
        });
        Series {
            name: table.columns.get(column).map_or(String::new(), column_name),
            points: points.collect(),
        }
    };
    (0..table.n_columns()).map(one).collect()
}

/// Least and greatest of the values, apart by more than nothing.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [least, greatest] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| {
        [a.min(v), b.max(v)]
    });
    if !(least.is_finite() && greatest.is_finite()) {
        [0.0, 1.0]
    } else if greatest > least {
        [least, greatest]
    } else {
        [least - 0.5, greatest + 0.5]
    }
}

/// The table as a picture (SVG): lines (0), points (1) or bars (2).
pub fn svg(table: &Table, kind: i32) -> String {
    let all = series(table);
    let points = || all.iter().flat_map(|s| &s.points);
    let mut y = range(points().map(|p| p[1]));
    if kind == 2 {
        y = [y[0].min(0.0), y[1].max(0.0)];
    }
    let mut x = range(points().map(|p| p[0]));
    if kind == 2 {
        x = [x[0] - 0.5, x[1] + 0.5];
    }
    let frame = Frame { x, y };
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        SIZE[0], SIZE[1]
    );
    frame.axes(&mut out, &table.title);
    for (i, series) in all.iter().enumerate() {
        let color = COLORS[i % COLORS.len()];
        frame.draw(&mut out, series, kind, color, [i, all.len()]);
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{color}\" text-anchor=\"end\">{}</text>",
            SIZE[0] - MARGINS[1] - 6.0,
            MARGINS[2] + 16.0 + 15.0 * i as f64,
            escaped(&series.name)
        );
    }
    out.push_str("</svg>\n");
    out
}

/// Where numbers stand in the picture.
struct Frame {
    x: [f64; 2],
    y: [f64; 2],
}

impl Frame {
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, right, top, bottom] = MARGINS;
        let share = |v: f64, [a, b]: [f64; 2]| (v - a) / (b - a);
        [
            left + share(x, self.x) * (SIZE[0] - left - right),
            SIZE[1] - bottom - share(y, self.y) * (SIZE[1] - top - bottom),
        ]
    }

    fn axes(&self, out: &mut String, title: &str) {
        let [[left, bottom], [right, top]] = [
            self.place([self.x[0], self.y[0]]),
            self.place([self.x[1], self.y[1]]),
        ];
        let _ = writeln!(
            out,
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"#444\"/>\n\
             <text x=\"{:.1}\" y=\"20\" text-anchor=\"middle\" font-size=\"14\">{}</text>",
            right - left,
            bottom - top,
            (left + right) / 2.0,
            escaped(title)
        );
        for x in marks(self.x) {
            let [at, _] = self.place([x, self.y[0]]);
            let _ = writeln!(
                out,
                "<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                bottom + 18.0,
                number(x)
            );
        }
        for y in marks(self.y) {
            let [_, at] = self.place([self.x[0], y]);
            let _ = writeln!(
                out,
                "<path d=\"M{left:.1} {at:.1}H{right:.1}\" stroke=\"#ddd\"/>\n\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                left - 6.0,
                at + 4.0,
                number(y)
            );
        }
    }

    fn draw(&self, out: &mut String, series: &Series, kind: i32, color: &str, [i, n]: [usize; 2]) {
        let places: Vec<[f64; 2]> = series.points.iter().map(|p| self.place(*p)).collect();
        match kind {
            1 => {
                for [x, y] in places {
                    let _ = writeln!(
                        out,
                        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{color}\"/>"
                    );
                }
            }
            2 => {
                let width =
                    0.8 * (self.place([1.0, 0.0])[0] - self.place([0.0, 0.0])[0]) / n as f64;
                let zero = self.place([0.0, 0.0])[1];
                for [x, y] in places {
                    let left = x + width * (i as f64 - n as f64 / 2.0);
                    let _ = writeln!(
                        out,
                        "<rect x=\"{left:.1}\" y=\"{:.1}\" width=\"{width:.1}\" height=\"{:.1}\" fill=\"{color}\"/>",
                        y.min(zero),
                        (y - zero).abs()
                    );
                }
            }
            _ if !places.is_empty() => {
                let path: Vec<String> = places
                    .iter()
                    .map(|[x, y]| format!("{x:.1} {y:.1}"))
                    .collect();
                let _ = writeln!(
                    out,
                    "<path d=\"M{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"/>",
                    path.join("L")
                );
            }
            _ => {}
        }
    }
}

/// Round numbers between two, about [`N_MARKS`] of them.
fn marks([from, to]: [f64; 2]) -> Vec<f64> {
    let rough = (to - from) / N_MARKS;
    let power = 10.0_f64.powi(rough.log10().floor() as i32);
    let step = [1.0, 2.0, 5.0, 10.0].map(|f| f * power);
    let step = step
        .into_iter()
        .find(|s| *s >= rough)
        .unwrap_or(10.0 * power);
    let first = (from / step).ceil();
    (0..20)
        .map(|i| (first + f64::from(i)) * step)
        .take_while(|v| *v <= to + step / 1024.0)
        .collect()
}

fn number(x: f64) -> String {
    if x != 0.0 && !(0.001..1_000_000.0).contains(&x.abs()) {
        return format!("{x:.2e}");
    }
    let text = format!("{x:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eval::library::data::TableRow;

    fn table() -> Table {
        let row = |key: Value, cells: Vec<Value>| TableRow { key, cells };
        let rows = vec![
            row(Value::Null, vec![Value::Double(1.5), Value::Int(2)]),
            row(Value::Int(7), vec![Value::Null, Value::Float(2.25)]),
        ];
        Table::of("Yield (mg), <all>", vec![Value::text("a,b")], rows)
    }

    #[test]
    fn tables_are_comma_separated_values() {
        assert_eq!(csv(&table()), "row,\"a,b\",column 1\n0,1.5,2\n7,,2.25\n");
        assert_eq!(file_name("Yield (mg), <all>"), "Yield-mg-all");
        assert_eq!(file_name("../.."), "chart");
    }

    #[test]
    fn pictures_show_every_value() {
        let scatter = svg(&table(), 1);
        assert_eq!(scatter.matches("<circle").count(), 3);
        assert!(scatter.contains("&lt;all&gt;") && scatter.ends_with("</svg>\n"));
        assert_eq!(svg(&table(), 2).matches("<rect").count(), 2 + 3);
        assert_eq!(
            svg(&Table::default(), 0).matches("<path d=\"M70").count(),
            6
        );
    }

    #[test]
    fn marks_are_round() {
        assert_eq!(marks([0.0, 10.0]), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!([0.25, 1e7, 3.0].map(number), ["0.25", "1.00e7", "3"]);
    }
}
