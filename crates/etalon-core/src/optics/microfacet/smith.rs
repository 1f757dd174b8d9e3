//! What a distribution of microfacet normals provides, its widths along x and along y, and Smith's shadowing that follows from it.
//! A shadowing term that other renderers use is for comparison; no BSDF here uses it.

use crate::math::Real;

/// A distribution of normals under Smith's model of shadowing.
pub trait Microfacet<T: Real>: Copy {
    /// Its widths along x and y.
    fn widths(&self) -> Widths<T>;

    /// x² + (r y)² of a normal: sin² of its angle on the isotropic surface, up to a factor.
    #[inline(always)]
    fn normal2<U: Real>(&self, wm: [U; 3]) -> U {
        sin2([wm[0], self.widths().unstretch_normal(wm[1]), wm[2]])
    }

    /// x² + (y/r)² of a direction, which is sin² of its angle times (α/αx)² for the width α along it.
    #[inline(always)]
    fn view2(&self, w: [T; 3]) -> T {
        sin2([w[0], self.widths().stretch(w[1]), w[2]])
    }

    /// Area of the facets with normal `wm`, per unit area of the surface and per solid angle (1/sr).
    ///
    /// ∫ D cos θₘ dωₘ = 1. Zero for normals on or below the horizon.
    fn d(&self, wm: [T; 3]) -> T;

    /// |z| Λ(w), the hidden part of the facets' projected area; `w` may be on either side.
    fn cos_lambda(&self, w: [T; 3]) -> T;

    /// Smith's Λ(w), hidden over visible projected area of the facets; infinite on the horizon.
    #[inline(always)]
    fn lambda(&self, w: [T; 3]) -> T {
        self.cos_lambda(w) / w[2].abs()
    }

    /// Smith's masking function G₁, the share of the facets visible from `w`: 1/(1 + Λ); 0 on the horizon.
    #[inline(always)]
    fn g1(&self, w: [T; 3]) -> T {
        w[2].abs() * self.g1_over_cos(w)
    }

    /// G₁(w)/|z|, finite on the horizon.
    #[inline(always)]
    fn g1_over_cos(&self, w: [T; 3]) -> T {
        (w[2].abs() + self.cos_lambda(w)).recip()
    }

    /// Smith's masking-shadowing function G₂, the share of the facets visible from both directions: 1/(1 + Λₒ + Λᵢ), for
    /// correlated heights; 0 between two directions along the surface.
    #[inline(always)]
    fn g2(&self, wo: [T; 3], wi: [T; 3]) -> T {
        // cos/(cos + cos Λ + cos'Λ' cos/cos') for the smaller cosine, whose ratio to the other neither over- nor underflows.
        // Not a map over both: loops over lanes vectorize only if it is inlined, which is not certain.
        let (a, b) = ((wo[2].abs(), self.cos_lambda(wo)), (wi[2].abs(), self.cos_lambda(wi)));
        let ((least, lambda), (most, other)) = if a.0 < b.0 { (a, b) } else { (b, a) };
        let ratio = if most > T::zero() { least / most } else { T::zero() };
        least / (least + lambda + ratio * other)
    }

    /// G₂(wo, wi)/|zₒ zᵢ|; infinite only with both directions on the horizon.
    #[inline(always)]
    fn g2_over_cosines(&self, wo: [T; 3], wi: [T; 3]) -> T {
        let (o, i) = (wo[2].abs(), wi[2].abs());
        (i * (o + self.cos_lambda(wo)) + o * self.cos_lambda(wi)).recip()
    }
}

/// sin² of the angle with the mean normal.
#[inline(always)]
fn sin2<T: Real>(w: [T; 3]) -> T {
    w[0] * w[0] + w[1] * w[1]
}

/// The widths αx and αy of a distribution of normals.
///
/// A surface of these widths is one of equal widths αx, stretched along y. So D(x, y, z) = r D'(x, r y, z) and
/// Λ(x, y, z) = Λ'(x, y/r, z) with r = αx/αy, D' and Λ' being those of the isotropic surface of width αx. For αx = αy
/// these are products with 1, which change no bit. Source: Heitz, "Understanding the Masking-Shadowing Function in
/// Microfacet-Based BRDFs", JCGT 3(2), 2014, section 5.3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Widths<T> {
    /// αx.
    pub(super) x: T,
    y: T,
    /// r = αx/αy, and its inverse.
    ratio: f64,
    inverse: f64,
}

impl<T: Real> Widths<T> {
    /// The widths αx and αy, both > 0.
    pub(super) fn new([x, y]: [T; 2]) -> Self {
        Self { x, y, ratio: x.to_f64() / y.to_f64(), inverse: y.to_f64() / x.to_f64() }
    }

    /// αx and αy.
    #[inline]
    pub fn both(&self) -> [T; 2] {
        [self.x, self.y]
    }

    /// αx, the width of the isotropic surface.
    #[inline(always)]
    pub fn along_x(&self) -> T {
        self.x
    }

    /// αx/αy.
    #[inline(always)]
    pub(super) fn ratio(&self) -> T {
        T::from_f64(self.ratio)
    }

    /// A number along y of the anisotropic surface's normals, on the isotropic surface: r y.
    #[inline(always)]
    fn unstretch_normal<U: Real>(&self, y: U) -> U {
        U::from_f64(self.ratio) * y
    }

    /// The component along y of a direction towards the anisotropic surface, of that towards the isotropic one: y/r. A
    /// slope along y of the isotropic surface becomes one of the anisotropic surface by the same product.
    #[inline(always)]
    pub fn stretch<U: Real>(&self, y: U) -> U {
        U::from_f64(self.inverse) * y
    }
}

/// Walter's rational fit of Smith's G₁ for Beckmann's distribution, a = 1/(α tan θ).
///
/// (3.535a + 2.181a²)/(1 + 2.276a + 2.577a²) for a < 1.6, else 1. Its error is up to 0.32 % (at a = 1.34), and it exceeds
/// 1 by 6·10⁻⁵ just below a = 1.6, so that a pdf built on it does not integrate to 1. Source: Walter et al., EGSR
/// 2007, eq. 27.
pub fn g1_rational<T: Real>(a: T) -> T {
    if a >= T::from_f64(1.6) {
        return T::one();
    }
    a * (T::from_f64(3.535) + T::from_f64(2.181) * a) / (T::one() + a * (T::from_f64(2.276) + T::from_f64(2.577) * a))
}

#[cfg(test)]
mod tests {
    use super::super::{Beckmann, Microfacet};
    use super::*;

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
