//! A page: its size and a flat list of shapes, text and images, painted in order on its paper.
//!
//! Lengths are drawing units: [`Page::unit`] CSS pixels in SVG and PDF, [`Page::scale`] pixels in PNG. The origin is the
//! top left corner, y points down.

use super::rgb8::Rgb8;
use super::shapes::{Colour, Marker, Paint, Point, Rect, Stroke, Text};
use super::style::{Room, Style};
use super::theme;
use etalon_core::error::{Error, Result};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Formats of figures, by the extensions of their files.
pub const FORMATS: [&str; 3] = ["svg", "png", "pdf"];

/// PNG pixels per drawing unit where neither an image nor a style decides.
pub(super) const PIXELS: f64 = 2.0;

/// One thing on the page.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// A line through the points, back to the first one when `closed`.
    Path {
        points: Vec<Point>,
        closed: bool,
        paint: Paint,
    },
    Rect {
        rect: Rect,
        paint: Paint,
    },
    Circle {
        centre: Point,
        radius: f64,
        paint: Paint,
    },
    Text(Text),
    /// An image stretched over `rect`; enlarged pixels stay sharp squares.
    Image {
        rect: Rect,
        image: Rgb8,
    },
}

impl Item {
    fn moved(mut self, dx: f64, dy: f64) -> Self {
        let shift = |p: &mut Point| *p = [p[0] + dx, p[1] + dy];
        match &mut self {
            Item::Path { points, .. } => points.iter_mut().for_each(shift),
            Item::Rect { rect, .. } | Item::Image { rect, .. } => *rect = rect.moved(dx, dy),
            Item::Circle { centre, .. } => shift(centre),
            Item::Text(text) => shift(&mut text.at),
        }
        self
    }

    /// The item enlarged about the origin, with its lines and its type. Dashes keep their length.
    fn scaled(mut self, factor: f64) -> Self {
        let scale = |p: &mut Point| *p = p.map(|v| v * factor);
        match &mut self {
            Item::Path { points, .. } => points.iter_mut().for_each(scale),
            Item::Rect { rect, .. } | Item::Image { rect, .. } => *rect = rect.scaled(factor),
            Item::Circle { centre, radius, .. } => {
                scale(centre);
                *radius *= factor;
            }
            Item::Text(text) => {
                scale(&mut text.at);
                text.size *= factor;
            }
        }
        if let Item::Path { paint, .. } | Item::Rect { paint, .. } | Item::Circle { paint, .. } = &mut self {
            paint.stroke.iter_mut().for_each(|stroke| stroke.width *= factor);
        }
        self
    }
}

/// A page with its items, painted in order.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Page {
    pub width: f64,
    pub height: f64,
    /// PNG pixels per drawing unit.
    pub scale: f64,
    /// CSS pixels per drawing unit.
    pub unit: f64,
    pub paper: Colour,
    /// The PNG file has at most 256 colours and is a third as large.
    pub few_colours: bool,
    /// From the lowest to the topmost.
    pub items: Vec<Item>,
}

impl Page {
    pub fn new(width: f64, height: f64, scale: f64) -> Self {
        Self { width, height, scale, unit: 1.0, paper: Colour::WHITE, few_colours: false, items: Vec::new() }
    }

    /// A page of the image's size in units, filled by it; pixel (x, y) covers `[x, x + 1] x [y, y + 1]`.
    pub fn over(image: Rgb8) -> Self {
        let (width, height) = (image.width() as f64, image.height() as f64);
        let mut page = Self::new(width, height, 1.0);
        page.image(Rect::new(0.0, 0.0, width, height), image);
        page
    }

    /// Pages below each other; `align` is 0 for their left edges in line, 0.5 for their middles.
    pub(super) fn stacked(rows: Vec<Page>, align: f64) -> Self {
        let width = rows.iter().map(|row| row.width).fold(0.0, f64::max);
        let mut page = Self::new(width, 0.0, PIXELS);
        for row in rows {
            let y = page.height;
            page.height += row.height;
            let x = align * (width - row.width);
            page.append(row, x, y);
        }
        page
    }

    /// Pages side by side, their upper edges in line.
    pub(super) fn beside(columns: Vec<Page>) -> Self {
        let height = columns.iter().map(|column| column.height).fold(0.0, f64::max);
        let mut page = Self::new(0.0, height, PIXELS);
        for column in columns {
            let x = page.width;
            page.width += column.width;
            page.append(column, x, 0.0);
        }
        page
    }

    /// The page in the middle of one of the style's size: as high as its content where the style does not say.
    pub(super) fn within(self, style: &Style) -> Self {
        let Room { width, height, .. } = style.room;
        if width.is_infinite() {
            return self;
        }
        let height = if style.is_fixed { height } else { self.height };
        let mut page = Self::new(width, height, self.scale);
        let [x, y] = [width - self.width, height - self.height].map(|rest| (0.5 * rest).max(0.0));
        page.append(self, x, y);
        page
    }

    /// Adds an item above the others. One with a coordinate that is not finite has no place on the page and is dropped.
    fn add(&mut self, item: Item) {
        let finite = |values: &[f64]| values.iter().all(|v| v.is_finite());
        let placed = match &item {
            Item::Path { points, .. } => points.iter().all(|p| finite(p)),
            Item::Rect { rect, .. } | Item::Image { rect, .. } => finite(&[rect.x, rect.y, rect.width, rect.height]),
            Item::Circle { centre, radius, .. } => finite(&[centre[0], centre[1], *radius]),
            Item::Text(text) => finite(&text.at),
        };
        if placed {
            self.items.push(item);
        }
    }

    pub fn line(&mut self, points: impl Into<Vec<Point>>, stroke: Stroke) {
        self.add(Item::Path { points: points.into(), closed: false, paint: stroke.into() });
    }

    pub fn polygon(&mut self, points: impl Into<Vec<Point>>, paint: impl Into<Paint>) {
        self.add(Item::Path { points: points.into(), closed: true, paint: paint.into() });
    }

    pub fn rect(&mut self, rect: Rect, paint: impl Into<Paint>) {
        self.add(Item::Rect { rect, paint: paint.into() });
    }

    pub fn circle(&mut self, centre: Point, radius: f64, paint: impl Into<Paint>) {
        self.add(Item::Circle { centre, radius, paint: paint.into() });
    }

    /// A data point's marker.
    pub fn marker(&mut self, centre: Point, radius: f64, marker: Marker, colour: Colour) {
        let corners = marker.corners(radius);
        if corners.is_empty() {
            self.circle(centre, radius, marker.paint(colour));
        } else {
            let moved = |corner: Point| [centre[0] + corner[0], centre[1] + corner[1]];
            self.polygon(corners.into_iter().map(moved).collect::<Vec<_>>(), marker.paint(colour));
        }
    }

    pub fn text(&mut self, text: Text) {
        self.add(Item::Text(text));
    }

    pub fn image(&mut self, rect: Rect, image: Rgb8) {
        self.add(Item::Image { rect, image });
    }

    pub(super) fn darkened(mut self) -> Self {
        let area = |colour: Colour| match colour {
            Colour { alpha, .. } if colour == Colour::WHITE.with_alpha(alpha) => theme::DARK_PAPER.with_alpha(alpha),
            other => theme::in_the_dark(other),
        };
        for item in &mut self.items {
            match item {
                Item::Path { paint, .. } | Item::Rect { paint, .. } | Item::Circle { paint, .. } => {
                    paint.fill = paint.fill.map(area);
                    paint.stroke.iter_mut().for_each(|stroke| stroke.colour = theme::in_the_dark(stroke.colour));
                }
                Item::Text(text) => text.colour = theme::in_the_dark(text.colour),
                Item::Image { .. } => {}
            }
        }
        Self { paper: theme::DARK_PAPER, ..self }
    }

    /// The page with everything on it enlarged.
    pub(super) fn scaled(self, factor: f64) -> Self {
        let items = self.items.into_iter().map(|item| item.scaled(factor)).collect();
        Self { width: self.width * factor, height: self.height * factor, items, ..self }
    }

    pub fn append(&mut self, other: Page, dx: f64, dy: f64) {
        self.items.extend(other.items.into_iter().map(|item| item.moved(dx, dy)));
    }

    /// The page as a file of one of [`FORMATS`].
    ///
    /// # Errors
    /// [`Error::Parameter`] for another format, and for a page that has no size that can be painted ([`Page::png`]).
    fn document(&self, format: &str) -> Result<Vec<u8>> {
        match format {
            "svg" => Ok(self.svg().into_bytes()),
            "png" => self.png(),
            "pdf" => Ok(self.pdf()),
            _ => Err(Error::parameter("format", format!("\"{format}\" is not a format of figures"))
                .with_hint(format!("formats: {}", FORMATS.join(", ")))),
        }
    }

    /// Writes `stem.svg` and so on, in `formats` of [`FORMATS`], and returns their paths in this order.
    /// The same page gives the same bytes.
    ///
    /// # Errors
    /// When a format is another, a file cannot be written, or the page has no size that can be painted ([`Page::png`]).
    pub fn write(&self, stem: &Path, formats: &[&str]) -> Result<Vec<PathBuf>> {
        if stem.file_name().is_none() {
            return Err(Error::parameter("figure", format!("{}: not a file name", stem.display()))
                .with_hint("give a name to write to"));
        }
        let documents: Vec<Result<Vec<u8>>> = formats.par_iter().map(|format| self.document(format)).collect();
        let write = |(format, bytes): (&&str, Result<Vec<u8>>)| {
            let path = with_extension(stem, format);
            etalon_core::files::write_bytes(&path, &bytes?).map(|()| path)
        };
        formats.iter().zip(documents).map(write).collect()
    }
}

/// `stem` with an extension added (a dot inside the stem stays).
pub fn with_extension(stem: &Path, extension: &str) -> PathBuf {
    let mut path = stem.as_os_str().to_owned();
    path.push(".");
    path.push(extension);
    path.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_are_appended_to_the_stem() {
        let dir = tempfile::tempdir().unwrap();
        let mut drawing = Page::new(20.0, 10.0, 2.0);
        drawing.text(Text::new([1.0, 8.0], 8.0, "a"));
        let paths = drawing.write(&dir.path().join("new/roughness-0.005"), &FORMATS).unwrap();
        let names: Vec<_> = paths.iter().map(|p| p.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, ["roughness-0.005.svg", "roughness-0.005.png", "roughness-0.005.pdf"]);
        assert!(paths.iter().all(|p| p.metadata().unwrap().len() > 100));
        assert!(drawing.write(Path::new("/"), &FORMATS).is_err());
        assert!(drawing.write(&dir.path().join("a"), &["gif"]).unwrap_err().to_string().contains("gif"));
    }

    #[test]
    fn items_without_a_place_are_dropped() {
        let mut drawing = Page::new(10.0, 10.0, 1.0);
        drawing.line([[0.0, 0.0], [f64::NAN, 1.0]], Stroke::solid(Colour::BLACK, 1.0));
        drawing.circle([0.0, f64::INFINITY], 1.0, Colour::BLACK);
        drawing.text(Text::new([f64::NAN, 0.0], 8.0, "a"));
        assert!(drawing.items.is_empty());
    }

    #[test]
    fn stacked_drawings_touch_and_line_up() {
        let row = |width, height| {
            let mut drawing = Page::new(width, height, 1.0);
            drawing.rect(Rect::new(1.0, 2.0, 3.0, 4.0), Colour::BLACK);
            drawing
        };
        for (align, left) in [(0.0, [1.0, 1.0, 1.0]), (0.5, [6.0, 1.0, 11.0])] {
            let page = Page::stacked(vec![row(20.0, 10.0), row(30.0, 5.0), row(10.0, 6.0)], align);
            assert_eq!((page.width, page.height), (30.0, 21.0));
            let rect = |x, y| Item::Rect { rect: Rect::new(x, y, 3.0, 4.0), paint: Colour::BLACK.into() };
            assert_eq!(page.items, [rect(left[0], 2.0), rect(left[1], 12.0), rect(left[2], 17.0)]);
        }
    }

    #[test]
    fn every_format_is_the_same_at_every_call() {
        let mut drawing = Page::new(80.0, 40.0, 2.0);
        drawing.text(Text::new([1.0, 20.0], 12.0, "/{R}_{∥} **bold**").bold());
        drawing.text(Text::new([1.0, 30.0], 12.0, "/{R}_{∥}"));
        drawing.rect(Rect::new(3.0, 3.0, 10.0, 10.0), Colour::BLACK.faded(0.3));
        drawing.circle([30.0, 20.0], 5.0, Colour::BLACK.faded(0.7));
        drawing.image(Rect::new(50.0, 3.0, 10.0, 10.0), Rgb8::from_fn(2, 2, |x, y| [x as u8 * 255, y as u8 * 255, 9]));
        assert_eq!(drawing.svg(), drawing.svg());
        assert_eq!(drawing.png().unwrap(), drawing.png().unwrap());
        assert_eq!(drawing.pdf(), drawing.pdf());
    }
}
