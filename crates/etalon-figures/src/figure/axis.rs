//! Axes: label, range, ticks, and the position of a value along them.

use super::ticks::{self, Ticks};

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps of the value.
    Linear,
    /// Equal factors are equally long; values that are not positive have no place.
    Log10,
}

/// An axis of a panel.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Axis {
    pub(super) label: String,
    pub(super) scale: Scale,
    range: Option<(f64, f64)>,
    every: Option<f64>,
    at: Vec<f64>,
    names: Vec<String>,
}

impl Axis {
    /// A linear axis that shows all the data. `label` may carry the markup of [`super::text`].
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None, every: None, at: Vec::new(), names: Vec::new() }
    }

    /// A logarithmic axis that shows all positive data.
    pub fn log(label: impl Into<String>) -> Self {
        Self { scale: Scale::Log10, ..Self::linear(label) }
    }

    /// Shows exactly this range; from a higher to a lower value runs the axis backwards.
    pub fn range(self, from: f64, to: f64) -> Self {
        Self { range: Some((from, to)), ..self }
    }

    /// Puts a labelled tick at every multiple of `step` (linear axes).
    pub fn every(self, step: f64) -> Self {
        Self { every: Some(step), ..self }
    }

    /// A y axis of named places instead of numbers, the first at the top: place `i` lies at `i` + ½.
    pub fn named(label: impl Into<String>, names: impl Into<Vec<String>>) -> Self {
        let names = names.into();
        Self { range: Some((names.len() as f64, 0.0)), names, ..Self::linear(label) }
    }

    /// Puts labelled ticks only at these values.
    pub fn at(self, places: impl Into<Vec<f64>>) -> Self {
        Self { at: places.into(), ..self }
    }

    /// The range that [`Axis::range`] set, or `from` to `to`.
    pub(super) fn span_or(&self, from: f64, to: f64) -> Span {
        let (from, to) = self.range.unwrap_or((from, to));
        Span::new(from, to, self.scale)
    }

    /// The range to show: the one that [`Axis::range`] set, or that of the data with `margin` (a fraction of it) at both ends.
    pub(super) fn span(&self, data: impl Iterator<Item = f64>, margin: f64) -> Span {
        match self.range {
            Some((from, to)) => Span::new(from, to, self.scale),
            None => Span::around(data, margin, self.scale),
        }
    }

    /// Up to about `most` labelled ticks, at their positions along `span`.
    pub(super) fn ticks(&self, span: &Span, most: usize) -> Ticks {
        let mut ticks = match (self.scale, self.every) {
            _ if !self.names.is_empty() => ticks::named(&self.names),
            _ if !self.at.is_empty() => ticks::at(span.lo(), span.hi(), &self.at),
            (Scale::Log10, _) => ticks::log(span.lo(), span.hi(), most),
            (Scale::Linear, Some(step)) => ticks::every(span.lo(), span.hi(), step),
            (Scale::Linear, None) => ticks::linear(span.lo(), span.hi(), most),
        };
        ticks.major.iter_mut().map(|tick| &mut tick.at).chain(&mut ticks.minor).for_each(|at| *at = span.position(*at));
        ticks
    }
}

/// A range that can be drawn: finite, not empty, positive when logarithmic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    from: f64,
    to: f64,
    scale: Scale,
}

impl Span {
    /// The nearest range that can be drawn: ends that are not finite are taken from the other end or
    /// from 0 to 1 (1 to 10 on a logarithmic scale), and an empty range is widened about its value.
    pub fn new(from: f64, to: f64, scale: Scale) -> Self {
        let usable = |v: f64| v.is_finite() && (scale == Scale::Linear || v > 0.0);
        let (least, most) = if scale == Scale::Linear { (-1e300, 1e300) } else { (1e-300, 1e300) };
        let (from, to) = match (usable(from), usable(to)) {
            (true, true) => (from.clamp(least, most), to.clamp(least, most)),
            // With one end missing, show six decades below the other
            (false, true) if scale == Scale::Log10 => ((to * 1e-6).clamp(least, most), to.clamp(least, most)),
            (true, false) if scale == Scale::Log10 => (from.clamp(least, most), (from * 1e-6).clamp(least, most)),
            (true, false) => (from.clamp(least, most), from.clamp(least, most)),
            (false, true) => (to.clamp(least, most), to.clamp(least, most)),
            (false, false) if scale == Scale::Log10 => (1.0, 10.0),
            (false, false) => (0.0, 1.0),
        };
        let span = Self { from, to, scale };
        // Widen ranges that are too narrow for distinct ticks
        if (to - from).abs() > (1e-9 * from.abs().max(to.abs())).max(if scale == Scale::Linear { 1e-290 } else { 0.0 })
        {
            return span;
        }
        match scale {
            Scale::Linear if from.abs() < 1e-290 => Self { from: -1.0, to: 1.0, scale },
            Scale::Linear => Self { from: from - 0.5 * from.abs(), to: from + 0.5 * from.abs(), scale },
            Scale::Log10 => Self { from: (from / 10.0).max(1e-301), to: (from * 10.0).min(1e301), scale },
        }
    }

    /// The range of all values that have a place on the scale, with a margin at both ends (a fraction of the range).
    fn around(data: impl Iterator<Item = f64>, margin: f64, scale: Scale) -> Self {
        let usable = data.filter(|v| v.is_finite() && (scale == Scale::Linear || *v > 0.0));
        let (lo, hi) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        if scale == Scale::Log10 {
            let pad = (hi / lo).powf(margin);
            let tight = Self::new(lo, hi, scale);
            return if pad.is_finite() && lo > 0.0 { Self::new(lo / pad, hi * pad, scale) } else { tight };
        }
        let pad = (hi - lo) * margin;
        // Data that come near zero from one side start at zero.
        if margin > 0.0 && lo >= 0.0 && lo <= 0.3 * hi {
            Self::new(0.0, hi + pad, scale)
        } else {
            Self::new(lo - pad, hi + pad, scale)
        }
    }

    pub fn lo(&self) -> f64 {
        self.from.min(self.to)
    }

    pub fn hi(&self) -> f64 {
        self.from.max(self.to)
    }

    /// Where `value` lies between the start (0) and the end (1) of the axis; NaN when it has no place on the scale.
    pub fn position(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.from) / (self.to - self.from),
            Scale::Log10 if value > 0.0 => (value.log10() - self.from.log10()) / (self.to.log10() - self.from.log10()),
            Scale::Log10 => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions() {
        let linear = Span::new(0.0, 90.0, Scale::Linear);
        assert_eq!(linear.position(45.0), 0.5);
        let backwards = Span::new(180.0, 0.0, Scale::Linear);
        assert_eq!((backwards.position(180.0), backwards.position(45.0)), (0.0, 0.75));
        let log = Span::new(1e-4, 1.0, Scale::Log10);
        assert!((log.position(1e-3) - 0.25).abs() < 1e-12);
        assert!(log.position(0.0).is_nan() && log.position(-1.0).is_nan());
    }

    #[test]
    fn no_range_is_too_odd_to_draw() {
        let [infinity, most] = [f64::INFINITY, f64::MAX];
        let odd = [0.0, -0.0, 1.0, -1.0, f64::NAN, infinity, -infinity, most, -most, 5e-324, 1e-300, 1e16];
        for from in odd {
            for to in odd.into_iter().chain([1.0 + 1e-15]) {
                for axis in [Axis::linear(""), Axis::log(""), Axis::linear("").every(0.1)] {
                    let spans = [
                        axis.clone().range(from, to).span(std::iter::empty(), 0.0),
                        axis.span([from, to].into_iter(), 0.05),
                    ];
                    for span in spans {
                        let [lo, hi] = [span.lo(), span.hi()];
                        assert!(lo < hi && lo.is_finite() && hi.is_finite(), "{from} to {to}: {span:?}");
                        assert!((span.position(lo) - span.position(hi)).abs() > 0.999, "{span:?}");
                        assert!(axis.ticks(&span, 6).major.len() < 220, "{span:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn ranges_follow_the_data() {
        let ends = |axis: Axis, data: &[f64], margin: f64| {
            let span = axis.span(data.iter().copied(), margin);
            (span.lo(), span.hi())
        };
        assert_eq!(ends(Axis::linear(""), &[2.0, f64::NAN, 4.0], 0.05), (1.9, 4.1));
        assert_eq!(ends(Axis::linear(""), &[0.1, 1.0], 0.1).0, 0.0, "zero is near enough to be shown");
        assert_eq!(ends(Axis::log(""), &[-1.0, 0.0, 0.01, 1.0], 0.0), (0.01, 1.0));
        let (lo, hi) = ends(Axis::linear(""), &[3.0], 0.05);
        assert!(lo < 3.0 && hi > 3.0);
    }
}
