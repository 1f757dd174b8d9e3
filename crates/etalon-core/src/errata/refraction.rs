//! Refraction: what the second report's text prints and its program does not do.
//!
//! As everywhere, η is the index of the far side over that of the near side.

/// Whether light is refracted, by the printed set of directions: (1 − cos²)/η² > 1.
///
/// Right is ≤ 1. Of the printed directions none has a refracted one.
#[must_use]
pub fn refracts_where_above_one(cos: f64, eta: f64) -> bool {
    (1.0 - cos * cos) / (eta * eta) > 1.0
}

/// The cosine of the refracted direction, by the printed 1 − (1 − cos)²/η², if that is not negative.
///
/// Right is 1 − (1 − cos²)/η². With the correct tangential part the direction is up to 11 % longer than 1 from air into glass of
/// 1.45, and from inside the critical angle is 72° and not 44°.
#[must_use]
pub fn refracted_cosine_of_squared_difference(cos: f64, eta: f64) -> Option<f64> {
    let square = 1.0 - ((1.0 - cos) / eta).powi(2);
    (square >= 0.0).then(|| square.sqrt())
}

/// The part along the normal of the refracted direction, of a cosine that is negative from inside, where the printed root reaches over
/// the sign of the cosine and over the normal: −√(1 − (1 − cos²)/η² sgn cos). It is the root of a vector; this is its part along n.
///
/// Right is −√(1 − (1 − cos²)/η²) sgn cos. From inside the sign is lost: no light leaves the glass.
#[must_use]
pub fn refracted_normal_part_under_root(cos: f64, eta: f64) -> f64 {
    -(1.0 - (1.0 - cos * cos) / (eta * eta) * cos.signum()).sqrt()
}

/// The sine of the refracted direction where the formula of its tangential part has that direction on both sides: t = −t/η has
/// no solution but 0.
///
/// Right is sin θᵢ/η.
#[must_use]
pub fn refracted_sine_of_itself() -> f64 {
    0.0
}

/// The radiance of refracted light over that of the incident light, by the printed BSDF: T(1 − r²)/n_r² with n_r = `eta`, the
/// index on the side of the refracted light over that of the incident light.
///
/// Right is T(1 − r²) n_r²: a beam's flux is kept and its étendue changes. The error is a factor n_r⁴, 4.42 out of glass of 1.45 and
/// 0.23 into it. Light that enters glass and leaves it again meets both, so that most images do not show it.
#[must_use]
pub fn refracted_radiance_over_square(transmitted: f64, eta: f64) -> f64 {
    transmitted / (eta * eta)
}

#[cfg(test)]
mod tests {
    use super::*;

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
