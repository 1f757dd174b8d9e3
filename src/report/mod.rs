//! The registry of figures and the views of results: a table, a drawing, checks.

mod check;
mod context;
pub mod depth;
mod entries;
pub mod fresnel;
pub mod junit;
pub mod map;
pub mod metals;
mod originals;
pub mod output;
pub mod proposal;
mod registry;
mod second_report;
mod self_test;
pub mod sphere;
pub mod statue;
pub mod validation;
pub mod validation_cells;

pub use check::Check;
pub use context::{Context, MapSource};
pub use originals::Originals;
pub use registry::{Entry, Made, Picture, Reproduced, registry, reproduce};
