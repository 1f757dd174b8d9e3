//! Brewster's angle and the critical angle over the index of refraction: `fresnel-angles`.

use super::fresnel::{BREWSTER_DEG, CRITICAL_DEG};
use crate::gallery::prelude::*;
use crate::view::special_angles as view;
use etalon_bench::media::Interface;
use etalon_bench::metal::worst;
use etalon_bench::special_angles::{self as study, AnglesRow};
use etalon_core::optics::dielectric::fresnel;

/// The report's glass among media known by name.
const MEDIA: [&str; 7] = ["ice", "water", "1.45", "glass", "sapphire", "LASF9", "diamond"];
const POINTS: usize = 801;

pub fn figures() -> Vec<Maker> {
    vec![maker("fresnel-angles", |_, _| content())]
}

fn content() -> Result<Content> {
    let media = MEDIA.iter().map(|name| Interface::named(name)).collect::<Result<Vec<_>>>()?;
    let angles = study::curves(1.0, &media, POINTS)?;
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
    Ok(Content::new(view::drawing(&angles), &rows, checks)?.with_printed(printed))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gallery::registry;

    #[test]
    fn the_command_makes_the_same() {
        let figure = registry().iter().find(|figure| figure.id == "fresnel-angles").unwrap();
        assert_eq!(figure.command, Some(format!("etalon fresnel --angles {}", MEDIA.join(" "))));
    }
}
