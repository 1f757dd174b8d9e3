//! `etalon`: a bench for light-transport samplers.
//!
//! The crate is a house; a room imports only rooms below it.
//!
//! | floor | room | what lives there |
//! |---|---|---|
//! | 8 | `main.rs`, [`cli`] | one file per subcommand: parse, call, print |
//! | 7 | [`gallery`], [`view`] | the registry of figures, their checks and the page; results of studies as drawings and tables |
//! | 6 | [`study`] | one file per experiment, each computing a plain result |
//! | 5 | [`render`], [`import`] | the integrator and its film; scene files and samplers of others |
//! | 4 | [`scene`] | camera, shapes, lights, built-in scenes |
//! | 3 | [`bsdf`], [`envmap`] | materials; environment maps |
//! | 2 | [`sampling`], [`figure`], [`output`] | random streams, warps and tables; drawing; result files |
//! | 1 | [`optics`], [`raster`] | light at an interface; float images and their files |
//! | 0 | [`error`], [`files`], [`interrupt`], [`memory`] | what every room needs |

pub mod bsdf;
pub mod cli;
pub mod envmap;
pub mod errata;
pub mod error;
pub mod figure;
pub mod files;
pub mod gallery;
pub mod import;
pub mod interrupt;
pub mod math;
pub mod memory;
pub mod optics;
pub mod output;
pub mod raster;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod study;
pub mod view;

pub use error::{Error, Result};
