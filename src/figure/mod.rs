//! Everything that draws: curves, heat maps, overlays and contact sheets, as SVG, PNG and PDF from one list of shapes.

pub mod axis;
pub mod backend;
mod clip;
pub mod colourmap;
pub mod drawing;
mod occupancy;
mod pdf;
mod png;
mod svg;
pub mod text;
pub mod theme;
mod ticks;

pub use axis::{Axis, Scale};
pub use drawing::{Anchor, Colour, Drawing, Item, Level, Paint, Point, Rect, Rgb8, Stroke, Text};
