//! Errors of the library as exceptions of Python.

use etalon::Error;
use pyo3::PyErr;
use pyo3::exceptions::{PyKeyboardInterrupt, PyMemoryError, PyOSError, PyValueError};

/// The exception for `error`, with its hint.
pub fn of(error: Error) -> PyErr {
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
