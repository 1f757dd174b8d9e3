//! Styles: the page that a figure is laid out for. All type and all lines have one size in drawing units; a style says how
//! large the page is in these units, and how large a unit is.

use etalon_core::error::{Error, Result};

/// Where a figure is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Medium {
    /// As large as its content.
    #[default]
    Screen,
    /// A page of 16:9, read from afar.
    Slide,
    /// A column of a paper.
    Column,
}

impl Medium {
    pub const ALL: [(&str, &str, Self); 3] = [
        ("screen", "As large as its content, for screens and web pages", Self::Screen),
        (
            "slide",
            "16:9, type of at least 3 % of the height (indices 2.3 %); what does not fit goes to further slides",
            Self::Slide,
        ),
        (
            "column",
            "84 mm wide, type of at least 7 pt (indices 5.5 pt), for a column of a paper; what is too high goes to further files",
            Self::Column,
        ),
    ];
}

/// The colours of paper and ink.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Theme {
    #[default]
    Light,
    Dark,
}

impl Theme {
    pub const ALL: [(&str, &str, Self); 2] = [("light", "", Self::Light), ("dark", "", Self::Dark)];
}

/// How a figure is laid out and coloured, and which of its panels are shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Style {
    /// Stands above the figure, in place of the title that it would have; empty for that one.
    pub title: String,
    /// Parts of the titles of the panels that are shown; all panels if empty.
    pub panels: Vec<String>,
    pub theme: Theme,
    /// The page, in drawing units.
    pub(super) room: Room,
    /// The page is as high as the room, whatever its content.
    pub(super) is_fixed: bool,
    /// The height over the width above which what can be divided is.
    pub(super) tallest: f64,
    /// CSS pixels per drawing unit.
    pub(super) unit: f64,
}

/// The room on a page for what is laid out, in drawing units; infinite where the content decides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Room {
    pub width: f64,
    pub height: f64,
    /// PNG pixels per drawing unit, if the page decides.
    pub pixels: Option<f64>,
}

impl Room {
    pub const UNLIMITED: Self = Self { width: f64::INFINITY, height: f64::INFINITY, pixels: None };
}

const CSS_PER_MM: f64 = 96.0 / 25.4;
/// Widths in millimetres: of a column, and of a slide of 13⅓ inches.
const COLUMN: f64 = 84.0;
const SLIDE: f64 = 1280.0 / CSS_PER_MM;
/// The least width in millimetres that a style may ask for, and the largest.
pub const WIDTHS: [f64; 2] = [30.0, 2000.0];
/// CSS pixels per unit in a column: the smallest type, of 11.5 units, has 7.1 pt.
const COLUMN_UNIT: f64 = 0.823;
/// The height of a figure in a column over its width.
const COLUMN_TALLEST: f64 = 1.5;
/// Units of a slide's height: the smallest type is 3.04 % of it.
const SLIDE_HEIGHT: f64 = 378.0;
/// PNG pixels per inch of a column, and along the width of a slide.
const COLUMN_DPI: f64 = 300.0;
const SLIDE_PIXELS: f64 = 1920.0;

impl Default for Style {
    fn default() -> Self {
        let (title, panels) = (String::new(), Vec::new());
        let (is_fixed, tallest) = (false, f64::INFINITY);
        Self { title, panels, theme: Theme::Light, room: Room::UNLIMITED, is_fixed, tallest, unit: 1.0 }
    }
}

impl Style {
    /// The style of a medium, on a page of its usual width, or of another in millimetres.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the width is out of range.
    pub fn new(medium: Medium, width: Option<f64>) -> Result<Self> {
        let [least, most] = WIDTHS;
        if let Some(mm) = width.filter(|mm| !(least..=most).contains(mm)) {
            return Err(Error::parameter("page_width", format!("{mm} mm: not between {least} and {most} mm")));
        }
        let page = |unit: f64, mm: f64, height: f64, pixels: Option<f64>| {
            let room = Room { width: mm * CSS_PER_MM / unit, height, pixels };
            Self { room, is_fixed: height.is_finite(), unit, ..Self::default() }
        };
        Ok(match (medium, width) {
            (Medium::Screen, None) => Self::default(),
            (Medium::Screen, Some(mm)) => page(1.0, mm, f64::INFINITY, None),
            (Medium::Column, _) => {
                let pixels = COLUMN_DPI / 96.0 * COLUMN_UNIT;
                let column = page(COLUMN_UNIT, width.unwrap_or(COLUMN), f64::INFINITY, Some(pixels));
                Self { tallest: COLUMN_TALLEST, ..column }
            }
            (Medium::Slide, _) => {
                let (mm, units) = (width.unwrap_or(SLIDE), SLIDE_HEIGHT * 16.0 / 9.0);
                page(mm * CSS_PER_MM / units, mm, SLIDE_HEIGHT, Some(SLIDE_PIXELS / units))
            }
        })
    }

    /// The same, with this title if it has none.
    #[must_use]
    pub fn or_title(self, title: &str) -> Self {
        if self.title.is_empty() { Self { title: title.to_owned(), ..self } } else { self }
    }

    /// The same for a figure with other panels, all of which are shown.
    #[must_use]
    pub fn with_all_panels(self) -> Self {
        Self { panels: Vec::new(), ..self }
    }

    /// The width of the page in millimetres.
    pub(super) fn width_mm(&self) -> f64 {
        self.room.width * self.unit / CSS_PER_MM
    }
}
