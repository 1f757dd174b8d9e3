//! Families of formulas: conductor Fresnel reflectance of unpolarized light.

use super::family::*;
use etalon_core::bsdf::ConductorFresnel;
use etalon_core::math::Rgb;
use etalon_core::optics::conductor;

pub const FAMILY: Family = Family {
    name: "conductor",
    about: "conductor reflectance of unpolarized light",
    figure: "stability-conductor",
    inputs: &["eta", "k", "cos"],
    // Beyond, the renderer uses a reflectance of 1.
    domains: &[(0.0, 1e6), (0.0, 1e6), COSINES],
    sections: &[
        Section::new("weak to strong absorbers, /{η} = 0.2", Scale::new("/{k}", 1e-8, 1e4), COSINE, |k, cos| {
            vec![0.2, k, cos]
        }),
        Section::new("almost a dielectric, /{k} = 10^{−6}", Scale::new("/{η}", 1e-4, 1e4), COSINE, |eta, cos| {
            vec![eta, 1e-6, cos]
        }),
        Section::new("index matched, /{η} = 1", Scale::new("/{k}", 1e-8, 1e4), COSINE, |k, cos| vec![1.0, k, cos]),
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
    variants: &[Variant::new(STABLE, rendered, stable), variant!(TEXTBOOK, textbook), variant!(REPORT, report)],
    range: Range::UpTo(1.0),
    bounds: &[Bound {
        name: "roundings over the cancellation in (η + ik)² − s²",
        limit: 93.0,
        reason: "7 of the root, twice in each of 4 squares, and 37 of what is computed from them",
        error: |case| case.rendered().map(|d| d.relative / (case.precision.rounding() * cancellation(&case.inputs))),
    }],
    coarser: 1,
};

/// The renderer's, which evaluates three channels at once without branches.
fn rendered(x: &[f32]) -> Value<f32> {
    scalar(ConductorFresnel::new(Rgb::splat(x[0]), Rgb::splat(x[1])).reflectance(x[2]).x)
}

fn stable(x: &[f64]) -> Value<f64> {
    scalar(conductor::fresnel(x[2], x[0], x[1]).unpolarized())
}

/// The textbook's, except where that is 0/0: between equal indices nothing is reflected. Cosines beyond ±1 are ±1.
fn defined<T: Number>(x: &[T]) -> Value<T> {
    let is_matched = x[0] == T::of(1.0) && x[1] == T::of(0.0);
    if is_matched { scalar(T::of(0.0)) } else { textbook(&[x[0], x[1], incidence(x[2])]) }
}

/// With s² = 1 − c², A² = (η² − k² − s²)² + 4η²k², a² = (A + η² − k² − s²)/2:
/// R⊥ = (A + c² − 2ac)/(A + c² + 2ac), R∥ = R⊥ (A c² + s⁴ − 2ac s²)/(A c² + s⁴ + 2ac s²).
fn textbook<T: Number>(x: &[T]) -> Value<T> {
    let (eta, k, c) = (x[0], x[1], x[2]);
    let two = T::of(2.0);
    let s2 = T::of(1.0) - c.square();
    // A and a, as defined above.
    let difference = eta.square() - k.square() - s2;
    let modulus = (difference.square() + T::of(4.0) * eta.square() * k.square()).sqrt();
    let a = ((modulus + difference) / two).sqrt();
    // Both polarizations.
    let middle = two * a * c;
    let perpendicular = (modulus + c.square() - middle) / (modulus + c.square() + middle);
    let sum = modulus * c.square() + s2.square();
    let parallel = perpendicular * (sum - middle * s2) / (sum + middle * s2);
    scalar((perpendicular + parallel) / two)
}

/// The second report's approximation.
fn report<T: Machine>(x: &[T]) -> Value<T> {
    scalar(conductor::fresnel_approximate(x[2], x[0], x[1]).unpolarized())
}

/// Condition of the sum (η + ik)² − s²: by how much the relative errors of its terms grow,
/// κ = (|η² − 1| + c² + k²) / |(η + ik)² − s²|, at least 1.
///
/// Let z² be that sum and u one rounding. (η−1)(η+1) − k² + c² has 5 roundings of its terms, so |Δz²| ≤ (5κ + 1) u |z²|
/// and, with the roundings of the root itself, |Δz| ≤ 7κu |z|. As Re z ≥ 0 neither |c + z|² nor |cz + s²|² cancels: each
/// has an error of at most 18κu, and 48κu remain of R⊥ = |n² − 1|²/|c + z|⁴, 43κu of 1 + |cz − s²|²/|cz + s²|².
fn cancellation(inputs: &[f64]) -> f64 {
    let [eta, k, c] = [inputs[0], inputs[1], inputs[2].abs().min(1.0)];
    let q = (eta - 1.0) * (eta + 1.0);
    let terms = q.abs() + c * c + k * k;
    // η² − s² as a product, without cancellation.
    let sin = ((1.0 - c) * (1.0 + c)).sqrt();
    let modulus = ((eta - sin) * (eta + sin) - k * k).hypot(2.0 * eta * k);
    if terms <= modulus { 1.0 } else { terms / modulus }
}
