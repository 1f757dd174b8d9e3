//! One contract, checked on grids: what holds for every material, and what each conserves.

use super::report_model::ReportConventions;
use super::*;
use crate::optics::metals::by_name;
use crate::optics::microfacet::Distribution;
use crate::scene::{Conductor as ConductorMaterial, Material, ScatterModel};

const ALPHAS: [f32; 7] = [1e-4, 1e-3, 0.005, 0.05, 0.25, 0.5, 1.0];
const DEGREES: [f64; 6] = [0.0, 30.0, 60.0, 80.0, 89.0, 89.99];
const NORMALS: [Normals; 3] = [Normals::Visible, Normals::All, Normals::Hemisphere];
const DISTRIBUTIONS: [Distribution; 2] = [Distribution::Beckmann, Distribution::Ggx];

fn rgb(values: [f64; 3]) -> Rgb {
    Rgb::from_array(values.map(|x| x as f32))
}

fn gold(alpha: f32, distribution: Distribution) -> Material {
    let metal = by_name("Au").unwrap();
    Material::Conductor(ConductorMaterial { eta: rgb(metal.eta), k: rgb(metal.k), alpha, distribution })
}

/// A metal that reflects all light but 10⁻⁸.
#[expect(dead_code)]
fn white(alpha: f32, distribution: Distribution) -> Material {
    let (eta, k) = (Rgb::splat(1.0), Rgb::splat(2e4));
    Material::Conductor(ConductorMaterial { eta, k, alpha, distribution })
}

fn towards(degrees: f64, phi: f64) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    glam::DVec3::new(sin * phi.cos(), sin * phi.sin(), cos).as_vec3()
}

/// Every rough and every smooth material, with every way to sample it.
fn all_materials() -> Vec<(String, Bsdf)> {
    let mut list = Vec::new();
    let models = NORMALS.map(|normals| ScatterModel { normals, ..ScatterModel::default() });
    for alpha in ALPHAS {
        for distribution in DISTRIBUTIONS {
            for model in models {
                let name = format!("{distribution:?} {alpha} {:?}", model.normals);
                list.push((name, gold(alpha, distribution).bsdf(model)));
            }
        }
        let report = ScatterModel { report: ReportConventions::ALL, ..ScatterModel::default() };
        list.push((format!("report {alpha}"), gold(alpha, Distribution::Beckmann).bsdf(report)));
    }
    let (reflectance, transmittance) = (Rgb::splat(0.9), Rgb::splat(0.8));
    let plain = [
        Material::Diffuse { albedo: Rgb::new(0.2, 0.5, 1.0) },
        Material::Mirror { reflectance },
        Material::Refraction { transmittance, eta: 1.45 },
        Material::Glass { reflectance, transmittance, eta: 1.45 },
        Material::Glass { reflectance, transmittance, eta: 1.0 },
        gold(0.0, Distribution::Beckmann),
    ];
    let schlick = ScatterModel {
        dielectric: DielectricFresnel::Schlick,
        report: ReportConventions { single_cosine_schlick: true, ..ReportConventions::default() },
        ..ScatterModel::default()
    };
    for model in [ScatterModel::default(), schlick, ScatterModel { report: Default::default(), ..schlick }] {
        list.extend(plain.iter().map(|m| (format!("{m:?}"), m.bsdf(model))));
    }
    list
}

/// Numbers in the unit square, its corners among them.
fn numbers() -> impl Iterator<Item = [f32; 2]> {
    let edges = [0.0, 1e-30, 1e-7, 0.3, 0.5, 0.999, 1.0 - f32::EPSILON / 2.0];
    let corners = edges.into_iter().flat_map(move |a| edges.map(|b| [a, b]));
    corners.chain((0..200).map(|i| [(i as f32 + 0.5) / 200.0, (i as f32 * 0.618_034).fract()]))
}

fn directions() -> Vec<Vec3> {
    let mut list: Vec<Vec3> = DEGREES.iter().flat_map(|&d| [0.0, 2.0].map(|phi| towards(d, phi))).collect();
    list.extend([Vec3::X, Vec3::new(0.6, -0.8, 0.0), Vec3::new(1.0, 0.0, 1e-20), Vec3::new(0.6, 0.8, -0.0)]);
    list.extend(list.clone().into_iter().map(|w| Vec3::new(w.x, w.y, -w.z)));
    list
}

#[test]
fn every_sample_keeps_the_contract() {
    for (name, bsdf) in all_materials() {
        for wo in directions() {
            for u in numbers() {
                let Some(s) = bsdf.sample(wo, u[1], u) else { continue };
                let case = format!("{name}, wo {wo}, u {u:?}: {s:?}");
                assert!((s.wi.length() - 1.0).abs() < 1e-6, "{case}");
                assert!(s.weight.is_finite() && s.weight.min_element() >= 0.0 && s.pdf.is_finite(), "{case}");
                let (f, pdf) = bsdf.eval_pdf(wo, s.wi);
                assert_eq!(s.pdf.to_bits(), pdf.to_bits(), "{case}");
                assert_eq!(pdf.to_bits(), bsdf.pdf(wo, s.wi).to_bits(), "{case}");
                assert_eq!(f, bsdf.eval(wo, s.wi), "{case}");
                assert_eq!(s.delta, bsdf.is_delta(), "{case}");
                assert_eq!(s.delta, s.pdf == 0.0, "{case}");
                // Both sides are rounded a few times, and a density below 10⁻³⁰ has lost its last bits.
                let (left, right) = (s.weight * s.pdf, f * s.wi.z.abs());
                let error = (left - right).abs().max_element();
                assert!(error <= 1e-5 * right.max_element() + 1e-30, "{case}: {left} {right}");
            }
        }
    }
}

#[test]
fn nothing_is_nan_for_any_two_directions() {
    for (name, bsdf) in all_materials() {
        for wo in directions() {
            for wi in directions().into_iter().chain([-wo]) {
                let (f, pdf) = bsdf.eval_pdf(wo, wi);
                assert!(f.is_finite() && f.min_element() >= 0.0 && pdf >= 0.0 && pdf.is_finite(), "{name} {wo} {wi}");
                let below = wo.z <= 0.0 || wi.z <= 0.0;
                if below && !matches!(bsdf, Bsdf::Diffuse(_)) {
                    assert!(f == Rgb::ZERO && pdf == 0.0, "{name} {wo} {wi}");
                }
            }
        }
    }
}

#[test]
fn light_takes_the_same_way_back() {
    let model = ScatterModel::default();
    for alpha in ALPHAS {
        for distribution in DISTRIBUTIONS {
            let bsdf = gold(alpha, distribution).bsdf(model);
            for u in numbers() {
                for wo in directions() {
                    let Some(s) = bsdf.sample(wo, 0.0, u) else { continue };
                    let (there, back) = (bsdf.eval(wo, s.wi), bsdf.eval(s.wi, wo));
                    let error = (there - back).abs().max_element();
                    assert!(error <= 3e-6 * there.max_element(), "{alpha} {distribution:?}: {there} {back}");
                }
            }
        }
    }
}
