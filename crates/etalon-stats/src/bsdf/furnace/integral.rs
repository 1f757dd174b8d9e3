//! The integral of a BSDF's weights over two random numbers, from polynomials and what random points find of the differences.

use super::control::{LINES, LINES_TO_POLES, Piece, pieces};
use super::mapped::Mapped;
use super::{RISK, borders, most_points};
use crate::bounded::EmpiricalBernstein;
use crate::error::{Error, Result, poll};
use crate::extremes::Extremes;
use rand::RngExt;

/// Points at a time, so few that their samples stay in the cache.
const BATCH: usize = 1 << 10;
/// Random points that measure the error, after which it is stated as it is: of weights with a bound, and of others.
const POINTS: f64 = (1u32 << 22) as f64;
const UNBOUNDED_POINTS: f64 = (1u32 << 20) as f64;
/// The fewest and the most of them in one round: enough to meet rare large weights, few enough for the memory.
const FEWEST: f64 = (1u32 << 12) as f64;
const MOST: f64 = (1u32 << 18) as f64;
/// The share of the points that is distributed by area times the largest possible difference. The others are distributed by area times the
/// root mean square of the differences.
const BY_LARGEST_DIFFERENCE: f64 = 7.0 / 8.0;
/// Where no largest weight is declared, no distance between a weight and the polynomial of its rectangle is taken to be larger than this
/// many times the largest that was found there, and than this share of the largest weight there and of the mean weight.
const OVER_FOUND: f64 = 2.0;
const LEAST_DISTANCE: f64 = 1.0 / 8.0;

/// The weights of one channel, with the extremes of all channels.
pub struct Weights<'a> {
    mapped: &'a Mapped<'a>,
    channel: usize,
    /// The channels that had the same values everywhere.
    pub equal: [bool; 3],
    /// The smallest and the largest weight of any channel.
    pub extremes: [f64; 2],
}

impl<'a> Weights<'a> {
    /// The integrand of this channel.
    pub fn new(mapped: &'a Mapped<'a>, channel: usize) -> Self {
        Self { mapped, channel, equal: [true; 3], extremes: [0.0; 2] }
    }

    fn at(&mut self, points: &[[f64; 2]]) -> Result<Vec<f64>> {
        let mut values = Vec::with_capacity(points.len());
        for points in points.chunks(BATCH) {
            poll(self.mapped.subject.protocol.cancelled)?;
            for weight in self.mapped.weights(points)? {
                let value = weight[self.channel];
                (0..3).for_each(|other| self.equal[other] &= weight[other] == value);
                let [least, most] = self.extremes;
                self.extremes =
                    [weight.into_iter().fold(least, f64::at_most), weight.into_iter().fold(most, f64::at_least)];
                values.push(value);
            }
            // No number of points would make an integral of it.
            if self.not_finite().is_some() {
                return Err(Error::external("a weight is not finite"));
            }
        }
        Ok(values)
    }

    /// A weight that is NaN or infinite, if one was met.
    pub fn not_finite(&self) -> Option<f64> {
        self.extremes.into_iter().find(|weight| !weight.is_finite())
    }
}

/// The integral over the unit square of weights between 0 and `largest`, if that is known, and the bound of its error. If it is not, points are added
/// until a round has no difference that is larger than was assumed.
pub fn integral(weights: &mut Weights, largest: Option<f64>, error: f64) -> Result<[f64; 2]> {
    if largest == Some(0.0) {
        return Ok([0.0; 2]);
    }
    // A quarter more points than exact polynomials take, n = 1.25 b ln(2/r)/error for differences up to b, make the half width over the error
    // (0.8 + ψ(λ) q)/λ, where q is their mean square over b · error. It is 1 for q = 0.075 at the best rate, λ = 0.93. The mean square
    // is the square of the mean difference over 1 − BY_LARGEST_DIFFERENCE at most, and b is the largest weight over BY_LARGEST_DIFFERENCE.
    let allowed =
        (0.075 * error * largest.unwrap_or(1.0) * (1.0 - BY_LARGEST_DIFFERENCE) / BY_LARGEST_DIFFERENCE).sqrt();
    let (lines, most) = match largest {
        Some(_) => (&LINES[..], POINTS),
        None => (&LINES_TO_POLES[..], UNBOUNDED_POINTS),
    };
    let most = most_points(weights.mapped.subject, most);
    let pieces = pieces(lines, allowed, most, |points| weights.at(points))?;
    let polynomials: f64 = pieces.iter().map(|piece| piece.integral).sum();
    let mut strata: Vec<Stratum> = pieces.into_iter().map(Stratum::new).collect();
    // A black surface has no weights to compare with.
    let mean_weight = polynomials.at_least(error);
    let mut mean = EmpiricalBernstein::default();
    let (mut result, mut used) = ([polynomials, f64::INFINITY], 0.0);
    for round in 0.. {
        let exceeded = largest.is_none() && round > 0 && strata.iter().any(Stratum::exceeds);
        if (result[1] <= error && !exceeded) || used >= most || !result[0].is_finite() {
            break;
        }
        // The bound of the rounds before rests on a wrong assumption.
        if exceeded {
            mean = EmpiricalBernstein::default();
        }
        strata.iter_mut().for_each(|stratum| stratum.bound(largest, mean_weight));
        let shares = shares(&strata);
        // What is expected of the next points: the largest difference and the mean square.
        let square = |(stratum, share): (&Stratum, &f64)| (stratum.distance() * stratum.area()).powi(2) / share;
        let square: f64 = strata.iter().zip(&shares).map(square).sum();
        let expected = |n: f64, scale: f64| mean.expect(n, scale, square, RISK);
        // As many points as suffice then. The first eighth of them measures the distances.
        let (mut points, scale) = (FEWEST, scale(&strata, &shares));
        while points < MOST && expected(points, scale)[1] > 0.97 * error {
            points *= 1.1;
        }
        if round == 0 {
            points = (points / 8.0).at_least(FEWEST);
        }
        let counts: Vec<f64> = shares.iter().map(|share| (share * points).ceil()).collect();
        let total: f64 = counts.iter().sum();
        let shares: Vec<f64> = counts.iter().map(|count| count / total).collect();
        let scale = self::scale(&strata, &shares);
        let [rate, _] = expected(total, scale);
        let sums = differences(weights, &mut strata, &counts, total, round)?;
        mean.add(rate, scale, total, sums);
        let [difference, bound] = mean.interval(RISK);
        (result, used) = ([polynomials + difference, bound], used + total);
    }
    Ok(result)
}

/// What the rounding of the two random numbers may change of the integral. Next to a border of the square, within the precision ε, a weight
/// that grows as the inverse root of the distance has the integral 2 ε w(ε), and a random number that is rounded to 0 or to the last one
/// below 1 may have a weight of its own.
pub fn unresolved(weights: &mut Weights) -> Result<f64> {
    const ALONG: usize = 64;
    let precision = weights.mapped.subject.properties.precision;
    let along = |at: f64| (0..ALONG).map(|i| (i as f64 + 0.5) / ALONG as f64).flat_map(move |x| [[at, x], [x, at]]);
    let places: Vec<[f64; 2]> = borders(precision).into_iter().flat_map(along).collect();
    Ok(precision * weights.at(&places)?.iter().sum::<f64>() / ALONG as f64)
}

/// The sum of the differences between weights and polynomials at random points, n in each stratum, as estimates of the whole square's,
/// and the sum of their squares.
fn differences(
    weights: &mut Weights,
    strata: &mut [Stratum],
    counts: &[f64],
    total: f64,
    round: u64,
) -> Result<[f64; 2]> {
    let mut rng = weights.mapped.subject.random(0x11, round);
    let numbers = || counts.iter().enumerate().flat_map(|(number, &count)| std::iter::repeat_n(number, count as usize));
    let local: Vec<[f64; 2]> = numbers().map(|_| [0; 2].map(|_| 2.0 * rng.random::<f64>() - 1.0)).collect();
    let places: Vec<[f64; 2]> = numbers().zip(&local).map(|(number, at)| strata[number].piece.at.place(*at)).collect();
    let mut sums = [0.0; 2];
    for ((number, at), value) in numbers().zip(local).zip(weights.at(&places)?) {
        let stratum = &mut strata[number];
        let difference = value - stratum.piece.value(at);
        stratum.piece.most = stratum.piece.most.at_least(value);
        stratum.most = stratum.most.at_least(difference.abs());
        (stratum.squares, stratum.count) = (stratum.squares + difference * difference, stratum.count + 1.0);
        // A point stands for its stratum's area over its share of the points.
        let weighted = difference * stratum.area() * total / counts[number];
        sums = [sums[0] + weighted, sums[1] + weighted * weighted];
    }
    Ok(sums)
}

/// A rectangle with what is known of the distances between the weights and its polynomial.
struct Stratum {
    piece: Piece,
    /// No distance is taken to be larger.
    largest_difference: f64,
    /// The largest that was found.
    most: f64,
    /// Sum of the squares of the distances that were measured.
    squares: f64,
    count: f64,
}

impl Stratum {
    fn new(piece: Piece) -> Self {
        Self { piece, largest_difference: 0.0, most: 0.0, squares: 0.0, count: 0.0 }
    }

    /// Bounds the distances of weights between 0 and `largest`, or says what they are taken to be at most if the mean weight is about `mean`.
    fn bound(&mut self, largest: Option<f64>, mean: f64) {
        let [low, high] = self.piece.range();
        self.largest_difference = match largest {
            Some(largest) => high.at_least(largest - low),
            None => (OVER_FOUND * self.most).at_least(LEAST_DISTANCE * self.piece.most.at_least(mean)),
        };
    }

    /// Whether a distance is larger than it was taken to be.
    fn exceeds(&self) -> bool {
        self.most > self.largest_difference
    }

    fn area(&self) -> f64 {
        self.piece.at.area()
    }

    /// The root mean square of the distances: as it was estimated, which counts as one point, and measured.
    fn distance(&self) -> f64 {
        ((self.piece.distance.powi(2) + self.squares) / (1.0 + self.count)).sqrt()
    }
}

/// The largest difference, as an estimate of the whole square's, of points with these shares in the strata.
fn scale(strata: &[Stratum], shares: &[f64]) -> f64 {
    strata
        .iter()
        .zip(shares)
        .map(|(stratum, share)| stratum.largest_difference * stratum.area() / share)
        .fold(0.0, f64::at_least)
}

/// The shares of the points that strata have.
fn shares(strata: &[Stratum]) -> Vec<f64> {
    let hidden: f64 = strata.iter().map(|stratum| stratum.area() * stratum.largest_difference).sum();
    let missed: f64 = strata.iter().map(|stratum| stratum.area() * stratum.distance()).sum();
    let share = |stratum: &Stratum| {
        let hidden = stratum.largest_difference / hidden;
        let missed = if missed > 0.0 { stratum.distance() / missed } else { hidden };
        stratum.area() * (BY_LARGEST_DIFFERENCE * hidden + (1.0 - BY_LARGEST_DIFFERENCE) * missed)
    };
    strata.iter().map(share).collect()
}
