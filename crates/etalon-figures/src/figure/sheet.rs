//! Contact sheets: captioned images in a grid, for comparing renders by eye; and tables: columns of text between rules, as in
//! print.

use super::drawing::Drawing;
use super::rgb8::Rgb8;
use super::shapes::{Anchor, Level, Rect, Stroke, Text};
use super::{text, theme};
use etalon_bench::table::{Column, Table};
use image::imageops::{self, FilterType};

/// Widest image on the sheet, and widest row of images, in PNG pixels; wider ones are reduced, narrower ones enlarged by whole
/// factors.
const WIDEST: usize = 640;
const WIDEST_ROW: usize = 2000;
/// PNG pixels per unit.
const SCALE: f64 = 2.0;
const EDGE: f64 = 12.0;
const GAP: f64 = 14.0;
const LINE: f64 = 16.0;

/// Draws captioned images in rows of `columns` (at least one), with an optional title. Captions may carry the markup of
/// [`super::text`] and are broken between words where they are wider than their image.
pub fn contact_sheet(title: &str, columns: usize, images: &[(String, Rgb8)]) -> Drawing {
    let columns = columns.clamp(1, images.len().max(1));
    let limit = WIDEST.min(WIDEST_ROW / columns);
    let shown: Vec<Rgb8> = images.iter().map(|(_, image)| reduced(image, limit)).collect();
    let size = |image: &Rgb8| size(image, limit);
    let widest = shown.iter().map(|image| size(image)[0]).fold(60.0, f64::max);
    let cell = widest.max(text::width(title, theme::TITLE_SIZE, true) / columns as f64 - GAP);
    let captioned = |((caption, _), image): (&(String, Rgb8), Rgb8)| (size(&image), image, wrapped(caption, cell));
    let cells: Vec<([f64; 2], Rgb8, Vec<String>)> = images.iter().zip(shown).map(captioned).collect();

    // Rows of images, aligned at the bottom, with their captions below
    let mut page = Drawing::new(0.0, 0.0, SCALE);
    let mut y = if title.is_empty() { EDGE } else { EDGE + theme::TITLE_SIZE + GAP };
    for row in cells.chunks(columns) {
        let tallest = row.iter().map(|([_, h], ..)| *h).fold(0.0, f64::max);
        let lines = row.iter().map(|(.., caption)| caption.len()).max().unwrap_or(0);
        for (i, ([w, h], image, caption)) in row.iter().enumerate() {
            let x = EDGE + i as f64 * (cell + GAP);
            let left = (x + (cell - w) / 2.0).round();
            page.image(Rect::new(left, y + (tallest - h).round(), *w, *h), image.clone());
            for (line, text) in caption.iter().enumerate() {
                let at = [x + cell / 2.0, y + tallest + 7.0 + LINE * line as f64];
                page.text(Text::new(at, theme::TICK_SIZE, text.clone()).held(Anchor::Middle, Level::Top));
            }
        }
        y += (tallest + 7.0 + LINE * lines as f64 + GAP).ceil();
    }
    // The title in the page's middle
    page.width = (2.0 * EDGE + columns as f64 * (cell + GAP) - GAP).ceil();
    page.height = (y - GAP + EDGE - 2.0).ceil();
    if !title.is_empty() {
        let text = Text::new([page.width / 2.0, EDGE], theme::TITLE_SIZE, title).held(Anchor::Middle, Level::Top);
        page.text(text.bold());
    }
    page
}

/// The image at no more than `widest` pixels across.
fn reduced(image: &Rgb8, widest: usize) -> Rgb8 {
    if image.width() <= widest {
        return image.clone();
    }
    let height = (image.height() * widest / image.width()).max(1);
    imageops::resize(image.pixels(), widest as u32, height as u32, FilterType::Triangle).into()
}

/// Size on the sheet in units: a whole number of PNG pixels for each pixel.
fn size(image: &Rgb8, widest: usize) -> [f64; 2] {
    let zoom = (widest / image.width()).max(1) as f64;
    [image.width() as f64 * zoom / SCALE, image.height() as f64 * zoom / SCALE]
}

/// Breaks a caption between words into lines of at most `width` (a single word may be wider).
pub fn wrapped(caption: &str, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    // At blanks only: others, as the one between a number and its unit, hold words together.
    for word in caption.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if text::width(&format!("{line} {word}"), theme::TICK_SIZE, false) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

const TABLE_EDGE: f64 = 14.0;
const ROW: f64 = 20.0;
/// Between columns.
const COLUMN_GAP: f64 = 26.0;

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
    let total = widths.iter().sum::<f64>() + COLUMN_GAP * columns.len().saturating_sub(1) as f64;
    let height = 2.0 * TABLE_EDGE + ROW * (rows + 1) as f64;
    let mut page = Drawing::new((total + 2.0 * TABLE_EDGE).ceil(), height, 2.0);
    for (line, width) in [(0, 1.2), (1, 0.8), (rows + 1, 1.2)] {
        let y = TABLE_EDGE + ROW * line as f64;
        page.line([[TABLE_EDGE, y], [TABLE_EDGE + total, y]], Stroke::solid(theme::INK, width));
    }
    let mut left = TABLE_EDGE;
    for (column, width) in columns.iter().zip(&widths) {
        let (x, anchor) = if column.is_number { (left + width, Anchor::End) } else { (left, Anchor::Start) };
        let text = |line: usize, text: &str| {
            let at = [x, TABLE_EDGE + ROW * (line as f64 + 0.5)];
            Text::new(at, theme::NOTE_SIZE, text).held(anchor, Level::Middle)
        };
        page.text(text(0, &column.heading).bold());
        column.cells.iter().enumerate().for_each(|(i, cell)| page.text(text(i + 1, cell)));
        left += width + COLUMN_GAP;
    }
    page
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Item;
    use super::*;

    #[test]
    fn small_images_are_enlarged_by_whole_factors_and_large_ones_reduced() {
        let grey = |width| Rgb8::from_fn(width, 10, |_, _| [99; 3]);
        let sheet = contact_sheet("", 2, &[("a".into(), grey(200)), ("b".into(), grey(640)), ("c".into(), grey(2000))]);
        let width = |item: &Item| if let Item::Image { rect, .. } = item { Some(rect.width * SCALE) } else { None };
        assert_eq!(sheet.items.iter().filter_map(width).collect::<Vec<_>>(), [600.0, 640.0, 640.0]);
        let many: Vec<_> = (0..4).map(|_| (String::new(), grey(160))).collect();
        let sheet = contact_sheet("", 4, &many);
        assert_eq!(sheet.items.iter().find_map(width), Some(480.0), "rows of many images stay on the page");
    }

    #[test]
    fn captions_are_broken_between_words() {
        let lines = wrapped("one two three four five six seven eight nine", 100.0);
        assert!(lines.len() > 1);
        assert!(lines.iter().all(|line| text::width(line, theme::TICK_SIZE, false) <= 100.0), "{lines:?}");
        assert_eq!(lines.join(" "), "one two three four five six seven eight nine");
        assert!(wrapped("about 13.5\u{a0}% of the light", 1.0).contains(&"13.5\u{a0}%".to_owned()));
    }

    #[test]
    fn an_empty_sheet_can_be_painted() {
        assert!(contact_sheet("", 0, &[]).png().is_ok());
        assert!(contact_sheet("only a title", 3, &[]).png().is_ok());
    }

    #[test]
    fn cells_stand_in_columns_on_the_page() {
        let rows = [("copper", "0.2"), ("Au", "")];
        let page = table(&Table::of(&rows).words("metal", |row| row.0).numbers("/{η}", |row| row.1));
        let texts: Vec<&Text> =
            page.items.iter().filter_map(|item| if let Item::Text(text) = item { Some(text) } else { None }).collect();
        assert_eq!(texts.len(), 6);
        let ends = texts.iter().map(|t| t.at[0] + t.start() + t.width());
        assert!(ends.clone().all(|end| end <= page.width - TABLE_EDGE + 1e-9), "{:?}", ends.collect::<Vec<_>>());
        assert_eq!(texts[0].at[0], texts[1].at[0]);
        assert!(table(&Table::of(&rows[..0])).png().is_ok());
    }
}
