//! The adjoint: importance passes from wo to wi as radiance passes from wi to wo.

use super::subject::{Comparison, Subject};
use crate::outcome::Outcome;

/// Compares the value for importance with f(wi, wo), and the weight of a sample for importance with that for radiance times η².
/// A BSDF whose f is not reciprocal has no such weights.
pub fn check(subject: &Subject) -> Option<Outcome> {
    let Subject { bsdf, properties, wo, .. } = subject;
    if !subject.is_deterministic() {
        return None;
    }
    let mut found = Comparison::default();
    for (u, sample) in subject.samples() {
        let wi = sample.wi;
        if let Some(adjoint) = bsdf.eval_adjoint(*wo, wi).filter(|_| !sample.is_delta()) {
            let back = bsdf.eval(wi, *wo, &[]);
            for channel in 0..properties.channels {
                let sides = [adjoint[channel], back[channel]];
                let adjoint_at = |a, b| bsdf.eval_adjoint(a, b).map_or(f64::NAN, |f| f[channel]);
                let rounding = || {
                    subject.rounding(back[channel], [wi, *wo], |a, b| bsdf.eval(a, b, &[])[channel])
                        + subject.rounding(adjoint[channel], [*wo, wi], adjoint_at)
                };
                let message = || format!("{} (value for importance, f(wi, wo))", subject.at(wi));
                found.equal(sides, subject.last_places(sides[1]), rounding, message);
            }
        }
        if let Some(adjoint) = bsdf.sample_adjoint(*wo, &u) {
            let same = adjoint.is_some_and(|other| other.wi == wi && other.density == sample.density);
            found.holds(same, || format!("{}, u = {u:?}: importance is sampled otherwise", subject.at(wi)));
            let Some(adjoint) = adjoint else { continue };
            for channel in 0..properties.channels {
                let sides = [adjoint.weight[channel], sample.weight[channel] * subject.eta2(wi)];
                let quick = subject.last_places(sides[1]);
                let message = || format!("{} (weight for importance, weight · η²)", subject.at(wi));
                found.equal(sides, quick, || quick, message);
            }
        }
    }
    found.outcome("the adjoint")
}
