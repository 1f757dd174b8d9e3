//! Conductor Fresnel reflectance of unpolarized light.

use super::family::{Answer, Family, Form, REPORT, Range, STABLE, Scale, Section, TEXTBOOK, scalar};
use super::fresnel::COSINE;
use super::number::{Machine, Number};
use crate::bsdf::ConductorFresnel;
use crate::math::Rgb;
use crate::optics::conductor;

pub const FAMILY: Family = Family {
    name: "conductor",
    about: "conductor reflectance of unpolarized light",
    inputs: &["eta", "k", "cos"],
    // Beyond, the renderer takes the metal for a perfect one.
    domains: &[(0.0, 1e6), (0.0, 1e6), (0.0, 1.0)],
    sections: &[
        Section {
            title: "weak to strong absorbers, /{η} = 0.2",
            x: Scale::new("/{k}", 1e-8, 1e4),
            y: COSINE,
            at: |k, cos| vec![0.2, k, cos],
        },
        Section {
            title: "almost a dielectric, /{k} = 10^{−6}",
            x: Scale::new("/{η}", 1e-4, 1e4),
            y: COSINE,
            at: |eta, cos| vec![eta, 1e-6, cos],
        },
        Section {
            title: "index matched, /{η} = 1",
            x: Scale::new("/{k}", 1e-8, 1e4),
            y: COSINE,
            at: |k, cos| vec![1.0, k, cos],
        },
    ],
    edges: &[
        &[1.0, 0.0, 0.0],
        &[1.0, 0.0, 1.0],
        &[1.5, 0.0, 0.0],
        &[0.2, 3.9, 0.0],
        &[0.2, 3.9, 1.0],
        &[1e4, 1e4, 0.0],
    ],
    reference: |x| defined(x),
    forms: &[
        Form::new(STABLE, rendered, stable),
        Form::new(TEXTBOOK, textbook, textbook),
        Form::new(REPORT, report, report),
    ],
    range: Range::UpTo(1.0),
    coarser: 1,
};

/// The renderer's, three channels at once without branches.
fn rendered(x: &[f32]) -> Answer<f32> {
    scalar(ConductorFresnel::new(Rgb::splat(x[0]), Rgb::splat(x[1])).reflectance(x[2]).x)
}

fn stable(x: &[f64]) -> Answer<f64> {
    scalar(conductor::fresnel(x[2], x[0], x[1]).unpolarized())
}

/// The textbook's, where that is no quotient of zeros: grazing light meets no interface between equal indices.
fn defined<T: Number>(x: &[T]) -> Answer<T> {
    if x[0] == T::of(1.0) && x[1] == T::of(0.0) { scalar(T::of(0.0)) } else { textbook(x) }
}

/// With s² = 1 − c², A² = (η² − k² − s²)² + 4η²k², a² = (A + η² − k² − s²)/2:
/// R⊥ = (A + c² − 2ac)/(A + c² + 2ac), R∥ = R⊥ (A c² + s⁴ − 2ac s²)/(A c² + s⁴ + 2ac s²).
fn textbook<T: Number>(x: &[T]) -> Answer<T> {
    let (eta, k, c) = (x[0], x[1], x[2]);
    let two = T::of(2.0);
    let s2 = T::of(1.0) - c.square();
    let difference = eta.square() - k.square() - s2;
    let modulus = (difference.square() + T::of(4.0) * eta.square() * k.square()).sqrt();
    let a = ((modulus + difference) / two).sqrt();
    let middle = two * a * c;
    let perpendicular = (modulus + c.square() - middle) / (modulus + c.square() + middle);
    let sum = modulus * c.square() + s2.square();
    let parallel = perpendicular * (sum - middle * s2) / (sum + middle * s2);
    scalar((perpendicular + parallel) / two)
}

/// The second report's approximation.
fn report<T: Machine>(x: &[T]) -> Answer<T> {
    scalar(conductor::fresnel_approximate(x[2], x[0], x[1]).unpolarized())
}
