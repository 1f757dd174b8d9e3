//! Reflectance: of glass from either side (`fresnel-enter`, `fresnel-exit`), of water, glass, diamond and metals in one panel
//! (`fresnel-media`); Brewster's angle and the critical angle over the index of refraction (`fresnel-angles`).

use crate::gallery::prelude::*;
use crate::view::fresnel::{self as view, Curve};
use etalon_bench::fresnel;
use etalon_bench::media::{self, AnglesRow, Interface, MediumCurves};
use etalon_bench::metal::worst;
use etalon_core::errata::Formulas;
use etalon_core::optics::dielectric::fresnel;

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
    vec![
        maker("fresnel-enter", |_, _| content(1.0, GLASS)),
        maker("fresnel-exit", |_, _| content(GLASS, 1.0)),
        maker("fresnel-media", |_, _| media()),
        maker("fresnel-angles", |_, _| angles()),
    ]
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
        let beyond = curves.rows.iter().filter(|r| r.theta_deg > critical).map(|r| r.exact.unpolarized());
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
    Ok(Content::of_csv(view::dielectric(&curves, ["glass"; 2]), curves.csv()?, checks).with_printed(vec![printed]))
}

const NAMES: [&str; 6] = ["water", "glass", "diamond", "Fe", "Au", "Ag"];

fn media() -> Result<Content> {
    let interfaces = NAMES.iter().map(|name| Interface::named(name)).collect::<Result<Vec<_>>>()?;
    let curves = media::curves(&Interface::dielectric(1.0), &interfaces, POINTS, Formulas::Exact)?;
    let closed = |c: &MediumCurves| {
        ((c.eta - 1.0).powi(2) + c.k * c.k) / ((c.eta + 1.0).powi(2) + c.k * c.k) - c.rows[0].exact.unpolarized()
    };
    let at_grazing = |c: &MediumCurves| c.rows.last().map_or(f64::NAN, |row| (row.exact.unpolarized() - 1.0).abs());
    let (metals, dielectrics): (Vec<_>, Vec<_>) = curves.media.iter().partition(|medium| medium.k > 0.0);
    let brewster = |c: &&MediumCurves| (c.brewster_deg.unwrap_or(f64::NAN).to_radians().tan() - c.eta).abs();
    let extreme = |of: &[&MediumCurves], pick: fn(f64, f64) -> f64| {
        of.iter().map(|medium| medium.r_normal).reduce(pick).unwrap_or(f64::NAN)
    };
    let checks = vec![
        Check::at_most(
            "error of R(0°) against ((η−1)²+k²)/((η+1)²+k²)",
            worst(curves.media.iter().map(|c| closed(c).abs())),
            1e-14,
        ),
        Check::at_most("error of R(90°) against 1", worst(curves.media.iter().map(at_grazing)), 1e-12),
        Check::at_most(
            "error of the tangent of Brewster's angle against η",
            worst(dielectrics.iter().map(brewster)),
            1e-12,
        ),
        Check::at_least(
            "smallest R(0°) of the metals over the largest of the dielectrics",
            extreme(&metals, f64::min) / extreme(&dielectrics, f64::max),
            1.0,
        ),
    ];
    let sides = [curves];
    let drawing = view::of_media(&sides, &[Curve::Unpolarized, Curve::Error]);
    Ok(Content::of_csv(drawing, media::csv(&sides)?, checks))
}

/// The report's glass among media known by name.
const MEDIA: [&str; 7] = ["ice", "water", "1.45", "glass", "sapphire", "LASF9", "diamond"];
const INDICES: usize = 801;

fn angles() -> Result<Content> {
    let media = MEDIA.iter().map(|name| Interface::named(name)).collect::<Result<Vec<_>>>()?;
    let angles = media::special_angles(1.0, &media, INDICES)?;
    let degrees = |angle: Option<f64>| angle.unwrap_or(f64::NAN);
    let glass = angles.media.iter().find(|row| row.eta_t == 1.45);
    let of_glass = |angle: fn(&AnglesRow) -> Option<f64>| degrees(glass.and_then(angle));
    // Fresnel's equations at the angles; the curves' first point has no interface
    let interfaces = || angles.curves.iter().filter(|row| row.eta_t > angles.eta_i);
    let cos = |deg: f64| deg.to_radians().cos();
    let parallel = |row: &AnglesRow| {
        let outside = fresnel(cos(degrees(row.brewster_deg)), row.eta_t).parallel;
        outside.max(fresnel(cos(degrees(row.brewster_reverse_deg)), 1.0 / row.eta_t).parallel)
    };
    let leaving =
        |row: &AnglesRow, beside: f64| fresnel(cos(degrees(row.critical_deg) + beside), 1.0 / row.eta_t).unpolarized();
    let sum = |row: &AnglesRow| (degrees(row.brewster_deg) + degrees(row.brewster_reverse_deg) - 90.0).abs();
    let above = |row: &AnglesRow| degrees(row.critical_deg) - degrees(row.brewster_reverse_deg);
    let smallest = |values: &mut dyn Iterator<Item = f64>| -worst(values.map(|value| -value));
    let checks = vec![
        Check::within(
            "Brewster's angle at 1.45 (degrees; the report prints 55.40771131249006)",
            BREWSTER_DEG,
            of_glass(|row| row.brewster_deg),
            1e-11,
        ),
        Check::within(
            "critical angle at 1.45 (degrees; the report prints 43.60281897270362)",
            CRITICAL_DEG,
            of_glass(|row| row.critical_deg),
            1e-11,
        ),
        Check::at_most("largest reflectance R∥ at Brewster's angles", worst(interfaces().map(parallel)), 1e-28),
        Check::equal(
            "smallest reflectance a millionth of a degree beyond the critical angle",
            1.0,
            smallest(&mut interfaces().map(|row| leaving(row, 1e-6))),
        ),
        Check::at_most(
            "largest reflectance a millionth of a degree before it",
            worst(interfaces().map(|row| leaving(row, -1e-6))),
            1.0 - 1e-4,
        ),
        Check::at_most(
            "error of the sum of Brewster's angles of both sides against 90 degrees",
            worst(interfaces().map(sum)),
            1e-12,
        ),
        Check::at_least(
            "smallest difference of the critical angle from Brewster's of the same side (degrees)",
            smallest(&mut interfaces().map(above)),
            0.0,
        ),
    ];
    let printed = |quantity: &str, report: &str, ours: f64| Printed {
        quantity: quantity.to_owned(),
        report: report.to_owned(),
        ours: ours.to_string(),
    };
    let printed = vec![
        printed("Brewster's angle at 1.45 (degrees)", "55.40771131249006", of_glass(|row| row.brewster_deg)),
        printed("Critical angle at 1.45 (degrees)", "43.60281897270362", of_glass(|row| row.critical_deg)),
    ];
    let rows: Vec<AnglesRow> = angles.curves.iter().chain(&angles.media).cloned().collect();
    Ok(Content::new(view::of_special_angles(&angles), &rows, checks)?.with_printed(printed))
}

#[cfg(test)]
mod tests {
    use super::super::super::registry;
    use super::*;

    #[test]
    fn the_command_makes_the_same() {
        let figure = registry().iter().find(|figure| figure.id == "fresnel-angles").unwrap();
        assert_eq!(figure.command, Some(format!("etalon fresnel --angles {}", MEDIA.join(" "))));
    }
}
