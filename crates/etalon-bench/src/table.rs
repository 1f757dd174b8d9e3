//! Tables of results by columns: as CSV by their keys; as text, Markdown and HTML for people. Structs that are records themselves as
//! CSV by their fields. Names of the files.

use etalon_core::error::{Error, Result};
use serde::Serialize;
use std::borrow::Cow;
use std::fmt::Display;
use std::path::Path;

/// Rows as CSV text, with the field names of `T` as header, also without rows.
pub fn csv<T: Serialize + Default>(rows: &[T]) -> Result<Vec<u8>> {
    if rows.is_empty() {
        let text = csv(&[T::default()])?;
        return Ok(text.split_inclusive(|b| *b == b'\n').next().unwrap_or_default().to_vec());
    }
    text_of(|writer| rows.iter().try_for_each(|row| writer.serialize(row)))
}

/// What `write` writes.
fn text_of(write: impl FnOnce(&mut csv::Writer<Vec<u8>>) -> csv::Result<()>) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let written = write(&mut writer).map_err(std::io::Error::from);
    let text = written.and_then(|()| writer.into_inner().map_err(csv::IntoInnerError::into_error));
    text.map_err(|e| Error::io(Path::new("table"), e))
}

#[derive(Serialize)]
#[serde(untagged)]
pub enum Cell<'a> {
    Empty,
    Double(f64),
    Single(f32),
    Count(u64),
    Flag(bool),
    Text(Cow<'a, str>),
}

macro_rules! cells {
    ($($of:ty: $cell:ident),*) => {
        $(impl<'a> From<$of> for Cell<'a> {
            fn from(value: $of) -> Self {
                Self::$cell(value.into())
            }
        })*
    };
}

cells!(f64: Double, f32: Single, u32: Count, u64: Count, bool: Flag, String: Text, &'a str: Text, &'a String: Text);

impl From<usize> for Cell<'_> {
    fn from(count: usize) -> Self {
        Self::Count(count as u64)
    }
}

impl<'a, C: Into<Self>> From<Option<C>> for Cell<'a> {
    fn from(value: Option<C>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

/// The cell of a row in a CSV file.
type Field<'a, T> = Box<dyn Fn(&'a T) -> Cell<'a> + 'a>;

/// Rows in columns: of a CSV file, or for people. Cells and headings for people are in the language of the output: Markdown for
/// Markdown, HTML for HTML.
pub struct Table<'a, T> {
    rows: &'a [T],
    /// For people.
    pub columns: Vec<Column>,
    /// Columns of the CSV file with their keys. Their cells are made as they are written: such tables may have millions.
    fields: Vec<(&'static str, Field<'a, T>)>,
}

pub struct Column {
    pub heading: String,
    /// Numbers stand below each other by their decimals, words begin below each other.
    pub is_number: bool,
    /// One for each row.
    pub cells: Vec<String>,
}

impl<'a, T> Table<'a, T> {
    pub fn of(rows: &'a [T]) -> Self {
        Self { rows, columns: Vec::new(), fields: Vec::new() }
    }

    /// Adds a column of the CSV file.
    pub fn field<C: Into<Cell<'a>>>(mut self, key: &'static str, cell: impl Fn(&'a T) -> C + 'a) -> Self {
        self.fields.push((key, Box::new(move |row| cell(row).into())));
        self
    }

    /// The columns with keys as CSV text, with their keys as header.
    pub fn csv(&self) -> Result<Vec<u8>> {
        text_of(|writer| {
            writer.write_record(self.fields.iter().map(|(key, _)| key))?;
            let cells = |row: &'a T| self.fields.iter().map(|(_, cell)| cell(row)).collect::<Vec<_>>();
            self.rows.iter().try_for_each(|row| writer.serialize(cells(row)))
        })
    }

    /// Adds a column of words. Where no column has a heading, there is no line of headings.
    pub fn words<D: Display>(mut self, heading: impl Display, cell: impl FnMut(&'a T) -> D) -> Self {
        let cells = self.rows.iter().map(cell).map(|cell| cell.to_string()).collect();
        self.columns.push(Column { heading: heading.to_string(), is_number: false, cells });
        self
    }

    /// Adds a column of numbers; NaN is "unknown".
    pub fn numbers<D: Display>(self, heading: impl Display, mut cell: impl FnMut(&'a T) -> D) -> Self {
        let mut table = self.words(heading, |row| cell(row).to_string().replace("NaN", "unknown"));
        table.columns.last_mut().into_iter().for_each(|column| column.is_number = true);
        table
    }

    /// A line of headings and one for each row, in columns as wide as their content.
    pub fn text(&self) -> String {
        self.text_with(|_, line| line)
    }

    /// The same, with the line of each row replaced by what `told` makes of it: for example with more lines below.
    pub fn text_with(&self, mut told: impl FnMut(&'a T, String) -> String) -> String {
        let columns: Vec<Vec<String>> = self.columns.iter().map(Column::aligned).collect();
        let line = |i: usize| {
            let cells: Vec<&str> = columns.iter().map(|cells| cells[i].as_str()).collect();
            format!("{}\n", cells.join("  ").trim_end())
        };
        let head = if self.columns.iter().all(|column| column.heading.is_empty()) { String::new() } else { line(0) };
        head + &self.rows.iter().enumerate().map(|(i, row)| told(row, line(i + 1))).collect::<String>()
    }

    pub fn markdown(&self) -> String {
        let line = |cell: &dyn Fn(&Column) -> &str| {
            format!("| {} |\n", self.columns.iter().map(cell).collect::<Vec<_>>().join(" | "))
        };
        let rule: String = self.columns.iter().map(|column| if column.is_number { "--:|" } else { "---|" }).collect();
        let rows = (0..self.rows.len()).map(|i| line(&|column| column.cells[i].as_str()));
        line(&|column| column.heading.as_str()) + "|" + &rule + "\n" + &rows.collect::<String>()
    }

    /// A `table` of a class, whose cells also carry the headings, for narrow pages.
    pub fn html(&self, class: &str) -> String {
        let heads: String = self.columns.iter().map(|c| format!("<th scope=\"col\">{}</th>", c.heading)).collect();
        let cell = |column: &Column, i: usize| {
            let class = if column.is_number { " class=\"number\"" } else { "" };
            format!("<td{class} data-label=\"{}\">{}</td>", column.heading.to_lowercase(), column.cells[i])
        };
        let row = |i| format!("<tr>{}</tr>\n", self.columns.iter().map(|c| cell(c, i)).collect::<String>());
        let rows: String = (0..self.rows.len()).map(row).collect();
        format!("<table class=\"{class}\">\n<thead><tr>{heads}</tr></thead>\n<tbody>\n{rows}</tbody></table>\n")
    }
}

impl Column {
    /// The heading and the cells, filled up to one width.
    fn aligned(&self) -> Vec<String> {
        // Numbers are filled up on the right, so that their decimal points stand below each other
        let tail = |cell: &str| {
            let digits = cell.find(|c: char| c.is_ascii_digit()).filter(|_| self.is_number).map(|first| &cell[first..]);
            digits.map(|digits| digits.trim_start_matches(|c: char| c.is_ascii_digit()).chars().count())
        };
        let longest = self.cells.iter().filter_map(|cell| tail(cell)).max().unwrap_or(0);
        let filled = |cell: &String| format!("{cell}{:1$}", "", tail(cell).map_or(0, |tail| longest - tail));
        let cells: Vec<String> = std::iter::once(self.heading.clone()).chain(self.cells.iter().map(filled)).collect();
        let width = cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
        let padded = |cell: &String| if self.is_number { format!("{cell:>width$}") } else { format!("{cell:<width$}") };
        cells.iter().map(padded).collect()
    }
}

/// `name` with a hyphen for each character that file names should not have.
pub fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "-_.+".contains(c) { c } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_has_the_field_names_as_header() {
        #[derive(Default, Serialize)]
        struct Row {
            theta_deg: f64,
        }
        assert_eq!(csv(&[Row { theta_deg: 0.5 }]).unwrap(), b"theta_deg\n0.5\n");
        assert_eq!(csv::<Row>(&[]).unwrap(), b"theta_deg\n");
    }

    #[test]
    fn columns_with_keys_are_the_csv_of_a_struct_of_their_cells() {
        #[derive(Clone, Copy, Default, Serialize)]
        struct Row {
            double: f64,
            single: f32,
            count: u64,
            size: usize,
            flag: bool,
            maybe: Option<f64>,
            text: &'static str,
        }
        let numbers = [0.0, -0.0, 1.0, 0.1, 1e-5, 1e-7, 1e15, 1e16, 1e17, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE];
        let texts = ["", "plain", "a, b", "\"quoted\"", "two\nlines", " η "];
        let row = |(i, double): (usize, f64)| {
            let (maybe, text) = ((i % 2 == 0).then_some(double), texts[i % texts.len()]);
            Row { double, single: double as f32, count: u64::MAX >> i, size: i, flag: maybe.is_none(), maybe, text }
        };
        let rows: Vec<Row> = numbers.into_iter().enumerate().map(row).collect();
        for rows in [&rows[..], &[]] {
            let table = Table::of(rows).field("double", |row| row.double).field("single", |row| row.single);
            let table = table.field("count", |row| row.count).field("size", |row| row.size);
            let table = table.field("flag", |row| row.flag).field("maybe", |row| row.maybe);
            assert_eq!(table.field("text", |row| row.text).csv().unwrap(), csv(rows).unwrap());
        }
        // A lone empty cell is no empty line
        let table = Table::of(&rows[..1]).field("text", |row| row.text);
        assert_eq!(table.csv().unwrap(), b"text\n\"\"\n");
    }

    #[test]
    fn columns_are_as_wide_as_their_content() {
        let rows = [("copper", 0.25, "5 %"), ("η", 10.0, ""), ("air", f64::NAN, "< 1e-9 %")];
        let table = Table::of(&rows).words("metal", |row| row.0).numbers("k", |row| row.1).numbers("", |row| row.2);
        let below = |row: &(&str, f64, &str), line: String| line + if row.0 == "η" { "  below\n" } else { "" };
        let text = "metal         k\ncopper     0.25    5 %\nη         10\n  below\nair     unknown  < 1e-9 %\n";
        assert_eq!(table.text_with(below), text);
        assert_eq!(Table::of(&rows[..1]).words("", |row| row.0).numbers("", |row| row.1).text(), "copper  0.25\n");
        assert!(table.markdown().starts_with("| metal | k |  |\n|---|--:|--:|\n| copper | 0.25 | 5 % |\n| η | 10 |"));
        let html = table.html("cards");
        assert!(html.contains(r#"<td data-label="metal">η</td><td class="number" data-label="k">10</td>"#), "{html}");
    }
}
