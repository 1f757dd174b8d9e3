//! Mathematics below every other module: colours, local frames, the float type of the formulas, elementary functions.

pub mod circular;
pub mod elementary;
pub mod error_function;
mod frame;
pub mod hash;
mod map_array;
mod real;
mod rgb;

pub use frame::Frame;
pub use map_array::map_array;
pub use real::Real;
pub use rgb::{Rgb, mean_rgb};
