//! A rough conductor of microfacets, by Torrance and Sparrow's model: f = F D G₂ / (4 cos θₒ cos θᵢ).
//!
//! F is that at the angle between `wi` and the facet's normal; G₂ is Smith's for correlated heights. Source:
//! Torrance & Sparrow, "Theory for Off-Specular Reflection from Roughened Surfaces", 1967; in this normalization Walter et al.,
//! EGSR 2007, eq. 20; G₂: Heitz, JCGT 3(2), 2014.
//!
//! The facet's normal is always recomputed from the two directions, in `sample` as in `pdf`, so that both return the same
//! pdf to the last bit.

use super::examples::{ALPHA_X, ALPHA_Y, ALPHAS, ETA, Example, Family, K, grey};
use super::{Bsdf, BsdfSample, ConductorFresnel, Lobe, Scatter, Vectorizable, VectorizedLoop};
use crate::math::{Rgb, map_array};
use crate::optics::microfacet::{Beckmann, Ggx};
use crate::sampling::normals::SampleNormals;
use crate::sampling::warp;
use etalon_stats::bsdf::Energy;
use glam::Vec3;

/// How a rough conductor samples directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NormalSampling {
    /// By the distribution of normals visible from `wo` (VNDF): weights F G₂/G₁ ≤ 1.
    #[default]
    Vndf,
    /// By a part of the visible normals that leaves out those that reflect light into the surface, as far as that is known:
    /// for GGX. Other distributions are sampled by visible normals. Source: Eto & Tokuyoshi, SIGGRAPH Asia 2023.
    Bounded,
    /// By the full distribution of normals (NDF): the weights are unbounded at grazing angles.
    Ndf,
    /// Directions uniform over the hemisphere, which ignores the material.
    Hemisphere,
}

impl NormalSampling {
    pub const ALL: [Self; 4] = [Self::Vndf, Self::Bounded, Self::Ndf, Self::Hemisphere];

    /// Its name at the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vndf => "visible",
            Self::Bounded => "bounded",
            Self::Ndf => "all",
            Self::Hemisphere => "hemisphere",
        }
    }
}

/// A rough metal, visible from the side of the normal (z > 0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughConductor<D> {
    pub distribution: D,
    pub fresnel: ConductorFresnel,
    pub normals: NormalSampling,
}

/// Half vectors below this length, whose squares f32 does not resolve, belong to no facet: both directions are that near to the horizon.
pub(super) const LEAST_LENGTH: f32 = 1e-18;

/// The facet that reflects `wi` to `wo`.
#[derive(Clone, Copy)]
pub struct Facet {
    /// Its unit normal, the half vector of `wo` and `wi`.
    pub wm: [f32; 3],
    /// Cosine of either direction with its normal.
    pub cos: f32,
    /// Whether there is such a facet: both directions are above the surface, and not opposite along it to all digits.
    pub exists: bool,
}

impl Facet {
    /// The facet, if there is one.
    #[inline]
    pub fn between(wo: Vec3, wi: Vec3) -> Option<Self> {
        let facet = Self::of(wo, wi);
        facet.exists.then_some(facet)
    }

    /// The facet; its normal and cosine mean nothing where it does not exist.
    #[inline(always)]
    pub fn of(wo: Vec3, wi: Vec3) -> Self {
        // Half vector, with the rounding of both lengths removed from x and y.
        let (eo, ei) = (half_excess(wo), half_excess(wi));
        let sum = wo + wi;
        let sum = Vec3::new(sum.x - (eo * wo.x + ei * wi.x), sum.y - (eo * wo.y + ei * wi.y), sum.z);
        // |wo + wi| is twice the cosine: unlike wo·wm it is symmetric and never 0 by cancellation.
        let length = sum.length();
        let wm = sum / length;
        let exists = (wo.z > 0.0) & (wi.z > 0.0) & (length > LEAST_LENGTH);
        Self { wm: wm.to_array(), cos: (0.5 * length).min(1.0), exists }
    }
}

/// ½ (|w|² − 1) of a direction whose length is rounded.
///
/// At grazing angles x and y of the two directions nearly cancel, and the errors of their lengths would remain, which are as
/// large as the tilt of facets of a small α. z is small there, hence precise.
#[inline(always)]
fn half_excess(w: Vec3) -> f32 {
    let [x, y, z] = map_array(w.to_array(), f64::from);
    (0.5 * (x * x + y * y + z * z - 1.0)) as f32
}

/// `wo` reflected by a facet with normal `wm`, if that faces `wo` and the direction leaves the surface.
#[inline]
pub(super) fn reflect_at(wo: Vec3, wm: [f32; 3]) -> Option<Vec3> {
    let (wi, is_above) = reflect(wo, wm);
    is_above.then_some(wi)
}

/// `wo` reflected by a facet, and whether the facet faces `wo` and the direction is above the surface.
#[inline(always)]
fn reflect(wo: Vec3, wm: [f32; 3]) -> (Vec3, bool) {
    let wm = Vec3::from_array(wm);
    let cos = wo.dot(wm);
    let wi = (2.0 * cos * wm - wo).normalize();
    (wi, (cos > 0.0) & (wi.z > 0.0))
}

/// Pdf per solid angle of the uniform hemisphere.
const UNIFORM_PDF: f32 = warp::UNIFORM_HEMISPHERE_PDF as f32;

impl<D: SampleNormals<f32>> RoughConductor<D> {
    /// Pdf per solid angle of the direction that `facet` reflects to.
    #[inline(always)]
    fn density(&self, wo: Vec3, facet: &Facet) -> f32 {
        match self.normals {
            NormalSampling::Vndf => self.pdf_visible::<false>(wo, facet),
            NormalSampling::Bounded => self.pdf_visible::<true>(wo, facet),
            NormalSampling::Ndf => 0.25 * self.distribution.pdf_ndf(facet.wm) / facet.cos,
            NormalSampling::Hemisphere => UNIFORM_PDF,
        }
    }

    /// D G₁(wo) / (4 cos θₒ): the pdf of the visible normal times the Jacobian 1 / (4 wo·m); or that of bounded normals.
    #[inline(always)]
    fn pdf_visible<const BOUNDED: bool>(&self, wo: Vec3, facet: &Facet) -> f32 {
        let (d, wo) = (&self.distribution, wo.to_array());
        0.25 * d.d(facet.wm) * if BOUNDED { d.bounded_over_cos(wo) } else { d.g1_over_cos(wo) }
    }

    /// f for F = 1.
    #[inline(always)]
    fn strength(&self, wo: Vec3, wi: Vec3, facet: &Facet) -> f32 {
        // D G₂ / (4 cos θₒ cos θᵢ); where D vanishes the other factor may be infinite.
        let d = self.distribution.d(facet.wm);
        let rest = self.distribution.g2_over_cosines(wo.to_array(), wi.to_array());
        if d > 0.0 { 0.25 * d * rest } else { 0.0 }
    }

    /// f cos θᵢ / pdf for F = 1, of samples by other than visible normals.
    #[inline]
    fn weight(&self, wo: Vec3, wi: Vec3, facet: &Facet) -> f32 {
        let d = &self.distribution;
        let (o, i) = (wo.to_array(), wi.to_array());
        match self.normals {
            NormalSampling::Ndf => d.g2_over_cosines(o, i) * wi.z * facet.cos / facet.wm[2],
            _ => 0.25 * d.d(facet.wm) * d.g2_over_cosines(o, i) * wi.z / UNIFORM_PDF,
        }
    }
}

/// A rough conductor sampled by visible normals, or by bounded ones.
#[derive(Clone, Copy)]
pub struct ByVisibleNormals<D, const BOUNDED: bool>(pub RoughConductor<D>);

impl<D: SampleNormals<f32>, const BOUNDED: bool> Vectorizable for ByVisibleNormals<D, BOUNDED> {
    #[inline(always)]
    fn sample_lane(&self, wo: Vec3, _uc: f32, u: [f32; 2]) -> BsdfSample {
        // Sample a visible normal, and reflect `wo` by it.
        let d = &self.0.distribution;
        let o = wo.to_array();
        let (wi, is_above) = reflect(wo, if BOUNDED { d.sample_bounded(o, u) } else { d.sample_vndf(o, u) });
        let facet = Facet::of(wo, wi);
        let pdf = self.0.pdf_visible::<BOUNDED>(wo, &facet);
        // D cancels in the weight. G₂/G₁ = a/(a + b) ≤ 1, also when rounded.
        let visible = wo.z + d.cos_lambda(o);
        let a = wi.z * visible;
        let g = a / (a + wo.z * d.cos_lambda(wi.to_array()));
        // Fewer normals have a greater pdf.
        let g = if BOUNDED { g / (visible * d.bounded_over_cos(o)) } else { g };
        let is_valid = is_above & facet.exists & (pdf > 0.0);
        let weight = self.0.fresnel.reflectance(facet.cos) * if is_valid { g } else { 0.0 };
        BsdfSample::reflected(wi, weight, if is_valid { pdf } else { 0.0 }, Lobe::GlossyReflection)
    }

    #[inline(always)]
    fn eval_pdf_lane(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let facet = Facet::of(wo, wi);
        let (f, pdf) = (self.0.strength(wo, wi, &facet), self.0.pdf_visible::<BOUNDED>(wo, &facet));
        let f = self.0.fresnel.reflectance(facet.cos) * if facet.exists { f } else { 0.0 };
        (f, if facet.exists { pdf } else { 0.0 })
    }
}

impl<D: SampleNormals<f32>> Scatter for RoughConductor<D> {
    fn lobes(&self) -> &'static [Lobe] {
        &[Lobe::GlossyReflection]
    }

    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        Facet::between(wo, wi).map_or(0.0, |facet| self.density(wo, &facet))
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let Some(facet) = Facet::between(wo, wi) else { return (Rgb::ZERO, 0.0) };
        (self.fresnel.reflectance(facet.cos) * self.strength(wo, wi, &facet), self.density(wo, &facet))
    }

    #[inline]
    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = match self.normals {
            NormalSampling::Vndf => return ByVisibleNormals::<_, false>(*self).sample_lane(wo, uc, u).if_possible(),
            NormalSampling::Bounded => return ByVisibleNormals::<_, true>(*self).sample_lane(wo, uc, u).if_possible(),
            NormalSampling::Ndf => reflect_at(wo, self.distribution.sample_ndf(u))?,
            NormalSampling::Hemisphere => warp::uniform_hemisphere(u.map(f64::from)).as_vec3(),
        };
        let facet = Facet::between(wo, wi)?;
        let pdf = self.density(wo, &facet);
        if pdf <= 0.0 {
            return None;
        }
        let weight = self.fresnel.reflectance(facet.cos) * self.weight(wo, wi, &facet);
        Some(BsdfSample::reflected(wi, weight, pdf, Lobe::GlossyReflection))
    }

    #[inline]
    fn vectorize(&self, work: impl VectorizedLoop) -> bool {
        match self.normals {
            NormalSampling::Vndf => work.over(ByVisibleNormals::<_, false>(*self)),
            NormalSampling::Bounded => work.over(ByVisibleNormals::<_, true>(*self)),
            NormalSampling::Ndf | NormalSampling::Hemisphere => return false,
        }
        true
    }

    /// F G₂/G₁ by visible normals, and less by those that are bounded.
    fn largest_weight(&self) -> Option<f32> {
        matches!(self.normals, NormalSampling::Vndf | NormalSampling::Bounded).then_some(1.0)
    }
}

impl Bsdf {
    /// A rough conductor of single scattering whose directions are sampled this way; any other BSDF as it is.
    #[must_use]
    pub fn with_normals(self, normals: NormalSampling) -> Self {
        match self {
            Self::Beckmann(metal) => Self::Beckmann(RoughConductor { normals, ..metal }),
            Self::Ggx(metal) => Self::Ggx(RoughConductor { normals, ..metal }),
            other => other,
        }
    }
}

pub(super) const BECKMANN: &[Family] = &[family("beckmann", isotropic_and_brushed, |v| Bsdf::Beckmann(beckmann(v)))];

pub(super) const GGX: &[Family] = &[
    family("ggx", isotropic_and_brushed, |v| Bsdf::Ggx(ggx(v, NormalSampling::Vndf))),
    family("ggx-bounded", |family| isotropic(family, "ggx/bounded"), |v| Bsdf::Ggx(ggx(v, NormalSampling::Bounded))),
    family("ggx-ndf", |_| Vec::new(), |v| Bsdf::Ggx(ggx(v, NormalSampling::Ndf))),
];

const fn family(name: &'static str, examples: fn(&Family) -> Vec<Example>, bsdf: fn(&[f32]) -> Bsdf) -> Family {
    Family { name, parameters: &[ALPHA_X, ALPHA_Y, ETA, K], energy: Energy::AtMostOne, bsdf, examples }
}

fn beckmann(v: &[f32]) -> RoughConductor<Beckmann<f32>> {
    let distribution = Beckmann::anisotropic([v[0], v[1]]);
    RoughConductor { distribution, fresnel: grey(v[2], v[3]), normals: NormalSampling::Vndf }
}

fn ggx(v: &[f32], normals: NormalSampling) -> RoughConductor<Ggx<f32>> {
    RoughConductor { distribution: Ggx::anisotropic([v[0], v[1]]), fresnel: grey(v[2], v[3]), normals }
}

fn isotropic(family: &Family, name: &str) -> Vec<Example> {
    let example = |alpha: f32| Example {
        is_integrated: alpha == 0.1 || alpha == 0.5,
        ..family.example(format!("{name}/{alpha}"), [alpha, alpha, 0.5, 2.5])
    };
    ALPHAS.map(example).into()
}

fn isotropic_and_brushed(family: &Family) -> Vec<Example> {
    let brushed = family.example(format!("{}/anisotropic", family.name), [0.05, 0.4, 0.5, 2.5]);
    isotropic(family, family.name).into_iter().chain([brushed]).collect()
}
