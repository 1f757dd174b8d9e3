//! Fresnel reflectance of a smooth dielectric, in a factored form without cancellation near eta = 1; Schlick's approximation of it,
//! correct on both sides.

use super::incidence;
use crate::math::Real;

/// What an interface does to a ray of given incidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflectance<T> {
    /// Reflected share of the power polarized in the plane of incidence, R∥.
    pub parallel: T,
    /// Reflected share of the power polarized across the plane of incidence, R⊥.
    pub perpendicular: T,
    /// Cosine of the refracted ray with the normal (≥ 0); `None` under total internal reflection, and of a conductor.
    pub cos_t: Option<T>,
}

impl<T: Real> Reflectance<T> {
    /// Reflected share of unpolarized light, (R∥ + R⊥) / 2.
    pub fn unpolarized(&self) -> T {
        (self.parallel + self.perpendicular) * T::from_f64(0.5)
    }

    /// Transmitted share of the power of unpolarized light, 1 − F.
    ///
    /// This is power, not radiance: radiance also scales with η² across the interface.
    pub fn transmittance(&self) -> T {
        T::one() - self.unpolarized()
    }
}

/// Exact Fresnel reflectance for a ray that meets the interface at `cos_i` from the near side; a cosine beyond 1 counts as 1.
///
/// `eta` > 0 is the far index over the near one, from 10⁻¹⁸ to 10¹⁸ in f32, so that its square neither overflows nor
/// vanishes. Total internal reflection gives R∥ = R⊥ = 1.
/// Source: Born & Wolf, *Principles of Optics*, 7th ed., 1.5.2, rearranged as the module describes.
pub fn fresnel<T: Real>(cos_i: T, eta: T) -> Reflectance<T> {
    let one = T::one();
    let c = incidence(cos_i);
    let q = (eta - one) * (eta + one);
    if q == T::zero() {
        return Reflectance { parallel: T::zero(), perpendicular: T::zero(), cos_t: Some(c) };
    }
    // Compute g = η cos θ_t by Snell's law.
    let Some(g) = eta_cos_t(c, eta) else {
        return Reflectance { parallel: one, perpendicular: one, cos_t: None };
    };
    let sin2 = (one - c) * (one + c);
    let (sum, difference) = (c + g, c - g);
    // r⊥ = −q/(c+g)² avoids the difference c − g but multiplies the rounding of g by four. Use (c−g)/(c+g), which never
    // exceeds 1, where c − g does not cancel: towards grazing and critical angles.
    let precise = difference.abs() + difference.abs() >= sum;
    let (above, below) = if precise { (difference, sum) } else { (-q, sum * sum) };
    let r_perpendicular = above / below;
    let ratio = (c * g - sin2) / (c * g + sin2);
    let perpendicular = r_perpendicular * r_perpendicular;
    Reflectance { parallel: perpendicular * ratio * ratio, perpendicular, cos_t: Some(g / eta) }
}

/// g = η cos θₜ at the incident cosine `c`; `None` under total internal reflection. Refraction directions reuse it.
pub fn eta_cos_t<T: Real>(c: T, eta: T) -> Option<T> {
    let g2 = g_squared(c, eta);
    let is_total = eta < T::one() && g2 <= T::zero();
    (!is_total).then(|| g2.sqrt())
}

/// g² = η² − s² = q + c², negative under total internal reflection.
///
/// For q = η² − 1 < 0 it cancels near the critical angle. It is factored as (c − c_c)(c + c_c), c_c = √−q being the
/// critical cosine, or as (η − s)(η + s), whichever has the smaller terms, which are rounded less there. It is computed in f64,
/// so that in f32 only the rounding of the input matters.
pub(super) fn g_squared<T: Real>(c: T, eta: T) -> T {
    let (c, eta) = (incidence(c.to_f64()), eta.to_f64());
    let q = (eta - 1.0) * (eta + 1.0);
    if q >= 0.0 {
        return T::from_f64(q + c * c);
    }
    let near_one = eta > std::f64::consts::FRAC_1_SQRT_2;
    let (a, b) = if near_one { (c, (-q).sqrt()) } else { (eta, ((1.0 - c) * (1.0 + c)).sqrt()) };
    T::from_f64((a - b) * (a + b))
}

/// Brewster's angle atan(η) in radians: light polarized in the plane of incidence is not reflected there. Both sides have one.
pub fn brewster(eta: f64) -> f64 {
    eta.atan()
}

/// The critical angle asin(η) in radians, beyond which all light is reflected; `None` where there is none (η ≥ 1).
pub fn critical(eta: f64) -> Option<f64> {
    (eta < 1.0).then(|| eta.asin())
}

/// Reflectance at normal incidence, ((η−1)/(η+1))².
pub fn normal_reflectance<T: Real>(eta: T) -> T {
    let r = (eta - T::one()) / (eta + T::one());
    r * r
}

/// Schlick's polynomial F₀ + (1 − F₀)(1 − c)⁵ for a given cosine; one beyond 1 counts as 1.
///
/// Source: Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994, eq. 15.
pub fn schlick_polynomial<T: Real>(f0: T, cos: T) -> T {
    let m = T::one() - incidence(cos);
    let m2 = m * m;
    f0 + (T::one() - f0) * m2 * m2 * m
}

/// Schlick for a dielectric: the cosine is that of the ray on the less dense side; 1 under total internal reflection.
pub fn schlick<T: Real>(cos_i: T, eta: T) -> T {
    if eta == T::one() {
        return T::zero();
    }
    let f0 = normal_reflectance(eta);
    if eta > T::one() {
        return schlick_polynomial(f0, cos_i);
    }
    eta_cos_t(cos_i, eta).map_or(T::one(), |g| schlick_polynomial(f0, g / eta))
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu_float::DBig;
    use std::str::FromStr;

    /// 50-digit reference by the textbook formulas, at the rounded inputs.
    fn reference(cos_i: f64, eta: f64) -> [f64; 2] {
        let big = |x: f64| DBig::from_str(&format!("{x:e}")).unwrap().with_precision(60).value();
        // `{:e}` prints the shortest decimal that reads back as x, which is not x itself; build it exactly instead.
        let exact = |x: f64| {
            let (mantissa, exponent, sign) = num_traits::Float::integer_decode(x);
            let two = big(2.0);
            let scale = if exponent >= 0 {
                (0..exponent).fold(big(1.0), |a, _| a * &two)
            } else {
                (0..-exponent).fold(big(1.0), |a, _| a / &two)
            };
            big(f64::from(sign)) * DBig::from(mantissa).with_precision(60).value() * scale
        };
        let (c, n) = (exact(cos_i), exact(eta));
        let g2 = &n * &n - big(1.0) + &c * &c;
        if g2 <= big(0.0) {
            return [1.0, 1.0];
        }
        let g = g2.sqrt();
        let s = (&c - &g) / (&c + &g);
        let p = (&n * &n * &c - &g) / (&n * &n * &c + &g);
        [(&p * &p).to_f64().value(), (&s * &s).to_f64().value()]
    }

    #[test]
    fn f32_is_as_accurate_as_its_input_for_every_eta() {
        let exact = |c: f32, eta: f32| {
            let [p, s] = reference(f64::from(c), f64::from(eta));
            0.5 * (p + s)
        };
        for eta in [1e-3f32, 0.4, 0.66, 0.9999, 1.000_002, 1.0003, 1.01, 1.33, 1.5, 2.4, 10.0, 1e3] {
            for i in 0..=200 {
                let c = i as f32 / 200.0;
                let (f, expected) = (fresnel(c, eta).unpolarized(), exact(c, eta));
                // Close to the critical angle the last bit of the cosine moves F by far more than 10⁻⁶.
                let last_bit = (exact(c.next_down().max(0.0), eta) - expected).abs() / expected;
                let error = (f64::from(f) - expected).abs() / expected;
                assert!(error < 1e-6 + 2.0 * last_bit, "eta {eta} cos {c}: {f} against {expected}, {error:e}");
            }
        }
    }

    #[test]
    fn f64_agrees_with_the_reference_at_every_angle() {
        for eta in [1.0 / 1.5, 1.0 / 1.01, 1.01, 1.45, 4.0] {
            for i in 0..=1000 {
                let c = f64::from(i) / 1000.0;
                let f = fresnel(c, eta);
                let [p, s] = reference(c, eta);
                assert!((f.parallel - p).abs() < 1e-12 && (f.perpendicular - s).abs() < 1e-12, "eta {eta} cos {c}");
            }
        }
    }

    #[test]
    fn limits_are_exact() {
        for c in [0.0, 1e-12, 0.5, 1.0] {
            assert_eq!(fresnel(c, 1.0).unpolarized(), 0.0, "no interface, no reflection");
        }
        assert!((fresnel(0.0f64, 1.5).unpolarized() - 1.0).abs() < 1e-15, "grazing light is reflected");
        assert_eq!(fresnel(0.0f64, 1.0 / 1.5), Reflectance { parallel: 1.0, perpendicular: 1.0, cos_t: None });
        assert!(fresnel(brewster(1.5).cos(), 1.5).parallel < 1e-30, "no parallel light at Brewster's angle");
        assert!((brewster(1.45).to_degrees() - 55.407_711_312_490_06).abs() < 1e-11);
        assert!((critical(1.0 / 1.45).unwrap().to_degrees() - 43.602_818_972_703_62).abs() < 1e-11);
        assert_eq!(critical(1.0), None);
    }

    #[test]
    fn light_takes_the_same_way_back() {
        for i in 1..=100 {
            let c = f64::from(i) / 100.0;
            let there = fresnel(c, 1.45);
            let back = fresnel(there.cos_t.unwrap(), 1.0 / 1.45);
            assert!((there.parallel - back.parallel).abs() < 1e-13);
            assert!((there.perpendicular - back.perpendicular).abs() < 1e-13);
            assert!((back.cos_t.unwrap() - c).abs() < 1e-13);
        }
    }

    #[test]
    fn both_sides_agree_with_each_other() {
        for i in 1..=100 {
            let c = f64::from(i) / 100.0;
            let cos_t = fresnel(c, 1.45).cos_t.unwrap();
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
