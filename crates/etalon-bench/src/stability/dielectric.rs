//! Smooth dielectrics: Fresnel reflectance of unpolarized light, and the refracted direction.

use super::family::*;
use etalon_core::bsdf::{Refraction, Scatter};
use etalon_core::errata::interface::schlick_incident_cosine;
use etalon_core::math::Rgb;
use etalon_core::optics::dielectric;
use glam::Vec3;

pub const FRESNEL: Family = Family {
    name: "fresnel",
    about: "dielectric reflectance of unpolarized light",
    figure: "stability-fresnel",
    inputs: &["eta", "cos"],
    domains: &[INDEX, COSINES],
    sections: &[
        Section::new("all indices", Scale::new("/{η}", 1e-4, 1e4), COSINE, |eta, cos| vec![eta, cos]),
        Section::new("nearly equal indices", Scale::new("/{η} − 1", 1e-7, 1.0), COSINE, |more, cos| {
            vec![1.0 + more, cos]
        }),
        Section { at: |eta, more| vec![eta, above_critical(eta, more)], ..CRITICAL },
    ],
    edges: &[&[1.0, 0.0], &[1.0, 1e-12], &[1.0, 1.0], &[1.5, 0.0], &[1.5, 1.0], &[0.5, 0.0], &[0.5, 1.0]],
    reference: |x| reflectance(x),
    variants: &[
        variant!(STABLE, |x| scalar(dielectric::fresnel(x[1], x[0]).unpolarized())),
        variant!(TEXTBOOK, textbook_reflectance),
        // The first report's Schlick, which uses the incident cosine on both sides.
        variant!(REPORT, |x| scalar(schlick_incident_cosine(x[1], x[0]))),
    ],
    range: Range::UpTo(1.0),
    bounds: &[
        Bound {
            name: "relative error in f32 away from the critical angle",
            limit: 1e-6,
            reason: "what the module `optics::dielectric` states",
            error: |case| {
                let [eta, cos] = [case.inputs[0], case.inputs[1]];
                let judged = case.precision == Precision::Single && (1e-3..=1e3).contains(&eta) && is_away(eta, cos);
                case.rendered().filter(|_| judged).map(|d| d.relative)
            },
        },
        Bound::roundings(
            8.0,
            "49 roundings (30 of r⊥², 16 of (r∥/r⊥)², 3 of the mean) that add up like random ones: √49, and one more",
        ),
    ],
    coarser: 1,
};

pub const SCHLICK: Family = Family {
    name: "schlick",
    about: "Schlick's approximation of that, with the cosine on the less dense side",
    reference: |x| schlick_of_less_dense(x),
    variants: &[variant!(STABLE, |x| scalar(dielectric::schlick(x[1], x[0])))],
    bounds: &[Bound::roundings(16.0, "4 of F₀, 6 of the cosine, 5 of the fifth power, and the sum")],
    ..FRESNEL
};

/// Cosines above that of the critical angle, by their relative distance from it; the inputs are left to the family.
const CRITICAL: Section = Section::new(
    "near the critical angle",
    Scale::new("/{η}", 1e-3, 0.999),
    Scale::new("cos /{θ} / cos /{θ}_{c} − 1", 1e-7, 1.0),
    |_, _| Vec::new(),
);

/// The cosine of the critical angle times (1 + `more`), at most 1.
fn above_critical(eta: f64, more: f64) -> f64 {
    (((1.0 - eta) * (1.0 + eta)).max(0.0).sqrt() * (1.0 + more)).min(1.0)
}

/// The textbook formula, except between equal indices, where it is 0/0: nothing is reflected there. Cosines beyond ±1 are ±1.
fn reflectance<T: Number>(x: &[T]) -> Value<T> {
    if x[0] == T::of(1.0) { scalar(T::of(0.0)) } else { textbook_reflectance(&[x[0], incidence(x[1])]) }
}

/// F₀ + (1 − F₀)(1 − cos)⁵ with the cosine on the less dense side; 1 under total internal reflection.
fn schlick_of_less_dense<T: Number>(x: &[T]) -> Value<T> {
    let (eta, cos, one) = (x[0], incidence(x[1]), T::of(1.0));
    if eta == one {
        return scalar(T::of(0.0));
    }
    let cos2_t = one - (one - cos.square()) / eta.square();
    let rest = match eta < one {
        true if cos2_t <= T::of(0.0) => return scalar(one),
        true => one - cos2_t.sqrt(),
        false => one - cos,
    };
    let f0 = ((eta - one) / (eta + one)).square();
    scalar(f0 + (one - f0) * rest.square().square() * rest)
}

/// (cos θᵢ − η cos θₜ)/(cos θᵢ + η cos θₜ) and (η cos θᵢ − cos θₜ)/(η cos θᵢ + cos θₜ), squared and averaged.
pub(super) fn textbook_reflectance<T: Number>(x: &[T]) -> Value<T> {
    let (eta, cos_i) = (x[0], x[1]);
    let one = T::of(1.0);
    // Snell's law.
    let sin2_t = (one - cos_i.square()) / eta.square();
    if sin2_t >= one {
        return scalar(one);
    }
    let cos_t = (one - sin2_t).sqrt();
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    scalar((perpendicular.square() + parallel.square()) / T::of(2.0))
}

/// Whether a direction is a degree or more from the critical angle.
fn is_away(eta: f64, cos: f64) -> bool {
    eta >= 1.0 || (cos.abs().min(1.0).acos() - eta.asin()).abs() >= 1f64.to_radians()
}

/// The refracted unit vector; none beyond the critical angle.
pub const REFRACTION: Family = Family {
    name: "refraction",
    about: "direction of the refracted ray",
    figure: "stability-fresnel",
    inputs: &["eta", "x", "y", "z"],
    domains: &[INDEX],
    sections: &[
        Section::new("all indices", Scale::new("/{η}", 1e-4, 1e4), COSINE, |eta, cos| with(eta, of_cosine(cos))),
        Section { at: |eta, more| with(eta, of_cosine(above_critical(eta, more))), ..CRITICAL },
    ],
    edges: &[&[1.5, 0.6, 0.8, 0.0], &[1.5, 0.0, 0.0, 1.0], &[1.0, 0.6, 0.0, 0.8], &[0.5, 0.6, 0.8, 0.0]],
    reference: refracted,
    variants: &[Variant::new(STABLE, rendered, stable), variant!(TEXTBOOK, textbook_refracted)],
    range: Range::Unit,
    bounds: &[Bound {
        name: "roundings over the slope of √ at the critical angle",
        limit: 24.0,
        reason: "8 of the length of the direction, 6 of g², half of which g keeps, and 10 in all of g and the direction",
        error: |case| case.rendered().map(|d| d.relative / (case.precision.rounding() * steepness(case))),
    }],
    coarser: 1,
};

/// Snell's law for the direction that the rounded components point to, from either side.
fn refracted<T: Number>(x: &[T]) -> Value<T> {
    let [wx, wy, wz] = normalized(vector(x, 1));
    if wz < T::of(0.0) {
        return textbook_refracted(&[T::of(1.0) / x[0], wx, wy, -wz]).map(|[x, y, z]| [x, y, -z]);
    }
    textbook_refracted(&[x[0], wx, wy, wz])
}

/// The material of the renderer.
fn rendered(x: &[f32]) -> Value<f32> {
    let material = Refraction { transmittance: Rgb::ONE, eta: x[0] };
    material.sample(Vec3::new(x[1], x[2], x[3]), 0.0, [0.0; 2]).map(|sample| sample.wi.to_array())
}

/// The same in f64: (−x, −y, −g)/η with g = η cos θₜ.
fn stable(x: &[f64]) -> Value<f64> {
    if x[3] < 0.0 {
        return stable(&[x[0].recip(), x[1], x[2], -x[3]]).map(|[x, y, z]| [x, y, -z]);
    }
    dielectric::eta_cos_t(x[3], x[0]).map(|g| [-x[1], -x[2], -g].map(|w| w / x[0]))
}

/// −wo/η + (cos θᵢ/η − cos θₜ) n.
fn textbook_refracted<T: Number>(x: &[T]) -> Value<T> {
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
    let (eta, c) = (case.inputs[0], case.inputs[3].abs().min(1.0));
    let eta = if case.inputs[3] < 0.0 { eta.recip() } else { eta };
    let sin = ((1.0 - c) * (1.0 + c)).sqrt();
    let g = ((eta - sin) * (eta + sin)).max(case.precision.rounding()).sqrt();
    (c * c / (eta * g)).max(1.0)
}
