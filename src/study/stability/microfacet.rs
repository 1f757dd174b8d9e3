//! Microfacets: the distribution of normals D, Smith's masking function G₁ = 1/(1 + Λ), which is all that rendering needs of
//! Λ, and the pdf of visible normals (VNDF).

use super::family::*;
use crate::errata::microfacet::lambda_with_pi;
use crate::optics::microfacet::{Beckmann, Ggx, Microfacet};
use crate::sampling::normals::SampleNormals;

pub const BECKMANN_D: Family = Family {
    name: "beckmann-d",
    about: "Beckmann's distribution of normals",
    figure: "stability-microfacet",
    inputs: &["alpha", "x", "y", "z"],
    domains: &[POSITIVE],
    // Beyond tan θ = 8 α there is less than 10⁻²⁷ of the normals.
    sections: &[Section::new("over the lobe", ALPHA, Scale::new(SLOPE, 1e-3, 8.0), over_the_lobe), GRAZING],
    edges: &[&[1e-5, 0.0, 0.0, 1.0], &[0.5, 0.0, 0.0, 1.0], &[10.0, 0.0, 0.0, 1.0], &[0.5, 0.6, 0.0, -0.8]],
    reference: |x| above_horizon(x, beckmann_d(x[0], sin2_from_xy(vector(x, 1)), x[3])),
    variants: &[
        variant!(STABLE, |x| scalar(Beckmann::new(x[0]).d(vector(x, 1)))),
        variant!(TEXTBOOK, |x| scalar(beckmann_d(x[0], sin2_from_z(vector(x, 1)), x[3]))),
    ],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(20.0, "9 of the root of D, twice, and 2 of what exp leaves")],
    coarser: 1,
};

pub const GGX_D: Family = Family {
    name: "ggx-d",
    about: "the GGX distribution of normals",
    sections: &[Section::new("over the lobe", ALPHA, Scale::new(SLOPE, 1e-3, 1e4), over_the_lobe), GRAZING],
    reference: |x| above_horizon(x, ggx_d(x[0], sin2_from_xy(vector(x, 1)), x[3])),
    variants: &[
        variant!(STABLE, |x| scalar(Ggx::new(x[0]).d(vector(x, 1)))),
        variant!(TEXTBOOK, |x| scalar(ggx_d(x[0], sin2_from_z(vector(x, 1)), x[3]))),
    ],
    bounds: &[Bound::roundings(13.0, "5 of the root of D, twice, and 3 of its square over π")],
    ..BECKMANN_D
};

const SLOPE: &str = "tan /{θ}_{m} / /{α}";
const GRAZING: Section = Section::new("down to the horizon", ALPHA, COSINE, |alpha, cos| with(alpha, of_cosine(cos)));

fn over_the_lobe(alpha: f64, slope: f64) -> Vec<f64> {
    with(alpha, of_slope(alpha * slope))
}

/// There are no normals below the horizon.
fn above_horizon<T: Number>(x: &[T], d: T) -> Value<T> {
    scalar(if x[3] > T::of(0.0) { d } else { T::of(0.0) })
}

/// exp(−tan²θ/α²) / (π α² cos⁴θ).
fn beckmann_d<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    let (alpha2, cos2) = (alpha.square(), cos.square());
    (-(sin2 / cos2) / alpha2).exp() / (T::pi() * alpha2 * cos2.square())
}

/// α² / (π cos⁴θ (α² + tan²θ)²).
pub(super) fn ggx_d<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    let (alpha2, cos2) = (alpha.square(), cos.square());
    alpha2 / (T::pi() * cos2.square() * (alpha2 + sin2 / cos2).square())
}

pub const BECKMANN_G1: Family = Family {
    name: "beckmann-g",
    about: "masking function G₁ of a Beckmann surface",
    figure: "stability-microfacet",
    inputs: &["alpha", "x", "y", "z"],
    domains: &[POSITIVE],
    sections: &[GRAZING],
    edges: &[&[1e-5, 0.0, 0.0, 1.0], &[10.0, 0.0, 0.0, 1.0], &[0.5, 0.6, 0.0, 0.8]],
    reference: |x| scalar(beckmann_g1(x[0], sin2_from_xy(vector(x, 1)), x[3])),
    variants: &[
        variant!(STABLE, |x| scalar(Beckmann::new(x[0]).g1(vector(x, 1)))),
        variant!(TEXTBOOK, |x| scalar(beckmann_g1(x[0], sin2_from_z(vector(x, 1)), x[3]))),
        variant!(REPORT, g1_of_report),
    ],
    range: Range::UpTo(1.0),
    bounds: &[Bound::roundings(
        20.0,
        "4 of the slope, 1 of its inverse, 5 of exp and erfcx each, 5 of the sum and the quotient",
    )],
    coarser: 1,
};

pub const GGX_G1: Family = Family {
    name: "ggx-g",
    about: "masking function G₁ of a GGX surface",
    reference: |x| scalar(ggx_g1(x[0], sin2_from_xy(vector(x, 1)), x[3])),
    variants: &[
        variant!(STABLE, |x| scalar(Ggx::new(x[0]).g1(vector(x, 1)))),
        variant!(TEXTBOOK, |x| scalar(ggx_g1(x[0], sin2_from_z(vector(x, 1)), x[3]))),
    ],
    bounds: &[Bound::roundings(12.0, "5 of the squared slope, 4 of the root and its sum, 3 of the quotients")],
    ..BECKMANN_G1
};

/// The second report's Λ, with π in place of its root.
fn g1_of_report<T: Machine>(x: &[T]) -> Value<T> {
    let tan = Number::sqrt(sin2_from_z(vector(x, 1))) / x[3];
    scalar(T::of(1.0) / (T::of(1.0) + lambda_with_pi(T::of(1.0) / (x[0] * tan))))
}

/// 1/(1 + Λ) with Λ = ½ (exp(−A²)/(A√π) − erfc A), A = 1/(α tan θ).
fn beckmann_g1<T: Number>(alpha: T, sin2: T, cos: T) -> T {
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
pub(super) fn ggx_g1<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    let one = T::of(1.0);
    let lambda = ((one + alpha.square() * (sin2 / cos.square())).sqrt() - one) / T::of(2.0);
    one / (one + lambda)
}

pub const BECKMANN_PDF: Family = Family {
    name: "beckmann-pdf",
    about: "pdf of the visible normals of a Beckmann surface",
    figure: "stability-microfacet",
    inputs: &["alpha", "wo_x", "wo_y", "wo_z", "wm_x", "wm_y", "wm_z"],
    domains: &[POSITIVE],
    sections: &[Section::new("a typical normal, tilted towards the view", ALPHA, COSINE, |alpha, cos| {
        [&[alpha][..], &of_cosine(cos), &of_slope(0.7 * alpha)].concat()
    })],
    edges: &[&[0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0], &[1e-5, 0.6, 0.0, 0.8, 0.0, 0.0, 1.0]],
    reference: |x| visible(x, sin2_from_xy, beckmann_d, beckmann_g1),
    variants: &[
        variant!(STABLE, |x| scalar(Beckmann::new(x[0]).pdf_vndf(vector(x, 1), vector(x, 4)))),
        variant!(TEXTBOOK, |x| visible(x, sin2_from_z, beckmann_d, beckmann_g1)),
    ],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(48.0, "20 of D, 20 of G₁, 6 of wo·wm, 2 of the products")],
    coarser: 1,
};

pub const GGX_PDF: Family = Family {
    name: "ggx-pdf",
    about: "pdf of the visible normals of a GGX surface",
    reference: |x| visible(x, sin2_from_xy, ggx_d, ggx_g1),
    variants: &[
        variant!(STABLE, |x| scalar(Ggx::new(x[0]).pdf_vndf(vector(x, 1), vector(x, 4)))),
        variant!(TEXTBOOK, |x| visible(x, sin2_from_z, ggx_d, ggx_g1)),
    ],
    bounds: &[Bound::roundings(33.0, "13 of D, 12 of G₁, 6 of wo·wm, 2 of the products")],
    ..BECKMANN_PDF
};

/// D(m) (wo·m) G₁(wo) / cos θₒ, for functions of α, sin² and cos.
fn visible<T: Number>(x: &[T], sin2: fn([T; 3]) -> T, d: fn(T, T, T) -> T, g1: fn(T, T, T) -> T) -> Value<T> {
    let (alpha, wo, wm) = (x[0], vector(x, 1), vector(x, 4));
    scalar(d(alpha, sin2(wm), wm[2]) * dot(wo, wm) * g1(alpha, sin2(wo), wo[2]) / wo[2])
}
