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
use super::examples::{ALPHA, ETA, Example, Family, K, gold, grey};
use super::rough_conductor::{ByVisibleNormals, NormalSampling, RoughConductor};
use super::{Bsdf, BsdfSample, ConductorFresnel, Lobe, Scatter, Vectorizable, VectorizedLoop};
use crate::math::{Rgb, circular::Circular};
use crate::optics::microfacet::{Beckmann, Ggx};
use crate::sampling::normals::SampleNormals;
use etalon_stats::bsdf::Energy;
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
    pub fn new(single: RoughConductor<D>, energy: MissingEnergy) -> Self {
        let colour = energy.colour(&single.fresnel);
        // At 60 degrees a metal reflects about as much as on average.
        let power = [colour.max_element(), single.fresnel.reflectance(0.5).max_element()];
        Self { single, multiple: Multiple { colour, power }, energy: Arc::new(energy) }
    }

    /// Single scattering alone.
    pub fn single(&self) -> &RoughConductor<D> {
        &self.single
    }

    /// Whether the distribution has equal widths.
    fn is_isotropic(&self) -> bool {
        self.energy.is_isotropic()
    }

    /// The model with its sampling fixed, for loops.
    #[inline]
    fn lanes<const BOUNDED: bool, const ISOTROPIC: bool>(&self) -> CompensatedLanes<'_, D, BOUNDED, ISOTROPIC> {
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
pub(super) fn cosine_direction(u: [f32; 2]) -> Vec3 {
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
    fn vectorize(&self, work: impl VectorizedLoop) -> bool {
        if self.single.normals != NormalSampling::Vndf {
            return false;
        }
        if self.is_isotropic() {
            work.over(self.lanes::<false, true>());
        } else {
            work.over(self.lanes::<false, false>());
        }
        true
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

pub(super) const BECKMANN: &[Family] =
    &[family("compensated-beckmann", |v| beckmann(v[0], grey(v[1], v[2])), |family| examples(family, beckmann))];

pub(super) const GGX: &[Family] =
    &[family("compensated-ggx", |v| ggx(v[0], grey(v[1], v[2])), |family| examples(family, ggx))];

const fn family(name: &'static str, bsdf: fn(&[f32]) -> Bsdf, examples: fn(&Family) -> Vec<Example>) -> Family {
    Family { name, parameters: &[ALPHA, ETA, K], energy: Energy::AtMostOne, bsdf, examples }
}

fn beckmann(alpha: f32, fresnel: ConductorFresnel) -> Bsdf {
    let single = RoughConductor { distribution: Beckmann::new(alpha), fresnel, normals: NormalSampling::Vndf };
    let energy = MissingEnergy::new(Beckmann::new(f64::from(alpha)));
    Bsdf::CompensatedBeckmann(CompensatedConductor::new(single, energy))
}

fn ggx(alpha: f32, fresnel: ConductorFresnel) -> Bsdf {
    let single = RoughConductor { distribution: Ggx::new(alpha), fresnel, normals: NormalSampling::Vndf };
    let energy = MissingEnergy::new(Ggx::new(f64::from(alpha)));
    Bsdf::CompensatedGgx(CompensatedConductor::new(single, energy))
}

/// Gold, and a lossless metal, which reflects all light but 10⁻⁸, and with multiple scattering all of it to the error of its table.
fn examples(family: &Family, metal: fn(f32, ConductorFresnel) -> Bsdf) -> Vec<Example> {
    let pair = |alpha| {
        let name = format!("{}/{alpha}", family.name);
        let lossless = Example::new(format!("{name}/lossless"), move || metal(alpha, grey(1.0, 2e4)));
        let gold = Example::new(name, move || metal(alpha, gold()));
        [Example { is_integrated: false, ..gold }, Example { energy: Energy::Conserved(1e-3), ..lossless }]
    };
    [0.01, 0.3, 1.0].map(pair).into_iter().flatten().collect()
}
