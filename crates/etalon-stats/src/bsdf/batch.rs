//! The contract of a BSDF in batches that may fail: what a program at the other end of a pipe can implement.

use super::contract::{Bsdf, BsdfSample, DeltaLobe, Direction, Properties, Spectrum};
use crate::error::Result;

/// The directions `wo` and `wi` of one value.
pub type Pair = [Direction; 2];

/// A BSDF that is asked for many values at a time and may fail. Every [`Bsdf`] is one.
///
/// Each method returns one entry for each direction or pair that it is given, and means what the method of the same name of
/// [`Bsdf`] means. `u` holds the random numbers of all entries, one after the other.
///
/// Errors are [`Error::External`](crate::Error::External) from a BSDF that another program evaluates.
#[expect(clippy::missing_errors_doc, reason = "they are the same for all methods")]
pub trait BatchBsdf: Sync {
    /// What it declares of itself.
    fn properties(&self) -> Properties;

    /// f(wo, wi) without the cosine.
    fn eval(&self, pairs: &[Pair], u: &[f64]) -> Result<Vec<Spectrum>>;

    /// Pdfs of samples, delta lobes left out.
    fn pdf(&self, pairs: &[Pair]) -> Result<Vec<f64>>;

    /// One sample for each `wo`.
    fn sample(&self, wos: &[Direction], u: &[f64]) -> Result<Vec<Option<BsdfSample>>>;

    /// The delta lobes for each `wo`.
    fn delta_lobes(&self, wos: &[Direction]) -> Result<Vec<Vec<DeltaLobe>>> {
        Ok(vec![Vec::new(); wos.len()])
    }

    /// The number of lobes.
    fn lobes(&self) -> usize {
        1
    }

    /// The probability of a lobe times its pdf, for one of `lobes` at each pair.
    fn lobe_pdf(&self, pairs: &[Pair], _lobes: &[usize]) -> Result<Vec<Option<f64>>> {
        match self.lobes() {
            1 => Ok(self.pdf(pairs)?.into_iter().map(Some).collect()),
            _ => Ok(vec![None; pairs.len()]),
        }
    }

    /// Values for importance.
    fn eval_adjoint(&self, pairs: &[Pair]) -> Result<Vec<Option<Spectrum>>> {
        Ok(vec![None; pairs.len()])
    }

    /// Samples for importance.
    fn sample_adjoint(&self, wos: &[Direction], _u: &[f64]) -> Result<Vec<Option<Option<BsdfSample>>>> {
        Ok(vec![None; wos.len()])
    }

    /// Known shares of power that are scattered to each `wo`.
    fn albedo(&self, wos: &[Direction]) -> Result<Vec<Option<Spectrum>>> {
        Ok(vec![None; wos.len()])
    }
}

impl<B: Bsdf> BatchBsdf for B {
    fn properties(&self) -> Properties {
        Bsdf::properties(self)
    }

    fn eval(&self, pairs: &[Pair], u: &[f64]) -> Result<Vec<Spectrum>> {
        let values = pairs.iter().enumerate();
        Ok(values.map(|(i, [wo, wi])| Bsdf::eval(self, *wo, *wi, entry(u, i, pairs.len()))).collect())
    }

    fn pdf(&self, pairs: &[Pair]) -> Result<Vec<f64>> {
        Ok(pairs.iter().map(|[wo, wi]| Bsdf::pdf(self, *wo, *wi)).collect())
    }

    fn sample(&self, wos: &[Direction], u: &[f64]) -> Result<Vec<Option<BsdfSample>>> {
        let samples = wos.iter().enumerate();
        Ok(samples.map(|(i, wo)| Bsdf::sample(self, *wo, entry(u, i, wos.len()))).collect())
    }

    fn delta_lobes(&self, wos: &[Direction]) -> Result<Vec<Vec<DeltaLobe>>> {
        Ok(wos.iter().map(|wo| Bsdf::delta_lobes(self, *wo)).collect())
    }

    fn lobes(&self) -> usize {
        Bsdf::lobes(self)
    }

    fn lobe_pdf(&self, pairs: &[Pair], lobes: &[usize]) -> Result<Vec<Option<f64>>> {
        Ok(pairs.iter().zip(lobes).map(|([wo, wi], lobe)| Bsdf::lobe_pdf(self, *wo, *wi, *lobe)).collect())
    }

    fn eval_adjoint(&self, pairs: &[Pair]) -> Result<Vec<Option<Spectrum>>> {
        Ok(pairs.iter().map(|[wo, wi]| Bsdf::eval_adjoint(self, *wo, *wi)).collect())
    }

    fn sample_adjoint(&self, wos: &[Direction], u: &[f64]) -> Result<Vec<Option<Option<BsdfSample>>>> {
        let samples = wos.iter().enumerate();
        Ok(samples.map(|(i, wo)| Bsdf::sample_adjoint(self, *wo, entry(u, i, wos.len()))).collect())
    }

    fn albedo(&self, wos: &[Direction]) -> Result<Vec<Option<Spectrum>>> {
        Ok(wos.iter().map(|wo| Bsdf::albedo(self, *wo)).collect())
    }
}

/// The random numbers of entry `i` of `count`.
fn entry(u: &[f64], i: usize, count: usize) -> &[f64] {
    let each = u.len() / count;
    &u[i * each..(i + 1) * each]
}
