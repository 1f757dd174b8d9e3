//! The film of a render that may be cut into parts: sums without rounding, so that parts can be merged in any order.
//!
//! A [`Film`] collects samples. A [`Part`] says which samples of how many they are, is written to an OpenEXR file
//! that viewers show as an image, is read back, and is merged with other parts of the same render.

mod accumulate;
mod classes;
mod file;
pub mod fixed;
mod layers;
mod part;
mod pixel;
mod ranges;
mod row;
mod splats;

pub use self::accumulate::{Film, PixelEstimate};
pub use self::classes::{PathClass, PathClasses};
pub use self::file::ERRORS_OF_SUMS;
pub use self::part::{Part, Task, merge_files};
pub use self::pixel::{Dropped, Pixel};
pub use self::ranges::{Ranges, list, shard};
pub use self::row::Row;
pub use self::splats::Splat;
