//! Lobe mixtures: the balance heuristic's weights of the lobes sum to 1, that is the pdfs of the lobes sum to the pdf.

use super::contract::{Direction, PdfKind};
use super::subject::{Comparison, Subject};
use crate::error::Result;
use crate::outcome::Outcome;

/// Adds the pdfs of all lobes, each times the lobe's probability, and compares the sum with the pdf.
pub fn check(subject: &Subject) -> Result<Option<Outcome>> {
    let Subject { bsdf, properties, .. } = subject;
    if bsdf.lobes() < 2 || properties.pdf != PdfKind::Exact {
        return Ok(None);
    }
    let samples = subject.samples()?;
    let sampled = samples.iter().filter(|(_, sample)| !sample.is_delta()).map(|(_, sample)| sample.wi);
    let directions: Vec<Direction> = sampled.chain(subject.directions()).collect();
    let pairs = subject.pairs(&directions);
    let mut numbers: Vec<[f64; 2]> = bsdf.pdf(&pairs)?.into_iter().map(|pdf| [0.0, pdf]).collect();
    for lobe in 0..bsdf.lobes() {
        for (numbers, pdf) in numbers.iter_mut().zip(bsdf.lobe_pdf(&pairs, &vec![lobe; pairs.len()])?) {
            let Some(pdf) = pdf else { return Ok(None) };
            numbers[0] += pdf;
        }
    }
    let rounding = |far: &[usize]| {
        let (pdfs, pairs): (Vec<f64>, Vec<_>) = far.iter().map(|&i| (numbers[i][1], pairs[i])).unzip();
        subject.rounding(&pdfs, &pairs, |pairs| bsdf.pdf(pairs))
    };
    let message = |i: usize| format!("{} (sum over the lobes, pdf)", subject.at(directions[i]));
    let mut found = Comparison::default();
    found.equal(&numbers, |i| subject.last_places(numbers[i][1]), rounding, message)?;
    Ok(found.outcome("pdf = Σ of the lobes' pdfs"))
}
