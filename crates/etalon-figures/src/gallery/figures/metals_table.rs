//! Indices, special angles and albedo of the metals: `metals-table`. A table stands beside their reflectance, and the error of the
//! second report's approximation.

use super::roughness::{iron_of_the_report, printed_iron};
use crate::figure::{Axis, Drawing, Panel, Plot, Point, Stroke, theme};
use crate::gallery::figure::Numbers;
use crate::gallery::prelude::*;
use crate::view::text::capitalized;
use etalon_bench::fresnel::Row;
use etalon_bench::metal::{self, Channel, ConductorCurves, MetalRow, MetalTable};
use etalon_bench::table::Table;

const POINTS: usize = 181;

pub fn figures() -> Vec<Maker> {
    vec![maker("metals-table", |_, _| content())]
}

fn content() -> Result<Content> {
    let table = metal::table(POINTS)?;
    let mut checks = iron_of_the_report();
    checks.extend([
        Check::at_most("error of R(0°) against ((η−1)²+k²)/((η+1)²+k²)", table.normal_error(), 1e-14),
        Check::at_most(
            "error of the approximation's albedo against its closed form",
            table.approximate_albedo_error(),
            1e-9,
        ),
        Check::at_most("largest error of the approximation", table.approximation_error(), 8e-3),
        Check::at_most("largest relative error of its albedo", table.albedo_error(), 6e-3),
    ]);
    let content = Content::new(drawing(&table), &table.rows, checks)?.with_printed(printed_iron());
    Ok(Content { numbers: numbers(&table), ..content })
}

/// One column for each metal: reflectance above, error of the approximation below, each row on one scale.
fn drawing(metals: &MetalTable) -> Drawing {
    let curves = &metals.curves;
    let exact = curves.iter().enumerate().map(|(i, metal)| {
        let y = Axis::linear(of_first(i, "reflectance")).range(0.3, 1.0).every(0.2);
        panel(metal, y, "", |_, row| row.exact.unpolarized()).title(capitalized(&metal.metal))
    });
    let errors = curves.iter().enumerate().map(|(i, metal)| {
        let y = Axis::linear(of_first(i, "approximate − exact")).range(0.0, 0.008).every(0.002);
        let error = |channel: &Channel, row: &Row| channel.approximate(row).unpolarized() - row.exact.unpolarized();
        panel(metal, y, "/{θ} (degrees)", error)
    });
    let rows = [exact.collect(), errors.collect()];
    let plot = Plot::grid(rows.map(|panels| (String::new(), panels))).frame_size(150.0, 150.0).draw();
    plot.headed("Reflectance of metals, and what the approximation for ∣/{n}∣² ≫ 1 adds to it", Vec::new())
}

/// The first column names the axes.
fn of_first(place: usize, text: &'static str) -> &'static str {
    if place == 0 { text } else { "" }
}

fn panel(metal: &ConductorCurves, y: Axis, x: &str, value: fn(&Channel, &Row) -> f64) -> Panel {
    let angle = Axis::linear(x).range(0.0, 90.0).every(30.0);
    metal.channels.iter().zip(theme::CHANNELS).fold(Panel::new(angle, y), |panel, (channel, colour)| {
        let points: Vec<Point> = channel.rows.iter().map(|r| [r.theta_deg, value(channel, r)]).collect();
        panel.line(channel.name.as_str(), Stroke::solid(colour, theme::LINE), points)
    })
}

/// One line for each metal and channel.
fn numbers(metals: &MetalTable) -> Numbers {
    let mut last = "";
    let metal = |r: &MetalRow| {
        let is_new = std::mem::replace(&mut last, r.metal) != r.metal;
        if is_new { format!("{} ({})", r.metal, r.symbol) } else { String::new() }
    };
    Numbers::of(
        &Table::of(&metals.rows)
            .words("Metal", metal)
            .numbers("Wavelength (nm)", |r| format!("{:.0}", r.wavelength_nm))
            .numbers("η", |r| format!("{:.4}", r.eta))
            .numbers("k", |r| format!("{:.4}", r.k))
            .numbers("R at 0°", |r| format!("{:.4}", r.r_normal))
            .numbers("Pseudo-Brewster angle", |r| format!("{:.2}°", r.pseudo_brewster_deg))
            .numbers("Albedo", |r| format!("{:.4}", r.albedo))
            .numbers("Albedo by the approximation", |r| format!("{:.4}", r.albedo_approximate))
            .numbers("Largest error of the approximation", |r| {
                format!("{:.4} at {:.1}°", r.approximate_max_abs_error, r.approximate_max_abs_error_deg)
            }),
    )
}
