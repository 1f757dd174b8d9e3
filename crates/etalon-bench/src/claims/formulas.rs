//! The reports' claims on formulas and indices, which no map or scene has a part in: glass of 1.45, metals, and microfacets.

use super::{Bound, Claim, Finding, VISIBLE, percent, texts};
use crate::metal::MetalTable;
use Bound::AtMost;
use etalon_core::errata::interface::schlick_incident_cosine;
use etalon_core::optics::metals::{IRON, WAVELENGTHS_NM};
use etalon_core::optics::microfacet::{Beckmann, Microfacet};
use etalon_core::optics::{conductor, dielectric};
use etalon_core::sampling::warp;
use etalon_stats::Extremes;
use std::f64::consts::PI;

const ETA: f64 = 1.45;
/// Difference of equal numbers by rounding.
const ROUNDING: f64 = 1e-12;

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::at_least)
}

/// The largest magnitude of a function of the cosine at angles between 0 and `limit` degrees.
fn largest_to(limit: f64, f: impl Fn(f64) -> f64) -> f64 {
    const ANGLES: u32 = 9000;
    largest((0..ANGLES).map(|i| f(((f64::from(i) + 0.5) * limit / f64::from(ANGLES)).to_radians().cos())))
}

/// The largest magnitude of a function of cosine and relative index, on both sides of glass, inside below the critical angle.
fn largest_on_both_sides(f: impl Fn(f64, f64) -> f64) -> f64 {
    let inside = largest_to((1.0 / ETA).asin().to_degrees(), |cos| f(cos, 1.0 / ETA));
    largest_to(90.0, |cos| f(cos, ETA)).at_least(inside)
}

/// Squares of the amplitudes of reflection and of transmission as the reports print them, each perpendicular and parallel.
fn squared_amplitudes(cos: f64, eta: f64) -> [[f64; 2]; 2] {
    let cos_t = (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt();
    let below = [cos + eta * cos_t, eta * cos + cos_t];
    let reflected = [(cos - eta * cos_t) / below[0], (eta * cos - cos_t) / below[1]];
    [reflected, below.map(|below| 2.0 * cos / below)].map(|pair| pair.map(|amplitude| amplitude * amplitude))
}

fn exact(cos: f64, eta: f64) -> f64 {
    dielectric::fresnel(cos, eta).unpolarized()
}

/// Tests the first report's claims on glass; `metals` are those of the table.
pub fn glass_claims(metals: &MetalTable) -> Vec<Claim> {
    let inside = 1.0 / ETA;
    let critical = dielectric::critical(inside).map_or(f64::NAN, f64::to_degrees);
    let angle = |name: &str, ours: f64, theirs: f64| {
        let what = format!("difference of {name} ({ours:.14}°) from it");
        [Finding::exact(what, (ours - theirs).abs(), AtMost(1e-11)).in_degrees()]
    };
    let rounding = |what: &str, value: f64| [Finding::exact(what, value, AtMost(ROUNDING))];
    let share = |what: &str, value: f64, most: f64| Finding::exact(what, value, AtMost(most)).in_percent();
    let parallel = dielectric::fresnel(texts::NO_PARALLEL.printed().to_radians().cos(), ETA).parallel;
    let quotients = largest_on_both_sides(|cos, eta| {
        let (exact, [[perpendicular, parallel], _]) = (dielectric::fresnel(cos, eta), squared_amplitudes(cos, eta));
        (parallel - exact.parallel).abs().at_least((perpendicular - exact.perpendicular).abs())
    });
    // Power: the beam's cross-section and speed change by η cos θₜ / cos θᵢ.
    let power = largest_on_both_sides(|cos, eta| {
        let [_, [perpendicular, parallel]] = squared_amplitudes(cos, eta);
        let factor = (eta * eta - 1.0 + cos * cos).sqrt() / cos;
        0.5 * (perpendicular + parallel) * factor + exact(cos, eta) - 1.0
    });
    let from_outside = largest_to(90.0, |cos| dielectric::schlick(cos, ETA) - exact(cos, ETA));
    let by_cosine_outside = largest_to(critical, |cos| dielectric::schlick(cos, inside) - exact(cos, inside));
    // The error rises steeply up to the critical angle, which the steps miss.
    let by_incidence = |cos: f64| schlick_incident_cosine(cos, inside) - exact(cos, inside);
    let from_inside = largest_to(critical, by_incidence).at_least(by_incidence(critical.to_radians().cos()).abs());
    let r0 = dielectric::normal_reflectance::<f64>;
    let by_r0 = metals.curves.iter().flat_map(|metal| &metal.channels).map(|channel| channel.schlick_max_abs_error);
    let complex = largest_to(90.0, |cos| conductor::fresnel(cos, ETA, 0.0).unpolarized() - exact(cos, ETA));
    let beyond = "share of uniform light inside that arrives at a larger angle, where R = 1";
    let schlick_inside =
        format!("largest error of R (by the cosine outside {:.1} %, as entering glass)", 100.0 * by_cosine_outside);
    vec![
        texts::BREWSTER.with(angle("ours", dielectric::brewster(ETA).to_degrees(), texts::BREWSTER.printed())),
        texts::NO_PARALLEL.with(rounding("R∥ at the printed angle", parallel)),
        texts::QUOTIENTS.with(rounding("largest difference from them, both sides of glass", quotients)),
        texts::CRITICAL.with(angle("ours", critical, texts::CRITICAL.printed())),
        texts::TRANSMITTANCE.with(rounding("largest |R + T − 1|, T by its own equations", power)),
        texts::UPPER_BOUND.with([share(beyond, 1.0 - inside * inside, VISIBLE)]),
        texts::SCHLICK_INSIDE.with([share(&schlick_inside, from_inside, from_outside)]),
        texts::SCHLICK_INDEX.with([
            share("change of R₀, made from the index, for 1 % of the index", r0(1.01 * ETA) / r0(ETA) - 1.0, VISIBLE),
            share("largest error for the metals from R₀ alone (bound: that for glass)", largest(by_r0), from_outside),
        ]),
        texts::COMPLEX_INDEX.with(rounding("largest difference of its reflectance with k = 0", complex)),
    ]
}

/// ∫ D dω over the hemisphere, and ∫ D cos θ dω.
fn integrals(alpha: f64) -> [f64; 2] {
    /// Steps in t = tan² θ/α², and where exp(−t) has no digit left.
    const STEPS: u32 = 40_000;
    const END: f64 = 40.0;
    let (facets, step) = (Beckmann::new(alpha), END / f64::from(STEPS));
    let (mut all, mut projected) = (0.0, 0.0);
    for i in 0..STEPS {
        let cos = 1.0 / (1.0 + alpha * alpha * (f64::from(i) + 0.5) * step).sqrt();
        // dω = 2π |d cos θ| = π α² cos³ θ dt
        let d = facets.d([(1.0 - cos * cos).sqrt(), 0.0, cos]) * PI * alpha * alpha * cos.powi(3) * step;
        all += d;
        projected += d * cos;
    }
    [all, projected]
}

/// Tests the second report's claims on formulas and indices; `metals` are those of the table.
pub fn metal_claims(metals: &MetalTable) -> Vec<Claim> {
    let number = |what: &str, value: f64, most: f64| Finding::exact(what, value, AtMost(most));
    let visible = |what: &str, value: f64| number(what, value, VISIBLE).in_percent();
    let amplitude = largest_on_both_sides(|cos, eta| {
        let [reflected, _] = squared_amplitudes(cos, eta);
        0.5 * (reflected[0] + reflected[1]) - exact(cos, eta)
    });
    let asymmetry = |cos: f64| exact(cos, ETA) - exact(cos, 1.0 / ETA);
    let measured = IRON.published.iter().zip(WAVELENGTHS_NM).enumerate();
    let iron = measured.map(|(channel, ([low, high], nm))| {
        let t = (nm - low[0]) / (high[0] - low[0]);
        let [eta, k] = [1, 2].map(|i| low[i] + t * (high[i] - low[i]));
        (IRON.eta[channel] - eta).abs().at_least((IRON.k[channel] - k).abs())
    });
    let density = [0, 1].map(|which| largest([0.005, 0.05, 0.25, 0.5].into_iter().map(|a| integrals(a)[which] - 1.0)));
    let projected = percent(density[1]);
    let all = format!("largest difference of ∫ D dω from 1 (of ∫ D cos θ dω: {projected})");
    const STEPS: u32 = 30;
    let at = |n: u32| (f64::from(n) + 0.5) / f64::from(STEPS);
    let direction = |n: u32| warp::uniform_hemisphere([at(n % STEPS), at(n / STEPS)]);
    let pairs = (0..STEPS * STEPS).flat_map(|n| (0..STEPS * STEPS).map(move |m| [n, m]));
    let half_vector = largest(pairs.map(|pair| {
        let [wo, wi] = pair.map(direction);
        4.0 * wo.dot((wo + wi).normalize()) - 2.0 * (wo + wi).length()
    }));
    vec![
        texts::AMPLITUDE.with([number("largest difference from it, both sides of glass", amplitude, ROUNDING)]),
        texts::SYMMETRY.with([
            visible("difference of R from both sides of glass, normal incidence", asymmetry(1.0).abs()),
            visible(
                "largest difference at one angle, below the critical one",
                largest_to((1.0 / ETA).asin().to_degrees(), asymmetry),
            ),
        ]),
        texts::IRON.with([number(
            "largest difference of η or k from Johnson & Christy, interpolated (their last digit: 0.01)",
            largest(iron),
            0.005,
        )]),
        texts::APPROXIMATION.with([
            visible("largest error of a reflectance, all metals and angles", metals.approximation_error()),
            visible("largest relative error of an albedo", metals.albedo_error()),
        ]),
        texts::DENSITY.with([number(&all, density[0], 1e-6).in_percent()]),
        texts::HALF_VECTOR.with([number("largest difference, pairs of directions", half_vector, ROUNDING)]),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::Verdict;
    use super::*;
    use crate::metal;

    #[test]
    fn the_formulas_agree_and_the_wrong_ones_do_not() {
        let claims = glass_claims(&metal::table(2).unwrap());
        let find = |text| claims.iter().find(|claim| claim.text == text).unwrap();
        assert_eq!(find(texts::BREWSTER).verdict(), Verdict::Holds);
        assert_eq!(find(texts::TRANSMITTANCE).verdict(), Verdict::Holds);
        assert_eq!(find(texts::SCHLICK_INSIDE).verdict(), Verdict::DoesNotHold);
        // The share cos² of the critical angle of uniform light inside arrives beyond it.
        assert!((find(texts::UPPER_BOUND).findings[0].value - (1.0 - 1.0 / (ETA * ETA))).abs() < 1e-12);
    }

    #[test]
    fn normals_are_dense_by_their_projected_area() {
        // ∫ exp(−t) √(1 + t) dt = 1 + e √π erfc(1)/2 for α = 1
        let [all, projected] = integrals(1.0);
        assert!((all - 1.378_948).abs() < 1e-4 && (projected - 1.0).abs() < 1e-6, "{all} {projected}");
    }
}
