//! The second report's claims on formulas and indices of metal.

use super::claim::{Bound, Claim, Finding, Unit, VISIBLE, percent};
use super::glass::{asymmetry, squared_amplitudes_error};
use crate::metal::MetalTable;
use etalon_core::optics::metals::{IRON, WAVELENGTHS_NM};
use etalon_core::optics::microfacet::{Beckmann, Microfacet};
use etalon_core::sampling::warp;
use etalon_stats::Extremes;
use std::f64::consts::PI;

/// Tests the claims on formulas and indices, which no scene has a part in.
pub fn metal_claims(metals: &MetalTable) -> Vec<Claim> {
    vec![amplitude(), symmetry(), iron(), approximation(metals), density(), half_vector()]
}

fn amplitude() -> Claim {
    Claim {
        place: "text",
        claim: "The reflectance is the square of the amplitude r.",
        findings: vec![Finding::exact(
            "largest difference from it, both sides of glass",
            squared_amplitudes_error(),
            Unit::Plain,
            Bound::AtMost(1e-12),
        )],
        evidence: &["fresnel-enter", "fresnel-exit"],
        ..Claim::default()
    }
}

fn iron() -> Claim {
    let measured = IRON.published.iter().zip(WAVELENGTHS_NM).enumerate();
    let difference = |(channel, ([low, high], nm)): (usize, (&[[f64; 3]; 2], f64))| {
        let t = (nm - low[0]) / (high[0] - low[0]);
        let [eta, k] = [1, 2].map(|i| low[i] + t * (high[i] - low[i]));
        (IRON.eta[channel] - eta).abs().at_least((IRON.k[channel] - k).abs())
    };
    Claim {
        place: "Table 1",
        claim: "Iron at 614, 549 and 466 nm.",
        number: "2.8851 + 3.0449i, 2.9500 + 2.9300i, 2.6500 + 2.8095i",
        findings: vec![Finding::exact(
            "largest difference of η or k from Johnson & Christy, interpolated (their last digit: 0.01)",
            measured.map(difference).fold(0.0, f64::at_least),
            Unit::Plain,
            Bound::AtMost(0.005),
        )],
        evidence: &["metals-table", "iron"],
        ..Claim::default()
    }
}

fn approximation(metals: &MetalTable) -> Claim {
    let percent = |what: &str, value| Finding::exact(what, value, Unit::Percent, Bound::AtMost(VISIBLE));
    Claim {
        place: "text",
        claim: "The conductor formulas for |n|² ≫ 1 do for these metals.",
        findings: vec![
            percent("largest error of a reflectance, all metals and angles", metals.approximation_error()),
            percent("largest relative error of an albedo", metals.albedo_error()),
        ],
        evidence: &["metals-table", "audit"],
        ..Claim::default()
    }
}

fn symmetry() -> Claim {
    let [normal, at_an_angle] = asymmetry();
    let finding = |what: &str, value| Finding::exact(what, value, Unit::Percent, Bound::AtMost(VISIBLE));
    Claim {
        place: "text",
        claim: "r is symmetric under exchange of the materials.",
        findings: vec![
            finding("difference of R from both sides of glass, normal incidence", normal),
            finding("largest difference at one angle, below the critical one", at_an_angle),
        ],
        remark: "It is symmetric between the two angles of a refracted path, which differ.",
        evidence: &["fresnel-enter", "fresnel-exit", "audit"],
        ..Claim::default()
    }
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
        let solid_angle = PI * alpha * alpha * cos.powi(3) * step;
        let d = facets.d([(1.0 - cos * cos).sqrt(), 0.0, cos]) * solid_angle;
        all += d;
        projected += d * cos;
    }
    [all, projected]
}

fn density() -> Claim {
    const ALPHAS: [f64; 4] = [0.005, 0.05, 0.25, 0.5];
    let [all, projected] =
        [0, 1].map(|which| ALPHAS.iter().map(|&a| (integrals(a)[which] - 1.0).abs()).fold(0.0, f64::at_least));
    let what = format!("largest difference of ∫ D dω from 1 (of ∫ D cos θ dω: {})", percent(projected));
    Claim {
        place: "text",
        claim: "D is a probability density of normals.",
        number: "α = 0.005, 0.05, 0.25, 0.5",
        findings: vec![Finding::exact(what, all, Unit::Percent, Bound::AtMost(1e-6))],
        remark: "D cos θ is the density, and what the printed inversion samples.",
        evidence: &["audit"],
        ..Claim::default()
    }
}

fn half_vector() -> Claim {
    const STEPS: u32 = 30;
    let at = |n: u32| (f64::from(n) + 0.5) / f64::from(STEPS);
    let direction = |n: u32| warp::uniform_hemisphere([at(n % STEPS), at(n / STEPS)]);
    let error = |n: u32, m: u32| {
        let (wo, wi) = (direction(n), direction(m));
        (4.0 * wo.dot((wo + wi).normalize()) - 2.0 * (wo + wi).length()).abs()
    };
    let pairs = (0..STEPS * STEPS).flat_map(|n| (0..STEPS * STEPS).map(move |m| (n, m)));
    Claim {
        place: "text",
        claim: "4 eᵣ·h = 2 |eᵣ + eᵢ|.",
        findings: vec![Finding::exact(
            "largest difference, pairs of directions",
            pairs.map(|(n, m)| error(n, m)).fold(0.0, f64::at_least),
            Unit::Plain,
            Bound::AtMost(1e-12),
        )],
        evidence: &[],
        ..Claim::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_are_dense_by_their_projected_area() {
        // ∫ exp(−t) √(1 + t) dt = 1 + e √π erfc(1)/2 for α = 1
        let [all, projected] = integrals(1.0);
        assert!((all - 1.378_948).abs() < 1e-4 && (projected - 1.0).abs() < 1e-6, "{all} {projected}");
    }
}
