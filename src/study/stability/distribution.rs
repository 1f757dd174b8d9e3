//! The distribution of microfacet normals, D.

use super::directions::{ALPHA, COSINE, of_cosine, of_slope, sin2_from_xy, sin2_from_z, vector, with};
use super::family::{Bound, Family, Number, POSITIVE, Range, STABLE, Scale, Section, TEXTBOOK, Value, scalar, variant};
use crate::optics::microfacet::{Beckmann, Ggx, Microfacet};

/// D of Beckmann's distribution.
pub const BECKMANN: Family = Family {
    name: "beckmann-d",
    about: "Beckmann's distribution of normals",
    figure: "stability-microfacet",
    inputs: &["alpha", "x", "y", "z"],
    domains: &[POSITIVE],
    // Beyond tan θ = 8 α there is less than 10⁻²⁷ of the normals.
    sections: &[
        Section { title: "over the lobe", x: ALPHA, y: Scale::new(SLOPE, 1e-3, 8.0), at: over_the_lobe },
        GRAZING,
    ],
    edges: &[&[1e-5, 0.0, 0.0, 1.0], &[0.5, 0.0, 0.0, 1.0], &[10.0, 0.0, 0.0, 1.0], &[0.5, 0.6, 0.0, -0.8]],
    reference: |x| above_horizon(x, beckmann(x[0], sin2_from_xy(vector(x, 1)), x[3])),
    variants: &[
        variant!(STABLE, |x| scalar(Beckmann::new(x[0]).d(vector(x, 1)))),
        variant!(TEXTBOOK, |x| scalar(beckmann(x[0], sin2_from_z(vector(x, 1)), x[3]))),
    ],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(20.0, "9 of the root of D, twice, and 2 of what exp leaves")],
    coarser: 1,
};

/// D of the GGX distribution.
pub const GGX: Family = Family {
    name: "ggx-d",
    about: "the GGX distribution of normals",
    sections: &[
        Section { title: "over the lobe", x: ALPHA, y: Scale::new(SLOPE, 1e-3, 1e4), at: over_the_lobe },
        GRAZING,
    ],
    reference: |x| above_horizon(x, ggx(x[0], sin2_from_xy(vector(x, 1)), x[3])),
    variants: &[
        variant!(STABLE, |x| scalar(Ggx::new(x[0]).d(vector(x, 1)))),
        variant!(TEXTBOOK, |x| scalar(ggx(x[0], sin2_from_z(vector(x, 1)), x[3]))),
    ],
    bounds: &[Bound::roundings(13.0, "5 of the root of D, twice, and 3 of its square over π")],
    ..BECKMANN
};

const SLOPE: &str = "tan /{θ}_{m} / /{α}";
const GRAZING: Section =
    Section { title: "down to the horizon", x: ALPHA, y: COSINE, at: |alpha, cos| with(alpha, of_cosine(cos)) };

fn over_the_lobe(alpha: f64, slope: f64) -> Vec<f64> {
    with(alpha, of_slope(alpha * slope))
}

/// There are no normals below the horizon.
fn above_horizon<T: Number>(x: &[T], d: T) -> Value<T> {
    scalar(if x[3] > T::of(0.0) { d } else { T::of(0.0) })
}

/// exp(−tan²θ/α²) / (π α² cos⁴θ).
pub fn beckmann<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    let (alpha2, cos2) = (alpha.square(), cos.square());
    (-(sin2 / cos2) / alpha2).exp() / (T::pi() * alpha2 * cos2.square())
}

/// α² / (π cos⁴θ (α² + tan²θ)²).
pub fn ggx<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    let (alpha2, cos2) = (alpha.square(), cos.square());
    alpha2 / (T::pi() * cos2.square() * (alpha2 + sin2 / cos2).square())
}
