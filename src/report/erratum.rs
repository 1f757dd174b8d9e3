//! A mistake in a report, and the evidence for it.

use serde::{Deserialize, Serialize};

/// One row of "where the reports are wrong".
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Erratum {
    /// What the report prints.
    pub printed: String,
    /// What is right.
    pub right: String,
    /// The test that tells them apart.
    pub test: String,
    /// The p-value of that test under what is printed; `None` where no chance is involved.
    pub p_value: Option<f64>,
    /// How far off the picture is, with the measure that says so.
    pub picture_error: String,
}
