//! The formula of weights: weight = f |cos θᵢ| / pdf, and the pdf that a sample carries.

use super::batch::Pair;
use super::contract::{BsdfSample, Density, PdfKind};
use super::subject::{Comparison, Subject};
use super::vector::{length, sphere};
use crate::domain::Domain;
use crate::error::Result;
use crate::outcome::Outcome;

/// A sample that is no delta lobe's, with its random numbers and its pdf.
type Spread<'a> = (&'a Vec<f64>, &'a BsdfSample, f64);

/// Compares weight · pdf with f |cos θᵢ| at samples, and the pdf of each with what `pdf` returns, to the last bit. For samples of
/// delta lobes, probability and weight are those of the lobe.
pub fn check(subject: &Subject) -> Result<Option<Outcome>> {
    let mut found = Comparison::default();
    let samples = subject.samples()?;
    let (mut spread, mut delta) = (Vec::new(), Vec::new());
    for (u, sample) in &samples {
        let unit = (length(sample.wi) - 1.0).abs() <= 1e-5;
        found.holds(unit, || format!("{}, u = {u:?}: wi is not a unit vector", subject.at(sample.wi)));
        match sample.density {
            Density::Pdf(pdf) if subject.properties.pdf == PdfKind::Exact => spread.push((u, sample, pdf)),
            Density::Delta(probability) => delta.push((u, sample, probability)),
            _ => {}
        }
    }
    carried_pdfs(subject, &spread, &mut found)?;
    if subject.is_deterministic() {
        weights(subject, &spread, &mut found)?;
    }
    delta_lobes(subject, &delta, &mut found)?;
    Ok(found.outcome("weight = f |cos| / pdf"))
}

fn at(subject: &Subject, (u, sample, _): &Spread) -> String {
    format!("{}, u = {u:?}", subject.at(sample.wi))
}

fn pairs(subject: &Subject, spread: &[Spread]) -> Vec<Pair> {
    spread.iter().map(|(_, sample, _)| [subject.wo, sample.wi]).collect()
}

fn carried_pdfs(subject: &Subject, spread: &[Spread], found: &mut Comparison) -> Result<()> {
    for (sample, asked) in spread.iter().zip(subject.bsdf.pdf(&pairs(subject, spread))?) {
        let (at, pdf) = (|| at(subject, sample), sample.2);
        let equal = asked.to_bits() == pdf.to_bits();
        found.holds(equal, || format!("{}: the sample's pdf {pdf:e} is not pdf(wo, wi) = {asked:e}", at()));
        found.holds(pdf > 0.0, || format!("{}: the pdf of a sample is {pdf}", at()));
    }
    Ok(())
}

fn weights(subject: &Subject, spread: &[Spread], found: &mut Comparison) -> Result<()> {
    let Subject { bsdf, properties, .. } = subject;
    let pairs = pairs(subject, spread);
    let values = bsdf.eval(&pairs, &[])?;
    for channel in 0..properties.channels {
        let both = spread.iter().zip(&values);
        let numbers: Vec<[f64; 2]> =
            both.map(|((_, sample, pdf), f)| [sample.weight[channel] * pdf, f[channel] * sample.wi[2].abs()]).collect();
        // The weight may be computed without f: its rounding is that of f/pdf at directions a last place away.
        let rounding = |far: &[usize]| {
            let pairs: Vec<Pair> = far.iter().map(|&i| pairs[i]).collect();
            let light: Vec<f64> = far.iter().map(|&i| numbers[i][1]).collect();
            let of_light = subject.rounding(&light, &pairs, |pairs| {
                let values = bsdf.eval(pairs, &[])?.into_iter().zip(pairs);
                Ok(values.map(|(f, [_, wi])| f[channel] * wi[2].abs()).collect())
            })?;
            let pdfs: Vec<f64> = far.iter().map(|&i| spread[i].2).collect();
            let of_pdf = subject.rounding(&pdfs, &pairs, |pairs| bsdf.pdf(pairs))?;
            let weight = |i: usize| spread[i].1.weight[channel];
            let both = of_light.iter().zip(of_pdf).zip(far);
            Ok(both.map(|((light, pdf), &i)| light + pdf * weight(i)).collect())
        };
        let message = |i: usize| format!("{} (weight · pdf, f |cos|)", at(subject, &spread[i]));
        found.equal(&numbers, |i| subject.last_places(numbers[i][1]), rounding, message)?;
    }
    Ok(())
}

fn delta_lobes(subject: &Subject, samples: &[Spread], found: &mut Comparison) -> Result<()> {
    for sample in samples {
        let (at, &(_, &BsdfSample { wi, weight, .. }, probability)) = (|| at(subject, sample), sample);
        let Some(lobe) = subject.deltas.iter().find(|lobe| sphere().same(lobe.wi.into(), wi.into())) else {
            found.holds(false, || format!("{}: this direction is none of the delta lobes", at()));
            continue;
        };
        let mut compare = |numbers: [f64; 2], what: &str| {
            found.near(&[numbers], |_| subject.last_places(numbers[1]), |_| format!("{} ({what})", at()))
        };
        compare([probability, lobe.probability], "probability of the sample, of the delta lobe")?;
        for (channel, weight) in weight.iter().enumerate().take(subject.properties.channels) {
            let product = weight * lobe.probability;
            compare([product, lobe.throughput[channel]], "weight · probability, throughput")?;
        }
    }
    Ok(())
}
