//! Fresnel reflectance: both reports' Schlick, and a misprint of it.

use crate::math::Real;
use crate::optics::dielectric;
use crate::optics::schlick::{normal_reflectance, polynomial};

/// Schlick's polynomial of the incident cosine on both sides of a dielectric.
///
/// Right is the cosine on the less dense side ([`crate::optics::schlick::schlick`]). Leaving glass of index 1.5 this one
/// gives 0.040 at 30° (right: 0.055), 0.041 at 40° (0.245) and at 41.5° (0.542): it knows no total internal reflection.
/// With total internal reflection added it reflects 0.573 of uniform light from inside; 0.596 is correct.
#[must_use]
pub fn schlick_incident_cosine<T: Real>(cos_i: T, eta: T) -> T {
    polynomial(normal_reflectance(eta), cos_i)
}

/// Schlick's polynomial of the cosine of the refracted direction, which the second report's BSDF of glass has in the share that is
/// refracted, beside that of the incident direction in the share that is reflected; `None` under total internal reflection.
///
/// By Fresnel's equations both are the same. By this polynomial the shares add up to 1.96 for light that grazes glass of 1.45.
#[must_use]
pub fn schlick_refracted_cosine(cos_i: f64, eta: f64) -> Option<f64> {
    dielectric::eta_cos_t(cos_i, eta).map(|g| polynomial(normal_reflectance(eta), g / eta))
}

/// Schlick's polynomial as the second report's text prints it, F₀ + (1 − F₀)(1 − cos⁵); its program has the correct
/// (1 − cos)⁵.
///
/// From air into glass of 1.45 it reflects 0.72 of uniform light; 0.09 is correct.
#[must_use]
pub fn schlick_of_fifth_power<T: Real>(cos: T, eta: T) -> T {
    let f0 = normal_reflectance(eta);
    f0 + (T::one() - f0) * (T::one() - cos * cos * cos * cos * cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_by_the_cosines_of_both_sides_do_not_add_up() {
        let sum = |cos: f64| schlick_incident_cosine(cos, 1.45) + 1.0 - schlick_refracted_cosine(cos, 1.45).unwrap();
        assert!((sum(1.0) - 1.0).abs() < 1e-12 && (sum(0.0) - 1.9647).abs() < 1e-4, "{}", sum(0.0));
        assert!(schlick_refracted_cosine(0.5, 1.0 / 1.45).is_none());
    }

    #[test]
    fn the_misprint_reflects_most_of_the_light() {
        // ∫ 2c (1 − c⁵) dc = 5/7.
        let n = 100_000;
        let light = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        let mean = (0..n).map(light).map(|c| 2.0 * c * schlick_of_fifth_power(c, 1.45)).sum::<f64>() / f64::from(n);
        let f0 = (0.45f64 / 2.45).powi(2);
        assert!((mean - (f0 + (1.0 - f0) * 5.0 / 7.0)).abs() < 1e-8, "{mean}");
    }

    #[test]
    fn one_cosine_misses_internal_reflection() {
        let (eta, n) = (1.0 / 1.5f64, 100_000);
        let wrong = |c: f64| {
            if dielectric::eta_cos_t(c, eta).is_some() { schlick_incident_cosine(c, eta) } else { 1.0 }
        };
        let exact = |c: f64| dielectric::fresnel(c, eta).unpolarized();
        for (degrees, wrong_value, truth) in [(30f64, 0.040, 0.055), (40.0, 0.041, 0.245), (41.5, 0.041, 0.542)] {
            let c = degrees.to_radians().cos();
            assert!((wrong(c) - wrong_value).abs() < 5e-4 && (exact(c) - truth).abs() < 5e-4, "{degrees}");
        }
        // For uniform light from inside: ∫ F 2c dc.
        let mean = |f: &dyn Fn(f64) -> f64| {
            (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n)).map(|c| 2.0 * c * f(c)).sum::<f64>() / f64::from(n)
        };
        assert!((mean(&wrong) - 0.5734).abs() < 1e-4 && (mean(&exact) - 0.5963).abs() < 1e-4);
    }
}
