//! Directions exchanged. Reciprocity: f(wo, wi)/n²(wo) = f(wi, wo)/n²(wi), n the index of refraction on the side of a direction.
//! The adjoint: importance passes from wo to wi as radiance passes from wi to wo.

use super::contract::{BsdfSample, DeltaLobe, Direction, Kind, Pair, Reciprocity};
use super::mistakes::Values;
use super::subject::{Comparison, Subject, channel_of, same_side, sphere};
use crate::diagnosis::tuple;
use crate::domain::Domain;
use crate::error::Result;
use crate::mistakes::{EQUAL, common_factor, number};
use crate::named_mistake::NamedMistake;
use crate::outcome::Outcome;

/// Exchanges the two directions, for samples and for directions all over the sphere; for delta lobes it compares the power
/// that each direction scatters to the other.
pub fn reciprocity(subject: &Subject) -> Result<Option<Outcome>> {
    if subject.properties.reciprocity != Reciprocity::Reciprocal || !subject.is_deterministic() {
        return Ok(None);
    }
    let mut found = Comparison::default();
    reciprocal_values(subject, &mut found)?;
    subject.deltas.iter().try_for_each(|lobe| reciprocal_lobe(subject, lobe, &mut found))?;
    let law =
        if subject.properties.kind == Kind::Surface { "f(wo, wi) η² = f(wi, wo)" } else { "p(wo, wi) = p(wi, wo)" };
    Ok(found.outcome(law))
}

fn reciprocal_values(subject: &Subject, found: &mut Comparison) -> Result<()> {
    let bsdf = subject.bsdf;
    let samples = subject.samples()?;
    let sampled = samples.iter().filter(|(_, sample)| !sample.is_delta()).map(|(_, sample)| sample.wi);
    // Directions along the surface have no other side, and no cosine to divide by.
    let directions = subject.directions()?.into_iter().filter(|wi| wi[2].abs() > 1e-6);
    let directions: Vec<Direction> = sampled.chain(directions).collect();
    let pairs = subject.pairs(&directions);
    let (there, back) = (bsdf.eval(&pairs, &[])?, bsdf.eval(&subject.swapped(&pairs), &[])?);
    let eta2 = |i: usize| subject.eta2(directions[i]);
    for channel in 0..subject.properties.channels {
        let (there, back) = (channel_of(&there, channel), channel_of(&back, channel));
        let numbers: Vec<[f64; 2]> = (0..pairs.len()).map(|i| [eta2(i) * there[i], back[i]]).collect();
        let rounding = |far: &[usize]| {
            let of = |values: &[f64]| far.iter().map(|&i| values[i]).collect::<Vec<f64>>();
            let pairs: Vec<Pair> = far.iter().map(|&i| pairs[i]).collect();
            let eval = |pairs: &[Pair]| Ok(channel_of(&bsdf.eval(pairs, &[])?, channel));
            let of_there = subject.rounding(&of(&there), &pairs, eval)?;
            let of_back = subject.rounding(&of(&back), &subject.swapped(&pairs), eval)?;
            let both = far.iter().zip(of_there).zip(of_back);
            Ok(both.map(|((&i, there), back)| eta2(i) * there + back).collect())
        };
        let message = |i: usize| {
            let (at, of) = (subject.at(directions[i]), subject.channel(channel));
            (Some(directions[i]), format!("{at} (f(wo, wi) η², f(wi, wo){of})"))
        };
        if !found.equal(&numbers, |i| subject.last_places(numbers[i][1]), rounding, message)? {
            let function = |pairs: &[Pair], channel| Ok(channel_of(&bsdf.eval(&subject.swapped(pairs), &[])?, channel));
            let exchanged = Values { subject, function, channel, is_exchanged: true };
            let mistake = match undeclared_eta(subject, &directions, &numbers) {
                None => exchanged
                    .explain(&directions, &numbers, ["f(wo, wi) η²", "f(wi, wo)"], || Ok(None))?
                    .map(of_one_direction),
                some => some,
            };
            found.named_in([channel, subject.properties.channels], mistake);
        }
    }
    Ok(())
}

/// The same, with what usually makes f other than its value with exchanged directions by the angle of one direction alone.
fn of_one_direction(named: NamedMistake) -> NamedMistake {
    const WORDS: &str = ": f has a factor of one direction, as by a Fresnel term at the surface's normal, or by masking of wo without shadowing of wi";
    named.with_words_after("cos θ alone", WORDS)
}

/// Where reflected light is reciprocal, transmitted light up to a factor, and no index of refraction is declared: that with which all is.
fn undeclared_eta(subject: &Subject, directions: &[Direction], numbers: &[[f64; 2]]) -> Option<NamedMistake> {
    let lit = directions.iter().zip(numbers).filter(|(_, both)| **both != [0.0; 2]);
    let ratios = lit.map(|(&wi, [there, back])| (same_side(subject.wo, wi), there / back));
    let (reflected, transmitted): (Vec<_>, Vec<_>) = ratios.partition(|(is_reflected, _)| *is_reflected);
    let factor = common_factor(&transmitted.iter().map(|(_, ratio)| *ratio).collect::<Vec<f64>>())?;
    // Other factors are no squares of indices.
    let is_usable = subject.properties.eta == 1.0 && (1.0 / 9.0..=9.0).contains(&factor);
    if !is_usable || reflected.iter().any(|(_, ratio)| (ratio - 1.0).abs() > EQUAL) {
        return None;
    }
    let eta = if subject.wo[2] > 0.0 { factor.sqrt().recip() } else { factor.sqrt() };
    let [factor, eta] = [factor, eta].map(number);
    Some(NamedMistake::from(format!(
        "f(wo, wi) η² is {factor} times f(wi, wo) where light is transmitted, as of eta = {eta}, which is not declared"
    )))
}

fn reciprocal_lobe(subject: &Subject, lobe: &DeltaLobe, found: &mut Comparison) -> Result<()> {
    let Subject { bsdf, properties, wo, .. } = subject;
    // What the delta lobe of one of `lobes` scatters to the side of `wo`.
    let passed = |lobes: &[DeltaLobe], channel: usize| {
        let back = lobes.iter().find(|back| same_side(back.wi, *wo));
        back.map_or(0.0, |back| back.throughput[channel] / subject.eta2(lobe.wi))
    };
    let lobes = bsdf.delta_lobes(&[lobe.wi])?.swap_remove(0);
    let returns = lobes.iter().any(|back| sphere().same(back.wi.into(), (*wo).into()));
    for channel in 0..properties.channels {
        let power = subject.eta2(lobe.wi) * lobe.throughput[channel];
        let found_back = if returns { passed(&lobes, channel) } else { 0.0 };
        // Moved by rounding, a direction near the critical angle may be reflected totally.
        let rounding = |_: &[usize]| {
            let of = |pairs: &[Pair]| {
                let from: Vec<Direction> = pairs.iter().map(|[from, _]| *from).collect();
                Ok(bsdf.delta_lobes(&from)?.iter().map(|lobes| passed(lobes, channel)).collect())
            };
            let rounding = subject.rounding(&[found_back], &[[lobe.wi, *wo]], of)?;
            Ok(vec![subject.last_places(power) + rounding[0]])
        };
        let message = |_| (Some(lobe.wi), format!("{} (power there and back)", subject.at(lobe.wi)));
        let quick = subject.last_places(power);
        found.equal(&[[power, found_back]], |_| quick, rounding, message)?;
    }
    Ok(())
}

/// Compares the value for importance with f(wi, wo), and the weight of a sample for importance with that for radiance times η².
/// A BSDF whose f is not reciprocal has no such weights.
pub fn adjoint(subject: &Subject) -> Result<Option<Outcome>> {
    if !subject.is_deterministic() {
        return Ok(None);
    }
    let (samples, mut found) = (subject.samples()?, Comparison::default());
    adjoint_values(subject, &samples, &mut found)?;
    adjoint_weights(subject, &samples, &mut found)?;
    Ok(found.outcome("the adjoint"))
}

fn adjoint_values(subject: &Subject, samples: &[(Vec<f64>, BsdfSample)], found: &mut Comparison) -> Result<()> {
    let Subject { bsdf, properties, wo, .. } = subject;
    let spread = samples.iter().filter(|(_, sample)| !sample.is_delta());
    let pairs: Vec<Pair> = spread.map(|(_, sample)| [*wo, sample.wi]).collect();
    let values = bsdf.eval_adjoint(&pairs)?;
    let known = pairs.into_iter().zip(values).filter_map(|(pair, value)| Some((pair, value?)));
    let (pairs, adjoint): (Vec<Pair>, Vec<_>) = known.unzip();
    let back = bsdf.eval(&subject.swapped(&pairs), &[])?;
    for channel in 0..properties.channels {
        let numbers: Vec<[f64; 2]> =
            adjoint.iter().zip(&back).map(|(adjoint, back)| [adjoint[channel], back[channel]]).collect();
        let rounding = |far: &[usize]| {
            let of = |values: fn([f64; 2]) -> f64| far.iter().map(|&i| values(numbers[i])).collect::<Vec<f64>>();
            let pairs: Vec<Pair> = far.iter().map(|&i| pairs[i]).collect();
            let of_back = subject.rounding(&of(|[_, back]| back), &subject.swapped(&pairs), |pairs| {
                Ok(channel_of(&bsdf.eval(pairs, &[])?, channel))
            })?;
            let of_adjoint = subject.rounding(&of(|[adjoint, _]| adjoint), &pairs, |pairs| {
                let values = bsdf.eval_adjoint(pairs)?.into_iter();
                Ok(values.map(|value| value.map_or(f64::NAN, |f| f[channel])).collect())
            })?;
            Ok(of_back.iter().zip(of_adjoint).map(|(a, b)| a + b).collect())
        };
        let message = |i: usize| {
            let [_, wi] = pairs[i];
            (Some(wi), format!("{} (value for importance, f(wi, wo))", subject.at(wi)))
        };
        found.equal(&numbers, |i| subject.last_places(numbers[i][1]), rounding, message)?;
    }
    Ok(())
}

fn adjoint_weights(subject: &Subject, samples: &[(Vec<f64>, BsdfSample)], found: &mut Comparison) -> Result<()> {
    let u: Vec<f64> = samples.iter().flat_map(|(u, _)| u).copied().collect();
    let adjoint = subject.bsdf.sample_adjoint(&vec![subject.wo; samples.len()], &u)?;
    let mut both = Vec::new();
    for ((u, sample), adjoint) in samples.iter().zip(adjoint) {
        let (Some(adjoint), wi) = (adjoint, sample.wi) else { continue };
        let same = adjoint.is_some_and(|other| other.wi == wi && other.density == sample.density);
        found.holds(same, || format!("{}, u = {}: importance is sampled otherwise", subject.at(wi), tuple(u)));
        both.extend(adjoint.map(|adjoint| (adjoint.weight, sample.weight.map(|w| w * subject.eta2(wi)), wi)));
    }
    for channel in 0..subject.properties.channels {
        let numbers: Vec<[f64; 2]> =
            both.iter().map(|(found, expected, _)| [found[channel], expected[channel]]).collect();
        let message =
            |i: usize| (Some(both[i].2), format!("{} (weight for importance, weight · η²)", subject.at(both[i].2)));
        found.near(&numbers, |i| subject.last_places(numbers[i][1]), message)?;
    }
    Ok(())
}
