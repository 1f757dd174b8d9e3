//! Samples against the pdf: the chi-square test on the sphere, with atoms for delta lobes.

use super::contract::{BsdfSample, Density as Probability, PdfKind};
use super::subject::{Subject, directions, sphere};
use crate::domain::Point;
use crate::error::Result;
use crate::examine::examine;
use crate::outcome::Outcome;
use crate::sampler::{Atom, Density, Mass, Sample, Sampler};

/// The samples and the pdf of a BSDF.
struct Scattering<'a>(&'a Subject<'a>);

impl Sampler for Scattering<'_> {
    fn dimension(&self) -> usize {
        self.0.properties.dimension
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample>>) -> Result<()> {
        let of = |sample: BsdfSample| match sample.density {
            Probability::Pdf(pdf) => Sample::with_pdf(sample.wi, pdf),
            Probability::Unknown => Sample::new(sample.wi),
            Probability::Delta(_) => Sample::atom(sample.wi),
        };
        out.extend(self.0.sample(u)?.into_iter().map(|sample| sample.map(of)));
        Ok(())
    }
}

impl Density for Scattering<'_> {
    fn pdf(&self, points: &[Point], out: &mut Vec<f64>) -> Result<()> {
        out.extend(self.0.bsdf.pdf(&self.0.pairs(&directions(points)))?);
        Ok(())
    }

    /// 1 minus the probability of "no sample", which is not declared.
    fn mass(&self) -> Mass {
        Mass::AtMostOne
    }

    fn atoms(&self) -> Vec<Atom> {
        self.0.deltas.iter().map(|lobe| Atom::new(lobe.wi, lobe.probability)).collect()
    }
}

/// Counts samples in cells, at delta lobes, and "no sample"; see [`examine`]. The integral of the pdf is tested with them, and
/// the pdf that each sample carries.
pub fn check(subject: &Subject) -> Result<Option<Outcome>> {
    if subject.properties.pdf != PdfKind::Exact {
        return Ok(None);
    }
    let scattering = Scattering(subject);
    examine(&sphere(), &scattering, &scattering, subject.protocol, subject.round).map(Some)
}
