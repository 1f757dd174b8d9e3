//! Distributions of microfacet normals, D, and their shadowing, in forms that stay precise at grazing angles.
//!
//! Directions are unit vectors in the local frame, the mean normal at +z; `alpha` is the root mean square slope times
//! √2 (Beckmann) or the width of the same name (GGX), along x and along y. sin² is x² + y² and never 1 − z², which at α = 10⁻³ would leave
//! a D that is wrong by some percent in f32.
//!
//! Shadowing is written by z Λ, which is finite at the horizon where Λ is not, so that no form divides by a cosine:
//! G₁/z = 1/(z + z Λ), and G₂/(zₒ zᵢ) = 1/(zₒ zᵢ + zᵢ (zₒ Λₒ) + zₒ (zᵢ Λᵢ)). Source: Heitz, "Understanding the
//! Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014.

mod distributions;
pub mod smith;

pub use distributions::{Beckmann, Ggx};
pub use smith::{Microfacet, Widths};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Distribution {
    /// [`Beckmann`].
    #[default]
    Beckmann,
    Ggx,
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALPHAS: [f64; 6] = [1e-4, 1e-3, 0.005, 0.05, 0.25, 1.0];

    fn direction(theta: f64) -> [f64; 3] {
        [theta.sin() * 0.6, theta.sin() * 0.8, theta.cos()]
    }

    fn narrow(w: [f64; 3]) -> ([f32; 3], [f64; 3]) {
        let single = w.map(|x| x as f32);
        (single, single.map(f64::from))
    }

    fn normals_cover_the_surface<D: Microfacet<f64>>(d: D, alpha: f64) {
        // ∫ D cos dω by the midpoint rule in ln tan θ, which resolves lobes of any width.
        let n = 20_000;
        let (low, high) = ((alpha * 1e-6).ln(), (alpha * 1e6).ln());
        let step = (high - low) / f64::from(n);
        let mut sum = 0.0;
        for i in 0..n {
            let theta = (low + (f64::from(i) + 0.5) * step).exp().atan();
            let (sin, cos) = theta.sin_cos();
            // dω = 2π sin dθ, dθ = sin cos d(ln tan).
            sum += d.d(direction(theta)) * cos * sin * sin * cos * 2.0 * std::f64::consts::PI * step;
        }
        assert!((sum - 1.0).abs() < 1e-5, "alpha {alpha}: {sum}");
    }

    #[test]
    fn projected_facets_cover_the_surface() {
        for alpha in ALPHAS {
            normals_cover_the_surface(Beckmann::new(alpha), alpha);
            normals_cover_the_surface(Ggx::new(alpha), alpha);
        }
    }

    fn single_against_double<S: Microfacet<f32>, D: Microfacet<f64>>(single: S, double: D, alpha: f64) {
        for i in 0..=1000 {
            // Normals over the lobe, directions over all angles up to the horizon.
            let (m32, m64) = narrow(direction((alpha * 4.0 * f64::from(i) / 1000.0).atan()));
            let (a, b) = (f64::from(single.d(m32)), double.d(m64));
            assert!((a - b).abs() <= 5e-6 * b + 1e-37, "alpha {alpha}: D {a} {b}");
            let (w32, w64) = narrow(direction(std::f64::consts::FRAC_PI_2 * f64::from(i) / 1000.0));
            for (a, b) in [(single.g1(w32), double.g1(w64)), (single.g1_over_cos(w32), double.g1_over_cos(w64))] {
                assert!((f64::from(a) - b).abs() <= 1e-6 * b.abs(), "alpha {alpha}, step {i}: {a} {b}");
            }
        }
    }

    #[test]
    fn f32_is_as_good_as_its_input() {
        for alpha in ALPHAS.map(|a| a as f32) {
            single_against_double(Beckmann::new(alpha), Beckmann::new(f64::from(alpha)), f64::from(alpha));
            single_against_double(Ggx::new(alpha), Ggx::new(f64::from(alpha)), f64::from(alpha));
        }
    }

    #[test]
    fn nothing_is_nan_at_the_edges() {
        fn check<D: Microfacet<f32>>(d: D) {
            for z in [0.0f32, 1e-30, 1e-12, 1e-6, 0.5, 1.0] {
                let w = [(1.0 - z * z).sqrt(), 0.0, z];
                assert!(d.d(w) >= 0.0 && d.d(w).is_finite(), "{z}");
                assert!((0.0..=1.0).contains(&d.g1(w)), "{z}");
                assert!(d.g1_over_cos(w).is_finite() && d.g2_over_cosines(w, [0.0, 0.0, 1.0]).is_finite());
            }
            assert_eq!(d.g1([0.0, 0.0, 1.0]), 1.0);
            assert_eq!(d.g1([1.0, 0.0, 0.0]), 0.0);
            assert_eq!(d.d([0.0, 0.6, -0.8]), 0.0);
        }
        for alpha in [1e-4, 0.01, 1.0] {
            check(Beckmann::new(alpha));
            check(Ggx::new(alpha));
        }
    }

    #[test]
    fn shadowing_is_what_the_distribution_demands() {
        // ∫ G₁(w) max(0, w·m) D(m) dωₘ = z: what is seen of the facets covers what is seen of the surface.
        fn check<D: Microfacet<f64>>(d: D, alpha: f64, theta: f64) {
            let w = [theta.sin(), 0.0, theta.cos()];
            let (n, turns) = (2000, 512);
            let (low, high) = ((alpha * 1e-4).ln(), (alpha * 1e5).ln());
            let step = (high - low) / f64::from(n);
            let mut sum = 0.0;
            for i in 0..n {
                let (sin, cos) = (low + (f64::from(i) + 0.5) * step).exp().atan().sin_cos();
                let mut ring = 0.0;
                for j in 0..turns {
                    let phi = std::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(turns);
                    ring += (w[0] * sin * phi.cos() + w[2] * cos).max(0.0);
                }
                sum += ring / f64::from(turns) * d.d([sin, 0.0, cos]) * sin * sin * cos * std::f64::consts::TAU * step;
            }
            let seen = sum * d.g1(w);
            assert!((seen / w[2] - 1.0).abs() < 2e-4, "alpha {alpha}, {theta}: {}", seen / w[2]);
        }
        for alpha in [0.05, 0.25, 1.0] {
            for degrees in [0.0f64, 30.0, 60.0, 85.0] {
                check(Beckmann::new(alpha), alpha, degrees.to_radians());
                check(Ggx::new(alpha), alpha, degrees.to_radians());
            }
        }
    }
}
