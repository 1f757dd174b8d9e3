//! `etalon`: a bench for light-transport samplers.
//!
//! The crate is a house; a room imports only rooms below it.
//!
//! | floor | room | what lives there |
//! |---|---|---|
//! | 8 | `main.rs`, [`cli`] | one file per subcommand: parse, call, print |
//! | 7 | [`report`] | the registry of figures and the checks that they must meet |
//! | 6 | [`study`] | one file per experiment, each computing a plain result |
//! | 5 | [`render`], [`import`] | the integrator and its film; scene files and samplers of others |
//! | 4 | [`scene`] | camera, shapes, lights, built-in scenes |
//! | 3 | [`stats`], [`bsdf`], [`envmap`] | tests and errors; materials; environment maps |
//! | 2 | [`sampling`], [`figure`] | random streams, warps and tables; drawing |
//! | 1 | [`optics`], [`raster`] | light at an interface; float images and their files |
//! | 0 | [`error`], [`files`], [`interrupt`], [`memory`] | what every room needs |

pub mod bsdf;
pub mod cli;
pub mod envmap;
pub mod errata;
pub mod error;
pub mod figure;
pub mod files;
pub mod import;
pub mod interrupt;
pub mod math;
pub mod memory;
pub mod optics;
pub mod raster;
pub mod render;
pub mod report;
pub mod sampling;
pub mod scene;
pub mod stats;
pub mod study;

pub use error::{Error, Result};
