//! A weighted sum of BSDFs: f = Σ wₖ fₖ.
//!
//! BSDF k is sampled with probability pₖ = wₖ / Σ w. The pdf of a direction is Σ pₖ pdfₖ, and the weight f |cos θᵢ| over that:
//! the balance heuristic, whose weights are at most those of the BSDFs. Delta lobes keep their own. Source: Veach, "Robust Monte
//! Carlo Methods for Light Transport Simulation", 1997, section 9.2.2.

use super::examples::{ALBEDO, ALPHA, COLOUR, ETA, Example, Family, K, REFLECTANCE, SHARE, grey};
use super::{Bsdf, BsdfSample, Diffuse, Lobe, Mirror, NormalSampling, RoughConductor, Scatter};
use crate::math::Rgb;
use crate::optics::microfacet::Ggx;
use etalon_stats::bsdf::Energy;
use glam::Vec3;
use std::sync::Arc;

/// A weighted sum of BSDFs.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixture<B> {
    parts: Arc<[Part<B>]>,
    lobes: Arc<[Lobe]>,
    is_reciprocal: bool,
}

/// A BSDF of the sum.
#[derive(Debug, Clone, PartialEq)]
struct Part<B> {
    bsdf: B,
    weight: f32,
    /// The probability with which it is sampled, and the sum of those before it.
    probability: f32,
    before: f32,
}

impl<B: Scatter> Mixture<B> {
    /// The sum of BSDFs with their weights, each ≥ 0; those of weight 0 are left out.
    pub fn new(parts: impl IntoIterator<Item = (f32, B)>) -> Self {
        let parts: Vec<(f32, B)> = parts.into_iter().filter(|(weight, _)| *weight > 0.0).collect();
        let total: f32 = parts.iter().map(|(weight, _)| weight).sum();
        let mut before = 0.0;
        let part = |(weight, bsdf): (f32, B)| {
            let part = Part { bsdf, weight, probability: weight / total, before };
            before += part.probability;
            part
        };
        let parts: Arc<[Part<B>]> = parts.into_iter().map(part).collect();
        let mut lobes: Vec<Lobe> = Vec::new();
        let mut twice = false;
        for lobe in parts.iter().flat_map(|part| part.bsdf.lobes()) {
            twice |= lobe.is_delta() && lobes.contains(lobe);
            if !lobes.contains(lobe) {
                lobes.push(*lobe);
            }
        }
        // Two delta lobes of one kind may share a direction, whose probability is then the sum of both. Light paths do not
        // compute it, so that such a mixture counts as not reciprocal.
        let is_reciprocal = !twice && parts.iter().all(|part| part.bsdf.is_reciprocal());
        Self { parts, lobes: lobes.into(), is_reciprocal }
    }

    /// Samples one of the BSDFs, and the weight by all: of the adjoint, or not.
    fn sample_by(
        &self,
        wo: Vec3,
        uc: f32,
        u: [f32; 2],
        sample: fn(&B, Vec3, f32, [f32; 2]) -> Option<BsdfSample>,
        eval: fn(&B, Vec3, Vec3) -> Rgb,
    ) -> Option<BsdfSample> {
        // Choose a BSDF, and make a random number of what is left of `uc`.
        let part = self.parts.iter().rev().find(|part| uc >= part.before)?;
        let rest = ((uc - part.before) / part.probability).min(1.0f32.next_down());
        let chosen = sample(&part.bsdf, wo, rest, u)?;
        let probability = part.probability * chosen.probability;
        if chosen.is_delta() {
            let weight = chosen.weight * (part.weight / part.probability);
            return Some(BsdfSample { weight, probability, ..chosen });
        }
        let pdf = self.pdf(wo, chosen.wi);
        let f: Rgb = self.parts.iter().map(|part| eval(&part.bsdf, wo, chosen.wi) * part.weight).sum();
        BsdfSample { weight: f * chosen.wi.z.abs() / pdf, pdf, probability, ..chosen }.if_possible()
    }
}

impl<B: Scatter> Scatter for Mixture<B> {
    fn lobes(&self) -> &[Lobe] {
        &self.lobes
    }

    /// Several parts may have the same lobe.
    fn needs_choice(&self) -> bool {
        true
    }

    fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        self.parts.iter().fold((Rgb::ZERO, 0.0), |(f, pdf), part| {
            let (of_part, pdf_of_part) = part.bsdf.eval_pdf(wo, wi);
            (f + of_part * part.weight, pdf + pdf_of_part * part.probability)
        })
    }

    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        self.sample_by(wo, uc, u, B::sample, B::eval)
    }

    fn lobe_probability(&self, wo: Vec3, lobe: Lobe) -> f32 {
        self.parts.iter().map(|part| part.probability * part.bsdf.lobe_probability(wo, lobe)).sum()
    }

    fn is_reciprocal(&self) -> bool {
        self.is_reciprocal
    }

    /// Each BSDF has its own η.
    fn sample_adjoint(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        self.sample_by(wo, uc, u, B::sample_adjoint, B::eval_adjoint)
    }

    /// By the balance heuristic, the largest of its parts times the sum of their weights.
    fn largest_weight(&self) -> Option<f32> {
        let total: f32 = self.parts.iter().map(|part| part.weight).sum();
        self.parts.iter().try_fold(0.0f32, |largest, part| Some(largest.max(total * part.bsdf.largest_weight()?)))
    }
}

/// A Lambertian surface and a rough metal, which has that share.
pub(super) const FAMILIES: &[Family] = &[Family {
    name: "mixture",
    parameters: &[("share", 0.5, SHARE), ALBEDO, ALPHA, ETA, K],
    energy: Energy::AtMostOne,
    bsdf: |v| painted_metal([1.0 - v[0], v[0]], Rgb::splat(v[1]), v[2], [v[3], v[4]]),
    examples: |family| {
        let diffuse = || Bsdf::Diffuse(Diffuse::new(COLOUR));
        let mirror = || Bsdf::Mirror(Mirror { reflectance: REFLECTANCE });
        vec![
            Example::new(family.name, || painted_metal([0.4, 0.6], COLOUR, 0.2, [0.5, 2.5])),
            Example::new("mixture/mirror", move || Bsdf::Mixture(Mixture::new([(0.5, diffuse()), (0.5, mirror())]))),
        ]
    },
}];

fn painted_metal([paint, metal]: [f32; 2], albedo: Rgb, alpha: f32, [eta, k]: [f32; 2]) -> Bsdf {
    let rough = RoughConductor { distribution: Ggx::new(alpha), fresnel: grey(eta, k), normals: NormalSampling::Vndf };
    Bsdf::Mixture(Mixture::new([(paint, Bsdf::Diffuse(Diffuse::new(albedo))), (metal, Bsdf::Ggx(rough))]))
}
