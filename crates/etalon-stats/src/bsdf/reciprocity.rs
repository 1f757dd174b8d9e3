//! Reciprocity: f(wo, wi)/n²(wo) = f(wi, wo)/n²(wi), n the index of refraction on the side of a direction.

use super::contract::{Direction, Reciprocity};
use super::subject::{Comparison, Subject};
use super::vector::{same_side, sphere};
use crate::domain::Domain;
use crate::outcome::Outcome;

/// Exchanges the two directions, for samples and for directions all over the sphere; for delta lobes it compares the power
/// that each direction passes on to the other.
pub fn check(subject: &Subject) -> Option<Outcome> {
    let Subject { bsdf, properties, wo, deltas, .. } = subject;
    if properties.reciprocity != Reciprocity::Reciprocal || !subject.is_deterministic() {
        return None;
    }
    let mut found = Comparison::default();
    let samples = subject.samples();
    let sampled = samples.iter().filter(|(_, sample)| !sample.is_delta()).map(|(_, sample)| sample.wi);
    // Directions along the surface have no other side, and no cosine to divide by.
    let directions = subject.directions().into_iter().filter(|wi| wi[2].abs() > 1e-6);
    for wi in sampled.chain(directions) {
        let (there, back) = (subject.eval(wi), bsdf.eval(wi, *wo, &[]));
        let eta2 = subject.eta2(wi);
        for channel in 0..properties.channels {
            let sides = [eta2 * there[channel], back[channel]];
            let of = |a: Direction, b: Direction| bsdf.eval(a, b, &[])[channel];
            let rounding = || {
                eta2 * subject.rounding(there[channel], [*wo, wi], of) + subject.rounding(back[channel], [wi, *wo], of)
            };
            let message = || format!("{} (f(wo, wi) η², f(wi, wo))", subject.at(wi));
            found.equal(sides, subject.last_places(sides[1]), rounding, message);
        }
    }
    for lobe in deltas {
        // What a delta lobe of `from` passes on to the side of `wo`.
        let passed = |from: Direction, channel: usize| {
            let lobes = bsdf.delta_lobes(from);
            let back = lobes.iter().find(|back| same_side(back.wi, *wo));
            back.map_or(0.0, |back| back.throughput[channel] / subject.eta2(lobe.wi))
        };
        let returns = bsdf.delta_lobes(lobe.wi).iter().any(|back| sphere().same(back.wi, *wo));
        for channel in 0..properties.channels {
            let power = subject.eta2(lobe.wi) * lobe.throughput[channel];
            let found_back = if returns { passed(lobe.wi, channel) } else { 0.0 };
            // Moved by rounding, a direction near the critical angle may be reflected totally.
            let rounding = || {
                let of = |from: Direction, _: Direction| passed(from, channel);
                subject.last_places(power) + subject.rounding(found_back, [lobe.wi, *wo], of)
            };
            let message = || format!("{} (power there and back)", subject.at(lobe.wi));
            found.equal([power, found_back], subject.last_places(power), rounding, message);
        }
    }
    found.outcome("f(wo, wi) η² = f(wi, wo)")
}
