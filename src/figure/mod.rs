//! Everything that draws: curves, heat maps, overlays and contact sheets, as SVG, PNG and PDF from one list of shapes.

pub mod axis;
pub mod backend;
mod chart;
mod clip;
mod colour_bar;
pub mod colourmap;
pub mod drawing;
mod frame;
mod heatmap;
mod legend;
mod marks;
mod occupancy;
mod overlay;
mod panel;
mod pdf;
mod pdf_font;
mod plot;
mod png;
mod rgb8;
pub mod shapes;
mod sheet;
mod svg;
pub mod text;
pub mod theme;
mod ticks;

pub use axis::{Axis, Scale};
pub use drawing::{Drawing, Item, with_extension};
pub use heatmap::{Heatmap, Shading};
pub use overlay::overlay;
pub use panel::Panel;
pub use plot::Plot;
pub use rgb8::Rgb8;
pub use shapes::{Anchor, Colour, Level, Paint, Point, Rect, Stroke, Text};
pub use sheet::contact_sheet;
pub(crate) use svg::{base64, escape};
