//! Multiple scattering, coated diffuse surfaces and mixtures: energy, reciprocity, values.

use super::*;
use crate::optics::dielectric;

/// Gold with multiple scattering.
pub fn compensated(alpha: [f32; 2], distribution: Distribution) -> ConductorMaterial {
    let metal = ConductorMaterial::new(GOLD.eta_rgb(), GOLD.k_rgb(), 0.0, distribution);
    ConductorMaterial { alpha, multiple_scattering: true, ..metal }
}

fn coated(albedo: Rgb, eta: f32) -> Material {
    Material::from(Bsdf::CoatedDiffuse(CoatedDiffuse::new(albedo, eta)))
}

pub fn mixtures() -> Vec<Material> {
    let diffuse = Material::Diffuse { albedo: Rgb::new(0.2, 0.5, 1.0) };
    let metal = gold(0.2, Distribution::Ggx);
    let [fine, coarse] = [(1.5, 0.1), (2.0, 0.5)]
        .map(|(eta, alpha)| Material::Dielectric(DielectricMaterial::rough(eta, alpha, Distribution::Beckmann)));
    let glass = Material::Dielectric(DielectricMaterial::clear(1.5));
    let mirror = Material::Mirror { reflectance: Rgb::splat(0.9) };
    let mix = |parts: &[(f32, &Material)]| {
        Material::Mixture(parts.iter().map(|(weight, part)| (*weight, (*part).clone())).collect())
    };
    let nested = mix(&[(0.5, &diffuse), (0.5, &metal)]);
    vec![
        mix(&[(0.3, &diffuse), (0.7, &metal)]),
        mix(&[(0.5, &fine), (0.4, &coarse)]),
        mix(&[(0.25, &glass), (0.75, &diffuse)]),
        mix(&[(0.5, &mirror), (0.5, &metal), (0.0, &diffuse)]),
        mix(&[(0.6, &nested), (0.3, &mirror)]),
        mix(&[(1.0, &glass)]),
    ]
}

/// ∫ f |cos θᵢ| dωᵢ by the midpoint rule on the two hemispheres, by the cosine.
fn albedo_of_values(bsdf: &Bsdf, wo: Vec3) -> f64 {
    let n = 300u32;
    let mut sum = 0.0;
    for i in 0..n * n {
        let u = [i / n, i % n].map(|j| (f64::from(j) + 0.5) / f64::from(n));
        let wi = crate::sampling::warp::cosine_hemisphere(u).as_vec3();
        sum += f64::from((bsdf.eval(wo, wi) + bsdf.eval(wo, -wi)).x) * std::f64::consts::PI;
    }
    sum / f64::from(n * n)
}

#[test]
fn a_lossless_metal_with_multiple_scattering_reflects_everything() {
    let (eta, k) = (Rgb::splat(1.0), Rgb::splat(1e6));
    for distribution in DISTRIBUTIONS {
        for alpha in [[1e-3; 2], [0.1; 2], [0.5; 2], [1.0; 2], [0.1, 0.7]] {
            let metal = ConductorMaterial::new(eta, k, 0.0, distribution);
            let metal = ConductorMaterial { alpha, multiple_scattering: true, ..metal };
            for normals in [NormalSampling::Vndf, NormalSampling::Bounded] {
                let bsdf = Material::Conductor(metal).bsdf(ScatterModel { normals, ..ScatterModel::default() });
                for degrees in DEGREES {
                    // The lobe of an almost smooth metal is narrow at the horizon, which samples by the cosine rarely find.
                    if alpha[0] < 0.01 && degrees > 89.0 {
                        continue;
                    }
                    let wo = towards(degrees, 0.7);
                    let n = 1 << 14;
                    let mut light = 0.0;
                    for i in 0..n {
                        let u = [
                            f64::from(u32::reverse_bits(i as u32)) / 2f64.powi(32),
                            (f64::from(i) * 0.618_033_988_7).fract(),
                        ];
                        let uc = (f64::from(i) * 0.754_877_666).fract();
                        let sample = bsdf.sample(wo, uc as f32, u.map(|u| u as f32));
                        light += sample.map_or(0.0, |s| f64::from(s.weight.x)) / f64::from(n);
                    }
                    // The table's error, and that of this quadrature, whose weights are not constant.
                    assert!((light - 1.0).abs() < 4e-3, "{distribution:?} {alpha:?} {degrees}: {light}");
                }
            }
        }
    }
}

#[test]
fn a_coat_on_white_absorbs_nothing() {
    for eta in [1.0f32, 1.3, 1.5, 2.4] {
        let bsdf = coated(Rgb::ONE, eta).bsdf(ScatterModel::default());
        for degrees in [0.0, 50.0, 80.0] {
            for wo in [towards(degrees, 0.3), -towards(degrees, 0.3)] {
                let mirrored = f64::from(dielectric::fresnel(wo.z.abs(), eta).unpolarized());
                let light = albedo_of_values(&bsdf, wo) + mirrored;
                assert!((light - 1.0).abs() < 1e-4, "{eta} {degrees}: {light}");
            }
        }
    }
}

#[test]
fn a_coat_has_the_value_of_the_series() {
    // Light of a unit of flux inside: reflected by the base, sent back by the boundary, and so on, in f64.
    let (eta, rho) = (1.5f64, 0.5f64);
    let n = 200_000;
    let mean: f64 = (0..n)
        .map(|i| {
            let cos = (f64::from(i) + 0.5) / f64::from(n);
            dielectric::fresnel(cos, 1.0 / eta).unpolarized() * 2.0 * cos / f64::from(n)
        })
        .sum();
    let (wo, wi) = (towards(20.0, 0.0), towards(65.0, 2.0));
    let passes = |w: Vec3| 1.0 - dielectric::fresnel(f64::from(w.z), eta).unpolarized();
    let series: f64 = (0..60).map(|k| rho * (rho * mean).powi(k)).sum();
    let expected = passes(wo) * passes(wi) * series / (std::f64::consts::PI * eta * eta);
    let bsdf = coated(Rgb::splat(rho as f32), eta as f32).bsdf(ScatterModel::default());
    let f = f64::from(bsdf.eval(wo, wi).x);
    assert!((f / expected - 1.0).abs() < 1e-5, "{f} {expected}");
}

#[test]
fn a_mixture_is_the_weighted_sum_of_its_parts() {
    let diffuse = Material::Diffuse { albedo: Rgb::splat(0.4) };
    let metal = gold(0.3, Distribution::Beckmann);
    let model = ScatterModel::default();
    let mixture = Material::Mixture([(0.3, diffuse.clone()), (0.6, metal.clone())].into_iter().collect()).bsdf(model);
    let (diffuse, metal) = (diffuse.bsdf(model), metal.bsdf(model));
    let (wo, wi) = (towards(30.0, 0.0), towards(50.0, 2.5));
    let (f, pdf) = mixture.eval_pdf(wo, wi);
    let expected = diffuse.eval(wo, wi) * 0.3 + metal.eval(wo, wi) * 0.6;
    assert!((f - expected).abs().max_element() < 1e-6);
    assert!((pdf - (diffuse.pdf(wo, wi) / 3.0 + metal.pdf(wo, wi) * (2.0 / 3.0))).abs() < 1e-6);
    // Lobes keep the probabilities with which they are chosen.
    let glass = Material::Dielectric(DielectricMaterial::clear(1.5));
    let parts = [(0.5, Material::Mirror { reflectance: Rgb::ONE }), (0.5, glass.clone())];
    let twice = Material::Mixture(parts.into_iter().collect()).bsdf(model);
    assert!(!twice.is_reciprocal() && twice.is_delta());
    assert!(mixture.is_reciprocal() && !mixture.is_delta());
    // Nothing is left of an empty sum.
    assert_eq!(Bsdf::Mixture(Mixture::new([])).sample(wo, 0.5, [0.5; 2]), None);
}

#[test]
fn a_mixture_of_indices_has_the_adjoint_of_its_parts() {
    let bsdf = mixtures()[1].bsdf(ScatterModel::default());
    let wo = towards(30.0, 0.4);
    for u in random_numbers() {
        let Some(s) = bsdf.sample_adjoint(wo, u[0], u) else { continue };
        let expected = bsdf.eval_adjoint(wo, s.wi) * s.wi.z.abs();
        assert!((s.weight * s.pdf - expected).abs().max_element() <= 1e-5 * expected.max_element() + 1e-30);
    }
}
