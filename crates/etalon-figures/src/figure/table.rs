//! Tables: columns of text between rules, as in print.

use super::drawing::Drawing;
use super::shapes::{Anchor, Level, Stroke, Text};
use super::text;
use super::theme;
use etalon_bench::table::{Column, Table};

const EDGE: f64 = 14.0;
const ROW: f64 = 20.0;
/// Between columns.
const GAP: f64 = 26.0;

/// Draws a table: words begin at the left end of their column, numbers end at its right end. Cells may carry the markup of
/// [`super::text`].
pub fn table<T>(table: &Table<'_, T>) -> Drawing {
    let columns = &table.columns;
    let rows = columns.first().map_or(0, |column| column.cells.len());
    let width = |column: &Column| {
        let cells = column.cells.iter().map(|cell| text::width(cell, theme::NOTE_SIZE, false));
        cells.fold(text::width(&column.heading, theme::NOTE_SIZE, true), f64::max)
    };
    let widths: Vec<f64> = columns.iter().map(width).collect();
    let total = widths.iter().sum::<f64>() + GAP * columns.len().saturating_sub(1) as f64;
    let height = 2.0 * EDGE + ROW * (rows + 1) as f64;
    let mut page = Drawing::new((total + 2.0 * EDGE).ceil(), height, 2.0);
    for (line, width) in [(0, 1.2), (1, 0.8), (rows + 1, 1.2)] {
        let y = EDGE + ROW * line as f64;
        page.line([[EDGE, y], [EDGE + total, y]], Stroke::solid(theme::INK, width));
    }
    let mut left = EDGE;
    for (column, width) in columns.iter().zip(&widths) {
        let (x, anchor) = if column.is_number { (left + width, Anchor::End) } else { (left, Anchor::Start) };
        let text = |line: usize, text: &str| {
            let at = [x, EDGE + ROW * (line as f64 + 0.5)];
            Text::new(at, theme::NOTE_SIZE, text).held(anchor, Level::Middle)
        };
        page.text(text(0, &column.heading).bold());
        column.cells.iter().enumerate().for_each(|(i, cell)| page.text(text(i + 1, cell)));
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
        let rows = [("copper", "0.2"), ("Au", "")];
        let page = table(&Table::of(&rows).words("metal", |row| row.0).numbers("/{η}", |row| row.1));
        let texts: Vec<&Text> =
            page.items.iter().filter_map(|item| if let Item::Text(text) = item { Some(text) } else { None }).collect();
        assert_eq!(texts.len(), 6);
        let ends = texts.iter().map(|t| t.at[0] + t.start() + t.width());
        assert!(ends.clone().all(|end| end <= page.width - EDGE + 1e-9), "{:?}", ends.collect::<Vec<_>>());
        assert_eq!(texts[0].at[0], texts[1].at[0]);
        assert!(table(&Table::of(&rows[..0])).png().is_ok());
    }
}
