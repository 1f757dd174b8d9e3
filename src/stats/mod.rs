//! Statistics: tests of counts against densities.

pub mod chi_square;
