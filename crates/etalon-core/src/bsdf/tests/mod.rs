//! The contract of every BSDF checked on grids, and conservation of energy.

mod anisotropy;
mod layers;
mod rough_dielectric;

use super::*;
use crate::optics::metals::GOLD;
use crate::optics::microfacet::Distribution;
use crate::scene::{Conductor as ConductorMaterial, Dielectric as DielectricMaterial, Material, ScatterModel};

const ALPHAS: [f32; 7] = [1e-4, 1e-3, 0.005, 0.05, 0.25, 0.5, 1.0];
const DEGREES: [f64; 6] = [0.0, 30.0, 60.0, 80.0, 89.0, 89.99];
const DISTRIBUTIONS: [Distribution; 2] = [Distribution::Beckmann, Distribution::Ggx];

fn gold(alpha: f32, distribution: Distribution) -> Material {
    Material::Conductor(ConductorMaterial::new(GOLD.eta_rgb(), GOLD.k_rgb(), alpha, distribution))
}

/// A metal that reflects all light but 10⁻⁸.
fn white(alpha: f32, distribution: Distribution) -> Material {
    let (eta, k) = (Rgb::splat(1.0), Rgb::splat(2e4));
    Material::Conductor(ConductorMaterial::new(eta, k, alpha, distribution))
}

fn towards(degrees: f64, phi: f64) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    glam::DVec3::new(sin * phi.cos(), sin * phi.sin(), cos).as_vec3()
}

/// Every BSDF of the list with each parameter in turn at the ends of its range, and every example; rough conductors with every
/// way to sample them.
fn all_bsdfs() -> Vec<(String, Bsdf)> {
    let mut list: Vec<(String, Bsdf)> =
        examples().into_iter().map(|example| (example.name, (example.bsdf)())).collect();
    for family in families() {
        let ends = |i: usize| {
            family.parameters[i].2.map(|end| {
                let mut values = family.defaults();
                values[i] = end;
                values
            })
        };
        let settings = (0..family.parameters.len()).flat_map(ends).chain([family.defaults()]);
        list.extend(settings.map(|values| (format!("{} {values:?}", family.name), family.with(&values))));
    }
    let with = |normals: NormalSampling| {
        let named =
            move |(name, bsdf): &(String, Bsdf)| (format!("{name} {normals:?}"), bsdf.clone().with_normals(normals));
        list.iter().filter(|(_, bsdf)| matches!(bsdf, Bsdf::Beckmann(_) | Bsdf::Ggx(_))).map(named).collect::<Vec<_>>()
    };
    let more = [NormalSampling::Ndf, NormalSampling::Hemisphere].map(with);
    list.extend(more.into_iter().flatten());
    // Other formulas of glass, mixtures with several lobes of a kind, multiple scattering sampled in other ways.
    let glass = Material::Dielectric(DielectricMaterial::clear(1.45));
    list.push(("glass".into(), glass.bsdf(ScatterModel::SECOND_REPORT)));
    // A coat of a lower index, a boundary without reflection
    list.push(("coat".into(), Bsdf::CoatedDiffuse(CoatedDiffuse::new(Rgb::new(0.2, 0.5, 1.0), 1.0 / 1.5))));
    list.push(("no boundary".into(), Bsdf::Dielectric(Dielectric::clear(1.0))));
    let mixtures = layers::mixtures().into_iter().map(|mixture| (mixture, NormalSampling::Vndf));
    let metals = NormalSampling::ALL
        .map(|normals| (Material::Conductor(layers::compensated([0.1, 0.5], Distribution::Ggx)), normals));
    let brushed = Material::Conductor(layers::compensated([0.1, 0.5], Distribution::Beckmann));
    let metals = metals.into_iter().chain([(brushed, NormalSampling::Vndf)]);
    list.extend(mixtures.chain(metals).map(|(material, normals)| {
        (format!("{material:?} {normals:?}"), material.bsdf(ScatterModel { normals, ..ScatterModel::default() }))
    }));
    list
}

#[test]
fn every_entry_of_the_registry_is_documented_and_has_families_and_examples() {
    let of_examples: Vec<&str> = examples().iter().map(|example| (example.bsdf)().name()).collect();
    for (name, doc) in ALL {
        let family = Family::named(name).unwrap();
        assert_eq!(family.with(&family.defaults()).name(), *name);
        assert!(doc.len() > 10 && of_examples.contains(name), "{name}: {doc}");
    }
    for family in families() {
        let is_inside = |&(_, value, [from, to]): &Parameter| from <= value && value <= to && from < to;
        assert!(family.parameters.iter().all(is_inside), "{}", family.name);
    }
    let names: Vec<&str> = families().map(|family| family.name).chain(ALL.iter().map(|(name, _)| *name)).collect();
    let distinct: std::collections::HashSet<&str> = names.iter().copied().collect();
    assert_eq!(distinct.len(), families().count(), "{names:?}");
}

#[test]
fn lobes_are_chosen_with_their_probabilities_and_importance_keeps_its_power() {
    for (name, bsdf) in all_bsdfs() {
        for wo in directions() {
            let all = [
                Lobe::DiffuseReflection,
                Lobe::DiffuseTransmission,
                Lobe::GlossyReflection,
                Lobe::GlossyTransmission,
                Lobe::SpecularReflection,
                Lobe::SpecularTransmission,
            ];
            let total: f32 = all.map(|lobe| bsdf.lobe_probability(wo, lobe)).iter().sum();
            let has_delta = bsdf.lobes().iter().any(|lobe| lobe.is_delta());
            assert!(total <= 1.0 + 1e-6 && (total == 0.0 || has_delta), "{name} {wo}: {total}");
            assert!(!bsdf.is_delta() || (total - 1.0).abs() < 1e-6, "{name} {wo}: {total}");
            for u in random_numbers().take(20) {
                let Some(s) = bsdf.sample(wo, u[1], u) else { continue };
                let adjoint = bsdf.sample_adjoint(wo, u[1], u).unwrap();
                // Parts of a mixture have their own η, and its weights are computed from values in the other order.
                if !matches!(bsdf, Bsdf::Mixture(_)) {
                    assert_eq!(adjoint.weight, s.weight * (s.eta * s.eta), "{name}");
                    assert!(s.lobe.is_transmission() || s.eta == 1.0, "{name}");
                }
            }
        }
    }
}

/// Random numbers in the unit square, its corners among them.
fn random_numbers() -> impl Iterator<Item = [f32; 2]> {
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
fn every_sample_satisfies_the_contract() {
    for (name, bsdf) in all_bsdfs() {
        for wo in directions() {
            for u in random_numbers() {
                let Some(s) = bsdf.sample(wo, u[1], u) else { continue };
                let case = format!("{name}, wo {wo}, u {u:?}: {s:?}");
                assert!((s.wi.length() - 1.0).abs() < 1e-6, "{case}");
                assert!(s.weight.is_finite() && s.weight.min_element() >= 0.0 && s.pdf.is_finite(), "{case}");
                let (f, pdf) = bsdf.eval_pdf(wo, s.wi);
                assert!(s.is_delta() || s.pdf.to_bits() == pdf.to_bits(), "{case}: {pdf}");
                assert_eq!(pdf.to_bits(), bsdf.pdf(wo, s.wi).to_bits(), "{case}");
                assert_eq!(f, bsdf.eval(wo, s.wi), "{case}");
                assert!(bsdf.lobes().contains(&s.lobe), "{case}");
                assert!(s.is_delta() || !bsdf.is_delta(), "{case}");
                assert_eq!(s.is_delta(), s.pdf == 0.0, "{case}");
                // The side of a direction along the surface is that of its sign, which a product with 0 does not have.
                assert!(wo.z == 0.0 || s.lobe.is_transmission() == (s.wi.z * wo.z < 0.0), "{case}");
                let probability = bsdf.lobe_probability(wo, s.lobe);
                assert!(!s.is_delta() || s.probability.to_bits() == probability.to_bits(), "{case}: {probability}");
                assert!(s.probability > 0.0 && s.probability <= 1.0, "{case}");
                // Both sides are rounded a few times, and a density below 10⁻³⁰ has lost its last bits.
                let (left, right) = if s.is_delta() { continue } else { (s.weight * s.pdf, f * s.wi.z.abs()) };
                let error = (left - right).abs().max_element();
                assert!(error <= 1e-5 * right.max_element() + 1e-30, "{case}: {left} {right}");
            }
        }
    }
}

#[test]
fn nothing_is_nan_for_any_two_directions() {
    for (name, bsdf) in all_bsdfs() {
        for wo in directions() {
            for wi in directions().into_iter().chain([-wo]) {
                let (f, pdf) = bsdf.eval_pdf(wo, wi);
                assert!(f.is_finite() && f.min_element() >= 0.0 && pdf >= 0.0 && pdf.is_finite(), "{name} {wo} {wi}");
                let below = wo.z <= 0.0 || wi.z <= 0.0;
                let is_conductor = matches!(bsdf, Bsdf::Beckmann(_) | Bsdf::Ggx(_) | Bsdf::ErrataConductor(_));
                if bsdf.is_delta() || below && is_conductor {
                    assert!(f == Rgb::ZERO && pdf == 0.0, "{name} {wo} {wi}");
                }
            }
        }
    }
}

#[test]
fn bsdfs_are_reciprocal_up_to_the_square_of_the_index() {
    // Parts of a mixture have their own η.
    let is_one = |bsdf: &Bsdf| bsdf.is_reciprocal() && !matches!(bsdf, Bsdf::Mixture(_));
    for (name, bsdf) in all_bsdfs().into_iter().filter(|(_, bsdf)| is_one(bsdf)) {
        for (u, wo) in random_numbers().flat_map(|u| directions().into_iter().map(move |wo| (u, wo))) {
            let Some(s) = bsdf.sample(wo, u[1], u).filter(|s| !s.is_delta()) else { continue };
            let (there, back) = (bsdf.eval(wo, s.wi) * (s.eta * s.eta), bsdf.eval_adjoint(wo, s.wi));
            // The exponent of D magnifies the rounding of the normal of a facet that refracts.
            let exponent = if s.lobe.is_transmission() { (1e8 / there.x).ln().max(0.0) } else { 0.0 };
            let bound = 1e-6 * (10.0 + exponent) * there.max_element();
            assert!((there - back).abs().max_element() <= bound, "{name} {wo}: {s:?} {there} {back}");
        }
    }
}

/// The share of uniform light that `bsdf` reflects, and the share of samples that carry any: means over a grid of (0,2)-points.
fn furnace(bsdf: &Bsdf, wo: Vec3) -> (f64, f64) {
    let n = 1 << 12;
    let (mut light, mut valid) = (0.0, 0.0);
    for i in 0..n {
        let u = [(f64::from(i) + 0.5) / f64::from(n), f64::from(u32::reverse_bits(i as u32)) / 2f64.powi(32)];
        if let Some(s) = bsdf.sample(wo, u[1] as f32, u.map(|u| u as f32)) {
            light += f64::from(s.weight.max_element());
            valid += 1.0;
        }
    }
    (light / f64::from(n), valid / f64::from(n))
}

#[test]
fn no_material_reflects_more_than_it_receives() {
    for alpha in ALPHAS {
        for distribution in DISTRIBUTIONS {
            for degrees in DEGREES {
                let wo = towards(degrees, 1.0);
                let [visible, all] = [NormalSampling::Vndf, NormalSampling::Ndf].map(|normals| {
                    furnace(&white(alpha, distribution).bsdf(ScatterModel { normals, ..ScatterModel::default() }), wo).0
                });
                let case = format!("{distribution:?} {alpha} at {degrees}: {visible} {all}");
                assert!(visible <= 1.0, "{case}");
                // Two quadratures of one integral; that over all normals has unbounded weights.
                assert!((visible - all).abs() < 0.01, "{case}");
                // A narrow lobe keeps all light, unless it meets the horizon.
                if alpha <= 1e-3 && degrees <= 60.0 {
                    assert!((visible - 1.0).abs() < 1e-6 && (all - 1.0).abs() < 1e-5, "{case}");
                }
            }
        }
    }
    // By hand for GGX at α = 1 from above, where D is constant: ∫ G₂/G₁ is 1 − ln 2.
    let (light, valid) = furnace(&white(1.0, Distribution::Ggx).bsdf(ScatterModel::default()), Vec3::Z);
    assert!((light - (1.0 - 2f64.ln())).abs() < 1e-6 && (valid - 0.5).abs() < 1e-6, "{light} {valid}");
}

#[test]
fn smooth_materials_lose_nothing() {
    let one = Rgb::ONE;
    let glass = Material::Dielectric(DielectricMaterial::clear(1.45));
    let model = ScatterModel::default();
    let schlick = ScatterModel { dielectric: DielectricFresnel::Schlick, ..model };
    let erroneous = ScatterModel::SECOND_REPORT;
    for wo in directions() {
        for bsdf in [glass.bsdf(model), glass.bsdf(schlick), glass.bsdf(erroneous)] {
            for i in 0..1000 {
                let Some(s) = bsdf.sample(wo, i as f32 / 1000.0, [0.5; 2]) else { panic!("glass loses light") };
                // Power, that is radiance over n², is what is conserved.
                let eta2 = if s.wi.z * wo.z >= 0.0 { 1.0 } else { 1.45f32.powi(if wo.z < 0.0 { -2 } else { 2 }) };
                assert!((s.weight.x * eta2 - 1.0).abs() < 1e-6, "{wo}: {s:?}");
            }
        }
        let s = Material::Mirror { reflectance: one }.bsdf(model).sample(wo, 0.0, [0.5; 2]).unwrap();
        assert_eq!((s.weight, s.wi), (one, Vec3::new(-wo.x, -wo.y, wo.z)));
        let diffuse = Material::Diffuse { albedo: one }.bsdf(model);
        if wo.z != 0.0 {
            assert_eq!(furnace(&diffuse, wo), (1.0, 1.0));
        }
    }
}

#[test]
fn a_slab_changes_neither_radiance_nor_direction() {
    let bsdf = Material::Refraction { transmittance: Rgb::ONE, eta: 1.45 }.bsdf(ScatterModel::default());
    // At 89.99 degrees the last bit of the direction inside decides whether it gets out.
    for degrees in &DEGREES[..5] {
        let wo = towards(*degrees, 0.3);
        let inside = bsdf.sample(wo, 0.0, [0.5; 2]).unwrap();
        // The far face looks the other way.
        let at_far_face = Vec3::new(-inside.wi.x, -inside.wi.y, inside.wi.z);
        let out = bsdf.sample(at_far_face, 0.0, [0.5; 2]).unwrap();
        assert!((inside.weight.x * out.weight.x - 1.0).abs() < 1e-6);
        assert!((inside.weight.x - 1.0 / 1.45f32.powi(2)).abs() < 1e-6);
        assert!((out.wi.truncate() + wo.truncate()).length() < 1e-6, "{degrees}: {wo} {}", out.wi);
    }
    // Beyond the critical angle, 43.6 degrees from inside, no light passes; glass reflects it.
    let wo = -towards(44.0, 0.3);
    assert_eq!(bsdf.sample(wo, 0.99, [0.5; 2]), None);
    let glass = Material::Dielectric(DielectricMaterial::clear(1.45));
    let s = glass.bsdf(ScatterModel::default()).sample(wo, 0.99, [0.5; 2]).unwrap();
    assert!(s.wi.z < 0.0 && s.weight == Rgb::ONE);
}

#[test]
fn exact_glass_reflects_as_often_as_fresnel_says() {
    let glass = Material::Dielectric(DielectricMaterial::clear(1.5));
    let bsdf = glass.bsdf(ScatterModel::default());
    for (wo, eta) in [(towards(40.0, 0.0), 1.5f32), (-towards(40.0, 0.0), 1.0 / 1.5)] {
        let f = crate::optics::dielectric::fresnel(wo.z.abs(), eta).unpolarized();
        let reflects = |uc: f32| bsdf.sample(wo, uc, [0.5; 2]).unwrap().wi.z * wo.z > 0.0;
        assert!(reflects(0.0) && reflects(f - 1e-6) && !reflects(f + 1e-6));
    }
}
