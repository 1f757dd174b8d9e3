//! The program `etalon`.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the program on `arguments`, the first of which is its name, and returns the exit code.
///
/// It belongs to a process that does nothing else: it sets handlers of signals.
#[pyfunction]
pub fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| etalon::cli::main(arguments))
}
