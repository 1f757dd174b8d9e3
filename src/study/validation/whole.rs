//! Checks of a whole BSDF as one test.

use crate::error::Result;
use etalon_stats::bsdf::{ALL, Bsdf, Check, Direction};
use etalon_stats::{Outcome, Protocol};

/// Runs all checks for every `wo`.
pub fn examine(bsdf: &dyn Bsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    of(&ALL.iter().collect::<Vec<_>>(), bsdf, wos, protocol, round)
}

/// Runs the exact checks but for that of the energy.
pub fn exact(bsdf: &dyn Bsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    let checks: Vec<&Check> = ALL.iter().filter(|check| !check.is_statistical && check.name != "energy").collect();
    of(&checks, bsdf, wos, protocol, round)
}

/// Runs the checks of the light that is scattered: of the energy, the albedo and the weights.
pub fn light(bsdf: &dyn Bsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    let checks: Vec<&Check> =
        ALL.iter().filter(|check| ["energy", "albedo", "weights"].contains(&check.name)).collect();
    of(&checks, bsdf, wos, protocol, round)
}

/// The first violation decides, and statistical checks are left out after one; otherwise the smallest p-value of all does,
/// after a correction for their number.
fn of(checks: &[&Check], bsdf: &dyn Bsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    let inner = Protocol { tests: protocol.tests * checks.len() * wos.len(), ..*protocol };
    let (mut found, mut tests) = (Outcome::open(0), 0);
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
            let detectable = [found.detectable, outcome.detectable].into_iter().flatten().max_by(f64::total_cmp);
            let (samples, seconds) = (found.samples + outcome.samples, found.seconds + outcome.seconds);
            if outcome.p.is_some_and(|p| found.p.is_none_or(|least| p < least)) {
                found = Outcome { diagnosis: outcome.diagnosis.clone().map(named), ..outcome };
            }
            found = Outcome { violation, inconclusive_reason: reason, detectable, samples, seconds, ..found };
        }
    }
    // 1 − (1 − p)ⁿ, precise for small p.
    found.p = found.p.map(|p| if p < 1.0 { -(tests as f64 * (-p).ln_1p()).exp_m1() } else { 1.0 });
    Ok(found)
}
