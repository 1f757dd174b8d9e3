//! Microfacets: the second report's shadowing and pdfs of Beckmann's distribution.

use crate::math::Real;

/// Which formulas of rough metal are the second report's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MetalErrors {
    /// Fresnel reflectance at the angle of `wi` with the surface's normal instead of the microfacet's.
    ///
    /// Not reciprocal: f(wo, wi) and f(wi, wo) differ by up to 2 % for the blue of silver, 13 % for that of aluminium,
    /// 82 % for copper, 105 % for iron and 148 % for gold (grazing against the least reflective angle).
    pub fresnel_at_normal: bool,
    /// The approximation [`crate::optics::conductor::fresnel_approximate`], which drops sin² against η² + k²: an error
    /// below 0.007 for gold and copper.
    pub approximate_fresnel: bool,
    /// [`lambda_with_pi`] in the shadowing term, which may then exceed 1.
    pub lambda_with_pi: bool,
}

impl MetalErrors {
    /// The correct formulas.
    pub const NONE: Self = Self { fresnel_at_normal: false, approximate_fresnel: false, lambda_with_pi: false };

    /// All of the second report's.
    pub const ALL: Self = Self { fresnel_at_normal: true, approximate_fresnel: true, lambda_with_pi: true };
}

/// The second report's Λ for Beckmann's distribution, a = 1/(α tan θ): ½ (erf a − 1 + exp(−a²)/(a π)).
///
/// The correct formula has √π in place of π. This one is negative for a > 0.529, down to −0.0241 at a = 0.805 where
/// the correct Λ is 0.0558, so that G = 1/(1 + Λₒ + Λᵢ) reaches 1.051 instead of staying below 1. Towards grazing
/// angles (a → 0) it is too small by the factor √π, 1.77. Measured on a grid of step 10⁻³ in a.
pub fn lambda_with_pi<T: Real>(a: T) -> T {
    let gauss = if a.is_infinite() { T::zero() } else { (-a * a).exp() / (a * T::PI()) };
    T::from_f64(0.5) * (a.error_function() - T::one() + gauss)
}

/// The pdf that the second report prints for its sampled direction, D(m)/(4 wo·m), of D and the cosine wo·m.
///
/// Correct is D(m) cos θₘ/(4 wo·m), which is also what the report's own routine samples. The printed pdf integrates to 1.086
/// for α = 0.5 and `wo` along the normal.
#[inline]
pub fn direction_pdf_without_cosine<T: Real>(d: T, cos: T) -> T {
    T::from_f64(0.25) * d / cos
}

/// The pdf of the reflected direction by the printed D det(∂eᵢ/∂h), of D and the cosine wo·m; the determinant is 4 wo·m.
///
/// Right is D over the determinant, which is what the report writes on the other side of that equation. The error is a factor
/// 16 (wo·m)².
pub fn reflected_pdf_by_determinant(d: f64, cos: f64) -> f64 {
    d * 4.0 * cos
}

/// The pdf of the normal as the second report's course computes it, p_θ p_φ / sin θ with p_θ = 2 sin θ/(α² cos³θ) exp(−tan²θ/α²) and
/// p_φ = 1/2π: D cos θ, but 0/0 for u = 0, where θ = 0.
pub fn normal_pdf_by_angles(alpha: f32, theta: f32) -> f32 {
    let (sin, cos) = theta.sin_cos();
    let tan = sin / cos;
    let p_theta = 2.0 * sin / (alpha * alpha * cos * cos * cos) * (-(tan * tan) / (alpha * alpha)).exp();
    p_theta * (0.5 * std::f32::consts::FRAC_1_PI) / sin
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::microfacet::{Beckmann, Microfacet};

    /// The exact Λ at a direction of that a for α = 1.
    fn exact(a: f64) -> f64 {
        let theta = (1.0 / a).atan();
        Beckmann::new(1.0).lambda([theta.sin(), 0.0, theta.cos()])
    }

    #[test]
    fn pi_for_its_root_makes_lambda_negative() {
        let lambda = |i: u32| lambda_with_pi(f64::from(i) * 1e-3);
        let lowest = (1..5000).min_by(|&a, &b| lambda(a).total_cmp(&lambda(b))).unwrap();
        let first = (1..5000).find(|&i| lambda(i) < 0.0).unwrap();
        let (at, least) = (f64::from(lowest) * 1e-3, lambda(lowest));
        assert_eq!((first, lowest), (530, 805));
        assert!((least + 0.0241).abs() < 1e-4 && (exact(at) - 0.0558).abs() < 1e-4);
        assert!((1.0 / (1.0 + 2.0 * least) - 1.0505).abs() < 1e-4);
        assert!((exact(1e-6) / lambda_with_pi(1e-6) - std::f64::consts::PI.sqrt()).abs() < 1e-5);
        assert_eq!(lambda_with_pi(f64::INFINITY), 0.0);
    }

    #[test]
    fn the_pdf_by_angles_is_not_a_number_at_the_pole() {
        assert!(normal_pdf_by_angles(0.3, 0.0).is_nan());
        let (alpha, theta) = (0.3f32, 0.2f32);
        let wm = [theta.sin(), 0.0, theta.cos()];
        assert!((normal_pdf_by_angles(alpha, theta) / (Beckmann::new(alpha).d(wm) * wm[2]) - 1.0).abs() < 1e-5);
    }
}
