//! Reflectance of a conductor over the angle of incidence: exact, by the second report's approximation, by Schlick; and the
//! metals of the table side by side.

use super::fresnel::{Row, angles, check_index, cos_deg, largest};
use crate::table::Table;
use etalon_core::error::{Error, Result};
use etalon_core::optics::conductor;
use etalon_core::optics::dielectric::{self, Reflectance};
use etalon_core::optics::metals::{self, Metal};
use serde::Serialize;

/// The curves of one complex index and what can be read off them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Channel {
    /// "614 nm" and so on, or "η + ik" for an index given freely.
    pub name: String,
    /// Index of refraction over that of the near side.
    pub eta: f64,
    /// Extinction coefficient over the index of the near side.
    pub k: f64,
    /// Reflectance at normal incidence.
    pub r_normal: f64,
    /// Where the exact R∥ is smallest.
    pub pseudo_brewster_deg: f64,
    /// Largest error of the approximation's unpolarized reflectance, and where.
    pub approximate_max_abs_error: f64,
    pub approximate_max_abs_error_deg: f64,
    /// Largest error of Schlick's, and where.
    pub schlick_max_abs_error: f64,
    pub schlick_max_abs_error_deg: f64,
    #[serde(skip)]
    pub rows: Vec<Row>,
}

impl Channel {
    /// Reflectance by the second report's approximation.
    pub fn approximate(&self, row: &Row) -> Reflectance<f64> {
        conductor::fresnel_approximate(cos_deg(row.theta_deg), self.eta, self.k)
    }
}

/// A metal's three channels, or the single channel of a complex index.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConductorCurves {
    /// "gold (Au)", or "complex index".
    pub metal: String,
    /// Where the metal's η and k were measured.
    pub source: Option<&'static str>,
    /// Three, or one.
    pub channels: Vec<Channel>,
}

impl ConductorCurves {
    pub fn csv(&self) -> Result<Vec<u8>> {
        let rows = self.channels.iter().flat_map(|channel| channel.rows.iter().map(move |row| (channel, row)));
        Table::of(&rows.collect::<Vec<(&Channel, &Row)>>())
            .field("channel", |(channel, _)| &channel.name)
            .field("theta_deg", |(_, row)| row.theta_deg)
            .field("r_parallel", |(_, row)| row.exact.parallel)
            .field("r_perpendicular", |(_, row)| row.exact.perpendicular)
            .field("r_unpolarized", |(_, row)| row.exact.unpolarized())
            .field("r_parallel_approximate", |(channel, row)| channel.approximate(row).parallel)
            .field("r_perpendicular_approximate", |(channel, row)| channel.approximate(row).perpendicular)
            .field("r_unpolarized_approximate", |(channel, row)| channel.approximate(row).unpolarized())
            .field("r_schlick", |(_, row)| row.schlick)
            .csv()
    }
}

/// Looks a metal up by symbol or name.
///
/// # Errors
/// [`Error::Parameter`] with the known metals.
pub fn find(name: &str) -> Result<&'static Metal> {
    metals::by_name(name).ok_or_else(|| {
        let known: Vec<_> = metals::METALS.iter().map(|m| m.symbol).collect();
        Error::parameter("metal", format!("\"{name}\" is not in the table"))
            .with_hint(format!("known metals: {}; any other by `eta_t` and `k`", known.join(", ")))
    })
}

/// The curves of a metal, met by light from index `eta_i`.
///
/// # Errors
/// [`Error::Parameter`] for an impossible index and numbers of points.
pub fn of_metal(eta_i: f64, metal: &Metal, points: usize) -> Result<ConductorCurves> {
    check_index("eta_i", eta_i)?;
    let in_channel = |c: usize| {
        let name = format!("{} nm", metals::WAVELENGTHS_NM[c]);
        channel(name, metal.eta[c] / eta_i, metal.k[c] / eta_i, points)
    };
    let channels = (0..3).map(in_channel).collect::<Result<_>>()?;
    Ok(ConductorCurves { metal: format!("{} ({})", metal.name, metal.symbol), source: Some(metal.source), channels })
}

/// The curves of the complex index (`eta_t` + i `k`) met from index `eta_i`.
pub fn by_index(eta_i: f64, eta_t: f64, k: f64, points: usize) -> Result<ConductorCurves> {
    check_index("eta_i", eta_i)?;
    check_index("eta_t", eta_t)?;
    if !(0.0..=1e6).contains(&k) {
        return Err(Error::parameter("k", format!("{k} is not an extinction coefficient"))
            .with_hint("give a number from 0 to 1e6; metals have 1 to 10 in visible light"));
    }
    let name = format!("η = {eta_t}, k = {k}");
    let channels = vec![channel(name, eta_t / eta_i, k / eta_i, points)?];
    Ok(ConductorCurves { metal: "complex index".into(), source: None, channels })
}

fn channel(name: String, eta: f64, k: f64, points: usize) -> Result<Channel> {
    let f0 = conductor::normal_reflectance(eta, k);
    let row = |theta_deg: f64| {
        let cos = cos_deg(theta_deg);
        Row { theta_deg, exact: conductor::fresnel(cos, eta, k), schlick: dielectric::schlick_polynomial(f0, cos) }
    };
    let approximate = |theta| conductor::fresnel_approximate(cos_deg(theta), eta, k).unpolarized();
    let (approximate_at, approximate_error) =
        largest(90.0, |theta| (approximate(theta) - row(theta).exact.unpolarized()).abs());
    let (schlick_at, schlick_error) = largest(90.0, |theta| row(theta).error().abs());
    Ok(Channel {
        eta,
        k,
        r_normal: f0,
        pseudo_brewster_deg: conductor::pseudo_brewster(eta, k).to_degrees(),
        approximate_max_abs_error: approximate_error,
        approximate_max_abs_error_deg: approximate_at,
        schlick_max_abs_error: schlick_error,
        schlick_max_abs_error_deg: schlick_at,
        rows: angles(points)?.map(row).collect(),
        name,
    })
}

/// One metal in one colour channel. Field names are the CSV columns.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct MetalRow {
    pub symbol: &'static str,
    pub metal: &'static str,
    pub wavelength_nm: f64,
    /// Index of refraction.
    pub eta: f64,
    /// Extinction coefficient.
    pub k: f64,
    /// η² + k²: the approximation drops sin²θ against it.
    pub q: f64,
    /// Reflectance at normal incidence.
    pub r_normal: f64,
    /// Where the exact R∥ is smallest.
    pub pseudo_brewster_deg: f64,
    /// Share of uniform light from the whole hemisphere that is reflected, exact and approximate.
    pub albedo: f64,
    pub albedo_approximate: f64,
    /// Largest error of the approximation's unpolarized reflectance.
    pub approximate_max_abs_error: f64,
    pub approximate_max_abs_error_deg: f64,
    /// The same of R∥ alone.
    pub approximate_max_parallel_error: f64,
    /// Where η and k were measured.
    pub source: &'static str,
}

/// All metals side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct MetalTable {
    /// Three for each metal.
    pub rows: Vec<MetalRow>,
    pub curves: Vec<ConductorCurves>,
}

impl MetalTable {
    /// The largest difference between the curves at 0° and ((η − 1)² + k²)/((η + 1)² + k²).
    pub fn normal_error(&self) -> f64 {
        let error = |c: &Channel| {
            let k2 = c.k * c.k;
            let closed = ((c.eta - 1.0).powi(2) + k2) / ((c.eta + 1.0).powi(2) + k2);
            c.rows.first().map_or(f64::NAN, |row| (row.exact.unpolarized() - closed).abs())
        };
        worst(self.curves.iter().flat_map(|curves| &curves.channels).map(error))
    }

    /// The largest difference between the approximation's albedo, integrated, and its closed form.
    pub fn approximate_albedo_error(&self) -> f64 {
        worst(self.rows.iter().map(|r| (r.albedo_approximate - approximate_albedo(r.eta, r.k)).abs()))
    }

    /// The largest error of the approximation's reflectance, over all angles.
    pub fn approximation_error(&self) -> f64 {
        worst(self.rows.iter().map(|r| r.approximate_max_abs_error))
    }

    /// The largest relative error of the approximation's albedo.
    pub fn albedo_error(&self) -> f64 {
        worst(self.rows.iter().map(|r| (r.albedo_approximate / r.albedo - 1.0).abs()))
    }
}

/// The largest value; NaN if any value is, or if there is none.
pub fn worst(values: impl Iterator<Item = f64>) -> f64 {
    values.reduce(|a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }).unwrap_or(f64::NAN)
}

/// All metals with `points` angles each.
///
/// # Errors
/// Too few or too many points.
pub fn table(points: usize) -> Result<MetalTable> {
    let mut rows = Vec::new();
    let mut all_curves = Vec::new();
    for known in metals::METALS {
        let curves = of_metal(1.0, known, points)?;
        for (channel, wavelength_nm) in curves.channels.iter().zip(metals::WAVELENGTHS_NM) {
            let (eta, k) = (channel.eta, channel.k);
            let exact = |c: f64| conductor::fresnel(c, eta, k);
            let approximate = |c: f64| conductor::fresnel_approximate(c, eta, k);
            let parallel = |theta: f64| {
                let c = cos_deg(theta);
                (approximate(c).parallel - exact(c).parallel).abs()
            };
            rows.push(MetalRow {
                symbol: known.symbol,
                metal: known.name,
                wavelength_nm,
                eta,
                k,
                q: eta * eta + k * k,
                r_normal: channel.r_normal,
                pseudo_brewster_deg: channel.pseudo_brewster_deg,
                albedo: albedo(|c| exact(c).unpolarized()),
                albedo_approximate: albedo(|c| approximate(c).unpolarized()),
                approximate_max_abs_error: channel.approximate_max_abs_error,
                approximate_max_abs_error_deg: channel.approximate_max_abs_error_deg,
                approximate_max_parallel_error: largest(90.0, parallel).1,
                source: known.source,
            });
        }
        all_curves.push(curves);
    }
    Ok(MetalTable { rows, curves: all_curves })
}

/// 2 ∫ R(c) c dc over the cosines from 0 to 1, by Simpson's rule in √c: R rises steeply from grazing incidence on.
fn albedo(reflectance: impl Fn(f64) -> f64) -> f64 {
    const STEPS: usize = 2000;
    let f = |i: usize| {
        let root = i as f64 / STEPS as f64;
        // c dc = 2 root³ d root.
        4.0 * reflectance(root * root) * root.powi(3)
    };
    let inner: f64 = (1..STEPS).map(|i| f(i) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
    (f(0) + inner + f(STEPS)) / (3.0 * STEPS as f64)
}

/// The approximation's albedo in closed form: 1 − (ε⊥ + ε∥) / 2 with
/// ε⊥ = 8η [1 − η ln((1 + 2η + q)/q) − (k² − η²)/k · (atan((1 + η)/k) − atan(η/k))] and
/// ε∥ = 8η/q [1 − η/q · ln(1 + 2η + q) − (k² − η²)/(qk) · (atan((q + η)/k) − atan(η/k))], q = η² + k².
///
/// Source: Dunkle, "Emissivity and inter-reflection relationships for infinite parallel specular surfaces", 1965.
pub fn approximate_albedo(eta: f64, k: f64) -> f64 {
    let q = eta * eta + k * k;
    let angle = |x: f64| (x / k).atan() - (eta / k).atan();
    let twist = (k * k - eta * eta) / k;
    // Emissivities ε⊥/8η and ε∥/8η.
    let perpendicular = 1.0 - eta * ((1.0 + 2.0 * eta + q) / q).ln() - twist * angle(1.0 + eta);
    let parallel = (1.0 - eta / q * (1.0 + 2.0 * eta + q).ln() - twist / q * angle(q + eta)) / q;
    1.0 - 4.0 * eta * (perpendicular + parallel)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_approximations_measured_errors() {
        // For the tables of these metals the approximation is known to stay below 0.008 unpolarized, and to be
        // worst where η² + k² is small: gold's blue, copper's green.
        for (name, worst) in [("Au", 2), ("copper", 1)] {
            let errors: Vec<f64> = of_metal(1.0, find(name).unwrap(), 2)
                .unwrap()
                .channels
                .iter()
                .map(|c| c.approximate_max_abs_error)
                .collect();
            assert!(errors.iter().all(|e| *e > 1e-4 && *e < 0.008), "{name}: {errors:?}");
            assert!(errors.iter().all(|e| *e <= errors[worst] * 1.3), "{name}: {errors:?}");
        }
    }

    #[test]
    fn no_extinction_meets_brewster() {
        let glass = by_index(1.0, 1.5, 0.0, 91).unwrap();
        assert!((glass.channels[0].pseudo_brewster_deg - 56.309_932).abs() < 1e-4);
        assert!((glass.channels[0].approximate_max_abs_error - 0.099).abs() < 1e-3, "the approximation is for metals");
    }

    #[test]
    fn bad_input_is_refused() {
        assert!(find("glass").is_err());
        assert!(by_index(1.0, 1.0, -0.1, 10).is_err());
        assert!(by_index(1.0, 1.0, f64::NAN, 10).is_err());
        assert!(of_metal(1.0, metals::GOLD, 1).is_err() && of_metal(0.0, metals::GOLD, 9).is_err());
    }

    #[test]
    fn every_metal_of_the_registry_is_in_the_table() {
        let MetalTable { rows, curves } = table(2).unwrap();
        for (i, metal) in metals::METALS.iter().enumerate() {
            assert!(rows[3 * i..3 * i + 3].iter().all(|row| row.symbol == metal.symbol && !row.source.is_empty()));
            assert!(curves[i].metal.contains(metal.symbol));
        }
        assert_eq!(rows.len(), 3 * metals::METALS.len());
    }

    #[test]
    fn the_albedo_agrees_with_closed_forms_and_the_approximation_reflects_a_little_more() {
        // R = c gives 2/3; and the approximation's is known in closed form.
        assert!((albedo(|c| c) - 2.0 / 3.0).abs() < 1e-12);
        for r in table(2).unwrap().rows {
            let known = approximate_albedo(r.eta, r.k);
            assert!((r.albedo_approximate - known).abs() < 1e-9, "{}: {} {known}", r.metal, r.albedo_approximate);
            // Up to half a percent more light, worst where q is small.
            let more = r.albedo_approximate / r.albedo - 1.0;
            assert!((0.0..6e-3).contains(&more), "{} {}: {more}", r.metal, r.wavelength_nm);
            assert!(r.albedo > 0.4 && r.albedo < 1.0);
        }
    }
}
