//! Distributions of different widths along x and y, and bounded visible normals.

use super::*;
use crate::optics::microfacet::Microfacet;
use crate::sampling::normals::SampleNormals;

/// Sums over a midpoint grid of slopes up to 10⁶ α: ∫ D cos, and ∫ D max(0, w·m).
fn projections(d: impl Microfacet<f64>, w: [f64; 3]) -> (f64, f64) {
    let (n, turns) = (1000, 720);
    let [ax, ay] = d.widths().both();
    let (low, high) = (1e-4f64.ln(), 1e5f64.ln());
    let step = (high - low) / f64::from(n);
    let (mut covered, mut seen) = (0.0, 0.0);
    for i in 0..n {
        let t = (low + (f64::from(i) + 0.5) * step).exp();
        for j in 0..turns {
            let (sin, cos) = (std::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(turns)).sin_cos();
            let (sx, sy) = (ax * t * cos, ay * t * sin);
            let z = 1.0 / (1.0 + sx * sx + sy * sy).sqrt();
            let m = [sx * z, sy * z, z];
            // dω = cos³ dsx dsy, dsx dsy = αx αy t dt dφ.
            let weight = d.d(m) * z.powi(3) * ax * ay * t * t * step * std::f64::consts::TAU / f64::from(turns);
            covered += weight * z;
            seen += weight * (m[0] * w[0] + m[1] * w[1] + m[2] * w[2]).max(0.0);
        }
    }
    (covered, seen)
}

#[test]
fn projected_facets_cover_the_surface_from_every_direction() {
    fn check<D: Microfacet<f64>>(d: D, name: &str) {
        for (degrees, phi) in [(0.0, 0.0), (50.0, 0.0), (50.0, 1.57), (80.0, 0.7)] {
            let w = towards(degrees, phi).as_dvec3().to_array();
            let (covered, seen) = projections(d, w);
            assert!((covered - 1.0).abs() < 1e-4, "{name}: {covered}");
            let seen = seen * d.g1(w) / w[2];
            assert!((seen - 1.0).abs() < 3e-4, "{name} {degrees} {phi}: {seen}");
        }
    }
    for alpha in [[0.3, 0.3], [0.05, 0.5], [1.0, 0.1]] {
        check(Beckmann::anisotropic(alpha), "Beckmann");
        check(Ggx::anisotropic(alpha), "GGX");
    }
}

#[test]
fn equal_widths_change_no_bit() {
    let (beckmann, ggx) = (Beckmann::new(0.3f32), Ggx::new(0.3f32));
    for wo in directions().into_iter().filter(|wo| wo.z > 0.0).map(|wo| wo.to_array()) {
        // The formulas without a stretch.
        let sin2 = wo[0] * wo[0] + wo[1] * wo[1];
        let az = 0.3 * wo[2];
        let root = 0.3 / (az * az + sin2);
        assert_eq!(ggx.d(wo), root * root * std::f32::consts::FRAC_1_PI);
        let slope2 = 0.3f32 * 0.3 * sin2;
        assert_eq!(ggx.cos_lambda(wo), 0.5 * slope2 / (wo[2] + (wo[2] * wo[2] + slope2).sqrt()));
        assert!(beckmann.d(wo).is_finite());
    }
}

#[test]
fn turning_widths_and_directions_by_a_quarter_changes_nothing() {
    let turned = |w: [f64; 3]| [w[1], -w[0], w[2]];
    fn values<D: SampleNormals<f64>>(d: D, w: [f64; 3], m: [f64; 3]) -> [f64; 3] {
        [d.d(m), d.g1(w), d.pdf_vndf(w, m)]
    }
    for (degrees, phi) in [(20.0, 0.3), (80.0, 2.0), (89.0, 0.1)] {
        let (w, m) = (towards(degrees, phi).as_dvec3().to_array(), towards(15.0, 1.2).as_dvec3().to_array());
        let pairs = [
            (
                values(Beckmann::anisotropic([0.1, 0.7]), w, m),
                values(Beckmann::anisotropic([0.7, 0.1]), turned(w), turned(m)),
            ),
            (values(Ggx::anisotropic([0.1, 0.7]), w, m), values(Ggx::anisotropic([0.7, 0.1]), turned(w), turned(m))),
        ];
        for (a, b) in pairs {
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-12 * a.abs()), "{a:?} {b:?}");
        }
    }
}

/// The mean weight of a white metal and the share of samples that carry light.
fn furnace_of(alpha: [f32; 2], normals: NormalSampling, wo: Vec3) -> (f64, f64) {
    let (eta, k) = (Rgb::splat(1.0), Rgb::splat(2e4));
    let metal = ConductorMaterial { alpha, ..ConductorMaterial::new(eta, k, 0.0, Distribution::Ggx) };
    furnace(&Material::Conductor(metal).bsdf(ScatterModel { normals, ..ScatterModel::default() }), wo)
}

#[test]
fn bounded_normals_reflect_the_same_light_and_waste_fewer_samples() {
    for alpha in [[0.1, 0.1], [0.5, 0.5], [1.0, 1.0], [0.3, 0.9]] {
        for degrees in [0.0, 30.0, 60.0, 85.0] {
            let wo = towards(degrees, 1.0);
            let [(all, valid_all), (bounded, valid)] =
                [NormalSampling::Vndf, NormalSampling::Bounded].map(|normals| furnace_of(alpha, normals, wo));
            assert!((all - bounded).abs() < 2e-3, "{alpha:?} {degrees}: {all} {bounded}");
            assert!(valid >= valid_all - 1e-3, "{alpha:?} {degrees}: {valid_all} {valid}");
        }
    }
    // For α = 1 from above D is constant, and every normal of the bounded cap reflects upwards.
    let (light, valid) = furnace_of([1.0; 2], NormalSampling::Bounded, Vec3::Z);
    assert!((light - (1.0 - 2f64.ln())).abs() < 1e-4 && valid > 0.999, "{light} {valid}");
}
