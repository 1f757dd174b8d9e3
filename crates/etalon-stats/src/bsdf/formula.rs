//! The formula of weights: weight = f |cos θᵢ| / pdf, and the pdf that a sample carries.

use super::contract::{Density, PdfKind};
use super::subject::{Comparison, Subject};
use super::vector::{length, sphere};
use crate::domain::Domain;
use crate::outcome::Outcome;

/// Compares weight · pdf with f |cos θᵢ| at samples, and the pdf of each with what `pdf` returns, to the last bit. For samples of
/// delta lobes, probability and weight are those of the lobe.
pub fn check(subject: &Subject) -> Option<Outcome> {
    let Subject { bsdf, properties, wo, deltas, .. } = subject;
    let mut found = Comparison::default();
    for (u, sample) in subject.samples() {
        let wi = sample.wi;
        let at = || format!("{}, u = {u:?}", subject.at(wi));
        found.holds((length(wi) - 1.0).abs() <= 1e-5, || format!("{}: wi is not a unit vector", at()));
        match sample.density {
            Density::Pdf(pdf) if properties.pdf == PdfKind::Exact => {
                let asked = bsdf.pdf(*wo, wi);
                let equal = asked.to_bits() == pdf.to_bits();
                found.holds(equal, || format!("{}: the sample's pdf {pdf:e} is not pdf(wo, wi) = {asked:e}", at()));
                found.holds(pdf > 0.0, || format!("{}: the pdf of a sample is {pdf}", at()));
                if !subject.is_deterministic() {
                    continue;
                }
                let f = subject.eval(wi);
                for (channel, f) in f.into_iter().enumerate().take(properties.channels) {
                    let sides = [sample.weight[channel] * pdf, f * wi[2].abs()];
                    // The weight may be computed without f: its rounding is that of f/pdf at directions a last place away.
                    let rounding = || {
                        subject.rounding(sides[1], [*wo, wi], |o, i| bsdf.eval(o, i, &[])[channel] * i[2].abs())
                            + subject.rounding(pdf, [*wo, wi], |o, i| bsdf.pdf(o, i)) * sample.weight[channel]
                    };
                    let quick = subject.last_places(sides[1]);
                    found.equal(sides, quick, rounding, || format!("{} (weight · pdf, f |cos|)", at()));
                }
            }
            Density::Delta(probability) => {
                let Some(lobe) = deltas.iter().find(|lobe| sphere().same(lobe.wi, wi)) else {
                    found.holds(false, || format!("{}: this direction is none of the delta lobes", at()));
                    continue;
                };
                let mut compare = |numbers: [f64; 2], what: &str| {
                    let quick = subject.last_places(numbers[1]);
                    found.equal(numbers, quick, || quick, || format!("{} ({what})", at()));
                };
                compare([probability, lobe.probability], "probability of the sample, of the delta lobe");
                for channel in 0..properties.channels {
                    let product = sample.weight[channel] * lobe.probability;
                    compare([product, lobe.throughput[channel]], "weight · probability, throughput");
                }
            }
            _ => {}
        }
    }
    found.outcome("weight = f |cos| / pdf")
}
