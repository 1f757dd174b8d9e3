//! Fresnel reflectance of a metal, three channels at once.

use crate::math::Rgb;
use crate::optics::incidence;

/// The complex index of refraction of a metal in three channels, with what its reflectance needs computed once.
///
/// The formula is that of [`crate::optics::conductor::fresnel`], without branches; k is cut at 10⁶, where the
/// reflectance is 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConductorFresnel {
    /// Real part.
    pub(super) eta: Rgb,
    /// Imaginary part.
    pub(super) k: Rgb,
    /// Real and imaginary part of (η + ik)² − 1, and the square of its modulus.
    re: Rgb,
    im: Rgb,
    modulus2: Rgb,
}

impl ConductorFresnel {
    /// A metal of index `eta` + i `k` relative to the medium above it, both ≥ 0.
    pub fn new(eta: Rgb, k: Rgb) -> Self {
        const LARGEST: f32 = 1e6;
        let (eta, k) = (eta.min(Rgb::splat(LARGEST)), k.min(Rgb::splat(LARGEST)));
        let re = (eta - Rgb::ONE) * (eta + Rgb::ONE) - k * k;
        let im = 2.0 * eta * k;
        Self { eta, k, re, im, modulus2: re * re + im * im }
    }

    /// Exact unpolarized reflectance; a cosine beyond 1 counts as 1.
    #[inline(always)]
    pub fn reflectance(&self, cos: f32) -> Rgb {
        let cos = incidence(cos);
        let channel = |c: usize| reflectance(self.re[c], self.im[c], self.modulus2[c], cos);
        Rgb::new(channel(0), channel(1), channel(2))
    }
}

/// One channel, from the parts and the squared modulus of (η + ik)² − 1.
#[inline(always)]
fn reflectance(re: f32, im: f32, modulus2: f32, cos: f32) -> f32 {
    // Divisors vanish only where there is no interface; their dividends vanish there, too.
    const TINY: f32 = 1e-18;
    let sin2 = (1.0 - cos) * (1.0 + cos);
    // z = a + ib, the root of (η + ik)² − s², without cancellation.
    let re = re + cos * cos;
    let modulus = (re * re + im * im).sqrt();
    let larger = (0.5 * (modulus + re.abs())).sqrt().max(TINY);
    let smaller = 0.5 * im / larger;
    let a = if re < 0.0 { smaller } else { larger };
    let b = if re < 0.0 { larger } else { smaller };
    // R⊥ = |(η + ik)² − 1|² / |c + z|⁴.
    let sum2 = ((a + cos) * (a + cos) + b * b).max(TINY);
    let perpendicular = (modulus2 / sum2 / sum2).min(1.0);
    let (x, y) = (cos * a, cos * b);
    // |r∥/r⊥|² = |c z − s²|² / |c z + s²|².
    let (minus, plus) = (x - sin2, x + sin2);
    let ratio2 = (minus * minus + y * y) / (plus * plus + y * y).max(TINY);
    0.5 * perpendicular * (1.0 + ratio2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::conductor::fresnel;
    use crate::optics::metals::METALS;

    #[test]
    fn the_reflectance_is_that_of_the_exact_formula() {
        let mut indices: Vec<([f64; 3], [f64; 3])> = METALS.iter().map(|m| (m.eta, m.k)).collect();
        indices.extend([([1.0, 1.5, 0.7], [0.0; 3]), ([1.0, 0.01, 100.0], [1e4, 3.0, 1e-3])]);
        for (eta, k) in indices {
            let (eta, k) = (eta.map(|x| x as f32), k.map(|x| x as f32));
            let metal = ConductorFresnel::new(Rgb::from_array(eta), Rgb::from_array(k));
            for i in 0..=1000 {
                let cos = i as f32 / 1000.0;
                let r = metal.reflectance(cos).to_array();
                for channel in 0..3 {
                    let expected =
                        fresnel(f64::from(cos), f64::from(eta[channel]), f64::from(k[channel])).unpolarized();
                    // At the critical angle of η < 1, k = 0 the root magnifies rounding.
                    let bound = if k[channel] == 0.0 && eta[channel] < 1.0 { 2e-3 } else { 1e-6 };
                    let error = (f64::from(r[channel]) - expected).abs();
                    assert!(error < bound, "{eta:?} {k:?}, cos {cos}: {r:?} {expected}");
                }
            }
        }
    }

    #[test]
    fn extreme_indices_give_finite_reflectance() {
        for (eta, k) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1e30), (1e30, 1e30), (1.0, f32::INFINITY), (1e-20, 1e-20)] {
            let metal = ConductorFresnel::new(Rgb::splat(eta), Rgb::splat(k));
            for cos in [0.0, 1e-30, 1e-9, 0.5, 1.0] {
                let r = metal.reflectance(cos).x;
                assert!((0.0..=1.0 + 1e-6).contains(&r), "{eta} {k} {cos}: {r}");
            }
        }
    }
}
