//! The first report's claims on Fresnel's equations and Schlick's approximation for glass of 1.45.

use super::claim::{Bound, Claim, Finding, Unit, VISIBLE};
use crate::metal::MetalTable;
use etalon_core::errata::fresnel::schlick_incident_cosine;
use etalon_core::optics::{conductor, dielectric, schlick};
use etalon_stats::Extremes;

const ETA: f64 = 1.45;
/// Angles at which formulas are compared.
const ANGLES: u32 = 9000;
/// Difference of equal numbers by rounding.
const ROUNDING: f64 = 1e-12;

/// Cosines of the angles from 0 to `limit` degrees, the ends left out.
fn cosines(limit: f64) -> impl Iterator<Item = f64> {
    (0..ANGLES).map(move |i| ((f64::from(i) + 0.5) * limit / f64::from(ANGLES)).to_radians().cos())
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::at_least)
}

/// Squares of the amplitudes of reflection and transmission, each a mean of both polarizations, at a cosine: as the equations stand.
fn amplitudes(cos_i: f64, eta: f64) -> [f64; 2] {
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (eta * eta)).sqrt();
    let (below_s, below_p) = (cos_i + eta * cos_t, eta * cos_i + cos_t);
    let reflected = [(cos_i - eta * cos_t) / below_s, (eta * cos_i - cos_t) / below_p];
    let transmitted = [2.0 * cos_i / below_s, 2.0 * cos_i / below_p];
    [reflected, transmitted].map(|[s, p]| 0.5 * (s * s + p * p))
}

/// The largest difference of squared amplitudes of reflection from the reflectance that is rendered, on both sides.
pub(super) fn squared_amplitudes_error() -> f64 {
    let critical = (1.0 / ETA).asin().to_degrees();
    let error = |cos: f64, eta: f64| amplitudes(cos, eta)[0] - dielectric::fresnel(cos, eta).unpolarized();
    largest(cosines(90.0).map(|c| error(c, ETA))).at_least(largest(cosines(critical).map(|c| error(c, 1.0 / ETA))))
}

/// The largest difference of the reflectances that the first report prints, of each polarization, from those that are rendered: squares
/// of quotients, both sides of glass.
fn printed_quotients_error() -> f64 {
    let error = |cos: f64, eta: f64| {
        let exact = dielectric::fresnel(cos, eta);
        let cos_t = exact.cos_t.unwrap_or(0.0);
        // With η of the near side 1, and η of the far side `eta`
        let parallel = ((eta * cos - cos_t) / (eta * cos + cos_t)).powi(2);
        let perpendicular = ((cos - eta * cos_t) / (cos + eta * cos_t)).powi(2);
        (parallel - exact.parallel).abs().at_least((perpendicular - exact.perpendicular).abs())
    };
    let critical = (1.0 / ETA).asin().to_degrees();
    largest(cosines(90.0).map(|c| error(c, ETA))).at_least(largest(cosines(critical).map(|c| error(c, 1.0 / ETA))))
}

/// The difference of the reflectances from both sides of glass at normal incidence, and the largest at one angle, below the critical
/// one.
pub(super) fn asymmetry() -> [f64; 2] {
    let difference = |cos: f64| {
        let [out, inside] = [ETA, 1.0 / ETA].map(|eta| dielectric::fresnel(cos, eta).unpolarized());
        (out - inside).abs()
    };
    [difference(1.0), largest(cosines((1.0 / ETA).asin().to_degrees()).map(difference))]
}

/// Tests the claims; `metals` are those of the table.
pub fn glass_claims(metals: &MetalTable) -> Vec<Claim> {
    let inside = 1.0 / ETA;
    let brewster = dielectric::brewster(ETA).to_degrees();
    let critical = dielectric::critical(inside).map_or(f64::NAN, f64::to_degrees);
    let exact = |cos: f64, eta: f64| dielectric::fresnel(cos, eta).unpolarized();
    let angle = |name: &str, ours: f64, theirs: f64| {
        let what = format!("difference of {name} ({ours:.14}°) from it");
        vec![Finding::exact(what, (ours - theirs).abs(), Unit::Degrees, Bound::AtMost(1e-11))]
    };
    // Power: the beam's cross-section and speed change by η cos θₜ / cos θᵢ.
    let power = |cos: f64, eta: f64| {
        let eta_cos_t = (eta * eta - 1.0 + cos * cos).sqrt();
        let [_, transmitted] = amplitudes(cos, eta);
        transmitted * eta_cos_t / cos + exact(cos, eta) - 1.0
    };
    let conserved =
        largest(cosines(89.0).map(|c| power(c, ETA))).at_least(largest(cosines(critical).map(|c| power(c, inside))));
    let from_outside = largest(cosines(90.0).map(|c| schlick::schlick(c, ETA) - exact(c, ETA)));
    // The error rises steeply up to the critical angle, which the steps miss.
    let up_to_critical = || cosines(critical).chain([critical.to_radians().cos()]);
    let from_inside = largest(up_to_critical().map(|c| schlick_incident_cosine(c, inside) - exact(c, inside)));
    let correct_inside = largest(cosines(critical).map(|c| schlick::schlick(c, inside) - exact(c, inside)));
    // R₀ with an index that is 1 % larger
    let r0 = schlick::normal_reflectance::<f64>;
    let by_index = r0(1.01 * ETA) / r0(ETA) - 1.0;
    let by_r0 = metals.curves.iter().flat_map(|metal| &metal.channels).map(|channel| channel.schlick_max_abs_error);
    let share_beyond = 1.0 - inside * inside;
    let complex = largest(cosines(90.0).map(|c| conductor::fresnel(c, ETA, 0.0).unpolarized() - exact(c, ETA)));
    let both: &[&str] = &["fresnel-enter", "fresnel-exit"];
    let percent = |what: &str, value: f64, bound: Bound| Finding::exact(what, value, Unit::Percent, bound);
    vec![
        Claim {
            place: "Fig. 1",
            claim: "Brewster's angle from η = 1 to 1.45.",
            number: "55.40771131249006",
            findings: angle("ours", brewster, 55.407_711_312_490_06),
            evidence: &["fresnel-enter"],
            ..Claim::default()
        },
        Claim {
            place: "Fig. 1",
            claim: "The curve of parallel polarization goes to zero at Brewster's angle.",
            number: "55.40771131249006",
            findings: vec![Finding::exact(
                "R∥ at the printed angle",
                dielectric::fresnel(55.407_711_312_490_06f64.to_radians().cos(), ETA).parallel,
                Unit::Plain,
                Bound::AtMost(ROUNDING),
            )],
            evidence: &["fresnel-enter", "fresnel-angles"],
            ..Claim::default()
        },
        Claim {
            place: "text",
            claim: "R∥ and R⊥ are the squares of the printed quotients of η and cosines.",
            findings: vec![Finding::exact(
                "largest difference from them, both sides of glass",
                printed_quotients_error(),
                Unit::Plain,
                Bound::AtMost(ROUNDING),
            )],
            evidence: both,
            ..Claim::default()
        },
        Claim {
            place: "Fig. 2",
            claim: "The critical angle from η = 1.45 to 1.",
            number: "43.60281897270362",
            findings: angle("ours", critical, 43.602_818_972_703_62),
            evidence: &["fresnel-exit"],
            ..Claim::default()
        },
        Claim {
            place: "Fig. 1, 2",
            claim: "Transmittance is 1 − R of unpolarized light.",
            findings: vec![Finding::exact(
                "largest |R + T − 1|, T by its own equations",
                conserved,
                Unit::Plain,
                Bound::AtMost(ROUNDING),
            )],
            evidence: both,
            ..Claim::default()
        },
        Claim {
            place: "Fig. 2",
            claim: "Leaving glass, the critical angle is the upper bound of the angle of incidence.",
            number: "43.60281897270362",
            findings: vec![percent(
                "share of uniform light inside that arrives at a larger angle, where R = 1",
                share_beyond,
                Bound::AtMost(VISIBLE),
            )],
            evidence: &["fresnel-exit"],
            ..Claim::default()
        },
        Claim {
            place: "Fig. 2",
            claim: "Schlick's approximation, leaving glass, by the cosine of incidence up to the critical angle.",
            findings: vec![percent(
                &format!(
                    "largest error of R (by the cosine outside {:.1} %, as entering glass)",
                    100.0 * correct_inside
                ),
                from_inside,
                Bound::AtMost(from_outside),
            )],
            evidence: &["fresnel-exit", "audit"],
            ..Claim::default()
        },
        Claim {
            place: "text",
            claim: "Schlick's approximation needs no estimate of the index of refraction.",
            findings: vec![
                percent("change of R₀, made from the index, for 1 % of the index", by_index, Bound::AtMost(VISIBLE)),
                percent(
                    "largest error for the metals from R₀ alone (bound: that for glass)",
                    largest(by_r0),
                    Bound::AtMost(from_outside),
                ),
            ],
            evidence: &["fresnel-enter", "metals-table"],
            ..Claim::default()
        },
        Claim {
            place: "text",
            claim: "A function for a complex index is not needed here.",
            findings: vec![Finding::exact(
                "largest difference of its reflectance with k = 0",
                complex,
                Unit::Plain,
                Bound::AtMost(ROUNDING),
            )],
            evidence: &["fresnel-enter"],
            ..Claim::default()
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::super::claim::Verdict;
    use super::*;
    use crate::metal;

    #[test]
    fn the_formulas_agree_and_the_wrong_ones_do_not() {
        assert!(squared_amplitudes_error() < ROUNDING);
        let claims = glass_claims(&metal::table(2).unwrap());
        let verdict = |start: &str| claims.iter().find(|c| c.claim.starts_with(start)).unwrap().verdict();
        assert_eq!(verdict("Brewster"), Verdict::Holds);
        assert_eq!(verdict("Transmittance"), Verdict::Holds);
        assert_eq!(verdict("Schlick's approximation, leaving"), Verdict::DoesNotHold);
        // Of uniform light inside, cos² of the critical angle arrives beyond it.
        let beyond = claims.iter().find(|c| c.claim.starts_with("Leaving glass")).unwrap();
        assert!((beyond.findings[0].value - (1.0 - 1.0 / (ETA * ETA))).abs() < 1e-12);
    }
}
