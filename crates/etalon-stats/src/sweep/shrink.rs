//! The simplest configuration in which a check still fails.

use super::decide::{CONFIRM_LEVEL, Finding, State, confirm};
use super::space::Configuration;
use crate::bsdf::{Family, Parameter};
use crate::error::Result;
use crate::extremes::Extremes;

/// A failure in the simplest configuration that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Shrunk {
    /// The configuration.
    pub configuration: Configuration,
    /// What the check says of it.
    pub finding: Finding,
    /// Configurations that were tried.
    pub tried: usize,
}

/// Angles with the normal in degrees, on one side, from the simplest.
const THETAS: [f64; 9] = [0.0, 45.0, 60.0, 30.0, 75.0, 80.0, 85.0, 89.0, 89.9];
/// Azimuths in degrees, from the simplest.
const PHIS: [f64; 3] = [0.0, 90.0, 45.0];
/// Every coordinate may become simpler after others have: two rounds find most of that.
pub(super) const ROUNDS: usize = 2;

/// What a check says of a configuration if it fails there: for an exact one that something is wrong, for a statistical one
/// p < [`CONFIRM_LEVEL`].
///
/// # Errors
/// As [`confirm`].
pub fn fails(
    family: &dyn Family,
    configuration: &Configuration,
    check: usize,
    detect: f64,
    cancelled: fn() -> bool,
) -> Result<Option<Finding>> {
    let found = confirm(family, configuration, check, detect, cancelled)?;
    Ok(found.filter(|found| found.state == State::Violated || found.p.is_some_and(|p| p < CONFIRM_LEVEL)))
}

/// Moves parameters to their default or to round values and the direction to simple angles, one at a time, as long as the
/// check fails. Tests of candidates have the level [`CONFIRM_LEVEL`], so that none fails by chance. `None` if the check
/// does not fail at this level in `configuration` itself.
///
/// # Errors
/// As [`confirm`].
pub fn shrink(
    family: &dyn Family,
    configuration: &Configuration,
    check: usize,
    detect: f64,
    cancelled: fn() -> bool,
) -> Result<Option<Shrunk>> {
    let Some(finding) = fails(family, configuration, check, detect, cancelled)? else { return Ok(None) };
    let mut best = Shrunk { configuration: configuration.clone(), finding, tried: 1 };
    let parameters = family.parameters();
    for _ in 0..ROUNDS {
        let before = best.configuration.clone();
        for axis in 0..parameters.len() + 2 {
            for candidate in simpler(&best.configuration, &parameters, axis) {
                best.tried += 1;
                if let Some(finding) = fails(family, &candidate, check, detect, cancelled)? {
                    best = Shrunk { configuration: candidate, finding, ..best };
                    break;
                }
            }
        }
        if best.configuration == before {
            break;
        }
    }
    Ok(Some(best))
}

/// The same configuration with simpler values on one axis, the simplest first: parameters, then the angle, then the azimuth.
fn simpler(configuration: &Configuration, parameters: &[Parameter], axis: usize) -> Vec<Configuration> {
    let [theta, phi] = configuration.wo;
    let current = match axis.checked_sub(parameters.len()) {
        None => configuration.values[axis],
        Some(0) => theta,
        Some(_) => phi,
    };
    let is_below = theta > 90.0;
    let side = |angle: f64| if is_below { 180.0 - angle } else { angle };
    let candidates: Vec<f64> = match axis.checked_sub(parameters.len()) {
        None => round_values(&configuration.values[..=axis], &parameters[..=axis]),
        Some(0) => {
            let whole = side(side(theta).round()).within(0.0, 180.0);
            let whole = if whole == 90.0 { theta } else { whole };
            // Above the surface is simpler than below.
            let above = is_below.then_some(180.0 - theta);
            above.into_iter().chain(THETAS.map(side)).chain([whole]).collect()
        }
        Some(_) => PHIS.into_iter().chain([phi.round()]).collect(),
    };
    let is_simpler = candidates.into_iter().take_while(|&candidate| candidate != current);
    let moved = |value: f64| {
        let mut moved = configuration.clone();
        match axis.checked_sub(parameters.len()) {
            None => moved.values[axis] = value,
            Some(coordinate) => moved.wo[coordinate.min(1)] = value,
        }
        moved
    };
    is_simpler.map(moved).collect()
}

/// Values of the last parameter from the simplest: the default, those of parameters before it with the same range (widths
/// of an isotropic surface), a power of ten, one digit, the nearest end of the range, two digits.
pub(super) fn round_values(values: &[f64], parameters: &[Parameter]) -> Vec<f64> {
    let ([before @ .., value], [others @ .., Parameter { value: default, range, .. }]) = (values, parameters) else {
        return Vec::new();
    };
    let [from, to] = *range;
    let digits = |n: usize| format!("{value:.n$e}").parse().unwrap_or(*value);
    let power = if *value > 0.0 { 10f64.powi(value.log10().round() as i32) } else { 0.0 };
    let nearest = if value - from < to - value { from } else { to };
    let equal = before.iter().zip(others).filter(|(_, other)| other.range == *range).map(|(value, _)| *value);
    let all = [*default].into_iter().chain(equal).chain([power, digits(0), nearest, digits(1)]);
    all.filter(|value| (from..=to).contains(value)).collect()
}
