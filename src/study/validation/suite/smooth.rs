//! Materials that scatter into one or two directions: mirrors, polished metal, refraction, glass from both sides.
//!
//! Directions and probabilities are computed here from the laws of reflection, Snell and Fresnel, in f64 and in their
//! textbook form, independently of the materials' code.

use super::super::case::Case;
use super::inputs::{short, towards};
use crate::bsdf::{Bsdf, Scatter};
use crate::math::Rgb;
use crate::optics::microfacet::Distribution;
use crate::sampling::direction_density;
use crate::scene::{Conductor, Material, ScatterModel};
use etalon_stats::{Atom, Directions, Mass, Pole, Sample, sampler};
use glam::{DVec3, Vec3};

/// The glass of the tests, and angles through its critical one of 41.81 degrees inside.
const ETA: f64 = 1.5;
const INSIDE: [f64; 7] = [0.0, 20.0, 35.0, 41.0, 41.7, 42.0, 80.0];
const OUTSIDE: [f64; 5] = [0.0, 30.0, 60.0, 85.0, 89.9];

/// The cases, each with its BSDF's name in the registry.
pub fn cases() -> Vec<(&'static str, Case)> {
    let model = ScatterModel::default();
    let one = Rgb::ONE;
    let mirror = Material::Mirror { reflectance: one }.bsdf(model);
    let (k, distribution) = (Rgb::splat(3.0), Distribution::Beckmann);
    let polished = Conductor { eta: one, k, alpha: 0.0, distribution, two_sided: false };
    let polished = Material::Conductor(polished).bsdf(model);
    let glass = Material::Glass { reflectance: one, transmittance: one, eta: ETA as f32 }.bsdf(model);
    let refraction = Material::Refraction { transmittance: one, eta: ETA as f32 }.bsdf(model);
    let mut cases = vec![
        case("bsdf/mirror/outside".into(), mirror, towards(60.0), |wo| vec![reflected(wo, 1.0)]),
        case("bsdf/mirror/inside".into(), mirror, -towards(60.0), |wo| vec![reflected(wo, 1.0)]),
        case("bsdf/polished-metal".into(), polished, towards(60.0), |wo| vec![reflected(wo, 1.0)]),
    ];
    let outside = OUTSIDE.map(|degrees| ("outside", degrees, towards(degrees)));
    let inside = INSIDE.map(|degrees| ("inside", degrees, -towards(degrees)));
    for (side, degrees, wo) in outside.into_iter().chain(inside) {
        cases.push(case(format!("bsdf/glass/{side}/{degrees}"), glass, wo, |wo| {
            let r = fresnel(wo);
            let passing = refracted(wo).map(|wt| Atom { point: wt.to_array(), probability: 1.0 - r });
            [reflected(wo, r)].into_iter().chain(passing).collect()
        }));
        // Beyond the critical angle there must be no samples.
        cases.push(case(format!("bsdf/refraction/{side}/{degrees}"), refraction, wo, |wo| {
            refracted(wo).map(|wt| Atom { point: wt.to_array(), probability: 1.0 }).into_iter().collect()
        }));
    }
    cases
}

fn reflected(wo: DVec3, probability: f64) -> Atom<[f64; 3]> {
    Atom { point: [-wo.x, -wo.y, wo.z], probability }
}

/// Index of refraction of the far side over that of `wo`'s.
fn eta_from(wo: DVec3) -> f64 {
    if wo.z < 0.0 { 1.0 / ETA } else { ETA }
}

/// By Snell's law; `None` beyond the critical angle.
fn refracted(wo: DVec3) -> Option<DVec3> {
    let eta = eta_from(wo);
    let sin = wo.x.hypot(wo.y) / eta;
    (sin < 1.0).then(|| DVec3::new(-wo.x / eta, -wo.y / eta, (1.0 - sin * sin).sqrt().copysign(-wo.z)))
}

/// The mean of r∥² and r⊥² by Fresnel's equations.
fn fresnel(wo: DVec3) -> f64 {
    let Some(wt) = refracted(wo) else { return 1.0 };
    let (eta, cos, cos_t) = (eta_from(wo), wo.z.abs(), wt.z.abs());
    let parallel = (eta * cos - cos_t) / (eta * cos + cos_t);
    let perpendicular = (cos - eta * cos_t) / (cos + eta * cos_t);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// The directions that `bsdf` samples for `wo`: must be the `atoms` for the direction rounded to f32.
fn case(name: String, bsdf: Bsdf, wo: DVec3, atoms: fn(DVec3) -> Vec<Atom<[f64; 3]>>) -> (&'static str, Case) {
    let wo: Vec3 = wo.as_vec3();
    let case = Case::of(name, Directions::sphere(Pole::Z), move || {
        let draw = move |u: &[f64]| {
            let sample = bsdf.sample(wo, short(u[0]), [short(u[1]), short(u[2])])?;
            Some(Sample { atom: sample.is_delta(), ..Sample::new(sample.wi.as_dvec3().to_array()) })
        };
        let pdf = move |wi: DVec3| f64::from(bsdf.pdf(wo, wi.as_vec3()));
        let atoms = atoms(wo.as_dvec3());
        let mass = atoms.iter().map(|atom| atom.probability).sum();
        (sampler(3, draw), direction_density(pdf).with_mass(Mass::Exactly(mass)).with_atoms(atoms))
    });
    (bsdf.name(), case)
}
