//! Mistakes in sampling microfacet normals.

use super::fault::PlantedFault;
use crate::validation::case::direction_density;
use etalon_core::errata::microfacet::normal_pdf_by_angles;
use etalon_core::math::circular::sin_cos_turns;
use etalon_core::optics::microfacet::variants::g1_rational;
use etalon_core::optics::microfacet::{Beckmann, Ggx, Microfacet};
use etalon_core::sampling::normals::SampleNormals;
use etalon_stats::{Directions, Pole, Sample, sampler};
use glam::DVec3;

const ALPHA: f64 = 0.3;

/// The view, at 60° unless said otherwise.
fn view() -> DVec3 {
    let (sin, cos) = 60f64.to_radians().sin_cos();
    DVec3::new(sin, 0.0, cos)
}

/// A mistake in the pdf of the full distribution of normals of Beckmann's distribution.
fn all(name: &'static str, wrong: fn(DVec3) -> f64) -> PlantedFault {
    PlantedFault::of(name, Directions::hemisphere(Pole::Z), move |faulty| {
        let facets = Beckmann::new(ALPHA);
        let draw = move |u: &[f64]| Some(Sample::new(facets.sample_ndf([u[0], u[1]])));
        (
            sampler(2, draw),
            direction_density(move |m: DVec3| if faulty { wrong(m) } else { facets.pdf_ndf(m.to_array()) }),
        )
    })
}

/// A mistake in the pdf of the normals visible from `wo`.
fn visible<M>(name: &'static str, facets: M, wo: DVec3, wrong: fn(&M, DVec3, DVec3) -> f64) -> PlantedFault
where
    M: SampleNormals<f64> + Send + Sync + 'static,
{
    PlantedFault::of(name, Directions::hemisphere(Pole::Z), move |faulty| {
        let draw = move |u: &[f64]| Some(Sample::new(facets.sample_vndf(wo.to_array(), [u[0], u[1]])));
        let pdf = move |m: DVec3| {
            if faulty { wrong(&facets, wo, m) } else { facets.pdf_vndf(wo.to_array(), m.to_array()) }
        };
        (sampler(2, draw), direction_density(pdf))
    })
}

/// A mistake in mapping random numbers to tan² θ and an azimuth in turns.
fn sampled(name: &'static str, wrong: fn(&[f64]) -> (f64, f64)) -> PlantedFault {
    PlantedFault::of(name, Directions::hemisphere(Pole::Z), move |faulty| {
        let draw = move |u: &[f64]| {
            let (tan2, turns) = if faulty { wrong(u) } else { (-ALPHA * ALPHA * (1.0 - u[0]).ln(), u[1]) };
            let cos = 1.0 / (1.0 + tan2).sqrt();
            let (sin, (sin_phi, cos_phi)) = (tan2.sqrt() * cos, sin_cos_turns(turns));
            Some(Sample::new([sin * cos_phi, sin * sin_phi, cos]))
        };
        (sampler(2, draw), direction_density(|m: DVec3| Beckmann::new(ALPHA).pdf_ndf(m.to_array())))
    })
}

pub fn faults() -> Vec<PlantedFault> {
    // 1/(α tan θ) = 1.34, where Walter's fit is worst.
    let theta = (1.0 / (1.34 * ALPHA)).atan();
    let worst = DVec3::new(theta.sin(), 0.0, theta.cos());
    vec![
        all("normals/missing-cosine", |m| Beckmann::new(ALPHA).d(m.to_array()))
            .mistake("D(m) taken for the pdf of normals, which is D(m) cos θ: the second report"),
        all("normals/alpha-for-roughness", |m| Beckmann::new(ALPHA * ALPHA).pdf_ndf(m.to_array()))
            .mistake("α² in the pdf where the sampler has α: one of them took α for a roughness"),
        all("normals/zero-over-zero", |m| {
            f64::from(normal_pdf_by_angles(ALPHA as f32, m.z.clamp(-1.0, 1.0).acos() as f32))
        })
        .mistake("the pdf formed as p(θ) p(φ)/sin θ, which is 0/0 for the normal of u = 0: the second report's course"),
        sampled("normals/logarithm-of-zero", |u| (-ALPHA * ALPHA * u[0].ln(), u[1]))
            .mistake("ln u instead of ln(1 − u): infinite for u = 0, which is sampled"),
        sampled("normals/half-a-turn", |u| (-ALPHA * ALPHA * (1.0 - u[0]).ln(), 0.5 * u[1]))
            .mistake("φ = π u instead of 2π u"),
        sampled("normals/slope-variance", |u| (-2.0 * ALPHA * ALPHA * (1.0 - u[0]).ln(), u[1]))
            .mistake("α taken for the standard deviation of slopes, which is α/√2"),
        visible("normals/all-for-visible", Beckmann::new(ALPHA), view(), |facets, _, m| facets.pdf_ndf(m.to_array()))
            .mistake("visible normals sampled, divided by the pdf of the full distribution"),
        visible("normals/missing-g1", Ggx::new(ALPHA), view(), |facets, wo, m| {
            facets.d(m.to_array()) * wo.dot(m).max(0.0) / wo.z
        })
        .mistake("the pdf of visible normals without the visible share G₁"),
        visible("normals/rational-shadowing", Beckmann::new(ALPHA), worst, |facets, wo, m| {
            let a = wo.z / (ALPHA * wo.truncate().length());
            facets.d(m.to_array()) * wo.dot(m).max(0.0) * g1_rational(a) / wo.z
        })
        .mistake("Walter's rational fit of G₁ in the pdf of visible normals, an error of 0.3 %: most renderers"),
        visible(
            "normals/facing-away",
            Ggx::new(1.0),
            DVec3::new(80f64.to_radians().sin(), 0.0, 80f64.to_radians().cos()),
            |facets, wo, m| facets.d(m.to_array()) * wo.dot(m).abs() * facets.g1_over_cos(wo.to_array()),
        )
        .mistake("the pdf not cut off where normals turn away from the viewer, but folded back by |wo·m|"),
    ]
}
