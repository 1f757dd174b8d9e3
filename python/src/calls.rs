//! Calls of a function under test: an exception at some rows and not at others is a finding and no error of use.

use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Rows that are tried one by one where a function has not worked yet.
const TRIED: usize = 16;

/// What the calls of a function have shown so far.
#[derive(Default)]
pub struct Calls {
    has_worked: AtomicBool,
    raised: Mutex<Option<String>>,
}

impl Calls {
    /// The results of `call` for `n` rows.
    ///
    /// If it raises an exception though it works for other rows, the row is looked for by halves, remembered with what `given`
    /// says of it, and all rows get the result `nan`, which no test accepts.
    ///
    /// # Errors
    /// The exception of a function that has not worked for any row, and those that end a program, such as KeyboardInterrupt.
    pub fn of_rows<T: Clone>(
        &self,
        py: Python<'_>,
        (name, n): (&str, usize),
        nan: T,
        call: impl Fn(Range<usize>) -> PyResult<Vec<T>>,
        given: impl Fn(usize) -> PyResult<String>,
    ) -> PyResult<Vec<T>> {
        let is_finding = |error: &PyErr| error.is_instance_of::<PyException>(py);
        let mut error = match call(0..n) {
            Ok(values) => {
                self.has_worked.store(true, Ordering::Relaxed);
                return Ok(values);
            }
            Err(error) if is_finding(&error) => error,
            Err(error) => return Err(error),
        };
        let works = |row: usize| call(row..row + 1).is_ok();
        if !self.has_worked.load(Ordering::Relaxed) && !(0..n).step_by(n.div_ceil(TRIED).max(1)).any(works) {
            return Err(error);
        }
        let mut raised = self.raised.lock().unwrap_or_else(PoisonError::into_inner);
        if raised.is_none() {
            let mut rows = 0..n;
            while rows.len() > 1 {
                let middle = rows.start.midpoint(rows.end);
                let halves = [rows.start..middle, middle..rows.end];
                let of_half = |half: &Range<usize>| Some((half.clone(), call(half.clone()).err()?));
                let Some((half, of_half)) = halves.iter().find_map(of_half) else { break };
                (rows, error) = (half, of_half);
            }
            let place = if rows.len() == 1 { given(rows.start)? } else { format!("{} rows together", rows.len()) };
            *raised = Some(format!("{name} raises {error}, for {place}"));
        }
        Ok(vec![nan; n])
    }

    /// The exception, with the row that it was raised for.
    pub fn raised(&self) -> Option<String> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
