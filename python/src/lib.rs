//! The extension module of the Python package `etalon_bench`: tests by the library, with functions of Python as what is tested,
//! and the program.
//!
//! The package's own modules in `etalon_bench/` are what users import; this module has what they are made of.

mod arrays;
mod bsdf;
mod caller;
mod calls;
mod errors;
mod found;
mod images;
mod power;
mod program;
mod sampler;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::bsdf::{check_bsdf, furnace};
    #[pymodule_export]
    use crate::found::Found;
    #[pymodule_export]
    use crate::images::compare_images;
    #[pymodule_export]
    use crate::power::{detectable, samples_for};
    #[pymodule_export]
    use crate::program::main;
    #[pymodule_export]
    use crate::sampler::{check_sampler, domains};
}
