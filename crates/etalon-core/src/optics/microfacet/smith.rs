//! What a distribution of microfacet normals provides, and Smith's shadowing that follows from it.

use super::widths::Widths;
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
        let [a, b] = [wo, wi].map(|w| (w[2].abs(), self.cos_lambda(w)));
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
pub(super) fn sin2<T: Real>(w: [T; 3]) -> T {
    w[0] * w[0] + w[1] * w[1]
}
