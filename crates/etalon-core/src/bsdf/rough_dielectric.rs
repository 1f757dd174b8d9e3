//! A rough dielectric boundary of microfacets: each reflects and refracts by Fresnel's equations.
//!
//! A facet of normal m scatters `wi` to `wo` if m is parallel to the half vector h = wo + s wi, with s = 1 for reflection and
//! s = η for refraction, η the index on the side of `wi` over that on the side of `wo`. Then |h| = |wo·m + s wi·m|, and one
//! formula holds for both, for the share P = F of what is reflected or 1 − F of what is refracted:
//!
//! * f = P D(m) G₂ |wo·m| |wi·m| / (cos θₒ cos θᵢ |h|²), which for reflection is F D G₂ / (4 cos θₒ cos θᵢ)
//! * pdf = P D(m) G₁(wo)/cos θₒ |wo·m| s² |wi·m| / |h|²: the facet is sampled among those visible from `wo`, then P
//! * f |cos θᵢ| / pdf = G₂/(G₁(wo) s²) = G₁(wi)/s² ≤ 1/s²: radiance changes by 1/η² across the boundary
//!
//! G₂ is G₁(wo) G₁(wi), as in the source, so that values agree with renderers that follow it (Mitsuba). Height-correlated
//! masking and shadowing would be greater for reflection, 1/(1 + Λₒ + Λᵢ), as the metals here have, and less for refraction,
//! the beta function B(1 + Λₒ, 1 + Λᵢ) (Heitz et al., "Multiple-Scattering Microfacet BSDFs with the Smith Model", SIGGRAPH
//! 2016). Light that meets a second facet is lost.
//!
//! Source: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, eq. 17, 20 and 21; sampling of
//! visible normals: Heitz & d'Eon, "Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals",
//! EGSR 2014.

use super::examples::{ALPHA_X, ALPHA_Y, ALPHAS, Example, Family, GLASS};
use super::rough_conductor::LEAST_LENGTH;
use super::{Bsdf, BsdfSample, Dielectric, Lobe, Scatter, Vectorizable, VectorizedLoop};
use crate::math::{Rgb, map_array};
use crate::optics::microfacet::{Beckmann, Ggx};
use crate::sampling::normals::SampleNormals;
use etalon_stats::bsdf::Energy;
use glam::Vec3;

/// A rough dielectric boundary, on either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughDielectric<D> {
    pub distribution: D,
    /// What reflected light is multiplied by, besides Fresnel's reflectance.
    pub reflectance: Rgb,
    /// What transmitted light is multiplied by, besides Fresnel's transmittance.
    pub transmittance: Rgb,
    /// Index of refraction of the inside over that of the outside.
    eta: f64,
}

/// The smallest α |η − 1| / max(η, 1) of a rough boundary.
///
/// |h| of refraction is at least |η − 1| and that from inside |η − 1|/η, with components that have been rounded by up to 2⁻²⁵
/// each with `wi`. So the tilt of m is uncertain by 2⁻²⁵ max(η, 1)/|η − 1|. Above this bound that is at most α 2⁻⁹, which
/// changes D at tan θₘ = α by at most 2⁻⁸. Below it the refracted lobe is hardly wider than the distance between directions
/// in f32, and the boundary is taken for smooth.
pub const LEAST_DEVIATION: f32 = 1.0 / 65536.0;

/// Whether f32 directions resolve the refracted lobe of a boundary: see [`LEAST_DEVIATION`].
pub fn is_resolved([x, y]: [f32; 2], eta: f32) -> bool {
    x.min(y) * (eta - 1.0).abs() >= LEAST_DEVIATION * eta.max(1.0)
}

/// The side of `wo`, turned upwards.
#[derive(Clone, Copy)]
struct Side {
    /// `wo`, with z ≥ 0.
    wo: Vec3,
    /// −1 if z has been turned.
    sign: f32,
    /// The index of the far side over that of this one, and its square minus 1.
    eta: f64,
    q: f64,
}

/// The facet between two directions, and what it makes of light.
#[derive(Clone, Copy)]
struct Facet {
    /// Its unit normal.
    wm: [f32; 3],
    /// wo·m.
    cos: f32,
    /// |wi·m| / |h|²: times s² the solid angle of normals over that of directions `wi`.
    spread: f32,
    /// The share of the light that takes this way: F, or 1 − F.
    share: f32,
    reflects: bool,
    /// Whether there is such a facet.
    exists: bool,
}

impl<D: SampleNormals<f32>> RoughDielectric<D> {
    /// A boundary between media of which the inside has the index `eta` > 0 over that of the outside, with
    /// α |η − 1| / max(η, 1) at least [`LEAST_DEVIATION`].
    pub fn new(distribution: D, reflectance: Rgb, transmittance: Rgb, eta: f32) -> Self {
        Self { distribution, reflectance, transmittance, eta: f64::from(eta) }
    }

    /// Index of refraction of the inside over that of the outside.
    pub fn eta(&self) -> f32 {
        self.eta as f32
    }

    /// The pdf of `wi` by the facet between.
    #[inline(always)]
    fn density(&self, side: &Side, facet: &Facet) -> f32 {
        let s2 = if facet.reflects { 1.0 } else { (side.eta * side.eta) as f32 };
        let d = self.distribution.d(facet.wm) * self.distribution.g1_over_cos(side.wo.to_array());
        facet.share * d * (facet.cos * s2 * facet.spread)
    }
}

impl Side {
    /// The side of `wo` of a boundary of index `eta`.
    #[inline(always)]
    fn of(wo: Vec3, eta: f64) -> Self {
        let inside = wo.z < 0.0;
        let eta = if inside { 1.0 / eta } else { eta };
        Self {
            wo: Vec3::new(wo.x, wo.y, wo.z.abs()),
            sign: if inside { -1.0 } else { 1.0 },
            eta,
            q: (eta - 1.0) * (eta + 1.0),
        }
    }
}

/// The normal, on the side of z > 0, of the facet that refracts `wi` to `wo`, and dωₘ/dωᵢ; `None` if there is none.
pub fn refracting_facet(eta: f32, wo: Vec3, wi: Vec3) -> Option<([f32; 3], f32)> {
    let side = Side::of(wo, f64::from(eta));
    let facet = Facet::between(&side, Vec3::new(wi.x, wi.y, wi.z * side.sign));
    let [x, y, z] = facet.wm;
    // The facet of the mirrored directions is the mirrored facet.
    let wm = [x * side.sign, y * side.sign, z];
    let jacobian = (side.eta * side.eta) as f32 * facet.spread;
    (facet.exists && !facet.reflects).then_some((wm, jacobian))
}

impl Facet {
    /// The facet between `side.wo` and `wi`, both turned by the same mirror.
    #[inline(always)]
    fn between(side: &Side, wi: Vec3) -> Self {
        let reflects = wi.z > 0.0;
        let (s, q) = if reflects { (1.0, 0.0) } else { (side.eta, side.q) };
        // h in f64 and with the rounding of both lengths removed: for η near 1 it is a small difference.
        let (o, i) = (unit(side.wo), unit(wi));
        let h = [o[0] + s * i[0], o[1] + s * i[1], o[2] + s * i[2]];
        let length2 = h[0] * h[0] + h[1] * h[1] + h[2] * h[2];
        // wo·h = (|h|² + 1 − s²)/2, and wi·h = (|h|² − 1 + s²)/(2 s), without a sum of products that cancel.
        let length = (length2 as f32).sqrt();
        let upwards = if h[2] < 0.0 { -1.0 } else { 1.0 } / length;
        let cos_o = (0.5 * (length2 - q)) as f32 * upwards;
        let cos_i = (0.5 * (length2 + q) / s) as f32 * upwards;
        // Light meets the facet from outside, and leaves it on the right side.
        let leaves = if reflects { cos_i > 0.0 } else { cos_i < 0.0 };
        let exists =
            (side.wo.z > 0.0) & (wi.z != 0.0) & (h[2] != 0.0) & (length > LEAST_LENGTH) & (cos_o > 0.0) & leaves;
        // g = η cos θₜ is known of refracted light; next to the critical angle that is more precise than Snell's law.
        let cos_o = cos_o.min(1.0);
        let (reflected, _) = fresnel(cos_o, side.q);
        let transmitted = transmittance(cos_o, side.eta as f32 * cos_i.abs(), (side.q + 1.0) as f32);
        Self {
            wm: [h[0] as f32 * upwards, h[1] as f32 * upwards, h[2] as f32 * upwards],
            cos: cos_o,
            spread: cos_i.abs() / length2 as f32,
            share: if reflects { reflected } else { transmitted },
            reflects,
            exists,
        }
    }
}

/// A direction in f64, the rounding of its length removed to first order.
#[inline(always)]
fn unit(w: Vec3) -> [f64; 3] {
    let w = map_array(w.to_array(), f64::from);
    let excess = 0.5 * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2] - 1.0);
    [w[0] - excess * w[0], w[1] - excess * w[1], w[2] - excess * w[2]]
}

/// The reflected share F and g = η cos θₜ at a cosine in \[0, 1\], for q = η² − 1: [`crate::optics::dielectric::fresnel`]
/// without branches. Under total internal reflection they are 1 and 0.
#[inline(always)]
fn fresnel(cos: f32, q: f64) -> (f32, f32) {
    const TINY: f32 = 1e-18;
    // c² is exact in f64, so that only the rounding of the cosine matters near the critical angle.
    let g2 = q + f64::from(cos) * f64::from(cos);
    let is_total = (q < 0.0) & (g2 <= 0.0);
    let g = g2.max(0.0) as f32;
    let g = g.sqrt();
    let sum = cos + g;
    let r = (q as f32 / (sum * sum).max(TINY)).abs().min(1.0);
    let sin2 = (1.0 - cos) * (1.0 + cos);
    let ratio = (cos * g - sin2) / (cos * g + sin2).max(TINY);
    let f = 0.5 * r * r * (1.0 + ratio * ratio);
    (if is_total { 1.0 } else { f.min(1.0) }, g)
}

/// 1 − F = 2 c g (1/(c + g)² + η²/(η² c + g)²), without the difference, for g = η cos θₜ and η².
#[inline(always)]
fn transmittance(cos: f32, g: f32, eta2: f32) -> f32 {
    let (across, along) = (cos + g, eta2 * cos + g);
    (2.0 * cos * g * ((across * across).recip() + eta2 / (along * along))).min(1.0)
}

impl<D: SampleNormals<f32>> Vectorizable for RoughDielectric<D> {
    #[inline(always)]
    fn sample_lane(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> BsdfSample {
        // Sample a facet visible from `wo`.
        let side = Side::of(wo, self.eta);
        let wm = Vec3::from_array(self.distribution.sample_vndf(side.wo.to_array(), u));
        let cos = side.wo.dot(wm).clamp(0.0, 1.0);
        // Choose reflection or refraction by its reflectance. wi = (c − g) m/η − wo/η, with c − g = −q/(c + g).
        let (reflected, g) = fresnel(cos, side.q);
        let reflects = uc < reflected;
        let along = if reflects { 2.0 * cos } else { -(side.q as f32) / (cos + g) };
        let turned = (along * wm - side.wo) / if reflects { 1.0 } else { side.eta as f32 };
        let wi = turned.normalize();
        // Compute the weight and the pdf from the facet between the directions as they are rounded.
        let facet = Facet::between(&side, wi);
        let pdf = self.density(&side, &facet);
        let weight = wi.z.abs() * self.distribution.g1_over_cos(wi.to_array());
        let eta = if reflects { 1.0 } else { side.eta as f32 };
        let tint = if reflects { self.reflectance } else { self.transmittance };
        let is_valid = facet.exists & (facet.reflects == reflects) & (pdf > 0.0);
        BsdfSample {
            wi: Vec3::new(wi.x, wi.y, wi.z * side.sign),
            weight: tint * if is_valid { weight / (eta * eta) } else { 0.0 },
            pdf: if is_valid { pdf } else { 0.0 },
            lobe: if reflects { Lobe::GlossyReflection } else { Lobe::GlossyTransmission },
            probability: facet.share,
            eta,
        }
    }

    #[inline(always)]
    fn eval_pdf_lane(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let side = Side::of(wo, self.eta);
        let wi = Vec3::new(wi.x, wi.y, wi.z * side.sign);
        let facet = Facet::between(&side, wi);
        let go = self.distribution.g1_over_cos(side.wo.to_array());
        let gi = self.distribution.g1_over_cos(wi.to_array());
        let d = self.distribution.d(facet.wm);
        let tint = if facet.reflects { self.reflectance } else { self.transmittance };
        // Where D vanishes the other factors may be infinite.
        let exists = facet.exists & (d > 0.0);
        let f = if exists { facet.share * d * (facet.cos * facet.spread) * go * gi } else { 0.0 };
        (tint * f, if exists { self.density(&side, &facet) } else { 0.0 })
    }
}

impl<D: SampleNormals<f32>> Scatter for RoughDielectric<D> {
    fn lobes(&self) -> &[Lobe] {
        &[Lobe::GlossyReflection, Lobe::GlossyTransmission]
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        self.eval_pdf_lane(wo, wi)
    }

    #[inline]
    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        self.sample_lane(wo, uc, u).if_possible()
    }

    #[inline]
    fn vectorize(&self, work: impl VectorizedLoop) -> bool {
        work.over(*self);
        true
    }

    /// F G₁(wi) of the reflected and (1 − F) G₁(wi) of the transmitted direction.
    fn largest_weight(&self) -> Option<f32> {
        Some(1.0)
    }
}

pub(super) const BECKMANN: &[Family] = &[family("beckmann-dielectric", |v| {
    let rough = |alpha| Bsdf::BeckmannDielectric(clear(Beckmann::anisotropic(alpha), v[2]));
    rough_or_smooth(v, rough)
})];

pub(super) const GGX: &[Family] = &[family("ggx-dielectric", |v| {
    let rough = |alpha| Bsdf::GgxDielectric(clear(Ggx::anisotropic(alpha), v[2]));
    rough_or_smooth(v, rough)
})];

const fn family(name: &'static str, bsdf: fn(&[f32]) -> Bsdf) -> Family {
    Family { name, parameters: &[ALPHA_X, ALPHA_Y, GLASS], energy: Energy::AtMostOne, bsdf, examples }
}

/// A boundary that absorbs nothing.
fn clear<D: SampleNormals<f32>>(distribution: D, eta: f32) -> RoughDielectric<D> {
    RoughDielectric::new(distribution, Rgb::ONE, Rgb::ONE, eta)
}

/// The rough boundary, or where directions do not resolve it the smooth one.
fn rough_or_smooth(v: &[f32], rough: impl Fn([f32; 2]) -> Bsdf) -> Bsdf {
    let alpha = [v[0], v[1]];
    if is_resolved(alpha, v[2]) { rough(alpha) } else { Bsdf::Dielectric(Dielectric::clear(v[2])) }
}

fn examples(family: &Family) -> Vec<Example> {
    let mut all = vec![family.example(format!("{}/anisotropic", family.name), [0.05, 0.4, 1.5])];
    for alpha in ALPHAS {
        for eta in [1.0 / 2.4, 1.0 / 1.5, 1.05, 1.5, 2.4] {
            let is_integrated = [(0.1, 1.0 / 1.5), (0.5, 1.5)].contains(&(alpha, eta));
            let example = family.example(format!("{}/{eta:.3}/{alpha}", family.name), [alpha, alpha, eta]);
            all.push(Example { is_integrated, ..example });
        }
    }
    all
}
