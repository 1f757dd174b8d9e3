//! The weights of samples as a function of the two random numbers that a BSDF maps to directions.

use crate::bsdf::contract::{Direction, Spectrum};
use crate::bsdf::subject::Subject;
use crate::error::Result;

/// Most lobes that are distinguished at one point.
const PASSES: usize = 64;
/// How far inside an interval of the third number it is asked.
const STEP: f64 = 1e-6;
/// The part of the third number that is not asked for.
pub const UNSEEN: f64 = 2.0 * STEP;
/// Growth of the step where the same sample is met again, up to a step that the rounding of a probability cannot explain.
const STEP_FACTOR: f64 = 8.0;
const LARGEST_STEP: f64 = 0.01;

/// A BSDF as a function of the two random numbers that it maps to directions.
pub struct Mapped<'a> {
    pub subject: &'a Subject<'a>,
    pub map: [usize; 2],
}

/// The part \[from, to) of the third number of one point that is not known yet.
struct Unknown {
    point: usize,
    from: f64,
    to: f64,
    /// Whether its lower end has no sample.
    from_above: bool,
    /// How far inside it is asked.
    step: f64,
    /// The lobe and the direction of the last sample.
    last: Option<(usize, Direction)>,
}

impl Mapped<'_> {
    /// The weight at each pair of random numbers, averaged over the third, without delta lobes; infinite if lobes remain unknown.
    ///
    /// The third number chooses the lobe. Starting at 0, each sample advances it by the probability of its lobe. At a number without a
    /// sample it goes on from 1 downwards, and ends where that has no sample either: between two such ends there are no lobes. A
    /// probability that was computed with other roundings than the choice may end before the interval: then the same sample is met again.
    pub fn weights(&self, points: &[[f64; 2]]) -> Result<Vec<Spectrum>> {
        let dimension = self.subject.properties.dimension;
        let choice = (0..3).find(|axis| !self.map.contains(axis)).unwrap_or(2);
        let mut sums = vec![[0.0; 3]; points.len()];
        let unknown = |point| Unknown { point, from: 0.0, to: 1.0, from_above: false, step: STEP, last: None };
        let mut rest: Vec<Unknown> = (0..points.len()).map(unknown).collect();
        let mut numbers = Vec::with_capacity(rest.len() * dimension);
        for _ in 0..PASSES {
            if rest.is_empty() {
                break;
            }
            numbers.clear();
            for unknown in &rest {
                let mut u = [0.0; 3];
                self.map.iter().zip(points[unknown.point]).for_each(|(&axis, at)| u[axis] = at);
                u[choice] = match unknown.from_above {
                    true => unknown.to - unknown.step,
                    false if unknown.from > 0.0 => unknown.from + unknown.step,
                    false => 0.0,
                };
                numbers.extend_from_slice(&u[..dimension]);
            }
            let mut samples = self.subject.sample(&numbers)?.into_iter();
            rest.retain_mut(|unknown| {
                let Some(sample) = samples.next().flatten() else {
                    // Once from below, once from above.
                    return !std::mem::replace(&mut unknown.from_above, true);
                };
                let met = Some((sample.lobe, sample.wi));
                if unknown.last == met && unknown.step < LARGEST_STEP {
                    unknown.step *= STEP_FACTOR;
                } else {
                    if !sample.is_delta() {
                        let power = self.subject.power(&sample);
                        let sum = &mut sums[unknown.point];
                        (0..3).for_each(|i| sum[i] += sample.lobe_probability * power[i]);
                    }
                    let passed = sample.lobe_probability;
                    if unknown.from_above {
                        unknown.to -= passed
                    } else {
                        unknown.from += passed
                    }
                    (unknown.last, unknown.step) = (met, STEP);
                }
                unknown.to - unknown.from > 2.0 * unknown.step
            });
        }
        rest.iter().for_each(|unknown| sums[unknown.point] = [f64::INFINITY; 3]);
        Ok(sums)
    }
}
