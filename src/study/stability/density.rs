//! The density of the normals that are seen from a direction.

use super::bound::Bound;
use super::distribution::{self, ALPHA, of_slope};
use super::family::{Family, POSITIVE, Range, STABLE, Section, TEXTBOOK, Value, Variant, scalar};
use super::fresnel::COSINE;
use super::number::{Machine, Number, dot};
use super::refraction::direction;
use super::shadowing;
use crate::optics::microfacet::{Beckmann, Ggx};
use crate::sampling::normals::SampleNormals;

pub const BECKMANN: Family = Family {
    name: "beckmann-pdf",
    about: "density of the visible normals of a Beckmann surface",
    figure: "stability-microfacet",
    inputs: INPUTS,
    domains: &[POSITIVE],
    sections: SECTIONS,
    edges: EDGES,
    reference: beckmann_reference,
    variants: &[
        Variant::new(STABLE, beckmann_stable, beckmann_stable),
        Variant::new(TEXTBOOK, beckmann_textbook, beckmann_textbook),
    ],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(48.0, "20 of D, 20 of G₁, 6 of wo·wm, 2 of the products")],
    coarser: 1,
};

pub const GGX: Family = Family {
    name: "ggx-pdf",
    about: "density of the visible normals of a GGX surface",
    figure: "stability-microfacet",
    inputs: INPUTS,
    domains: &[POSITIVE],
    sections: SECTIONS,
    edges: EDGES,
    reference: ggx_reference,
    variants: &[Variant::new(STABLE, ggx_stable, ggx_stable), Variant::new(TEXTBOOK, ggx_textbook, ggx_textbook)],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(33.0, "13 of D, 12 of G₁, 6 of wo·wm, 2 of the products")],
    coarser: 1,
};

const INPUTS: &[&str] = &["alpha", "wo_x", "wo_y", "wo_z", "wm_x", "wm_y", "wm_z"];
const EDGES: &[&[f64]] = &[&[0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0], &[1e-5, 0.6, 0.0, 0.8, 0.0, 0.0, 1.0]];
const SECTIONS: &[Section] = &[Section {
    title: "a typical normal, tilted towards the view",
    x: ALPHA,
    y: COSINE,
    at: |alpha, cos| [&[alpha][..], &direction(cos), &of_slope(0.7 * alpha)].concat(),
}];

fn split<T: Number>(x: &[T]) -> (T, [T; 3], [T; 3]) {
    (x[0], [x[1], x[2], x[3]], [x[4], x[5], x[6]])
}

fn beckmann_stable<T: Machine>(x: &[T]) -> Value<T> {
    let (alpha, wo, wm) = split(x);
    scalar(Beckmann::new(alpha).pdf_vndf(wo, wm))
}

fn ggx_stable<T: Machine>(x: &[T]) -> Value<T> {
    let (alpha, wo, wm) = split(x);
    scalar(Ggx::new(alpha).pdf_vndf(wo, wm))
}

/// D(m) (wo·m) G₁(wo) / cos θₒ, for functions of α, sin² and cos.
fn visible<T: Number>(x: &[T], sin2: fn([T; 3]) -> T, d: fn(T, T, T) -> T, g1: fn(T, T, T) -> T) -> Value<T> {
    let (alpha, wo, wm) = split(x);
    scalar(d(alpha, sin2(wm), wm[2]) * dot(wo, wm) * g1(alpha, sin2(wo), wo[2]) / wo[2])
}

fn from_xy<T: Number>(w: [T; 3]) -> T {
    w[0].square() + w[1].square()
}

fn from_z<T: Number>(w: [T; 3]) -> T {
    T::of(1.0) - w[2].square()
}

fn beckmann_reference<T: Number>(x: &[T]) -> Value<T> {
    visible(x, from_xy, distribution::beckmann, shadowing::beckmann)
}

fn beckmann_textbook<T: Number>(x: &[T]) -> Value<T> {
    visible(x, from_z, distribution::beckmann, shadowing::beckmann)
}

fn ggx_reference<T: Number>(x: &[T]) -> Value<T> {
    visible(x, from_xy, distribution::ggx, shadowing::ggx)
}

fn ggx_textbook<T: Number>(x: &[T]) -> Value<T> {
    visible(x, from_z, distribution::ggx, shadowing::ggx)
}
