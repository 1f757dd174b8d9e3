//! Fresnel reflectance of a conductor: exact, and an approximation that older renderers use.

use super::dielectric::{Reflectance, g_squared};
use super::incidence;
use crate::math::Real;

/// Exact reflectance for the complex index η + i k (relative to the near side, k ≥ 0), at `cos_i`; a cosine
/// beyond 1 counts as 1.
///
/// With s² = 1 − c², A = |(η + ik)² − s²|, a = Re √((η + ik)² − s²):
/// R⊥ = (A + c² − 2ac) / (A + c² + 2ac), R∥ = R⊥ (A c² + s⁴ − 2ac s²) / (A c² + s⁴ + 2ac s²).
/// Computed through the complex root a + ib itself, so that R⊥ = |c − (a+ib)|² / |c + (a+ib)|² is a quotient of
/// sums of squares and cannot turn negative. Source: Born & Wolf, 7th ed., 14.2.
pub fn fresnel<T: Real>(cos_i: T, eta: T, k: T) -> Reflectance<T> {
    let one = T::one();
    let c = incidence(cos_i);
    let sin2 = (one - c) * (one + c);
    // z = a + ib = η cos θ_t by Snell's law.
    let (a, b) = root(c, eta, k);
    // r⊥ = (c − z)/(c + z); c − z = −(n² − 1)/(c + z) with n² = (η + ik)², which does not cancel as n → 1.
    let (re, im) = ((eta - one) * (eta + one) - k * k, (eta + eta) * k);
    let sum2 = (c + a) * (c + a) + b * b;
    if sum2 == T::zero() {
        // Only for c = 0 and n = 1 exactly: no interface.
        return Reflectance { parallel: T::zero(), perpendicular: T::zero(), cos_t: None };
    }
    // |c − z|²/|c + z|² is more precise where c − z does not cancel, and never exceeds 1.
    let difference2 = (c - a) * (c - a) + b * b;
    let r = re.hypot(im) / sum2;
    let perpendicular = if difference2 * T::from_f64(4.0) >= sum2 { difference2 / sum2 } else { r * r };
    // r∥/r⊥ = (c z − s²)/(c z + s²) in modulus.
    let (x, y) = (c * a, c * b);
    let below = (x + sin2) * (x + sin2) + y * y;
    let ratio2 = if below == T::zero() { one } else { ((x - sin2) * (x - sin2) + y * y) / below };
    Reflectance { parallel: perpendicular * ratio2, perpendicular, cos_t: None }
}

/// The root z = a + ib (a, b ≥ 0) of (η + ik)² − s², without the cancellation of √((|z²| + Re z²)/2) for Re z² < 0.
fn root<T: Real>(c: T, eta: T, k: T) -> (T, T) {
    let half = T::from_f64(0.5);
    let re = g_squared(c, eta) - k * k;
    let im = (eta + eta) * k;
    let larger = ((re.hypot(im) + re.abs()) * half).sqrt();
    if larger == T::zero() {
        return (T::zero(), T::zero());
    }
    let smaller = im * half / larger;
    if re >= T::zero() { (larger, smaller) } else { (smaller, larger) }
}

/// The approximation of pbrt-v2 and of the second report, which drops s² against η² + k²:
/// R⊥ = (q − 2ηc + c²) / (q + 2ηc + c²), R∥ = (q c² − 2ηc + 1) / (q c² + 2ηc + 1), q = η² + k².
///
/// Its error is below 0.007 (unpolarized) for gold and copper. It is unusable for q < 5: its error for glass (k = 0,
/// η = 1.5) is 0.099.
pub fn fresnel_approximate<T: Real>(cos_i: T, eta: T, k: T) -> Reflectance<T> {
    let c = incidence(cos_i);
    let q = eta * eta + k * k;
    let middle = T::from_f64(2.0) * eta * c;
    let parallel = (q * c * c - middle + T::one()) / (q * c * c + middle + T::one());
    Reflectance { parallel, perpendicular: (q - middle + c * c) / (q + middle + c * c), cos_t: None }
}

/// Reflectance at normal incidence, ((η−1)² + k²) / ((η+1)² + k²).
pub fn normal_reflectance<T: Real>(eta: T, k: T) -> T {
    let one = T::one();
    ((eta - one) * (eta - one) + k * k) / ((eta + one) * (eta + one) + k * k)
}

/// The pseudo-Brewster angle in radians: where R∥ is smallest.
///
/// It solves a cubic; minimizing the exact R∥ by golden sections is as good and exact to about 10⁻⁸ rad, the root of the
/// precision to which a minimum can be located. The search starts around the best of 900 angles, because R∥ is almost
/// flat where a weak absorber of η < 1 reflects all light.
pub fn pseudo_brewster(eta: f64, k: f64) -> f64 {
    let parallel = |theta: f64| fresnel(theta.cos().max(0.0), eta, k).parallel;
    // Bracket the minimum by the best of equidistant angles.
    const PLACES: usize = 900;
    let at = |i: usize| std::f64::consts::FRAC_PI_2 * i as f64 / PLACES as f64;
    let best = (0..=PLACES).min_by(|&a, &b| parallel(at(a)).total_cmp(&parallel(at(b)))).unwrap_or(0);
    // Narrow the bracket by golden sections.
    let section = (5f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (at(best.saturating_sub(1)), at((best + 1).min(PLACES)));
    let (mut x1, mut x2) = (high - section * (high - low), low + section * (high - low));
    let (mut f1, mut f2) = (parallel(x1), parallel(x2));
    while high - low > 1e-9 {
        if f1 < f2 {
            (high, x2, f2) = (x2, x1, f1);
            x1 = high - section * (high - low);
            f1 = parallel(x1);
        } else {
            (low, x1, f1) = (x1, x2, f2);
            x2 = low + section * (high - low);
            f2 = parallel(x2);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::dielectric;

    #[test]
    fn without_absorption_it_is_the_dielectric() {
        for eta in [0.51, 0.999, 1.0001, 1.45, 3.0] {
            for i in 0..=90 {
                let c = f64::from(i).to_radians().cos().max(0.0);
                let (metal, glass) = (fresnel(c, eta, 0.0), dielectric::fresnel(c, eta));
                let apart = [metal.parallel - glass.parallel, metal.perpendicular - glass.perpendicular];
                assert!(apart.iter().all(|apart| apart.abs() < 1e-12), "eta {eta}, {i} deg: {metal:?} {glass:?}");
            }
        }
        assert_eq!(fresnel(0.0f32, 1.0, 0.0).unpolarized(), 0.0);
        assert_eq!(fresnel(0.3f32, 1.0, 0.0).unpolarized(), 0.0);
    }

    #[test]
    fn it_agrees_with_the_squared_form() {
        for (eta, k) in [(0.2f64, 3.9f64), (1.4, 1.6), (0.05, 4.0), (2.9, 3.1)] {
            for i in 0..=90 {
                let c = f64::from(i).to_radians().cos();
                let s2 = 1.0 - c * c;
                let d = eta * eta - k * k - s2;
                let big = (d * d + 4.0 * eta * eta * k * k).sqrt();
                let a = ((big + d) / 2.0).sqrt();
                let s = (big + c * c - 2.0 * a * c) / (big + c * c + 2.0 * a * c);
                let p = s * (big * c * c + s2 * s2 - 2.0 * a * c * s2) / (big * c * c + s2 * s2 + 2.0 * a * c * s2);
                let f = fresnel(c, eta, k);
                assert!((f.parallel - p).abs() < 1e-12 && (f.perpendicular - s).abs() < 1e-12, "{eta} {k} {i}");
            }
            let f = fresnel(1.0, eta, k);
            assert!((f.parallel - f.perpendicular).abs() < 1e-15, "no polarization along the normal");
            assert!((f.parallel - normal_reflectance(eta, k)).abs() < 1e-15);
        }
    }

    #[test]
    fn pseudo_brewster_meets_brewster() {
        for eta in [0.01f64, 0.5, 1.5, 4.0] {
            assert!((pseudo_brewster(eta, 0.0) - eta.atan()).abs() < 1e-7, "{eta}");
        }
        let theta = pseudo_brewster(0.2, 3.9);
        let at = |t: f64| fresnel(t.cos(), 0.2, 3.9).parallel;
        assert!(at(theta) <= at(theta - 1e-3) && at(theta) <= at(theta + 1e-3));
    }

    #[test]
    fn the_approximation_is_close_for_gold_and_wrong_for_glass() {
        let worst = |eta: f64, k: f64| {
            (0..=900)
                .map(|i| {
                    let c = (f64::from(i) / 10.0).to_radians().cos();
                    (fresnel(c, eta, k).unpolarized() - fresnel_approximate(c, eta, k).unpolarized()).abs()
                })
                .fold(0.0, f64::max)
        };
        assert!(worst(1.3284, 1.8661) < 0.008);
        assert!(worst(1.5, 0.0) > 0.09);
    }
}
