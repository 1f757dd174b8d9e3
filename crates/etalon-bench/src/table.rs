//! Tables of results: as CSV by the fields of their rows; as text, Markdown and HTML by columns for people. Names of their files.

use etalon_core::error::{Error, Result};
use serde::Serialize;
use std::fmt::Display;
use std::path::Path;

/// Rows as CSV text, with the field names of `T` as header, also without rows.
pub fn csv<T: Serialize + Default>(rows: &[T]) -> Result<Vec<u8>> {
    if rows.is_empty() {
        let text = csv(&[T::default()])?;
        return Ok(text.split_inclusive(|b| *b == b'\n').next().unwrap_or_default().to_vec());
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    let written = rows.iter().try_for_each(|row| writer.serialize(row)).map_err(std::io::Error::from);
    let text = written.and_then(|()| writer.into_inner().map_err(csv::IntoInnerError::into_error));
    text.map_err(|e| Error::io(Path::new("table"), e))
}

/// Rows in columns for people. Cells and headings are in the language of the output: Markdown for Markdown, HTML for HTML.
pub struct Table<'a, T> {
    rows: &'a [T],
    pub columns: Vec<Column>,
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
        Self { rows, columns: Vec::new() }
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
