//! Smith's masking function G₁ = 1/(1 + Λ), which is all that rendering needs of Λ.

use super::directions::{ALPHA, COSINE, of_cosine, sin2_from_xy, sin2_from_z, vector, with};
use super::family::{
    Bound, Family, Machine, Number, POSITIVE, REPORT, Range, STABLE, Section, TEXTBOOK, Value, scalar, variant,
};
use crate::errata::microfacet::lambda_with_pi;
use crate::optics::microfacet::{Beckmann, Ggx, Microfacet};

/// G₁ of Beckmann's distribution.
pub const BECKMANN: Family = Family {
    name: "beckmann-g",
    about: "shadowing of a Beckmann surface",
    figure: "stability-microfacet",
    inputs: &["alpha", "x", "y", "z"],
    domains: &[POSITIVE],
    sections: &[Section {
        title: "down to the horizon",
        x: ALPHA,
        y: COSINE,
        at: |alpha, cos| with(alpha, of_cosine(cos)),
    }],
    edges: &[&[1e-5, 0.0, 0.0, 1.0], &[10.0, 0.0, 0.0, 1.0], &[0.5, 0.6, 0.0, 0.8]],
    reference: |x| scalar(beckmann(x[0], sin2_from_xy(vector(x, 1)), x[3])),
    variants: &[
        variant!(STABLE, |x| scalar(Beckmann::new(x[0]).g1(vector(x, 1)))),
        variant!(TEXTBOOK, |x| scalar(beckmann(x[0], sin2_from_z(vector(x, 1)), x[3]))),
        variant!(REPORT, report),
    ],
    range: Range::UpTo(1.0),
    bounds: &[Bound::roundings(
        20.0,
        "4 of the slope, 1 of its inverse, 5 of exp and erfcx each, 5 of the sum and the quotient",
    )],
    coarser: 1,
};

/// G₁ of the GGX distribution.
pub const GGX: Family = Family {
    name: "ggx-g",
    about: "shadowing of a GGX surface",
    reference: |x| scalar(ggx(x[0], sin2_from_xy(vector(x, 1)), x[3])),
    variants: &[
        variant!(STABLE, |x| scalar(Ggx::new(x[0]).g1(vector(x, 1)))),
        variant!(TEXTBOOK, |x| scalar(ggx(x[0], sin2_from_z(vector(x, 1)), x[3]))),
    ],
    bounds: &[Bound::roundings(12.0, "5 of the squared slope, 4 of the root and its sum, 3 of the quotients")],
    ..BECKMANN
};

/// The second report's Λ, with π in place of its root.
fn report<T: Machine>(x: &[T]) -> Value<T> {
    let tan = Number::sqrt(sin2_from_z(vector(x, 1))) / x[3];
    scalar(T::of(1.0) / (T::of(1.0) + lambda_with_pi(T::of(1.0) / (x[0] * tan))))
}

/// 1/(1 + Λ) with Λ = ½ (exp(−A²)/(A√π) − erfc A), A = 1/(α tan θ).
pub fn beckmann<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    let slope = alpha * sin2.sqrt() / cos;
    let one = T::of(1.0);
    // Nothing is masked at normal incidence, where A is infinite.
    if slope == T::of(0.0) {
        return one;
    }
    let a = one / slope;
    let lambda = ((-a.square()).exp() * slope / T::pi().sqrt() - a.erfc()) / T::of(2.0);
    one / (one + lambda)
}

/// 1/(1 + Λ) with Λ = ½ (√(1 + α² tan²θ) − 1).
pub fn ggx<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    let one = T::of(1.0);
    let lambda = ((one + alpha.square() * (sin2 / cos.square())).sqrt() - one) / T::of(2.0);
    one / (one + lambda)
}
