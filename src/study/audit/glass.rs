//! The reports' glass: Schlick's polynomial of the incident cosine, inside as outside, and the radiance that is refracted.

use super::erratum::{ETA, Erratum, ErratumCurves, Suspect, at_all_angles, curve, mean_by_cosine};
use crate::bsdf::{Dielectric, DielectricFresnel, Scatter};
use crate::errata::fresnel::schlick_incident_cosine;
use crate::errata::refraction::refracted_radiance_over_square;
use crate::math::Rgb;
use crate::optics::dielectric;
use crate::study::validation::Case;
use etalon_stats::{Atom, Directions, Pole, Sample, density, sampler};
use glam::DVec3;

/// Angle of incidence inside the glass in degrees, below the critical angle of 43.6°.
const THETA: f64 = 40.0;

pub fn suspects() -> Vec<Suspect> {
    vec![one_cosine(), radiance()]
}

fn one_cosine() -> Suspect {
    let (sin, cos) = THETA.to_radians().sin_cos();
    let case = |name: &str, printed: bool| {
        Case::of(format!("audit/glass/{name}"), Directions::sphere(Pole::Z), move || {
            let (reflectance, transmittance, eta) = (Rgb::ONE, Rgb::ONE, ETA as f32);
            let fresnel = if printed { DielectricFresnel::SingleCosineSchlick } else { DielectricFresnel::Exact };
            let glass = Dielectric { reflectance, transmittance, eta, fresnel };
            let wo = DVec3::new(sin, 0.0, -cos).as_vec3();
            let draw = move |u: &[f64]| {
                glass.sample(wo, u[0] as f32, [0.5; 2]).map(|sample| Sample::atom(sample.wi.as_dvec3().to_array()))
            };
            let truth = dielectric::fresnel(cos, 1.0 / ETA);
            let reflected = truth.unpolarized();
            let atom = |point: [f64; 3], probability| Atom { point, probability };
            // Exact directions and probabilities of reflection and refraction.
            let atoms = vec![
                atom([-sin, 0.0, -cos], reflected),
                atom([-sin * ETA, 0.0, truth.cos_t.unwrap_or(0.0)], 1.0 - reflected),
            ];
            (sampler(1, draw), density(|_| 0.0).with_atoms(atoms))
        })
    };
    let printed = |cos: f64| schlick_incident_cosine(cos, 1.0 / ETA);
    let right = |cos: f64| dielectric::fresnel(cos, 1.0 / ETA).unpolarized();
    let erratum = Erratum {
        title: "Schlick's cosine inside glass",
        report: "both reports",
        printed: "F₀ + (1 − F₀)(1 − cos θᵢ)⁵ on both sides",
        right: "Fresnel's equations; Schlick's cosine is that on the less dense side",
        test: "chi-square of reflected and refracted directions from inside at 40°",
        error_in_picture: mean_by_cosine(|cos| {
            if dielectric::eta_cos_t(cos, 1.0 / ETA).is_some() { printed(cos) } else { 1.0 }
        }) / mean_by_cosine(right)
            - 1.0,
        error_of: "light reflected inside",
        curves: ErratumCurves {
            x: "/{θ} inside (degrees)",
            every: 30.0,
            y: "reflectance",
            printed: curve(0.0, 90.0, |a| printed(a.to_radians().cos())),
            right: curve(0.0, 90.0, |a| right(a.to_radians().cos())),
            scattered: false,
        },
        ..Erratum::default()
    };
    (erratum, [case("printed", true), case("right", false)])
}

/// Radiance that is refracted: the flux in a beam stays, and the beam's étendue changes by η².
fn radiance() -> Suspect {
    let right = |transmitted: f64, eta: f64| transmitted * eta * eta;
    let printed = refracted_radiance_over_square;
    // Reflected and refracted flux over the incident one: that of the refracted beam is its radiance over η².
    let lost = |refracted: fn(f64, f64) -> f64| {
        move |cos: f64, eta: f64| {
            let fresnel = dielectric::fresnel(cos, eta);
            (fresnel.unpolarized() + refracted(fresnel.transmittance(), eta) / (eta * eta) - 1.0).abs()
        }
    };
    let entering = |refracted: fn(f64, f64) -> f64| {
        curve(0.0, 90.0, |a| refracted(dielectric::fresnel(a.to_radians().cos(), ETA).transmittance(), ETA))
    };
    let erratum = Erratum {
        title: "radiance over n²",
        report: "second report",
        printed: "T(1 − r²)/(nᵣ² (eᵢ·n)), nᵣ = index of eᵣ over that of eᵢ",
        right: "T(1 − r²) nᵣ²/(eᵢ·n)",
        test: "reflected and refracted flux against the incident one, at every angle from both sides",
        error_in_picture: printed(1.0, 1.0 / ETA) / right(1.0, 1.0 / ETA) - 1.0,
        error_of: "light inside glass, seen from outside",
        curves: ErratumCurves {
            x: "/{θ} outside (degrees)",
            every: 30.0,
            y: "radiance into glass",
            printed: entering(printed),
            right: entering(right),
            scattered: false,
        },
        ..Erratum::default()
    };
    let what = "of the incident flux, lost or added:";
    let case = |name: &str, refracted| at_all_angles(name, what, lost(refracted));
    (erratum, [case("radiance/printed", printed), case("radiance/right", right)])
}
