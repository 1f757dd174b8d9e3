//! Reflectance of a conductor over the angle of incidence: exact, by the second report's approximation, by Schlick.

use super::fresnel::{angles, check_index, cos_deg, largest};
use crate::error::{Error, Result};
use crate::optics::{conductor, metals, schlick};
use serde::Serialize;

/// One angle of incidence in one channel. Field names are the CSV columns.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ConductorRow {
    /// Name of the channel.
    pub channel: String,
    /// Angle of incidence in degrees.
    pub theta_deg: f64,
    /// Exact reflectance of parallel polarization.
    pub r_parallel: f64,
    /// Exact reflectance of perpendicular polarization.
    pub r_perpendicular: f64,
    /// Exact reflectance of unpolarized light.
    pub r_unpolarized: f64,
    /// The approximation's R∥.
    pub r_parallel_approximate: f64,
    /// The approximation's R⊥.
    pub r_perpendicular_approximate: f64,
    /// The approximation's R of unpolarized light.
    pub r_unpolarized_approximate: f64,
    /// Schlick's approximation.
    pub r_schlick: f64,
}

/// The curves of one complex index and what can be read off them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Channel {
    /// "614 nm" and so on, or "η + ik" for an index given freely.
    pub name: String,
    /// Index of refraction.
    pub eta: f64,
    /// Extinction coefficient.
    pub k: f64,
    /// Reflectance at normal incidence.
    pub r_normal: f64,
    /// Where the exact R∥ is smallest.
    pub pseudo_brewster_deg: f64,
    /// Largest error of the approximation's unpolarized reflectance, and where.
    pub approximate_max_abs_error: f64,
    /// Angle of that error.
    pub approximate_max_abs_error_deg: f64,
    /// Largest error of Schlick's, and where.
    pub schlick_max_abs_error: f64,
    /// Angle of that error.
    pub schlick_max_abs_error_deg: f64,
    /// A row for each angle.
    #[serde(skip)]
    pub rows: Vec<ConductorRow>,
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

/// The curves of a metal known by symbol or name, in air.
pub fn by_name(name: &str, points: usize) -> Result<ConductorCurves> {
    let Some(metal) = metals::by_name(name) else {
        let known: Vec<_> = metals::METALS.iter().map(|m| m.symbol).collect();
        return Err(Error::parameter("metal", format!("\"{name}\" is not in the table"))
            .with_hint(format!("known metals: {}; any other by `eta_t` and `k`", known.join(", "))));
    };
    let channels = (0..3)
        .map(|c| channel(format!("{} nm", metals::WAVELENGTHS_NM[c]), metal.eta[c], metal.k[c], points))
        .collect::<Result<_>>()?;
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
        let exact = conductor::fresnel(cos, eta, k);
        let approximate = conductor::fresnel_approximate(cos, eta, k);
        ConductorRow {
            channel: name.clone(),
            theta_deg,
            r_parallel: exact.parallel,
            r_perpendicular: exact.perpendicular,
            r_unpolarized: exact.unpolarized(),
            r_parallel_approximate: approximate.parallel,
            r_perpendicular_approximate: approximate.perpendicular,
            r_unpolarized_approximate: approximate.unpolarized(),
            r_schlick: schlick::polynomial(f0, cos),
        }
    };
    let largest_error = |f: fn(&ConductorRow) -> f64| largest(90.0, |theta| f(&row(theta)).abs());
    let (approximate_at, approximate_error) = largest_error(|r| r.r_unpolarized_approximate - r.r_unpolarized);
    let (schlick_at, schlick_error) = largest_error(|r| r.r_schlick - r.r_unpolarized);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_approximations_measured_errors() {
        // For the tables of these metals the approximation is known to stay below 0.008 unpolarized, and to be
        // worst where η² + k² is small: gold's blue, copper's green.
        for (name, worst) in [("Au", 2), ("copper", 1)] {
            let errors: Vec<f64> =
                by_name(name, 2).unwrap().channels.iter().map(|c| c.approximate_max_abs_error).collect();
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
        assert!(by_name("glass", 10).is_err());
        assert!(by_index(1.0, 1.0, -0.1, 10).is_err());
        assert!(by_index(1.0, 1.0, f64::NAN, 10).is_err());
        assert!(by_name("Au", 1).is_err());
    }
}
