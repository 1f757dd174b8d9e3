//! A test bench for the sampling code of physically based renderers: plots, environment maps, a small path tracer and
//! statistical tests. `ARCHITECTURE.md` says more.
//!
//! Each crate below imports only from those under it; this one re-exports what its users need.
//!
//! | crate | what it holds |
//! |---|---|
//! | [`cli`] | one file per subcommand: parse, call, print |
//! | [`summary`] | results of studies for other user interfaces: text, SVG, CSV |
//! | `etalon_figures` | plots, views of results, the figures and their page |
//! | [`study`] (`etalon_bench`) | one file or folder per study: computes a plain result |
//! | [`render`] (`etalon_render`) | the path tracer and its film |
//! | `etalon_core` | [`import`], [`export`], [`scene`], [`bsdf`], [`envmap`], [`raster`], [`errata`], [`sampling`], [`optics`], [`math`] |
//! | [`etalon_stats`] | statistical tests of samplers; knows nothing of rendering |
//! | `etalon_random` | hash functions and random streams, re-exported by [`sampling`] |

// Only the command line prints.
#![warn(missing_docs)]
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr, clippy::dbg_macro))]

pub mod cli;
pub mod summary;

pub use etalon_bench as study;
pub use etalon_bench::protocol;
pub use etalon_core::build::Build;
pub use etalon_core::{
    Error, Result, bsdf, envmap, errata, export, import, interrupt, math, memory, optics, raster, sampling, scene,
};
pub use etalon_render as render;

/// What this program is built from.
pub const BUILD: Build =
    Build { version: env!("CARGO_PKG_VERSION"), sources: env!("ETALON_SOURCES"), commit: env!("ETALON_COMMIT") };
