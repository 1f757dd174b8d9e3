//! Reflection and refraction at an interface: scalars in, scalars out, generic over the float type. Beside them, in f64, the
//! media known by name, and spectra as colours.
//!
//! Cosines are of the angle between the normal and a direction; `eta` is the index on the far side over the
//! index on the near side (the side of `wo`), `k` the extinction coefficient relative to the near side's index.

pub mod colorimetry;
pub mod conductor;
pub mod dielectric;
pub mod media;
pub mod metals;
pub mod microfacet;

use crate::math::Real;

/// The modulus of a cosine with the normal, at most 1: rounding takes that of two unit vectors up to a few last places beyond.
#[inline(always)]
pub fn incidence<T: Real>(cos: T) -> T {
    cos.abs().min(T::one())
}

/// The line of helium at which catalogues state the index of a medium, in nanometres.
pub const D_LINE_NM: f64 = 587.5618;
