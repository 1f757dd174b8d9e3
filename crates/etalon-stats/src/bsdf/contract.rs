//! The contract of a BSDF under test: what it evaluates and samples, and what it declares of itself; in batches that may fail,
//! which a program at the other end of a pipe can implement; and families, BSDFs of one kind over their parameters.

use crate::error::Result;
use crate::extremes::Extremes;

/// A unit vector in the local frame, the normal at +z, that points away from the surface.
pub type Direction = [f64; 3];

/// A value per channel; of a BSDF with one channel the first counts.
pub type Spectrum = [f64; 3];

/// How probable a sample is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Density {
    /// Its pdf per solid angle over all lobes: what [`Bsdf::pdf`] returns.
    Pdf(f64),
    /// A pdf exists, but the BSDF does not know it.
    Unknown,
    /// The sample is the direction of a delta lobe, which has this probability.
    Delta(f64),
}

/// A direction that a BSDF samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BsdfSample {
    /// Where light comes from.
    pub wi: Direction,
    /// f |cos θᵢ| / pdf, or what a delta lobe does to radiance over its probability.
    pub weight: Spectrum,
    /// How probable it is.
    pub density: Density,
    /// The number of its lobe.
    pub lobe: usize,
    /// The probability of choosing this lobe, given the two random numbers of [`Properties::map`].
    pub lobe_probability: f64,
    /// The sampled point of a light, if it is known.
    pub point: Option<[f64; 3]>,
}

impl BsdfSample {
    /// A sample of the only lobe of a BSDF.
    #[must_use]
    pub fn new(wi: Direction, weight: Spectrum, density: Density) -> Self {
        Self { wi, weight, density, lobe: 0, lobe_probability: 1.0, point: None }
    }

    /// The same sample of one lobe of several.
    #[must_use]
    pub fn of_lobe(self, lobe: usize, lobe_probability: f64) -> Self {
        Self { lobe, lobe_probability, ..self }
    }

    /// Whether its lobe is a delta distribution.
    #[must_use]
    pub fn is_delta(&self) -> bool {
        matches!(self.density, Density::Delta(_))
    }
}

/// A delta lobe: perfect specular reflection or transmission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeltaLobe {
    /// The direction.
    pub wi: Direction,
    /// The probability that it is sampled.
    pub probability: f64,
    /// The factor of the radiance from there.
    pub throughput: Spectrum,
}

/// Whether η² f(wo, wi) = f(wi, wo), η the index of refraction on the side of `wi` over that on the side of `wo` (1 for reflection).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reciprocity {
    /// It is.
    Reciprocal,
    /// It is not, for this reason.
    Not(&'static str),
}

/// How much of the incident power is scattered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Energy {
    /// All of it, within this error of the albedo.
    Conserved(f64),
    /// All of it at most.
    AtMostOne,
    /// Possibly more, for this reason.
    MayExceedOne(&'static str),
}

/// What the values of [`Bsdf::pdf`] are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PdfKind {
    /// The pdf of the samples.
    Exact,
    /// An approximation, which samples do not follow.
    Approximate,
    /// Nothing: there is no pdf.
    None,
}

/// A parameter of a configuration, with the range in which the BSDF is meant to work.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// The range.
    pub range: [f64; 2],
}

impl Parameter {
    /// A parameter of this name.
    #[must_use]
    pub fn new(name: impl Into<String>, value: f64, range: [f64; 2]) -> Self {
        Self { name: name.into(), value, range }
    }

    /// Whether its values are compared by their ratios: where the range spans more than a factor of ten.
    #[must_use]
    pub fn is_logarithmic(&self) -> bool {
        let [from, to] = self.range;
        from > 0.0 && to > 10.0 * from
    }

    /// The value at a share of the range from 0 to 1, in equal factors or in equal steps.
    #[must_use]
    pub fn at(&self, share: f64) -> f64 {
        let [from, to] = self.range;
        let value = if self.is_logarithmic() { from * (to / from).powf(share) } else { from + (to - from) * share };
        value.within(from, to)
    }
}

/// What directions are sampled for.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// A BSDF: the integral of f |cos θᵢ| is its albedo.
    Surface,
    /// A phase function: [`Bsdf::eval`] is its value, which integrates to 1 over the sphere. `wi` points away from the place of scattering.
    Phase {
        /// Whether `wo` points away from there, too, so that light is scattered forward where `wi` is -`wo` (pbrt, Mitsuba); otherwise it is
        /// the direction in which the light travels.
        wo_points_away: bool,
        /// The mean cosine of the angle between light before and after, where it is declared.
        mean_cosine: Option<f64>,
    },
    /// A light: the place of a [reference point](Direction) is that of `wo`, and [`Bsdf::eval`] is the radiance from `wi`.
    Light {
        /// Whether [`Bsdf::hit`] tells where a ray meets the light.
        hits: bool,
        /// Whether it emits to the side alone to which its normals point.
        one_sided: bool,
        /// Reference points; if there are none, they are chosen near the light and far from it, on all sides.
        points: Vec<[f64; 3]>,
    },
}

impl Kind {
    /// The factor of values in integrals over solid angle.
    #[must_use]
    pub fn cos(&self, wi: Direction) -> f64 {
        if *self == Self::Surface { wi[2].abs() } else { 1.0 }
    }

    /// Values times that factor, in messages.
    #[must_use]
    pub fn integrand(&self) -> &'static str {
        match self {
            Self::Surface => "f |cos θi|",
            Self::Phase { .. } => "the value",
            Self::Light { .. } => "the radiance",
        }
    }

    /// The relative error of the pdf that a test detects unless another is asked for. The pdf of a light ends at edges, where
    /// integrals take long.
    #[must_use]
    pub fn detectable_error(&self) -> f64 {
        match self {
            Self::Surface => 0.02,
            Self::Phase { .. } => 0.05,
            Self::Light { .. } => 0.09,
        }
    }
}

/// Where a ray from a reference point meets a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// How far away.
    pub distance: f64,
    /// The unit normal there.
    pub normal: [f64; 3],
    /// The pdf of the point per area, if it is known.
    pub pdf_area: Option<f64>,
}

/// What a BSDF declares of itself. [`Properties::default`] is an opaque surface without delta lobes, in f64.
#[derive(Debug, Clone, PartialEq)]
pub struct Properties {
    /// Whether it is a BSDF, a phase function or a light.
    pub kind: Kind,
    /// 1 or 3.
    pub channels: usize,
    /// Whether light is reflected.
    pub reflection: bool,
    /// Whether light is transmitted.
    pub transmission: bool,
    /// Whether there are delta lobes; [`Bsdf::delta_lobes`] lists them.
    pub delta: bool,
    /// The index of refraction below the surface (z < 0) over that above it.
    pub eta: f64,
    /// Whether it is reciprocal.
    pub reciprocity: Reciprocity,
    /// Whether it conserves energy.
    pub energy: Energy,
    /// What its pdf is.
    pub pdf: PdfKind,
    /// Random numbers for one sample.
    pub dimension: usize,
    /// The two of them that a lobe maps to directions one to one, if there are any. Of the others the first chooses the lobe:
    /// each has an interval of it.
    pub map: Option<[usize; 2]>,
    /// Whether its lobes are so narrow that its arithmetic does not resolve how directions change with random numbers.
    pub narrow: bool,
    /// Random numbers for one value; 0 for a deterministic BSDF.
    pub eval_dimension: usize,
    /// A bound of the weights of samples times η² in the mean over the lobes that the same two numbers of [`map`](Self::map)
    /// may be mapped by, if one is known from theory.
    pub largest_weight: Option<f64>,
    /// Machine epsilon of its arithmetic: `f64::EPSILON` or `f32::EPSILON`.
    pub precision: f64,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
}

impl Default for Properties {
    fn default() -> Self {
        Self {
            kind: Kind::Surface,
            channels: 1,
            reflection: true,
            transmission: false,
            delta: false,
            eta: 1.0,
            reciprocity: Reciprocity::Reciprocal,
            energy: Energy::AtMostOne,
            pdf: PdfKind::Exact,
            dimension: 3,
            map: Some([1, 2]),
            narrow: false,
            eval_dimension: 0,
            largest_weight: None,
            precision: f64::EPSILON,
            parameters: Vec::new(),
        }
    }
}

impl Properties {
    /// Those of a phase function for which both directions point away and no mean cosine is declared.
    #[must_use]
    pub fn phase() -> Self {
        let kind = Kind::Phase { wo_points_away: true, mean_cosine: None };
        Self { kind, transmission: true, energy: Energy::Conserved(0.0), dimension: 2, map: None, ..Self::default() }
    }

    /// Those of a light of which no ray is asked.
    #[must_use]
    pub fn light() -> Self {
        let kind = Kind::Light { hits: false, one_sided: false, points: Vec::new() };
        let (energy, reciprocity) = (Energy::MayExceedOne("it emits"), Reciprocity::Not("it is a light"));
        Self { kind, transmission: true, energy, reciprocity, dimension: 2, map: None, ..Self::default() }
    }
}

/// A BSDF under test, or what is tested like one: see [`Kind`]. Light is radiance, which refraction divides by the square of the relative index.
pub trait Bsdf: Sync {
    /// What it declares of itself.
    fn properties(&self) -> Properties;

    /// f(wo, wi) without the cosine, of all lobes but delta lobes. A stochastic BSDF takes
    /// [`eval_dimension`](Properties::eval_dimension) uniform random numbers from `u`, the first of which may seed a generator,
    /// and returns a value whose mean is f.
    fn eval(&self, wo: Direction, wi: Direction, u: &[f64]) -> Spectrum;

    /// Pdf of [`sample`](Self::sample) at `wi` per solid angle, delta lobes left out.
    fn pdf(&self, wo: Direction, wi: Direction) -> f64;

    /// Samples a direction by [`dimension`](Properties::dimension) uniform random numbers; `None` if no light is scattered.
    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample>;

    /// The delta lobes for `wo`.
    fn delta_lobes(&self, _wo: Direction) -> Vec<DeltaLobe> {
        Vec::new()
    }

    /// The number of lobes between which [`sample`](Self::sample) chooses.
    fn lobes(&self) -> usize {
        1
    }

    /// The probability of a lobe times its pdf at `wi`; `None` if it is not known.
    fn lobe_pdf(&self, wo: Direction, wi: Direction, _lobe: usize) -> Option<f64> {
        (self.lobes() == 1).then(|| self.pdf(wo, wi))
    }

    /// [`eval`](Self::eval) for importance, of a path that starts at a light; `None` if there is no such function.
    fn eval_adjoint(&self, _wo: Direction, _wi: Direction) -> Option<Spectrum> {
        None
    }

    /// [`sample`](Self::sample) for importance, by the same random numbers; `None` if there is no such function.
    fn sample_adjoint(&self, _wo: Direction, _u: &[f64]) -> Option<Option<BsdfSample>> {
        None
    }

    /// The share of power that is scattered to `wo`, if it is known.
    fn albedo(&self, _wo: Direction) -> Option<Spectrum> {
        None
    }

    /// Where the ray from the reference point `wo` in direction `wi` meets a light; `None` if it does not.
    fn hit(&self, _wo: Direction, _wi: Direction) -> Option<Hit> {
        None
    }
}

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

    /// Where rays meet a light.
    fn hits(&self, pairs: &[Pair]) -> Result<Vec<Option<Hit>>> {
        Ok(vec![None; pairs.len()])
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

    fn hits(&self, pairs: &[Pair]) -> Result<Vec<Option<Hit>>> {
        Ok(pairs.iter().map(|[wo, wi]| Bsdf::hit(self, *wo, *wi)).collect())
    }
}

/// The random numbers of entry `i` of `count`.
fn entry(u: &[f64], i: usize, count: usize) -> &[f64] {
    let each = u.len() / count;
    &u[i * each..(i + 1) * each]
}

/// BSDFs of one kind over their parameters: what sweeps and furnace tests visit.
pub trait Family: Sync {
    /// Its name.
    fn name(&self) -> &str;

    /// Its parameters with their ranges and default values.
    fn parameters(&self) -> Vec<Parameter>;

    /// Whether BSDFs with different parameters should be used one after the other: they share a state, and changing it takes time.
    fn is_sequential(&self) -> bool {
        false
    }

    /// The BSDF whose parameters have these values, in the order of [`parameters`](Self::parameters).
    ///
    /// # Errors
    /// [`Error::External`](crate::Error::External) from a BSDF that another program makes.
    fn with(&self, values: &[f64]) -> Result<Box<dyn BatchBsdf + '_>>;
}
