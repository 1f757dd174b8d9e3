//! Mistakes of samplers that choose one coordinate of the plane, and then the other by its conditional pdf.

use super::asked;
use crate::domain::{Domain, Point};
use crate::error::Result;
use crate::sampler::Density;
use std::collections::BTreeMap;

/// Midpoints of a mean along a line; most columns of a table divide this number. And most lines.
const MIDPOINTS: usize = 120;
const MOST_LINES: usize = 1 << 12;
/// Chart coordinates that differ by less are one.
const SAME: f64 = 1e-9;

/// The mean of the density along the chart's `axis`, through each of the points; NaN where there are too many lines.
fn means(domain: &dyn Domain, density: &dyn Density, points: &[Point], axis: usize) -> Result<Vec<f64>> {
    let across = |&point: &Point| domain.to_chart(point).map(|at| at[1 - axis]);
    let key = |at: f64| (at / SAME).round() as i64;
    let places: Vec<Option<f64>> = points.iter().map(across).collect();
    let lines: BTreeMap<i64, f64> = places.iter().flatten().map(|&at| (key(at), at)).collect();
    if lines.len() > MOST_LINES {
        return Ok(vec![f64::NAN; points.len()]);
    }
    let along = |&at: &f64| {
        (0..MIDPOINTS).map(move |i| {
            let t = (i as f64 + 0.5) / MIDPOINTS as f64;
            domain.point_at(if axis == 0 { [t, at] } else { [at, t] })
        })
    };
    let values = asked(density, &lines.values().flat_map(along).collect::<Vec<_>>())?;
    let of_line = |values: &[f64]| values.iter().sum::<f64>() / MIDPOINTS as f64;
    let means: BTreeMap<i64, f64> = lines.into_keys().zip(values.chunks_exact(MIDPOINTS).map(of_line)).collect();
    Ok(places.iter().map(|at| at.map_or(f64::NAN, |at| means[&key(at)])).collect())
}

/// The names of the mistakes of a density over a domain with two axes, with the values at points that lead to each.
pub fn of(domain: &dyn Domain, density: &dyn Density, points: &[Point]) -> Result<Vec<(String, Vec<f64>)>> {
    let [x, y] = domain.coordinates();
    let (all, of_x, of_y) =
        (asked(density, points)?, means(domain, density, points, 1)?, means(domain, density, points, 0)?);
    // A conditional pdf beside a uniform one
    let over = |marginal: &[f64]| -> Vec<f64> {
        all.iter().zip(marginal).map(|(pdf, mean)| if *mean > 0.0 { pdf / mean } else { 0.0 }).collect()
    };
    let [by_y, by_x] = [over(&of_x), over(&of_y)];
    let product = of_x.iter().zip(&of_y).map(|(x, y)| x * y).collect();
    Ok(vec![
        (format!("with {y} uniform"), of_x),
        (format!("with {x} uniform"), of_y),
        (format!("as if {x} and {y} were independent (the product of its marginals)"), product),
        (format!("with {x} uniform, and {y} by its conditional pdf"), by_y),
        (format!("with {y} uniform, and {x} by its conditional pdf"), by_x),
    ])
}
