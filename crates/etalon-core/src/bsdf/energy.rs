//! The energy that single scattering at a rough conductor loses: a table of its albedo, and the lobe that returns the rest.

use super::ConductorFresnel;
use crate::math::{Real, Rgb};
use crate::sampling::normals::SampleNormals;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// Chebyshev polynomials in s, which stands for the elevation of a direction.
const TERMS: usize = 20;
/// Steps of the integral in each random number.
const STEPS: u32 = 96;
/// Chebyshev polynomials in the logarithm of the width along a direction, for anisotropic surfaces.
const ROWS: usize = 6;

/// The directional albedo E(w) of single scattering for F = 1, and what follows from it.
///
/// For a direction w let q² = αx² w_x² + αy² w_y² and s = √(z/(z + q)). Masking depends on z/q alone, and E is a smooth function
/// of s. For αx ≠ αy it is smooth
/// in the logarithm of the width along the direction, q/sin θ, too. It is computed at the Chebyshev points of both by
/// integrating over visible normals, and interpolated. The error is at most 10⁻³ for widths in \[10⁻⁴, 1\], and 2·10⁻³ where
/// they differ by a factor of up to 30, which a test measures; the white-furnace test of a lossless metal deviates from 1 by as
/// much.
#[derive(Debug, Clone, PartialEq)]
pub struct MissingEnergy {
    alpha: [f32; 2],
    /// ln αmin, and 2/ln(αmax/αmin); 0 if the surface is isotropic.
    azimuth: [f32; 2],
    /// Chebyshev coefficients of E in 2s − 1, for each polynomial in the azimuth.
    coefficients: [[f32; TERMS]; ROWS],
    /// 1/(π (1 − Ē)), Ē being the mean of E by the cosine.
    scale: f32,
    /// Ē.
    mean: f32,
}

impl MissingEnergy {
    pub fn new(distribution: impl SampleNormals<f64>) -> Self {
        let alpha = distribution.widths().both().map(|alpha| alpha as f32);
        let isotropic = alpha[0] == alpha[1];
        let (low, high) = (alpha[0].min(alpha[1]).ln(), alpha[0].max(alpha[1]).ln());
        let azimuth = [low, if isotropic { 0.0 } else { 2.0 / (high - low) }];
        // Compute E at Chebyshev points.
        let rows = if isotropic { 1 } else { ROWS };
        let mut values = [[0.0; TERMS]; ROWS];
        for (row, values) in values.iter_mut().enumerate().take(rows) {
            // The azimuth at which the width is that of the place.
            let y = f64::from(low) + 0.5 * (1.0 + chebyshev_point(row, rows)) * f64::from(high - low);
            let [ax2, ay2] = alpha.map(|alpha| f64::from(alpha).powi(2));
            let cos2 = if isotropic { 1.0 } else { (((2.0 * y).exp() - ay2) / (ax2 - ay2)).clamp(0.0, 1.0) };
            let width = (ax2 * cos2 + ay2 * (1.0 - cos2)).sqrt();
            for (i, value) in values.iter_mut().enumerate() {
                let x = 0.5 * (1.0 + chebyshev_point(i, TERMS));
                let cot = width * x * x / (1.0 - x * x);
                let sin = 1.0 / (1.0 + cot * cot).sqrt();
                let w = [sin * cos2.sqrt(), sin * (1.0 - cos2).sqrt(), sin * cot];
                *value = albedo(distribution, w, STEPS);
            }
        }
        // Transform along both coordinates.
        let mut coefficients = [[0.0; TERMS]; ROWS];
        for (k, of_azimuth) in coefficients.iter_mut().enumerate().take(rows) {
            for (j, coefficient) in of_azimuth.iter_mut().enumerate() {
                let row = |row: usize| chebyshev_coefficient(j, TERMS, |i| values[row][i]);
                *coefficient = chebyshev_coefficient(k, rows, row) as f32;
            }
        }
        let mut energy = Self { alpha, azimuth, coefficients, scale: 0.0, mean: 0.0 };
        // Integrate what is interpolated, so that the lobe returns exactly that.
        let missing = energy.mean_missing(if isotropic { 1 } else { 64 });
        energy.scale = FRAC_1_PI / missing.max(f32::MIN_POSITIVE);
        energy.mean = 1.0 - missing;
        energy
    }

    /// Whether the widths along x and y are equal.
    pub fn is_isotropic(&self) -> bool {
        self.alpha[0] == self.alpha[1]
    }

    /// 1 − E(w), the share that single scattering loses. `ISOTROPIC` says what [`is_isotropic`](Self::is_isotropic) does.
    #[inline(always)]
    pub fn missing<const ISOTROPIC: bool>(&self, w: Vec3) -> f32 {
        let (qx, qy) = (self.alpha[0] * w.x, self.alpha[1] * w.y);
        let q = (qx * qx + qy * qy).sqrt();
        let z = w.z.abs();
        // At grazing angles E is 1: all reflected directions are above the surface, and G₂/G₁ is 1.
        let s = 2.0 * (z / (z + q)).sqrt() - 1.0;
        if ISOTROPIC {
            return (1.0 - chebyshev(&self.coefficients[0], s)).clamp(0.0, 1.0);
        }
        // At normal incidence any width will do.
        let sin = (w.x * w.x + w.y * w.y).sqrt();
        let width = (q / sin.max(1e-10)).max(f32::MIN_POSITIVE);
        let y = ((width.logarithm() - self.azimuth[0]) * self.azimuth[1] - 1.0).clamp(-1.0, 1.0);
        // Written out, so that loops over this vectorize.
        let row = |k: usize| chebyshev(&self.coefficients[k], s);
        let rows: [f32; ROWS] = [row(0), row(1), row(2), row(3), row(4), row(5)];
        (1.0 - chebyshev(&rows, y)).clamp(0.0, 1.0)
    }

    /// The lobe that returns what is lost, for F = 1, from the two shares that are: m(wo) m(wi) / (π (1 − Ē)).
    #[inline(always)]
    pub fn lobe(&self, missing_o: f32, missing_i: f32) -> f32 {
        // The product last: either factor may be tiny.
        missing_o * (missing_i * self.scale)
    }

    /// F_ms: the factor on that lobe for a metal that absorbs.
    ///
    /// Light that is scattered more than once is scattered k ≥ 2 times with the share (1 − Ē)^(k−1) Ē; of it the metal
    /// leaves F̄^k, F̄ being the mean of F by the cosine. The sum, over that for F̄ = 1, is F̄² Ē / (1 − F̄ (1 − Ē)).
    pub fn colour(&self, fresnel: &ConductorFresnel) -> Rgb {
        const STEPS: usize = 256;
        // ∫ F(μ) 2μ dμ by the midpoint rule.
        let place = |i: usize| (i as f32 + 0.5) / STEPS as f32;
        let of = |i: usize| fresnel.reflectance(place(i)) * (2.0 * place(i) / STEPS as f32);
        let mean: Rgb = (0..STEPS).map(of).sum();
        let mean = mean.min(Rgb::ONE);
        mean * mean * self.mean / (Rgb::ONE - mean * (1.0 - self.mean))
    }

    /// ∫ (1 − E) cos dω / π, by the midpoint rule in x² over `turns` azimuths of a quarter turn.
    fn mean_missing(&self, turns: u32) -> f32 {
        const STEPS: u32 = 1024;
        let mut sum = 0.0;
        for turn in 0..turns {
            let phi = std::f64::consts::FRAC_PI_2 * (f64::from(turn) + 0.5) / f64::from(turns);
            let (sin_phi, cos_phi) = phi.sin_cos();
            for step in 0..STEPS {
                // z = v²: the integrand is sharp near the horizon. 2z dz = 4v³ dv.
                let v = (f64::from(step) + 0.5) / f64::from(STEPS);
                let (z, sin) = (v * v, (1.0 - v.powi(4)).sqrt());
                let w = glam::DVec3::new(sin * cos_phi, sin * sin_phi, z).as_vec3();
                let missing = if self.is_isotropic() { self.missing::<true>(w) } else { self.missing::<false>(w) };
                sum += 4.0 * v.powi(3) * f64::from(missing);
            }
        }
        (sum / f64::from(STEPS * turns)) as f32
    }
}

/// E(w) of single scattering for F = 1: the mean of G₂/G₁ over visible normals, by the midpoint rule with that many steps in v,
/// u = v² (3 − 2v): at the ends of u, where slopes may be infinite, the steps are small.
fn albedo<D: SampleNormals<f64>>(distribution: D, w: [f64; 3], steps: u32) -> f64 {
    let mut sum = 0.0;
    for i in 0..steps * steps {
        let v = [i / steps, i % steps].map(|i| (f64::from(i) + 0.5) / f64::from(steps));
        let u = v.map(|v| v * v * (3.0 - 2.0 * v));
        let weight = 36.0 * v[0] * (1.0 - v[0]) * v[1] * (1.0 - v[1]);
        let m = distribution.sample_vndf(w, u);
        let cos = w[0] * m[0] + w[1] * m[1] + w[2] * m[2];
        let wi = [2.0 * cos * m[0] - w[0], 2.0 * cos * m[1] - w[1], 2.0 * cos * m[2] - w[2]];
        if wi[2] > 0.0 {
            let a = wi[2] * (w[2] + distribution.cos_lambda(w));
            sum += weight * a / (a + w[2] * distribution.cos_lambda(wi));
        }
    }
    sum / f64::from(steps * steps)
}

/// Point `i` of `n` in \[−1, 1\].
fn chebyshev_point(i: usize, n: usize) -> f64 {
    -(std::f64::consts::PI * (i as f64 + 0.5) / n as f64).cos()
}

/// The coefficient of polynomial `k` of the interpolation of `values` at `n` Chebyshev points.
fn chebyshev_coefficient(k: usize, n: usize, values: impl Fn(usize) -> f64) -> f64 {
    let polynomial = |i: usize| (k as f64 * chebyshev_point(i, n).acos()).cos();
    let sum: f64 = (0..n).map(|i| values(i) * polynomial(i)).sum();
    sum * if k == 0 { 1.0 } else { 2.0 } / n as f64
}

/// The sum of Chebyshev polynomials in `x`, by Clenshaw's recurrence.
#[inline(always)]
fn chebyshev<const N: usize>(coefficients: &[f32; N], x: f32) -> f32 {
    let (mut next, mut after) = (0.0, 0.0);
    for k in (1..N).rev() {
        (next, after) = (coefficients[k] + 2.0 * x * next - after, next);
    }
    coefficients[0] + x * next - after
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::microfacet::{Beckmann, Ggx};

    /// The largest difference between the table and the integral, over directions between its points.
    fn worst(distribution: impl SampleNormals<f64>) -> f64 {
        let energy = MissingEnergy::new(distribution);
        let mut worst = 0f64;
        for (i, phi) in (0..40).map(|i| (i, f64::from(i) * 0.4)) {
            let z = (f64::from(i) + 0.3) / 40.0;
            for z in [z, z * z * z] {
                let s = (1.0 - z * z).sqrt();
                let w = glam::DVec3::new(s * phi.cos(), s * phi.sin(), z);
                let missing = if energy.is_isotropic() {
                    energy.missing::<true>(w.as_vec3())
                } else {
                    energy.missing::<false>(w.as_vec3())
                };
                worst = worst.max((1.0 - f64::from(missing) - albedo(distribution, w.to_array(), 128)).abs());
            }
        }
        worst
    }

    #[test]
    #[ignore = "takes seconds: cargo test -- --ignored"]
    fn the_table_is_the_integral() {
        for alpha in
            [[1e-4; 2], [1e-3; 2], [0.03; 2], [0.1; 2], [0.3; 2], [1.0; 2], [0.05, 0.5], [1.0, 0.1], [0.01, 0.3]]
        {
            let errors = [worst(Beckmann::anisotropic(alpha)), worst(Ggx::anisotropic(alpha))];
            let bound = if alpha[0] == alpha[1] { 1e-3 } else { 2e-3 };
            assert!(errors.iter().all(|&error| error < bound), "{alpha:?}: {errors:?}");
        }
        // By hand for GGX at α = 1 from above: ∫ G₂/G₁ is 1 − ln 2.
        let energy = MissingEnergy::new(Ggx::new(1.0));
        assert!((energy.missing::<true>(Vec3::Z) - std::f32::consts::LN_2).abs() < 3e-4);
        // Albedos at an angle in degrees by an independent integration over facets.
        let reflected = |energy: MissingEnergy, degrees: f32| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            1.0 - energy.missing::<true>(Vec3::new(sin, 0.0, cos))
        };
        for (energy, degrees, known) in [
            (MissingEnergy::new(Ggx::new(0.5)), 85.0, 0.872_024),
            (MissingEnergy::new(Beckmann::new(0.5)), 0.0, 0.942_998),
            (MissingEnergy::new(Beckmann::new(1.0)), 60.0, 0.766_568),
        ] {
            let albedo = reflected(energy, degrees);
            assert!((albedo - known).abs() < 1e-3, "{degrees}°: {albedo} {known}");
        }
    }

    #[test]
    fn the_lobe_returns_what_is_missing() {
        for alpha in [[0.5, 0.5], [0.1, 0.8]] {
            let energy = MissingEnergy::new(Ggx::anisotropic(alpha));
            let missing =
                |w: Vec3| if energy.is_isotropic() { energy.missing::<true>(w) } else { energy.missing::<false>(w) };
            let wo = Vec3::new(0.48, 0.64, 0.6);
            let n = 512u32;
            let mut sum = 0.0;
            for i in 0..n * n {
                let u = [i / n, i % n].map(|j| (f64::from(j) + 0.5) / f64::from(n));
                let wi = crate::sampling::warp::cosine_hemisphere(u).as_vec3();
                sum += f64::from(energy.lobe(missing(wo), missing(wi))) * std::f64::consts::PI;
            }
            let returned = sum / f64::from(n * n);
            assert!((returned - f64::from(missing(wo))).abs() < 2e-4, "{alpha:?}: {returned} {}", missing(wo));
        }
    }

    #[test]
    fn gold_takes_its_colour_twice() {
        let energy = MissingEnergy::new(Ggx::new(0.5));
        let white = energy.colour(&ConductorFresnel::new(Rgb::ONE, Rgb::splat(2e4)));
        assert!((white.x - 1.0).abs() < 1e-3, "{white}");
        let metal = crate::optics::metals::GOLD;
        let gold = energy.colour(&ConductorFresnel::new(metal.eta_rgb(), metal.k_rgb()));
        assert!(gold.x > gold.y && gold.y > gold.z && gold.z > 0.0, "{gold}");
    }
}
