//! Reflectance of water, glass, diamond and metals in one panel: `fresnel-media`.

use crate::gallery::prelude::*;
use crate::view::media::{self as view, Curve};
use etalon_bench::media::{self, Interface, MediumCurves};
use etalon_bench::metal::worst;
use etalon_core::errata::Formulas;

const NAMES: [&str; 6] = ["water", "glass", "diamond", "Fe", "Au", "Ag"];
const POINTS: usize = 901;

pub fn figures() -> Vec<Maker> {
    vec![maker("fresnel-media", |_, _| content())]
}

fn content() -> Result<Content> {
    let interfaces = NAMES.iter().map(|name| Interface::named(name)).collect::<Result<Vec<_>>>()?;
    let curves = media::curves(1.0, &interfaces, POINTS, Formulas::Exact)?;
    let closed = |c: &MediumCurves| {
        ((c.eta - 1.0).powi(2) + c.k * c.k) / ((c.eta + 1.0).powi(2) + c.k * c.k) - c.rows[0].r_unpolarized
    };
    let at_grazing = |c: &MediumCurves| c.rows.last().map_or(f64::NAN, |row| (row.r_unpolarized - 1.0).abs());
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
    let rows: Vec<_> = curves.media.iter().flat_map(|medium| medium.rows.iter().cloned()).collect();
    Content::new(view::drawing(&curves, &[Curve::Unpolarized, Curve::Error]), &rows, checks)
}
