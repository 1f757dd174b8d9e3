//! The centre about which a pdf of the square is symmetric, as that of a disk is, and usual mistakes around it.

use super::Mistake;
use super::axis::{CHANGE, TURNS};
use crate::domain::Point;
use crate::extremes::Extremes;

type Place = [f64; 2];

/// The centre of a pdf that has the values `pdfs` and the `masses` at `points` of the plane, if it is symmetric about its mean, and not
/// uniform. `pdf` is asked for the pdf, NaN outside of the domain.
pub fn of<E>(
    points: &[Point],
    pdfs: &[f64],
    masses: &[f64],
    pdf: impl Fn(&[Point]) -> Result<Vec<f64>, E>,
) -> Result<Option<Place>, E> {
    if points.first().is_none_or(|point| point.coordinates().len() != 2) {
        return Ok(None);
    }
    let total: f64 = masses.iter().sum();
    let mean = |axis: usize| {
        points.iter().zip(masses).map(|(point, mass)| mass * point.coordinates()[axis]).sum::<f64>() / total
    };
    let centre = [mean(0), mean(1)];
    let turned = TURNS.map(|angle: f64| {
        let (sin, cos) = angle.sin_cos();
        let place = |point: &Point| {
            let [x, y] = [0, 1].map(|axis| point.coordinates()[axis] - centre[axis]);
            [centre[0] + cos * x - sin * y, centre[1] + sin * x + cos * y].into()
        };
        pdf(&points.iter().map(place).collect::<Vec<Point>>())
    });
    for there in turned {
        let there = there?;
        let known = || pdfs.iter().zip(&there).zip(masses).filter(|((_, there), mass)| !there.is_nan() && **mass > 0.0);
        let change = |((here, there), mass): ((&f64, &f64), &f64)| mass * (there / here - 1.0).abs().at_most(1.0);
        let all: f64 = known().map(|(_, mass)| mass).sum();
        if all < 0.5 * total || known().map(change).sum::<f64>() > CHANGE * all {
            return Ok(None);
        }
    }
    let is_even = pdfs.iter().all(|pdf| (pdf / pdfs[0] - 1.0).abs() <= CHANGE);
    Ok((!is_even).then_some(centre))
}

/// Usual mistakes around the centre.
pub fn mistakes<'a>(centre: Place) -> Vec<Mistake<'a>> {
    let radius = move |point: Point| {
        let [x, y]: Place = point.into();
        (x - centre[0]).hypot(y - centre[1])
    };
    let name = format!("({:.2}, {:.2})", centre[0], centre[1]);
    let mut all = vec![Mistake::within(
        &format!(
            "a density in proportion to 1/r where the pdf is positive, r the distance from its centre {name} (the radius is u, not √u)"
        ),
        move |at| 1.0 / radius(at),
    )];
    all.extend(Mistake::factor(&format!("r, r the distance from its centre {name}"), radius));
    let scaled = move |scale: f64, point: Point| {
        let at: Place = point.into();
        ([0, 1].map(|axis| centre[axis] + (at[axis] - centre[axis]) / scale).into(), 1.0)
    };
    all.push(Mistake::scaled(&format!("with distances from its centre {name} that are {{}} times as large"), scaled));
    all
}
