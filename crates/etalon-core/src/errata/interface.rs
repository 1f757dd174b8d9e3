//! Interfaces: both reports' Schlick and a misprint of it; what the second report's text prints of reflection and refraction and
//! its program does not do.

use crate::math::Real;
use crate::optics::dielectric::{self, normal_reflectance, schlick_polynomial};

/// Schlick's polynomial of the incident cosine on both sides of a dielectric.
///
/// Right is the cosine on the less dense side ([`crate::optics::dielectric::schlick`]). Leaving glass of index 1.5 this one
/// gives 0.040 at 30° (right: 0.055), 0.041 at 40° (0.245) and at 41.5° (0.542): it knows no total internal reflection.
/// With total internal reflection added it reflects 0.573 of uniform light from inside; 0.596 is correct.
pub fn schlick_incident_cosine<T: Real>(cos_i: T, eta: T) -> T {
    schlick_polynomial(normal_reflectance(eta), cos_i)
}

/// Schlick's polynomial of the cosine of the refracted direction, which the second report's BSDF of glass has in the share that is
/// refracted, beside that of the incident direction in the share that is reflected; `None` under total internal reflection.
///
/// By Fresnel's equations both are the same. By this polynomial the shares add up to 1.96 for light that grazes glass of 1.45.
pub fn schlick_refracted_cosine(cos_i: f64, eta: f64) -> Option<f64> {
    dielectric::eta_cos_t(cos_i, eta).map(|g| schlick_polynomial(normal_reflectance(eta), g / eta))
}

/// Schlick's polynomial as the second report's text prints it, F₀ + (1 − F₀)(1 − cos⁵); its program has the correct
/// (1 − cos)⁵.
///
/// From air into glass of 1.45 it reflects 0.72 of uniform light; 0.09 is correct.
pub fn schlick_of_fifth_power<T: Real>(cos: T, eta: T) -> T {
    let f0 = normal_reflectance(eta);
    f0 + (T::one() - f0) * (T::one() - cos * cos * cos * cos * cos)
}

/// The tangential part of the mirrored direction, of one whose tangential part is `sin`: the printed components have no minus.
///
/// Right is −sin. The printed mirror sends all light back to where it came from.
pub fn reflected_sine_without_sign(sin: f64) -> f64 {
    sin
}

/// 1/(e·n), the factor of the printed BSDFs of mirror and glass.
///
/// Right is 1/|e·n|: the report's n is fixed, so that for light from inside of glass e·n and with it the printed BSDF are negative.
pub fn reciprocal_of_signed_cosine(cos: f64) -> f64 {
    1.0 / cos
}

/// Whether light is refracted, by the printed set of directions: (1 − cos²)/η² > 1.
///
/// Right is ≤ 1. Of the printed directions none has a refracted one.
pub fn refracts_where_above_one(cos: f64, eta: f64) -> bool {
    (1.0 - cos * cos) / (eta * eta) > 1.0
}

/// The cosine of the refracted direction, by the printed 1 − (1 − cos)²/η², if that is not negative.
///
/// Right is 1 − (1 − cos²)/η². With the correct tangential part the direction is up to 11 % longer than 1 from air into glass of
/// 1.45, and from inside the critical angle is 72° and not 44°.
pub fn refracted_cosine_of_squared_difference(cos: f64, eta: f64) -> Option<f64> {
    let square = 1.0 - ((1.0 - cos) / eta).powi(2);
    (square >= 0.0).then(|| square.sqrt())
}

/// The part along the normal of the refracted direction, of a cosine that is negative from inside, where the printed root reaches over
/// the sign of the cosine and over the normal: −√(1 − (1 − cos²)/η² sgn cos). It is the root of a vector; this is its part along n.
///
/// Right is −√(1 − (1 − cos²)/η²) sgn cos. From inside the sign is lost: no light leaves the glass.
pub fn refracted_normal_part_under_root(cos: f64, eta: f64) -> f64 {
    -(1.0 - (1.0 - cos * cos) / (eta * eta) * cos.signum()).sqrt()
}

/// The sine of the refracted direction where the formula of its tangential part has that direction on both sides: t = −t/η has
/// no solution but 0.
///
/// Right is sin θᵢ/η.
pub fn refracted_sine_of_itself() -> f64 {
    0.0
}

/// The radiance of refracted light over that of the incident light, by the printed BSDF: T(1 − r²)/n_r² with n_r = `eta`, the
/// index on the side of the refracted light over that of the incident light.
///
/// Right is T(1 − r²) n_r²: a beam's flux is kept and its étendue changes. The error is a factor n_r⁴, 4.42 out of glass of 1.45 and
/// 0.23 into it. Light that enters glass and leaves it again meets both, so that most images do not show it.
pub fn refracted_radiance_over_square(transmitted: f64, eta: f64) -> f64 {
    transmitted / (eta * eta)
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

    #[test]
    fn a_mirror_sends_light_back_and_glass_takes_it_away() {
        assert_eq!(reflected_sine_without_sign(0.5), 0.5);
        assert!(reciprocal_of_signed_cosine(-0.5) < 0.0 && reciprocal_of_signed_cosine(0.5) == 2.0);
    }

    #[test]
    fn radiance_is_wrong_by_the_fourth_power_one_way_and_right_through_a_slab() {
        let right = |transmitted: f64, eta: f64| transmitted * eta * eta;
        assert!((refracted_radiance_over_square(1.0, 1.0 / 1.45) / right(1.0, 1.0 / 1.45) - 4.4205).abs() < 1e-4);
        let through = refracted_radiance_over_square(refracted_radiance_over_square(1.0, 1.45), 1.0 / 1.45);
        assert!((through - 1.0).abs() < 1e-15);
    }

    #[test]
    fn light_is_refracted_where_it_cannot_be_and_too_far_from_inside() {
        // From air nothing is refracted, from glass what lies beyond the critical angle of 43.6°.
        assert!((0..=90).all(|a| !refracts_where_above_one(f64::from(a).to_radians().cos(), 1.45)));
        let inside = |degrees: f64| refracts_where_above_one(degrees.to_radians().cos(), 1.0 / 1.45);
        assert!(!inside(43.6) && inside(43.7));
        // 1 − 1/1.45 is the cosine of 71.9°.
        let leaves = |degrees: f64| refracted_cosine_of_squared_difference(degrees.to_radians().cos(), 1.0 / 1.45);
        assert!(leaves(71.8).is_some() && leaves(72.0).is_none());
        // Under the root the sign of a direction from inside makes 1 + sin²/η², and the part along n does not change sides.
        assert_eq!(refracted_normal_part_under_root(-1.0, 1.0 / 1.45), -1.0);
        let part = refracted_normal_part_under_root(-(0.75f64.sqrt()), 1.0 / 1.45);
        assert!((part + (1.0 + 0.25 * 1.45f64 * 1.45).sqrt()).abs() < 1e-12);
        // At 60°: 1 + 2 cos (1 − cos)/η² with cos = ½.
        let (sin2, cos) = (0.75 / 1.45f64.powi(2), refracted_cosine_of_squared_difference(0.5, 1.45).unwrap());
        assert!(((sin2 + cos * cos).sqrt() - 1.1126).abs() < 1e-4);
    }
}
