//! Rough dielectrics: values by the published formulas, reciprocity, energy, limits.

use super::*;
use glam::DVec3;

const ETAS: [f32; 5] = [1.0 / 2.4, 1.0 / 1.5, 1.01, 1.5, 2.4];

fn boundary(alpha: [f32; 2], eta: f32, distribution: Distribution) -> Bsdf {
    let material = DielectricMaterial { alpha, ..DielectricMaterial::rough(eta, 0.0, distribution) };
    Material::Dielectric(material).bsdf(ScatterModel::default())
}

/// Directions on both sides, not at the horizon.
fn views() -> Vec<Vec3> {
    DEGREES.iter().flat_map(|&degrees| [towards(degrees, 0.5), -towards(degrees, 2.0)]).collect()
}

/// The reflected share by Fresnel's equations as books print them, at a cosine of either sign.
fn fresnel(cos: f64, eta: f64) -> f64 {
    let cos_t2 = 1.0 - (1.0 - cos * cos) / (eta * eta);
    if cos_t2 <= 0.0 {
        return 1.0;
    }
    let (c, t) = (cos.abs(), cos_t2.sqrt());
    let parallel = (eta * c - t) / (eta * c + t);
    let perpendicular = (c - eta * t) / (c + eta * t);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// D, and the Λ of a direction, by their published formulas in slopes.
fn facets(alpha: [f64; 2], distribution: Distribution, m: DVec3) -> f64 {
    let slope2 = (m.x / (alpha[0] * m.z)).powi(2) + (m.y / (alpha[1] * m.z)).powi(2);
    let scale = std::f64::consts::PI * alpha[0] * alpha[1] * m.z.powi(4);
    match distribution {
        Distribution::Beckmann => (-slope2).exp() / scale,
        Distribution::Ggx => 1.0 / (scale * (1.0 + slope2).powi(2)),
    }
}

fn lambda(alpha: [f64; 2], distribution: Distribution, w: DVec3) -> f64 {
    let a = w.z.abs() / (alpha[0] * w.x).hypot(alpha[1] * w.y);
    match distribution {
        Distribution::Beckmann => 0.5 * ((-a * a).exp() / (a * std::f64::consts::PI.sqrt()) - libm::erfc(a)),
        Distribution::Ggx => 0.5 * ((1.0 + 1.0 / (a * a)).sqrt() - 1.0),
    }
}

/// f and the pdf by the formulas of Walter et al., 2007.
fn walter(alpha: [f64; 2], eta: f64, distribution: Distribution, o: DVec3, i: DVec3) -> (f64, f64) {
    let (ni, no) = if o.z > 0.0 { (eta, 1.0) } else { (1.0, eta) };
    let reflects = o.z * i.z > 0.0;
    let h = if reflects { o + i } else { -(no * o + ni * i) };
    let m = h.normalize() * h.z.signum();
    let (om, im) = (o.dot(m), i.dot(m));
    // The facet must be visible from the side of the surface that each direction is on.
    if om * o.z <= 0.0 || im * i.z <= 0.0 {
        return (0.0, 0.0);
    }
    let f = fresnel(om, ni / no);
    let [lo, li] = [o, i].map(|w| lambda(alpha, distribution, w));
    let d = facets(alpha, distribution, m);
    let visible = d * om.abs() / (o.z.abs() * (1.0 + lo));
    let g = 1.0 / ((1.0 + lo) * (1.0 + li));
    if reflects {
        (f * d * g / (4.0 * o.z * i.z).abs(), f * visible / (4.0 * om.abs()))
    } else {
        let jacobian = ni * ni * im.abs() / (no * om + ni * im).powi(2);
        // Their f is that of basic radiance L/n²: ours is of radiance.
        let value = (om * im / (o.z * i.z)).abs() * no * no * (1.0 - f) * g * d / (no * om + ni * im).powi(2);
        (value, (1.0 - f) * visible * jacobian)
    }
}

#[test]
fn values_are_those_of_the_published_formulas() {
    for distribution in DISTRIBUTIONS {
        for alpha in [[0.05f32; 2], [0.25; 2], [1.0; 2], [0.1, 0.6], [0.8, 0.02]] {
            for eta in ETAS {
                let bsdf = boundary(alpha, eta, distribution);
                for wo in views() {
                    for u in random_numbers().skip(49) {
                        let Some(s) = bsdf.sample(wo, u[1], u) else { continue };
                        let unit = |w: Vec3| w.as_dvec3().normalize();
                        let (f, pdf) = bsdf.eval_pdf(wo, s.wi);
                        let wide = alpha.map(f64::from);
                        let expected = walter(wide, f64::from(eta), distribution, unit(wo), unit(s.wi));
                        // What rounding the sine of a grazing direction, and the half vector of a small deviation, leave.
                        let error =
                            ((f64::from(f.x) / expected.0 - 1.0).abs()).max((f64::from(pdf) / expected.1 - 1.0).abs());
                        assert!(
                            error < 2e-4 || expected.0 < 1e-25,
                            "{distribution:?} {alpha:?} {eta}, {wo} {}: {} {pdf}, {expected:?}",
                            s.wi,
                            f.x
                        );
                    }
                }
            }
        }
    }
}

/// The mean power that is scattered.
fn power(bsdf: &Bsdf, wo: Vec3) -> f64 {
    let n = 1 << 14;
    let of = |i: i32| {
        let u = [f64::from(u32::reverse_bits(i as u32)) / 2f64.powi(32), (f64::from(i) * 0.618_033_988_7).fract()];
        let uc = (f64::from(i) + 0.5) / f64::from(n);
        bsdf.sample(wo, uc as f32, u.map(|u| u as f32)).map_or(0.0, |s| f64::from(s.adjoint().weight.x))
    };
    (0..n).map(of).sum::<f64>() / f64::from(n)
}

#[test]
fn power_is_lost_at_second_facets_only() {
    for distribution in DISTRIBUTIONS {
        for eta in ETAS {
            for alpha in ALPHAS {
                let bsdf = boundary([alpha; 2], eta, distribution);
                for wo in views() {
                    let power = power(&bsdf, wo);
                    assert!(power <= 1.0 + 1e-5, "{distribution:?} {alpha} {eta} {wo}: {power}");
                    // A narrow lobe keeps all light, unless it meets the horizon.
                    if alpha <= 1e-3 && wo.z.abs() > 0.4 && (eta - 1.0).abs() > 0.1 {
                        assert!(power > 0.999, "{distribution:?} {alpha} {eta} {wo}: {power}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_boundary_of_equal_media_is_smooth_and_lets_light_pass() {
    for (eta, alpha, is_delta) in
        [(1.0, 0.5, true), (1.0 + 1e-5, 1.0, true), (1.0001, 0.5, false), (1.0 / 1.0001, 0.1, true)]
    {
        let bsdf = boundary([alpha; 2], eta, Distribution::Ggx);
        assert_eq!(bsdf.is_delta(), is_delta, "{eta} {alpha}");
        let wo = towards(40.0, 1.0);
        let s = bsdf.sample(wo, 0.5, [0.5; 2]).unwrap();
        assert!(s.lobe.is_transmission() && (s.wi + wo).length() < 1e-3, "{s:?}");
    }
}
