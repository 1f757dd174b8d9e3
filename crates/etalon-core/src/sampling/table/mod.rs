//! Piecewise-constant distributions: cumulative tables with a guide, in one and two dimensions.
//!
//! Probabilities are differences of the *stored* table, so that samples follow the pdf to the last bit.
//! Cells are found through a guide (cutpoint) table: one look-up per sample and a short search. The result is monotone in
//! `u`, hence invertible and suited to stratified random numbers. Source: Chen & Asau, "On generating random variates from an
//! empirical distribution", AIIE Transactions 6(2), 1974.

mod cdf;
mod grid;
mod line;
mod short;

pub use cdf::CellSample;
pub use grid::{GridSample, Table2};
pub use line::Table1;
pub use short::ShortTables;
