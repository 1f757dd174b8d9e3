//! The direction that a smooth dielectric refracts to.

use super::bound::{Bound, rounding};
use super::family::{Family, INDEX, Range, STABLE, Scale, Section, TEXTBOOK, Value, Variant};
use super::fresnel::{COSINE, critical_cosine};
use super::number::{Number, normalized};
use super::sweep::Case;
use crate::bsdf::{Refraction, Scatter};
use crate::math::Rgb;
use crate::optics::dielectric;
use glam::Vec3;

pub const FAMILY: Family = Family {
    name: "refraction",
    about: "direction of the refracted ray",
    figure: "stability-fresnel",
    inputs: &["eta", "x", "y", "z"],
    domains: &[INDEX],
    sections: &[
        Section { title: "all indices", x: Scale::new("/{η}", 1e-4, 1e4), y: COSINE, at: |eta, cos| from(eta, cos) },
        Section {
            title: "near the critical angle",
            x: Scale::new("/{η}", 1e-3, 0.999),
            y: Scale::new("cos /{θ} / cos /{θ}_{c} − 1", 1e-7, 1.0),
            at: |eta, more| from(eta, (critical_cosine(eta) * (1.0 + more)).min(1.0)),
        },
    ],
    edges: &[&[1.5, 0.6, 0.8, 0.0], &[1.5, 0.0, 0.0, 1.0], &[1.0, 0.6, 0.0, 0.8], &[0.5, 0.6, 0.8, 0.0]],
    reference,
    variants: &[Variant::new(STABLE, rendered, stable), Variant::new(TEXTBOOK, textbook, textbook)],
    range: Range::Unit,
    bounds: &[Bound {
        name: "roundings over the slope of √ at the critical angle",
        limit: 24.0,
        reason: "8 of the length of the direction, 6 of g², half of which g keeps, and 10 in all of g and the direction",
        error: |case| case.deviations[0].map(|d| d.relative / (rounding(case.precision) * steepness(case))),
    }],
    coarser: 1,
};

/// A direction of that cosine.
pub(super) fn direction(cos: f64) -> [f64; 3] {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    [0.6 * sin, 0.8 * sin, cos]
}

fn from(eta: f64, cos: f64) -> Vec<f64> {
    let [x, y, z] = direction(cos);
    vec![eta, x, y, z]
}

/// Snell's law for the direction that the rounded components point to.
fn reference<T: Number>(x: &[T]) -> Value<T> {
    let [wx, wy, wz] = normalized([x[1], x[2], x[3]]);
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

/// By how much the refracted direction answers to g² = η² − s²: c² / (η g), at least 1.
///
/// With u one rounding, the squared length of the rounded direction is 1 up to 8u, which the code takes for 1, and g² has
/// 6u of its own. Δg = Δg²/2g, but never more than √Δg²: hence g counts as √u at least. The direction's error is Δg/η.
fn steepness(case: &Case) -> f64 {
    let (eta, c) = (case.inputs[0], case.inputs[3]);
    let sin = ((1.0 - c) * (1.0 + c)).sqrt();
    let g = ((eta - sin) * (eta + sin)).max(rounding(case.precision)).sqrt();
    (c * c / (eta * g)).max(1.0)
}
