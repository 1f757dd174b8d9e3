//! The facet that reflects one direction into another: its normal, the half vector, and the cosine with either.

use super::bound::Bound;
use super::family::{Family, Range, STABLE, Scale, Section, TEXTBOOK, Value, Variant, scalar};
use super::number::{Number, dot, normalized};
use crate::bsdf::Facet;
use glam::Vec3;

pub const NORMAL: Family = Family {
    name: "half-vector",
    about: "normal of the facet between nearly opposite directions",
    figure: "stability-geometry",
    inputs: INPUTS,
    domains: &[],
    sections: SECTIONS,
    edges: EDGES,
    reference: normal,
    variants: &[Variant::single(STABLE, rendered_normal), Variant::new(TEXTBOOK, normal, normal)],
    range: Range::Unit,
    bounds: &[Bound::roundings(8.0, "3 of the sum, 4 of its length, 1 of the quotient")],
    coarser: 1,
};

pub const COSINE: Family = Family {
    name: "half-cosine",
    about: "cosine of nearly opposite directions with the facet between them",
    figure: "stability-geometry",
    inputs: INPUTS,
    domains: &[],
    sections: SECTIONS,
    edges: EDGES,
    reference: |x| cosine(x),
    variants: &[Variant::single(STABLE, rendered_cosine), Variant::new(TEXTBOOK, projected, projected)],
    range: Range::UpTo(1.0),
    bounds: &[Bound::roundings(8.0, "3 of the sum, 4 of its length, 1 of the half")],
    coarser: 1,
};

const INPUTS: &[&str] = &["wo_x", "wo_y", "wo_z", "wi_x", "wi_y", "wi_z"];
const EDGES: &[&[f64]] = &[&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0], &[0.6, 0.0, 0.8, -0.6, 0.0, 0.8]];
const SECTIONS: &[Section] = &[Section {
    title: "opposite azimuths, both near the horizon",
    x: Scale::new("cos /{θ}_{o}", 1e-10, 1.0),
    y: Scale::new("cos /{θ}_{i}", 1e-10, 1.0),
    at: |o, i| {
        let sin = |cos: f64| ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
        // A little apart in azimuth, or rounding would cancel alike in x and y.
        vec![0.6 * sin(o), 0.8 * sin(o), o, -0.600_000_8 * sin(i), -0.799_999_4 * sin(i), i]
    },
}];

fn split<T: Number>(x: &[T]) -> [[T; 3]; 2] {
    [[x[0], x[1], x[2]], [x[3], x[4], x[5]]]
}

fn sum<T: Number>(x: &[T]) -> [T; 3] {
    let [wo, wi] = split(x);
    std::array::from_fn(|c| wo[c] + wi[c])
}

fn rendered(x: &[f32]) -> Option<Facet> {
    let [wo, wi] = split(x).map(Vec3::from_array);
    Facet::between(wo, wi)
}

fn rendered_normal(x: &[f32]) -> Value<f32> {
    rendered(x).map(|facet| facet.wm)
}

fn rendered_cosine(x: &[f32]) -> Value<f32> {
    rendered(x).and_then(|facet| scalar(facet.cos))
}

/// (wo + wi) / |wo + wi|.
fn normal<T: Number>(x: &[T]) -> Value<T> {
    Some(normalized(sum(x)))
}

/// |wo + wi| / 2.
fn cosine<T: Number>(x: &[T]) -> Value<T> {
    let sum = sum(x);
    scalar(dot(sum, sum).sqrt() / T::of(2.0))
}

/// wo · wm.
fn projected<T: Number>(x: &[T]) -> Value<T> {
    let [wo, _] = split(x);
    scalar(dot(wo, normalized(sum(x))))
}
