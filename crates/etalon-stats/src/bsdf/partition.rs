//! Lobe mixtures: the balance heuristic's weights of the lobes sum to 1, that is the pdfs of the lobes sum to the pdf.

use super::contract::PdfKind;
use super::subject::{Comparison, Subject};
use crate::outcome::Outcome;

/// Adds the pdfs of all lobes, each times the lobe's probability, and compares the sum with the pdf.
pub fn check(subject: &Subject) -> Option<Outcome> {
    let Subject { bsdf, properties, wo, .. } = subject;
    if bsdf.lobes() < 2 || properties.pdf != PdfKind::Exact {
        return None;
    }
    let mut found = Comparison::default();
    let samples = subject.samples();
    let sampled = samples.iter().filter(|(_, sample)| !sample.is_delta()).map(|(_, sample)| sample.wi);
    for wi in sampled.chain(subject.directions()) {
        let pdfs: Option<Vec<f64>> = (0..bsdf.lobes()).map(|lobe| bsdf.lobe_pdf(*wo, wi, lobe)).collect();
        let sides = [pdfs?.iter().sum(), bsdf.pdf(*wo, wi)];
        let rounding = || subject.rounding(sides[1], [*wo, wi], |a, b| bsdf.pdf(a, b));
        let message = || format!("{} (sum over the lobes, pdf)", subject.at(wi));
        found.equal(sides, subject.last_places(sides[1]), rounding, message);
    }
    found.outcome("pdf = Σ of the lobes' pdfs")
}
