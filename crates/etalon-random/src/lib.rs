//! Random numbers for Monte Carlo rendering: hash functions, counter-based streams, the azimuth of a direction in turns.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr, clippy::dbg_macro))]
#![warn(missing_docs)]

pub mod hash;
pub mod stream;
mod turns;

pub use turns::turns;
