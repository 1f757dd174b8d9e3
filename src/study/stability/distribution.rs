//! The density of microfacet normals, D.

use super::bound::Bound;
use super::family::{Family, POSITIVE, Range, STABLE, Scale, Section, TEXTBOOK, Value, Variant, scalar};
use super::number::{Machine, Number};
use super::refraction::direction;
use crate::optics::microfacet::{Beckmann, Ggx, Microfacet};

pub const BECKMANN: Family = Family {
    name: "beckmann-d",
    about: "Beckmann's density of normals",
    figure: "stability-microfacet",
    inputs: INPUTS,
    domains: &[POSITIVE],
    // Beyond tan θ = 8 α there is less than 10⁻²⁷ of the normals.
    sections: &[
        Section { title: "over the lobe", x: ALPHA, y: Scale::new(SLOPE, 1e-3, 8.0), at: over_the_lobe },
        GRAZING,
    ],
    edges: EDGES,
    reference: beckmann_reference,
    variants: &[
        Variant::new(STABLE, beckmann_stable, beckmann_stable),
        Variant::new(TEXTBOOK, beckmann_textbook, beckmann_textbook),
    ],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(20.0, "9 of the root of D, twice, and 2 of what exp leaves")],
    coarser: 1,
};

pub const GGX: Family = Family {
    name: "ggx-d",
    about: "the GGX density of normals",
    figure: "stability-microfacet",
    inputs: INPUTS,
    domains: &[POSITIVE],
    sections: &[
        Section { title: "over the lobe", x: ALPHA, y: Scale::new(SLOPE, 1e-3, 1e4), at: over_the_lobe },
        GRAZING,
    ],
    edges: EDGES,
    reference: ggx_reference,
    variants: &[Variant::new(STABLE, ggx_stable, ggx_stable), Variant::new(TEXTBOOK, ggx_textbook, ggx_textbook)],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(13.0, "5 of the root of D, twice, and 3 of its square over π")],
    coarser: 1,
};

const INPUTS: &[&str] = &["alpha", "x", "y", "z"];
const EDGES: &[&[f64]] =
    &[&[1e-5, 0.0, 0.0, 1.0], &[0.5, 0.0, 0.0, 1.0], &[10.0, 0.0, 0.0, 1.0], &[0.5, 0.6, 0.0, -0.8]];
const SLOPE: &str = "tan /{θ}_{m} / /{α}";
pub(super) const ALPHA: Scale = Scale::new("/{α}", 1e-5, 10.0);

const GRAZING: Section = Section {
    title: "down to the horizon",
    x: ALPHA,
    y: super::fresnel::COSINE,
    at: |alpha, cos| at(alpha, direction(cos)),
};

fn at(alpha: f64, w: [f64; 3]) -> Vec<f64> {
    vec![alpha, w[0], w[1], w[2]]
}

fn over_the_lobe(alpha: f64, slope: f64) -> Vec<f64> {
    at(alpha, of_slope(alpha * slope))
}

/// The unit vector of that tan θ.
pub(super) fn of_slope(tan: f64) -> [f64; 3] {
    let cos = (1.0 + tan * tan).sqrt().recip();
    [0.6 * tan * cos, 0.8 * tan * cos, cos]
}

fn beckmann_stable<T: Machine>(x: &[T]) -> Value<T> {
    scalar(Beckmann::new(x[0]).d([x[1], x[2], x[3]]))
}

fn ggx_stable<T: Machine>(x: &[T]) -> Value<T> {
    scalar(Ggx::new(x[0]).d([x[1], x[2], x[3]]))
}

fn beckmann_reference<T: Number>(x: &[T]) -> Value<T> {
    above(x, beckmann(x[0], x[1].square() + x[2].square(), x[3]))
}

fn ggx_reference<T: Number>(x: &[T]) -> Value<T> {
    above(x, ggx(x[0], x[1].square() + x[2].square(), x[3]))
}

/// There are no normals below the horizon.
fn above<T: Number>(x: &[T], d: T) -> Value<T> {
    scalar(if x[3] > T::of(0.0) { d } else { T::of(0.0) })
}

/// With sin² = 1 − cos², as books and most renderers have it.
fn beckmann_textbook<T: Number>(x: &[T]) -> Value<T> {
    scalar(beckmann(x[0], T::of(1.0) - x[3].square(), x[3]))
}

fn ggx_textbook<T: Number>(x: &[T]) -> Value<T> {
    scalar(ggx(x[0], T::of(1.0) - x[3].square(), x[3]))
}

/// exp(−tan²θ/α²) / (π α² cos⁴θ).
pub(super) fn beckmann<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    let (alpha2, cos2) = (alpha.square(), cos.square());
    (-(sin2 / cos2) / alpha2).exp() / (T::pi() * alpha2 * cos2.square())
}

/// α² / (π cos⁴θ (α² + tan²θ)²).
pub(super) fn ggx<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    let (alpha2, cos2) = (alpha.square(), cos.square());
    alpha2 / (T::pi() * cos2.square() * (alpha2 + sin2 / cos2).square())
}
