//! The metals of the table side by side: indices, special angles, and the error of the second report's Fresnel terms.

use super::metal;
use crate::error::Result;
use crate::optics::{conductor, metals};
use serde::Serialize;

/// One metal in one colour channel. Field names are the CSV columns.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct MetalRow {
    /// Chemical symbol.
    pub symbol: &'static str,
    /// Name of the metal.
    pub metal: &'static str,
    /// Wavelength of the channel.
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
    /// The approximation's albedo.
    pub albedo_approximate: f64,
    /// Largest error of the approximation's unpolarized reflectance.
    pub approximate_max_abs_error: f64,
    /// Angle of that error.
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
    /// The curves of each metal.
    pub curves: Vec<metal::ConductorCurves>,
}

impl MetalTable {
    /// The largest difference between the curves at 0° and ((η − 1)² + k²)/((η + 1)² + k²).
    pub fn normal_error(&self) -> f64 {
        let error = |c: &metal::Channel| {
            let k2 = c.k * c.k;
            let closed = ((c.eta - 1.0).powi(2) + k2) / ((c.eta + 1.0).powi(2) + k2);
            c.rows.first().map_or(f64::NAN, |row| (row.r_unpolarized - closed).abs())
        };
        largest(self.curves.iter().flat_map(|curves| &curves.channels).map(error))
    }

    /// The largest difference between the approximation's albedo, integrated, and its closed form.
    pub fn approximate_albedo_error(&self) -> f64 {
        largest(self.rows.iter().map(|r| (r.albedo_approximate - approximate_albedo(r.eta, r.k)).abs()))
    }

    /// The largest error of the approximation's reflectance, over all angles.
    pub fn approximation_error(&self) -> f64 {
        largest(self.rows.iter().map(|r| r.approximate_max_abs_error))
    }

    /// The largest relative error of the approximation's albedo.
    pub fn albedo_error(&self) -> f64 {
        largest(self.rows.iter().map(|r| (r.albedo_approximate / r.albedo - 1.0).abs()))
    }
}

/// NaN if any value is, or if there is none.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
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
        let curves = metal::by_name(known.symbol, points)?;
        for (channel, wavelength_nm) in curves.channels.iter().zip(metals::WAVELENGTHS_NM) {
            let (eta, k) = (channel.eta, channel.k);
            let exact = |c: f64| conductor::fresnel(c, eta, k);
            let approximate = |c: f64| conductor::fresnel_approximate(c, eta, k);
            let parallel = |theta: f64| {
                let c = super::fresnel::cos_deg(theta);
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
                approximate_max_parallel_error: super::fresnel::largest(90.0, parallel).1,
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
