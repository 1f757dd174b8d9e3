//! A rough conductor of microfacets, by Torrance and Sparrow's model: f = F D G₂ / (4 cos θₒ cos θᵢ).
//!
//! F is taken at the angle between `wi` and the facet's normal, G₂ is Smith's for heights that correlate. Source: Cook &
//! Torrance, "A Reflectance Model for Computer Graphics", 1982; Walter et al., EGSR 2007; Heitz, JCGT 3(2), 2014.
//!
//! The facet's normal is always recomputed from the two directions, in `sample` as in `pdf`, so that both speak of the
//! same f32 directions to the last bit. Where α cos θₒ < 10⁻⁷ two such directions no longer tell the facet between
//! them, and the density's integral is off by some ten percent; elsewhere it is exact within what a grid of 32768 normals
//! can tell, 0.3 %.

use super::{BsdfSample, MetalFresnel, Scatter};
use crate::raster::Rgb;
use crate::sampling::normals::SampleNormals;
use crate::sampling::warp;
use glam::Vec3;

/// How a rough conductor draws directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Normals {
    /// By facets as seen from `wo`: weights F G₂/G₁ ≤ 1.
    #[default]
    Visible,
    /// By facets as they lie: the weights are unbounded at grazing angles.
    All,
    /// Directions spread evenly over the hemisphere, which ignores the material.
    Hemisphere,
}

/// A rough metal, on the outside only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conductor<D> {
    pub distribution: D,
    pub fresnel: MetalFresnel,
    pub normals: Normals,
}

/// The facet that reflects `wi` to `wo`.
#[derive(Clone, Copy)]
pub(super) struct Facet {
    pub wm: [f32; 3],
    /// Cosine of either direction with its normal.
    pub cos: f32,
}

impl Facet {
    /// `None` unless both directions are above the surface.
    #[inline]
    pub fn between(wo: Vec3, wi: Vec3) -> Option<Self> {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return None;
        }
        let sum = wo + wi;
        // |wo + wi| is twice the cosine: unlike wo·wm it is symmetric and never 0 by cancellation.
        let length = sum.length();
        let wm = sum / length;
        // Opposite directions along the surface leave no normal.
        (wm.z > 0.0).then(|| Self { wm: wm.to_array(), cos: (0.5 * length).min(1.0) })
    }
}

/// `wo` reflected by a facet with normal `wm`, if that faces `wo` and the direction leaves the surface.
#[inline]
pub(super) fn reflect_at(wo: Vec3, wm: [f32; 3]) -> Option<Vec3> {
    let wm = Vec3::from_array(wm);
    let cos = wo.dot(wm);
    let wi = (2.0 * cos * wm - wo).normalize();
    (cos > 0.0 && wi.z > 0.0).then_some(wi)
}

/// Density per solid angle of the even hemisphere.
const EVEN: f32 = warp::UNIFORM_HEMISPHERE_PDF as f32;

impl<D: SampleNormals<f32>> Conductor<D> {
    #[inline]
    fn density(&self, wo: Vec3, facet: &Facet) -> f32 {
        match self.normals {
            Normals::Visible => 0.25 * self.distribution.d(facet.wm) * self.distribution.g1_over_cos(wo.to_array()),
            Normals::All => 0.25 * self.distribution.pdf_all(facet.wm) / facet.cos,
            Normals::Hemisphere => EVEN,
        }
    }

    /// f cos θᵢ over the density, for F = 1. D cancels where the normals are drawn by it.
    #[inline]
    fn weight(&self, wo: Vec3, wi: Vec3, facet: &Facet) -> f32 {
        let d = &self.distribution;
        let (o, i) = (wo.to_array(), wi.to_array());
        match self.normals {
            Normals::Visible => {
                // G₂/G₁ = a/(a + b) ≤ 1 even when rounded.
                let a = wi.z * (wo.z + d.cos_lambda(o));
                a / (a + wo.z * d.cos_lambda(i))
            }
            Normals::All => d.g2_over_cosines(o, i) * wi.z * facet.cos / facet.wm[2],
            Normals::Hemisphere => 0.25 * d.d(facet.wm) * d.g2_over_cosines(o, i) * wi.z / EVEN,
        }
    }
}

impl<D: SampleNormals<f32>> Scatter for Conductor<D> {
    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        Facet::between(wo, wi).map_or(0.0, |facet| self.density(wo, &facet))
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let Some(facet) = Facet::between(wo, wi) else { return (Rgb::ZERO, 0.0) };
        let pdf = self.density(wo, &facet);
        let d = self.distribution.d(facet.wm);
        if d == 0.0 {
            return (Rgb::ZERO, pdf);
        }
        let f = 0.25 * d * self.distribution.g2_over_cosines(wo.to_array(), wi.to_array());
        (self.fresnel.reflectance(facet.cos) * f, pdf)
    }

    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = match self.normals {
            Normals::Visible => reflect_at(wo, self.distribution.sample_visible(wo.to_array(), u))?,
            Normals::All => reflect_at(wo, self.distribution.sample_all(u))?,
            Normals::Hemisphere => warp::uniform_hemisphere(u.map(f64::from)).as_vec3(),
        };
        let facet = Facet::between(wo, wi)?;
        let pdf = self.density(wo, &facet);
        if pdf <= 0.0 {
            return None;
        }
        let weight = self.fresnel.reflectance(facet.cos) * self.weight(wo, wi, &facet);
        Some(BsdfSample { wi, weight, pdf, delta: false })
    }
}
