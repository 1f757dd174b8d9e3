//! Schlick's approximation of a dielectric's reflectance, correct on both sides.

use super::{dielectric, incidence};
use crate::math::Real;

/// Reflectance at normal incidence, ((η−1)/(η+1))².
#[must_use]
pub fn normal_reflectance<T: Real>(eta: T) -> T {
    let r = (eta - T::one()) / (eta + T::one());
    r * r
}

/// Schlick's polynomial F₀ + (1 − F₀)(1 − c)⁵ for a given cosine; one beyond 1 counts as 1.
///
/// Source: Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994, eq. 15.
#[must_use]
pub fn polynomial<T: Real>(f0: T, cos: T) -> T {
    let m = T::one() - incidence(cos);
    let m2 = m * m;
    f0 + (T::one() - f0) * m2 * m2 * m
}

/// Schlick for a dielectric: the cosine is that of the ray on the less dense side; 1 under total internal reflection.
#[must_use]
pub fn schlick<T: Real>(cos_i: T, eta: T) -> T {
    if eta == T::one() {
        return T::zero();
    }
    let f0 = normal_reflectance(eta);
    if eta > T::one() {
        return polynomial(f0, cos_i);
    }
    dielectric::eta_cos_t(cos_i, eta).map_or(T::one(), |g| polynomial(f0, g / eta))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_agree_with_each_other() {
        for i in 1..=100 {
            let c = f64::from(i) / 100.0;
            let cos_t = dielectric::fresnel(c, 1.45).cos_t.unwrap();
            assert!((schlick(c, 1.45) - schlick(cos_t, 1.0 / 1.45)).abs() < 1e-13);
        }
    }

    #[test]
    fn limits() {
        assert_eq!(schlick(0.3, 1.0), 0.0);
        assert_eq!(schlick(0.0, 1.5), 1.0);
        assert_eq!(schlick(0.5, 1.0 / 1.5), 1.0, "total internal reflection");
        assert!((schlick(1.0f64, 1.45) - 0.033_735_943_356_934).abs() < 1e-15);
    }
}
