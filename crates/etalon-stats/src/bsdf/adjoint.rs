//! The adjoint: importance passes from wo to wi as radiance passes from wi to wo.

use super::batch::Pair;
use super::contract::BsdfSample;
use super::subject::{Comparison, Subject, channel_of, swapped};
use crate::error::Result;
use crate::outcome::Outcome;

/// Compares the value for importance with f(wi, wo), and the weight of a sample for importance with that for radiance times η².
/// A BSDF whose f is not reciprocal has no such weights.
pub fn check(subject: &Subject) -> Result<Option<Outcome>> {
    if !subject.is_deterministic() {
        return Ok(None);
    }
    let (samples, mut found) = (subject.samples()?, Comparison::default());
    values(subject, &samples, &mut found)?;
    weights(subject, &samples, &mut found)?;
    Ok(found.outcome("the adjoint"))
}

fn values(subject: &Subject, samples: &[(Vec<f64>, BsdfSample)], found: &mut Comparison) -> Result<()> {
    let Subject { bsdf, properties, wo, .. } = subject;
    let spread = samples.iter().filter(|(_, sample)| !sample.is_delta());
    let pairs: Vec<Pair> = spread.map(|(_, sample)| [*wo, sample.wi]).collect();
    let values = bsdf.eval_adjoint(&pairs)?;
    let known = pairs.into_iter().zip(values).filter_map(|(pair, value)| Some((pair, value?)));
    let (pairs, adjoint): (Vec<Pair>, Vec<_>) = known.unzip();
    let back = bsdf.eval(&swapped(&pairs), &[])?;
    for channel in 0..properties.channels {
        let numbers: Vec<[f64; 2]> =
            adjoint.iter().zip(&back).map(|(adjoint, back)| [adjoint[channel], back[channel]]).collect();
        let rounding = |far: &[usize]| {
            let of = |values: fn([f64; 2]) -> f64| far.iter().map(|&i| values(numbers[i])).collect::<Vec<f64>>();
            let pairs: Vec<Pair> = far.iter().map(|&i| pairs[i]).collect();
            let of_back = subject.rounding(&of(|[_, back]| back), &swapped(&pairs), |pairs| {
                Ok(channel_of(&bsdf.eval(pairs, &[])?, channel))
            })?;
            let of_adjoint = subject.rounding(&of(|[adjoint, _]| adjoint), &pairs, |pairs| {
                let values = bsdf.eval_adjoint(pairs)?.into_iter();
                Ok(values.map(|value| value.map_or(f64::NAN, |f| f[channel])).collect())
            })?;
            Ok(of_back.iter().zip(of_adjoint).map(|(a, b)| a + b).collect())
        };
        let message = |i: usize| format!("{} (value for importance, f(wi, wo))", subject.at(pairs[i][1]));
        found.equal(&numbers, |i| subject.last_places(numbers[i][1]), rounding, message)?;
    }
    Ok(())
}

fn weights(subject: &Subject, samples: &[(Vec<f64>, BsdfSample)], found: &mut Comparison) -> Result<()> {
    let u: Vec<f64> = samples.iter().flat_map(|(u, _)| u).copied().collect();
    let adjoint = subject.bsdf.sample_adjoint(&vec![subject.wo; samples.len()], &u)?;
    let mut both = Vec::new();
    for ((u, sample), adjoint) in samples.iter().zip(adjoint) {
        let (Some(adjoint), wi) = (adjoint, sample.wi) else { continue };
        let same = adjoint.is_some_and(|other| other.wi == wi && other.density == sample.density);
        found.holds(same, || format!("{}, u = {u:?}: importance is sampled otherwise", subject.at(wi)));
        both.extend(adjoint.map(|adjoint| (adjoint.weight, sample.weight.map(|w| w * subject.eta2(wi)), wi)));
    }
    for channel in 0..subject.properties.channels {
        let numbers: Vec<[f64; 2]> =
            both.iter().map(|(found, expected, _)| [found[channel], expected[channel]]).collect();
        let message = |i: usize| format!("{} (weight for importance, weight · η²)", subject.at(both[i].2));
        found.near(&numbers, |i| subject.last_places(numbers[i][1]), message)?;
    }
    Ok(())
}
