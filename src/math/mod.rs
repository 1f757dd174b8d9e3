//! Mathematics below every other module: colours, local frames, the float type of the formulas, elementary functions.

pub mod circular;
mod each;
pub mod elementary;
pub mod error_function;
mod frame;
pub(crate) mod polynomial;
mod real;
mod rgb;

pub use each::each;
pub use frame::Frame;
pub use real::Real;
pub use rgb::{Rgb, mean_rgb};
