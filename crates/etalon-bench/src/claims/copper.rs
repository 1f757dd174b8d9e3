//! The second report's claims on a bunny of copper by importance and by hemisphere sampling.

use super::claim::{Bound, Claim, Finding, Unit, VISIBLE};
use crate::sampling_strategies::{StrategyComparison, Zone, ZoneImage, quotient};
use etalon_core::optics::microfacet::{Beckmann, Microfacet};
use etalon_core::sampling::warp;
use etalon_stats::Extremes;
use glam::DVec3;

/// Tests the claims on a statue of copper by importance and by hemisphere sampling.
pub fn sampling_claims(sampling: &StrategyComparison) -> Vec<Claim> {
    vec![dark_line(sampling), explanation(sampling), noise(sampling)]
}

fn dark_line(sampling: &StrategyComparison) -> Claim {
    let [rim, interior] = [&sampling.rim, &sampling.interior].map(|zone| zone.ratio(|image| image.shown));
    let finding = |what: String, value, bound| Finding::estimated(what, value, Unit::Times, bound);
    Claim {
        place: "Fig. 3b",
        claim: "Hemisphere sampling shows a black line around the bunny.",
        findings: vec![
            finding(
                "median radiance of the rim (3 pixels), hemisphere over importance sampling".into(),
                sampling.rim.ratio(|image| image.median),
                Bound::AtMost(0.5),
            ),
            finding(
                format!(
                    "brightness of the rim in the image, hemisphere over importance sampling ({:.2}), over the same of \
                     the interior ({:.2}): of a line",
                    rim[0], interior[0]
                ),
                quotient(rim, interior),
                Bound::AtMost(1.0 - VISIBLE),
            ),
        ],
        evidence: &["sampling-error", "sampling-hemisphere"],
        ..Claim::default()
    }
}

/// Uniform directions of the hemisphere seen at an angle: mean angle of the half-vector in degrees, and the share of directions
/// where D is above a hundredth of its peak.
fn half_vectors(view_deg: f64, alpha: f64) -> [f64; 2] {
    const STEPS: u32 = 400;
    let (sin, cos) = view_deg.to_radians().sin_cos();
    let (wo, facets) = (DVec3::new(sin, 0.0, cos), Beckmann::new(alpha));
    let peak = facets.d([0.0, 0.0, 1.0]);
    let (mut angle, mut above) = (0.0, 0.0);
    for i in 0..STEPS * STEPS {
        let at = |n: u32| (f64::from(n) + 0.5) / f64::from(STEPS);
        let half = (wo + warp::uniform_hemisphere([at(i % STEPS), at(i / STEPS)])).normalize();
        angle += half.z.at_most(1.0).acos().to_degrees();
        above += f64::from(u8::from(facets.d(half.to_array()) > 0.01 * peak));
    }
    [angle, above].map(|sum| sum / f64::from(STEPS * STEPS))
}

fn explanation(sampling: &StrategyComparison) -> Claim {
    /// The silhouette is seen at nearly 90°.
    const RIM_DEG: f64 = 85.0;
    let alpha = f64::from(sampling.importance.row.alpha);
    let ([angle, at_rim], [_, facing]) = (half_vectors(RIM_DEG, alpha), half_vectors(0.0, alpha));
    Claim {
        place: "Fig. 3b",
        claim: "The line is black because half-vectors lie about 45° off the normal, where D is exponentially small.",
        findings: vec![
            Finding::exact(
                format!("mean angle of the half-vector, seen at {RIM_DEG}° ({angle:.0}°): distance from 45°"),
                (angle - 45.0).abs(),
                Unit::Degrees,
                Bound::AtMost(5.0),
            ),
            Finding::exact(
                format!(
                    "share of directions with D above 1 % of its peak ({:.2} %), over that seen at 0°",
                    100.0 * at_rim
                ),
                at_rim / facing,
                Unit::Times,
                Bound::AtMost(0.5),
            ),
            Finding::estimated(
                "mean light of the rim, hemisphere over importance sampling: no light is missing",
                sampling.rim.ratio(ZoneImage::light),
                Unit::Times,
                Bound::AtMost(0.5),
            ),
        ],
        remark: "Few samples carry all of the light: noise, and not darkness.",
        evidence: &["sampling-error"],
        ..Claim::default()
    }
}

fn noise(sampling: &StrategyComparison) -> Claim {
    let finding = |what: &str, zone: &Zone| {
        let what = format!("noise in the 8-bit values {what}, hemisphere over importance sampling");
        Finding::estimated(what, zone.ratio(|image| image.shown_noise), Unit::Times, Bound::AtLeast(1.0))
    };
    Claim {
        place: "Fig. 3",
        claim: "Importance sampling reduces the noise overall.",
        findings: vec![finding("of the metal's pixels", &sampling.statue), finding("of all pixels", &sampling.picture)],
        evidence: &["sampling-error", "sampling-importance"],
        ..Claim::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_vectors_seen_from_above_are_half_as_far_off_the_normal() {
        // The mean angle of uniform directions is 1 rad.
        let [angle, share] = half_vectors(0.0, 0.05);
        assert!((angle - 0.5f64.to_degrees()).abs() < 0.01, "{angle}");
        // D is a hundredth of its peak at tan θ = α √ln 100, but for cos⁴ θ.
        let limit = (0.05 * 100f64.ln().sqrt()).atan();
        assert!((share / (1.0 - (2.0 * limit).cos()) - 1.0).abs() < 0.05, "{share}");
    }
}
