//! Mistakes at surfaces: in sampling microfacet normals, in what they reflect, and at a smooth boundary of glass.

use super::super::case::{direction_density, direction_sampler};
use super::fault::PlantedFault;
use etalon_core::errata::interface::schlick_incident_cosine;
use etalon_core::errata::microfacet::normal_pdf_by_angles;
use etalon_core::math::circular::sin_cos_turns;
use etalon_core::optics::dielectric;
use etalon_core::optics::microfacet::smith::g1_rational;
use etalon_core::optics::microfacet::{Beckmann, Ggx, Microfacet};
use etalon_core::sampling::normals::SampleNormals;
use etalon_stats::{Atom, Density, Directions, Mass, Point, Pole, Sample, Sampler, density, sampler};
use glam::DVec3;

const ALPHA: f64 = 0.3;

/// The view of the tests of normals, at 60°.
fn view() -> DVec3 {
    let (sin, cos) = 60f64.to_radians().sin_cos();
    DVec3::new(sin, 0.0, cos)
}

/// A mistake in the pdf of the full distribution of normals of Beckmann's distribution.
fn ndf_pdf(name: &'static str, wrong: fn(DVec3) -> f64) -> PlantedFault {
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
fn vndf_pdf<M>(name: &'static str, facets: M, wo: DVec3, wrong: fn(&M, DVec3, DVec3) -> f64) -> PlantedFault
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
fn ndf_sampling(name: &'static str, wrong: fn(&[f64]) -> (f64, f64)) -> PlantedFault {
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

pub fn normals() -> Vec<PlantedFault> {
    // 1/(α tan θ) = 1.34, where Walter's fit is worst.
    let theta = (1.0 / (1.34 * ALPHA)).atan();
    let worst = DVec3::new(theta.sin(), 0.0, theta.cos());
    vec![
        ndf_pdf("normals/missing-cosine", |m| Beckmann::new(ALPHA).d(m.to_array()))
            .mistake("D(m) taken for the pdf of normals, which is D(m) cos θ: the second report"),
        ndf_pdf("normals/alpha-for-roughness", |m| Beckmann::new(ALPHA * ALPHA).pdf_ndf(m.to_array()))
            .mistake("α² in the pdf where the sampler has α: one of them took α for a roughness"),
        ndf_pdf("normals/zero-over-zero", |m| {
            f64::from(normal_pdf_by_angles(ALPHA as f32, m.z.clamp(-1.0, 1.0).acos() as f32))
        })
        .mistake("the pdf formed as p(θ) p(φ)/sin θ, which is 0/0 for the normal of u = 0: the second report's course"),
        ndf_sampling("normals/logarithm-of-zero", |u| (-ALPHA * ALPHA * u[0].ln(), u[1]))
            .mistake("ln u instead of ln(1 − u): infinite for u = 0, which is sampled"),
        ndf_sampling("normals/half-a-turn", |u| (-ALPHA * ALPHA * (1.0 - u[0]).ln(), 0.5 * u[1]))
            .mistake("φ = π u instead of 2π u"),
        ndf_sampling("normals/slope-variance", |u| (-2.0 * ALPHA * ALPHA * (1.0 - u[0]).ln(), u[1]))
            .mistake("α taken for the standard deviation of slopes, which is α/√2"),
        vndf_pdf("normals/all-for-visible", Beckmann::new(ALPHA), view(), |facets, _, m| facets.pdf_ndf(m.to_array()))
            .mistake("visible normals sampled, divided by the pdf of the full distribution"),
        vndf_pdf("normals/missing-g1", Ggx::new(ALPHA), view(), |facets, wo, m| {
            facets.d(m.to_array()) * wo.dot(m).max(0.0) / wo.z
        })
        .mistake("the pdf of visible normals without the visible share G₁"),
        vndf_pdf("normals/rational-shadowing", Beckmann::new(ALPHA), worst, |facets, wo, m| {
            let a = wo.z / (ALPHA * wo.truncate().length());
            facets.d(m.to_array()) * wo.dot(m).max(0.0) * g1_rational(a) / wo.z
        })
        .mistake("Walter's rational fit of G₁ in the pdf of visible normals, an error of 0.3 %: most renderers"),
        vndf_pdf(
            "normals/facing-away",
            Ggx::new(1.0),
            DVec3::new(80f64.to_radians().sin(), 0.0, 80f64.to_radians().cos()),
            |facets, wo, m| facets.d(m.to_array()) * wo.dot(m).abs() * facets.g1_over_cos(wo.to_array()),
        )
        .mistake("the pdf not cut off where normals turn away from the viewer, but folded back by |wo·m|"),
    ]
}

/// A rough surface, of which many reflections end below the horizon.
const REFLECTING_ALPHA: f64 = 0.8;

fn facets() -> Ggx<f64> {
    Ggx::new(REFLECTING_ALPHA)
}

/// The view of the tests of reflection, at 45°.
const WO: DVec3 = DVec3::new(std::f64::consts::FRAC_1_SQRT_2, 0.0, std::f64::consts::FRAC_1_SQRT_2);

/// `WO` reflected at the facet, if the direction leaves the surface.
fn reflected(m: [f64; 3]) -> Option<DVec3> {
    let m = DVec3::from_array(m);
    let wi = 2.0 * WO.dot(m) * m - WO;
    (wi.z > 0.0).then_some(wi)
}

fn reflected_at_visible(u: [f64; 2]) -> Option<DVec3> {
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
    let a = REFLECTING_ALPHA.min(1.0);
    let s2 = (1.0 + WO.truncate().length()).powi(2);
    let k = (1.0 - a * a) * s2 / (s2 + a * a * WO.z * WO.z);
    (k, (REFLECTING_ALPHA * WO.truncate()).extend(WO.z).length())
}

/// Reflections at normals of the bounded cap.
fn bounded(u: [f64; 2]) -> Option<DVec3> {
    let (k, length) = bound();
    let v = (REFLECTING_ALPHA * WO.truncate()).extend(WO.z) / length;
    // Sample the bounded spherical cap, and unstretch the half vector.
    let z = (1.0 - u[0]) * (1.0 + k * v.z) - k * v.z;
    let (sin_phi, cos_phi) = sin_cos_turns(u[1]);
    let sin = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    let h = DVec3::new(sin * cos_phi, sin * sin_phi, z) + v;
    reflected((REFLECTING_ALPHA * h.truncate()).extend(h.z).normalize().to_array())
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
fn reflection_pdf(name: &'static str, wrong: fn(DVec3) -> f64) -> PlantedFault {
    PlantedFault::of(name, Directions::hemisphere(Pole::Z), move |faulty| {
        pair(reflected_at_visible, if faulty { wrong } else { pdf_vndf })
    })
}

pub fn reflection() -> Vec<PlantedFault> {
    let half = Directions::hemisphere(Pole::Z);
    vec![
        reflection_pdf("bsdf/reflection/missing-jacobian", |wi| facets().pdf_vndf(WO.to_array(), facet(wi).to_array()))
            .mistake("the normal's pdf taken for the direction's: 1/(4 wo·m) forgotten"),
        reflection_pdf("bsdf/reflection/jacobian-of-the-surface", |wi| pdf_vndf(wi) * WO.dot(facet(wi)) / WO.z)
            .mistake("1/(4 wo·n) in place of 1/(4 wo·m): the surface's normal for the facet's"),
        reflection_pdf("bsdf/reflection/swapped-directions", |wi| {
            0.25 * facets().d(facet(wi).to_array()) * facets().g1_over_cos(wi.to_array())
        })
        .mistake("wo and wi exchanged in the pdf, which by visible normals is not symmetric"),
        PlantedFault::of("bsdf/reflection/bounded-density", half, |faulty| {
            pair(if faulty { reflected_at_visible } else { bounded }, pdf_bounded)
        })
        .mistake("the pdf of bounded visible normals with samples of the unbounded ones"),
        PlantedFault::of("bsdf/reflection/drawn-again", half, |faulty| {
            let draw = move |u: &[f64]| {
                let again = || if faulty { reflected_at_visible([u[2], u[3]]) } else { None };
                reflected_at_visible([u[0], u[1]]).or_else(again).map(|w| Sample::new(w.to_array()))
            };
            (sampler(4, draw), direction_density(pdf_vndf).with_mass(Mass::AtMostOne))
        })
        .mistake("directions below the horizon sampled once more, with the pdf as it was"),
    ]
}

const ETA: f64 = 1.5;

/// What happens to light at the boundary.
#[derive(Clone, Copy)]
struct Boundary {
    /// Directions towards the viewer, and where light is reflected and refracted from.
    reflected: DVec3,
    refracted: DVec3,
    /// Probability of reflection.
    share: f64,
}

impl Boundary {
    /// The truth for a viewer at that angle, inside the glass or outside, on the side z > 0, below the critical angle.
    fn at(degrees: f64, eta: f64) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let cos_t = dielectric::eta_cos_t(cos, eta).map_or(0.0, |g| g / eta);
        Self {
            reflected: DVec3::new(-sin, 0.0, cos),
            refracted: DVec3::new(-sin / eta, 0.0, -cos_t),
            share: dielectric::fresnel(cos, eta).unpolarized(),
        }
    }

    /// Samples by `self`, tested against `truth`.
    fn against(self, truth: Self) -> (impl Sampler, impl Density) {
        let draw = move |u: &[f64]| {
            Some(Sample::atom((if u[0] < self.share { self.reflected } else { self.refracted }).to_array()))
        };
        let atom = |point: DVec3, probability| Atom::new(point.to_array(), probability);
        let atoms = vec![atom(truth.reflected, truth.share), atom(truth.refracted, 1.0 - truth.share)];
        (sampler(1, draw), density(|_: Point| 0.0).with_atoms(atoms))
    }
}

fn boundary(name: &'static str, degrees: f64, eta: f64, spoil: fn(&mut Boundary)) -> PlantedFault {
    PlantedFault::of(name, Directions::sphere(Pole::Z), move |faulty| {
        let truth = Boundary::at(degrees, eta);
        let mut boundary = truth;
        if faulty {
            spoil(&mut boundary);
        }
        boundary.against(truth)
    })
}

pub fn glass() -> Vec<PlantedFault> {
    vec![
        boundary("bsdf/glass/incident-cosine", 40.0, 1.0 / ETA, |boundary| {
            boundary.share = schlick_incident_cosine(40f64.to_radians().cos(), 1.0 / ETA)
        })
        .mistake(
            "Schlick's polynomial of the incident cosine also inside the glass, 0.04 for 0.25 at 40°: both reports",
        ),
        boundary("bsdf/glass/schlick-for-fresnel", 85.0, ETA, |boundary| {
            boundary.share = dielectric::schlick(85f64.to_radians().cos(), ETA)
        })
        .mistake("Schlick's approximation as the probability of reflection, weighed as if by Fresnel's equations"),
        boundary("bsdf/glass/total-reflection-outside", 60.0, ETA, |boundary| boundary.share = 1.0)
            .mistake("the critical angle looked for on the wrong side: light that enters is totally reflected"),
        boundary("bsdf/glass/inverted-index", 30.0, ETA, |boundary| {
            boundary.refracted = Boundary::at(30.0, 1.0 / ETA).refracted
        })
        .mistake("refraction by η where it should be 1/η: the side of the ray mistaken"),
        boundary("bsdf/glass/exchanged", 30.0, ETA, |boundary| {
            boundary.share = 1.0 - boundary.share;
        })
        .mistake("refraction chosen as often as light is reflected"),
    ]
}
