//! Values of a coordinate that several samples of a batch have: clamped ones, for example.

use crate::hash::GOLDEN;
use crate::tally::BATCH;
use std::cmp::Reverse;

/// Batches in which repeated values are looked for, and most such values that are kept of an axis in each: they bound memory.
const BATCHES: u64 = 1 << 10;
const KEPT: usize = 16;
/// Bits of a filter: sixteen for each sample of a batch, so that few other samples pass it by chance.
const BITS: u32 = BATCH.trailing_zeros() + 4;

/// A value that several samples of a batch have, or of several batches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeated {
    pub value: f64,
    /// In how many batches.
    pub batches: u64,
    /// The largest pdf of these samples.
    pub pdf: f64,
}

/// What was found in the batches so far.
#[derive(Debug, Clone, Default)]
pub struct Repeats {
    /// Batches looked at.
    pub batches: u64,
    of_axes: [Vec<Repeated>; 2],
}

impl Repeats {
    /// Looks at batch number `batch`: coordinates along the `axes` first axes, and the pdf there.
    pub fn count(&mut self, batch: u64, axes: usize, samples: impl Iterator<Item = ([f64; 2], f64)> + Clone) {
        if batch >= BATCHES {
            return;
        }
        self.batches += 1;
        for (axis, repeated) in self.of_axes.iter_mut().enumerate().take(axes) {
            repeated.extend(of_batch(samples.clone().map(|(at, pdf)| (at[axis], pdf))));
        }
    }

    pub fn add(&mut self, other: Self) {
        self.batches += other.batches;
        self.of_axes.iter_mut().zip(other.of_axes).for_each(|(repeated, more)| repeated.extend(more));
    }

    /// The values of an axis that are repeated in several batches.
    pub fn along(&self, axis: usize) -> Vec<Repeated> {
        let mut all = self.of_axes[axis].clone();
        all.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.pdf.total_cmp(&b.pdf)));
        let same = all.chunk_by(|a, b| a.value == b.value).filter(|same| same.len() > 1);
        same.map(|same| Repeated { batches: same.len() as u64, ..same[same.len() - 1] }).collect()
    }
}

/// The values that several samples of a batch have, the most frequent ones of them.
///
/// Two passes over a filter that stays in the cache leave few samples to sort: those that share a bit with another.
fn of_batch(samples: impl Iterator<Item = (f64, f64)> + Clone) -> Vec<Repeated> {
    let (mut seen, mut again) = (vec![0u64; 1 << (BITS - 6)], vec![0u64; 1 << (BITS - 6)]);
    let place = |value: f64| {
        let hash = value.to_bits().wrapping_mul(GOLDEN) >> (64 - BITS);
        ((hash / 64) as usize, 1u64 << (hash % 64))
    };
    for (value, _) in samples.clone() {
        let (word, bit) = place(value);
        again[word] |= seen[word] & bit;
        seen[word] |= bit;
    }
    let is_again = |value: f64| {
        let (word, bit) = place(value);
        again[word] & bit != 0
    };
    let mut suspects: Vec<(f64, f64)> = samples.filter(|(value, _)| is_again(*value)).collect();
    suspects.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut repeated: Vec<&[(f64, f64)]> = suspects.chunk_by(|a, b| a.0 == b.0).filter(|s| s.len() > 1).collect();
    repeated.sort_by_key(|same| Reverse(same.len()));
    let of_value = |same: &[(f64, f64)]| Repeated { value: same[0].0, batches: 1, pdf: same[same.len() - 1].1 };
    repeated.into_iter().take(KEPT).map(of_value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::{Independent, Stream};
    use crate::{Line, Protocol, Sample, SampleCount, Verdict, density, sampler, validate};

    #[test]
    fn values_that_repeat_in_a_batch_are_counted() {
        let batch = |batch: u64| {
            let number = move |i: u32| Independent::new(1, batch, i).pair(0);
            (0..BATCH as u32)
                .map(move |i| if i % 3000 == 7 { ([0.25, number(i)[1]], f64::from(i)) } else { (number(i), 0.0) })
        };
        let (mut repeats, mut other) = (Repeats::default(), Repeats::default());
        (0..5).for_each(|i| repeats.count(i, 2, batch(i)));
        (5..8).chain([BATCHES]).for_each(|i| other.count(i, 2, batch(i)));
        repeats.add(other);
        assert_eq!(repeats.batches, 8);
        assert_eq!(repeats.along(0), [Repeated { value: 0.25, batches: 8, pdf: 6007.0 }]);
        assert_eq!(repeats.along(1), []);
    }

    #[test]
    fn clamped_values_are_found_and_rounded_ones_are_not() {
        let protocol = Protocol { samples: SampleCount::Fixed(200_000), cells: 50, ..Protocol::default() };
        let verdict = |change: fn(f64) -> f64| {
            let drawn = sampler(1, move |u: &[f64]| Some(Sample::new(change(u[0]))));
            validate(&Line::UNIT, &drawn, &density(|_: f64| 1.0), &protocol).unwrap()
        };
        // 4 of 10,000 samples have one value: 80 in all.
        let clamped = verdict(|u| if (u - 0.4).abs() < 2e-4 { 0.4 } else { u });
        assert_eq!(clamped.verdict, Verdict::Reject, "{clamped}");
        assert!(clamped.violation.as_ref().is_some_and(|what| what.contains("x = 0.4 is repeated")), "{clamped}");
        for right in [|u| u, |u| f64::from(u as f32), |u: f64| (u * 65536.0).floor() / 65536.0] {
            assert_eq!(verdict(right).violation, None);
        }
    }
}
