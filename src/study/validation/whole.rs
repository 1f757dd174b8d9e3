//! All checks of a whole BSDF as one test.

use crate::error::Result;
use etalon_stats::bsdf::{ALL, Bsdf, Direction};
use etalon_stats::{Outcome, Protocol};

/// Runs all checks for every `wo`. The first violation decides, and statistical checks are left out after one; otherwise
/// the smallest p-value of all does, after a correction for their number.
pub fn examine(bsdf: &dyn Bsdf, wos: &[Direction], protocol: &Protocol, round: u64) -> Result<Outcome> {
    let inner = Protocol { tests: protocol.tests * ALL.len() * wos.len(), ..*protocol };
    let (mut found, mut tests) = (Outcome::open(0), 0);
    for check in ALL.iter().filter(|check| !check.is_statistical).chain(ALL.iter().filter(|check| check.is_statistical))
    {
        if check.is_statistical && found.violation.is_some() {
            break;
        }
        for &wo in wos {
            let Some(outcome) = check.examine(bsdf, wo, &inner, round)? else { continue };
            let named = |text: String| format!("{}: {text}", check.name);
            tests += usize::from(outcome.p.is_some());
            let violation = found.violation.take().or(outcome.violation.clone().map(named));
            let reason = found.inconclusive_reason.take().or(outcome.inconclusive_reason.clone().map(named));
            let (samples, seconds) = (found.samples + outcome.samples, found.seconds + outcome.seconds);
            if outcome.p.is_some_and(|p| found.p.is_none_or(|least| p < least)) {
                found = Outcome { diagnosis: outcome.diagnosis.clone().map(named), ..outcome };
            }
            found = Outcome { violation, inconclusive_reason: reason, samples, seconds, ..found };
        }
    }
    // 1 − (1 − p)ⁿ, precise for small p.
    let corrected = |p: f64| if p < 1.0 { -(tests as f64 * (-p).ln_1p()).exp_m1() } else { 1.0 };
    found.p = found.p.map(corrected);
    Ok(found)
}
