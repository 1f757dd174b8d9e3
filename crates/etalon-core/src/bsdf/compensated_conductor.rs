//! A rough conductor that also reflects the light which single scattering loses.
//!
//! Single-scattering microfacet models lose the light that meets a second facet: at α = 1 most of it for GGX, a third for
//! Beckmann, averaged over the cosine-weighted hemisphere. This model
//! adds a diffuse lobe that returns it, f = F_ms (1 − E(wo)) (1 − E(wi)) / (π (1 − Ē)), with the albedo E of single
//! scattering for F = 1, its mean Ē by the cosine, and the factor F_ms of coloured metals of [`MissingEnergy::colour`]. A
//! metal that reflects everything then reflects everything, to the error of the table, 10⁻³, or 2·10⁻³ if it is
//! anisotropic.
//!
//! This is the one of the models in use whose value is a closed form, deterministic and reciprocal, so that light tracing may
//! use it and tests can check it. Scaling the single scattering up instead (Turquin, "Practical Multiple Scattering
//! Compensation for Microfacet Models", 2019) is not reciprocal; random walks between the facets (Heitz et al., SIGGRAPH
//! 2016) have no value in closed form.
//!
//! Source: Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", SIGGRAPH 2017 course; Kelemen and
//! Szirmay-Kalos, "A Microfacet Based Coupled Specular-Matte BRDF Model with Importance Sampling", Eurographics 2001.

use super::energy::MissingEnergy;
use super::rough_conductor::{ByVisibleNormals, NormalSampling, RoughConductor};
use super::{BsdfSample, Lobe, Scatter, Vectorizable};
use crate::math::{Rgb, circular::Circular};
use crate::sampling::normals::SampleNormals;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

/// A rough metal with multiple scattering, visible from the side of the normal (z > 0).
#[derive(Debug, Clone, PartialEq)]
pub struct CompensatedConductor<D> {
    single: RoughConductor<D>,
    multiple: Multiple,
    /// The share that single scattering loses.
    energy: Arc<MissingEnergy>,
}

/// What multiple scattering leaves of the light, and how strong both kinds are.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Multiple {
    colour: Rgb,
    /// Power of the two for a direction that loses everything, and nothing.
    power: [f32; 2],
}

impl<D: SampleNormals<f32>> CompensatedConductor<D> {
    /// Adds multiple scattering to `single`; `energy` is the table of its distribution.
    #[must_use]
    pub fn new(single: RoughConductor<D>, energy: MissingEnergy) -> Self {
        let colour = energy.colour(&single.fresnel);
        // At 60 degrees a metal reflects about as much as on average.
        let power = [colour.max_element(), single.fresnel.reflectance(0.5).max_element()];
        Self { single, multiple: Multiple { colour, power }, energy: Arc::new(energy) }
    }

    /// How single scattering samples its directions.
    pub fn normals(&self) -> NormalSampling {
        self.single.normals
    }

    /// Whether the distribution has equal widths.
    pub fn is_isotropic(&self) -> bool {
        self.energy.is_isotropic()
    }

    /// The model with its sampling fixed, for loops.
    #[inline]
    pub fn lanes<const BOUNDED: bool, const ISOTROPIC: bool>(&self) -> CompensatedLanes<'_, D, BOUNDED, ISOTROPIC> {
        CompensatedLanes { single: ByVisibleNormals(self.single), multiple: self.multiple, energy: &self.energy }
    }
}

impl Multiple {
    /// The probability with which the lobe of multiple scattering is sampled, where single scattering loses that share.
    #[inline(always)]
    fn probability(&self, missing: f32) -> f32 {
        let [all, nothing] = self.power;
        let (multiple, single) = (missing * all, (1.0 - missing) * nothing);
        // A black metal has no power at all.
        if multiple > 0.0 { multiple / (multiple + single) } else { 0.0 }
    }
}

/// A compensated conductor as straight-line arithmetic.
#[derive(Clone, Copy)]
pub struct CompensatedLanes<'a, D, const BOUNDED: bool, const ISOTROPIC: bool> {
    single: ByVisibleNormals<D, BOUNDED>,
    multiple: Multiple,
    energy: &'a MissingEnergy,
}

/// Adds multiple scattering to f and the pdf of single scattering; `missing` are the lost shares of `wo` and `wi`.
#[inline(always)]
fn add_multiple(
    multiple: &Multiple,
    energy: &MissingEnergy,
    [missing_o, missing_i]: [f32; 2],
    cos_i: f32,
    (f, pdf): (Rgb, f32),
) -> (Rgb, f32) {
    let probability = multiple.probability(missing_o);
    (
        f + multiple.colour * energy.lobe(missing_o, missing_i),
        (1.0 - probability) * pdf + probability * (cos_i * FRAC_1_PI),
    )
}

/// A direction of the upper hemisphere with pdf cos θ / π.
#[inline(always)]
fn cosine_direction(u: [f32; 2]) -> Vec3 {
    let (sin_phi, cos_phi) = f32::sin_cos_turns(u[1]);
    let r = u[0].sqrt();
    Vec3::new(r * cos_phi, r * sin_phi, (1.0 - u[0]).sqrt())
}

impl<D: SampleNormals<f32>, const BOUNDED: bool, const ISOTROPIC: bool> Vectorizable
    for CompensatedLanes<'_, D, BOUNDED, ISOTROPIC>
{
    #[inline(always)]
    fn sample_lane(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> BsdfSample {
        // Choose single or multiple scattering, and sample a direction of it.
        let probability = self.multiple.probability(self.energy.missing::<ISOTROPIC>(wo));
        let again = uc < probability;
        let (single, diffuse) = (self.single.sample_lane(wo, uc, u), cosine_direction(u));
        let wi = if again { diffuse } else { single.wi };
        // Evaluate both at this direction.
        let (f, pdf) = self.eval_pdf_lane(wo, wi);
        let is_valid = (again | (single.pdf > 0.0)) & (wo.z > 0.0) & (wi.z > 0.0) & (pdf > 0.0);
        let (cos, divisor) = if is_valid { (wi.z, pdf) } else { (0.0, 1.0) };
        BsdfSample {
            wi,
            weight: f * cos / divisor,
            pdf: if is_valid { pdf } else { 0.0 },
            lobe: if again { Lobe::DiffuseReflection } else { Lobe::GlossyReflection },
            probability: if again { probability } else { 1.0 - probability },
            eta: 1.0,
        }
    }

    #[inline(always)]
    fn eval_pdf_lane(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let single = self.single.eval_pdf_lane(wo, wi);
        let missing = [self.energy.missing::<ISOTROPIC>(wo), self.energy.missing::<ISOTROPIC>(wi)];
        let (f, pdf) = add_multiple(&self.multiple, self.energy, missing, wi.z, single);
        let exists = (wo.z > 0.0) & (wi.z > 0.0);
        (f * if exists { 1.0 } else { 0.0 }, if exists { pdf } else { 0.0 })
    }
}

impl<D: SampleNormals<f32>> CompensatedConductor<D> {
    /// 1 − E.
    fn missing(&self, w: Vec3) -> f32 {
        if self.is_isotropic() { self.energy.missing::<true>(w) } else { self.energy.missing::<false>(w) }
    }
}

impl<D: SampleNormals<f32>> Scatter for CompensatedConductor<D> {
    fn lobes(&self) -> &[Lobe] {
        &[Lobe::GlossyReflection, Lobe::DiffuseReflection]
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let single = self.single.eval_pdf(wo, wi);
        add_multiple(&self.multiple, &self.energy, [self.missing(wo), self.missing(wi)], wi.z, single)
    }

    #[inline]
    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let probability = self.multiple.probability(self.missing(wo));
        let (wi, lobe, probability) = if uc < probability {
            (cosine_direction(u), Lobe::DiffuseReflection, probability)
        } else {
            (self.single.sample(wo, uc, u)?.wi, Lobe::GlossyReflection, 1.0 - probability)
        };
        let (f, pdf) = self.eval_pdf(wo, wi);
        let weight = f * wi.z / pdf;
        BsdfSample { wi, weight, pdf, lobe, probability, eta: 1.0 }.if_possible()
    }
}
