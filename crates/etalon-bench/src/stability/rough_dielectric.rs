//! Families of formulas: refraction at a rough dielectric boundary.

use super::dielectric::textbook_reflectance;
use super::family::*;
use super::microfacet::{above_horizon, ggx_cos_lambda, ggx_d, ggx_g1, masking};
use etalon_core::bsdf::{RoughDielectric, Scatter, refracting_facet};
use etalon_core::math::Rgb;
use etalon_core::optics::microfacet::Ggx;
use glam::DVec3;

/// Pairs of directions are refracted at this facet, tilted towards `wo`; they are rounded to the precision of the case.
const TILT: f64 = 0.1;

const MORE: Scale = Scale::new("/{η} − 1", 1e-5, 1.4);

pub const HALF_VECTOR: Family = Family {
    name: "refraction-half-vector",
    about: "normal of the facet that refracts one direction into another",
    figure: "stability-geometry",
    inputs: &["eta", "wo_x", "wo_y", "wo_z", "wi_x", "wi_y", "wi_z"],
    domains: &[INDEX],
    sections: &[
        Section::new("seen from outside", MORE, COSINE, |more, cos| outside(1.0 + more, cos, TILT)),
        Section::new("seen from inside", MORE, COSINE, |more, cos| inside(1.0 + more, cos, TILT)),
    ],
    edges: &[&[1.5, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0], &[1.5, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0]],
    reference: |x| refracting(facet_of_directions(x)).map(|facet| facet.wm),
    variants: &[
        Variant::single(STABLE, |x| rendered(x).map(|(wm, _)| wm)),
        variant!(TEXTBOOK, |x| refracting(facet(x)).map(|facet| facet.wm)),
    ],
    range: Range::Unit,
    bounds: &[Bound::roundings(4.0, "1 of each difference in f64, 2 of the length and 1 of the quotient")],
    coarser: 1,
};

pub const JACOBIAN: Family = Family {
    name: "refraction-jacobian",
    about: "solid angle of the facets' normals over that of the refracted directions",
    reference: |x| refracting(facet_of_directions(x)).and_then(|facet| scalar(facet.jacobian)),
    variants: &[
        Variant::single(STABLE, |x| rendered(x).and_then(|(_, jacobian)| scalar(jacobian))),
        variant!(TEXTBOOK, |x| refracting(facet(x)).and_then(|facet| scalar(facet.jacobian))),
    ],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(8.0, "2 of the length, 2 of the cosine, 1 of |h|², 3 of the quotient and η²")],
    ..HALF_VECTOR
};

pub const PDF: Family = Family {
    name: "dielectric-pdf",
    about: "pdf of the direction reflected or refracted at a rough GGX surface",
    figure: "stability-microfacet",
    inputs: &["alpha", "eta", "wo_x", "wo_y", "wo_z", "wi_x", "wi_y", "wi_z"],
    domains: &[POSITIVE, INDEX],
    sections: &[
        Section::new("seen from outside, /{η} = 1.5", ROUGH, COSINE, |alpha, cos| {
            [vec![alpha], outside(1.5, cos, 0.7 * alpha)].concat()
        }),
        Section::new("nearly equal indices, /{α} = 0.3", MORE, COSINE, |more, cos| {
            [vec![0.3], outside(1.0 + more, cos, 0.2)].concat()
        }),
        Section::new("seen from inside, /{η} = 1.5", ROUGH, COSINE, |alpha, cos| {
            [vec![alpha], inside(1.5, cos, 0.7 * alpha)].concat()
        }),
    ],
    edges: &[&[0.5, 1.5, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0], &[0.5, 1.5, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0]],
    reference: |x| {
        let Some(facet) = facet_of_directions(&x[1..]) else { return scalar(Number::of(0.0)) };
        let seen = above_horizon(ggx_d, x[0], facet.wm) * masking(ggx_cos_lambda, x[0], vector(x, 2))[1];
        scattered(&facet, seen)
    },
    variants: &[
        Variant::single(STABLE, |x| {
            let [wo, wi] = [vector(x, 2), vector(x, 5)];
            let boundary = RoughDielectric::new(Ggx::new(x[0]), Rgb::ONE, Rgb::ONE, x[1]);
            scalar(boundary.pdf(wo.into(), wi.into()))
        }),
        variant!(TEXTBOOK, |x| facet(&x[1..]).and_then(|facet| textbook_pdf(x, &facet))),
    ],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound {
        name: "last places over condition number",
        limit: 45.0,
        reason: "13 of D, 12 of G₁, 8 of 1 − F, 8 of the Jacobian, 4 of the products; of a denormal cosine that of the facet's normal may be lost",
        error: |case| {
            let judged = [case.inputs[4], case.inputs[7]].iter().all(|z| *z == 0.0 || (*z as f32).is_normal());
            case.rendered().filter(|_| judged).map(|d| d.ulp / case.amplification())
        },
    }],
    coarser: 1,
};

/// Widths that renders take for rough at these indices.
const ROUGH: Scale = Scale::new("/{α}", 1e-4, 1.0);

/// η, `wo` of that cosine outside, and the direction that it is refracted to at a facet of that slope.
fn outside(eta: f64, cos: f64, slope: f64) -> Vec<f64> {
    let (wo, m) = (DVec3::from_array(of_cosine(cos)), DVec3::from_array(of_slope(slope)));
    let c = wo.dot(m);
    let g = ((eta - 1.0) * (eta + 1.0) + c * c).sqrt();
    let wi = (-(eta - 1.0) * (eta + 1.0) / (c + g) * m - wo) / eta;
    [vec![eta], wo.to_array().to_vec(), wi.normalize().to_array().to_vec()].concat()
}

/// The same, seen from the other side.
fn inside(eta: f64, cos: f64, slope: f64) -> Vec<f64> {
    let x = outside(eta, cos, slope);
    [&x[..1], &x[4..], &x[1..4]].concat()
}

/// What the renderer computes.
fn rendered(x: &[f32]) -> Option<([f32; 3], f32)> {
    refracting_facet(x[0], vector(x, 1).into(), vector(x, 4).into())
}

/// The facet if it refracts.
fn refracting<T>(facet: Option<Facet<T>>) -> Option<Facet<T>> {
    facet.filter(|facet| !facet.reflects)
}

/// A facet between two directions.
struct Facet<T> {
    /// Its normal, on the side of z > 0.
    wm: [T; 3],
    /// Its cosine with `wo`, without the sign.
    cos: T,
    reflects: bool,
    /// The index on the far side over that on the side of `wo`.
    eta: T,
    jacobian: T,
}

/// The facet between the directions that the rounded components point to.
fn facet_of_directions<T: Number>(x: &[T]) -> Option<Facet<T>> {
    let ([ox, oy, oz], [ix, iy, iz]) = (normalized(vector(x, 1)), normalized(vector(x, 4)));
    facet(&[x[0], ox, oy, oz, ix, iy, iz])
}

/// m along wo + s wi, and s² |wi·m| / (wo·m + s wi·m)², s = η for refraction and 1 for reflection. Source: Walter et al., EGSR 2007, eq. 16 and 17.
fn facet<T: Number>(x: &[T]) -> Option<Facet<T>> {
    let (zero, one) = (T::of(0.0), T::of(1.0));
    let (wo, wi): ([T; 3], [T; 3]) = (vector(x, 1), vector(x, 4));
    let eta = if wo[2] < zero { one / x[0] } else { x[0] };
    let reflects = wo[2] * wi[2] > zero;
    let s = if reflects { one } else { eta };
    let h: [T; 3] = std::array::from_fn(|c| wo[c] + s * wi[c]);
    let wm = normalized(if h[2] < zero { h.map(|h| -h) } else { h });
    let (cos_o, cos_i) = (dot(wo, wm), dot(wi, wm));
    // Both directions meet the facet on the side of the surface that they are on.
    // Both directions along the surface to all digits of f32 have no facet between them.
    let exists = cos_o * wo[2] > zero && cos_i * wi[2] > zero && dot(h, h) > T::of(1e-36);
    let cos_i = if cos_i < zero { -cos_i } else { cos_i };
    let jacobian = s.square() * cos_i / (cos_o + s * dot(wi, wm)).square();
    exists.then(|| Facet { wm, reflects, cos: if cos_o < zero { -cos_o } else { cos_o }, eta, jacobian })
}

/// F or 1 − F times |wo·m|, the Jacobian and D G₁ / |cos θₒ|, which is `seen`.
fn scattered<T: Number>(facet: &Facet<T>, seen: T) -> Value<T> {
    let reflected = textbook_reflectance(&[facet.eta, facet.cos])?[0];
    let share = if facet.reflects { reflected } else { T::of(1.0) - reflected };
    scalar(share * seen * facet.cos * facet.jacobian)
}

/// By sin² θ = 1 − cos² θ.
fn textbook_pdf<T: Number>(x: &[T], facet: &Facet<T>) -> Value<T> {
    let (alpha, wo): (T, [T; 3]) = (x[0], vector(x, 2));
    let cos = if wo[2] < T::of(0.0) { -wo[2] } else { wo[2] };
    let d = ggx_d(alpha, sin2_from_z(facet.wm), facet.wm[2]);
    scattered(facet, d * ggx_g1(alpha, sin2_from_z(wo), cos) / cos)
}
