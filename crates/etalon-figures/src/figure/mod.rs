//! Everything that draws: curves, heat maps, overlays and contact sheets, as SVG, PNG and PDF from one list of shapes.

mod axis;
mod backend;
mod chart;
mod drawing;
mod frame;
mod heatmap;
mod legend;
mod marks;
mod page;
mod panel;
mod pdf;
mod picture;
mod plot;
mod png;
mod rgb8;
mod shapes;
mod sheet;
pub mod style;
mod svg;
pub mod text;
pub mod theme;

pub use axis::Axis;
pub use drawing::{Drawing, Wanted, write_pages};
pub use heatmap::{Heatmap, Shading};
#[cfg(test)]
pub use page::Item;
pub use page::{FORMATS, Page, with_extension};
pub use panel::Panel;
pub use picture::Picture;
pub use plot::Plot;
pub use rgb8::Rgb8;
pub use shapes::{Anchor, Colour, Level, Marker, Point, Rect, Stroke, Text};
pub use sheet::{contact_sheet, image_rows};
pub use style::Style;
pub use svg::{escape, with_dark_colours};
