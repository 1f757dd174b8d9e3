//! A panel: two axes, a title, and the marks between them.

use super::axis::{Axis, Span};
use super::heatmap::Heatmap;
use super::shapes::{Colour, Marker, Point, Stroke};
use super::theme;

/// One thing drawn between the axes, in the axes' own values. An empty label keeps it out of the legend.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Mark {
    Line { label: String, stroke: Stroke, points: Vec<Point> },
    Dots { label: String, colour: Colour, marker: Marker, points: Vec<Point> },
    Band { label: String, colour: Colour, points: Vec<[f64; 3]> },
    Bars { label: String, colour: Colour, edges: Vec<f64>, heights: Vec<f64> },
    Vertical { at: f64, label: String, above: Option<Stroke> },
    Horizontal { at: f64, label: String },
    Shade { from: f64, to: f64, colour: Colour },
    Note { at: Point, text: String, colour: Colour },
}

/// A chart with its own axes. Marks are added by chaining; areas are painted below lines, lines below dots, and
/// within each kind in the order in which they were added. All labels may carry the markup of [`super::text`].
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Panel {
    pub(super) title: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) marks: Vec<Mark>,
    /// Drawn below the marks, in place of the grid lines.
    pub(super) heatmap: Option<Heatmap>,
    /// Curves have their names where they run, if there is room.
    pub(super) names_curves: bool,
}

impl Panel {
    pub fn new(x: Axis, y: Axis) -> Self {
        Self { title: String::new(), x, y, marks: Vec::new(), heatmap: None, names_curves: false }
    }

    /// A title in bold type; what follows its first line stands below that in plain type.
    pub fn title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    fn with(mut self, mark: Mark) -> Self {
        self.marks.push(mark);
        self
    }

    /// A curve through `points`; a point that is not finite (or has no place on a logarithmic axis) breaks it.
    pub fn line(self, label: impl Into<String>, stroke: Stroke, points: impl Into<Vec<Point>>) -> Self {
        self.with(Mark::Line { label: label.into(), stroke, points: points.into() })
    }

    /// Scattered dots. Under the label of a line they share its legend entry.
    pub fn dots(self, label: impl Into<String>, colour: Colour, points: impl Into<Vec<Point>>) -> Self {
        self.markers(label, colour, Marker::Disc, points)
    }

    /// Scattered points of another shape.
    pub fn markers(
        self,
        label: impl Into<String>,
        colour: Colour,
        marker: Marker,
        points: impl Into<Vec<Point>>,
    ) -> Self {
        self.with(Mark::Dots { label: label.into(), colour, marker, points: points.into() })
    }

    /// A curve through `points`, each with the marker of its stroke.
    pub fn dotted_line(self, label: impl Into<String>, stroke: Stroke, points: impl Into<Vec<Point>>) -> Self {
        let (label, points) = (label.into(), points.into());
        self.line(label.clone(), stroke, points.clone()).markers(label, stroke.colour, theme::marker(stroke), points)
    }

    /// A curve through `[x, low, value, high]` at the values, with a pale band from low to high.
    pub fn banded_line(self, label: impl Into<String>, stroke: Stroke, points: &[[f64; 4]]) -> Self {
        let band: Vec<_> = points.iter().map(|&[x, low, _, high]| [x, low, high]).collect();
        let line: Vec<_> = points.iter().map(|&[x, _, value, _]| [x, value]).collect();
        self.band("", stroke.colour, band).line(label, stroke, line)
    }

    /// A pale band between two curves, from `[x, lower, upper]`.
    pub fn band(self, label: impl Into<String>, colour: Colour, points: impl Into<Vec<[f64; 3]>>) -> Self {
        self.with(Mark::Band { label: label.into(), colour, points: points.into() })
    }

    /// A histogram: bar `i` stands from `edges[i]` to `edges[i + 1]`, `heights[i]` high; bars beyond the shorter list
    /// are left out.
    pub fn bars(self, label: impl Into<String>, colour: Colour, edges: Vec<f64>, heights: Vec<f64>) -> Self {
        self.with(Mark::Bars { label: label.into(), colour, edges, heights })
    }

    /// A vertical reference line with its label beside it, where nothing else is drawn.
    pub fn vertical(self, at: f64, label: impl Into<String>) -> Self {
        self.with(Mark::Vertical { at, label: label.into(), above: None })
    }

    /// A vertical line of its own stroke, above all other marks, with its label beside it.
    pub fn vertical_above(self, at: f64, label: impl Into<String>, stroke: Stroke) -> Self {
        self.with(Mark::Vertical { at, label: label.into(), above: Some(stroke) })
    }

    /// A pale background from one x to another; labels may stand on it.
    pub fn shade(self, from: f64, to: f64, colour: Colour) -> Self {
        self.with(Mark::Shade { from, to, colour })
    }

    /// A horizontal reference line with its label above or below it, where nothing else is drawn.
    pub fn horizontal(self, at: f64, label: impl Into<String>) -> Self {
        self.with(Mark::Horizontal { at, label: label.into() })
    }

    /// A text in the free place nearest to a point.
    pub fn note(self, at: Point, text: impl Into<String>, colour: Colour) -> Self {
        self.with(Mark::Note { at, text: text.into(), colour })
    }

    /// Writes the names of curves where they run, if there is room for all; else all are in a legend.
    pub fn with_names_on_curves(self) -> Self {
        Self { names_curves: true, ..self }
    }

    /// A heat map that fills the frame, with a colour bar beside it. Axes without a range count columns from the left and
    /// rows from the top; for row 0 at the top give the y axis the range from the last row's value to the first's.
    pub fn heatmap(self, heatmap: Heatmap) -> Self {
        Self { heatmap: Some(heatmap), ..self }
    }

    pub(super) fn spans(&self) -> (Span, Span) {
        if let Some(map) = &self.heatmap {
            let (columns, rows) = (map.columns() as f64, map.rows() as f64);
            return (self.x.span_or(0.0, columns), self.y.span_or(rows, 0.0));
        }
        // Dots keep off the frame; lines and bars use its full width.
        let margin = if self.marks.iter().any(|m| matches!(m, Mark::Dots { .. })) { 0.04 } else { 0.0 };
        let xs = self.marks.iter().flat_map(|mark| mark.extent(0));
        let ys = self.marks.iter().flat_map(|mark| mark.extent(1));
        (self.x.span(xs, margin), self.y.span(ys, 0.05))
    }
}

impl Mark {
    /// What the legend calls this mark.
    pub(super) fn label(&self) -> &str {
        match self {
            Mark::Line { label, .. }
            | Mark::Dots { label, .. }
            | Mark::Band { label, .. }
            | Mark::Bars { label, .. } => label,
            Mark::Vertical { .. } | Mark::Horizontal { .. } | Mark::Shade { .. } | Mark::Note { .. } => "",
        }
    }

    /// The values that the x axis (0) or the y axis (1) must include.
    fn extent(&self, axis: usize) -> Vec<f64> {
        match (self, axis) {
            (Mark::Line { points, .. } | Mark::Dots { points, .. }, _) => points.iter().map(|p| p[axis]).collect(),
            (Mark::Band { points, .. }, 0) => points.iter().map(|p| p[0]).collect(),
            (Mark::Band { points, .. }, _) => points.iter().flat_map(|p| [p[1], p[2]]).collect(),
            (Mark::Bars { edges, .. }, 0) => edges.clone(),
            (Mark::Bars { heights, .. }, _) => heights.iter().copied().chain([0.0]).collect(),
            (Mark::Vertical { at, .. }, 0) | (Mark::Horizontal { at, .. }, 1) => vec![*at],
            (Mark::Vertical { .. } | Mark::Horizontal { .. } | Mark::Shade { .. } | Mark::Note { .. }, _) => Vec::new(),
        }
    }
}
