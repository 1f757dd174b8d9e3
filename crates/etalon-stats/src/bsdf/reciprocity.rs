//! Reciprocity: f(wo, wi)/n²(wo) = f(wi, wo)/n²(wi), n the index of refraction on the side of a direction.

use super::batch::Pair;
use super::contract::{DeltaLobe, Direction, Reciprocity};
use super::subject::{Comparison, Subject, channel_of, swapped};
use super::vector::{same_side, sphere};
use crate::domain::Domain;
use crate::error::Result;
use crate::outcome::Outcome;

/// Exchanges the two directions, for samples and for directions all over the sphere; for delta lobes it compares the power
/// that each direction scatters to the other.
pub fn check(subject: &Subject) -> Result<Option<Outcome>> {
    if subject.properties.reciprocity != Reciprocity::Reciprocal || !subject.is_deterministic() {
        return Ok(None);
    }
    let mut found = Comparison::default();
    values(subject, &mut found)?;
    subject.deltas.iter().try_for_each(|lobe| delta_lobe(subject, lobe, &mut found))?;
    Ok(found.outcome("f(wo, wi) η² = f(wi, wo)"))
}

fn values(subject: &Subject, found: &mut Comparison) -> Result<()> {
    let bsdf = subject.bsdf;
    let samples = subject.samples()?;
    let sampled = samples.iter().filter(|(_, sample)| !sample.is_delta()).map(|(_, sample)| sample.wi);
    // Directions along the surface have no other side, and no cosine to divide by.
    let directions = subject.directions().into_iter().filter(|wi| wi[2].abs() > 1e-6);
    let directions: Vec<Direction> = sampled.chain(directions).collect();
    let pairs = subject.pairs(&directions);
    let (there, back) = (bsdf.eval(&pairs, &[])?, bsdf.eval(&swapped(&pairs), &[])?);
    let eta2 = |i: usize| subject.eta2(directions[i]);
    for channel in 0..subject.properties.channels {
        let (there, back) = (channel_of(&there, channel), channel_of(&back, channel));
        let numbers: Vec<[f64; 2]> = (0..pairs.len()).map(|i| [eta2(i) * there[i], back[i]]).collect();
        let rounding = |far: &[usize]| {
            let of = |values: &[f64]| far.iter().map(|&i| values[i]).collect::<Vec<f64>>();
            let pairs: Vec<Pair> = far.iter().map(|&i| pairs[i]).collect();
            let eval = |pairs: &[Pair]| Ok(channel_of(&bsdf.eval(pairs, &[])?, channel));
            let of_there = subject.rounding(&of(&there), &pairs, eval)?;
            let of_back = subject.rounding(&of(&back), &swapped(&pairs), eval)?;
            let both = far.iter().zip(of_there).zip(of_back);
            Ok(both.map(|((&i, there), back)| eta2(i) * there + back).collect())
        };
        let message = |i: usize| format!("{} (f(wo, wi) η², f(wi, wo))", subject.at(directions[i]));
        found.equal(&numbers, |i| subject.last_places(numbers[i][1]), rounding, message)?;
    }
    Ok(())
}

fn delta_lobe(subject: &Subject, lobe: &DeltaLobe, found: &mut Comparison) -> Result<()> {
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
        let message = |_| format!("{} (power there and back)", subject.at(lobe.wi));
        let quick = subject.last_places(power);
        found.equal(&[[power, found_back]], |_| quick, rounding, message)?;
    }
    Ok(())
}
