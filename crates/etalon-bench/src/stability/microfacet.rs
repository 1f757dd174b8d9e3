//! Microfacets: the distribution of normals D, Smith's masking function G₁ = 1/(1 + Λ), which is all that rendering needs of
//! Λ, and the pdf of visible normals (VNDF).

use super::family::*;
use etalon_core::errata::microfacet::lambda_with_pi;
use etalon_core::optics::microfacet::{Beckmann, Ggx, Microfacet};
use etalon_core::sampling::normals::SampleNormals;

pub const BECKMANN_D: Family = Family {
    name: "beckmann-d",
    about: "Beckmann's distribution of normals",
    figure: "stability-microfacet",
    inputs: &["alpha", "x", "y", "z"],
    domains: &[POSITIVE],
    // Beyond tan θ = 8 α there is less than 10⁻²⁷ of the normals.
    sections: &[Section::new("over the lobe", ALPHA, Scale::new(SLOPE, 1e-3, 8.0), over_the_lobe), GRAZING],
    edges: &[&[1e-5, 0.0, 0.0, 1.0], &[0.5, 0.0, 0.0, 1.0], &[10.0, 0.0, 0.0, 1.0], &[0.5, 0.6, 0.0, -0.8]],
    reference: |x| scalar(above_horizon(beckmann_d, x[0], vector(x, 1))),
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
    reference: |x| scalar(above_horizon(ggx_d, x[0], vector(x, 1))),
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

/// D of a normal; there are none on or below the horizon.
pub(super) fn above_horizon<T: Number>(d: fn(T, T, T) -> T, alpha: T, wm: [T; 3]) -> T {
    if wm[2] > T::of(0.0) { d(alpha, sin2_from_xy(wm), wm[2]) } else { T::of(0.0) }
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
    reference: |x| scalar(masking(beckmann_cos_lambda, x[0], vector(x, 1))[0]),
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
    reference: |x| scalar(masking(ggx_cos_lambda, x[0], vector(x, 1))[0]),
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

/// G₁ and G₁/|cos θ| of a direction on either side, from |cos θ| Λ: both are defined on the horizon as well.
pub(super) fn masking<T: Number>(cos_lambda: fn(T, T, T) -> T, alpha: T, w: [T; 3]) -> [T; 2] {
    let cos = if w[2] < T::of(0.0) { -w[2] } else { w[2] };
    let whole = cos + cos_lambda(alpha, sin2_from_xy(w), cos);
    [cos / whole, T::of(1.0) / whole]
}

/// cos θ Λ = ½ (α sin θ exp(−A²)/√π − cos θ erfc A), A = 1/(α tan θ).
fn beckmann_cos_lambda<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    let slope = alpha * sin2.sqrt();
    // At normal incidence A is infinite, and nothing is masked.
    if slope == T::of(0.0) {
        return T::of(0.0);
    }
    let a = cos / slope;
    ((-a.square()).exp() * slope / T::pi().sqrt() - cos * a.erfc()) / T::of(2.0)
}

/// cos θ Λ = ½ (√(cos²θ + α² sin²θ) − cos θ).
pub(super) fn ggx_cos_lambda<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    ((cos.square() + alpha.square() * sin2).sqrt() - cos) / T::of(2.0)
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

pub const BECKMANN_G2: Family = Family {
    name: "beckmann-g2",
    about: "masking-shadowing function G₂ of a Beckmann surface",
    inputs: &["alpha", "wo_x", "wo_y", "wo_z", "wi_x", "wi_y", "wi_z"],
    sections: &[Section::new("two directions, cos /{θ}_{i} = 0.3", ALPHA, COSINE, |alpha, cos| {
        [&[alpha][..], &of_cosine(cos), &of_cosine(0.3)].concat()
    })],
    edges: &[&[0.5, 0.6, 0.8, 0.0, -0.6, -0.8, 0.0], &[0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]],
    reference: |x| scalar(masking_shadowing(beckmann_cos_lambda, x)),
    variants: &[variant!(STABLE, |x| scalar(Beckmann::new(x[0]).g2(vector(x, 1), vector(x, 4))))],
    bounds: &[Bound::roundings(
        26.0,
        "20 as in G₁ of each direction, and 6 of the sums, the products and the quotient",
    )],
    ..BECKMANN_G1
};

pub const GGX_G2: Family = Family {
    name: "ggx-g2",
    about: "masking-shadowing function G₂ of a GGX surface",
    reference: |x| scalar(masking_shadowing(ggx_cos_lambda, x)),
    variants: &[variant!(STABLE, |x| scalar(Ggx::new(x[0]).g2(vector(x, 1), vector(x, 4))))],
    bounds: &[Bound::roundings(
        18.0,
        "12 as in G₁ of each direction, and 6 of the sums, the products and the quotient",
    )],
    ..BECKMANN_G2
};

/// 1/(1 + Λₒ + Λᵢ), multiplied out; 0 between two directions along the surface.
fn masking_shadowing<T: Number>(cos_lambda: fn(T, T, T) -> T, x: &[T]) -> T {
    let zero = T::of(0.0);
    let [(o, lambda_o), (i, lambda_i)] = [vector(x, 1), vector(x, 4)].map(|w: [T; 3]| {
        let cos = if w[2] < zero { -w[2] } else { w[2] };
        (cos, cos_lambda(x[0], sin2_from_xy(w), cos))
    });
    let whole = o * i + i * lambda_o + o * lambda_i;
    if whole > zero { o * i / whole } else { zero }
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
    reference: |x| visible_normals(x, beckmann_d, beckmann_cos_lambda),
    variants: &[
        variant!(STABLE, |x| scalar(Beckmann::new(x[0]).pdf_vndf(vector(x, 1), vector(x, 4)))),
        variant!(TEXTBOOK, |x| visible(x, beckmann_d, beckmann_g1)),
    ],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(48.0, "20 of D, 20 of G₁, 6 of wo·wm, 2 of the products")],
    coarser: 1,
};

pub const GGX_PDF: Family = Family {
    name: "ggx-pdf",
    about: "pdf of the visible normals of a GGX surface",
    reference: |x| visible_normals(x, ggx_d, ggx_cos_lambda),
    variants: &[
        variant!(STABLE, |x| scalar(Ggx::new(x[0]).pdf_vndf(vector(x, 1), vector(x, 4)))),
        variant!(TEXTBOOK, |x| visible(x, ggx_d, ggx_g1)),
    ],
    bounds: &[Bound::roundings(33.0, "13 of D, 12 of G₁, 6 of wo·wm, 2 of the products")],
    ..BECKMANN_PDF
};

/// D(m) max(0, wo·m) G₁(wo) / |cos θₒ|, for functions of α, sin² and cos: normals that face away are not visible.
fn visible_normals<T: Number>(x: &[T], d: fn(T, T, T) -> T, cos_lambda: fn(T, T, T) -> T) -> Value<T> {
    let (alpha, wo, wm) = (x[0], vector(x, 1), vector(x, 4));
    let facing = dot(wo, wm);
    if facing <= T::of(0.0) {
        return scalar(T::of(0.0));
    }
    scalar(above_horizon(d, alpha, wm) * facing * masking(cos_lambda, alpha, wo)[1])
}

/// The same as printed, by sin² θ = 1 − cos² θ and without its support.
fn visible<T: Number>(x: &[T], d: fn(T, T, T) -> T, g1: fn(T, T, T) -> T) -> Value<T> {
    let (alpha, wo, wm): (T, [T; 3], [T; 3]) = (x[0], vector(x, 1), vector(x, 4));
    scalar(d(alpha, sin2_from_z(wm), wm[2]) * dot(wo, wm) * g1(alpha, sin2_from_z(wo), wo[2]) / wo[2])
}
