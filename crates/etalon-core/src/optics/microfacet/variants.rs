//! A shadowing term that other renderers use, for comparison; no BSDF here uses it.

use crate::math::Real;

/// Walter's rational fit of Smith's G₁ for Beckmann's distribution, a = 1/(α tan θ).
///
/// (3.535a + 2.181a²)/(1 + 2.276a + 2.577a²) for a < 1.6, else 1. Its error is up to 0.32 % (at a = 1.34), and it exceeds
/// 1 by 6·10⁻⁵ just below a = 1.6, so that a pdf built on it does not integrate to 1. Source: Walter et al., EGSR
/// 2007, eq. 27.
#[must_use]
pub fn g1_rational<T: Real>(a: T) -> T {
    if a >= T::from_f64(1.6) {
        return T::one();
    }
    a * (T::from_f64(3.535) + T::from_f64(2.181) * a) / (T::one() + a * (T::from_f64(2.276) + T::from_f64(2.577) * a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::microfacet::{Beckmann, Microfacet};

    /// The exact G₁ at a direction of that a for α = 1.
    fn exact(a: f64) -> f64 {
        let theta = (1.0 / a).atan();
        Beckmann::new(1.0).g1([theta.sin(), 0.0, theta.cos()])
    }

    #[test]
    fn the_error_of_the_rational_fit_is_a_third_of_a_percent() {
        let error = |i: u32| (g1_rational(f64::from(i) * 1e-3) / exact(f64::from(i) * 1e-3) - 1.0).abs();
        let worst = (1..3000).max_by(|&a, &b| error(a).total_cmp(&error(b))).unwrap();
        assert!((error(worst) - 0.003_13).abs() < 5e-5 && (1330..1350).contains(&worst));
        assert!(g1_rational(1.5999f64) > 1.00005);
    }
}
