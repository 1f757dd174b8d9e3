//! A test bench for the sampling code of physically based renderers: plots, environment maps, a small path tracer and
//! statistical tests.
//!
//! Modules in layers, highest first; a module imports only from lines below its own. Those without a link are
//! private to the program. The repository's `ARCHITECTURE.md` says more.
//!
//! | modules | what they hold |
//! |---|---|
//! | [`cli`] | one file per subcommand: parse, call, print |
//! | `gallery` | one file per figure, the registry of figures, their checks and the page |
//! | [`summary`] | results of studies for other user interfaces: text, SVG, CSV |
//! | `view` | results of studies as drawings and tables |
//! | [`study`] | one file or folder per experiment: computes a plain result |
//! | [`render`], [`import`], [`export`] | the path tracer and its film; scene files, meshes, external samplers; scenes as files of other renderers |
//! | [`scene`] | camera, shapes, BVH, materials, lights, built-in scenes |
//! | [`bsdf`], [`envmap`] | BSDFs; lat-long maps and their samplers |
//! | `output` | drawings and tables as files |
//! | [`raster`], `figure` | float images and their files; plots as SVG, PNG and PDF |
//! | [`errata`] | the formulas that are wrong in the two reports |
//! | [`sampling`] | warps, tables, normals of microfacets, solid angles of shapes |
//! | [`optics`] | Fresnel equations, metals, microfacet distributions |
//! | [`math`] | colours, local frames, the float trait, elementary functions |
//! | `files`, [`memory`], [`interrupt`], [`error`] | atomic files, the limit of memory, Ctrl-C, the error type |
//!
//! The statistical tests are the crate [`etalon_stats`].

// Only the command line prints.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr, clippy::dbg_macro))]

pub mod bsdf;
pub mod cli;
pub mod envmap;
pub mod errata;
pub mod error;
pub mod export;
mod figure;
mod files;
mod gallery;
pub mod import;
pub mod interrupt;
pub mod math;
pub mod memory;
pub mod optics;
mod output;
pub mod raster;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod study;
pub mod summary;
mod view;

pub use error::{Error, Result};
