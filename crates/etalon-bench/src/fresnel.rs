//! Reflectance of a dielectric over the angle of incidence, exact and by Schlick.

use crate::table::Table;
use etalon_core::errata::Formulas;
use etalon_core::errata::interface::schlick_incident_cosine;
use etalon_core::error::{Error, Result};
use etalon_core::optics::dielectric::{self, Reflectance};
use serde::Serialize;

/// Reflectance at one angle of incidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    pub theta_deg: f64,
    pub exact: Reflectance<f64>,
    /// Schlick's approximation of unpolarized light.
    pub schlick: f64,
}

impl Row {
    /// The error of Schlick's approximation.
    pub fn error(&self) -> f64 {
        self.schlick - self.exact.unpolarized()
    }
}

/// The curves of one interface, and special angles and values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DielectricCurves {
    /// Index of refraction on the side of the incident light.
    pub eta_i: f64,
    /// Index of refraction on the other side.
    pub eta_t: f64,
    /// "exact", or "report" for curves by the first report's formulas.
    pub model: &'static str,
    /// Angle at which no parallel light is reflected; `None` without an interface (equal indices).
    pub brewster_deg: Option<f64>,
    /// Angle beyond which all light is reflected; `None` when entering the denser side.
    pub critical_deg: Option<f64>,
    /// Reflectance at normal incidence, the same for both polarizations.
    pub r_normal: f64,
    /// The same of parallel polarization.
    pub r_normal_parallel: f64,
    /// The same of perpendicular polarization.
    pub r_normal_perpendicular: f64,
    /// Largest |Schlick − exact| over 0–90°, and where.
    pub schlick_max_abs_error: f64,
    pub schlick_max_abs_error_deg: f64,
    /// Largest |Schlick − exact| / exact, and where.
    pub schlick_max_rel_error: f64,
    pub schlick_max_rel_error_deg: f64,
    #[serde(skip)]
    pub rows: Vec<Row>,
}

impl DielectricCurves {
    /// Schlick's formula with the cosine of incidence on the denser side, too, where it is that of refraction which counts.
    pub fn schlick_incident(&self, row: &Row) -> f64 {
        schlick_incident_cosine(cos_deg(row.theta_deg), self.eta_t / self.eta_i)
    }

    pub fn csv(&self) -> Result<Vec<u8>> {
        Table::of(&self.rows)
            .field("theta_deg", |row| row.theta_deg)
            .field("r_parallel", |row| row.exact.parallel)
            .field("r_perpendicular", |row| row.exact.perpendicular)
            .field("r_unpolarized", |row| row.exact.unpolarized())
            .field("transmittance", |row| row.exact.transmittance())
            .field("r_schlick", |row| row.schlick)
            .field("r_schlick_incident", |row| self.schlick_incident(row))
            .csv()
    }
}

/// Largest number of angles that can be asked for.
pub const MAX_POINTS: usize = 1_000_000;

pub(super) fn check_points(points: usize) -> Result<()> {
    if (2..=MAX_POINTS).contains(&points) {
        return Ok(());
    }
    Err(Error::parameter("points", format!("{points} is out of range"))
        .with_hint(format!("a curve needs 2 to {MAX_POINTS} points")))
}

/// Checks a number of angles and spaces them uniformly over 0–90°, both ends included.
pub(super) fn angles(points: usize) -> Result<impl Iterator<Item = f64>> {
    check_points(points)?;
    Ok((0..points).map(move |i| 90.0 * i as f64 / (points - 1) as f64))
}

pub(super) fn check_index(name: &str, value: f64) -> Result<()> {
    if value.is_finite() && (1e-6..=1e6).contains(&value) {
        return Ok(());
    }
    Err(Error::parameter(name, format!("{value} is not an index of refraction"))
        .with_hint("give a positive number between 1e-6 and 1e6, for example 1 for air or 1.5 for glass"))
}

/// cos of an angle in degrees, exactly 0 at 90.
pub(super) fn cos_deg(theta_deg: f64) -> f64 {
    if theta_deg >= 90.0 { 0.0 } else { theta_deg.to_radians().cos() }
}

/// Computes the curves for light that comes from index `eta_i` and meets index `eta_t`.
///
/// With the first report's formulas Schlick's curve has the incident cosine on both sides, and all end at the critical angle, as
/// there.
///
/// # Errors
/// [`Error::Parameter`] for impossible indices and numbers of points.
pub fn curves(eta_i: f64, eta_t: f64, points: usize, formulas: Formulas) -> Result<DielectricCurves> {
    check_index("eta_i", eta_i)?;
    check_index("eta_t", eta_t)?;
    let eta = eta_t / eta_i;
    let single_cosine = formulas == Formulas::FirstReport;
    let approximate = |cos: f64| {
        if single_cosine { schlick_incident_cosine(cos, eta) } else { dielectric::schlick(cos, eta) }
    };
    let critical_deg = dielectric::critical(eta).map(f64::to_degrees);
    let end = if single_cosine { critical_deg.unwrap_or(90.0) } else { 90.0 };
    let row = |theta_deg: f64| {
        let cos = cos_deg(theta_deg);
        Row { theta_deg, exact: dielectric::fresnel(cos, eta), schlick: approximate(cos) }
    };
    let relative = |row: Row| {
        let exact = row.exact.unpolarized();
        if exact > 0.0 { row.error().abs() / exact } else { 0.0 }
    };
    let (abs_at, abs_max) = largest(end, |theta| row(theta).error().abs());
    let (rel_at, rel_max) = largest(end, |theta| relative(row(theta)));
    let normal = dielectric::fresnel(1.0, eta);
    Ok(DielectricCurves {
        eta_i,
        eta_t,
        model: if single_cosine { "report" } else { "exact" },
        brewster_deg: (eta != 1.0).then(|| dielectric::brewster(eta).to_degrees()),
        critical_deg,
        r_normal: normal.unpolarized(),
        r_normal_parallel: normal.parallel,
        r_normal_perpendicular: normal.perpendicular,
        schlick_max_abs_error: abs_max,
        schlick_max_abs_error_deg: abs_at,
        schlick_max_rel_error: rel_max,
        schlick_max_rel_error_deg: rel_at,
        // A curve that ends before 90° ends exactly where it is said to.
        rows: angles(points)?.filter(|theta| *theta < end).chain([end]).map(row).collect(),
    })
}

/// The angle on \[0, `end`\] degrees at which `f` is largest, and its value there: the best of 4001 angles, refined by
/// ternary search.
pub(super) fn largest(end: f64, f: impl Fn(f64) -> f64) -> (f64, f64) {
    const PLACES: usize = 4000;
    let at = |i: usize| end * i as f64 / PLACES as f64;
    let best = (0..=PLACES).max_by(|&a, &b| f(at(a)).total_cmp(&f(at(b)))).unwrap_or(0);
    let (mut low, mut high) = (at(best.saturating_sub(1)), at((best + 1).min(PLACES)));
    while high - low > 1e-9 {
        let third = (high - low) / 3.0;
        if f(low + third) < f(high - third) { low += third } else { high -= third }
    }
    // A maximum at an end or a jump is not improved by the search.
    let middle = 0.5 * (low + high);
    if f(middle) >= f(at(best)) { (middle, f(middle)) } else { (at(best), f(at(best))) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reports_glass() {
        let exit = curves(1.45, 1.0, 91, Formulas::Exact).unwrap();
        assert!(exit.rows.iter().filter(|r| r.theta_deg > 43.7).all(|r| r.exact.parallel == 1.0 && r.schlick == 1.0));
        let report = curves(1.45, 1.0, 91, Formulas::FirstReport).unwrap();
        assert_eq!(
            report.rows.last().unwrap().theta_deg,
            report.critical_deg.unwrap(),
            "the report's curve ends there"
        );
        assert!(report.schlick_max_abs_error > 0.9, "it misses total internal reflection");
    }

    #[test]
    fn schlicks_published_error_for_glass() {
        // numerics of eta 1.5: 0.036 at about 85°; relative 23 % somewhere.
        let c = curves(1.0, 1.5, 2, Formulas::Exact).unwrap();
        assert!((c.schlick_max_abs_error - 0.036).abs() < 1e-3 && (c.schlick_max_abs_error_deg - 85.0).abs() < 1.0);
        assert!((c.schlick_max_rel_error - 0.23).abs() < 0.01);
    }

    #[test]
    fn bad_input_is_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(curves(bad, 1.5, 10, Formulas::Exact).is_err() && curves(1.0, bad, 10, Formulas::Exact).is_err());
        }
        for points in [0, 1, usize::MAX] {
            assert!(curves(1.0, 1.5, points, Formulas::Exact).is_err());
        }
    }
}
