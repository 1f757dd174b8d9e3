//! Primitives of drawings: colours, strokes, rectangles, text.

use super::text;

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
    /// The colour of text, frames and ticks.
    pub const INK: Colour = Colour::rgb(38, 38, 38);

    pub const fn rgb(r: u8, g: u8, b: u8) -> Self {
        Self { r, g, b, alpha: 255 }
    }

    /// The same colour at another opacity, from 0 to 1.
    pub fn faded(self, opacity: f64) -> Self {
        self.with_alpha((opacity * 255.0).round() as u8)
    }

    pub const fn with_alpha(self, alpha: u8) -> Self {
        Self { alpha, ..self }
    }
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    pub colour: Colour,
    pub width: f64,
    /// Alternating lengths of dashes and gaps; empty for a solid line.
    pub dash: &'static [f64],
}

impl Stroke {
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

/// The shape of a data point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    Disc,
    Square,
    Diamond,
    Triangle,
    /// A triangle on its tip.
    Wedge,
    /// A circle, for points that stand apart from those with a filled marker.
    Open,
}

impl Marker {
    /// The corners about the origin of a shape that looks as large as a disc of this radius; a circle has none.
    pub fn corners(self, radius: f64) -> Vec<Point> {
        let [side, tip] = [0.9 * radius, 1.3 * radius];
        match self {
            Self::Disc | Self::Open => Vec::new(),
            Self::Square => vec![[-side, -side], [side, -side], [side, side], [-side, side]],
            Self::Diamond => vec![[0.0, -tip], [tip, 0.0], [0.0, tip], [-tip, 0.0]],
            Self::Triangle => vec![[0.0, -tip], [tip, side], [-tip, side]],
            Self::Wedge => vec![[0.0, tip], [tip, -side], [-tip, -side]],
        }
    }

    pub fn paint(self, colour: Colour) -> Paint {
        if self == Self::Open { Stroke::solid(colour, 1.3).into() } else { colour.into() }
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
    /// A rectangle by its upper left corner and its size.
    pub const fn new(x: f64, y: f64, width: f64, height: f64) -> Self {
        Self { x, y, width, height }
    }

    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }

    pub fn centre(&self) -> Point {
        [self.x + self.width / 2.0, self.y + self.height / 2.0]
    }

    pub fn contains(&self, [x, y]: Point) -> bool {
        (self.x..=self.right()).contains(&x) && (self.y..=self.bottom()).contains(&y)
    }

    /// Distance of a point from the rectangle; 0 inside.
    pub fn distance(&self, [x, y]: Point) -> f64 {
        let beyond = |v: f64, from: f64, to: f64| (from - v).max(v - to).max(0.0);
        beyond(x, self.x, self.right()).hypot(beyond(y, self.y, self.bottom()))
    }

    /// The rectangle with every side moved outwards by `margin` (inwards when negative).
    pub fn grown(&self, margin: f64) -> Self {
        Self::new(self.x - margin, self.y - margin, self.width + 2.0 * margin, self.height + 2.0 * margin)
    }

    pub fn moved(&self, dx: f64, dy: f64) -> Self {
        Self { x: self.x + dx, y: self.y + dy, ..*self }
    }

    /// The rectangle enlarged about the origin.
    pub fn scaled(&self, factor: f64) -> Self {
        Self::new(self.x * factor, self.y * factor, self.width * factor, self.height * factor)
    }
}

/// The horizontal anchor of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
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
    /// The lowest point of letters.
    Bottom,
}

/// One line of text, with the markup of [`text`].
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Text {
    pub at: Point,
    pub markup: String,
    /// Font size in drawing units.
    pub size: f64,
    pub colour: Colour,
    /// Which point of the line is at `at`.
    pub anchor: Anchor,
    /// Which height of the letters is at `at`.
    pub level: Level,
    /// Whether the text is turned by 90° about `at`.
    pub upwards: bool,
    pub bold: bool,
}

impl Text {
    /// Text in the colour of ink that starts at `at`, on the baseline.
    pub fn new(at: Point, size: f64, markup: impl Into<String>) -> Self {
        let (anchor, level) = (Anchor::Start, Level::Baseline);
        Self { at, markup: markup.into(), size, colour: Colour::INK, anchor, level, upwards: false, bold: false }
    }

    pub fn held(self, anchor: Anchor, level: Level) -> Self {
        Self { anchor, level, ..self }
    }

    pub fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    pub fn upwards(self) -> Self {
        Self { upwards: true, ..self }
    }

    pub fn width(&self) -> f64 {
        text::width(&self.markup, self.size, self.bold)
    }

    /// Where the line starts, along itself from the point.
    pub fn start(&self) -> f64 {
        match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -self.width() / 2.0,
            Anchor::End => -self.width(),
        }
    }

    /// How far the baseline lies below the point, before turning.
    pub fn drop(&self) -> f64 {
        match self.level {
            Level::Baseline => 0.0,
            Level::Middle => self.size * (text::CAP_HEIGHT / 2.0),
            Level::Top => self.size * text::CAP_HEIGHT,
            Level::Bottom => -self.size * text::DESCENT,
        }
    }
}
