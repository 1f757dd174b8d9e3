//! What is tested: samplers, the code under test, with their samples; and densities, the pdf that samples are tested against.

use crate::domain::Point;
use crate::error::{Error, Result};
use crate::mistakes::{Mistake, Variable};

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
    /// What the sample counts: 1, or the weight that it carries, an estimate of 1/pdf, where the density is a [`target`].
    pub weight: f64,
}

impl Sample {
    /// A sample without a pdf.
    pub fn new(point: impl Into<Point>) -> Self {
        Self { point: point.into(), pdf: None, atom: false, weight: 1.0 }
    }

    /// A sample that carries its pdf.
    pub fn with_pdf(point: impl Into<Point>, pdf: f64) -> Self {
        Self { pdf: Some(pdf), ..Self::new(point) }
    }

    /// A sample that carries a weight: of resampling or of a reservoir.
    pub fn with_weight(point: impl Into<Point>, weight: f64) -> Self {
        Self { weight, ..Self::new(point) }
    }

    /// A sample at an atom.
    pub fn atom(point: impl Into<Point>) -> Self {
        Self { atom: true, ..Self::new(point) }
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

/// What a density, its atoms included, is declared to integrate to. 1 minus this is the probability of "no sample".
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mass {
    /// This value; a density that integrates to another one is rejected.
    Exactly(f64),
    /// An unknown value of at most 1: the integral then gives the probability of "no sample".
    AtMostOne,
    /// An unknown value: only the shape of the density is tested, and "no sample" is left out.
    Unknown,
}

/// A point that is sampled with a probability of its own: a Dirac delta of the distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Atom {
    /// Where it lies.
    pub point: Point,
    /// The probability of this very point.
    pub probability: f64,
}

impl Atom {
    /// The atom at `point`.
    #[must_use]
    pub fn new(point: impl Into<Point>, probability: f64) -> Self {
        Self { point: point.into(), probability }
    }
}

/// What the roundings of two computations in single precision may differ by: 64 units of the last place.
pub const SINGLE_PRECISION: f64 = 64.0 * f32::EPSILON as f64;

/// A pdf over a domain, with respect to the domain's measure, plus atoms.
pub trait Density: Sync {
    /// Appends the pdf at each of `points`.
    ///
    /// # Errors
    /// [`Error::External`](crate::Error::External) where the pdf is computed in another process.
    fn pdf(&self, points: &[Point], out: &mut Vec<f64>) -> Result<()>;

    /// What it integrates to, atoms included.
    fn mass(&self) -> Mass {
        Mass::Exactly(1.0)
    }

    /// Its atoms.
    fn atoms(&self) -> Vec<Atom> {
        Vec::new()
    }

    /// The names of its atoms.
    fn atom_names(&self) -> Vec<String> {
        (0..self.atoms().len()).map(|atom| format!("atom {atom}")).collect()
    }

    /// The relative difference that the pdf carried by a sample may have from the one asked for: 0, to the last bit, unless more is
    /// declared, such as [`SINGLE_PRECISION`].
    fn precision(&self) -> f64 {
        0.0
    }

    /// Whether this is no pdf: samples then carry weights, and the mean of the weights of the samples in any set is to be its integral
    /// over that set. Atoms have this mean in place of a probability.
    fn is_target(&self) -> bool {
        false
    }

    /// Whether values are random, with the pdf as their mean, be it for equal points or for points nearby.
    fn is_stochastic(&self) -> bool {
        false
    }

    /// Rectangles of the domain's chart, \[from, to\] along each axis, in which the pdf is narrow: there it is integrated by smaller
    /// steps. A point is a rectangle without a size.
    fn narrow(&self) -> Vec<[[f64; 2]; 2]> {
        Vec::new()
    }

    /// For a pdf that is piecewise constant in the domain's chart: the lines between the pieces, ascending and strictly
    /// between 0 and 1, for each axis. Its integrals are then exact sums.
    fn steps(&self) -> Option<[Vec<f64>; 2]> {
        None
    }

    /// Quantities of points by whose powers pdfs of this kind differ, beside those of the domain.
    fn variables(&self) -> Vec<Variable<'_>> {
        Vec::new()
    }

    /// Usual mistakes of samplers of such a pdf, which are tried where samples do not follow it.
    fn mistakes(&self) -> Vec<Mistake<'_>> {
        Vec::new()
    }
}

/// A [`Density`] made of a function; see [`density`].
pub struct DensityFn<F> {
    pdf: F,
    mass: Mass,
    atoms: Vec<Atom>,
    steps: Option<[Vec<f64>; 2]>,
    precision: f64,
    is_target: bool,
    is_stochastic: bool,
    narrow: Vec<[[f64; 2]; 2]>,
}

/// The density that `pdf` returns: of mass 1, without atoms, not piecewise constant.
pub fn density<P: From<Point>>(pdf: impl Fn(P) -> f64 + Sync) -> DensityFn<impl Fn(Point) -> f64 + Sync> {
    DensityFn {
        pdf: move |point: Point| pdf(point.into()),
        mass: Mass::Exactly(1.0),
        atoms: Vec::new(),
        steps: None,
        precision: 0.0,
        is_target: false,
        is_stochastic: false,
        narrow: Vec::new(),
    }
}

/// What samples with weights are tested against, in place of a pdf: their weights estimate 1/pdf if `of` is 1, or `of`/pdf. It is 0
/// where there are no samples.
pub fn target<P: From<Point>>(of: impl Fn(P) -> f64 + Sync) -> DensityFn<impl Fn(Point) -> f64 + Sync> {
    DensityFn { is_target: true, ..density(of) }
}

impl<F> DensityFn<F> {
    /// Declares another mass than 1.
    #[must_use]
    pub fn with_mass(self, mass: Mass) -> Self {
        Self { mass, ..self }
    }

    /// Adds atoms.
    #[must_use]
    pub fn with_atoms(self, atoms: Vec<Atom>) -> Self {
        Self { atoms, ..self }
    }

    /// Declares the precision of the pdfs that samples carry; see [`Density::precision`].
    #[must_use]
    pub fn with_precision(self, precision: f64) -> Self {
        Self { precision, ..self }
    }

    /// Declares that values are random, with the pdf as their mean; see [`Density::is_stochastic`].
    #[must_use]
    pub fn stochastic(self) -> Self {
        Self { is_stochastic: true, ..self }
    }

    /// Declares where the pdf is narrow; see [`Density::narrow`].
    #[must_use]
    pub fn with_narrow(self, narrow: Vec<[[f64; 2]; 2]>) -> Self {
        Self { narrow, ..self }
    }

    /// Declares the lines of the chart between which the pdf is constant; see [`Density::steps`].
    #[must_use]
    pub fn with_steps(self, steps: [Vec<f64>; 2]) -> Self {
        Self { steps: Some(steps), ..self }
    }
}

impl<F: Fn(Point) -> f64 + Sync> Density for DensityFn<F> {
    fn pdf(&self, points: &[Point], out: &mut Vec<f64>) -> Result<()> {
        out.extend(points.iter().map(|&point| (self.pdf)(point)));
        Ok(())
    }

    fn mass(&self) -> Mass {
        self.mass
    }

    fn atoms(&self) -> Vec<Atom> {
        self.atoms.clone()
    }

    fn steps(&self) -> Option<[Vec<f64>; 2]> {
        self.steps.clone()
    }

    fn precision(&self) -> f64 {
        self.precision
    }

    fn is_target(&self) -> bool {
        self.is_target
    }

    fn is_stochastic(&self) -> bool {
        self.is_stochastic
    }

    fn narrow(&self) -> Vec<[[f64; 2]; 2]> {
        self.narrow.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Line, Protocol, Sample, Verdict, validate};

    #[test]
    fn carried_pdfs_may_have_a_declared_precision() {
        // The pdf that samples carry is rounded to single precision, or wrong by 1e-4.
        let verdict = |carried: fn(f64) -> f64, precision: f64| {
            let pdf = |x: f64| 2.0 * x + 1e-3 * (1.0 - 2.0 * x);
            let draw = move |u: &[f64]| {
                let x = ((0.001f64).powi(2) + 4.0 * 0.999 * u[0]).sqrt();
                let x = ((x - 0.001) / (2.0 * 0.999)).clamp(0.0, 1.0);
                Some(Sample { pdf: Some(carried(pdf(x))), ..Sample::new(x) })
            };
            let outcome =
                validate(&Line::UNIT, &sampler(1, draw), &density(pdf).with_precision(precision), &Protocol::default());
            let outcome = outcome.unwrap();
            (outcome.verdict, outcome.violation.unwrap_or_default())
        };
        let single = |pdf: f64| f64::from(pdf as f32);
        let (exact, why) = verdict(single, 0.0);
        assert!(exact == Verdict::Reject && why.contains("precision=single"), "{why}");
        assert_eq!(verdict(single, SINGLE_PRECISION).0, Verdict::Accept, "{}", verdict(single, SINGLE_PRECISION).1);
        let (wrong, why) = verdict(|pdf| pdf * 1.0001, SINGLE_PRECISION);
        assert!(wrong == Verdict::Reject && !why.contains("precision=single"), "{why}");
        assert_eq!(verdict(|pdf| pdf * 1.0001, 1e-3).0, Verdict::Accept);
    }
}
