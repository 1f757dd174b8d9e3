//! The film of a render that may be cut into parts: sums without rounding, so that parts can be merged in any order.
//!
//! An [`Exposure`] collects samples. A [`Part`] says which samples of how many they are, is written to an OpenEXR file
//! that viewers show as a picture, is read back, and is merged with other parts of the same render.

mod classes;
mod dropped;
mod film;
pub mod fixed;
mod layers;
mod pixel;
mod row;

pub use self::classes::{Classes, Word};
pub use self::dropped::Dropped;
pub use self::film::Exposure;
pub use self::pixel::Pixel;
pub use self::row::Row;
