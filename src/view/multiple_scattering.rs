//! Albedos of rough metals with single and with multiple scattering, and spheres of both.

use super::renders::grid;
use crate::figure::{Axis, Drawing, Panel, Plot, Point, Stroke, theme};
use crate::study::multiple_scattering::{ALPHAS, AlbedoRow, DISTRIBUTIONS, Spheres, THETAS_DEG};

/// The curves, and below them the spheres.
pub fn energy(rows: &[AlbedoRow], spheres: &[Spheres]) -> Drawing {
    let title = |spheres: &Spheres| {
        let kind = if spheres.multiple { "single and multiple scattering" } else { "single scattering" };
        format!("{}: {kind}", spheres.metal)
    };
    let cells: Vec<_> = spheres.iter().map(|spheres| (title(spheres), &spheres.image)).collect();
    let alphas = ALPHAS.map(|alpha| alpha.to_string()).join(", ");
    let title = format!("Spheres in light of radiance 1 from everywhere, /{{α}} = {alphas}");
    // Darker, so that radiance above 1 shows, too.
    Drawing::stacked(vec![curves(rows), grid(&title, 2, -0.5, &cells)], 0.5, 2.0)
}

fn curves(rows: &[AlbedoRow]) -> Drawing {
    let panel = |(name, _)| {
        let mut panel = Panel::new(
            Axis::linear("width /{α} of the distribution of normals").range(0.0, 1.0),
            Axis::linear("directional albedo").range(0.2, 1.05),
        )
        .title(format!("{name}, a metal that reflects everything"));
        // One line for all angles: they differ by less than its width.
        let multiple = Stroke { colour: theme::INK, dash: theme::DASHED, ..theme::series(0) };
        for (i, theta) in THETAS_DEG.into_iter().enumerate() {
            let of = |f: fn(&AlbedoRow) -> f64| -> Vec<Point> {
                let rows = rows.iter().filter(|row| row.distribution == name && row.theta_deg == theta);
                rows.map(|row| [f64::from(row.alpha), f(row)]).collect()
            };
            let stroke = Stroke { dash: theme::SOLID, ..theme::series(i) };
            panel = panel.line(format!("single scattering, /{{θ}} = {theta}°"), stroke, of(|row| row.single)).line(
                "",
                multiple,
                of(|row| row.multiple),
            );
        }
        panel.line("with multiple scattering, each /{θ}", multiple, Vec::new())
    };
    Plot::new(DISTRIBUTIONS.map(panel)).draw()
}
