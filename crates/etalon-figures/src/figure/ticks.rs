//! Positions and labels of ticks: round steps, decades, fixed steps.
//!
//! Every function takes a finite range `lo < hi` (see [`super::axis::Span`]) and returns a bounded number of ticks.

/// A tick that is labelled.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// A value of the axis, which [`super::axis::Axis::ticks`] turns into a position from 0 to 1.
    pub at: f64,
    /// Marked-up text, without the common factor of [`Ticks::exponent`].
    pub label: String,
}

/// The ticks of an axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ticks {
    /// Those with labels.
    pub major: Vec<Tick>,
    /// Where those without labels are.
    pub minor: Vec<f64>,
    /// The labels are in units of ten to this power.
    pub exponent: i32,
}

/// More steps than this across a range are not drawn.
const MOST_STEPS: f64 = 200.0;

/// Steps of 1, 2, 2.5 or 5 times a power of ten, the smallest that gives at most `most` ticks.
pub fn linear(lo: f64, hi: f64, most: usize) -> Ticks {
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
pub fn every(lo: f64, hi: f64, step: f64) -> Ticks {
    let count = (hi - lo) / step;
    if !(step > 0.0 && (0.5..=MOST_STEPS).contains(&count)) {
        return linear(lo, hi, 8);
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
pub fn at(lo: f64, hi: f64, places: &[f64]) -> Ticks {
    let inside = places.iter().filter(|p| (lo..=hi).contains(*p));
    let decimals = |v: f64| (0..6).find(|&d| (v * ten(d) - (v * ten(d)).round()).abs() < 1e-6).unwrap_or(6) as usize;
    let major = inside.map(|&at| Tick { at, label: number(at, decimals(at)) }).collect();
    Ticks { major, ..Ticks::default() }
}

/// A tick in the middle of each place of a list, which is one wide.
pub fn named(names: &[String]) -> Ticks {
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

/// Decades, all or every n-th, with the multiples 2 to 9 between them; the round steps of [`linear`] when the range
/// holds no two decades. Needs `lo > 0`.
pub fn log(lo: f64, hi: f64, most: usize) -> Ticks {
    let (first, last) = ((lo.log10() - 1e-9).ceil() as i32, (hi.log10() + 1e-9).floor() as i32);
    if last <= first {
        return within_two_decades(lo, hi).unwrap_or(Ticks { minor: Vec::new(), ..linear(lo, hi, most.min(6)) });
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

    fn labels(ticks: &Ticks) -> String {
        let labels: Vec<&str> = ticks.major.iter().map(|t| t.label.as_str()).collect();
        labels.join(" ")
    }

    #[test]
    fn labels_are_round() {
        let cases = [
            (linear(0.0, 1.0, 6), "0.0 0.2 0.4 0.6 0.8 1.0", 0),
            (linear(-1.0, 1.0, 5), "−1.0 −0.5 0.0 0.5 1.0", 0),
            (linear(0.0, 90.0, 10), "0 10 20 30 40 50 60 70 80 90", 0),
            (linear(0.0, 1000.0, 4), "0 500 1000", 0),
            (linear(0.0, 0.1, 5), "0.000 0.025 0.050 0.075 0.100", 0),
            // Tiny and huge values share a factor.
            (linear(0.0, 4e-7, 5), "0 1 2 3 4", -7),
            (linear(-2e6, 2e6, 5), "−2 −1 0 1 2", 6),
            (every(0.0, 90.0, 15.0), "0 15 30 45 60 75 90", 0),
            (every(0.0, 0.5, 0.25), "0.00 0.25 0.50", 0),
            (at(8.0, 40.0, &[4.0, 8.0, 16.0, 32.0, 64.0]), "8 16 32", 0),
            (at(0.01, 1.0, &[0.02, 0.25, 1.0]), "0.02 0.25 1", 0),
            (named(&["a".into(), "b".into()]), "a b", 0),
            (log(1e-3, 1.0, 8), "10^{−3} 10^{−2} 10^{−1} 10^{0}", 0),
            (log(1e-30, 1.0, 4), "10^{−30} 10^{−20} 10^{−10} 10^{0}", 0),
            // No two decades inside: plain round values; one decade inside: round steps of the logarithm.
            (log(2.0, 8.0, 6), "2 4 6 8", 0),
            (log(0.12, 2.8, 6), "0.2 0.5 1 2", 0),
        ];
        for (ticks, expected, exponent) in cases {
            assert_eq!((labels(&ticks).as_str(), ticks.exponent), (expected, exponent));
        }
    }

    #[test]
    fn minor_ticks_divide_steps() {
        assert_eq!(every(0.0, 90.0, 15.0).minor[..3], [3.0, 6.0, 9.0]);
        assert_eq!((log(1e-3, 1.0, 8).minor.len(), log(0.12, 2.8, 6).minor.len()), (24, 6));
        for useless in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9, 1e9] {
            assert_eq!(every(0.0, 90.0, useless), linear(0.0, 90.0, 8), "{useless}");
        }
    }

    #[test]
    fn any_range_gives_few_ticks() {
        let ends = [-1e300, -1e5, -1.0, -1e-300, 0.0, 1e-300, 1e-12, 0.1, 0.3, 1.0, 1.0 + 1e-9, 7.0, 1e16, 1e300];
        for (i, &lo) in ends.iter().enumerate() {
            for (&hi, most) in ends[i + 1..].iter().flat_map(|hi| [0, 1, 5, 40].map(|most| (hi, most))) {
                let few = |ticks: Ticks, minor| ticks.major.len() <= 42 && ticks.minor.len() <= minor;
                assert!(few(linear(lo, hi, most), 250), "{lo} {hi} {most}");
                assert!(lo <= 0.0 || few(log(lo, hi, most), 700), "{lo} {hi} {most}");
            }
        }
    }
}
