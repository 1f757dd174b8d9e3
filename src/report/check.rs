//! A check: a number that a figure must meet, and whether it did.

use serde::Serialize;

/// |got − expected| ≤ tolerance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    pub name: String,
    pub expected: f64,
    pub got: f64,
    pub tolerance: f64,
    pub pass: bool,
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
