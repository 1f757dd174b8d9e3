//! The Jacobian by finite differences: the pdf of a lobe times the Jacobian determinant of its map from random numbers to
//! directions is the probability of choosing the lobe.

use super::contract::{BsdfSample, Direction, PdfKind};
use super::subject::{Comparison, Subject};
use super::vector::{cross, length};
use crate::outcome::Outcome;
use rand::RngExt;

/// Points at which the derivative is taken, and samples that are tried for them.
const POINTS: usize = 64;
const TRIALS: usize = 16 * POINTS;
/// The largest and the smallest step, as powers of ½.
const STEPS: std::ops::Range<i32> = 3..14;
/// Random numbers are multiples of this, so that steps from them are exact in single precision.
const RASTER: f64 = (1u64 << 16) as f64;
/// Rounding of a derivative times its step: three times that of a sampled direction, in units of the last place of 1.
const ROUNDING: f64 = 12.0;
/// A derivative with a larger error than this says nothing.
const COARSEST: f64 = 0.1;
/// Fewer points than this say nothing; where samples of other than delta lobes are so rare, the check does not apply.
const FEWEST: u64 = 8;

/// Compares pdf · |∂wi/∂u₁ × ∂wi/∂u₂| with the probability of choosing the lobe by other random numbers.
///
/// Each derivative comes from central differences at several steps, extrapolated to step 0 (Richardson); of these the one with
/// the smallest error counts, where the error is the change by extrapolation, rounding over the step, and the distance from the
/// values of the next steps.
pub fn check(subject: &Subject) -> Option<Outcome> {
    let Subject { bsdf, properties, wo, .. } = subject;
    let axes = properties.map.filter(|_| properties.pdf == PdfKind::Exact && !properties.narrow)?;
    let (mut found, mut used) = (Comparison::default(), 0);
    let mut rng = subject.random(2, 0);
    let mut points = 0;
    // Where most samples are of delta lobes, try more.
    for _ in 0..TRIALS {
        if points == POINTS {
            break;
        }
        let mut u: Vec<f64> = (0..properties.dimension).map(|_| rng.random::<f64>()).collect();
        axes.iter().for_each(|&axis| u[axis] = (u[axis] * RASTER).floor() / RASTER);
        let Some(sample) = bsdf.sample(*wo, &u).filter(|sample| !sample.is_delta()) else { continue };
        let Some(pdf) = bsdf.lobe_pdf(*wo, sample.wi, sample.lobe) else { continue };
        points += 1;
        let [first, second] = axes.map(|axis| derivative(subject, &sample, &u, axis));
        let (Some((a, da)), Some((b, db))) = (first, second) else { continue };
        let area = length(cross(a, b));
        let error = (da * length(b) + db * length(a)) / area;
        if error.is_nan() || error > COARSEST {
            continue;
        }
        used += 1;
        let product = pdf * area / sample.lobe_probability;
        let rounding = || {
            let of = |o: Direction, i: Direction| bsdf.lobe_pdf(o, i, sample.lobe).unwrap_or(f64::NAN);
            error + subject.rounding(pdf, [*wo, sample.wi], of) / pdf
        };
        let message = || format!("{}, u = {u:?}, lobe {}", subject.at(sample.wi), sample.lobe);
        found.equal([product, 1.0], error, rounding, message);
    }
    let outcome = found.outcome("pdf · |∂wi/∂u| / P(lobe) = 1").filter(|_| used >= FEWEST);
    let reason = "the map is too steep for finite differences in its precision".to_owned();
    let undecided = || Outcome { inconclusive_reason: Some(reason), ..Outcome::open(used) };
    (points as u64 >= FEWEST).then(|| outcome.unwrap_or_else(undecided))
}

/// The derivative of the sampled direction by one random number, and the bound of its error; `None` at the edge of the lobe.
fn derivative(subject: &Subject, sample: &BsdfSample, u: &[f64], axis: usize) -> Option<(Direction, f64)> {
    let at = |step: f64| {
        let mut u = u.to_vec();
        u[axis] += step;
        let inside = (0.0..1.0).contains(&u[axis]);
        let moved = subject.bsdf.sample(subject.wo, &u).filter(|_| inside)?;
        (moved.lobe == sample.lobe && !moved.is_delta()).then_some(moved.wi)
    };
    let central = |step: f64| {
        let (before, after) = (at(-step)?, at(step)?);
        Some([0, 1, 2].map(|i| (after[i] - before[i]) / (2.0 * step)))
    };
    let of_step = |power: i32| {
        let step = 0.5f64.powi(power);
        let (coarse, fine) = (central(step)?, central(0.5 * step)?);
        let value = [0, 1, 2].map(|i| fine[i] + (fine[i] - coarse[i]) / 3.0);
        Some((value, distance(value, fine) + ROUNDING * subject.properties.precision / step))
    };
    let all: Vec<(Direction, f64)> = STEPS.filter_map(of_step).collect();
    let (best, &(value, error)) = all.iter().enumerate().min_by(|a, b| a.1.1.total_cmp(&b.1.1))?;
    // Rounding that is larger than expected shows in the next steps.
    let next = [best.checked_sub(1), best.checked_add(1)].into_iter().flatten().filter_map(|i| all.get(i));
    let spread = next.map(|(other, _)| distance(value, *other)).fold(0.0, f64::max);
    Some((value, error + spread))
}

fn distance(a: Direction, b: Direction) -> f64 {
    length([0, 1, 2].map(|i| a[i] - b[i]))
}
