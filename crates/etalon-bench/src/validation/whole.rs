//! Checks of a whole BSDF as one test.

use etalon_core::error::Result;
use etalon_stats::Extremes;
use etalon_stats::bsdf::{ALL, BatchBsdf, Check, Direction};
use etalon_stats::{Outcome, Protocol};

/// Runs all checks for every `wo`.
pub fn examine(bsdf: &dyn BatchBsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    of(&ALL.iter().collect::<Vec<_>>(), bsdf, wos, protocol, round)
}

/// Runs the exact checks.
pub fn exact(bsdf: &dyn BatchBsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    let checks: Vec<&Check> = ALL.iter().filter(|check| !check.is_statistical).collect();
    of(&checks, bsdf, wos, protocol, round)
}

/// Runs the checks of the light that is scattered: of the energy, the albedo and the weights.
pub fn light(bsdf: &dyn BatchBsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    let checks: Vec<&Check> =
        ALL.iter().filter(|check| ["energy", "albedo", "weights"].contains(&check.name)).collect();
    of(&checks, bsdf, wos, protocol, round)
}

/// The first violation decides, and statistical checks are left out after one; otherwise the smallest p-value of all does,
/// after a correction for their number.
fn of(checks: &[&Check], bsdf: &dyn BatchBsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    let inner = Protocol { tests: protocol.tests * checks.len() * wos.len(), ..*protocol };
    let (mut found, mut tests) = (Outcome::open(0), 0);
    let (mut detectable, mut exact) = (0f64, Vec::new());
    for check in checks {
        if check.is_statistical && found.violation.is_some() {
            break;
        }
        for &wo in wos {
            let Some(outcome) = check.examine(bsdf, wo, &inner, round)? else { continue };
            tests += usize::from(outcome.p.is_some());
            let named = |text: String| format!("{}: {text}", check.name);
            let violation = found.violation.take().or(outcome.violation.clone().map(named));
            let reason = found.inconclusive_reason.take().or(outcome.inconclusive_reason.clone().map(named));
            if check.is_statistical {
                detectable = detectable.at_least(outcome.detectable.unwrap_or(0.0));
            } else {
                exact.push((outcome.detectable.unwrap_or(0.0), outcome.samples));
            }
            let (samples, seconds) = (found.samples + outcome.samples, found.seconds + outcome.seconds);
            if outcome.p.is_some_and(|p| found.p.is_none_or(|least| p < least || p.is_nan())) {
                found = Outcome { diagnosis: outcome.diagnosis.clone().map(named), ..outcome };
            }
            found = Outcome { violation, inconclusive_reason: reason, samples, seconds, ..found };
        }
    }
    found.detectable = Some(detectable.at_least(found_in_most(exact)));
    // 1 − (1 − p)ⁿ, precise for small p.
    found.p = found.p.map(|p| if p >= 1.0 { 1.0 } else { -(tests as f64 * (-p).ln_1p()).exp_m1() });
    Ok(found)
}

/// The error that nine of ten comparisons would have found, from that of several checks with their numbers of comparisons.
fn found_in_most(mut checks: Vec<(f64, u64)>) -> f64 {
    checks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let most = 0.9 * checks.iter().map(|(_, compared)| *compared as f64).sum::<f64>();
    let mut sum = 0.0;
    let reaches = |(_, compared): &&(f64, u64)| {
        sum += *compared as f64;
        sum >= most
    };
    checks.iter().find(reaches).map_or(0.0, |(error, _)| *error)
}
