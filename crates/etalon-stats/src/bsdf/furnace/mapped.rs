//! The weights of samples as a function of the two random numbers that a BSDF maps to directions.

use crate::bsdf::contract::{Direction, Spectrum};
use crate::bsdf::subject::Subject;
use crate::error::Result;

/// Most lobes that are told apart at one point.
const PASSES: usize = 16;
/// How far inside an interval of the third number it is asked.
const STEP: f64 = 1e-6;
/// By how many times farther where the same sample is met again, until it cannot be the rounding of a probability.
const FARTHER: f64 = 8.0;
const ROUNDED: f64 = 0.01;

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
    none_below: bool,
    /// How far inside it is asked.
    step: f64,
    /// The lobe and the direction of the last sample.
    last: Option<(usize, Direction)>,
}

impl Mapped<'_> {
    /// The weights at pairs of random numbers in the mean over the third, which chooses the lobe, delta lobes left out.
    ///
    /// Each lobe has an interval of the third number. From either end of \[0, 1) the intervals are passed one by one by the
    /// probabilities of their lobes. Where neither end has a sample, there is none between them. A probability that was computed
    /// with other roundings than the choice may end before the interval: then the same sample is met again.
    pub fn weights(&self, points: &[[f64; 2]]) -> Result<Vec<Spectrum>> {
        let dimension = self.subject.properties.dimension;
        let choice = (0..3).find(|axis| !self.map.contains(axis)).unwrap_or(2);
        let mut sums = vec![[0.0; 3]; points.len()];
        let unknown = |point| Unknown { point, from: 0.0, to: 1.0, none_below: false, step: STEP, last: None };
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
                u[choice] = match unknown.none_below {
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
                    return !std::mem::replace(&mut unknown.none_below, true);
                };
                let answer = Some((sample.lobe, sample.wi));
                if unknown.last == answer && unknown.step < ROUNDED {
                    unknown.step *= FARTHER;
                } else {
                    if !sample.is_delta() {
                        let eta2 = self.subject.eta2(sample.wi);
                        let sum = &mut sums[unknown.point];
                        (0..3).for_each(|i| sum[i] += sample.lobe_probability * sample.weight[i] * eta2);
                    }
                    let passed = sample.lobe_probability;
                    if unknown.none_below {
                        unknown.to -= passed
                    } else {
                        unknown.from += passed
                    }
                    (unknown.last, unknown.step) = (answer, STEP);
                }
                unknown.to - unknown.from > 2.0 * unknown.step
            });
        }
        Ok(sums)
    }
}
