//! The reports' glass: Schlick's polynomial of the incident cosine, inside as outside.

use super::erratum::{ETA, Erratum, ErratumCurves, Suspect, curve, mean_by_cosine};
use crate::validation::Case;
use etalon_core::bsdf::{Dielectric, DielectricFresnel, Scatter};
use etalon_core::errata::interface::schlick_incident_cosine;
use etalon_core::math::Rgb;
use etalon_core::optics::dielectric;
use etalon_stats::{Atom, Directions, Point, Pole, Sample, density, sampler};
use glam::DVec3;

/// Angle of incidence inside the glass in degrees, below the critical angle of 43.6°.
const THETA: f64 = 40.0;

pub fn suspect() -> Suspect {
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
            let atom = |point: [f64; 3], probability| Atom::new(point, probability);
            // Exact directions and probabilities of reflection and refraction.
            let atoms = vec![
                atom([-sin, 0.0, -cos], reflected),
                atom([-sin * ETA, 0.0, truth.cos_t.unwrap_or(0.0)], 1.0 - reflected),
            ];
            (sampler(1, draw), density(|_: Point| 0.0).with_atoms(atoms))
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
