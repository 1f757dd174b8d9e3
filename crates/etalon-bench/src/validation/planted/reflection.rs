//! Mistakes in turning normals into reflected directions.

use super::super::case::direction_sampler;
use super::fault::PlantedFault;
use crate::validation::case::direction_density;
use etalon_core::math::circular::sin_cos_turns;
use etalon_core::optics::microfacet::{Ggx, Microfacet};
use etalon_core::sampling::normals::SampleNormals;
use etalon_stats::{Density, Directions, Mass, Pole, Sample, Sampler, sampler};
use glam::DVec3;

/// A rough surface, of which many reflections end below the horizon.
const ALPHA: f64 = 0.8;

fn facets() -> Ggx<f64> {
    Ggx::new(ALPHA)
}

/// The view, at 45°.
const WO: DVec3 = DVec3::new(std::f64::consts::FRAC_1_SQRT_2, 0.0, std::f64::consts::FRAC_1_SQRT_2);

/// `WO` reflected at the facet, if the direction leaves the surface.
fn reflected(m: [f64; 3]) -> Option<DVec3> {
    let m = DVec3::from_array(m);
    let wi = 2.0 * WO.dot(m) * m - WO;
    (wi.z > 0.0).then_some(wi)
}

fn visible(u: [f64; 2]) -> Option<DVec3> {
    reflected(facets().sample_vndf(WO.to_array(), u))
}

/// The normal between `WO` and `wi`.
fn facet(wi: DVec3) -> DVec3 {
    (WO + wi).normalize()
}

/// D(m) G₁(wo)/(4 cos θₒ): the pdf of what visible normals reflect.
fn pdf_vndf(wi: DVec3) -> f64 {
    0.25 * facets().d(facet(wi).to_array()) * facets().g1_over_cos(WO.to_array())
}

/// The factor k by which the cap of normals is cut to those that may reflect above the horizon, and the length of the
/// stretched view. Source: Eto & Tokuyoshi, "Bounded VNDF Sampling for Smith–GGX Reflections", SIGGRAPH Asia 2023.
fn bound() -> (f64, f64) {
    let a = ALPHA.min(1.0);
    let s2 = (1.0 + WO.truncate().length()).powi(2);
    let k = (1.0 - a * a) * s2 / (s2 + a * a * WO.z * WO.z);
    (k, (ALPHA * WO.truncate()).extend(WO.z).length())
}

/// Reflections at normals of the bounded cap.
fn bounded(u: [f64; 2]) -> Option<DVec3> {
    let (k, length) = bound();
    let v = (ALPHA * WO.truncate()).extend(WO.z) / length;
    // Sample the bounded spherical cap, and unstretch the half vector.
    let z = (1.0 - u[0]) * (1.0 + k * v.z) - k * v.z;
    let (sin_phi, cos_phi) = sin_cos_turns(u[1]);
    let sin = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    let h = DVec3::new(sin * cos_phi, sin * sin_phi, z) + v;
    reflected((ALPHA * h.truncate()).extend(h.z).normalize().to_array())
}

/// D(m)/(2 (k cos θₒ + t)), t the length of the stretched view: the pdf of [`bounded`].
fn pdf_bounded(wi: DVec3) -> f64 {
    let (k, length) = bound();
    facets().d(facet(wi).to_array()) / (2.0 * (k * WO.z + length))
}

/// Two random numbers for a direction, in a hemisphere where some are lost.
fn pair(draw: fn([f64; 2]) -> Option<DVec3>, pdf: fn(DVec3) -> f64) -> (impl Sampler, impl Density) {
    (direction_sampler(draw), direction_density(pdf).with_mass(Mass::AtMostOne))
}

/// A mistake in the pdf of reflections at visible normals.
fn pdf_fault(name: &'static str, wrong: fn(DVec3) -> f64) -> PlantedFault {
    PlantedFault::of(name, Directions::hemisphere(Pole::Z), move |faulty| {
        pair(visible, if faulty { wrong } else { pdf_vndf })
    })
}

pub fn faults() -> Vec<PlantedFault> {
    let half = Directions::hemisphere(Pole::Z);
    vec![
        pdf_fault("bsdf/reflection/missing-jacobian", |wi| facets().pdf_vndf(WO.to_array(), facet(wi).to_array()))
            .mistake("the normal's pdf taken for the direction's: 1/(4 wo·m) forgotten"),
        pdf_fault("bsdf/reflection/jacobian-of-the-surface", |wi| pdf_vndf(wi) * WO.dot(facet(wi)) / WO.z)
            .mistake("1/(4 wo·n) in place of 1/(4 wo·m): the surface's normal for the facet's"),
        pdf_fault("bsdf/reflection/swapped-directions", |wi| {
            0.25 * facets().d(facet(wi).to_array()) * facets().g1_over_cos(wi.to_array())
        })
        .mistake("wo and wi exchanged in the pdf, which by visible normals is not symmetric"),
        PlantedFault::of("bsdf/reflection/bounded-density", half, |faulty| {
            pair(if faulty { visible } else { bounded }, pdf_bounded)
        })
        .mistake("the pdf of bounded visible normals with samples of the unbounded ones"),
        PlantedFault::of("bsdf/reflection/drawn-again", half, |faulty| {
            let draw = move |u: &[f64]| {
                let again = || if faulty { visible([u[2], u[3]]) } else { None };
                visible([u[0], u[1]]).or_else(again).map(|w| Sample::new(w.to_array()))
            };
            (sampler(4, draw), direction_density(pdf_vndf).with_mass(Mass::AtMostOne))
        })
        .mistake("directions below the horizon sampled once more, with the pdf as it was"),
    ]
}
