//! Shadowing terms in use elsewhere, kept for comparison; none of them is used by the default materials.

use crate::math::Real;
use crate::math::error_function::erf;

/// Walter's rational fit of Smith's G₁ for Beckmann's distribution, a = 1/(α tan θ).
///
/// (3.535a + 2.181a²)/(1 + 2.276a + 2.577a²) for a < 1.6, else 1. It is off by up to 0.32 % (at a = 1.34) and exceeds
/// 1 by 6·10⁻⁵ just below a = 1.6, so that a density built on it does not integrate to 1. Source: Walter et al., EGSR
/// 2007, eq. 27.
#[must_use]
pub fn g1_rational<T: Real>(a: T) -> T {
    if a >= T::from_f64(1.6) {
        return T::one();
    }
    a * (T::from_f64(3.535) + T::from_f64(2.181) * a) / (T::one() + a * (T::from_f64(2.276) + T::from_f64(2.577) * a))
}

/// The second report's Λ for Beckmann's distribution, a = 1/(α tan θ): ½ (erf a − 1 + exp(−a²)/(a π)).
///
/// The correct formula has √π in place of π. This one is negative for a > 0.529, down to −0.0241 at a = 0.805 where
/// the correct Λ is 0.0558, so that G = 1/(1 + Λₒ + Λᵢ) reaches 1.051 instead of staying below 1. Towards grazing
/// angles (a → 0) it is too small by the factor √π, 1.77. Measured on a grid of step 10⁻³ in a.
#[must_use]
pub fn lambda_with_pi<T: Real>(a: T) -> T {
    let gauss = if a.is_infinite() { T::zero() } else { (-a * a).exp() / (a * T::PI()) };
    T::from_f64(0.5) * (erf(a) - T::one() + gauss)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::microfacet::{Beckmann, Microfacet};

    /// A direction of that a for α = 1, and the exact G₁ and Λ there.
    fn exact(a: f64) -> (f64, f64) {
        let theta = (1.0 / a).atan();
        let (w, beckmann) = ([theta.sin(), 0.0, theta.cos()], Beckmann::new(1.0));
        (beckmann.g1(w), beckmann.lambda(w))
    }

    #[test]
    fn the_rational_fit_is_off_by_a_third_of_a_percent() {
        let error = |i: u32| (g1_rational(f64::from(i) * 1e-3) / exact(f64::from(i) * 1e-3).0 - 1.0).abs();
        let worst = (1..3000).max_by(|&a, &b| error(a).total_cmp(&error(b))).unwrap();
        assert!((error(worst) - 0.003_13).abs() < 5e-5 && (1330..1350).contains(&worst));
        assert!(g1_rational(1.5999f64) > 1.00005);
    }

    #[test]
    fn pi_for_its_root_makes_lambda_negative() {
        let lambda = |i: u32| lambda_with_pi(f64::from(i) * 1e-3);
        let lowest = (1..5000).min_by(|&a, &b| lambda(a).total_cmp(&lambda(b))).unwrap();
        let first = (1..5000).find(|&i| lambda(i) < 0.0).unwrap();
        let (at, least) = (f64::from(lowest) * 1e-3, lambda(lowest));
        assert_eq!((first, lowest), (530, 805));
        assert!((least + 0.0241).abs() < 1e-4 && (exact(at).1 - 0.0558).abs() < 1e-4);
        assert!((1.0 / (1.0 + 2.0 * least) - 1.0505).abs() < 1e-4);
        assert!((exact(1e-6).1 / lambda_with_pi(1e-6) - std::f64::consts::PI.sqrt()).abs() < 1e-5);
        assert_eq!(lambda_with_pi(f64::INFINITY), 0.0);
    }
}
