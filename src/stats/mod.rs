//! Statistics: tests of counts against densities, intervals from replicates, fits.

pub mod chi_square;
pub mod estimate;
pub mod fit;
