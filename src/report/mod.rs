//! The registry of figures and the views of results: a table, a drawing, checks.

mod audit;
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
pub mod planted;
pub mod proposal;
mod registry;
mod second_report;
pub mod sphere;
pub mod statue;
pub mod validation;

pub use check::Check;
pub use context::{Context, MapSource};
pub use originals::Originals;
pub use registry::{Entry, Made, Picture, Reproduced, registry, reproduce};
