//! Mistakes of samplers that choose one coordinate of the plane, and then the other by its conditional pdf.

use super::{Follows, Mistake, asked};
use crate::domain::{Domain, Point};
use crate::error::Result;
use crate::extremes::Extremes;
use crate::sampler::Density;
use std::collections::BTreeMap;

/// Midpoints of a mean along a line; most columns of a table divide this number. And most lines.
const MIDPOINTS: usize = 120;
const MOST_LINES: usize = 1 << 12;
/// Chart coordinates that differ by less are one.
const SAME: f64 = 1e-9;

/// Most other places of the pdf that are tried.
const PLACES: usize = 4;

/// Values of a density at points.
type Values<'a> = dyn Fn(&[Point]) -> Result<Vec<f64>> + 'a;

/// The mean of a density along the chart's `axis`, through each of the points; NaN where there are too many lines.
fn means(domain: &dyn Domain, density: &Values, points: &[Point], axis: usize) -> Result<Vec<f64>> {
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
    let values = density(&lines.values().flat_map(along).collect::<Vec<_>>())?;
    let of_line = |values: &[f64]| values.iter().sum::<f64>() / MIDPOINTS as f64;
    let means: BTreeMap<i64, f64> = lines.into_keys().zip(values.chunks_exact(MIDPOINTS).map(of_line)).collect();
    Ok(places.iter().map(|at| at.map_or(f64::NAN, |at| means[&key(at)])).collect())
}

/// Whether a mistake's other places of points on a line along an axis of the chart are on one, too.
fn keeps_lines(domain: &dyn Domain, place: impl Fn(Point) -> Point) -> bool {
    let [at, right, up] =
        [[0.3, 0.2], [0.4, 0.2], [0.3, 0.35]].map(|chart| domain.to_chart(place(domain.point_at(chart))));
    let is_line = |other: Option<[f64; 2]>| {
        at.zip(other).is_some_and(|(a, b)| (a[0] - b[0]).abs().at_most((a[1] - b[1]).abs()) < SAME)
    };
    is_line(right) && is_line(up)
}

/// Values, where those that they are divided by are positive.
fn ratios(values: &[f64], by: &[f64]) -> Vec<f64> {
    values.iter().zip(by).map(|(value, by)| if *by > 0.0 { value / by } else { 0.0 }).collect()
}

fn products(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

/// The names of the mistakes of a density over a domain with two axes, with the values at points that lead to each.
pub fn of(domain: &dyn Domain, density: &dyn Density, points: &[Point]) -> Result<Vec<(String, Vec<f64>)>> {
    let [x, y] = domain.coordinates();
    let own = |points: &[Point]| asked(density, points);
    let marginals = |of: &Values| Ok([means(domain, of, points, 1)?, means(domain, of, points, 0)?]);
    let (all, of_own) = (own(points)?, marginals(&own)?);
    let [of_x, of_y] = of_own.clone();
    let product = products(&of_x, &of_y);
    let mut found = vec![
        (format!("with {y} uniform"), of_x),
        (format!("with {x} uniform"), of_y),
        (format!("as if {x} and {y} were independent (the product of its marginals)"), product),
    ];
    let orders = [(0, [x, y]), (1, [y, x])];
    // A conditional pdf beside a uniform one, and of a coordinate that is not the sampled one
    for (axis, [first, second]) in orders {
        let conditional = |points: &[Point]| Ok(ratios(&own(points)?, &means(domain, &own, points, 1 - axis)?));
        let mean = means(domain, &conditional, points, axis)?;
        found.extend([
            (format!("with {first} uniform, and {second} by its conditional pdf"), ratios(&all, &of_own[axis])),
            (
                format!("with {second} by its conditional pdf for another {first} than the sampled one"),
                products(&of_own[axis], &mean),
            ),
        ]);
    }
    // The marginal or the conditional pdf of another place
    let places = domain.mistakes().into_iter().filter_map(|Mistake { name, follows, .. }| match follows {
        Follows::At(place) if keeps_lines(domain, &place) => Some((name, place)),
        _ => None,
    });
    for (name, place) in places.take(PLACES) {
        let other = |points: &[Point]| asked(density, &points.iter().map(|&at| place(at)).collect::<Vec<_>>());
        let (there, of_there) = (other(points)?, marginals(&other)?);
        for (axis, [first, second]) in orders {
            found.extend([
                (
                    format!("with the marginal of {first} taken {name}"),
                    products(&of_there[axis], &ratios(&all, &of_own[axis])),
                ),
                (
                    format!("with the conditional pdf of {second} taken {name}"),
                    products(&of_own[axis], &ratios(&there, &of_there[axis])),
                ),
            ]);
        }
    }
    Ok(found)
}
