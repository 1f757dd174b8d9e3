//! Does a density depend on its point alone?

use super::cubature::Place;
use super::density::Density;
use super::domain::Domain;
use crate::error::Result;

/// Points that are asked for twice.
const POINTS: usize = 64;

/// What is wrong with a density that has another value when asked again at the same points, some of those at `places`.
pub fn changes<D: Domain>(domain: &D, density: &dyn Density<D::Point>, places: &[Place]) -> Result<Option<String>> {
    let points: Vec<D::Point> = places.iter().take(POINTS).map(|place| domain.point(place.at)).collect();
    let ask = || -> Result<Vec<f64>> {
        let mut values = Vec::with_capacity(points.len());
        density.pdf(&points, &mut values).map(|()| values)
    };
    let (first, second) = (ask()?, ask()?);
    let differ = |a: f64, b: f64| a.to_bits() != b.to_bits() && !(a.is_nan() && b.is_nan());
    let found = points.iter().zip(first.iter().zip(&second)).find(|(_, (a, b))| differ(**a, **b));
    Ok(found
        .map(|(point, (a, b))| format!("the density at {point:?} is not the same when asked again: {a:e}, then {b:e}")))
}
