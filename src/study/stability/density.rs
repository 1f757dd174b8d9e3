//! The pdf of visible normals (VNDF).

use super::directions::{ALPHA, COSINE, of_cosine, of_slope, sin2_from_xy, sin2_from_z, vector};
use super::family::{Bound, Family, Number, POSITIVE, Range, STABLE, Section, TEXTBOOK, Value, dot, scalar, variant};
use super::{distribution, shadowing};
use crate::optics::microfacet::{Beckmann, Ggx};
use crate::sampling::normals::SampleNormals;

/// The pdf of Beckmann's visible normals.
pub const BECKMANN: Family = Family {
    name: "beckmann-pdf",
    about: "pdf of the visible normals of a Beckmann surface",
    figure: "stability-microfacet",
    inputs: &["alpha", "wo_x", "wo_y", "wo_z", "wm_x", "wm_y", "wm_z"],
    domains: &[POSITIVE],
    sections: &[Section {
        title: "a typical normal, tilted towards the view",
        x: ALPHA,
        y: COSINE,
        at: |alpha, cos| [&[alpha][..], &of_cosine(cos), &of_slope(0.7 * alpha)].concat(),
    }],
    edges: &[&[0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0], &[1e-5, 0.6, 0.0, 0.8, 0.0, 0.0, 1.0]],
    reference: |x| visible(x, sin2_from_xy, distribution::beckmann, shadowing::beckmann),
    variants: &[
        variant!(STABLE, |x| scalar(Beckmann::new(x[0]).pdf_vndf(vector(x, 1), vector(x, 4)))),
        variant!(TEXTBOOK, |x| visible(x, sin2_from_z, distribution::beckmann, shadowing::beckmann)),
    ],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(48.0, "20 of D, 20 of G₁, 6 of wo·wm, 2 of the products")],
    coarser: 1,
};

/// The pdf of visible normals of GGX.
pub const GGX: Family = Family {
    name: "ggx-pdf",
    about: "pdf of the visible normals of a GGX surface",
    reference: |x| visible(x, sin2_from_xy, distribution::ggx, shadowing::ggx),
    variants: &[
        variant!(STABLE, |x| scalar(Ggx::new(x[0]).pdf_vndf(vector(x, 1), vector(x, 4)))),
        variant!(TEXTBOOK, |x| visible(x, sin2_from_z, distribution::ggx, shadowing::ggx)),
    ],
    bounds: &[Bound::roundings(33.0, "13 of D, 12 of G₁, 6 of wo·wm, 2 of the products")],
    ..BECKMANN
};

/// D(m) (wo·m) G₁(wo) / cos θₒ, for functions of α, sin² and cos.
fn visible<T: Number>(x: &[T], sin2: fn([T; 3]) -> T, d: fn(T, T, T) -> T, g1: fn(T, T, T) -> T) -> Value<T> {
    let (alpha, wo, wm) = (x[0], vector(x, 1), vector(x, 4));
    scalar(d(alpha, sin2(wm), wm[2]) * dot(wo, wm) * g1(alpha, sin2(wo), wo[2]) / wo[2])
}
