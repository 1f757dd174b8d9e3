//! Smith's shadowing: Λ, by way of G₁ = 1/(1 + Λ), which is all that rendering takes from it.

use super::bound::Bound;
use super::distribution::ALPHA;
use super::family::{Family, POSITIVE, REPORT, Range, STABLE, Section, TEXTBOOK, Value, Variant, scalar};
use super::fresnel::COSINE;
use super::number::{Machine, Number};
use super::refraction::direction;
use crate::errata::microfacet::lambda_with_pi;
use crate::optics::microfacet::{Beckmann, Ggx, Microfacet};

pub const BECKMANN: Family = Family {
    name: "beckmann-g",
    about: "shadowing of a Beckmann surface",
    figure: "stability-microfacet",
    inputs: INPUTS,
    domains: &[POSITIVE],
    sections: SECTIONS,
    edges: EDGES,
    reference: beckmann_reference,
    variants: &[
        Variant::new(STABLE, beckmann_stable, beckmann_stable),
        Variant::new(TEXTBOOK, beckmann_textbook, beckmann_textbook),
        Variant::new(REPORT, beckmann_report, beckmann_report),
    ],
    range: Range::UpTo(1.0),
    bounds: &[Bound::roundings(
        20.0,
        "4 of the slope, 1 of its inverse, 5 of exp and erfcx each, 5 of the sum and the quotient",
    )],
    coarser: 1,
};

pub const GGX: Family = Family {
    name: "ggx-g",
    about: "shadowing of a GGX surface",
    figure: "stability-microfacet",
    inputs: INPUTS,
    domains: &[POSITIVE],
    sections: SECTIONS,
    edges: EDGES,
    reference: ggx_reference,
    variants: &[Variant::new(STABLE, ggx_stable, ggx_stable), Variant::new(TEXTBOOK, ggx_textbook, ggx_textbook)],
    range: Range::UpTo(1.0),
    bounds: &[Bound::roundings(12.0, "5 of the squared slope, 4 of the root and its sum, 3 of the quotients")],
    coarser: 1,
};

const INPUTS: &[&str] = &["alpha", "x", "y", "z"];
const EDGES: &[&[f64]] = &[&[1e-5, 0.0, 0.0, 1.0], &[10.0, 0.0, 0.0, 1.0], &[0.5, 0.6, 0.0, 0.8]];
const SECTIONS: &[Section] = &[Section {
    title: "down to the horizon",
    x: ALPHA,
    y: COSINE,
    at: |alpha, cos| {
        let [x, y, z] = direction(cos);
        vec![alpha, x, y, z]
    },
}];

fn beckmann_stable<T: Machine>(x: &[T]) -> Value<T> {
    scalar(Beckmann::new(x[0]).g1([x[1], x[2], x[3]]))
}

fn ggx_stable<T: Machine>(x: &[T]) -> Value<T> {
    scalar(Ggx::new(x[0]).g1([x[1], x[2], x[3]]))
}

fn beckmann_reference<T: Number>(x: &[T]) -> Value<T> {
    scalar(beckmann(x[0], x[1].square() + x[2].square(), x[3]))
}

fn ggx_reference<T: Number>(x: &[T]) -> Value<T> {
    scalar(ggx(x[0], x[1].square() + x[2].square(), x[3]))
}

fn beckmann_textbook<T: Number>(x: &[T]) -> Value<T> {
    scalar(beckmann(x[0], T::of(1.0) - x[3].square(), x[3]))
}

fn ggx_textbook<T: Number>(x: &[T]) -> Value<T> {
    scalar(ggx(x[0], T::of(1.0) - x[3].square(), x[3]))
}

/// The second report's Λ, with π in place of its root.
fn beckmann_report<T: Machine>(x: &[T]) -> Value<T> {
    let tan = Number::sqrt(T::of(1.0) - x[3].square()) / x[3];
    scalar(T::of(1.0) / (T::of(1.0) + lambda_with_pi(T::of(1.0) / (x[0] * tan))))
}

/// 1/(1 + Λ) with Λ = ½ (exp(−A²)/(A√π) − erfc A), A = 1/(α tan θ).
pub(super) fn beckmann<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    let slope = alpha * sin2.sqrt() / cos;
    let one = T::of(1.0);
    if slope == T::of(0.0) {
        return one;
    }
    let a = one / slope;
    let lambda = ((-a.square()).exp() * slope / T::pi().sqrt() - a.erfc()) / T::of(2.0);
    one / (one + lambda)
}

/// 1/(1 + Λ) with Λ = ½ (√(1 + α² tan²θ) − 1).
pub(super) fn ggx<T: Number>(alpha: T, sin2: T, cos: T) -> T {
    let one = T::of(1.0);
    let lambda = ((one + alpha.square() * (sin2 / cos.square())).sqrt() - one) / T::of(2.0);
    one / (one + lambda)
}
