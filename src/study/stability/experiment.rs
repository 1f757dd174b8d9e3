//! Experiments whose exact results no formula of the inputs gives: sums, tables, cuts, paths.
//!
//! It re-exports what an experiment is written with.

pub use super::bound::Bound;
pub use super::precision::Precision;
pub use super::row::ErrorRow;
pub use super::variant::{STABLE, TEXTBOOK};

use crate::error::Result;

/// An experiment whose exact result is known by integers, by construction, or in closed form.
pub struct Experiment {
    /// Its name.
    pub name: &'static str,
    /// What it does, in a line.
    pub about: &'static str,
    /// Id of the figure that shows it.
    pub figure: &'static str,
    /// Upper bounds of the errors of the code that renders.
    pub bounds: &'static [Bound<ErrorRow>],
    /// Runs it with an amount of work and a seed.
    pub run: fn(&Workload, u64) -> Result<Vec<ErrorRow>>,
}

/// How much work to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Workload {
    /// Places along each side of the grids.
    pub side: usize,
    /// Samples of one pixel of the film.
    pub film_samples: u32,
    /// Columns and rows of the map whose tables are tested.
    pub map: [usize; 2],
    /// Samples from the tables.
    #[serde(rename = "draws")]
    pub table_samples: u32,
    /// Bounces of the paths.
    pub bounces: u32,
}

impl Workload {
    /// Of the subcommand.
    pub const FULL: Self =
        Self { side: 33, film_samples: 100_000_000, map: [8192, 4096], table_samples: 10_000_000, bounces: 10_000 };

    /// For figures: finer than a page shows, and a quarter of the map.
    pub const FIGURES: Self = Self { side: 25, map: [4096, 2048], ..Self::FULL };

    /// For a quick look: coarse grids, small sums.
    pub const QUICK: Self =
        Self { side: 9, film_samples: 1_000_000, map: [1024, 512], table_samples: 100_000, bounces: 10_000 };
}

/// The errors of one variant of an experiment, accumulated into an [`ErrorRow`].
pub struct Tally(ErrorRow);

impl Tally {
    /// Without any case yet.
    #[must_use]
    pub fn new(family: &'static str, variant: &'static str, precision: Precision) -> Self {
        Self(ErrorRow { family, variant, precision, ..ErrorRow::default() })
    }

    /// Compares one result with the exact one. `condition` is the sum of the summands' moduli over the result: rounding
    /// of the summands alone changes the result by that many units of its last place.
    pub fn compare(&mut self, value: f64, exact: f64, condition: f64, what: impl FnOnce() -> String) {
        let row = &mut self.0;
        let first = row.cases == 0;
        row.cases += 1;
        row.non_finite += u64::from(!value.is_finite());
        row.negative += u64::from(value < 0.0);
        let error = if value == exact { 0.0 } else { (value - exact).abs() };
        let relative = if error == 0.0 { 0.0 } else { error / exact.abs() };
        let ulp = error / row.precision.unit(exact);
        row.max_ulp = row.max_ulp.max(ulp);
        row.max_ulp_per_condition = row.max_ulp_per_condition.max(ulp / condition.max(1.0));
        if first || relative > row.max_relative || relative.is_nan() {
            (row.max_relative, row.condition_at_worst, row.worst) = (relative, condition, what());
        }
    }

    /// Counts results that are impossible in themselves.
    pub fn impossible(&mut self, count: u64) {
        self.0.out_of_range += count;
    }

    /// Counts cases that are possible or impossible, with no error to measure.
    pub fn cases(&mut self, count: u64) {
        self.0.cases += count;
    }

    /// Adds the errors that another thread found of the same variant.
    #[must_use]
    pub fn merge(mut self, other: Self) -> Self {
        let (mine, theirs) = (&mut self.0, other.0);
        if mine.cases == 0 || theirs.max_relative > mine.max_relative {
            mine.max_relative = theirs.max_relative;
            (mine.condition_at_worst, mine.worst) = (theirs.condition_at_worst, theirs.worst);
        }
        mine.max_ulp = mine.max_ulp.max(theirs.max_ulp);
        mine.max_ulp_per_condition = mine.max_ulp_per_condition.max(theirs.max_ulp_per_condition);
        mine.cases += theirs.cases;
        mine.non_finite += theirs.non_finite;
        mine.negative += theirs.negative;
        mine.out_of_range += theirs.out_of_range;
        self
    }

    /// The row of the table.
    #[must_use]
    pub fn row(self) -> ErrorRow {
        self.0
    }
}
