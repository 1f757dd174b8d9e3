//! Arrays that callbacks take and return: conversion, and errors that name the array, its shape and the shape wanted.

use numpy::{Element, IntoPyArray, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Numbers in C order, with their shape and the name of the array in messages.
pub struct Numbers<T> {
    /// Whose they are: `pdf`, `samples.x`.
    pub name: String,
    /// Shape of the array.
    pub shape: Vec<usize>,
    /// Row by row.
    pub values: Vec<T>,
}

/// The kinds of NumPy's dtypes of real numbers: floats, signed and unsigned integers.
const REAL: [&str; 3] = ["f", "i", "u"];

/// Whatever `numpy.asarray` takes, as numbers.
///
/// # Errors
/// TypeError for what are no real numbers; the exception of `numpy.asarray`.
pub fn numbers<T: Element + Copy>(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Numbers<T>> {
    let py = value.py();
    let numpy = py.import("numpy")?;
    let array = match numpy.getattr("ma")?.call_method1("isMaskedArray", (value,))?.is_truthy()? {
        // What is masked is no number.
        true => value.call_method1("astype", ("float64",))?.call_method1("filled", (f64::NAN,))?,
        false => numpy.call_method1("asarray", (value,))?,
    };
    let dtype = array.getattr("dtype")?;
    let kind: String = dtype.getattr("kind")?.extract()?;
    if !REAL.contains(&kind.as_str()) {
        let given = value.get_type().name()?;
        return Err(PyTypeError::new_err(format!("{name}: {given} of dtype {dtype}; wanted real numbers")));
    }
    // The shape before the conversion, which makes a single number an array of one
    let shape = array.getattr("shape")?.extract()?;
    let options = PyDict::new(py);
    options.set_item("dtype", numpy::dtype::<T>(py))?;
    let array = numpy.call_method("ascontiguousarray", (&array,), Some(&options))?;
    let array = array.cast::<PyArrayDyn<T>>()?;
    let values = array.readonly().as_slice()?.to_vec();
    Ok(Numbers { name: name.to_owned(), shape, values })
}

impl<T> Numbers<T> {
    /// The values, if the array has one of the `wanted` shapes.
    ///
    /// # Errors
    /// ValueError.
    pub fn of_shape(self, wanted: &[&[usize]]) -> PyResult<Vec<T>> {
        if wanted.contains(&&self.shape[..]) {
            return Ok(self.values);
        }
        let wanted: Vec<String> = wanted.iter().map(|shape| tuple(shape)).collect();
        Err(self.wrong_shape(&wanted.join(" or ")))
    }

    /// The error for an array of another shape than `wanted`.
    pub fn wrong_shape(&self, wanted: &str) -> PyErr {
        PyValueError::new_err(format!("{}: shape {}; wanted {wanted}", self.name, tuple(&self.shape)))
    }
}

/// What a function was given, by the names of its arguments: rows of it are named in messages.
pub type Given<'a, 'py> = &'a [(&'a str, &'a Bound<'py, PyAny>)];

/// Refuses NaN in rows of `width` numbers that `counts`.
///
/// # Errors
/// ValueError that names the first row, and what it was returned for.
pub fn no_nan(
    values: &[f64],
    width: usize,
    name: &str,
    counts: impl Fn(usize) -> bool,
    given: Given<'_, '_>,
) -> PyResult<()> {
    let mut rows = values.chunks_exact(width.max(1)).enumerate();
    let Some((i, row)) = rows.find(|(i, row)| row.iter().any(|x| x.is_nan()) && counts(*i)) else { return Ok(()) };
    let mut message = format!("{name}: NaN in row {i}: {row:?}");
    for (argument, array) in given {
        let entry = array.get_item(i)?.call_method0("tolist")?;
        message += &format!(", for {argument} = {}", entry.repr()?);
    }
    Err(PyValueError::new_err(message))
}

/// One truth value for each of `n` entries; `default` for all if there is none.
///
/// # Errors
/// TypeError and ValueError.
pub fn flags(value: Option<&Bound<'_, PyAny>>, name: &str, n: usize, default: bool) -> PyResult<Vec<bool>> {
    let Some(value) = value.filter(|value| !value.is_none()) else { return Ok(vec![default; n]) };
    let array = value.py().import("numpy")?.call_method1("asarray", (value,))?;
    let dtype = array.getattr("dtype")?;
    if dtype.getattr("kind")?.extract::<String>()? != "b" {
        return Err(PyTypeError::new_err(format!("{name}: dtype {dtype}; wanted bool")));
    }
    let values: Vec<f64> = numbers(&array.call_method1("astype", ("float64",))?, name)?.of_shape(&[&[n]])?;
    Ok(values.into_iter().map(|value| value != 0.0).collect())
}

/// An array of rows of `width` numbers.
///
/// # Errors
/// Those of NumPy.
pub fn rows(py: Python<'_>, values: Vec<f64>, width: usize) -> PyResult<Bound<'_, PyAny>> {
    let count = values.len() / width.max(1);
    Ok(values.into_pyarray(py).reshape([count, width])?.into_any())
}

/// A shape as Python writes it.
fn tuple(shape: &[usize]) -> String {
    match shape {
        [n] => format!("({n},)"),
        all => format!("({})", all.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}
