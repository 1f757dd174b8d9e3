//! Reflectance of glass from either side: `fresnel-enter`, `fresnel-exit`.

use crate::gallery::prelude::*;
use crate::view::fresnel as view;
use etalon_bench::fresnel;
use etalon_core::errata::Formulas;

/// Index of refraction of the report's glass.
const GLASS: f64 = 1.45;
const POINTS: usize = 901;
/// tan θ = 1.45, as the report prints it.
pub(super) const BREWSTER_DEG: f64 = 55.407_711_312_490_06;
/// sin θ = 1/1.45, as the report prints it.
pub(super) const CRITICAL_DEG: f64 = 43.602_818_972_703_62;
/// (0.45/2.45)².
const NORMAL_REFLECTANCE: f64 = 0.033_735_943_356_934;

pub fn figures() -> Vec<Maker> {
    vec![maker("fresnel-enter", |_, _| content(1.0, GLASS)), maker("fresnel-exit", |_, _| content(GLASS, 1.0))]
}

fn content(eta_i: f64, eta_t: f64) -> Result<Content> {
    let curves = fresnel::curves(eta_i, eta_t, POINTS, Formulas::Exact)?;
    // From inside, Brewster's angle is the complement.
    let (brewster, of_brewster) = if eta_t > eta_i {
        (BREWSTER_DEG, "Brewster's angle (degrees; the report prints 55.40771131249006)")
    } else {
        (90.0 - BREWSTER_DEG, "Brewster's angle (degrees)")
    };
    let mut checks = vec![
        Check::within("reflectance at normal incidence", NORMAL_REFLECTANCE, curves.r_normal, 1e-14),
        Check::within(
            "both polarizations at normal incidence",
            curves.r_normal_parallel,
            curves.r_normal_perpendicular,
            1e-15,
        ),
        Check::within(of_brewster, brewster, curves.brewster_deg.unwrap_or(f64::NAN), 1e-11),
    ];
    if eta_i > eta_t {
        let critical = curves.critical_deg.unwrap_or(f64::NAN);
        let beyond = curves.rows.iter().filter(|r| r.theta_deg > critical).map(|r| r.r_unpolarized);
        checks.push(Check::within(
            "critical angle (degrees; the report prints 43.60281897270362)",
            CRITICAL_DEG,
            critical,
            1e-11,
        ));
        checks.push(Check::equal(
            "smallest reflectance beyond the critical angle",
            1.0,
            beyond.fold(f64::NAN, f64::min),
        ));
    }
    let printed = |quantity: &str, report: &str, ours: Option<f64>| Printed {
        quantity: quantity.to_owned(),
        report: report.to_owned(),
        ours: ours.map_or_else(|| "none".to_owned(), |degrees| degrees.to_string()),
    };
    let printed = if eta_t > eta_i {
        printed("Brewster's angle (degrees)", "55.40771131249006", curves.brewster_deg)
    } else {
        printed("Critical angle (degrees)", "43.60281897270362", curves.critical_deg)
    };
    Ok(Content::new(view::dielectric(&curves), &curves.rows, checks)?.with_printed(vec![printed]))
}
