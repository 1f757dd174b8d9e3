//! Primitives of drawings: colours, strokes, rectangles, text.

use super::text;

/// A point in drawing units.
pub type Point = [f64; 2];

/// An sRGB colour with opacity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Colour {
    /// Red.
    pub r: u8,
    /// Green.
    pub g: u8,
    /// Blue.
    pub b: u8,
    /// Opacity: 0 is invisible, 255 covers what lies below.
    pub alpha: u8,
}

impl Colour {
    /// Black.
    pub const BLACK: Colour = Colour::rgb(0, 0, 0);
    /// White.
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
    /// Its colour.
    pub colour: Colour,
    /// Width.
    pub width: f64,
    /// Alternating lengths of dashes and gaps; empty for a solid line.
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
    /// The inside, if it is filled.
    pub fill: Option<Colour>,
    /// The outline, if there is one.
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
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

impl Rect {
    /// A rectangle by its upper left corner and its size.
    #[must_use]
    pub const fn new(x: f64, y: f64, width: f64, height: f64) -> Self {
        Self { x, y, width, height }
    }

    /// x of the right edge.
    #[must_use]
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    /// y of the lower edge.
    #[must_use]
    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }

    /// The point in its middle.
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

/// The horizontal anchor of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// At its start.
    Start,
    /// In its middle.
    Middle,
    /// At its end.
    End,
}

/// The vertical anchor of a text.
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
    /// The anchor.
    pub at: Point,
    /// The text with its markup.
    pub markup: String,
    /// Font size in drawing units.
    pub size: f64,
    /// Its colour.
    pub colour: Colour,
    /// Which point of the line is at the anchor.
    pub anchor: Anchor,
    /// Which height of the letters is at the anchor.
    pub level: Level,
    /// Whether the text runs upwards, turned by 90° about its point.
    pub upwards: bool,
    /// Whether it is bold.
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

    /// The same in another colour.
    #[must_use]
    pub fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    /// The same in bold letters.
    #[must_use]
    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    /// The same, running upwards.
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
