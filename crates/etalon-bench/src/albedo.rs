//! A furnace test with numbers: the directional albedo of BSDFs over the angle and parameters.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

use crate::validation::families::{Facets, position, values};
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::optics::microfacet::{Beckmann, Distribution, Ggx, Microfacet};
use etalon_stats::bsdf::{Albedo, Basis, BatchBsdf, Energy, Family, directional_albedo};
use etalon_stats::cubature::integrate;
use etalon_stats::{Extremes, Grid, Protocol, SampleCount, Square, Verdict, density};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The parameters that vary together; by default the first one, and for `NAME_x` also `NAME_y`.
    pub over: Vec<String>,
    /// Values of other parameters than their usual ones.
    pub set: Vec<(String, f64)>,
    /// Angles, and values of the parameters.
    pub cells: [usize; 2],
    /// The error that every albedo should have at most.
    pub error: f64,
    /// The most samples that all albedos take together, or 4,096 for each if that is more; `None`: as many as the error needs, up to 2²² for each.
    pub samples: Option<u64>,
    pub seed: u64,
}

/// The most samples of the table of a program's BSDFs, which take half a minute in plain Python.
pub const SAMPLES_OF_PROGRAMS: u64 = 1 << 21;

/// Grazing directions are this far from the horizon, in degrees.
const GRAZING: f64 = 0.01;
/// The loss by single scattering has this error: it explains an albedo, it does not judge it.
const LOSS_ERROR: f64 = 1e-3;

/// Tabulates the albedo of a family. `facets` describes the microfacets of a BSDF with given parameters, where that is known; `done` is
/// told the number of all cells after each.
///
/// # Errors
/// [`Error::Parameter`] for unknown parameters and values out of range; [`Error::Interrupted`]; those of the family.
pub fn albedo_table(
    family: &dyn Family,
    facets: &(dyn Fn(&[f64]) -> Option<Facets> + Sync),
    request: &Request,
    done: &(dyn Fn(u64) + Sync),
) -> Result<Table> {
    let start = Instant::now();
    let parameters = family.parameters();
    let fixed = values(family, &request.set)?;
    let over = varied(family, &request.over)?;
    let varies = |name: &&String| over.iter().any(|&k| parameters[k].name == **name);
    if let Some(name) = request.set.iter().map(|(name, _)| name).find(varies) {
        return Err(Error::parameter("set", format!("{name} cannot be set: the table goes over it")));
    }
    let [angles, steps] = request.cells;
    if !(1..=4096).contains(&angles) || !(1..=4096).contains(&steps) {
        return Err(Error::parameter("size", format!("{angles} x {steps} cells")).with_hint("use 1 to 4096 of each"));
    }
    if !(request.error > 0.0 && request.error < 1.0) {
        return Err(Error::parameter("error", format!("an error of {}", request.error)).with_hint("use 0.0001"));
    }
    let steps = if over.is_empty() { 1 } else { steps };
    let share = |i: usize, n: usize| if n > 1 { i as f64 / (n - 1) as f64 } else { 0.5 };
    let configurations: Vec<Vec<f64>> = (0..steps)
        .map(|i| {
            let mut configuration = fixed.clone();
            over.iter().for_each(|&k| configuration[k] = parameters[k].at(share(i, steps)));
            configuration
        })
        .collect();
    let bsdfs = configurations.iter().map(|c| Ok(family.with(c)?)).collect::<Result<Vec<_>>>()?;
    // Directions from above, and from below if light passes.
    let transmits = bsdfs.iter().any(|bsdf| bsdf.properties().transmission);
    let theta = |i: usize| match (transmits, i < angles.div_ceil(2)) {
        (false, _) => (90.0 - GRAZING) * share(i, angles),
        (true, true) => (90.0 - GRAZING) * share(i, angles.div_ceil(2)),
        (true, false) => {
            let half = angles / 2;
            90.0 + GRAZING + (90.0 - GRAZING) * share(i - angles.div_ceil(2), half)
        }
    };
    let thetas_deg: Vec<f64> = (0..angles).map(theta).collect();
    let tests = angles * steps;
    let one = |k: usize| -> Result<Vec<Row>> {
        let (i, theta_deg) = (k / angles, thetas_deg[k % angles]);
        let parameter = over.first().map_or(0.0, |&k| configurations[i][k]);
        let rows = cell(&*bsdfs[i], facets(&configurations[i]), request, tests, [theta_deg, parameter]);
        done(tests as u64);
        rows
    };
    let rows = match family.is_sequential() {
        true => (0..tests).map(one).collect::<Result<Vec<_>>>()?.concat(),
        false => (0..tests).into_par_iter().map(one).collect::<Result<Vec<_>>>()?.concat(),
    };
    Ok(Table {
        family: family.name().to_owned(),
        is_logarithmic: over.first().is_some_and(|&k| parameters[k].is_logarithmic()),
        parameters: configurations.iter().map(|c| over.first().map_or(0.0, |&k| c[k])).collect(),
        fixed: (0..parameters.len())
            .filter(|k| !over.contains(k))
            .map(|k| (parameters[k].name.clone(), fixed[k]))
            .collect(),
        over: over.iter().map(|&k| parameters[k].name.clone()).collect(),
        thetas_deg,
        rows,
        wanted_error: request.error,
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// The numbers of the parameters that vary.
fn varied(family: &dyn Family, over: &[String]) -> Result<Vec<usize>> {
    if !over.is_empty() {
        return over.iter().map(|name| position(family.name(), &family.parameters(), "over", name)).collect();
    }
    let names: Vec<String> = family.parameters().into_iter().map(|parameter| parameter.name).collect();
    let partner = names.first().and_then(|name| name.strip_suffix("_x")).map(|stem| format!("{stem}_y"));
    let both = names.first().into_iter().chain(partner.as_ref());
    Ok(both.filter_map(|name| names.iter().position(|known| known == name)).collect())
}

/// The direction at an angle with the normal, in degrees.
fn towards(theta_deg: f64) -> [f64; 3] {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    [sin, 0.0, cos]
}

/// The rows of one cell, a row for each channel that differs from the first.
fn cell(
    bsdf: &dyn BatchBsdf,
    facets: Option<Facets>,
    request: &Request,
    tests: usize,
    [theta_deg, parameter]: [f64; 2],
) -> Result<Vec<Row>> {
    let wo = towards(theta_deg);
    let mut protocol = Protocol { seed: request.seed, cancelled: interrupt::requested, ..Protocol::default() };
    if let Some(samples) = request.samples {
        protocol.samples = SampleCount::Fixed(samples / tests as u64);
    }
    let found = directional_albedo(bsdf, wo, request.error, &protocol)?;
    let properties = bsdf.properties();
    let lossless = facets.as_ref().and_then(|facets| facets.lossless.as_ref());
    let lost = lossless.map(|bsdf| directional_albedo(bsdf, wo, LOSS_ERROR, &protocol)).transpose()?;
    let lost_by_single_scattering = lost.map(|albedo| 1.0 - albedo.value[0]);
    // From below, the facets that are seen are those from above, turned over.
    let weak_furnace = facets.map(|facets| weak_furnace(&facets, [wo[0], wo[1], wo[2].abs()])).transpose()?;
    let values = &found.value[..properties.channels];
    let channels = if values.iter().all(|v| *v == values[0]) { 1 } else { values.len() };
    let row = |channel: usize| Row {
        theta_deg,
        parameter,
        channel,
        albedo: found.value[channel],
        error: found.error[channel],
        basis: match found.basis {
            Basis::Certified(_) => "certified",
            Basis::Exceeded { .. } => "exceeded",
            Basis::Found(_) => "found",
            Basis::Normal { .. } => "normal",
        },
        largest_weight: match found.basis {
            Basis::Certified(largest)
            | Basis::Found(largest)
            | Basis::Exceeded { declared: largest, .. }
            | Basis::Normal { largest, .. } => Some(largest),
        },
        is_violation: is_violation(&found, channel, properties.energy, tests * channels),
        lost_by_single_scattering,
        weak_furnace,
    };
    Ok((0..channels).map(row).collect())
}

/// Whether an albedo is impossible for what the BSDF declares of its energy and its weights.
fn is_violation(albedo: &Albedo, channel: usize, energy: Energy, tests: usize) -> bool {
    let excess = albedo.value[channel] - 1.0;
    let error = albedo.error_of(channel, tests) + ROUNDING;
    match energy {
        _ if !albedo.value[channel].is_finite() || matches!(albedo.basis, Basis::Exceeded { .. }) => true,
        Energy::Conserved(known) => excess.abs() > error + known,
        Energy::AtMostOne => excess > error,
        Energy::MayExceedOne(_) => false,
    }
}

/// The weak furnace test of the functions D and G₁ that render, in f64.
fn weak_furnace(facets: &Facets, wo: [f64; 3]) -> Result<f64> {
    match facets.distribution {
        Distribution::Beckmann => masked(Beckmann::anisotropic(facets.alpha), facets.alpha, wo),
        Distribution::Ggx => masked(Ggx::anisotropic(facets.alpha), facets.alpha, wo),
    }
}

/// ∫ G₁(wo) D(m) max(0, wo·m)/cos θₒ dωₘ over slopes (αx r cos φ, αy r sin φ), in ln r and φ.
fn masked<D: Microfacet<f64> + Sync>(facets: D, alpha: [f64; 2], wo: [f64; 3]) -> Result<f64> {
    // Beyond, the tails of GGX hold less than 10⁻⁵.
    const LOG_R: [f64; 2] = [-9.0, 12.5];
    let width = LOG_R[1] - LOG_R[0];
    let visible = facets.g1_over_cos(wo);
    let integrand = density(move |[x, y]: [f64; 2]| {
        let r = (LOG_R[0] + width * x).exp();
        let (sin_phi, cos_phi) = (std::f64::consts::TAU * y).sin_cos();
        let [sx, sy] = [alpha[0] * r * cos_phi, alpha[1] * r * sin_phi];
        let z = 1.0 / (1.0 + sx * sx + sy * sy).sqrt();
        let m = [-sx * z, -sy * z, z];
        let facing = wo[0] * m[0] + wo[1] * m[1] + wo[2] * m[2];
        // dωₘ = z³ dsx dsy = z³ αx αy r² d(ln r) dφ.
        let area = z.powi(3) * alpha[0] * alpha[1] * r * r * width * std::f64::consts::TAU;
        visible * facets.d(m) * facing.at_least(0.0) * area
    });
    Ok(integrate(&Square, &integrand, &Grid::equal([6, 4], None))?.values.iter().sum())
}

/// Rounding of single precision may change an albedo by so much.
pub(super) const ROUNDING: f64 = 1e-5;

/// A directional albedo: the radiance towards `wo` over that of uniform light. Field names are the CSV columns.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Row {
    /// The angle of `wo` with the normal.
    pub theta_deg: f64,
    /// The value of the parameters that vary, or 0 if none does.
    pub parameter: f64,
    /// 0 for all channels if they are equal.
    pub channel: usize,
    pub albedo: f64,
    pub error: f64,
    /// What the bound rests on.
    pub basis: &'static str,
    /// The largest mean weight that the BSDF declares, with room for rounding, or the largest that was found if none is declared.
    pub largest_weight: Option<f64>,
    /// Whether the BSDF contradicts what it declares: an albedo above 1, or other than 1 if it conserves energy, a weight above the
    /// largest, or a value that is not finite.
    pub is_violation: bool,
    /// The share that a metal loses because light which facets reflect more than once is not added: 1 minus the albedo
    /// for a Fresnel reflectance of 1.
    pub lost_by_single_scattering: Option<f64>,
    /// The weak furnace test: ∫ G₁(wo) D(m) max(0, wo·m)/cos θₒ dωₘ, which is 1 for any masking function that belongs to its
    /// distribution. Source: Heitz, JCGT 3(2), 2014, section 5.1.
    pub weak_furnace: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    pub family: String,
    /// The parameters that vary together.
    pub over: Vec<String>,
    /// Whether their values are in equal factors.
    pub is_logarithmic: bool,
    pub fixed: Vec<(String, f64)>,
    pub thetas_deg: Vec<f64>,
    /// The values of the parameters that vary.
    pub parameters: Vec<f64>,
    /// By value of the parameters, angle, and channel.
    pub rows: Vec<Row>,
    pub wanted_error: f64,
    /// Wall-clock time.
    pub seconds: f64,
}

impl Table {
    /// The rows of the smallest and of the largest albedo.
    pub fn extremes(&self) -> Option<[&Row; 2]> {
        let by = |a: &&Row, b: &&Row| a.albedo.total_cmp(&b.albedo);
        Some([self.rows.iter().min_by(by)?, self.rows.iter().max_by(by)?])
    }

    pub fn with_largest_error(&self) -> Option<&Row> {
        self.rows.iter().max_by(|a, b| a.error.total_cmp(&b.error))
    }

    /// The largest deviation of the weak furnace test from 1.
    pub fn weak_deviation(&self) -> Option<f64> {
        self.rows.iter().filter_map(|row| row.weak_furnace).map(|weak| (weak - 1.0).abs()).max_by(f64::total_cmp)
    }

    /// What the bounds of the errors rest on, with the numbers of albedos.
    pub fn bases(&self) -> BTreeMap<&'static str, usize> {
        let mut bases = BTreeMap::new();
        self.rows.iter().for_each(|row| *bases.entry(row.basis).or_default() += 1);
        bases
    }

    pub fn violations(&self) -> usize {
        self.rows.iter().filter(|row| row.is_violation).count()
    }

    /// The largest albedo over the channels, by value of the parameters and angle.
    pub fn largest_channels(&self) -> Vec<f64> {
        let largest = |rows: &[Row]| rows.iter().map(|row| row.albedo).fold(f64::MIN, f64::at_least);
        self.rows.chunk_by(|_, next| next.channel != 0).map(largest).collect()
    }

    /// The number of albedos above 1 by more than their error, which the BSDF may declare as possible.
    pub fn above_one(&self) -> usize {
        self.rows.iter().filter(|row| row.albedo > 1.0 + row.error + ROUNDING).count()
    }

    /// The rows whose errors are larger than wanted.
    pub fn uncertain(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.error > self.wanted_error)
    }

    /// The verdict: rejected if an albedo contradicts what the BSDF declares or the weak furnace test fails, inconclusive if errors are larger
    /// than wanted.
    pub fn verdict(&self) -> Verdict {
        if self.violations() > 0 || self.weak_deviation().is_some_and(is_wrong) {
            Verdict::Reject
        } else if self.uncertain().next().is_some() {
            Verdict::Inconclusive
        } else {
            Verdict::Accept
        }
    }
}

/// Whether a deviation of the weak furnace test is an error of the distribution or of its masking; NaN is.
pub fn is_wrong(deviation: f64) -> bool {
    const TOLERANCE: f64 = 1e-4;
    deviation.is_nan() || deviation > TOLERANCE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::validation::families;

    fn request(cells: [usize; 2]) -> Request {
        Request { over: Vec::new(), set: Vec::new(), cells, error: 1e-3, samples: None, seed: 1 }
    }

    fn table(name: &str, request: &Request) -> Result<Table> {
        let all = families::all();
        let family = all.iter().find(|family| Family::name(*family) == name).unwrap();
        albedo_table(family, &|values| family.facets(values), request, &|_| {})
    }

    #[test]
    fn white_surfaces_and_known_losses() {
        // A Lambertian surface, and a lossless dielectric from both sides.
        let diffuse = table("diffuse", &request([3, 3])).unwrap();
        for row in &diffuse.rows {
            assert!((row.albedo - row.parameter).abs() <= row.error + 1e-6 && row.error <= 1e-3, "{row:?}");
        }
        let glass = table("dielectric", &request([6, 3])).unwrap();
        assert!(glass.rows.iter().all(|row| (row.albedo - 1.0).abs() < 1e-5 && !row.is_violation));
        assert!(glass.thetas_deg.iter().any(|theta| *theta > 90.0));
        // GGX of α = 1 at normal incidence has the albedo 1 − ln 2 for F = 1: ∫ 2 c/(1 + c) ½ dc over the cosines of wi.
        let ggx = table("ggx", &request([2, 2])).unwrap();
        let rough = ggx.rows.iter().find(|row| row.theta_deg == 0.0 && row.parameter == 1.0).unwrap();
        let lost = rough.lost_by_single_scattering.unwrap();
        assert!((lost - std::f64::consts::LN_2).abs() < LOSS_ERROR, "{rough:?}");
        assert!(!is_wrong(ggx.weak_deviation().unwrap()), "{:?}", ggx.weak_deviation());
    }

    #[test]
    fn impossible_albedos_are_violations() {
        let of = |value: f64, energy| {
            let albedo = Albedo { value: [value; 3], error: [1e-3; 3], basis: Basis::Certified(1.0) };
            is_violation(&albedo, 0, energy, 1)
        };
        assert!(!of(1.0009, Energy::AtMostOne) && of(1.002, Energy::AtMostOne) && of(f64::NAN, Energy::AtMostOne));
        assert!(
            !of(0.5, Energy::AtMostOne) && of(0.5, Energy::Conserved(1e-3)) && !of(0.9985, Energy::Conserved(1e-3))
        );
        assert!(!of(1.5, Energy::MayExceedOne("for a test")));
    }

    #[test]
    fn the_largest_channel_of_each_cell_is_drawn() {
        let row = |channel, albedo| Row { channel, albedo, ..Row::default() };
        // Channels are equal in the first and in the last cell.
        let rows = vec![row(0, 0.1), row(0, 0.2), row(1, 0.5), row(2, 0.3), row(0, 0.4)];
        let [family, over, fixed] = [String::new(), String::new(), String::new()];
        let table = Table {
            wanted_error: 1e-3,
            family,
            over: vec![over],
            is_logarithmic: false,
            fixed: vec![(fixed, 0.0)],
            thetas_deg: vec![0.0; 3],
            parameters: vec![0.0],
            rows,
            seconds: 0.0,
        };
        assert_eq!(table.largest_channels(), [0.1, 0.5, 0.4]);
    }

    #[test]
    fn a_wrong_masking_function_fails_the_weak_test() {
        // G₁ of another width.
        let facets = Facets { distribution: Distribution::Ggx, alpha: [0.5; 2], lossless: None };
        let wo = towards(60.0);
        let right = weak_furnace(&facets, wo).unwrap();
        let wrong = right * Ggx::new(0.45f64).g1(wo) / Ggx::new(0.5f64).g1(wo);
        assert!(!is_wrong((right - 1.0).abs()) && is_wrong(0.1 * (wrong - 1.0).abs()), "{right} {wrong}");
    }

    #[test]
    fn requests_that_mean_nothing_are_refused() {
        let refused = |request: Request, name: &str| {
            let error = table("ggx", &request).unwrap_err().to_string();
            assert!(error.contains(name), "{error}");
        };
        let usual = request([2, 2]);
        refused(Request { over: vec!["beta".into()], ..usual.clone() }, "has no parameter \"beta\"");
        refused(Request { set: vec![("eta".into(), 1e9)], ..usual.clone() }, "is not from");
        refused(Request { set: vec![("alpha_x".into(), 0.5)], ..usual.clone() }, "goes over it");
        refused(Request { cells: [0, 3], ..usual.clone() }, "0 x 3");
        refused(Request { error: f64::NAN, ..usual }, "NaN");
    }
}
