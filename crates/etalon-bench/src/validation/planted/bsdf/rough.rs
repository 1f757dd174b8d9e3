//! Rough surfaces of GGX microfacets in f64, as the textbook has them: a conductor by Schlick's Fresnel, and a dielectric.
//!
//! Source: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007; Heitz, "Sampling the GGX
//! Distribution of Visible Normals", JCGT 7(4), 2018. Independent of `etalon_core::bsdf`.

use etalon_core::optics::dielectric;
use etalon_stats::bsdf::{Bsdf, BsdfSample, Density, Direction, Energy, Parameter, Properties, Spectrum};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// What the facets are made of.
#[derive(Clone, Copy)]
pub enum Facets {
    /// Metal of this reflectance at normal incidence.
    Conductor(f64),
    /// A dielectric of this index below over that above.
    Dielectric(f64),
}

/// A rough surface, by visible normals.
#[derive(Clone, Copy)]
pub struct Rough {
    pub alpha: [f64; 2],
    pub facets: Facets,
}

/// What two directions have to do with each other.
pub struct Pair {
    /// The facet's normal, with z > 0.
    pub m: DVec3,
    /// |wo·m| and |wi·m|.
    pub cos_o: f64,
    pub cos_i: f64,
    /// The index on the far side over that on the side of `wo`.
    pub eta: f64,
    pub is_reflection: bool,
    /// wo·m + η wi·m, of refraction.
    pub sum: f64,
}

impl Rough {
    /// The index below over that above.
    pub fn index(&self) -> f64 {
        if let Facets::Dielectric(eta) = self.facets { eta } else { 1.0 }
    }

    /// The index on the far side of `wo` over that on its side.
    pub fn eta(&self, wo: Direction) -> f64 {
        if wo[2] > 0.0 { self.index() } else { 1.0 / self.index() }
    }

    /// Fresnel reflectance at the cosine with the facet.
    pub fn fresnel(&self, cos: f64, eta: f64) -> f64 {
        match self.facets {
            Facets::Conductor(f0) => f0 + (1.0 - f0) * (1.0 - cos).powi(5),
            Facets::Dielectric(_) => dielectric::fresnel(cos, eta).unpolarized(),
        }
    }

    /// GGX: the density of normals per solid angle.
    pub fn d(&self, m: DVec3) -> f64 {
        let [ax, ay] = self.alpha;
        let e = (m.x / ax).powi(2) + (m.y / ay).powi(2) + m.z * m.z;
        1.0 / (PI * ax * ay * e * e)
    }

    /// Smith's Λ.
    pub fn lambda(&self, w: Direction) -> f64 {
        let [ax, ay] = self.alpha;
        let tan2 = ((ax * w[0]).powi(2) + (ay * w[1]).powi(2)) / (w[2] * w[2]);
        0.5 * ((1.0 + tan2).sqrt() - 1.0)
    }

    pub fn g1(&self, w: Direction) -> f64 {
        1.0 / (1.0 + self.lambda(w))
    }

    pub fn g2(&self, wo: Direction, wi: Direction) -> f64 {
        1.0 / (1.0 + self.lambda(wo) + self.lambda(wi))
    }

    /// The facet between two directions, if it faces both.
    pub fn pair(&self, wo: Direction, wi: Direction) -> Option<Pair> {
        self.unoriented(wo, wi).filter(|pair| {
            let faces = |w: Direction| pair.m.dot(DVec3::from_array(w)) * w[2] > 0.0;
            faces(wo) && faces(wi)
        })
    }

    /// The facet between two directions, which need not see it.
    pub fn unoriented(&self, wo: Direction, wi: Direction) -> Option<Pair> {
        let (o, i, eta) = (DVec3::from_array(wo), DVec3::from_array(wi), self.eta(wo));
        let is_reflection = wo[2] * wi[2] > 0.0;
        let possible = match self.facets {
            Facets::Conductor(_) => wo[2] > 0.0 && wi[2] > 0.0,
            Facets::Dielectric(_) => wo[2] * wi[2] != 0.0,
        };
        let m = if is_reflection { o + i } else { o + eta * i };
        if !possible || m.length_squared() == 0.0 {
            return None;
        }
        let m = m.normalize();
        let m = if m.z < 0.0 { -m } else { m };
        let (dot_o, dot_i) = (o.dot(m), i.dot(m));
        Some(Pair { m, cos_o: dot_o.abs(), cos_i: dot_i.abs(), eta, is_reflection, sum: dot_o + eta * dot_i })
    }

    /// f between two directions with that facet, for G₂ and the share F or 1 − F.
    pub fn value(&self, wo: Direction, wi: Direction, pair: &Pair, g: f64, share: f64) -> f64 {
        let common = share * self.d(pair.m) * g / (wo[2] * wi[2]).abs();
        if pair.is_reflection { 0.25 * common } else { common * pair.cos_o * pair.cos_i / (pair.sum * pair.sum) }
    }

    /// F of a reflection, 1 − F of a refraction.
    pub fn share(&self, pair: &Pair) -> f64 {
        let f = self.fresnel(pair.cos_o.min(1.0), pair.eta);
        if pair.is_reflection { f } else { 1.0 - f }
    }

    /// The probability of the pair's lobe: by F for a dielectric.
    pub fn probability(&self, pair: &Pair) -> f64 {
        if let Facets::Dielectric(_) = self.facets { self.share(pair) } else { 1.0 }
    }

    /// |dm/dwi|.
    pub fn jacobian(&self, pair: &Pair) -> f64 {
        let Pair { cos_o, cos_i, eta, sum, .. } = *pair;
        if pair.is_reflection { 0.25 / cos_o } else { eta * eta * cos_i / (sum * sum) }
    }

    /// Pdf of the visible normals.
    pub fn visible(&self, wo: Direction, pair: &Pair) -> f64 {
        self.g1(wo) * self.d(pair.m) * pair.cos_o / wo[2].abs()
    }

    pub fn sample_normal(&self, wo: Direction, [u, v]: [f64; 2]) -> DVec3 {
        let [ax, ay] = self.alpha;
        let side = wo[2].signum();
        let view = DVec3::new(ax * side * wo[0], ay * side * wo[1], side * wo[2]).normalize();
        let flat = view.truncate().length();
        let t1 = if flat > 0.0 { DVec3::new(-view.y, view.x, 0.0) / flat } else { DVec3::X };
        let (r, s) = (u.sqrt(), 0.5 * (1.0 + view.z));
        let (sin, cos) = (TAU * v).sin_cos();
        let (p1, p2) = (r * cos, r * sin);
        let p2 = (1.0 - s) * (1.0 - p1 * p1).sqrt() + s * p2;
        let n = p1 * t1 + p2 * view.cross(t1) + (1.0 - p1 * p1 - p2 * p2).max(0.0).sqrt() * view;
        DVec3::new(ax * n.x, ay * n.y, n.z.max(1e-12)).normalize()
    }

    /// `wo` reflected or refracted by a facet.
    pub fn scatter(&self, wo: Direction, m: DVec3, reflects: bool) -> Option<Direction> {
        let (o, eta) = (DVec3::from_array(wo), self.eta(wo));
        let cos = o.dot(m);
        let wi = if reflects {
            2.0 * cos * m - o
        } else {
            let cos2 = 1.0 - (1.0 - cos * cos) / (eta * eta);
            let cos_t = (cos2 >= 0.0).then(|| cos2.sqrt())?;
            (cos / eta - cos_t.copysign(cos)) * m - o / eta
        };
        Some(wi.normalize().to_array())
    }

    /// The sample of `wi`: weight G₂/G₁ times what refraction and the choice of the lobe do.
    pub fn weighted(&self, wo: Direction, wi: Direction) -> Option<BsdfSample> {
        let pair = self.pair(wo, wi)?;
        let (pdf, probability) = (self.pdf(wo, wi), self.probability(&pair));
        let share = self.share(&pair) / probability;
        let radiance = if pair.is_reflection { 1.0 } else { 1.0 / (pair.eta * pair.eta) };
        let weight = share * radiance * self.g2(wo, wi) / self.g1(wo);
        let lobe = usize::from(!pair.is_reflection);
        (pdf > 0.0).then(|| BsdfSample::new(wi, [weight; 3], Density::Pdf(pdf)).of_lobe(lobe, probability))
    }
}

impl Bsdf for Rough {
    fn properties(&self) -> Properties {
        let transmission = matches!(self.facets, Facets::Dielectric(_));
        let alpha = |name, value| Parameter::new(name, value, [1e-4, 1.0]);
        Properties {
            transmission,
            eta: self.index(),
            energy: Energy::AtMostOne,
            parameters: vec![alpha("alpha x", self.alpha[0]), alpha("alpha y", self.alpha[1])],
            ..Properties::default()
        }
    }

    fn eval(&self, wo: Direction, wi: Direction, _: &[f64]) -> Spectrum {
        let value = |pair: Pair| self.value(wo, wi, &pair, self.g2(wo, wi), self.share(&pair));
        [self.pair(wo, wi).map_or(0.0, value); 3]
    }

    fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
        let pdf = |pair: Pair| self.probability(&pair) * self.visible(wo, &pair) * self.jacobian(&pair);
        self.pair(wo, wi).map_or(0.0, pdf)
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        if matches!(self.facets, Facets::Conductor(_)) && wo[2] <= 0.0 {
            return None;
        }
        let m = self.sample_normal(wo, [u[1], u[2]]);
        let cos = m.dot(DVec3::from_array(wo)).abs().min(1.0);
        let reflects = match self.facets {
            Facets::Conductor(_) => true,
            Facets::Dielectric(_) => u[0] < self.fresnel(cos, self.eta(wo)),
        };
        let wi = self.scatter(wo, m, reflects).filter(|wi| (wi[2] * wo[2] > 0.0) == reflects)?;
        self.weighted(wo, wi)
    }

    fn lobes(&self) -> usize {
        if let Facets::Dielectric(_) = self.facets { 2 } else { 1 }
    }

    fn lobe_pdf(&self, wo: Direction, wi: Direction, lobe: usize) -> Option<f64> {
        let is_lobe = (wo[2] * wi[2] > 0.0) == (lobe == 0);
        Some(if is_lobe { self.pdf(wo, wi) } else { 0.0 })
    }

    fn eval_adjoint(&self, wo: Direction, wi: Direction) -> Option<Spectrum> {
        let eta = if wo[2] * wi[2] > 0.0 { 1.0 } else { self.eta(wo) };
        Some(self.eval(wo, wi, &[]).map(|f| f * eta * eta))
    }

    fn sample_adjoint(&self, wo: Direction, u: &[f64]) -> Option<Option<BsdfSample>> {
        let adjoint = |sample: BsdfSample| {
            let eta = if wo[2] * sample.wi[2] > 0.0 { 1.0 } else { self.eta(wo) };
            BsdfSample { weight: sample.weight.map(|w| w * eta * eta), ..sample }
        };
        Some(self.sample(wo, u).map(adjoint))
    }
}
