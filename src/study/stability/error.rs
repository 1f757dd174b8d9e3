//! How far a value is from the exact one, and how much of that rounding of its input alone would explain.

use super::family::{Family, Precision, Range, Value, Variant};
use super::number::{Number, dot};
use super::precise::Precise;

/// The exact answer at an input, and how it answers to changes of that input.
pub struct Exact {
    pub answer: Value<Precise>,
    /// Relative change of the answer per relative change of the inputs: Σ |xᵢ ∂f/∂xᵢ| / |f|. An input that is off by one
    /// part in 10⁷ alone moves the answer by this many parts in 10⁷.
    pub condition: f64,
}

/// Relative change of an input from which slopes are taken: small enough for 80 bits of the slope, large enough for 80
/// more to be left of the difference.
const STEP: isize = -80;

impl Exact {
    #[must_use]
    pub fn at(family: &Family, inputs: &[f64]) -> Self {
        let mut x: Vec<Precise> = inputs.iter().map(|&x| Precise::of(x)).collect();
        let answer = (family.reference)(&x);
        let Some(value) = answer else { return Self { answer, condition: 1.0 } };
        let length = dot(value, value).sqrt();
        let step = Precise::power_of_two(STEP);
        let mut sum = Precise::of(0.0);
        for i in 0..x.len() {
            let unchanged = x[i];
            x[i] = unchanged + unchanged * step;
            // Beyond an edge there is nothing to compare with; the other side of it has the same slope.
            if let Some(moved) = (family.reference)(&x).or_else(|| {
                x[i] = unchanged - unchanged * step;
                (family.reference)(&x)
            }) {
                let change: [Precise; 3] = std::array::from_fn(|c| moved[c] - value[c]);
                sum = sum + dot(change, change).sqrt();
            }
            x[i] = unchanged;
        }
        let condition = (sum / step / length).to_f64();
        Self { answer, condition: if condition.is_nan() { 0.0 } else { condition } }
    }
}

/// Whether one input that is off by the last place decides if there is an answer at all, such as at a triangle's edge.
#[must_use]
pub fn on_the_edge(family: &Family, precision: Precision, inputs: &[f64]) -> bool {
    let mut x: Vec<Precise> = inputs.iter().map(|&x| Precise::of(x)).collect();
    let answers = (family.reference)(&x).is_some();
    (0..x.len()).any(|i| {
        let unchanged = x[i];
        let step = Precise::of(4.0 * precision.unit(inputs[i]));
        let flips = [unchanged + step, unchanged - step].into_iter().any(|moved| {
            x[i] = moved;
            (family.reference)(&x).is_some() != answers
        });
        x[i] = unchanged;
        flips
    })
}

/// What is wrong with an answer before it is compared with anything.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flaw {
    NonFinite,
    Negative,
    OutOfRange,
}

/// A variant's answer, compared with the exact one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    pub value: Value<f64>,
    /// |answer − exact| / |exact|; 1 where one of them alone is nothing or 0. An exact answer below the smallest normal
    /// number counts as that.
    pub relative: f64,
    /// |answer − exact| in units of the last place of |exact|.
    pub ulp: f64,
    pub flaw: Option<Flaw>,
}

impl Deviation {
    /// Runs a variant; `None` where it does not exist in that precision.
    #[must_use]
    pub fn of(family: &Family, variant: &Variant, precision: Precision, inputs: &[f64], exact: &Exact) -> Option<Self> {
        let value = variant.evaluate(precision, inputs)?;
        Some(Self::between(family.range, precision, value, exact))
    }

    /// The error of a value.
    #[must_use]
    pub fn between(range: Range, precision: Precision, value: Value<f64>, exact: &Exact) -> Self {
        let (relative, ulp) = match (value, exact.answer) {
            (Some(value), Some(exact)) => distance(precision, value, exact),
            (None, None) => (0.0, 0.0),
            _ => altogether(precision),
        };
        Self { value, relative, ulp, flaw: value.and_then(|v| flaw(range, precision, v)) }
    }
}

/// Something where there should be nothing, or the other way round.
fn altogether(precision: Precision) -> (f64, f64) {
    (1.0, 1.0 / precision.unit(1.0))
}

fn distance(precision: Precision, value: [f64; 3], exact: [Precise; 3]) -> (f64, f64) {
    if value.iter().any(|x| !x.is_finite()) {
        return (f64::INFINITY, f64::INFINITY);
    }
    let difference: [Precise; 3] = std::array::from_fn(|c| Precise::of(value[c]) - exact[c]);
    let (distance, length) = (dot(difference, difference).sqrt(), dot(exact, exact).sqrt());
    let zero = Precise::of(0.0);
    match (distance == zero, length == zero) {
        (true, _) => return (0.0, 0.0),
        (false, true) => return altogether(precision),
        _ => {}
    }
    // Below the smallest normal number nobody has digits left.
    let least = Precise::of(precision.least());
    let length = if length < least { least } else { length };
    ((distance / length).to_f64(), (distance / Precise::of(precision.unit(length.to_f64()))).to_f64())
}

fn flaw(range: Range, precision: Precision, value: [f64; 3]) -> Option<Flaw> {
    if value.iter().any(|x| !x.is_finite()) {
        return Some(Flaw::NonFinite);
    }
    match range {
        Range::UpTo(_) if value[0] < 0.0 => Some(Flaw::Negative),
        Range::UpTo(limit) => (value[0] > limit).then_some(Flaw::OutOfRange),
        Range::Unit => ((dot(value, value).sqrt() - 1.0).abs() > 4.0 * precision.unit(1.0)).then_some(Flaw::OutOfRange),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::stability::family::{STABLE, Scale, Section, scalar};

    fn minus_one<T: Number>(x: &[T]) -> Value<T> {
        scalar(x[0] * x[0] - T::of(1.0))
    }

    const SQUARE: Family = Family {
        name: "square",
        about: "x² − 1",
        figure: "",
        bounds: &[],
        inputs: &["x"],
        domains: &[],
        sections: &[Section {
            title: "",
            x: Scale::new("", 1.0, 2.0),
            y: Scale::new("", 1.0, 2.0),
            at: |x, _| vec![x],
        }],
        edges: &[],
        reference: minus_one,
        variants: &[Variant::new(STABLE, minus_one, minus_one)],
        range: Range::UpTo(2.0),
        coarser: 1,
    };

    fn deviation(x: f64) -> Deviation {
        let exact = Exact::at(&SQUARE, &[x]);
        Deviation::of(&SQUARE, &SQUARE.variants[0], Precision::Single, &[x], &exact).unwrap()
    }

    #[test]
    fn conditions_are_logarithmic_slopes() {
        // x d(x² − 1)/dx / (x² − 1) = 2x² / (x² − 1).
        for x in [1.0 + 1e-6, 1.5, 3.0] {
            let expected = 2.0 * x * x / (x * x - 1.0);
            assert!((Exact::at(&SQUARE, &[x]).condition / expected - 1.0).abs() < 1e-9, "{x}");
        }
    }

    #[test]
    fn cancellation_is_seen_and_flaws_are_told_apart() {
        // 1 + 2⁻²³ squared is 1 + 2⁻²² + 2⁻⁴⁶, of which f32 keeps all but the last term: 2⁻²⁴ of the difference.
        let x = f64::from(1f32.next_up());
        assert!((deviation(x).relative / 2f64.powi(-24) - 1.0).abs() < 1e-6);
        assert!((deviation(x).ulp - 0.5).abs() < 1e-6);
        assert_eq!((deviation(1.5).relative, deviation(1.5).flaw), (0.0, None));
        assert_eq!(deviation(0.5).flaw, Some(Flaw::Negative));
        assert_eq!(deviation(2.0).flaw, Some(Flaw::OutOfRange));
        assert_eq!((deviation(1e30).flaw, deviation(1e30).relative), (Some(Flaw::NonFinite), f64::INFINITY));
    }
}
