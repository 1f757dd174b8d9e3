//! Tables: columns of text between rules, as in print.

use super::drawing::Drawing;
use super::shapes::{Anchor, Level, Stroke, Text};
use super::text;
use super::theme;

const EDGE: f64 = 14.0;
const ROW: f64 = 20.0;
/// Between columns.
const GAP: f64 = 26.0;

/// Draws a table: the first column is left-aligned, the others are right-aligned. Cells may carry the markup of
/// [`super::text`]; a row with fewer cells than the header ends early.
pub fn table(header: &[&str], rows: &[Vec<String>]) -> Drawing {
    let cells = |column: usize| rows.iter().filter_map(move |row| row.get(column)).map(String::as_str);
    let width = |markup: &str| text::width(markup, theme::NOTE_SIZE, false);
    let widths: Vec<f64> = (0..header.len())
        .map(|column| cells(column).map(width).fold(text::width(header[column], theme::NOTE_SIZE, true), f64::max))
        .collect();
    let total = widths.iter().sum::<f64>() + GAP * header.len().saturating_sub(1) as f64;
    let height = 2.0 * EDGE + ROW * (rows.len() + 1) as f64;
    let mut page = Drawing::new((total + 2.0 * EDGE).ceil(), height, 2.0);
    for (line, width) in [(0, 1.2), (1, 0.8), (rows.len() + 1, 1.2)] {
        let y = EDGE + ROW * line as f64;
        page.line([[EDGE, y], [EDGE + total, y]], Stroke::solid(theme::INK, width));
    }
    let mut left = EDGE;
    for (column, (title, width)) in header.iter().zip(&widths).enumerate() {
        let (x, anchor) = if column == 0 { (left, Anchor::Start) } else { (left + width, Anchor::End) };
        let at = |line: usize| [x, EDGE + ROW * (line as f64 + 0.5)];
        page.text(Text::new(at(0), theme::NOTE_SIZE, *title).held(anchor, Level::Middle).bold());
        for (i, row) in rows.iter().enumerate() {
            let Some(cell) = row.get(column) else { continue };
            page.text(Text::new(at(i + 1), theme::NOTE_SIZE, cell.clone()).held(anchor, Level::Middle));
        }
        left += width + GAP;
    }
    page
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Item;
    use super::*;

    #[test]
    fn cells_stand_in_columns_on_the_page() {
        let rows = [vec!["copper".to_owned(), "0.2".to_owned()], vec!["Au".to_owned()]];
        let page = table(&["metal", "/{η}"], &rows);
        let texts: Vec<&Text> =
            page.items.iter().filter_map(|item| if let Item::Text(text) = item { Some(text) } else { None }).collect();
        assert_eq!(texts.len(), 5);
        let ends = texts.iter().map(|t| t.at[0] + t.start() + t.width());
        assert!(ends.clone().all(|end| end <= page.width - EDGE + 1e-9), "{:?}", ends.collect::<Vec<_>>());
        assert_eq!(texts[0].at[0], texts[1].at[0]);
        assert!(table(&[], &[]).png().is_ok());
    }
}
