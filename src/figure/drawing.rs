//! A drawing: a page size and a flat list of shapes, text and images, painted in order on white.
//!
//! Lengths are drawing units: CSS pixels in SVG, 0.75 pt in PDF, [`Drawing::scale`] pixels in PNG. The origin is the
//! top left corner, y points down.

use super::text;
use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// A point in drawing units.
pub type Point = [f64; 2];

/// An sRGB colour with opacity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Colour {
    pub r: u8,
    pub g: u8,
    pub b: u8,
    /// Opacity: 0 is invisible, 255 covers what lies below.
    pub alpha: u8,
}

impl Colour {
    pub const BLACK: Colour = Colour::rgb(0, 0, 0);
    pub const WHITE: Colour = Colour::rgb(255, 255, 255);

    /// An opaque colour.
    #[must_use]
    pub const fn rgb(r: u8, g: u8, b: u8) -> Self {
        Self { r, g, b, alpha: 255 }
    }

    /// The same colour at another opacity, from 0 to 1.
    #[must_use]
    pub fn faded(self, opacity: f64) -> Self {
        Self { alpha: (opacity * 255.0).round() as u8, ..self }
    }
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    pub colour: Colour,
    pub width: f64,
    /// Lengths of dashes and gaps in turn; empty for a solid line.
    pub dash: &'static [f64],
}

impl Stroke {
    /// A solid line.
    #[must_use]
    pub const fn solid(colour: Colour, width: f64) -> Self {
        Self { colour, width, dash: &[] }
    }
}

/// How a shape is drawn: its inside, its outline, or both.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Paint {
    pub fill: Option<Colour>,
    pub stroke: Option<Stroke>,
}

impl From<Colour> for Paint {
    fn from(fill: Colour) -> Self {
        Self { fill: Some(fill), stroke: None }
    }
}

impl From<Stroke> for Paint {
    fn from(stroke: Stroke) -> Self {
        Self { fill: None, stroke: Some(stroke) }
    }
}

/// A rectangle with sides parallel to the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rect {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

impl Rect {
    #[must_use]
    pub const fn new(x: f64, y: f64, width: f64, height: f64) -> Self {
        Self { x, y, width, height }
    }

    #[must_use]
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    #[must_use]
    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }

    #[must_use]
    pub fn centre(&self) -> Point {
        [self.x + self.width / 2.0, self.y + self.height / 2.0]
    }

    /// The rectangle with every side moved outwards by `margin` (inwards when negative).
    #[must_use]
    pub fn grown(&self, margin: f64) -> Self {
        Self::new(self.x - margin, self.y - margin, self.width + 2.0 * margin, self.height + 2.0 * margin)
    }

    /// The rectangle moved by (dx, dy).
    #[must_use]
    pub fn moved(&self, dx: f64, dy: f64) -> Self {
        Self { x: self.x + dx, y: self.y + dy, ..*self }
    }
}

/// Which end of the text stands at its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// Which height of the text stands at its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// The line that letters stand on.
    Baseline,
    /// Half the height of a capital letter.
    Middle,
    /// The top of a capital letter.
    Top,
}

/// One line of text, with the markup of [`text`].
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    pub at: Point,
    pub markup: String,
    /// Font size in drawing units.
    pub size: f64,
    pub colour: Colour,
    pub anchor: Anchor,
    pub level: Level,
    /// Whether the text runs upwards, turned by 90° about its point.
    pub upwards: bool,
    pub bold: bool,
}

impl Text {
    /// Black text that starts at `at`, on the baseline.
    #[must_use]
    pub fn new(at: Point, size: f64, markup: impl Into<String>) -> Self {
        let (anchor, level) = (Anchor::Start, Level::Baseline);
        Self { at, markup: markup.into(), size, colour: Colour::BLACK, anchor, level, upwards: false, bold: false }
    }

    /// The same text, held at another end and height.
    #[must_use]
    pub fn held(self, anchor: Anchor, level: Level) -> Self {
        Self { anchor, level, ..self }
    }

    #[must_use]
    pub fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    #[must_use]
    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    #[must_use]
    pub fn upwards(self) -> Self {
        Self { upwards: true, ..self }
    }

    /// Length of the line in drawing units.
    #[must_use]
    pub fn width(&self) -> f64 {
        text::width(&self.markup, self.size, self.bold)
    }

    /// How far the baseline lies below the point, before turning.
    #[must_use]
    pub fn drop(&self) -> f64 {
        self.size
            * match self.level {
                Level::Baseline => 0.0,
                Level::Middle => text::CAP_HEIGHT / 2.0,
                Level::Top => text::CAP_HEIGHT,
            }
    }
}

/// An 8-bit RGB image (sRGB, three bytes a pixel, row 0 at the top).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rgb8 {
    width: usize,
    height: usize,
    data: Vec<u8>,
}

impl Rgb8 {
    /// Wraps `data`.
    ///
    /// # Panics
    /// When a side is 0 or `data.len() != 3 * width * height`: a bug of the caller, never of an input file.
    #[must_use]
    pub fn new(width: usize, height: usize, data: Vec<u8>) -> Self {
        assert!(width > 0 && height > 0 && data.len() == 3 * width * height, "{width}x{height}, {} bytes", data.len());
        Self { width, height, data }
    }

    /// Evaluates `f(x, y)` at every pixel.
    #[must_use]
    pub fn from_fn(width: usize, height: usize, f: impl Fn(usize, usize) -> [u8; 3]) -> Self {
        let data = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| f(x, y)).collect();
        Self::new(width, height, data)
    }

    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// The bytes, row by row from the top.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        &self.data
    }
}

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
    /// The same item, moved by (dx, dy).
    #[must_use]
    pub fn moved(mut self, dx: f64, dy: f64) -> Self {
        let shift = |p: &mut Point| *p = [p[0] + dx, p[1] + dy];
        match &mut self {
            Item::Path { points, .. } => points.iter_mut().for_each(shift),
            Item::Rect { rect, .. } | Item::Image { rect, .. } => *rect = rect.moved(dx, dy),
            Item::Circle { centre, .. } => shift(centre),
            Item::Text(text) => shift(&mut text.at),
        }
        self
    }
}

/// A page with its items, painted in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    width: f64,
    height: f64,
    /// PNG pixels per drawing unit.
    scale: f64,
    items: Vec<Item>,
}

impl Drawing {
    /// An empty white page; `scale` is the number of PNG pixels per drawing unit.
    #[must_use]
    pub fn new(width: f64, height: f64, scale: f64) -> Self {
        Self { width, height, scale, items: Vec::new() }
    }

    #[must_use]
    pub fn width(&self) -> f64 {
        self.width
    }

    #[must_use]
    pub fn height(&self) -> f64 {
        self.height
    }

    /// PNG pixels per drawing unit.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    #[must_use]
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// Adds an item above the others. One with a coordinate that is not finite has no place on the page and is dropped.
    pub fn add(&mut self, item: Item) {
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

    /// Adds an open line through `points`.
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

    pub fn text(&mut self, text: Text) {
        self.add(Item::Text(text));
    }

    pub fn image(&mut self, rect: Rect, image: Rgb8) {
        self.add(Item::Image { rect, image });
    }

    /// Adds all items of another drawing, moved by (dx, dy).
    pub fn append(&mut self, other: Drawing, dx: f64, dy: f64) {
        self.items.extend(other.items.into_iter().map(|item| item.moved(dx, dy)));
    }

    /// Writes `stem.svg`, `stem.png` and `stem.pdf` and returns their paths in this order.
    ///
    /// The extension is appended: a dot inside the stem (`roughness-0.005`) stays. The same drawing gives the same bytes.
    ///
    /// # Errors
    /// When a file cannot be written, or the page has no size that can be painted ([`Drawing::png`]).
    pub fn write(&self, stem: &Path) -> Result<Vec<PathBuf>> {
        let name = stem.file_name().ok_or_else(|| {
            Error::parameter("figure", format!("{}: not a file name", stem.display()))
                .with_hint("give a name to write to")
        })?;
        let files = [("svg", self.svg().into_bytes()), ("png", self.png()?), ("pdf", self.pdf())];
        let mut written = Vec::with_capacity(files.len());
        for (extension, bytes) in files {
            let mut full = name.to_os_string();
            full.push(".");
            full.push(extension);
            let path = stem.with_file_name(full);
            crate::files::write_bytes(&path, &bytes)?;
            written.push(path);
        }
        Ok(written)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_are_appended_to_the_stem() {
        let dir = tempfile::tempdir().unwrap();
        let mut drawing = Drawing::new(20.0, 10.0, 2.0);
        drawing.text(Text::new([1.0, 8.0], 8.0, "a"));
        let paths = drawing.write(&dir.path().join("new/roughness-0.005")).unwrap();
        let names: Vec<_> = paths.iter().map(|p| p.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, ["roughness-0.005.svg", "roughness-0.005.png", "roughness-0.005.pdf"]);
        assert!(paths.iter().all(|p| p.metadata().unwrap().len() > 100));
        assert!(drawing.write(Path::new("/")).is_err());
    }

    #[test]
    fn items_without_a_place_are_dropped() {
        let mut drawing = Drawing::new(10.0, 10.0, 1.0);
        drawing.line([[0.0, 0.0], [f64::NAN, 1.0]], Stroke::solid(Colour::BLACK, 1.0));
        drawing.circle([0.0, f64::INFINITY], 1.0, Colour::BLACK);
        drawing.text(Text::new([f64::NAN, 0.0], 8.0, "a"));
        assert!(drawing.items().is_empty());
    }

    #[test]
    fn every_format_is_the_same_at_every_call() {
        let mut drawing = Drawing::new(80.0, 40.0, 2.0);
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
