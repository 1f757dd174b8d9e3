//! The extension module of the Python package `etalon_bench`: tests by the library, with functions of Python as what is tested,
//! and the program.
//!
//! The package's own modules in `etalon_bench/` are what users import; this module has what they are made of.

mod arrays;
mod bsdf;
mod caller;
mod calls;
mod found;
mod images;
mod sampler;

use etalon::Error;
use etalon_stats::{Protocol, SampleCount, power};
use pyo3::exceptions::{PyKeyboardInterrupt, PyMemoryError, PyOSError, PyValueError};
use pyo3::prelude::*;
use std::ffi::OsString;

#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::bsdf::{check_bsdf, furnace};
    #[pymodule_export]
    use crate::found::Found;
    #[pymodule_export]
    use crate::images::compare_images;
    #[pymodule_export]
    use crate::sampler::{check_sampler, domains};
    #[pymodule_export]
    use crate::{detectable, main, samples_for};
}

/// The exception for `error`, with its hint.
fn exception(error: Error) -> PyErr {
    let text = match error.hint() {
        Some(hint) => format!("{error} ({hint})"),
        None => error.to_string(),
    };
    match error {
        Error::Interrupted => PyKeyboardInterrupt::new_err(text),
        Error::Memory(_) => PyMemoryError::new_err(text),
        Error::Io { .. } => PyOSError::new_err(text),
        _ => PyValueError::new_err(text),
    }
}

/// Runs the program on `arguments`, the first of which is its name, and returns the exit code.
///
/// It belongs to a process that does nothing else: it sets handlers of signals.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| etalon::cli::main(arguments))
}

/// A protocol with these values, and the number of cells, atoms and "no sample" included, less one.
fn setting(level: f64, samples: SampleCount) -> PyResult<(Protocol, usize)> {
    let protocol = Protocol { level, samples, ..Protocol::default() };
    protocol.check().map_err(|error| exception(error.into()))?;
    Ok((protocol, protocol.cells))
}

/// The smallest relative error of a pdf that `samples` detect with a probability of 90 %.
#[pyfunction]
fn detectable(samples: u64, level: f64) -> PyResult<f64> {
    let (protocol, dof) = setting(level, SampleCount::Fixed(samples))?;
    Ok(power::detectable(dof, protocol.level_of_cells(samples), samples))
}

/// The number of samples that detect a relative error of a pdf with a probability of 90 %.
#[pyfunction]
fn samples_for(error: f64, level: f64) -> PyResult<u64> {
    let (protocol, dof) = setting(level, SampleCount::Detect(error))?;
    Ok(protocol.samples_for(dof))
}
