//! Contact sheets: captioned images in a grid, for comparing renders by eye; and tables: columns of text between rules, as in
//! print.

use super::drawing::{Drawing, Keep};
use super::page::{PIXELS, Page};
use super::rgb8::Rgb8;
use super::shapes::{Anchor, Level, Rect, Text};
use super::style::Room;
use super::{text, theme};
use image::imageops::{self, FilterType};

/// Widest image on the sheet, and widest row of images, in PNG pixels; wider ones are reduced, narrower ones enlarged by whole
/// factors.
const WIDEST: usize = 640;
const WIDEST_ROW: usize = 2000;
/// Narrowest cell, and lowest image, on a page of limited size.
const NARROWEST: f64 = 110.0;
const LOWEST: f64 = 100.0;
const EDGE: f64 = 12.0;
const GAP: f64 = 14.0;
const LINE: f64 = 16.0;
const TITLE_LINE: f64 = 18.0;

/// Captioned images in rows of `columns`, with an optional title.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Sheet {
    pub title: String,
    pub columns: usize,
    pub images: Vec<(String, Rgb8)>,
    /// Rows are not divided: each row of a page has one of them, several, or one image.
    pub keeps_rows: bool,
}

/// Captioned images in rows of at most `columns` (at least one), with an optional title. Captions may carry the markup of
/// [`super::text`] and are broken between words where they are wider than their image.
pub fn contact_sheet(title: &str, columns: usize, images: &[(String, Rgb8)]) -> Drawing {
    Drawing::Sheet(Sheet {
        title: title.into(),
        columns: columns.clamp(1, images.len().max(1)),
        images: images.to_vec(),
        keeps_rows: false,
    })
}

/// The same, of images that belong together row by row.
pub fn image_rows(title: &str, columns: usize, images: &[(String, Rgb8)]) -> Drawing {
    match contact_sheet(title, columns, images) {
        Drawing::Sheet(sheet) => Drawing::Sheet(Sheet { keeps_rows: true, ..sheet }),
        other => other,
    }
}

impl Sheet {
    /// The images whose caption `keep` wants.
    pub(super) fn select(&self, groups: &[&str], keep: &mut Keep) -> Option<Self> {
        let mut is_kept =
            |(caption, _): &&(String, Rgb8)| keep(&[groups, &[self.title.as_str(), caption.as_str()]].concat());
        let images: Vec<_> = self.images.iter().filter(&mut is_kept).cloned().collect();
        let columns = self.columns.min(images.len());
        (!images.is_empty()).then_some(Self { columns, images, ..self.clone() })
    }

    /// The images that pages are divided between.
    pub(super) fn unit(&self) -> usize {
        if self.keeps_rows { self.columns } else { 1 }
    }

    /// The columns that rows of a page may have.
    fn is_whole(&self, columns: usize) -> bool {
        !self.keeps_rows || columns == 1 || columns.is_multiple_of(self.columns)
    }

    /// The page for a room: in limited room images fill its width, or are as large as its height allows.
    pub(super) fn laid(&self, room: Room) -> Page {
        if room.width.is_infinite() {
            return self.page(self.columns, WIDEST.min(WIDEST_ROW / self.columns) as f64, [f64::INFINITY; 2], room);
        }
        let cell = |columns: usize| {
            let columns = columns as f64;
            (room.width - 2.0 * EDGE - GAP * (columns - 1.0)) / columns
        };
        let pixels = room.pixels.unwrap_or(PIXELS);
        let page = |columns: usize, high: f64| self.page(columns, cell(columns) * pixels, [cell(columns), high], room);
        if room.height.is_infinite() {
            let fits = |columns: &usize| cell(*columns) >= NARROWEST && self.is_whole(*columns);
            let columns = (1..=self.columns).rev().find(fits).unwrap_or(1);
            // In even rows
            let rows = self.images.len().div_ceil(columns).max(1);
            let even = self.images.len().div_ceil(rows).max(1);
            return page(if self.is_whole(even) { even } else { columns }, f64::INFINITY);
        }
        // The largest images that fit
        let highs = (0..20).map(|i| room.height * 0.9f64.powi(i)).filter(|&high| high >= LOWEST);
        let fits = |n: &usize| cell(*n) >= NARROWEST && self.is_whole(*n);
        let fit = |high: f64| (1..=self.images.len()).filter(fits).map(move |n| (n, high));
        // Images end at the width of their cells, too
        let aspect = |image: &Rgb8| image.height() as f64 / image.width() as f64;
        let flattest = self.images.iter().map(|(_, image)| aspect(image)).fold(f64::INFINITY, f64::min);
        let height = |(columns, high): &(usize, f64)| high.min(flattest * cell(*columns));
        let mut sizes: Vec<(usize, f64)> = highs.flat_map(fit).collect();
        sizes.sort_by(|a, b| height(b).total_cmp(&height(a)));
        let mut pages = sizes.into_iter().map(|(columns, high)| page(columns, high));
        pages.find(|page| page.height <= room.height).unwrap_or_else(|| page(self.columns, LOWEST))
    }

    /// A page with images of at most `limit` PNG pixels across, in cells of a width and at most a height.
    fn page(&self, columns: usize, limit: f64, [width, high]: [f64; 2], room: Room) -> Page {
        let pixels = room.pixels.unwrap_or(PIXELS);
        let fit = |image: &Rgb8| limit.min(high * pixels * image.width() as f64 / image.height() as f64) as usize;
        let shown: Vec<Rgb8> = self.images.iter().map(|(_, image)| reduced(image, fit(image).max(1))).collect();
        // On a page of limited width images fill their cells
        let is_filled = width.is_finite();
        let size = |image: &Rgb8| size(image, fit(image), pixels, is_filled);
        let widest = shown.iter().map(|image| size(image)[0]).fold(60.0, f64::max);
        let title_width = text::width(&self.title, theme::TITLE_SIZE, true);
        let natural = widest.max(title_width / columns as f64 - GAP);
        let cell = if width.is_finite() { width } else { natural };
        let captioned = |((caption, _), image): (&(String, Rgb8), Rgb8)| {
            (size(&image), image, text::wrapped(caption, theme::TICK_SIZE, false, cell))
        };
        let cells: Vec<([f64; 2], Rgb8, Vec<String>)> = self.images.iter().zip(shown).map(captioned).collect();

        // The title in the middle of the page
        let mut page = Page::new((2.0 * EDGE + columns as f64 * (cell + GAP) - GAP).ceil(), 0.0, PIXELS);
        let mut y = EDGE;
        let title = &self.title;
        let limit = if width.is_finite() { page.width - 2.0 * EDGE } else { f64::INFINITY };
        for line in text::wrapped(title, theme::TITLE_SIZE, true, limit).into_iter().filter(|line| !line.is_empty()) {
            let text = Text::new([page.width / 2.0, y], theme::TITLE_SIZE, line).held(Anchor::Middle, Level::Top);
            page.text(text.bold());
            y += TITLE_LINE;
        }
        if !title.is_empty() {
            y += theme::TITLE_SIZE + GAP - TITLE_LINE;
        }
        // Rows of images, aligned at the bottom, with their captions below
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
        page.height = (y - GAP + EDGE - 2.0).ceil();
        page
    }
}

/// The image at no more than `widest` pixels across.
fn reduced(image: &Rgb8, widest: usize) -> Rgb8 {
    if image.width() <= widest {
        return image.clone();
    }
    let height = (image.height() * widest / image.width()).max(1);
    imageops::resize(image.pixels(), widest as u32, height as u32, FilterType::Triangle).into()
}

/// Size on the sheet in units: a whole number of PNG pixels for each pixel; where images fill their cells, of small ones only.
fn size(image: &Rgb8, widest: usize, pixels: f64, is_filled: bool) -> [f64; 2] {
    const SMALL: f64 = 4.0;
    let zoom = (widest as f64 / image.width() as f64).max(1.0);
    let zoom = if is_filled && zoom < SMALL { zoom } else { zoom.floor() };
    [image.width() as f64 * zoom / pixels, image.height() as f64 * zoom / pixels]
}

#[cfg(test)]
mod tests {
    use super::super::page::Item;
    use super::*;

    #[test]
    fn small_images_are_enlarged_by_whole_factors_and_large_ones_reduced() {
        let grey = |width| Rgb8::from_fn(width, 10, |_, _| [99; 3]);
        let images = [("a".into(), grey(200)), ("b".into(), grey(640)), ("c".into(), grey(2000))];
        let sheet = contact_sheet("", 2, &images).laid(Room::UNLIMITED);
        let width = |item: &Item| if let Item::Image { rect, .. } = item { Some(rect.width * PIXELS) } else { None };
        assert_eq!(sheet.items.iter().filter_map(width).collect::<Vec<_>>(), [600.0, 640.0, 640.0]);
        let many: Vec<_> = (0..4).map(|_| (String::new(), grey(160))).collect();
        let sheet = contact_sheet("", 4, &many).laid(Room::UNLIMITED);
        assert_eq!(sheet.items.iter().find_map(width), Some(480.0), "rows of many images stay on the page");
    }

    /// The numbers of images in the rows of a page.
    fn rows(page: &Page) -> Vec<usize> {
        let top = |item: &Item| if let Item::Image { rect, .. } = item { Some(rect.bottom()) } else { None };
        let tops: Vec<f64> = page.items.iter().filter_map(top).collect();
        tops.chunk_by(|a, b| a == b).map(<[f64]>::len).collect()
    }

    #[test]
    fn images_that_belong_together_stay_in_a_row_and_others_stand_in_even_rows() {
        let images = |count: usize| {
            let one = (String::new(), Rgb8::from_fn(48, 36, |_, _| [99; 3]));
            vec![one; count]
        };
        let slide = Room { width: 672.0, height: 378.0, pixels: Some(2.857) };
        let triples = rows(&image_rows("", 3, &images(9)).laid(slide));
        assert!(triples.iter().all(|count| count % 3 == 0), "{triples:?}");
        let column = Room { width: 386.0, height: f64::INFINITY, pixels: Some(2.57) };
        assert_eq!(rows(&image_rows("", 3, &images(6)).laid(column)), [3, 3]);
        assert_eq!(rows(&contact_sheet("", 5, &images(4)).laid(column)), [2, 2]);
    }

    #[test]
    fn images_fill_their_cells_on_a_page_of_limited_width() {
        let image = Rgb8::from_fn(480, 360, |_, _| [99; 3]);
        let pair = [(String::new(), image.clone()), (String::new(), image)];
        let page = image_rows("", 2, &pair).laid(Room { width: 672.0, height: 378.0, pixels: Some(2.857) });
        let width = |item: &Item| if let Item::Image { rect, .. } = item { Some(rect.width) } else { None };
        let widths: Vec<f64> = page.items.iter().filter_map(width).collect();
        assert!(widths.iter().all(|width| *width > 300.0), "{widths:?}");
    }

    #[test]
    fn an_empty_sheet_can_be_painted() {
        assert!(contact_sheet("", 0, &[]).laid(Room::UNLIMITED).png().is_ok());
        assert!(contact_sheet("only a title", 3, &[]).laid(Room::UNLIMITED).png().is_ok());
    }
}
