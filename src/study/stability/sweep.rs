//! A family swept over its grids: every variant in every precision against the exact answer at the rounded input.

use super::error::{Deviation, Exact, on_the_edge};
use super::family::{Family, Precision};
use rayon::prelude::*;

/// One input in one precision.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Where in which grid; `None` for an input that is in no grid.
    pub place: Option<Place>,
    /// That all variants ran in.
    pub precision: Precision,
    /// Rounded to that precision.
    pub inputs: Vec<f64>,
    /// Relative change of the exact answer per relative change of the inputs; infinite where rounding decides whether
    /// there is an answer.
    pub condition: f64,
    /// In the order of the family's variants; `None` for one that does not run in that precision.
    pub deviations: Vec<Option<Deviation>>,
}

/// A place in a family's grids.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    pub section: usize,
    pub column: usize,
    pub row: usize,
}

/// All cases of a family.
pub struct Sweep {
    /// What was swept.
    pub family: &'static Family,
    /// Places along each side of a section.
    pub side: usize,
    /// Section by section, then the edges.
    pub cases: Vec<Case>,
}

impl Sweep {
    /// Sweeps all sections with `side` × `side` places each (fewer where the family says so), and the edges, on all
    /// threads.
    #[must_use]
    pub fn new(family: &'static Family, side: usize) -> Self {
        let side = (side / family.coarser).max(2);
        let grid = (0..family.sections.len() * side * side).into_par_iter().map(|i| {
            let place = Place { section: i / (side * side), row: i / side % side, column: i % side };
            let section = &family.sections[place.section];
            let inputs = (section.at)(section.x.at(place.column, side), section.y.at(place.row, side));
            (Some(place), inputs)
        });
        let edges = family.edges.par_iter().map(|edge| (None, edge.to_vec()));
        let cases = grid.chain(edges).flat_map_iter(|(place, inputs)| {
            let precisions = Precision::ALL.into_iter().filter(|p| family.runs_in(*p));
            precisions.map(move |precision| Case { place, ..case(family, precision, &inputs) })
        });
        Self { family, side, cases: cases.collect() }
    }
}

impl Family {
    /// Whether any variant runs in that precision.
    #[must_use]
    pub fn runs_in(&self, precision: Precision) -> bool {
        precision == Precision::Single || self.variants.iter().any(|variant| variant.double.is_some())
    }
}

/// All variants at one input, which is rounded to the precision first.
#[must_use]
pub fn case(family: &Family, precision: Precision, inputs: &[f64]) -> Case {
    let inputs: Vec<f64> = inputs.iter().map(|&x| precision.round(x)).collect();
    let exact = Exact::at(family, &inputs);
    let deviations: Vec<Option<Deviation>> =
        family.variants.iter().map(|variant| Deviation::of(family, variant, precision, &inputs, &exact)).collect();
    let disputed = deviations.iter().flatten().any(|d| d.value.is_some() != exact.answer.is_some());
    let decided_by_rounding = disputed && on_the_edge(family, precision, &inputs);
    let condition = if decided_by_rounding { f64::INFINITY } else { exact.condition };
    Case { place: None, precision, inputs, condition, deviations }
}
