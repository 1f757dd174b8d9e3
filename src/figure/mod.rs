//! Everything that draws: curves, heat maps, overlays and contact sheets, as SVG, PNG and PDF from one list of shapes.

pub mod axis;
pub mod backend;
mod chart;
mod clip;
pub mod colourmap;
pub mod drawing;
mod frame;
mod heatmap;
mod legend;
mod occupancy;
mod overlay;
mod panel;
mod pdf;
mod plot;
mod png;
mod sheet;
mod svg;
pub mod text;
pub mod theme;
mod ticks;

pub use axis::{Axis, Scale};
pub use drawing::{Anchor, Colour, Drawing, Item, Level, Paint, Point, Rect, Rgb8, Stroke, Text};
pub use heatmap::{Heatmap, Shading};
pub use overlay::overlay;
pub use panel::Panel;
pub use plot::Plot;
pub use sheet::contact_sheet;
