//! The BSDF of another program: all checks of whole BSDFs for directions on both sides of the surface.

use super::run::{Tested, Validation};
use crate::error::Result;
use crate::interrupt;
use etalon_stats::bsdf::{ALL, Check, Direction, Family, Properties};
use etalon_stats::{Outcome, Protocol, decide};
use std::time::Instant;

/// Angles of `wo` to the normal in degrees.
const DEGREES: [f64; 6] = [0.0, 30.0, 60.0, 85.0, 110.0, 150.0];

/// A BSDF of a family.
pub struct WholeBsdf<F> {
    family: F,
    values: Vec<f64>,
}

impl<F: Family> WholeBsdf<F> {
    /// The BSDF whose parameters have these values.
    pub fn new(family: F, values: Vec<f64>) -> Self {
        Self { family, values }
    }

    /// The name of the BSDF.
    pub fn name(&self) -> &str {
        self.family.name()
    }

    /// The names of all tests, those included that do not apply to the BSDF.
    pub fn names(&self) -> Vec<String> {
        tests().map(|(check, degrees)| self.test_name(check, degrees)).collect()
    }

    fn test_name(&self, check: &Check, degrees: f64) -> String {
        format!("{}/{}/{degrees}", self.family.name(), check.name)
    }

    /// Runs all checks that apply for every direction, at the level of `protocol` for all together, and calls `done` after each.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::error::Error::Parameter) for an impossible protocol; those of the BSDF;
    /// [`Error::Interrupted`](crate::error::Error::Interrupted).
    pub fn run(&self, protocol: &Protocol, done: &dyn Fn()) -> Result<Validation> {
        let start = Instant::now();
        let protocol = Protocol { tests: tests().count(), cancelled: interrupt::requested, ..*protocol };
        let bsdf = self.family.with(&self.values)?;
        let properties = bsdf.properties();
        let mut applied = Vec::new();
        let mut outcomes: Vec<Outcome> = Vec::new();
        for (check, degrees) in tests() {
            let wo = towards(degrees, &properties);
            if let Some(outcome) = check.examine(&*bsdf, wo, &protocol, 0)? {
                applied.push((check, degrees));
                outcomes.push(outcome);
            }
            done();
        }
        decide(&mut outcomes, protocol.level, |i| {
            let (check, degrees) = applied[i];
            check.examine(&*bsdf, towards(degrees, &properties), &protocol, 1).map(Option::unwrap_or_default)
        })?;
        let named = applied.into_iter().map(|(check, degrees)| self.test_name(check, degrees));
        let tests = named.zip(outcomes).map(|(name, outcome)| Tested { name, outcome });
        Ok(Validation::new(&protocol, tests.collect(), start))
    }
}

fn tests() -> impl Iterator<Item = (&'static Check, f64)> {
    ALL.iter().flat_map(|check| DEGREES.map(|degrees| (check, degrees)))
}

/// The direction at that angle, in no symmetric position to the tangents; a direction in single precision for a BSDF that
/// computes in it.
fn towards(degrees: f64, properties: &Properties) -> Direction {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let wo = [0.8 * sin, 0.6 * sin, cos];
    if properties.precision < f64::from(f32::EPSILON) { wo } else { wo.map(|x| f64::from(x as f32)) }
}
