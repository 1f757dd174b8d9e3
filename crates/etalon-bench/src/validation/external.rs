//! The BSDF of another program: all checks of whole BSDFs for directions on both sides of the surface.

use super::run::{Tested, Validation};
use etalon_core::error::Result;
use etalon_core::interrupt;
use etalon_stats::bsdf::{ALL, Check, Direction, Family, Properties};
use etalon_stats::{Outcome, Protocol, decide};
use std::time::Instant;

/// Angles of `wo` to the normal in degrees, and its azimuth as (cos φ, sin φ): in no symmetric position to the tangents, and
/// with all signs of x, y and xy on each side.
const WOS: [(f64, [f64; 2]); 6] = [
    (0.0, [0.8, 0.6]),
    (30.0, [0.8, 0.6]),
    (60.0, [-0.6, -0.8]),
    (85.0, [0.8, -0.6]),
    (110.0, [-0.8, 0.6]),
    (150.0, [0.6, -0.8]),
];

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
        tests().map(|(check, (degrees, _))| self.test_name(check, degrees)).collect()
    }

    fn test_name(&self, check: &Check, degrees: f64) -> String {
        format!("{}/{}/{degrees}", self.family.name(), check.name)
    }

    /// Runs all checks that apply for every direction, at the level of `protocol` for all together, and calls `done` after each.
    ///
    /// # Errors
    /// [`Error::Parameter`](etalon_core::error::Error::Parameter) for an impossible protocol; those of the BSDF;
    /// [`Error::Interrupted`](etalon_core::error::Error::Interrupted).
    pub fn run(&self, protocol: &Protocol, done: &dyn Fn()) -> Result<Validation> {
        let start = Instant::now();
        let protocol = Protocol { tests: tests().count(), cancelled: interrupt::requested, ..*protocol };
        let bsdf = self.family.with(&self.values)?;
        let properties = bsdf.properties();
        let mut applied = Vec::new();
        let mut outcomes: Vec<Outcome> = Vec::new();
        for (check, wo) in tests() {
            if let Some(outcome) = check.examine(&*bsdf, towards(wo, &properties), &protocol, 0)? {
                applied.push((check, wo));
                outcomes.push(outcome);
            }
            done();
        }
        decide(&mut outcomes, protocol.level, |i| {
            let (check, wo) = applied[i];
            check.examine(&*bsdf, towards(wo, &properties), &protocol, 1).map(Option::unwrap_or_default)
        })?;
        let named = applied.into_iter().map(|(check, (degrees, _))| self.test_name(check, degrees));
        let tests = named.zip(outcomes).map(|(name, outcome)| Tested { name, outcome });
        Ok(Validation::new(&protocol, tests.collect(), start))
    }
}

fn tests() -> impl Iterator<Item = (&'static Check, (f64, [f64; 2]))> {
    ALL.iter().flat_map(|check| WOS.map(|wo| (check, wo)))
}

/// The direction at that angle and azimuth, in single precision for a BSDF that computes in it.
fn towards((degrees, [x, y]): (f64, [f64; 2]), properties: &Properties) -> Direction {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let wo = [x * sin, y * sin, cos];
    if properties.precision < f64::from(f32::EPSILON) { wo } else { wo.map(|x| f64::from(x as f32)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_of_coordinates_are_all_met_on_each_side() {
        for (side, least) in [(1.0, 2), (-1.0, 1)] {
            let wos: Vec<[f64; 2]> =
                WOS.iter().filter(|wo| wo.0 > 0.0 && (90.0 - wo.0) * side > 0.0).map(|wo| wo.1).collect();
            for [a, b] in [[1.0, 0.0], [0.0, 1.0]] {
                let met = |sign: f64| wos.iter().any(|[x, y]| (a * x + b * y) * sign > 0.0);
                assert!(met(1.0) && met(-1.0));
            }
            assert!(wos.iter().filter(|[x, y]| x * y < 0.0).count() >= least.min(1));
        }
    }
}
