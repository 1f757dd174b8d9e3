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
        given: impl Fn(usize) -> String,
    ) -> PyResult<Vec<T>> {
        // The exception of some rows; those that are no errors, such as KeyboardInterrupt, end the test.
        let attempt = |rows: Range<usize>| match call(rows) {
            Ok(_) => Ok(None),
            Err(error) if error.is_instance_of::<PyException>(py) => Ok(Some(error)),
            Err(error) => Err(error),
        };
        let mut error = match call(0..n) {
            Ok(values) => {
                self.has_worked.store(true, Ordering::Relaxed);
                return Ok(values);
            }
            Err(error) if error.is_instance_of::<PyException>(py) => error,
            Err(error) => return Err(error),
        };
        let mut raised = self.raised.lock().unwrap_or_else(PoisonError::into_inner);
        if raised.is_some() {
            return Ok(vec![nan; n]);
        }
        let has_worked = self.has_worked.load(Ordering::Relaxed);
        let mut tried = (0..n).step_by(n.div_ceil(TRIED).max(1)).map(|row| attempt(row..row + 1));
        if !has_worked && !tried.try_fold(false, |works, row| row.map(|error| works | error.is_none()))? {
            return Err(error);
        }
        let mut rows = 0..n;
        while rows.len() > 1 {
            let middle = rows.start.midpoint(rows.end);
            let [first, second] = [rows.start..middle, middle..rows.end];
            let (half, of_half) = match attempt(first.clone())? {
                Some(error) => (first, error),
                None => match attempt(second.clone())? {
                    Some(error) => (second, error),
                    None => break,
                },
            };
            (rows, error) = (half, of_half);
        }
        let place = match rows.len() {
            1 => given(rows.start),
            // A function of one row at a time.
            _ if !has_worked => return Err(error),
            together => format!("{together} rows together"),
        };
        *raised = Some(format!("{name} raises {error}, for {place}"));
        Ok(vec![nan; n])
    }

    /// The exception, with the row that it was raised for.
    pub fn raised(&self) -> Option<String> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
