//! A check: a number that a figure must meet, and whether it did.

use serde::{Deserialize, Deserializer, Serialize};

/// |got − expected| ≤ tolerance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Check {
    pub name: String,
    #[serde(deserialize_with = "number_or_nan")]
    pub expected: f64,
    #[serde(deserialize_with = "number_or_nan")]
    pub got: f64,
    #[serde(deserialize_with = "number_or_nan")]
    pub tolerance: f64,
    pub pass: bool,
}

/// JSON writes what is no number as null.
pub(super) fn number_or_nan<'de, D: Deserializer<'de>>(source: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(source)?.unwrap_or(f64::NAN))
}

impl Check {
    #[must_use]
    pub fn near(name: impl Into<String>, expected: f64, got: f64, tolerance: f64) -> Self {
        // Written so that NaN fails.
        let pass = (got - expected).abs() <= tolerance;
        Self { name: name.into(), expected, got, tolerance, pass }
    }

    /// 0 ≤ got ≤ limit.
    #[must_use]
    pub fn at_most(name: impl Into<String>, got: f64, limit: f64) -> Self {
        Self::near(name, 0.0, got, limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_fails() {
        assert!(Check::near("a", 1.0, 1.05, 0.1).pass);
        assert!(!Check::near("a", 1.0, 1.2, 0.1).pass);
        assert!(!Check::near("a", 1.0, f64::NAN, 0.1).pass);
        assert!(!Check::at_most("a", f64::INFINITY, 1.0).pass);
    }
}
