//! The direction that a smooth dielectric refracts to.

use super::family::{Answer, Family, Form, INDEX, Range, STABLE, Scale, Section, TEXTBOOK};
use super::fresnel::{COSINE, critical_cosine};
use super::number::{Number, normalized};
use crate::bsdf::{Refraction, Scatter};
use crate::math::Rgb;
use crate::optics::dielectric;
use glam::Vec3;

pub const FAMILY: Family = Family {
    name: "refraction",
    about: "direction of the refracted ray",
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
    forms: &[Form::new(STABLE, rendered, stable), Form::new(TEXTBOOK, textbook, textbook)],
    range: Range::Unit,
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
fn reference<T: Number>(x: &[T]) -> Answer<T> {
    let [wx, wy, wz] = normalized([x[1], x[2], x[3]]);
    textbook(&[x[0], wx, wy, wz])
}

/// The material of the renderer.
fn rendered(x: &[f32]) -> Answer<f32> {
    let material = Refraction { transmittance: Rgb::ONE, eta: x[0] };
    material.sample(Vec3::new(x[1], x[2], x[3]), 0.0, [0.0; 2]).map(|sample| sample.wi.to_array())
}

/// The same in f64: (−x, −y, −g)/η with g = η cos θₜ.
fn stable(x: &[f64]) -> Answer<f64> {
    dielectric::eta_cos_t(x[3], x[0]).map(|g| [-x[1], -x[2], -g].map(|w| w / x[0]))
}

/// −wo/η + (cos θᵢ/η − cos θₜ) n.
fn textbook<T: Number>(x: &[T]) -> Answer<T> {
    let (eta, cos_i) = (x[0], x[3]);
    let one = T::of(1.0);
    let sin2_t = (one - cos_i.square()) / eta.square();
    if sin2_t > one {
        return None;
    }
    Some([-x[1] / eta, -x[2] / eta, -cos_i / eta + (cos_i / eta - (one - sin2_t).sqrt())])
}
