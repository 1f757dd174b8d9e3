//! Families of formulas: samples of visible normals (VNDF).

use super::family::*;
use super::number::Precise;
use etalon_core::optics::microfacet::{Beckmann, Ggx};
use etalon_core::sampling::normals::SampleNormals;
use etalon_core::sampling::warp;
use glam::DVec3;

pub const BECKMANN: Family = Family {
    name: "beckmann-normal",
    about: "visible normals sampled from a Beckmann surface",
    figure: "stability-sampling",
    inputs: &["alpha", "wo_x", "wo_y", "wo_z", "u0", "u1"],
    // Normals are sampled for directions above the surface.
    domains: &[POSITIVE, COSINES, COSINES, (0.0, COSINES.1), SHARES, SHARES],
    sections: &[
        Section::new("down to the horizon", ALPHA, COSINE, |alpha, cos| {
            [&[alpha][..], &of_cosine(cos), &[0.3, 0.7]].concat()
        }),
        Section::new("rare normals, cos /{θ} = 0.2", ALPHA, Scale::new("/{u}_{0}", 1e-10, 0.99), |alpha, u| {
            [&[alpha][..], &of_cosine(0.2), &[u, 0.2]].concat()
        }),
    ],
    edges: &[&[0.5, 0.0, 0.0, 1.0, 0.5, 0.5], &[0.5, 0.6, 0.0, 0.8, 0.5, 1e-7]],
    reference: beckmann_reference,
    variants: &[
        variant!(STABLE, |x| Some(Beckmann::new(x[0]).sample_vndf(vector(x, 1), [x[4], x[5]]))),
        variant!(TEXTBOOK, beckmann_textbook),
    ],
    range: Range::Unit,
    bounds: &[Bound {
        name: "relative error over condition number",
        limit: 1e-7,
        reason: "what the inversion of the slopes states, in f64 as in f32; a random number of 0 has an infinite slope",
        error: |case| {
            let judged = case.inputs[4] > 0.0 && case.inputs[5] > 0.0;
            case.rendered().filter(|_| judged).map(|d| d.relative / case.amplification())
        },
    }],
    coarser: 2,
};

/// Domain of random numbers: from 0 to below 1.
const SHARES: (f64, f64) = (0.0, 1.0 - f32::EPSILON as f64 / 2.0);

pub const GGX: Family = Family {
    name: "ggx-normal",
    about: "visible normals sampled from a GGX surface",
    reference: ggx_reference,
    variants: &[
        variant!(STABLE, |x| Some(Ggx::new(x[0]).sample_vndf(vector(x, 1), [x[4], x[5]]))),
        variant!(TEXTBOOK, ggx_textbook),
    ],
    bounds: &[Bound::roundings(20.0, "6 of the stretched direction, 8 of the point of the cap, 6 of the unit vector")],
    coarser: 1,
    ..BECKMANN
};

pub const COSINE_HEMISPHERE: Family = Family {
    name: "cosine-hemisphere",
    about: "directions sampled by the cosine",
    figure: "stability-sampling",
    inputs: &["u0", "u1"],
    domains: &[SHARES, SHARES],
    sections: &[Section::new("small numbers", SMALL, Scale { label: "/{u}_{1}", ..SMALL }, |u, v| vec![u, v])],
    edges: &[&[0.0, 0.0], &[0.5, 0.25], &[SHARES.1, 0.5]],
    reference: |x| hemisphere(x[1], x[0].sqrt(), (one() - x[0]).sqrt()),
    variants: &[Variant::new(STABLE, |x| warped(warp::cosine_hemisphere, x), |x| wide(warp::cosine_hemisphere, x))],
    range: Range::Unit,
    bounds: &[Bound::roundings(4.0, "1 of each root, 1 of the sine and the cosine, 1 of the product")],
    coarser: 1,
};

pub const UNIFORM_HEMISPHERE: Family = Family {
    name: "uniform-hemisphere",
    about: "directions sampled uniformly over the hemisphere",
    reference: |x| hemisphere(x[1], (x[0] * (one() + one() - x[0])).sqrt(), one() - x[0]),
    variants: &[Variant::new(STABLE, |x| warped(warp::uniform_hemisphere, x), |x| wide(warp::uniform_hemisphere, x))],
    ..COSINE_HEMISPHERE
};

const SMALL: Scale = Scale::new("/{u}_{0}", 1e-10, 0.99);

fn one() -> Precise {
    Precise::of(1.0)
}

/// The direction at an azimuth in turns, from the sine and the cosine of its angle with the normal.
fn hemisphere(turns: Precise, sin: Precise, cos: Precise) -> Value<Precise> {
    let [sin_phi, cos_phi] = turns.sin_cos_turns();
    Some([sin * cos_phi, sin * sin_phi, cos])
}

/// A warp as BSDFs use it, rounded at its end.
fn warped(warp: fn([f64; 2]) -> DVec3, x: &[f32]) -> Value<f32> {
    Some(warp([x[0], x[1]].map(f64::from)).as_vec3().to_array())
}

fn wide(warp: fn([f64; 2]) -> DVec3, x: &[f64]) -> Value<f64> {
    Some(warp([x[0], x[1]]).to_array())
}

fn split<T: Number>(x: &[T]) -> (T, [T; 3], [T; 2]) {
    (x[0], vector(x, 1), [x[4], x[5]])
}

/// The spherical cap as printed: z = (1 − u)(1 + v_z) − v_z, sin = √(1 − z²). Source: Dupuy & Benyoub, HPG 2023.
fn ggx_textbook<T: Number>(x: &[T]) -> Value<T> {
    let (alpha, wo, u) = split(x);
    let one = T::of(1.0);
    // Stretch the view direction to where the distribution is that of a hemisphere.
    let v = normalized([alpha * wo[0], alpha * wo[1], wo[2]]);
    // Sample the cap of normals visible from there.
    let z = (one - u[0]) * (one + v[2]) - v[2];
    let sin = (one - z.square()).sqrt();
    let [sin_phi, cos_phi] = u[1].sin_cos_turns();
    // Half vector of the cap's direction and the view, unstretched.
    Some(normalized([alpha * (sin * cos_phi + v[0]), alpha * (sin * sin_phi + v[1]), z + v[2]]))
}

/// The same with sin² = (1 − z)(1 + z): at the pole rounding would make a root of a negative number of 1 − z².
fn ggx_reference(x: &[Precise]) -> Value<Precise> {
    let (alpha, wo, u) = split(x);
    let v = normalized([alpha * wo[0], alpha * wo[1], wo[2]]);
    let below = u[0] * (one() + v[2]);
    let sin = (below * (one() + one() - below)).sqrt();
    let [sin_phi, cos_phi] = u[1].sin_cos_turns();
    Some(normalized([alpha * (sin * cos_phi + v[0]), alpha * (sin * sin_phi + v[1]), one() - below + v[2]]))
}

/// By inversion of the distributions of slopes along and across `wo`, to 256 bits. A random number of 0 counts as 10⁻³⁰.
fn beckmann_reference(x: &[Precise]) -> Value<Precise> {
    from_slopes(x, |cos, slope, u| newton(cos, slope, u, bisect(cos.to_f64(), slope.to_f64(), u.to_f64())))
}

/// The same by bisection alone, in the precision at hand.
fn beckmann_textbook<T: Machine>(x: &[T]) -> Value<T> {
    from_slopes(x, bisect)
}

/// The normal of slopes sampled along and across `wo`; `visible` inverts the distribution of the visible slopes, for a
/// cosine with the normal, a slope of the view in units of 1/α, and a random number.
fn from_slopes<T: Number>(x: &[T], visible: impl Fn(T, T, T) -> T) -> Value<T> {
    let (alpha, wo, u) = split(x);
    let sin = (wo[0].square() + wo[1].square()).sqrt();
    let (zero, one) = (T::of(0.0), T::of(1.0));
    // Azimuth of the view; any at normal incidence.
    let azimuth = if sin > zero { [wo[0] / sin, wo[1] / sin] } else { [one, zero] };
    let least = T::of(1e-30);
    let u = u.map(|u| if u < least { least } else { u });
    let along = alpha * visible(wo[2], alpha * sin, u[0]);
    // Across the view, slopes are distributed as from above.
    let across = alpha * visible(one, zero, u[1]);
    let slopes = [along * azimuth[0] - across * azimuth[1], along * azimuth[1] + across * azimuth[0]];
    Some(normalized([-slopes[0], -slopes[1], one]))
}

/// Visible area of slopes up to `s` from the direction (slope, cos), not normalized: cos (1 + erf s) + slope exp(−s²)/√π.
fn cdf<T: Number>(cos: T, slope: T, s: T) -> T {
    let below = if s < T::of(0.0) { (-s).erfc() } else { T::of(2.0) - s.erfc() };
    cos * below + slope * (-s.square()).exp() / T::pi().sqrt()
}

/// The steepest slope that faces the view, or one beyond which the distribution is 0 to all digits.
fn steepest<T: Number>(cos: T, slope: T) -> T {
    let most = T::of(9.0);
    if cos < most * slope { cos / slope } else { most }
}

/// Solves cdf(s) = u cdf(∞) by bisection.
fn bisect<T: Number>(cos: T, slope: T, u: T) -> T {
    let (mut low, mut high) = (T::of(-9.0), steepest(cos, slope));
    let share = u * cdf(cos, slope, high);
    for _ in 0..100 {
        let middle = (low + high) / T::of(2.0);
        if cdf(cos, slope, middle) < share { low = middle } else { high = middle }
    }
    (low + high) / T::of(2.0)
}

/// The same by Newton's method from a start of 15 digits, which each step doubles.
fn newton(cos: Precise, slope: Precise, u: Precise, start: f64) -> Precise {
    let limit = if cos < Precise::of(1e3) * slope { cos / slope } else { Precise::of(1e3) };
    let share = u * cdf(cos, slope, limit);
    let root_pi = Precise::pi().sqrt();
    (0..2).fold(Precise::of(start), |s, _| {
        let derivative = Precise::of(2.0) / root_pi * (-s.square()).exp() * (cos - s * slope);
        s - (cdf(cos, slope, s) - share) / derivative
    })
}
