//! Samplers, the code under test, and their samples.

use crate::error::{Error, Result};
use crate::point::Point;

/// A sample as its sampler returns it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Where it lies in the domain.
    pub point: Point,
    /// The pdf that the sampler returns with the sample, if it does. It must equal what the density returns for `point`,
    /// to the last bit.
    pub pdf: Option<f64>,
    /// Whether the point is an atom of the distribution (the one direction of a mirror): the sample is then counted at the
    /// density's [`Atom`](crate::Atom)s.
    pub atom: bool,
}

impl Sample {
    /// A sample without a pdf.
    pub fn new(point: impl Into<Point>) -> Self {
        Self { point: point.into(), pdf: None, atom: false }
    }

    /// A sample that carries its pdf.
    pub fn with_pdf(point: impl Into<Point>, pdf: f64) -> Self {
        Self { point: point.into(), pdf: Some(pdf), atom: false }
    }

    /// A sample at an atom.
    pub fn atom(point: impl Into<Point>) -> Self {
        Self { point: point.into(), pdf: None, atom: true }
    }
}

/// Maps uniform random numbers to points of a domain.
pub trait Sampler: Sync {
    /// Uniform random numbers per sample; 0 for a sampler with a generator of its own, which
    /// [`sample_seeded`](Self::sample_seeded) then calls.
    fn dimension(&self) -> usize;

    /// Appends one entry to `out` for every [`dimension`](Self::dimension) random numbers of `u`, which are in \[0, 1).
    /// `None` means "no sample", which is counted as an outcome of its own.
    ///
    /// # Errors
    /// [`Error::External`] where sampling itself can fail: in another process.
    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample>>) -> Result<()>;

    /// Appends `count` entries to `out`, from the sampler's own generator started with `seed`: equal seeds give equal
    /// samples. Each batch of a test has a seed of its own.
    ///
    /// # Errors
    /// [`Error::External`] as in [`sample`](Self::sample); [`Error::Parameter`] unless implemented.
    fn sample_seeded(&self, _count: usize, _seed: u32, _out: &mut Vec<Option<Sample>>) -> Result<()> {
        let message = "a sampler without uniform random numbers has to implement sample_seeded".to_owned();
        Err(Error::Parameter { name: "dimension", message, hint: None })
    }

    /// The number of samples left, of a sampler that has finitely many: a file. The test then uses each of them once,
    /// independent of the protocol, and the random numbers have no meaning.
    fn finite_len(&self) -> Option<u64> {
        None
    }

    /// The random numbers that [`sample`](Self::sample) maps to `point`, if the sampler has an inverse.
    ///
    /// # Errors
    /// [`Error::External`] as in [`sample`](Self::sample).
    fn invert(&self, _point: Point) -> Result<Option<Vec<f64>>> {
        Ok(None)
    }
}

/// A [`Sampler`] made of a function; see [`sampler`].
pub struct SamplerFn<F, I> {
    dimension: usize,
    sample: F,
    inverse: I,
}

/// The absence of an inverse.
pub type NoInverse = fn(Point) -> Option<Vec<f64>>;

/// The sampler whose `sample` maps `dimension` uniform random numbers to one sample.
pub fn sampler<F>(dimension: usize, sample: F) -> SamplerFn<F, NoInverse>
where
    F: Fn(&[f64]) -> Option<Sample> + Sync,
{
    SamplerFn { dimension, sample, inverse: |_| None }
}

impl<F, I> SamplerFn<F, I> {
    /// Adds the inverse: the random numbers that are mapped to a point. It is then tested too.
    pub fn with_inverse<P, J>(self, invert: J) -> SamplerFn<F, impl Fn(Point) -> Option<Vec<f64>> + Sync>
    where
        P: From<Point>,
        J: Fn(P) -> Vec<f64> + Sync,
    {
        SamplerFn {
            dimension: self.dimension,
            sample: self.sample,
            inverse: move |point: Point| Some(invert(point.into())),
        }
    }
}

impl<F, I> Sampler for SamplerFn<F, I>
where
    F: Fn(&[f64]) -> Option<Sample> + Sync,
    I: Fn(Point) -> Option<Vec<f64>> + Sync,
{
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn sample(&self, u: &[f64], out: &mut Vec<Option<Sample>>) -> Result<()> {
        out.extend(u.chunks_exact(self.dimension).map(&self.sample));
        Ok(())
    }

    fn invert(&self, point: Point) -> Result<Option<Vec<f64>>> {
        Ok((self.inverse)(point))
    }
}
