//! Whether two renderers have the same expectation: Welch's t-tests of linear functionals of their images.
//!
//! A *functional* is a weighted mean of the pixels: the mean of the image, its low-order cosine modes, the mean of each tile.
//! It is evaluated for each replicate, so that pixels may correlate, by filters, by light paths, by sample patterns: only
//! replicates must be independent. Source of the test by tiles: Jung, Hanika & Dachsbacher, "Detecting Bias in Monte Carlo
//! Renderers using Welch's t-test", JCGT 9(2), 2020.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod bias;
mod explain;
mod functionals;
mod measured;
mod noise;
mod side;

pub use self::bias::Bias;
pub use self::explain::{Explanation, explain_turned, with_interval};
pub use self::functionals::{Family, Functional};
pub use self::measured::{Limit, METRICS, Measured, Metric};
pub use self::side::{Noise, NotFinite, PRECISION, Side};
pub use bias::Needed;
pub use noise::Related;

use self::functionals::{Blocks, Layout, Observed};
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_stats::Extremes;
use etalon_stats::estimate::{Difference, is_dominated};
use etalon_stats::welch::Mean;
use rayon::prelude::*;
use serde::Serialize;
use std::cmp::Ordering;

/// What to test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Probability of calling images of one expectation different.
    pub level: f64,
    /// The relative bias of the whole image that is to be found with 90 % probability.
    pub detect: f64,
}

/// What the tests say together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Answer {
    Different,
    /// No difference found, though a uniform bias as small as asked for would have been found.
    NoDifferenceFound,
    /// No difference found, and such a bias might have gone unnoticed.
    CannotTell,
    /// Nothing can be said: the images of a side are no replicates.
    NotIndependent,
    /// A pixel is NaN or infinite, which is a wrong result; no difference is found in the others.
    NotFinite,
}

/// One functional in one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tested {
    pub functional: Functional,
    /// 0 to 2: R, G, B, or X, Y, Z.
    pub channel: usize,
    pub means: [f64; 2],
    /// That of B with its error.
    of_b: Mean,
    pub difference: Difference,
    /// Why it is not tested: one replicate, or one pixel, makes nearly all of the variance.
    pub dominated: bool,
}

/// The tests of one family, which share a third of the level.
#[derive(Debug, Clone, PartialEq)]
pub struct FamilyResult {
    pub family: Family,
    /// All tests; none where the family cannot be tested.
    pub tests: Vec<Tested>,
    /// The test with the smallest p-value among those that are not dominated.
    pub worst: Option<Tested>,
    /// p of `worst`, corrected for the number of tests and of families: below the level, the images differ.
    pub adjusted_p: Option<f64>,
    /// Tests without a result because a few samples dominate.
    pub dominated: usize,
    /// Why the family is not tested.
    pub untested: Option<&'static str>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    pub plan: Plan,
    pub answer: Answer,
    pub families: Vec<FamilyResult>,
    /// Smallest relative bias of the whole image that would have been found with 90 % probability; none where the mean is dominated.
    pub uniform_bias: Option<f64>,
    /// The same of a single tile, relative to the image's mean: the median over the tiles.
    pub tile_bias: Option<f64>,
    /// The same, relative to the tile's own mean.
    pub own_tile_bias: Option<f64>,
    pub channels: [&'static str; 3],
    /// The mean of B's image, by channel.
    pub mean_of_b: [Mean; 3],
    /// Columns and rows of pixels.
    pub size: [usize; 2],
    /// Side of a tile in pixels.
    pub tile_side: usize,
    pub images: [usize; 2],
    /// Two images of a side that are no replicates of one another.
    pub related: [Option<Related>; 2],
    /// The variance of the noise of an image that is declared exact, by that of the other side's mean, if it is allowed for: it
    /// is found, or it would explain the difference.
    pub noise_of_exact: Option<f64>,
    /// Whether the images would be different if the one that is declared exact had no noise.
    pub noise_hides_difference: bool,
    /// What it would take to find the bias that is asked for; none where it would be found, or if the means are dominated.
    pub needed: Option<Needed>,
    /// Tiles of each side that are equal in all replicates, and not black, though they vary on the other side: their noise is
    /// the same in all images, unless the side has none there.
    pub constant_tiles: [usize; 2],
    /// Pixels left out because they are not finite in an image.
    pub non_finite: usize,
    /// The first image with such a pixel, which rejects it as `converge` rejects a run: a program that writes NaN is wrong.
    pub not_finite: Option<NotFinite>,
    pub means: [Image; 2],
    /// What would explain their difference, if the sides are different.
    pub explanation: Option<Explanation>,
}

/// Number of families, which share the level.
const FAMILIES: f64 = 3.0;

/// The share of the level at which images count as no replicates, or as not exact: such an alarm hides what the tests say.
const OF_PREMISES: f64 = 0.1;

/// Tests whether `a` and `b` have the same expectation.
///
/// The level is shared by the families (mean, low frequency, tiles) and in each by its tests, dominated ones included, so
/// that leaving these out cannot raise the probability of a false alarm (Bonferroni).
///
/// # Errors
/// [`Error::Parameter`] when sizes differ, an image occurs twice, no pixel is finite everywhere, or neither side has noise.
pub fn compare(a: Side, b: Side, plan: Plan) -> Result<Compared> {
    let mut sides = [a, b];
    check(&sides)?;
    let not_finite = side::not_finite(&sides);
    let channels = side::in_common_colours(&mut sides);
    let valid = side::finite(&sides);
    let layout = Layout::new(sides[0].size(), &valid);
    if layout.pixels() == 0 {
        return Err(Error::parameter(
            "against",
            "no pixel has finite values in all images (and errors, which take two samples): nothing to compare",
        ));
    }
    // [side][functional][channel]
    let mut observed: Vec<Vec<[Observed; 3]>> = [[0, 1], [1, 0]]
        .map(|[k, l]| observe([&sides[k], &sides[l]], &layout, plan.level))
        .into_iter()
        .collect::<Result<_>>()?;
    let constant_tiles = [0, 1].map(|side| constant_tiles(&sides, &observed, &layout, &valid, side));
    observed.iter_mut().for_each(|side| widen(side, &layout));
    let blocks = Blocks::new(sides[0].size(), &valid);
    let related = sides.each_ref().map(|side| noise::related(&side.images, &blocks, OF_PREMISES * plan.level));
    let exact = sides.iter().position(|side| side.noise == Noise::None);
    let noise = exact
        .and_then(|k| Some((k, noise::noise(&sides[k].images[0], &sides[1 - k], &blocks, OF_PREMISES * plan.level)?)));
    let means = sides.each_ref().map(side::mean_image);
    let scales = layout.scales(&means[1]);
    let few = sides.iter().any(Side::has_few_replicates).then_some("fewer than 16 replicates on a side");
    let families_of = |observed: &[Vec<_>], no_tiles| families(observed, &layout, &scales, no_tiles);
    let is_different =
        |all: &[FamilyResult]| all.iter().any(|family| family.adjusted_p.is_some_and(|p| p < plan.level));
    let mut families = families_of(&observed, few);
    // Noise that is found is allowed for. Fine detail that differs looks like noise: where that alone would explain a
    // difference, found or not, nothing can be said.
    let (mut noise_of_exact, mut noise_hides_difference) = (None, false);
    if let Some((k, noise)) = noise {
        let allowed = noise.allowed_for(&observed, k);
        // One noisy image says nothing of how its noise is distributed over the few pixels of a tile.
        let no_tiles = few.or(noise.found.then_some("noise in the image that is declared exact"));
        let with_noise = families_of(&allowed, no_tiles);
        noise_hides_difference = is_different(&families) && !is_different(&with_noise);
        if noise.found || noise_hides_difference {
            (observed, families, noise_of_exact) = (allowed, with_noise, Some(noise.ratio));
        }
    }
    let different = is_different(&families);
    let relative = |test: &Tested, to: &Tested, level: f64| {
        test.difference.detectable(level) / (0.5 * (to.means[0].abs() + to.means[1].abs()))
    };
    let whole = &families[0];
    // A channel that is black on both sides has no share.
    let shares = whole.tests.iter().map(|test| relative(test, test, whole.level(plan))).filter(|share| !share.is_nan());
    let uniform = shares.fold(f64::INFINITY, f64::at_most);
    let uniform_bias = Some(uniform).filter(|bias| bias.is_finite() && whole.dominated == 0);
    let of_tile = |is_own: bool| {
        let usable = families[2].tests.iter().filter(|test| !test.dominated);
        let relative = |test: &Tested| {
            relative(test, if is_own { test } else { &whole.tests[test.channel] }, families[2].level(plan))
        };
        let mut biases: Vec<f64> = usable.map(relative).filter(|bias| bias.is_finite()).collect();
        biases.sort_unstable_by(f64::total_cmp);
        biases.get(biases.len() / 2).copied()
    };
    let [tile_bias, own_tile_bias] = [false, true].map(of_tile);
    let answer = match uniform_bias {
        _ if different && related.iter().all(Option::is_none) => Answer::Different,
        _ if related.iter().any(Option::is_some) => Answer::NotIndependent,
        _ if not_finite.is_some() => Answer::NotFinite,
        Some(bias) if bias <= plan.detect && !noise_hides_difference => Answer::NoDifferenceFound,
        _ => Answer::CannotTell,
    };
    let of_image = [0, 1].map(|side| observed[side][0].each_ref().map(|channel| channel.mean));
    let is_noisy = answer == Answer::CannotTell && whole.dominated == 0 && !noise_hides_difference;
    let needed = if is_noisy {
        bias::needed(&sides, of_image, scales[0].map(|scale| PRECISION * scale), whole.level(plan), plan.detect)
    } else {
        None
    };
    // XYZ has no channels to swap and no values to encode
    let is_different = answer == Answer::Different && channels[0] == "R";
    let explanation = is_different.then(|| explain::explain(&means[0], &means[1], [false; 2]).explanation()).flatten();
    Ok(Compared {
        plan,
        answer,
        explanation,
        uniform_bias,
        tile_bias,
        own_tile_bias,
        families,
        channels,
        mean_of_b: of_image[1],
        size: sides[0].size(),
        tile_side: layout.side(),
        images: sides.each_ref().map(|side| side.images.len()),
        related,
        noise_of_exact,
        noise_hides_difference,
        needed,
        constant_tiles,
        not_finite,
        non_finite: valid.iter().filter(|v| !**v).count(),
        means,
    })
}

/// The tests of all families, from what both sides say of each functional; `scales` are what their precision is relative to,
/// and `no_tiles` is why tiles are not tested.
fn families(
    observed: &[Vec<[Observed; 3]>],
    layout: &Layout,
    scales: &[[f64; 3]],
    no_tiles: Option<&'static str>,
) -> Vec<FamilyResult> {
    let of_family = |family: Family| {
        let untested = no_tiles.filter(|_| family == Family::Tiles);
        let of_functional = |i: usize| {
            let functional = layout.functional(i);
            (0..3).map(move |channel| {
                let [a, b] = [&observed[0][i][channel], &observed[1][i][channel]];
                Tested {
                    functional,
                    channel,
                    means: [a.mean.value, b.mean.value],
                    of_b: b.mean,
                    difference: Difference::of(a.mean, b.mean, PRECISION * scales[i][channel]),
                    dominated: a.dominated || b.dominated,
                }
            })
        };
        let tests = layout.of(family).filter(|_| untested.is_none()).flat_map(of_functional).collect();
        let mut result = FamilyResult { family, tests, worst: None, adjusted_p: None, dominated: 0, untested };
        result.judge();
        result
    };
    Family::ALL.into_iter().map(of_family).collect()
}

impl Compared {
    /// The difference of a test of `family`, in parts of the mean of B: of the image's, or of a tile's own; nothing where that is not told
    /// from 0.
    pub fn bias(&self, family: &FamilyResult, test: &Tested) -> Option<Bias> {
        let of_b = if family.family == Family::Tiles { test.of_b } else { self.mean_of_b[test.channel] };
        Bias::of(test.difference, of_b, family.level(self.plan))
    }
}

impl Tested {
    /// The order of tests, the least likely first: by t where p is too small for a double.
    pub fn by_p(&self, other: &Self) -> Ordering {
        let [a, b] = [self, other].map(|test| test.difference);
        a.p().total_cmp(&b.p()).then(b.t().abs().total_cmp(&a.t().abs()))
    }
}

impl FamilyResult {
    /// Finds the smallest p-value and corrects it.
    fn judge(&mut self) {
        self.dominated = self.tests.iter().filter(|test| test.dominated).count();
        let usable = self.tests.iter().filter(|test| !test.dominated);
        self.worst = usable.min_by(|a, b| a.by_p(b)).copied();
        self.adjusted_p = self.worst.map(|test| self.adjusted(&test));
    }

    pub fn level(&self, plan: Plan) -> f64 {
        plan.level / FAMILIES / self.tests.len().max(1) as f64
    }

    /// The p-value of a test, corrected for the number of tests and of families.
    pub fn adjusted(&self, test: &Tested) -> f64 {
        (test.difference.p() * self.tests.len() as f64 * FAMILIES).at_most(1.0)
    }
}

/// A pixel with more than this share of a functional's variance decides alone.
const MOST: f64 = 0.5;

/// All functionals of the first side.
fn observe([side, other]: [&Side; 2], layout: &Layout, level: f64) -> Result<Vec<[Observed; 3]>> {
    interrupt::check()?;
    let values: Vec<Vec<[f64; 3]>> = side.images.par_iter().map(|image| layout.values(image)).collect();
    // The level at which normal replicates would count as dominated anywhere at all.
    let each = level / (2.0 * 3.0 * layout.count() as f64);
    let spread = side.error().map(|error| layout.spread(error));
    // Against an image without noise nothing offsets the skewness of a single pixel's.
    let is_one_sided = side.noise == Noise::Replicates && other.noise == Noise::None;
    let of_pixels = is_one_sided.then(|| layout.spread(&noise::deviations(&side.images)));
    let of = |i: usize, channel: usize| {
        let replicates: Vec<f64> = values.iter().map(|values| values[i][channel]).collect();
        match (side.noise, &spread) {
            (_, Some(spread)) => {
                let (variance, dof, share) = spread[i][channel].parts();
                // A pixel that outweighs all others together: their sum is as uncertain, and as skewed, as the one sample
                // that may be behind it, whatever the number of pixels.
                Observed { mean: Mean { value: replicates[0], variance, dof }, dominated: share > MOST }
            }
            (Noise::Replicates, None) => Observed {
                mean: Mean::of_replicates(&replicates).unwrap_or(Mean::exact(replicates[0])),
                dominated: is_dominated(&replicates, each)
                    || of_pixels.as_ref().is_some_and(|spread| spread[i][channel].parts().2 > MOST),
            },
            (Noise::None | Noise::PerPixel, None) => Observed { mean: Mean::exact(replicates[0]), dominated: false },
        }
    };
    let mut observed: Vec<[Observed; 3]> =
        (0..layout.count()).map(|i| [0, 1, 2].map(|channel| of(i, channel))).collect();
    if side.has_few_replicates() {
        let own: Vec<[Mean; 3]> = observed.iter().map(|channels| channels.each_ref().map(|of| of.mean)).collect();
        for (observed, means) in observed.iter_mut().zip(noise::pool([side, other], layout, &own)) {
            observed.iter_mut().zip(means).for_each(|(of, mean)| of.mean = mean);
        }
    }
    Ok(observed)
}

/// How many tiles of a side have the same bits in all replicates, and are not black, though they vary on the other side.
fn constant_tiles(
    sides: &[Side; 2],
    observed: &[Vec<[Observed; 3]>],
    layout: &Layout,
    valid: &[bool],
    side: usize,
) -> usize {
    let width = sides[0].size()[0];
    let is_constant = |i: &usize| {
        let Functional::Tile([x, y, w, h]) = layout.functional(*i) else { return false };
        let pixels = || (y..y + h).flat_map(|y| (x..x + w).map(move |x| y * width + x)).filter(|i| valid[*i]);
        let bits = |image: &Image, i: usize| image.pixels()[i].to_array().map(f32::to_bits);
        let varies = |side: &Side| {
            let [first, others @ ..] = side.images.as_slice() else { return false };
            others.iter().any(|other| pixels().any(|i| bits(first, i) != bits(other, i)))
        };
        // One image has no bits that vary, but errors
        let has_noise = |side: usize| observed[side][*i].iter().any(|channel| channel.mean.variance > 0.0);
        let other = &sides[1 - side];
        let other_varies = if other.noise == Noise::Replicates { varies(other) } else { has_noise(1 - side) };
        let is_black = pixels().all(|i| sides[side].images[0].pixels()[i] == Rgb::ZERO);
        other_varies && !is_black && !varies(&sides[side])
    };
    let tiles = layout.of(Family::Tiles).filter(is_constant);
    if sides[side].noise == Noise::Replicates { tiles.count() } else { 0 }
}

/// Gives each tile at least the mean variance of its neighbourhood of 3 by 3 tiles.
///
/// Light is skewed to the right: a few replicates, or the samples of a few pixels, without a rare bright path have a low mean
/// *and* a low variance, and t is far out on the negative side. With the right variance, that side's tail is thinner than the
/// normal one; on the other side the bright path is there, and in the variance. So what must not happen is a variance that is
/// too low; neighbours have seen the same paths. 3 by 3 is the smallest neighbourhood that prefers no direction. A larger
/// variance can only lower the probability of a false alarm.
fn widen(observed: &mut [[Observed; 3]], layout: &Layout) {
    let tiles: Vec<usize> = layout.of(Family::Tiles).collect();
    let pooled = |i: usize, channel: usize| {
        let near = layout.neighbours(i);
        near.iter().map(|&i| observed[i][channel].mean.variance).sum::<f64>() / near.len() as f64
    };
    let variances: Vec<[f64; 3]> = tiles.iter().map(|&i| [0, 1, 2].map(|channel| pooled(i, channel))).collect();
    for (i, pooled) in tiles.into_iter().zip(variances) {
        for (observed, pooled) in observed[i].iter_mut().zip(pooled) {
            observed.mean.variance = observed.mean.variance.at_least(pooled);
        }
    }
}

fn check(sides: &[Side; 2]) -> Result<()> {
    let first = sides[0].size();
    let size = |image: &Image| [image.width(), image.height()];
    for (side, name) in sides.iter().zip(["A", "B"]) {
        let Some(i) = side.images.iter().position(|image| size(image) != first) else { continue };
        let [width, height] = size(&side.images[i]);
        // Images in memory have no file.
        let which = side.files.get(i).map_or(format!("an image of {name}"), |path| path.display().to_string());
        let message = format!("sizes differ: {which} has {width}x{height} pixels, the first {}x{}", first[0], first[1]);
        return Err(Error::parameter("images", message).with_hint("only images of the same size can be compared"));
    }
    if sides.iter().all(|side| side.noise == Noise::None) {
        return Err(Error::parameter("exact", "neither side has noise: compare the two images without a test"));
    }
    side::check_distinct(sides)
}

#[cfg(test)]
mod tests;
