//! The contract of every BSDF: [`Scatter`], its samples, and the kinds of lobes.

use crate::math::Rgb;
use glam::Vec3;

/// A kind of lobe: the part of a BSDF that a sample comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lobe {
    /// Reflection in nearly all directions.
    DiffuseReflection,
    /// Transmission in nearly all directions.
    DiffuseTransmission,
    /// Reflection around the mirror direction.
    GlossyReflection,
    /// Transmission around the refracted direction.
    GlossyTransmission,
    /// Reflection in the mirror direction alone, a delta distribution.
    SpecularReflection,
    /// Transmission in the refracted direction alone, a delta distribution.
    SpecularTransmission,
}

impl Lobe {
    /// Whether it is a delta distribution: one direction, which no other strategy can sample.
    #[inline]
    pub const fn is_delta(self) -> bool {
        matches!(self, Self::SpecularReflection | Self::SpecularTransmission)
    }

    /// Whether light passes to the other side.
    #[inline]
    pub const fn is_transmission(self) -> bool {
        matches!(self, Self::DiffuseTransmission | Self::GlossyTransmission | Self::SpecularTransmission)
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BsdfSample {
    /// Unit direction in the local frame.
    pub wi: Vec3,
    /// f |cos θᵢ| / pdf: the factor of the radiance from `wi`.
    pub weight: Rgb,
    /// Pdf per solid angle, equal to [`Scatter::pdf`] to the last bit; 0 of delta lobes.
    pub pdf: f32,
    pub lobe: Lobe,
    /// The probability with which the lobe was chosen: of delta lobes [`Scatter::lobe_probability`]. `weight` is divided by it,
    /// and the pdf within the lobe has it as a factor in `pdf`.
    pub probability: f32,
    /// The index of refraction on the side of `wi` over that on the side of `wo`: 1 unless transmitted. Radiance changes by
    /// 1/η² across the interface.
    pub eta: f32,
}

impl BsdfSample {
    /// A sample of the only lobe, which reflects.
    #[inline(always)]
    pub fn reflected(wi: Vec3, weight: Rgb, pdf: f32, lobe: Lobe) -> Self {
        Self { wi, weight, pdf, lobe, probability: 1.0, eta: 1.0 }
    }

    /// The mirror direction, chosen with this probability.
    #[inline(always)]
    pub(super) fn specular_reflection(wi: Vec3, weight: Rgb, probability: f32) -> Self {
        Self { wi, weight, pdf: 0.0, lobe: Lobe::SpecularReflection, probability, eta: 1.0 }
    }

    /// The refracted direction, chosen with this probability.
    #[inline(always)]
    pub(super) fn specular_transmission(wi: Vec3, weight: Rgb, probability: f32, eta: f32) -> Self {
        Self { wi, weight, pdf: 0.0, lobe: Lobe::SpecularTransmission, probability, eta }
    }

    /// Whether the lobe is a delta distribution, which no other strategy can sample.
    #[inline]
    pub fn is_delta(&self) -> bool {
        self.lobe.is_delta()
    }

    /// The sample of the adjoint: see [`Scatter::sample_adjoint`].
    #[inline]
    #[must_use]
    pub fn adjoint(self) -> Self {
        Self { weight: self.weight * (self.eta * self.eta), ..self }
    }

    /// The sample of a BSDF without delta lobes, `None` where its pdf is 0.
    #[inline(always)]
    pub fn if_possible(self) -> Option<Self> {
        (self.pdf > 0.0).then_some(self)
    }
}

/// A BSDF without delta lobes as straight-line arithmetic, so that a loop over it vectorizes.
pub trait Vectorizable {
    /// [`Scatter::sample`]; where there is no sample the weight and the pdf are 0.
    fn sample_lane(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> BsdfSample;

    /// [`Scatter::eval_pdf`].
    fn eval_pdf_lane(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32);
}

/// A loop over a BSDF, compiled anew for each that is [`Vectorizable`].
pub trait VectorizedLoop {
    fn over(self, bsdf: impl Vectorizable);
}

/// How a surface scatters light. Default methods that do not follow from others are those of a BSDF with one delta lobe.
pub trait Scatter {
    fn lobes(&self) -> &[Lobe];

    /// Whether all lobes are delta distributions, so that light sampling contributes nothing.
    fn is_delta(&self) -> bool {
        self.lobes().iter().all(|lobe| lobe.is_delta())
    }

    /// Whether [`sample`](Self::sample) depends on `uc`.
    fn needs_choice(&self) -> bool {
        self.lobes().len() > 1
    }

    /// The BSDF f(wo, wi), without the cosine (1/sr); 0 for delta lobes and where nothing is scattered.
    #[inline]
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.eval_pdf(wo, wi).0
    }

    /// [`eval`](Self::eval) of the adjoint, f(wi, wo), for a path that starts at a light.
    #[inline]
    fn eval_adjoint(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.eval(wi, wo)
    }

    /// Pdf per solid angle of [`sample`](Self::sample) at `wi`; 0 for delta lobes. Its integral is 1 minus the probability
    /// of `None` and of delta lobes. The pdf of the reverse direction, of a path that arrives from `wi`, is `pdf(wi, wo)`.
    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.eval_pdf(wo, wi).1
    }

    /// [`eval`](Self::eval) and [`pdf`](Self::pdf) together, which costs little more than one of them.
    fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32);

    /// Samples a direction: `uc` in \[0, 1) chooses a lobe, `u` in \[0, 1)² a direction of that lobe. `None` is a sample
    /// that carries no light.
    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample>;

    /// The probability with which [`sample`](Self::sample) chooses a delta lobe for `wo`; 0 of other lobes.
    fn lobe_probability(&self, _wo: Vec3, lobe: Lobe) -> f32 {
        f32::from(u8::from(lobe.is_delta() && self.lobes().contains(&lobe)))
    }

    /// Whether f(wi, wo) = f(wo, wi), apart from refraction's η², so that paths may start at either end.
    fn is_reciprocal(&self) -> bool {
        true
    }

    /// A bound of the weights of samples other than of delta lobes, times η², in the mean over the lobes that `uc` chooses for the
    /// same `u`; `None` if none is known from theory.
    fn largest_weight(&self) -> Option<f32> {
        self.is_delta().then_some(0.0)
    }

    /// The BSDF with this albedo of its diffuse reflection, as a texture sets it; itself if it has none.
    fn with_albedo(&self, _albedo: Rgb) -> Self
    where
        Self: Clone,
    {
        self.clone()
    }

    /// Runs a loop over the BSDF as straight-line arithmetic, if it has that form; returns whether it has.
    fn vectorize(&self, _work: impl VectorizedLoop) -> bool {
        false
    }

    /// [`sample`](Self::sample) of the adjoint f(wi, wo), for a path that starts at a light, towards which `wo` points, and that
    /// transports importance; of a BSDF that [`is_reciprocal`](Self::is_reciprocal).
    ///
    /// The two differ in refraction alone: it changes radiance by 1/η² but not power. Source: Veach, "Robust Monte Carlo
    /// Methods for Light Transport Simulation", 1997, 5.2.
    #[inline]
    fn sample_adjoint(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        self.sample(wo, uc, u).map(BsdfSample::adjoint)
    }
}
