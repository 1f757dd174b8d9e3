//! The registry of figures and the views of results: a table, a drawing, checks.

mod check;
mod context;
mod entries;
pub mod fresnel;
pub mod map;
pub mod output;
pub mod proposal;
mod registry;
pub mod sphere;

pub use check::Check;
pub use context::{Context, MapSource};
pub use registry::{Entry, Made, Reproduced, registry, reproduce};
