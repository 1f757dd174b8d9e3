//! The widths of a distribution of normals along x and along y.

use crate::math::Real;

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
    #[must_use]
    pub fn both(&self) -> [T; 2] {
        [self.x, self.y]
    }

    /// αx, the width of the isotropic surface.
    #[inline(always)]
    #[must_use]
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
    pub(super) fn unstretch_normal<U: Real>(&self, y: U) -> U {
        U::from_f64(self.ratio) * y
    }

    /// The component along y of a direction towards the anisotropic surface, of that towards the isotropic one: y/r. A
    /// slope along y of the isotropic surface becomes one of the anisotropic surface by the same product.
    #[inline(always)]
    #[must_use]
    pub fn stretch<U: Real>(&self, y: U) -> U {
        U::from_f64(self.inverse) * y
    }
}
