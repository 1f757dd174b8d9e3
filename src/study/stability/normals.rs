//! Drawing the normals that are seen from a direction.

use super::bound::Bound;
use super::distribution::ALPHA;
use super::family::{Family, POSITIVE, Range, STABLE, Scale, Section, TEXTBOOK, Value, Variant};
use super::fresnel::COSINE;
use super::number::{Machine, Number, normalized};
use super::precise::Precise;
use super::refraction::direction;
use crate::optics::microfacet::{Beckmann, Ggx};
use crate::sampling::normals::SampleNormals;

pub const BECKMANN: Family = Family {
    name: "beckmann-normal",
    about: "visible normals drawn from a Beckmann surface",
    figure: "stability-sampling",
    inputs: INPUTS,
    domains: &[POSITIVE],
    sections: SECTIONS,
    edges: EDGES,
    reference: beckmann_reference,
    variants: &[
        Variant::new(STABLE, beckmann_stable, beckmann_stable),
        Variant::new(TEXTBOOK, beckmann_textbook, beckmann_textbook),
    ],
    range: Range::Unit,
    bounds: &[Bound {
        name: "relative error over condition number",
        limit: 1e-7,
        reason: "what the inversion of the slopes states, in f64 as in f32",
        error: |case| case.deviations[0].map(|d| d.relative / case.condition.max(1.0)),
    }],
    coarser: 2,
};

pub const GGX: Family = Family {
    name: "ggx-normal",
    about: "visible normals drawn from a GGX surface",
    figure: "stability-sampling",
    inputs: INPUTS,
    domains: &[POSITIVE],
    sections: SECTIONS,
    edges: EDGES,
    reference: ggx_textbook,
    variants: &[Variant::new(STABLE, ggx_stable, ggx_stable), Variant::new(TEXTBOOK, ggx_textbook, ggx_textbook)],
    range: Range::Unit,
    bounds: &[Bound::roundings(20.0, "6 of the stretched direction, 8 of the point of the cap, 6 of the unit vector")],
    coarser: 1,
};

const INPUTS: &[&str] = &["alpha", "wo_x", "wo_y", "wo_z", "u0", "u1"];
const EDGES: &[&[f64]] = &[&[0.5, 0.0, 0.0, 1.0, 0.5, 0.5], &[0.5, 0.6, 0.0, 0.8, 0.5, 1e-7]];
const SECTIONS: &[Section] = &[
    Section {
        title: "down to the horizon",
        x: ALPHA,
        y: COSINE,
        at: |alpha, cos| [&[alpha][..], &direction(cos), &[0.3, 0.7]].concat(),
    },
    Section {
        title: "rare normals, cos /{θ} = 0.2",
        x: ALPHA,
        y: Scale::new("/{u}_{0}", 1e-10, 0.99),
        at: |alpha, u| [&[alpha][..], &direction(0.2), &[u, 0.2]].concat(),
    },
];

fn split<T: Number>(x: &[T]) -> (T, [T; 3], [T; 2]) {
    (x[0], [x[1], x[2], x[3]], [x[4], x[5]])
}

fn beckmann_stable<T: Machine>(x: &[T]) -> Value<T> {
    let (alpha, wo, u) = split(x);
    Some(Beckmann::new(alpha).sample_vndf(wo, u))
}

fn ggx_stable<T: Machine>(x: &[T]) -> Value<T> {
    let (alpha, wo, u) = split(x);
    Some(Ggx::new(alpha).sample_vndf(wo, u))
}

/// The spherical cap as printed: z = (1 − u)(1 + v_z) − v_z, sin = √(1 − z²). Source: Dupuy & Benyoub, HPG 2023.
fn ggx_textbook<T: Number>(x: &[T]) -> Value<T> {
    let (alpha, wo, u) = split(x);
    let one = T::of(1.0);
    let v = normalized([alpha * wo[0], alpha * wo[1], wo[2]]);
    let z = (one - u[0]) * (one + v[2]) - v[2];
    let sin = (one - z.square()).sqrt();
    let [sin_phi, cos_phi] = u[1].sin_cos_turns();
    Some(normalized([alpha * (sin * cos_phi + v[0]), alpha * (sin * sin_phi + v[1]), z + v[2]]))
}

/// The slopes along and across `wo` by inversion of their distributions, made a unit vector.
fn beckmann_reference(x: &[Precise]) -> Value<Precise> {
    from_slopes(x, |cos, slope, u| polished(cos, slope, u, bisected(cos.to_f64(), slope.to_f64(), u.to_f64())))
}

/// The same by bisection alone, in the precision at hand.
fn beckmann_textbook<T: Machine>(x: &[T]) -> Value<T> {
    from_slopes(x, bisected)
}

fn from_slopes<T: Number>(x: &[T], visible: impl Fn(T, T, T) -> T) -> Value<T> {
    let (alpha, wo, u) = split(x);
    let sin = (wo[0].square() + wo[1].square()).sqrt();
    let (zero, one) = (T::of(0.0), T::of(1.0));
    let azimuth = if sin > zero { [wo[0] / sin, wo[1] / sin] } else { [one, zero] };
    let along = alpha * visible(wo[2], alpha * sin, u[0]);
    // Seen from above, slopes are as they lie.
    let across = alpha * visible(one, zero, u[1]);
    let slopes = [along * azimuth[0] - across * azimuth[1], along * azimuth[1] + across * azimuth[0]];
    Some(normalized([-slopes[0], -slopes[1], one]))
}

/// Slopes of up to `s` as seen from the direction (slope, cos): cos (1 + erf s) + slope exp(−s²)/√π.
fn seen<T: Number>(cos: T, slope: T, s: T) -> T {
    let below = if s < T::of(0.0) { (-s).erfc() } else { T::of(2.0) - s.erfc() };
    cos * below + slope * (-s.square()).exp() / T::pi().sqrt()
}

/// The steepest slope that is seen, or one beyond which there is nothing.
fn steepest<T: Number>(cos: T, slope: T) -> T {
    let most = T::of(9.0);
    if cos < most * slope { cos / slope } else { most }
}

/// Solves seen(s) = u seen(∞) by bisection.
fn bisected<T: Number>(cos: T, slope: T, u: T) -> T {
    let (mut low, mut high) = (T::of(-9.0), steepest(cos, slope));
    let share = u * seen(cos, slope, high);
    for _ in 0..100 {
        let middle = (low + high) / T::of(2.0);
        if seen(cos, slope, middle) < share { low = middle } else { high = middle }
    }
    (low + high) / T::of(2.0)
}

/// The same from a good start, 15 digits, by Newton's steps, each of which doubles them.
fn polished(cos: Precise, slope: Precise, u: Precise, start: f64) -> Precise {
    let limit = if cos < Precise::of(1e3) * slope { cos / slope } else { Precise::of(1e3) };
    let share = u * seen(cos, slope, limit);
    let root_pi = Precise::pi().sqrt();
    (0..2).fold(Precise::of(start), |s, _| {
        let density = Precise::of(2.0) / root_pi * (-s.square()).exp() * (cos - s * slope);
        s - (seen(cos, slope, s) - share) / density
    })
}
