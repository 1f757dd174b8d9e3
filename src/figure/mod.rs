//! Everything that draws: curves, heat maps, overlays and contact sheets, as SVG, PNG and PDF from one list of shapes.

pub mod drawing;
mod pdf;
mod png;
mod svg;
pub mod text;

pub use drawing::{Anchor, Colour, Drawing, Item, Level, Paint, Point, Rect, Rgb8, Stroke, Text};
