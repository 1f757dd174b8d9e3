//! Random numbers for Monte Carlo rendering: hash functions, counter-based streams, the azimuth of a direction in turns.

#![warn(missing_docs)]

pub mod hash;
pub mod stream;
mod turns;

pub use turns::turns;
