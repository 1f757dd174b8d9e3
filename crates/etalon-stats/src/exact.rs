//! Deterministic checks: what must hold for every sample and every value of the pdf; and values of a coordinate that several
//! samples of a batch have: clamped ones, for example.

use crate::counting::BATCH;
use crate::cubature::Probe;
use crate::diagnosis::{count, different, tuple};
use crate::domain::{Domain, Point};
use crate::error::Result;
use crate::extremes::Extremes;
use crate::hash::GOLDEN;
use crate::mistakes::Pair;
use crate::outcome::Compared;
use crate::power::chi_square_below;
use crate::sampler::{Density, SINGLE_PRECISION, Sample, Sampler};
use crate::serial::SerialCounts;
use std::cmp::Reverse;

/// Whether a point of an unbounded set is at infinity, where pdfs are 0 and formulas of them say anything.
pub fn is_infinite(point: &Point) -> bool {
    point.coordinates().iter().any(|x| x.is_infinite())
}

/// Whether a point of an unbounded set is so far away, or so close to 0, that charts do not tell it from others.
pub fn is_beyond_charts(point: &Point) -> bool {
    point.coordinates().iter().any(|x| *x != 0.0 && !(1e-60..1e60).contains(&x.abs()))
}

/// What is wrong with `pdf`, the density's value at a sample, if no pdf can have it. At single points a pdf may be infinite.
pub fn invalid_pdf(sample: &Sample, pdf: f64) -> Option<String> {
    (pdf.is_nan() && !is_infinite(&sample.point) || pdf < 0.0)
        .then(|| format!("the pdf at the sample {} is {pdf}", tuple(&sample.point)))
}

/// The relative difference of the pdf that a sample carries from `pdf`, the density's value there, if it carries one; 0 where
/// they are equal to the last bit, or up to the declared precision.
fn difference(sample: &Sample, pdf: f64, precision: f64) -> Option<f64> {
    let carried = sample.pdf?;
    let relative = relative_difference(carried, pdf);
    Some(if carried.to_bits() == pdf.to_bits() || relative <= precision { 0.0 } else { relative })
}

/// The relative difference of two numbers; infinite where one is not a number.
pub fn relative_difference(a: f64, b: f64) -> f64 {
    let relative = if a == b { 0.0 } else { (a - b).abs() / a.abs().at_least(b.abs()) };
    if relative.is_nan() { f64::INFINITY } else { relative }
}

/// The ordinary one of cases in which two numbers have these ratios: the one whose distance from 1, up or down, is nearest to the median, the
/// first where several are about as near.
pub fn ordinary(ratios: impl Iterator<Item = f64>) -> Option<usize> {
    /// Logarithms that differ by less are about the same.
    const ABOUT: f64 = 0.01;
    let size = |ratio: f64| if ratio > 0.0 { ratio.ln().abs() } else { f64::INFINITY };
    let all: Vec<f64> = ratios.map(size).collect();
    let mut sorted = all.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let median = *sorted.get(all.len() / 2)?;
    let far = |size: f64| if size == median { 0.0 } else { ((size - median).abs() / ABOUT).floor() };
    (0..all.len()).min_by(|&a, &b| far(all[a]).total_cmp(&far(all[b])))
}

/// The sentence on a sample that carries another pdf than the density's.
pub fn carries_another(sample: &Sample, pdf: f64) -> String {
    let [carried, asked] = different(sample.pdf.unwrap_or(f64::NAN), pdf);
    format!("the sample {} carries the pdf {carried}, but the density says {asked}", tuple(&sample.point))
}

/// What is wrong with a single sample and `pdf`, the density's value there.
fn pdf_violation(sample: &Sample, pdf: f64, precision: f64) -> Option<String> {
    invalid_pdf(sample, pdf).or_else(|| {
        let difference = difference(sample, pdf, precision).filter(|difference| *difference > 0.0)?;
        let hint = if difference <= SINGLE_PRECISION { AS_SINGLE } else { "" };
        Some(carries_another(sample, pdf) + hint)
    })
}

/// The end of a message on two numbers that differ as roundings in single precision do.
pub const AS_SINGLE: &str = ": as near as roundings in single precision (declare precision=single if it computes so)";

/// Samples whose pdfs are kept, of which the median difference and the mistake are known.
const PAIRS: usize = 1 << 10;
/// Sentences of a batch that are kept, of which an ordinary one is told.
const SENTENCES: usize = 1 << 5;

/// The pdfs that samples carry, compared with the density.
#[derive(Debug, Clone, Default)]
pub struct Carried {
    /// Samples that carry a pdf.
    compared: u64,
    /// Those of them that carry another one than the density has.
    different: u64,
    /// The largest relative difference.
    largest: f64,
    /// Ratios of some of the pdfs that differ to those of the density, and the sentences on them.
    told: Vec<(f64, String)>,
    /// Some of the samples that carry a pdf.
    pub pairs: Vec<Pair>,
}

impl Carried {
    /// Compares the pdf of a sample with `pdf`, the density's value there; `words` says that the two differ.
    #[inline]
    pub fn count(&mut self, sample: &Sample, pdf: f64, precision: f64, words: impl FnOnce() -> String) {
        let (Some(difference), Some(carried)) = (difference(sample, pdf, precision), sample.pdf) else { return };
        self.compared += 1;
        if self.pairs.len() < PAIRS {
            self.pairs.push((sample.point, [carried, pdf]));
        }
        if difference > 0.0 {
            self.different += 1;
            self.largest = self.largest.at_least(difference);
            if self.told.len() < SENTENCES {
                self.told.push((carried / pdf, words()));
            }
        }
    }

    pub fn add(&mut self, other: Self) {
        self.compared += other.compared;
        self.different += other.different;
        self.pairs.extend(other.pairs);
        self.pairs.truncate(PAIRS);
        self.largest = self.largest.at_least(other.largest);
        self.told.extend(other.told);
        self.told.truncate(PAIRS);
    }

    /// Whether all differences are those of roundings in single precision.
    pub fn is_rounding(&self) -> bool {
        self.different > 0 && self.largest <= SINGLE_PRECISION
    }

    /// The pdfs that differ, at directions that are turned so that the pole is +z.
    pub fn differences(&self, domain: &dyn Domain) -> Option<Compared> {
        let is_about_y = domain.at_angles([0.0; 2]).is_some_and(|pole| <[f64; 3]>::from(pole)[1] == 1.0);
        let turned = |point: Point| match point.coordinates() {
            &[x, y, z] if is_about_y => [z, x, y].into(),
            _ => point,
        };
        let places = self.pairs.iter().filter(|(_, [carried, pdf])| carried != pdf);
        let places: Vec<_> = places.map(|&(point, numbers)| (turned(point), numbers)).collect();
        let law = "the pdf that samples carry = the pdf".to_owned();
        (self.different > 0 && !places.is_empty()).then_some(Compared { law, places })
    }

    /// Samples that carry a pdf, and those of them that carry another one than the density has.
    pub fn counts(&self) -> [u64; 2] {
        [self.compared, self.different]
    }

    /// What is wrong at an ordinary sample; the share of samples that differ, the largest difference, and the median.
    pub fn violation(&self) -> Option<String> {
        let (_, sentence) = &self.told[ordinary(self.told.iter().map(|(ratio, _)| *ratio))?];
        let mut all: Vec<f64> =
            self.pairs.iter().map(|(_, [carried, pdf])| relative_difference(*carried, *pdf)).collect();
        all.sort_unstable_by(f64::total_cmp);
        let share = 100.0 * self.different as f64 / self.compared as f64;
        let share = if share < 0.1 { format!("{share:.1e}") } else { format!("{share:.1}").replace(".0", "") };
        let median = all[all.len() / 2];
        let hint = if self.is_rounding() { AS_SINGLE } else { "" };
        Some(format!(
            "{sentence}; {share} % of samples differ, the largest difference is {}, and the median of all is {}{hint}",
            percent(self.largest),
            percent(median)
        ))
    }
}

/// A share in percent; of one that is very small or larger than any that matters its order of magnitude.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match share {
        0.0 => "0.00 %".to_owned(),
        _ if share < 1e-4 => format!("{percent:.1e} %"),
        _ if share < 100.0 => format!("{percent:.2} %"),
        _ => format!("{percent:.0e} %"),
    }
}

/// What is wrong with a sample that has no chart coordinates.
pub fn outside(domain: &dyn Domain, sample: &Sample) -> String {
    format!("the sample {} is outside of the domain{}", tuple(&sample.point), domain.hint(sample.point))
}

/// What random numbers at the edges of \[0, 1) find, which a generator hardly ever returns.
#[derive(Default)]
pub struct Corners {
    /// What is wrong.
    pub violation: Option<String>,
    /// Where the pdf is infinite.
    pub infinite: Option<String>,
}

/// Tests the sampler with random numbers at the edges of \[0, 1).
pub fn corners(domain: &dyn Domain, sampler: &dyn Sampler, density: &dyn Density) -> Result<Corners> {
    const EDGES: [f64; 4] = [0.0, 0.5, 1.0 / (1u64 << 53) as f64, 1.0 - 1.0 / (1u64 << 53) as f64];
    let dimension = sampler.dimension();
    if dimension == 0 {
        return Ok(Corners::default());
    }
    // All corners of the cube in few dimensions; in many, those where all but one random number are ½.
    let corner = |i: usize| -> Vec<f64> {
        if dimension <= 4 {
            (0..dimension).map(|d| EDGES[i >> (2 * d) & 3]).collect()
        } else {
            (0..dimension).map(|d| if i / 4 == d { EDGES[i % 4] } else { 0.5 }).collect()
        }
    };
    let count = if dimension <= 4 { 1 << (2 * dimension) } else { 4 * dimension };
    let numbers: Vec<Vec<f64>> = (0..count).map(corner).collect();
    let mut samples = Vec::with_capacity(count);
    sampler.sample(&numbers.concat(), &mut samples)?;
    let from = |u: &[f64], what: String| format!("{what} (sampled from u = {})", tuple(&u));
    let mut corners = Corners::default();
    // A point outside of the domain has no pdf, and an atom none of its own.
    let (mut spread, mut points) = (Vec::new(), Vec::new());
    for (u, sample) in numbers.iter().zip(samples) {
        match sample {
            Some(sample) if domain.to_chart(sample.point).is_none() => {
                corners.violation.get_or_insert_with(|| from(u, outside(domain, &sample)));
            }
            Some(sample) if !sample.atom => {
                points.push(sample.point);
                spread.push((u, sample));
            }
            _ => {}
        }
    }
    let mut pdfs = Vec::with_capacity(points.len());
    density.pdf(&points, &mut pdfs)?;
    let all = spread.iter().zip(pdfs).filter(|((_, sample), _)| !is_infinite(&sample.point));
    for ((u, sample), pdf) in all {
        if let Some(violation) = pdf_violation(sample, pdf, density.precision()) {
            corners.violation.get_or_insert_with(|| from(u, violation));
        }
        if pdf == f64::INFINITY {
            corners.infinite.get_or_insert_with(|| from(u, tuple(&sample.point)));
        }
    }
    Ok(corners)
}

/// Tests whether the density returns the same values when asked again at the points of some probes.
pub fn repeatable(domain: &dyn Domain, density: &dyn Density, probes: &[Probe]) -> Result<Option<String>> {
    const POINTS: usize = 64;
    let places: Vec<[f64; 2]> = probes.iter().take(POINTS).map(|probe| probe.at).collect();
    let points = domain.points_at(&places)?;
    let ask = || -> Result<Vec<f64>> {
        let mut values = Vec::with_capacity(points.len());
        density.pdf(&points, &mut values).map(|()| values)
    };
    let (first, second) = (ask()?, ask()?);
    let differ = |a: f64, b: f64| a.to_bits() != b.to_bits() && !(a.is_nan() && b.is_nan());
    let found = points.iter().zip(first.iter().zip(&second)).find(|(_, (a, b))| differ(**a, **b));
    Ok(found.map(|(point, (a, b))| {
        format!("the pdf at {} is not the same when asked again: {a:e}, then {b:e}", tuple(point))
    }))
}

/// Fewest samples of a pilot in which values are compared.
const FEWEST: usize = 1000;
/// Values of an axis that are fewer than this and further apart than that share of themselves are no rounding of f32, whose
/// values are 2⁻²⁴ apart, also where a projection magnifies it a thousand times.
const VALUES: f64 = 16_384.0;
const SPACING: f64 = 1.0 / (1 << 18) as f64;
/// Chance explains what is less likely than this for no sampler.
const IMPOSSIBLE: f64 = 1e-9;
/// Probability, at most, that two independent samples of f32 numbers are equal.
const COINCIDENCE: f64 = 1.0 / (1 << 20) as f64;

/// Finds samples that repeat the one before, more often than two samples of the pilot are equal otherwise.
pub fn repeated(domain: &dyn Domain, probes: &[Probe]) -> Option<String> {
    if domain.outcomes().is_some() || probes.len() < FEWEST {
        return None;
    }
    let mut points: Vec<[u64; 2]> = probes.iter().map(|probe| probe.at.map(f64::to_bits)).collect();
    let samples = points.len();
    let repeats = points.windows(2).filter(|pair| pair[0] == pair[1]).count();
    points.sort_unstable();
    let pairs: f64 = points.chunk_by(|a, b| a == b).map(|same| (same.len() * (same.len() - 1)) as f64).sum();
    let n = samples as f64;
    let expected = n * (pairs / (n * (n - 1.0))).at_least(COINCIDENCE);
    let p = if repeats > 0 { chi_square_below(2.0 * repeats as f64, 2.0 * expected) } else { 1.0 };
    let percent = 100.0 * repeats as f64 / samples as f64;
    (p < IMPOSSIBLE).then(|| format!("samples depend on those before them: {percent:.2} % repeat the one before"))
}

/// Finds outcomes of a finite set that never occur although the pdf has them: the others meet more often.
///
/// In N draws, "no sample" and atoms among them, the samples of outcomes with N p ≤ 1 make (N − 1)/2 Σ p(xᵢ) equal pairs on
/// average, whatever p is, and nearly a Poisson-distributed number. Cells hold many outcomes and do not see it.
pub fn collisions(domain: &dyn Domain, probes: &[Probe], draws: u64) -> Option<String> {
    let n = draws as f64;
    let outcomes = domain.outcomes().filter(|_| probes.len() >= FEWEST)? as f64;
    let known = probes.iter().map(|probe| (probe.at[0].to_bits(), probe.density / outcomes));
    let mut rare: Vec<(u64, f64)> = known.filter(|(_, pdf)| n * pdf <= 1.0).collect();
    let expected = 0.5 * (n - 1.0) * rare.iter().map(|(_, pdf)| pdf).sum::<f64>();
    rare.sort_unstable_by_key(|(outcome, _)| *outcome);
    let pairs: usize = rare.chunk_by(|a, b| a.0 == b.0).map(|same| same.len() * (same.len() - 1) / 2).sum();
    let p = if pairs > 0 { chi_square_below(2.0 * pairs as f64, 2.0 * expected) } else { 1.0 };
    (p < IMPOSSIBLE).then(|| {
        format!(
            "some outcomes occur too often, others too rarely or never: {} of equal samples among {}, {expected:.0} \
             expected (counting outcomes with a probability of at most 1/{draws})",
            count(pairs, "pair", "pairs"),
            probes.len()
        )
    })
}

/// Finds a sampler of a continuous domain that returns the same few points or coordinates again and again.
pub fn discrete(domain: &dyn Domain, probes: &[Probe], mass: f64) -> Option<String> {
    if domain.outcomes().is_some() || probes.len() < FEWEST {
        return None;
    }
    let axes = if domain.is_plane() { 2 } else { 1 };
    (0..axes).find_map(|axis| few_values(domain, axis, probes, mass)).or_else(|| {
        let mut points: Vec<[u64; 2]> = probes.iter().map(|probe| probe.at.map(f64::to_bits)).collect();
        points.sort_unstable();
        points.dedup();
        let (points, samples) = (points.len(), probes.len());
        (4 * points < samples)
            .then(|| format!("this sampler is discrete: only {points} distinct points in {samples} samples"))
    })
}

/// Finds a coordinate with few values, or with one value that many samples have.
fn few_values(domain: &dyn Domain, axis: usize, probes: &[Probe], mass: f64) -> Option<String> {
    let mut values: Vec<(f64, f64)> = probes.iter().map(|probe| (probe.at[axis], probe.density)).collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let groups: Vec<&[(f64, f64)]> = values.chunk_by(|a, b| a.0 == b.0).collect();
    let (samples, distinct) = (values.len() as f64, groups.len() as f64);

    // A value that many times as many samples have as one value has on average, where the density is not so high that
    // single precision has no other value near.
    let common = groups.iter().max_by_key(|group| group.len())?;
    let highest = common.iter().map(|(_, density)| *density).fold(0.0, f64::at_least);
    let is_steep = highest / mass * COINCIDENCE * samples > 1.0;
    if common.len() as f64 > 8.0 * samples / distinct && !is_steep {
        let percent = 100.0 * common.len() as f64 / samples;
        let same = domain.told(axis, common[0].0);
        return Some(format!("{percent:.2} % of the samples have the same {same}, where the pdf has no atom"));
    }

    // N samples meet, of M equally likely values, M (1 − e^(−N/M)). Fewer values than the limit are a lattice, if they are
    // further apart than single precision has them.
    let met = |m: f64| m * -(-samples / m).exp_m1();
    let mut gaps: Vec<f64> = groups.windows(2).map(|pair| (pair[1][0].0 - pair[0][0].0) / pair[1][0].0).collect();
    gaps.sort_by(f64::total_cmp);
    (distinct < met(VALUES) && gaps.get(gaps.len() / 2).is_some_and(|gap| *gap > SPACING)).then(|| {
        let (mut few, mut many) = (1.0f64, VALUES);
        for _ in 0..60 {
            let middle = (few * many).sqrt();
            if met(middle) < distinct { few = middle } else { many = middle }
        }
        format!(
            "{} takes about {many:.0} values only, each many times: random numbers of {:.1} bits, or rounded samples",
            domain.axes()[axis],
            many.log2()
        )
    })
}

/// The distance of f32 numbers just below 1.
const SINGLE_ULP: f64 = 1.0 / (1u64 << 24) as f64;

/// Finds a value of a coordinate that several samples of a batch have, in more batches than chance explains.
///
/// A value that each sample has with the probability q is repeated in one of n samples with at most (nq)²/2. For samples that
/// are rounded, q is the probability that two of the pilot are equal, at least that of f32 numbers, times the density. At the
/// ends of an axis samplers clamp what rounding puts beyond them, up to the root of a rounding error (of √(1 − x²) at x = 1): 2⁻¹²
/// in single precision, which is as frequent as what could be found here.
pub fn repeated_values(domain: &dyn Domain, probes: &[Probe], repeats: &Repeats, mass: f64) -> Option<String> {
    let n = probes.len() as f64;
    (0..1 + usize::from(domain.is_plane())).find_map(|axis| {
        let mut values: Vec<u64> = probes.iter().map(|probe| probe.at[axis].to_bits()).collect();
        values.sort_unstable();
        let pairs: usize = values.chunk_by(|a, b| a == b).map(|same| same.len() * (same.len() - 1)).sum();
        let equal = (pairs as f64 / (n * (n - 1.0)).at_least(1.0)).at_least(COINCIDENCE);
        let is_impossible = |of: &Repeated| {
            let q = equal * (of.density / mass).at_least(1.0);
            let expected = repeats.batches as f64 * (0.5 * (BATCH as f64 * q).powi(2)).at_most(1.0);
            // Any of as many values could be found.
            chi_square_below(2.0 * of.batches as f64, 2.0 * expected) < IMPOSSIBLE * COINCIDENCE
        };
        let is_inside = |of: &Repeated| of.value > SINGLE_ULP && of.value < 1.0 - SINGLE_ULP;
        let inside = repeats.along(axis).into_iter().filter(is_inside);
        let found = inside.filter(is_impossible).max_by_key(|of| of.batches)?;
        let Repeated { value, batches, .. } = found;
        let (of, value) = (repeats.batches, domain.told(axis, value));
        Some(format!("{value} is repeated in {batches} of {of} batches of samples, where the pdf has no atom"))
    })
}

/// Finds batches that begin with the same samples though their random numbers or seeds differ.
pub fn same_batches(domain: &dyn Domain, serial: &SerialCounts) -> Option<String> {
    let repeated = if domain.outcomes().is_none() { serial.repeated_batches() } else { 0 };
    (repeated > 0).then(|| {
        format!(
            "samples repeat: {} with the same samples as another of a different seed",
            count(repeated, "batch begins", "batches begin")
        )
    })
}

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
    /// The largest density of these samples per area of the chart.
    pub density: f64,
}

/// Values that several samples of a batch have, from the batches so far.
#[derive(Debug, Clone, Default)]
pub struct Repeats {
    /// Batches looked at.
    pub batches: u64,
    of_axes: [Vec<Repeated>; 2],
}

impl Repeats {
    /// Looks at batch number `batch`: coordinates along the `axes` first axes, and the density there.
    pub fn count(&mut self, batch: u64, axes: usize, samples: impl Iterator<Item = ([f64; 2], f64)> + Clone) {
        if batch >= BATCHES {
            return;
        }
        self.batches += 1;
        for (axis, repeated) in self.of_axes.iter_mut().enumerate().take(axes) {
            repeated.extend(of_batch(samples.clone().map(|(at, density)| (at[axis], density))));
        }
    }

    pub fn add(&mut self, other: Self) {
        self.batches += other.batches;
        self.of_axes.iter_mut().zip(other.of_axes).for_each(|(repeated, more)| repeated.extend(more));
    }

    /// The values of an axis that are repeated in several batches.
    pub fn along(&self, axis: usize) -> Vec<Repeated> {
        let mut all = self.of_axes[axis].clone();
        all.sort_by(|a, b| a.value.total_cmp(&b.value).then(a.density.total_cmp(&b.density)));
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
    let of_value = |same: &[(f64, f64)]| Repeated { value: same[0].0, batches: 1, density: same[same.len() - 1].1 };
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
        assert_eq!(repeats.along(0), [Repeated { value: 0.25, batches: 8, density: 6007.0 }]);
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
