//! The figures of `etalon`. Modules in layers, highest first; a module imports only from lines below its own.
//!
//! | modules | what they hold |
//! |---|---|
//! | [`gallery`] | one file per figure, the registry of figures, their checks and the page |
//! | [`view`] | results of studies as drawings and tables |
//! | [`output`] | drawings and tables as files |
//! | [`figure`] | plots as SVG, PNG and PDF |

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr, clippy::dbg_macro))]

pub mod figure;
pub mod gallery;
pub mod output;
pub mod view;
