//! Dielectric Fresnel reflectance of unpolarized light.

use super::directions::COSINE;
use super::family::{
    Bound, Family, INDEX, Number, Precision, REPORT, Range, STABLE, Scale, Section, TEXTBOOK, Value, scalar, variant,
};
use crate::errata::fresnel::schlick_incident_cosine;
use crate::optics::dielectric;

/// R of a dielectric, from 0 to 1.
pub const FAMILY: Family = Family {
    name: "fresnel",
    about: "dielectric reflectance of unpolarized light",
    figure: "stability-fresnel",
    inputs: &["eta", "cos"],
    domains: &[INDEX, (0.0, 1.0)],
    sections: &[
        Section { title: "all indices", x: Scale::new("/{η}", 1e-4, 1e4), y: COSINE, at: |eta, cos| vec![eta, cos] },
        Section {
            title: "nearly equal indices",
            x: Scale::new("/{η} − 1", 1e-7, 1.0),
            y: COSINE,
            at: |more, cos| vec![1.0 + more, cos],
        },
        Section { at: |eta, more| vec![eta, above_critical(eta, more)], ..CRITICAL },
    ],
    edges: &[&[1.0, 0.0], &[1.0, 1e-12], &[1.0, 1.0], &[1.5, 0.0], &[1.5, 1.0], &[0.5, 0.0], &[0.5, 1.0]],
    reference: |x| defined(x),
    variants: &[
        variant!(STABLE, |x| scalar(dielectric::fresnel(x[1], x[0]).unpolarized())),
        variant!(TEXTBOOK, textbook),
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

/// Cosines above that of the critical angle, by their relative distance from it; the inputs are left to the family.
pub(super) const CRITICAL: Section = Section {
    title: "near the critical angle",
    x: Scale::new("/{η}", 1e-3, 0.999),
    y: Scale::new("cos /{θ} / cos /{θ}_{c} − 1", 1e-7, 1.0),
    at: |_, _| Vec::new(),
};

/// The cosine of the critical angle times (1 + `more`), at most 1.
pub(super) fn above_critical(eta: f64, more: f64) -> f64 {
    (((1.0 - eta) * (1.0 + eta)).max(0.0).sqrt() * (1.0 + more)).min(1.0)
}

/// The textbook's, except where that is 0/0: between equal indices nothing is reflected.
fn defined<T: Number>(x: &[T]) -> Value<T> {
    if x[0] == T::of(1.0) { scalar(T::of(0.0)) } else { textbook(x) }
}

/// (cos θᵢ − η cos θₜ)/(cos θᵢ + η cos θₜ) and (η cos θᵢ − cos θₜ)/(η cos θᵢ + cos θₜ), squared and averaged.
fn textbook<T: Number>(x: &[T]) -> Value<T> {
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
    eta >= 1.0 || (cos.acos() - eta.asin()).abs() >= 1f64.to_radians()
}
