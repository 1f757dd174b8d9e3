//! False alarms by numbers of replicates, kinds of noise and sizes of images: images of one expectation whose noise is made here.

use super::super::{Answer, Compared, Plan, Side, compare};
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_stats::stream::CounterRng;
use rand::RngExt;
use rayon::prelude::*;
use statrs::distribution::{Binomial, DiscreteCDF};

/// Noise of mean 1: that of a pixel, and the side of the squares of pixels over which it is averaged.
#[derive(Clone, Copy)]
struct Noise {
    name: &'static str,
    value: fn(&mut CounterRng) -> f64,
    side: usize,
}

fn open(rng: &mut CounterRng) -> f64 {
    1.0 - rng.random::<f64>()
}

fn gamma(rng: &mut CounterRng) -> f64 {
    -open(rng).ln()
}

fn lognormal(rng: &mut CounterRng) -> f64 {
    let normal = (-2.0 * open(rng).ln()).sqrt() * (std::f64::consts::TAU * rng.random::<f64>()).cos();
    (normal - 0.5).exp()
}

/// P(x > t) = (t/t₀)⁻³: the variance is finite, the skewness is not.
fn pareto(rng: &mut CounterRng) -> f64 {
    2.0 / 3.0 * open(rng).powf(-1.0 / 3.0)
}

const NOISES: [Noise; 5] = [
    Noise { name: "gamma", value: gamma, side: 1 },
    Noise { name: "lognormal", value: lognormal, side: 1 },
    Noise { name: "Pareto", value: pareto, side: 1 },
    Noise { name: "gamma over 2 pixels", value: gamma, side: 2 },
    Noise { name: "gamma over 8 pixels", value: gamma, side: 8 },
];
const SIZES: [[usize; 2]; 2] = [[32, 24], [96, 72]];
const PLAN: Plan = Plan { level: 0.01, detect: 0.01 };

/// The values of an image's pixels in one channel.
fn channel(rng: &mut CounterRng, noise: Noise, [width, height]: [usize; 2]) -> Vec<f64> {
    let side = noise.side;
    let [columns, rows] = [width + side - 1, height + side - 1];
    let values: Vec<f64> = (0..columns * rows).map(|_| (noise.value)(rng)).collect();
    if side == 1 {
        return values;
    }
    let mean = |x: usize, y: usize| {
        let rows = (y..y + side).map(|y| values[y * columns + x..][..side].iter().sum::<f64>());
        rows.sum::<f64>() / (side * side) as f64
    };
    (0..width * height).map(|i| mean(i % width, i / width)).collect()
}

fn image(rng: &mut CounterRng, noise: Noise, size: [usize; 2]) -> Image {
    let channels = [0, 1, 2].map(|_| channel(rng, noise, size));
    Image::from_fn(size[0], size[1], |x, y| Rgb::from_array(channels.each_ref().map(|c| c[y * size[0] + x] as f32)))
}

fn replicates(rng: &mut CounterRng, noise: Noise, size: [usize; 2], n: usize) -> Side {
    Side::replicates((0..n).map(|_| image(rng, noise, size)).collect())
}

/// The mean of `n` samples a pixel, with its standard error.
fn with_errors(rng: &mut CounterRng, noise: Noise, [width, height]: [usize; 2], n: usize) -> Side {
    let (mut mean, mut error) = (Image::new(width, height), Image::new(width, height));
    for i in 0..width * height {
        let estimates = [0, 1, 2].map(|_| {
            let samples: Vec<f64> = (0..n).map(|_| (noise.value)(rng)).collect();
            etalon_stats::welch::Mean::of_replicates(&samples).unwrap()
        });
        mean.set(i % width, i / width, Rgb::from_array(estimates.map(|e| e.value as f32)));
        error.set(i % width, i / width, Rgb::from_array(estimates.map(|e| e.variance.sqrt() as f32)));
    }
    Side::with_error(mean, error)
}

type MakeSide = fn(&mut CounterRng, Noise, [usize; 2], usize) -> Side;

/// How many of `pairs` pairs of images of one expectation are called different, and how many not independent.
fn rejected(seed: u64, pairs: u64, side: MakeSide, noise: Noise, size: [usize; 2], n: [usize; 2]) -> [u64; 2] {
    let answer = |pair: u64| {
        let mut rng = CounterRng::new(seed, pair);
        let [a, b] = n.map(|n| side(&mut rng, noise, size, n));
        compare(a, b, PLAN).unwrap().answer
    };
    let answers: Vec<Answer> = (0..pairs).into_par_iter().map(answer).collect();
    [Answer::Different, Answer::NotIndependent].map(|wrong| answers.iter().filter(|of| **of == wrong).count() as u64)
}

/// The number of rejections at the level that a right test exceeds with a probability of 0.1 % at most.
fn limit(pairs: u64) -> u64 {
    Binomial::new(PLAN.level, pairs).unwrap().inverse_cdf(0.999)
}

/// What is compared: a way to make sides, kinds of noise, sizes, and numbers of replicates or samples of A and of B.
struct Table<'a> {
    title: &'a str,
    side: MakeSide,
    noises: &'a [Noise],
    sizes: &'a [[usize; 2]],
    numbers: [&'a [usize]; 2],
    /// In each cell.
    pairs: u64,
}

impl Table<'_> {
    /// Counts the rejections of all cells, prints them, and checks all, each row and each column against their limits.
    fn level_is_held(&self) {
        // Numbers of A and B, and how many are called different and not independent.
        let mut cells: Vec<([usize; 2], [u64; 2])> = Vec::new();
        for noise in self.noises {
            for &size in self.sizes {
                println!("\n{}, {}, {}x{}: of {}", self.title, noise.name, size[0], size[1], self.pairs);
                for &a in self.numbers[0] {
                    let row = cells.len();
                    for &b in self.numbers[1] {
                        let count = rejected(cells.len() as u64, self.pairs, self.side, *noise, size, [a, b]);
                        cells.push(([a, b], count));
                    }
                    let counts: Vec<String> = cells[row..].iter().map(|(_, [d, n])| format!("{d} + {n}")).collect();
                    println!("| {a} | {} |", counts.join(" | "));
                }
            }
        }
        let check = |name: String, of: &dyn Fn([usize; 2]) -> bool| {
            let counts = cells.iter().filter(|(numbers, _)| of(*numbers)).map(|(_, [d, n])| d + n);
            let (pairs, count): (u64, u64) = (self.pairs * counts.clone().count() as u64, counts.sum());
            println!("{}, {name}: {count} of {pairs}, limit {}", self.title, limit(pairs));
            assert!(count <= limit(pairs), "{}, {name}: {count} of {pairs}", self.title);
        };
        for (k, name) in ["A", "B"].into_iter().enumerate() {
            for n in self.numbers[k] {
                check(format!("{name} {n}"), &|numbers| numbers[k] == *n);
            }
        }
        check("all".into(), &|_| true);
    }
}

const REPLICATES: Table<'static> = Table {
    title: "replicates",
    side: replicates,
    noises: &NOISES,
    sizes: &SIZES,
    numbers: [&[2, 3, 4, 6, 8, 16, 64], &[2, 4, 16, 64]],
    pairs: 200,
};

#[test]
fn few_replicates_hold_the_level() {
    Table { sizes: &SIZES[..1], numbers: [&[2, 3], &[4, 16]], pairs: 20, ..REPLICATES }.level_is_held();
}

#[test]
#[ignore = "takes minutes: cargo test --release --lib hold_the_level -- --ignored --nocapture"]
fn any_numbers_of_replicates_hold_the_level() {
    REPLICATES.level_is_held();
}

#[test]
#[ignore = "takes minutes: cargo test --release --lib hold_the_level -- --ignored --nocapture"]
fn errors_by_pixel_hold_the_level() {
    let numbers: [&[usize]; 2] = [&[4, 16, 64], &[4, 16, 64]];
    Table { title: "errors by pixel", side: with_errors, noises: &NOISES[..3], numbers, ..REPLICATES }.level_is_held();
}

/// How many of `runs` answers are `wanted`.
fn answered(runs: u64, wanted: Answer, compared: impl Fn(&mut CounterRng) -> Compared + Sync) -> usize {
    let is_wanted = |run: &u64| compared(&mut CounterRng::new(99, *run)).answer == wanted;
    (0..runs).into_par_iter().filter(is_wanted).count()
}

/// `n` images whose noise is an autoregressive sequence, so that neighbours have this correlation.
fn correlated(rng: &mut CounterRng, size: [usize; 2], n: usize, correlation: f32) -> Side {
    let fresh = |rng: &mut CounterRng| image(rng, NOISES[0], size).map(|p| p - Rgb::ONE);
    let mut noise = fresh(rng);
    let mut images = Vec::new();
    for _ in 0..n {
        let new = fresh(rng);
        let next = |x, y| correlation * noise.get(x, y) + (1.0 - correlation * correlation).sqrt() * new.get(x, y);
        noise = Image::from_fn(size[0], size[1], next);
        images.push(noise.map(|p| p + Rgb::splat(3.0)));
    }
    Side::replicates(images)
}

#[test]
#[ignore = "takes minutes: cargo test --release --lib compare::tests::levels -- --ignored --nocapture"]
fn dependent_replicates_are_called_so() {
    for n in [8, 16] {
        for correlation in [0.2, 0.5, 0.9] {
            let found = answered(100, Answer::NotIndependent, |rng| {
                let a = correlated(rng, SIZES[1], n, correlation);
                compare(a, replicates(rng, NOISES[0], SIZES[1], n), PLAN).unwrap()
            });
            println!("{n} images, correlation {correlation}: {found} of 100 not independent");
            assert!(found >= 90, "{n} images, correlation {correlation}: {found} of 100");
        }
    }
    // Images of unequal numbers of samples are independent.
    let found = answered(100, Answer::NotIndependent, |rng| {
        let expectation = texture(rng, SIZES[1]);
        let images = (0..8).map(|k| noisy(rng, &expectation, 1, [0.3, 0.6][k % 2]).remove(0)).collect();
        compare(Side::replicates(images), Side::replicates(noisy(rng, &expectation, 8, 0.1)), PLAN).unwrap()
    });
    println!("unequal numbers of samples: {found} of 100 not independent");
    assert!(found <= 1, "{found}");
    // Eight students: each has a factor of its own, within 5 % of 1.
    let found = answered(100, Answer::NotIndependent, |rng| {
        let expectation = texture(rng, SIZES[1]);
        let mut images = noisy(rng, &expectation, 8, 0.1);
        for image in &mut images {
            let factor = 0.95 + 0.1 * rng.random::<f32>();
            *image = image.map(|p| p * factor);
        }
        compare(Side::replicates(images), Side::replicates(noisy(rng, &expectation, 8, 0.1)), PLAN).unwrap()
    });
    println!("eight factors: {found} of 100 not independent");
    assert!(found >= 90, "{found}");
}

/// A texture of squares and waves, between 0.1 and 1.
fn texture(rng: &mut CounterRng, size: [usize; 2]) -> Image {
    let [frequency, phase, steps] = [0, 1, 2].map(|_| rng.random::<f32>());
    Image::from_fn(size[0], size[1], |x, y| {
        let wave = (x as f32 * (0.2 + 2.0 * frequency) + 3.0 * phase + y as f32 * steps).sin();
        let square = ((x / (1 + (6.0 * steps) as usize) + y / 3) % 2) as f32;
        Rgb::new(0.55 + 0.45 * wave, 0.1 + 0.9 * square, 0.3 + 0.2 * wave + 0.3 * square)
    })
}

/// `n` images of an expectation, with noise in proportion to it.
fn noisy(rng: &mut CounterRng, expectation: &Image, n: usize, strength: f32) -> Vec<Image> {
    let size = [expectation.width(), expectation.height()];
    let one = |rng: &mut CounterRng| {
        let noise = image(rng, NOISES[0], size);
        Image::from_fn(size[0], size[1], |x, y| expectation.get(x, y) * (1.0 + strength * (noise.get(x, y) - 1.0)))
    };
    (0..n).map(|_| one(rng)).collect()
}

#[test]
#[ignore = "takes minutes: cargo test --release --lib compare::tests::levels -- --ignored --nocapture"]
fn noise_of_images_declared_exact_is_seen() {
    let of = |rng: &mut CounterRng, n: usize, noise_of_b: f32, factor: f32| {
        let expectation = texture(rng, SIZES[1]);
        let a = noisy(rng, &expectation, n, 0.3).iter().map(|image| image.map(|p| p * factor)).collect();
        let b = noisy(rng, &expectation, 1, noise_of_b).remove(0);
        compare(Side::replicates(a), Side::exact(b), PLAN).unwrap()
    };
    for n in [2, 4, 16] {
        let count = |noise: f32, factor: f32| {
            let runs = (0..100_u64).into_par_iter().map(|run| of(&mut CounterRng::new(7, run), n, noise, factor));
            let runs: Vec<Compared> = runs.collect();
            let called_noisy = runs.iter().filter(|compared| compared.noise_of_exact.is_some()).count();
            [called_noisy, runs.iter().filter(|compared| compared.answer == Answer::Different).count()]
        };
        for (noise, factor) in [(0.0, 1.0), (0.0, 1.03), (0.3, 1.0), (0.15, 1.0), (0.3, 1.1)] {
            let [called_noisy, different] = count(noise, factor);
            println!(
                "{n} images, noise {noise} of B, A × {factor}: {called_noisy} noisy, {different} different of 100"
            );
            if noise == 0.0 {
                assert!(called_noisy <= 1);
            }
            if noise >= 0.15 {
                assert!(called_noisy >= 90);
            }
            if factor == 1.0 {
                assert!(different <= 4);
            }
        }
    }
}

/// A dark image with bright pixels, two of a hundred, that have nearly all of the noise.
fn bright_pixels(rng: &mut CounterRng, [width, height]: [usize; 2]) -> Image {
    Image::from_fn(width, height, |_, _| Rgb::splat(if rng.random::<f32>() < 0.02 { 50.0 } else { 0.1 }))
}

/// The texture, averaged over 5 × 5 pixels.
fn blurred(rng: &mut CounterRng, size: [usize; 2]) -> Image {
    let sharp = texture(rng, [size[0] + 4, size[1] + 4]);
    let near = |x: usize, y: usize| (0..25).map(move |i| (x + i % 5, y + i / 5));
    Image::from_fn(size[0], size[1], |x, y| near(x, y).map(|(x, y)| sharp.get(x, y)).sum::<Rgb>() / 25.0)
}

/// How many of `runs` comparisons with an image that is declared exact find noise, and how many are different.
fn against_one(runs: u64, make: fn(&mut CounterRng, [usize; 2]) -> Image, n: usize, noises: [f32; 2]) -> [usize; 2] {
    let compared = |run: u64| {
        let rng = &mut CounterRng::new(23, run);
        let expectation = make(rng, SIZES[0]);
        let a = noisy(rng, &expectation, n, noises[0]);
        let b = noisy(rng, &expectation, 1, noises[1]).remove(0);
        compare(Side::replicates(a), Side::exact(b), PLAN).unwrap()
    };
    let all: Vec<Compared> = (0..runs).into_par_iter().map(compared).collect();
    let count = |of: &dyn Fn(&Compared) -> bool| all.iter().filter(|compared| of(compared)).count();
    [count(&|compared| compared.noise_of_exact.is_some()), count(&|compared| compared.answer == Answer::Different)]
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn noise_in_few_pixels_of_an_exact_image_is_seen() {
    for n in [2, 4, 16] {
        for (name, make) in
            [("sharp", texture as fn(&mut _, _) -> _), ("blurred", blurred), ("bright pixels", bright_pixels)]
        {
            for noise in [0.0, 0.03, 0.15, 0.3] {
                let [found, different] = against_one(100, make, n, [0.3, noise]);
                println!("{name}, {n} images, noise {noise} of B: {found} noisy, {different} different of 100");
                // More than 3 of 100 at a level of 1 % have a probability of 2 %, at 0.1 % one of 10⁻⁶.
                assert!(found <= 1 || noise > 0.0, "{name}, {n}: {found}");
                assert!(different <= 4, "{name}, {n}, {noise}: {different}");
                assert!(found >= 90 || noise < 0.3, "{name}, {n}: {found}");
            }
        }
    }
}

#[test]
#[ignore = "takes minutes: cargo test --release --lib compare::tests::levels -- --ignored --nocapture"]
fn differences_in_fine_detail_are_not_hidden_by_noise() {
    // Half a pixel of shift against an exact image.
    let answers: Vec<Compared> = (0..100)
        .into_par_iter()
        .map(|run| {
            let rng = &mut CounterRng::new(5, run);
            let b = texture(rng, SIZES[1]);
            let right = |x: usize| (x + 1).min(b.width() - 1);
            let a = Image::from_fn(b.width(), b.height(), |x, y| 0.5 * (b.get(x, y) + b.get(right(x), y)));
            compare(Side::replicates(noisy(rng, &a, 16, 0.3)), Side::exact(b), PLAN).unwrap()
        })
        .collect();
    let count = |answer: Answer| answers.iter().filter(|compared| compared.answer == answer).count();
    let [different, fine, unknown] = [Answer::Different, Answer::NoDifferenceFound, Answer::CannotTell].map(count);
    println!("half a pixel of shift: {different} different, {unknown} cannot tell, {fine} no difference found of 100");
    assert!(fine <= 1, "{fine}");
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn the_numbers_named_find_the_bias_and_a_third_of_them_does_not() {
    const RUNS: u64 = 200;
    let plan = Plan { detect: 0.05, ..PLAN };
    // Grey noise: of three independent channels one finds it sooner.
    let side = |rng: &mut CounterRng, n: usize, expectation: f32| {
        let grey = |rng: &mut CounterRng| image(rng, NOISES[1], SIZES[0]).map(|p| Rgb::splat(expectation * p.x));
        Side::replicates((0..n).map(|_| grey(rng)).collect())
    };
    for n in [[2, 2], [3, 8], [4, 4], [16, 16]] {
        let found = |run: u64| {
            let rng = &mut CounterRng::new(11, run);
            let first = compare(side(rng, n[0], 1.0), side(rng, n[1], 1.0), plan).unwrap();
            let numbers = first.needed?.replicates.map(Option::unwrap);
            let mut is_found = |part: usize| {
                let [a, b] = numbers.map(|n| n.div_ceil(part).max(2));
                let [a, b] = [side(rng, a, 1.0 + plan.detect as f32), side(rng, b, 1.0)];
                compare(a, b, plan).unwrap().answer == Answer::Different
            };
            Some((numbers, [1, 3].map(&mut is_found)))
        };
        let mut runs: Vec<_> = (0..RUNS).into_par_iter().filter_map(found).collect();
        runs.sort_unstable();
        let [all, third] = [0, 1].map(|k| runs.iter().filter(|(_, found)| found[k]).count() as u64);
        println!("{n:?}: {all} of {}, by a third {third}; median {:?}", runs.len(), runs[runs.len() / 2].0);
        // As often as 90 % make it, except for one test of a thousand.
        let least = Binomial::new(0.9, runs.len() as u64).unwrap().inverse_cdf(0.001);
        assert!(runs.len() > 150 && all >= least && third < least, "{n:?}: {all} and {third} of {}", runs.len());
    }
}
