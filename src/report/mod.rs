//! The registry of figures and the views of results: a table, a drawing, checks, and the page that shows them all.

mod audit;
mod audit_entry;
mod check;
mod context;
pub mod converge;
mod converge_entries;
pub mod converge_series;
pub mod depth;
mod entries;
mod erratum;
pub mod fresnel;
pub mod junit;
pub mod map;
pub mod metals;
mod originals;
pub mod output;
pub mod page;
pub mod planted;
pub mod proposal;
mod registry;
mod second_report;
mod self_test;
pub mod sphere;
pub mod stability;
mod stability_entries;
pub mod stability_summary;
pub mod statue;
pub mod validation;
pub mod validation_cells;

pub use check::Check;
pub use context::{Context, MapSource};
pub use erratum::Erratum;
pub use originals::Originals;
pub use registry::{Entry, Made, Picture, Reproduced, Reproduction, registry, reproduce};
