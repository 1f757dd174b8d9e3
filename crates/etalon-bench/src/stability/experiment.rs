//! Experiments whose exact results no formula of the inputs gives: sums, tables, paths.
//!
//! It re-exports what an experiment is written with.

pub use super::number::Precision;
pub use super::row::{Bound, ErrorRow, STABLE, TEXTBOOK};

use etalon_core::error::Result;

/// An experiment whose exact result is known by integers, by construction, or in closed form.
pub struct Experiment {
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
    pub film_samples: u32,
    /// Columns and rows of the map whose tables are tested.
    pub map: [usize; 2],
    pub table_samples: u32,
    pub bounces: u32,
}

impl Workload {
    /// The effort of the subcommand.
    pub const FULL: Self =
        Self { side: 33, film_samples: 100_000_000, map: [8192, 4096], table_samples: 10_000_000, bounces: 10_000 };

    /// For figures: finer than a page shows, and a quarter of the map.
    pub const FIGURES: Self = Self { side: 25, map: [4096, 2048], ..Self::FULL };

    /// For a quick look: coarse grids, small sums.
    pub const QUICK: Self =
        Self { side: 9, film_samples: 1_000_000, map: [1024, 512], table_samples: 100_000, bounces: 10_000 };
}
