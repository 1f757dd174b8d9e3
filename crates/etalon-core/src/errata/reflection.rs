//! Reflection: what the second report's text prints and its program does not do.

/// The tangential part of the mirrored direction, of one whose tangential part is `sin`: the printed components have no minus.
///
/// Right is −sin. The printed mirror sends all light back to where it came from.
#[must_use]
pub fn reflected_sine_without_sign(sin: f64) -> f64 {
    sin
}

/// 1/(e·n), the factor of the printed BSDFs of mirror and glass.
///
/// Right is 1/|e·n|: the report's n is fixed, so that for light from inside of glass e·n and with it the printed BSDF are negative.
#[must_use]
pub fn reciprocal_of_signed_cosine(cos: f64) -> f64 {
    1.0 / cos
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirror_sends_light_back_and_glass_takes_it_away() {
        assert_eq!(reflected_sine_without_sign(0.5), 0.5);
        assert!(reciprocal_of_signed_cosine(-0.5) < 0.0 && reciprocal_of_signed_cosine(0.5) == 2.0);
    }
}
