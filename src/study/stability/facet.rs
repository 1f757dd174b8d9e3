//! The facet that reflects one direction into another: its normal, the half vector, and the cosine with either.

use super::directions::vector;
use super::family::{
    Bound, Family, Number, Range, STABLE, Scale, Section, TEXTBOOK, Value, Variant, dot, normalized, scalar, variant,
};
use crate::bsdf::Facet;

/// The half vector.
pub const NORMAL: Family = Family {
    name: "half-vector",
    about: "normal of the facet between nearly opposite directions",
    figure: "stability-geometry",
    inputs: &["wo_x", "wo_y", "wo_z", "wi_x", "wi_y", "wi_z"],
    domains: &[],
    sections: &[Section {
        title: "opposite azimuths, both near the horizon",
        x: Scale::new("cos /{θ}_{o}", 1e-10, 1.0),
        y: Scale::new("cos /{θ}_{i}", 1e-10, 1.0),
        at: |o, i| {
            let sin = |cos: f64| ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
            // Azimuths that are not exactly opposite: rounding errors would otherwise cancel alike in x and y.
            vec![0.6 * sin(o), 0.8 * sin(o), o, -0.600_000_8 * sin(i), -0.799_999_4 * sin(i), i]
        },
    }],
    edges: &[&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0], &[0.6, 0.0, 0.8, -0.6, 0.0, 0.8]],
    reference: normal,
    variants: &[Variant::single(STABLE, |x| rendered(x).map(|facet| facet.wm)), variant!(TEXTBOOK, normal)],
    range: Range::Unit,
    bounds: &[Bound::roundings(8.0, "3 of the sum, 4 of its length, 1 of the quotient")],
    coarser: 1,
};

/// The cosine of either direction with the half vector.
pub const COSINE: Family = Family {
    name: "half-cosine",
    about: "cosine of nearly opposite directions with the facet between them",
    reference: |x| scalar(dot(sum(x), sum(x)).sqrt() / Number::of(2.0)),
    variants: &[
        Variant::single(STABLE, |x| rendered(x).and_then(|facet| scalar(facet.cos))),
        variant!(TEXTBOOK, |x| scalar(dot(vector(x, 0), normalized(sum(x))))),
    ],
    range: Range::UpTo(1.0),
    bounds: &[Bound::roundings(8.0, "3 of the sum, 4 of its length, 1 of the half")],
    ..NORMAL
};

/// wo + wi.
fn sum<T: Number>(x: &[T]) -> [T; 3] {
    let [wo, wi] = [vector(x, 0), vector(x, 3)];
    std::array::from_fn(|c| wo[c] + wi[c])
}

fn rendered(x: &[f32]) -> Option<Facet> {
    Facet::between(vector(x, 0).into(), vector(x, 3).into())
}

/// (wo + wi) / |wo + wi|.
fn normal<T: Number>(x: &[T]) -> Value<T> {
    Some(normalized(sum(x)))
}
