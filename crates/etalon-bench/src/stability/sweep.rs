//! A family swept over its grids: every variant in every precision against the exact value at the rounded input; one input, the
//! errors of all variants there, and how much of them rounding of the input alone would explain.

use super::family::{ErrorRow, Family};
use super::number::{Formula, Number, Precise, Precision, Value, dot};
use rayon::prelude::*;

/// One input in one precision.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Where in which grid; `None` for an input that is in no grid.
    pub place: Option<Place>,
    /// Precision of the inputs, in which all variants are evaluated.
    pub precision: Precision,
    /// Rounded to that precision.
    pub inputs: Vec<f64>,
    /// Relative change of the exact value per relative change of the inputs; infinite where rounding decides whether
    /// there is a value.
    pub condition: f64,
    /// In the order of the family's variants; `None` for one that does not exist in that precision.
    pub deviations: Vec<Option<Deviation>>,
}

/// A place in a family's grids.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    pub section: usize,
    /// From left to right.
    pub column: usize,
    /// From bottom to top.
    pub row: usize,
}

impl Case {
    /// The error of the variant that renders, if that exists in this precision.
    pub fn rendered(&self) -> Option<&Deviation> {
        self.deviations[0].as_ref()
    }

    /// The condition number, but at least 1: results are rounded once, whatever the inputs.
    pub fn amplification(&self) -> f64 {
        self.condition.max(1.0)
    }
}

/// The values that a quantity can have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// From 0 to this.
    UpTo(f64),
    /// Unit vectors: lengths have an error of at most 4 units of the last place.
    Unit,
}

impl Range {
    /// How many numbers a value is.
    pub fn components(self) -> usize {
        if self == Self::Unit { 3 } else { 1 }
    }
}

/// The exact value at an input, and its condition number.
pub struct Exact {
    /// By the defining formula.
    pub value: Value<Precise>,
    /// Relative change of the value per relative change of the inputs: Σ |xᵢ ∂f/∂xᵢ| / |f|. A relative error of 10⁻⁷ of
    /// the inputs alone changes the value by this many times 10⁻⁷.
    pub condition: f64,
}

/// Binary exponent of the relative change of an input from which slopes are taken: small enough for 80 bits of the
/// slope, large enough for 80 more to be left of the difference.
const STEP: isize = -80;

impl Exact {
    /// Evaluates the defining formula at an input, and its slopes by differences.
    pub fn at(reference: Formula<Precise>, inputs: &[f64]) -> Self {
        let mut x: Vec<Precise> = inputs.iter().map(|&x| Precise::of(x)).collect();
        let value = reference(&x);
        let Some(here) = value else { return Self { value, condition: 1.0 } };
        // Sum the changes of the value by relative steps of each input.
        let length = dot(here, here).sqrt();
        let step = Precise::power_of_two(STEP);
        let mut sum = Precise::of(0.0);
        for i in 0..x.len() {
            let unchanged = x[i];
            x[i] = unchanged + unchanged * step;
            // Where there is no value on one side of an edge, the other side has the same slope.
            if let Some(moved) = reference(&x).or_else(|| {
                x[i] = unchanged - unchanged * step;
                reference(&x)
            }) {
                let change: [Precise; 3] = std::array::from_fn(|c| moved[c] - here[c]);
                sum = sum + dot(change, change).sqrt();
            }
            x[i] = unchanged;
        }
        let condition = (sum / step / length).to_f64();
        Self { value, condition: if condition.is_nan() { 0.0 } else { condition } }
    }
}

/// Whether moving one input by a few units of its last place decides if there is a value at all, such as at a
/// triangle's edge.
fn on_the_edge(reference: Formula<Precise>, precision: Precision, inputs: &[f64]) -> bool {
    let mut x: Vec<Precise> = inputs.iter().map(|&x| Precise::of(x)).collect();
    let exists = reference(&x).is_some();
    (0..x.len()).any(|i| {
        let unchanged = x[i];
        let step = Precise::of(4.0 * precision.unit(inputs[i]));
        let flips = [unchanged + step, unchanged - step].into_iter().any(|moved| {
            x[i] = moved;
            reference(&x).is_some() != exists
        });
        x[i] = unchanged;
        flips
    })
}

/// What is wrong with a value whatever the exact one is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flaw {
    /// Infinite or NaN.
    NonFinite,
    /// Below 0, where the [`Range`] starts.
    Negative,
    /// Above the [`Range`], or no unit vector.
    OutOfRange,
}

/// A variant's value, compared with the exact one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// As the variant gives it.
    pub value: Value<f64>,
    /// |value − exact| / |exact|; 1 where one of them alone is nothing or 0. An exact value below the smallest normal
    /// number counts as that.
    pub relative: f64,
    /// |value − exact| in units of the last place of |exact|.
    pub ulp: f64,
    pub flaw: Option<Flaw>,
}

impl Deviation {
    pub fn between(range: Range, precision: Precision, value: Value<f64>, exact: &Exact) -> Self {
        let (relative, ulp) = match (value, exact.value) {
            (Some(value), Some(exact)) => distance(precision, value, exact),
            (None, None) => (0.0, 0.0),
            _ => total(precision),
        };
        Self { value, relative, ulp, flaw: value.and_then(|v| flaw(range, precision, v)) }
    }
}

/// The errors of a value where there should be none or 0, and of none or 0 where there should be another.
fn total(precision: Precision) -> (f64, f64) {
    (1.0, 1.0 / precision.unit(1.0))
}

fn distance(precision: Precision, value: [f64; 3], exact: [Precise; 3]) -> (f64, f64) {
    if value.iter().any(|x| !x.is_finite()) {
        return (f64::INFINITY, f64::INFINITY);
    }
    // Length of the error, in 256 bits.
    let difference: [Precise; 3] = std::array::from_fn(|c| Precise::of(value[c]) - exact[c]);
    let (distance, length) = (dot(difference, difference).sqrt(), dot(exact, exact).sqrt());
    let zero = Precise::of(0.0);
    match (distance == zero, length == zero) {
        (true, _) => return (0.0, 0.0),
        (false, true) => return total(precision),
        _ => {}
    }
    // Below the smallest normal number, precision is lost to underflow: errors are relative to that number.
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

pub struct Sweep {
    pub family: &'static Family,
    /// Places along each side of a section; 0 for inputs that are in no grid.
    pub side: usize,
    /// Section by section, then the edges.
    pub cases: Vec<Case>,
}

impl Sweep {
    /// Sweeps all sections with `side` × `side` places each (fewer where the family says so), and the edges, on all
    /// threads.
    pub fn new(family: &'static Family, side: usize) -> Self {
        let side = (side / family.coarser).max(2);
        let grid = (0..family.sections.len() * side * side).into_par_iter().map(|i| {
            let place = Place { section: i / (side * side), row: i / side % side, column: i % side };
            let section = &family.sections[place.section];
            let inputs = (section.at)(section.x.at(place.column, side), section.y.at(place.row, side));
            (Some(place), inputs)
        });
        let edges = family.edges.par_iter().map(|edge| (None, edge.to_vec()));
        Self { family, side, cases: cases(family, grid.chain(edges)) }
    }

    /// Runs those inputs, on all threads.
    pub fn of_inputs(family: &'static Family, inputs: &[Vec<f64>]) -> Self {
        Self { family, side: 0, cases: cases(family, inputs.par_iter().map(|inputs| (None, inputs.clone()))) }
    }

    /// A row for each variant and precision.
    pub fn rows(&self) -> Vec<ErrorRow> {
        let variants = 0..self.family.variants.len();
        variants.flat_map(|variant| Precision::ALL.map(|precision| self.row(variant, precision))).flatten().collect()
    }

    fn row(&self, variant: usize, precision: Precision) -> Option<ErrorRow> {
        let mut row = ErrorRow::new(self.family.name, self.family.variants[variant].name, precision);
        for case in self.cases.iter().filter(|case| case.precision == precision) {
            let Some(deviation) = case.deviations[variant] else { continue };
            row.cases += 1;
            match deviation.flaw {
                Some(Flaw::NonFinite) => row.non_finite += 1,
                Some(Flaw::Negative) => row.negative += 1,
                Some(Flaw::OutOfRange) => row.out_of_range += 1,
                None => {}
            }
            // Where rounding alone decides whether there is a value, errors do not count.
            if case.condition.is_finite() {
                row.add(deviation.relative, deviation.ulp, case.condition, || self.family.text(case));
            }
        }
        (row.cases > 0).then_some(row)
    }
}

/// All variants at all inputs, in every precision.
fn cases(family: &Family, inputs: impl ParallelIterator<Item = (Option<Place>, Vec<f64>)>) -> Vec<Case> {
    let of_input = |(place, inputs): (Option<Place>, Vec<f64>)| {
        let precisions = Precision::ALL.into_iter().filter(|p| family.runs_in(*p));
        precisions.map(move |precision| Case { place, ..case(family, precision, &inputs) })
    };
    inputs.flat_map_iter(of_input).collect()
}

/// All variants at one input, which is rounded to the precision first.
pub fn case(family: &Family, precision: Precision, inputs: &[f64]) -> Case {
    let inputs: Vec<f64> = inputs.iter().map(|&x| precision.round(x)).collect();
    let exact = Exact::at(family.reference, &inputs);
    let values = family.variants.iter().map(|variant| variant.evaluate(precision, &inputs));
    let deviation = |value| Deviation::between(family.range, precision, value, &exact);
    let deviations: Vec<Option<Deviation>> = values.map(|value| value.map(deviation)).collect();
    // Rounding decides if a variant and the reference disagree next to an edge.
    let disputed = deviations.iter().flatten().any(|d| d.value.is_some() != exact.value.is_some());
    let decided_by_rounding = disputed && on_the_edge(family.reference, precision, &inputs);
    let condition = if decided_by_rounding { f64::INFINITY } else { exact.condition };
    Case { place: None, precision, inputs, condition, deviations }
}

#[cfg(test)]
mod tests {
    use super::super::number::scalar;
    use super::*;

    fn minus_one<T: Number>(x: &[T]) -> Value<T> {
        scalar(x[0] * x[0] - T::of(1.0))
    }

    fn deviation(x: f64) -> Deviation {
        let value = minus_one(&[x as f32]).map(|value| value.map(f64::from));
        Deviation::between(Range::UpTo(2.0), Precision::Single, value, &Exact::at(minus_one, &[x]))
    }

    #[test]
    fn conditions_are_logarithmic_slopes() {
        // x d(x² − 1)/dx / (x² − 1) = 2x² / (x² − 1).
        for x in [1.0 + 1e-6, 1.5, 3.0] {
            let expected = 2.0 * x * x / (x * x - 1.0);
            assert!((Exact::at(minus_one, &[x]).condition / expected - 1.0).abs() < 1e-9, "{x}");
        }
    }

    #[test]
    fn cancellation_is_measured_and_flaws_are_classified() {
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
