//! Axes: label, range, and the position of a value along them; positions and labels of ticks: round steps, decades, fixed steps.

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps of the value.
    Linear,
    /// Equal factors are equally long; values that are not positive have no place.
    Log10,
}

#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Axis {
    pub(super) label: String,
    pub(super) scale: Scale,
    range: Option<(f64, f64)>,
    every: Option<f64>,
    at: Vec<f64>,
    names: Vec<String>,
    /// Ticks have no numbers, which those of a neighbour are.
    is_silent: bool,
}

impl Axis {
    /// A linear axis that shows all the data. `label` may carry the markup of [`super::text`].
    pub fn linear(label: impl Into<String>) -> Self {
        let (label, at, names) = (label.into(), Vec::new(), Vec::new());
        Self { label, scale: Scale::Linear, range: None, every: None, at, names, is_silent: false }
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

    /// The axis with steps between labelled ticks as many times as long, if its steps are fixed.
    pub(super) fn coarser(&self, times: f64) -> Option<Self> {
        let every = self.every.map(|step| step * times)?;
        Some(Self { every: Some(every), ..self.clone() })
    }

    /// The axis without its title and the names of its places, if they are those of another one.
    pub(super) fn without_names_of(mut self, other: &Self) -> Self {
        if self == *other && self.range.is_some() {
            self.label.clear();
        }
        if self.names == other.names {
            self.names.iter_mut().for_each(String::clear);
        }
        self
    }

    /// The axis without the numbers of its ticks, if they are those of another one.
    pub(super) fn without_numbers_of(self, other: &Self) -> Self {
        let is_silent = self.range.is_some() && self.range == other.range && self.scale == other.scale;
        Self { is_silent, ..self }
    }

    pub(super) fn places(&self) -> usize {
        self.names.len()
    }

    /// Up to about `most` labelled ticks, at their positions along `span`.
    pub(super) fn ticks(&self, span: &Span, most: usize) -> Ticks {
        let mut ticks = match (self.scale, self.every) {
            _ if !self.names.is_empty() => named_ticks(&self.names),
            _ if !self.at.is_empty() => ticks_at(span.lo(), span.hi(), &self.at),
            (Scale::Log10, _) => log_ticks(span.lo(), span.hi(), most),
            (Scale::Linear, Some(step)) => ticks_every(span.lo(), span.hi(), step),
            (Scale::Linear, None) => linear_ticks(span.lo(), span.hi(), most),
        };
        if self.is_silent {
            ticks.major.iter_mut().for_each(|tick| tick.label.clear());
            ticks.exponent = 0;
        }
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

#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// A value of the axis, which [`Axis::ticks`] turns into a position from 0 to 1.
    pub at: f64,
    /// Marked-up text, without the common factor of [`Ticks::exponent`].
    pub label: String,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ticks {
    pub major: Vec<Tick>,
    /// Where those without labels are.
    pub minor: Vec<f64>,
    /// The labels are in units of ten to this power.
    pub exponent: i32,
}

/// More steps than this across a range are not drawn.
const MOST_STEPS: f64 = 200.0;

/// Steps of 1, 2, 2.5 or 5 times a power of ten, the smallest that gives at most `most` ticks.
fn linear_ticks(lo: f64, hi: f64, most: usize) -> Ticks {
    // The smallest round step that is not below the wanted one
    let wanted = (hi - lo) / most.max(2) as f64;
    let power = wanted.log10().floor() as i32;
    // The mantissa, its own decimals, and how many minor steps divide it.
    let choices = [(1.0, 0, 5), (2.0, 0, 4), (2.5, 1, 5), (5.0, 0, 5), (10.0, -1, 5)];
    let fits = |&&(mantissa, ..): &&(f64, i32, i32)| (hi - lo) / (mantissa * ten(power)) < most.max(2) as f64;
    let &(mantissa, decimals, parts) = choices.iter().find(fits).unwrap_or(&choices[4]);
    steps(lo, hi, mantissa * ten(power), decimals - power, parts)
}

/// A tick at every multiple of `step`; round steps instead when `step` is not a positive number that fits the range.
fn ticks_every(lo: f64, hi: f64, step: f64) -> Ticks {
    let count = (hi - lo) / step;
    if !(step > 0.0 && (0.5..=MOST_STEPS).contains(&count)) {
        return linear_ticks(lo, hi, 8);
    }
    let decimals = (0..9)
        .find(|&d| {
            let v = step * ten(d);
            (v - v.round()).abs() < 1e-6 * v
        })
        .unwrap_or(9);
    // Divide a step into 5, 3 or 2 if the parts are round.
    let parts = [5, 3, 2].into_iter().find(|&n| {
        let v = step * ten(decimals) / f64::from(n);
        (v - v.round()).abs() < 1e-6
    });
    steps(lo, hi, step, decimals, parts.unwrap_or(1))
}

/// Ticks at those of `places` that lie in the range, labelled with as many decimals as each needs, up to six.
fn ticks_at(lo: f64, hi: f64, places: &[f64]) -> Ticks {
    let inside = places.iter().filter(|p| (lo..=hi).contains(*p));
    let decimals = |v: f64| (0..6).find(|&d| (v * ten(d) - (v * ten(d)).round()).abs() < 1e-6).unwrap_or(6) as usize;
    let major = inside.map(|&at| Tick { at, label: number(at, decimals(at)) }).collect();
    Ticks { major, ..Ticks::default() }
}

/// A tick in the middle of each place of a list, which is one wide.
fn named_ticks(names: &[String]) -> Ticks {
    let tick = |(i, name): (usize, &String)| Tick { at: i as f64 + 0.5, label: name.clone() };
    Ticks { major: names.iter().enumerate().map(tick).collect(), ..Ticks::default() }
}

/// Multiples of `step`, each divided into `parts`; labels need `decimals` (negative: trailing zeros).
fn steps(lo: f64, hi: f64, step: f64, decimals: i32, parts: i32) -> Ticks {
    let largest = lo.abs().max(hi.abs());
    let exponent = if (1e-3..1e5).contains(&largest) { 0 } else { largest.log10().floor() as i32 };
    let decimals = (decimals + exponent).clamp(0, 15) as usize;
    let multiples = |step: f64| {
        // A range that ends on a multiple except for rounding has its tick there.
        let (first, last) = ((lo / step - 1e-6).ceil(), (hi / step + 1e-6).floor());
        let count = (last - first).clamp(-1.0, 10.0 * MOST_STEPS) as i64;
        (0..=count).map(move |i| first + i as f64)
    };
    let major =
        multiples(step).map(|n| Tick { at: n * step, label: number(n * step / ten(exponent), decimals) }).collect();
    let minor = multiples(step / f64::from(parts))
        .filter(|n| n.rem_euclid(f64::from(parts)) != 0.0)
        .map(|n| n * step / f64::from(parts))
        .collect();
    Ticks { major, minor, exponent }
}

/// Decades, all or every n-th, with the multiples 2 to 9 between them; the round steps of [`linear_ticks`] when the range
/// holds no two decades. Needs `lo > 0`.
fn log_ticks(lo: f64, hi: f64, most: usize) -> Ticks {
    let (first, last) = ((lo.log10() - 1e-9).ceil() as i32, (hi.log10() + 1e-9).floor() as i32);
    if last <= first {
        return within_two_decades(lo, hi).unwrap_or(Ticks { minor: Vec::new(), ..linear_ticks(lo, hi, most.min(6)) });
    }
    // Label every stride-th decade
    let least = (last - first + 1).unsigned_abs().div_ceil(most.max(2) as u32) as i32;
    let stride = [1, 2, 3, 5, 10, 20, 50, 100, 200].into_iter().find(|&n| n >= least).unwrap_or(500);
    // Every n-th decade counted from 1, so that 1 itself is among them.
    let labelled = |n: &i32| n.rem_euclid(stride) == 0;
    let major: Vec<Tick> = (first..=last)
        .filter(labelled)
        .map(|n| Tick { at: ten(n), label: format!("10^{{{}}}", number(f64::from(n), 0)) })
        .collect();
    let between = |v: &f64| (lo * (1.0 - 1e-9)..=hi * (1.0 + 1e-9)).contains(v);
    let minor = if stride == 1 {
        (first - 1..=last).flat_map(|n| (2..10).map(move |m| f64::from(m) * ten(n))).filter(between).collect()
    } else {
        (first..=last).filter(|n| !labelled(n)).map(ten).collect()
    };
    Ticks { major, minor, exponent: 0 }
}

/// 1, 2 and 5 times the powers of ten, if at least three of them lie in the range and they can be written out.
fn within_two_decades(lo: f64, hi: f64) -> Option<Ticks> {
    let first = (lo.log10() + 1e-9).floor() as i32;
    if !(-4..4).contains(&first) || hi / lo > 1000.0 {
        return None;
    }
    let inside = |v: f64| (lo * (1.0 - 1e-9)..=hi * (1.0 + 1e-9)).contains(&v);
    let all = (first..first + 3).flat_map(|n| (1..10).map(move |m| (m, n)));
    let (mut major, mut minor) = (Vec::new(), Vec::new());
    for (m, n) in all.filter(|&(m, n)| inside(f64::from(m) * ten(n))) {
        let at = f64::from(m) * ten(n);
        if [1, 2, 5].contains(&m) {
            major.push(Tick { at, label: number(at, n.min(0).unsigned_abs() as usize) });
        } else {
            minor.push(at);
        }
    }
    (major.len() >= 3).then_some(Ticks { major, minor, exponent: 0 })
}

fn ten(n: i32) -> f64 {
    10f64.powi(n)
}

/// Fixed decimals with a true minus sign; never a negative zero.
pub fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().any(|b| (b'1'..=b'9').contains(&b)) => format!("−{digits}"),
        Some(digits) => digits.to_owned(),
        None => text,
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

    fn labels(ticks: &Ticks) -> String {
        let labels: Vec<&str> = ticks.major.iter().map(|t| t.label.as_str()).collect();
        labels.join(" ")
    }

    #[test]
    fn labels_are_round() {
        let cases = [
            (linear_ticks(0.0, 1.0, 6), "0.0 0.2 0.4 0.6 0.8 1.0", 0),
            (linear_ticks(-1.0, 1.0, 5), "−1.0 −0.5 0.0 0.5 1.0", 0),
            (linear_ticks(0.0, 90.0, 10), "0 10 20 30 40 50 60 70 80 90", 0),
            (linear_ticks(0.0, 1000.0, 4), "0 500 1000", 0),
            (linear_ticks(0.0, 0.1, 5), "0.000 0.025 0.050 0.075 0.100", 0),
            // Tiny and huge values share a factor.
            (linear_ticks(0.0, 4e-7, 5), "0 1 2 3 4", -7),
            (linear_ticks(-2e6, 2e6, 5), "−2 −1 0 1 2", 6),
            (ticks_every(0.0, 90.0, 15.0), "0 15 30 45 60 75 90", 0),
            (ticks_every(0.0, 0.5, 0.25), "0.00 0.25 0.50", 0),
            (ticks_at(8.0, 40.0, &[4.0, 8.0, 16.0, 32.0, 64.0]), "8 16 32", 0),
            (ticks_at(0.01, 1.0, &[0.02, 0.25, 1.0]), "0.02 0.25 1", 0),
            (named_ticks(&["a".into(), "b".into()]), "a b", 0),
            (log_ticks(1e-3, 1.0, 8), "10^{−3} 10^{−2} 10^{−1} 10^{0}", 0),
            (log_ticks(1e-30, 1.0, 4), "10^{−30} 10^{−20} 10^{−10} 10^{0}", 0),
            // No two decades inside: plain round values; one decade inside: round steps of the logarithm.
            (log_ticks(2.0, 8.0, 6), "2 4 6 8", 0),
            (log_ticks(0.12, 2.8, 6), "0.2 0.5 1 2", 0),
        ];
        for (ticks, expected, exponent) in cases {
            assert_eq!((labels(&ticks).as_str(), ticks.exponent), (expected, exponent));
        }
    }

    #[test]
    fn minor_ticks_divide_steps() {
        assert_eq!(ticks_every(0.0, 90.0, 15.0).minor[..3], [3.0, 6.0, 9.0]);
        assert_eq!((log_ticks(1e-3, 1.0, 8).minor.len(), log_ticks(0.12, 2.8, 6).minor.len()), (24, 6));
        for useless in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9, 1e9] {
            assert_eq!(ticks_every(0.0, 90.0, useless), linear_ticks(0.0, 90.0, 8), "{useless}");
        }
    }

    #[test]
    fn any_range_gives_few_ticks() {
        let ends = [-1e300, -1e5, -1.0, -1e-300, 0.0, 1e-300, 1e-12, 0.1, 0.3, 1.0, 1.0 + 1e-9, 7.0, 1e16, 1e300];
        for (i, &lo) in ends.iter().enumerate() {
            for (&hi, most) in ends[i + 1..].iter().flat_map(|hi| [0, 1, 5, 40].map(|most| (hi, most))) {
                let few = |ticks: Ticks, minor| ticks.major.len() <= 42 && ticks.minor.len() <= minor;
                assert!(few(linear_ticks(lo, hi, most), 250), "{lo} {hi} {most}");
                assert!(lo <= 0.0 || few(log_ticks(lo, hi, most), 700), "{lo} {hi} {most}");
            }
        }
    }
}
