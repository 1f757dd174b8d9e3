//! Everything that draws: curves, heat maps, overlays and contact sheets, as SVG, PNG and PDF from one list of shapes.

mod axis;
mod backend;
mod chart;
mod drawing;
mod frame;
mod heatmap;
mod legend;
mod marks;
mod panel;
mod pdf;
mod plot;
mod png;
mod rgb8;
mod shapes;
mod sheet;
mod svg;
pub mod text;
pub mod theme;

pub use axis::Axis;
#[cfg(test)]
pub use drawing::Item;
pub use drawing::{Drawing, with_extension};
pub use heatmap::{Heatmap, Shading};
pub use panel::Panel;
pub use plot::Plot;
pub use rgb8::Rgb8;
pub use shapes::{Anchor, Colour, Level, Marker, Point, Rect, Stroke, Text};
pub use sheet::{contact_sheet, table, wrapped};
pub use svg::escape;
pub use svg::with_dark_colours;
