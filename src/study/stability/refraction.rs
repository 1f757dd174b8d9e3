//! The direction that a smooth dielectric refracts to.

use super::directions::{COSINE, of_cosine, vector, with};
use super::family::{
    Bound, Case, Family, INDEX, Number, Range, STABLE, Scale, Section, TEXTBOOK, Value, Variant, normalized, variant,
};
use super::fresnel::{CRITICAL, above_critical};
use crate::bsdf::{Refraction, Scatter};
use crate::math::Rgb;
use crate::optics::dielectric;
use glam::Vec3;

/// The refracted unit vector; none beyond the critical angle.
pub const FAMILY: Family = Family {
    name: "refraction",
    about: "direction of the refracted ray",
    figure: "stability-fresnel",
    inputs: &["eta", "x", "y", "z"],
    domains: &[INDEX],
    sections: &[
        Section {
            title: "all indices",
            x: Scale::new("/{η}", 1e-4, 1e4),
            y: COSINE,
            at: |eta, cos| with(eta, of_cosine(cos)),
        },
        Section { at: |eta, more| with(eta, of_cosine(above_critical(eta, more))), ..CRITICAL },
    ],
    edges: &[&[1.5, 0.6, 0.8, 0.0], &[1.5, 0.0, 0.0, 1.0], &[1.0, 0.6, 0.0, 0.8], &[0.5, 0.6, 0.8, 0.0]],
    reference,
    variants: &[Variant::new(STABLE, rendered, stable), variant!(TEXTBOOK, textbook)],
    range: Range::Unit,
    bounds: &[Bound {
        name: "roundings over the slope of √ at the critical angle",
        limit: 24.0,
        reason: "8 of the length of the direction, 6 of g², half of which g keeps, and 10 in all of g and the direction",
        error: |case| case.rendered().map(|d| d.relative / (case.precision.rounding() * steepness(case))),
    }],
    coarser: 1,
};

/// Snell's law for the direction that the rounded components point to.
fn reference<T: Number>(x: &[T]) -> Value<T> {
    let [wx, wy, wz] = normalized(vector(x, 1));
    textbook(&[x[0], wx, wy, wz])
}

/// The material of the renderer.
fn rendered(x: &[f32]) -> Value<f32> {
    let material = Refraction { transmittance: Rgb::ONE, eta: x[0] };
    material.sample(Vec3::new(x[1], x[2], x[3]), 0.0, [0.0; 2]).map(|sample| sample.wi.to_array())
}

/// The same in f64: (−x, −y, −g)/η with g = η cos θₜ.
fn stable(x: &[f64]) -> Value<f64> {
    dielectric::eta_cos_t(x[3], x[0]).map(|g| [-x[1], -x[2], -g].map(|w| w / x[0]))
}

/// −wo/η + (cos θᵢ/η − cos θₜ) n.
fn textbook<T: Number>(x: &[T]) -> Value<T> {
    let (eta, cos_i) = (x[0], x[3]);
    let one = T::of(1.0);
    let sin2_t = (one - cos_i.square()) / eta.square();
    if sin2_t > one {
        return None;
    }
    Some([-x[1] / eta, -x[2] / eta, -cos_i / eta + (cos_i / eta - (one - sin2_t).sqrt())])
}

/// Condition of the refracted direction with respect to g² = η² − s²: c² / (η g), at least 1.
///
/// With u one rounding, the squared length of the rounded direction has an error of 8u, which the code ignores, and g² has
/// 6u of its own. Δg = Δg²/2g, but never more than √Δg²: hence g counts as √u at least. The direction's error is Δg/η.
fn steepness(case: &Case) -> f64 {
    let (eta, c) = (case.inputs[0], case.inputs[3]);
    let sin = ((1.0 - c) * (1.0 + c)).sqrt();
    let g = ((eta - sin) * (eta + sin)).max(case.precision.rounding()).sqrt();
    (c * c / (eta * g)).max(1.0)
}
