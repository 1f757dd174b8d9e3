//! Results of studies for other user interfaces than the command line: as text, as a figure, as a table.

use etalon_bench::albedo::Table;
use etalon_bench::compare::Compared;
use etalon_bench::validation::{Tested, Validation};
use etalon_core::error::Result;
use etalon_figures::figure::Drawing;
pub use etalon_figures::figure::style::{Medium, Style, Theme};
use etalon_figures::output::csv;
use etalon_figures::view;

/// What the command line prints and writes of a result.
pub trait Summary {
    /// The result in words, over several lines.
    fn text(&self) -> String;

    /// The figure.
    fn drawing(&self) -> Drawing;

    /// The table as a CSV document with a header; `None` if there is none.
    ///
    /// # Errors
    /// [`Error::Io`](etalon_core::Error::Io) if the table cannot be put together.
    fn csv(&self) -> Result<Option<Vec<u8>>>;
}

/// One test: its counts by cell.
impl Summary for Tested {
    fn text(&self) -> String {
        self.outcome.to_string()
    }

    fn drawing(&self) -> Drawing {
        view::validation_cells::drawing(self)
    }

    fn csv(&self) -> Result<Option<Vec<u8>>> {
        self.outcome.counts.as_ref().map(|counts| csv(&view::validation_cells::rows(counts))).transpose()
    }
}

/// A run of tests: a row for each.
impl Summary for Validation {
    fn text(&self) -> String {
        view::validation::text(self, false)
    }

    fn drawing(&self) -> Drawing {
        view::validation::drawing(self)
    }

    fn csv(&self) -> Result<Option<Vec<u8>>> {
        view::validation::csv(self).map(Some)
    }
}

/// Two renderers: a row for each functional in each channel.
impl Summary for Compared {
    fn text(&self) -> String {
        view::compare::text(self)
    }

    fn drawing(&self) -> Drawing {
        view::compare::drawing(self)
    }

    fn csv(&self) -> Result<Option<Vec<u8>>> {
        view::compare::csv(self).map(Some)
    }
}

/// Directional albedos: a row for each, and for each channel that differs.
impl Summary for Table {
    fn text(&self) -> String {
        view::furnace::text(self)
    }

    fn drawing(&self) -> Drawing {
        view::furnace::drawing(self)
    }

    fn csv(&self) -> Result<Option<Vec<u8>>> {
        csv(&self.rows).map(Some)
    }
}
