//! A family swept over its grids: every variant in every precision against the exact value at the rounded input.

use super::case::{Case, Deviation, Exact, Flaw, Place, on_the_edge};
use super::family::Family;
use super::number::Precision;
use super::row::ErrorRow;
use rayon::prelude::*;

/// All cases of a family.
pub struct Sweep {
    /// What was swept.
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
