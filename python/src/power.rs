//! What a test detects with how many samples.

use etalon_stats::power;
use etalon_stats::{Protocol, SampleCount};
use pyo3::prelude::*;

/// A protocol with these values, and the number of cells, atoms and "no sample" included, less one.
fn setting(level: f64, samples: SampleCount) -> PyResult<(Protocol, usize)> {
    let protocol = Protocol { level, samples, ..Protocol::default() };
    protocol.check().map_err(|error| crate::errors::of(error.into()))?;
    Ok((protocol, protocol.cells))
}

/// The smallest relative error of a pdf that `samples` detect with a probability of 90 %.
#[pyfunction]
pub fn detectable(samples: u64, level: f64) -> PyResult<f64> {
    let (protocol, dof) = setting(level, SampleCount::Fixed(samples))?;
    Ok(power::detectable(dof, protocol.level_of_cells(samples), samples))
}

/// The number of samples that detect a relative error of a pdf with a probability of 90 %.
#[pyfunction]
pub fn samples_for(error: f64, level: f64) -> PyResult<u64> {
    let (protocol, dof) = setting(level, SampleCount::Detect(error))?;
    Ok(protocol.samples_for(dof))
}
