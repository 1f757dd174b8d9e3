//! Heat maps: a grid of values as colours.

use super::axis::{Axis, Span};
use super::colourmap;
use super::rgb8::Rgb8;
use super::shapes::Colour;
use super::theme;

/// How values become colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shading {
    /// From dark to light, in equal steps of the value.
    Linear,
    /// From dark to light, in equal factors; values that are not positive have no colour.
    Log10,
    /// From blue through white at zero to red, equally far to both sides.
    Diverging,
}

/// A grid of values, row 0 at the top. What is not finite is shown in [`theme::NO_VALUE`].
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Heatmap {
    columns: usize,
    values: Vec<f64>,
    shading: Shading,
    pub(super) label: String,
    range: Option<(f64, f64)>,
}

impl Heatmap {
    /// A map of `values`, row by row from the top; `label` stands beside the colour bar. Cells that have no value, as in a last
    /// row that is not full, are not finite.
    pub fn new(columns: usize, values: Vec<f64>, shading: Shading, label: impl Into<String>) -> Self {
        Self { columns: columns.max(1), values, shading, label: label.into(), range: None }
    }

    /// Spreads the colours over this range instead of that of the values; values outside take the colour of the nearest end.
    pub fn range(self, lo: f64, hi: f64) -> Self {
        Self { range: Some((lo, hi)), ..self }
    }

    pub fn columns(&self) -> usize {
        self.columns
    }

    pub fn rows(&self) -> usize {
        self.values.len().div_ceil(self.columns).max(1)
    }

    pub(super) fn axis(&self) -> Axis {
        let axis = if self.shading == Shading::Log10 { Axis::log("") } else { Axis::linear("") };
        match (self.range, self.shading) {
            (Some((lo, hi)), _) => axis.range(lo, hi),
            (None, Shading::Diverging) => {
                let largest = self.values.iter().filter(|v| v.is_finite()).fold(0.0f64, |m, v| m.max(v.abs()));
                axis.range(-largest, largest)
            }
            (None, _) => axis,
        }
    }

    pub(super) fn span(&self) -> Span {
        self.axis().span(self.values.iter().copied(), 0.0)
    }

    /// Whether both maps show the same colours for the same values, so that one colour bar serves both.
    pub(super) fn has_scale_of(&self, other: &Self) -> bool {
        self.shading == other.shading && self.label == other.label && self.span() == other.span()
    }

    /// The colour at a position along the colour bar, from 0 to 1.
    pub(super) fn colour(&self, position: f64) -> [u8; 3] {
        let Colour { r, g, b, .. } = match self.shading {
            _ if position.is_nan() => theme::NO_VALUE,
            Shading::Diverging => colourmap::diverging(2.0 * position - 1.0),
            Shading::Linear | Shading::Log10 => colourmap::sequential(position),
        };
        [r, g, b]
    }

    /// The map as an image, one pixel for each value.
    pub fn image(&self) -> Rgb8 {
        let span = self.span();
        Rgb8::from_fn(self.columns, self.rows(), |x, y| {
            let value = self.values.get(y * self.columns + x).filter(|value| value.is_finite());
            self.colour(value.map_or(f64::NAN, |&value| span.position(value)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_gaps_have_their_colours() {
        let map = Heatmap::new(2, vec![0.0, 1.0, f64::NAN, 0.5], Shading::Linear, "p");
        let image = map.image();
        let colours =
            [colourmap::sequential(0.0), colourmap::sequential(1.0), theme::NO_VALUE, colourmap::sequential(0.5)];
        let bytes: Vec<u8> = colours.iter().flat_map(|c| [c.r, c.g, c.b]).collect();
        assert_eq!((image.width(), image.height(), image.pixels().as_raw()), (2, 2, &bytes));
    }

    #[test]
    fn a_diverging_map_is_neutral_at_zero() {
        let map = Heatmap::new(3, vec![-1.0, 0.0, 4.0], Shading::Diverging, "");
        let Colour { r, g, b, .. } = colourmap::diverging(0.0);
        assert_eq!(map.colour(map.span().position(0.0)), [r, g, b]);
        assert_eq!((map.span().lo(), map.span().hi()), (-4.0, 4.0));
    }

    #[test]
    fn odd_grids_and_values_are_drawn_somehow() {
        for shading in [Shading::Linear, Shading::Log10, Shading::Diverging] {
            for values in [&[][..], &[0.0], &[-1.0], &[f64::NAN], &[f64::INFINITY, 1.0, 2.0], &[f64::MAX]] {
                let map = |columns| Heatmap::new(columns, values.into(), shading, "").image();
                assert_eq!(map(0), map(1));
                assert_eq!((map(2).width(), map(2).height()), (2, values.len().div_ceil(2).max(1)));
            }
        }
    }
}
