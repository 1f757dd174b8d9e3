//! A BSDF for one `wo` under a protocol: what every check starts from, and how exact checks compare numbers; vectors of three
//! numbers.

use super::contract::{
    BatchBsdf, BsdfSample, DeltaLobe, Density, Direction, Energy, Kind, Pair, PdfKind, Properties, Spectrum,
};
use super::places::survey;
use crate::diagnosis::{count, different};
use crate::domain::{Directions, Domain, Point, Pole};
use crate::error::Result;
use crate::exact::{AS_SINGLE, ordinary, percent, relative_difference};
use crate::examine::Protocol;
use crate::extremes::Extremes;
use crate::mistakes::{EQUAL, number};
use crate::named_mistake::NamedMistake;
use crate::outcome::{Compared, Outcome};
use crate::sampler::SINGLE_PRECISION;
use crate::stream::CounterRng;
use rand::RngExt;

/// Samples that exact checks look at, besides those at the edges of the unit cube.
const SAMPLES: usize = 1 << 10;
/// Directions, independent of the samples, that exact checks look at.
const DIRECTIONS: usize = 1 << 8;
/// Random numbers at which implementations fail.
const EDGES: [f64; 6] = [0.0, 1e-30, 1e-7, 0.5, 0.999, 1.0 - 1.0 / (1u64 << 24) as f64];
/// Units of the last place within which two ways to compute one number agree.
const PLACES: f64 = 64.0;
/// Last places by which coordinates are moved to find out what rounding may change: about as many as there are roundings between
/// the directions and a value.
const MOVED: f64 = 16.0;
/// Numbers below this are 0 to every check: single precision has lost their last places.
const TINY: f64 = 1e-30;

/// A BSDF for one `wo`.
pub struct Subject<'a> {
    pub bsdf: &'a dyn BatchBsdf,
    pub properties: Properties,
    pub wo: Direction,
    pub deltas: Vec<DeltaLobe>,
    pub protocol: &'a Protocol,
    pub round: u64,
}

impl<'a> Subject<'a> {
    pub fn new(bsdf: &'a dyn BatchBsdf, wo: Direction, protocol: &'a Protocol, round: u64) -> Result<Self> {
        let deltas = bsdf.delta_lobes(&[wo])?.swap_remove(0);
        let properties = bsdf.properties();
        Ok(Self { bsdf, properties, wo, deltas, protocol, round })
    }

    /// Whether this is a light that is not sampled from here.
    pub fn is_dark(&self) -> Result<bool> {
        Ok(self.is_light() && self.samples_inside()?.is_empty())
    }

    pub fn is_light(&self) -> bool {
        matches!(self.properties.kind, Kind::Light { .. })
    }

    /// A generator of random numbers of its own for each purpose of each check.
    pub fn random(&self, purpose: u64, batch: u64) -> CounterRng {
        CounterRng::new(self.protocol.seed, (batch << 16) | (purpose << 8) | 0x80 | self.round)
    }

    /// `wo` with each of `wis`.
    pub fn pairs(&self, wis: &[Direction]) -> Vec<Pair> {
        wis.iter().map(|&wi| [self.wo, wi]).collect()
    }

    /// A sample for each [`dimension`](Properties::dimension) numbers of `u`, which keep off the edges of a light: rays to its very edge may miss it.
    pub fn sample(&self, u: &[f64]) -> Result<Vec<Option<BsdfSample>>> {
        if self.is_light() {
            let edge = self.properties.precision.sqrt();
            return self.sample_at(&u.iter().map(|u| edge + (1.0 - 2.0 * edge) * u).collect::<Vec<f64>>());
        }
        self.sample_at(u)
    }

    fn sample_at(&self, u: &[f64]) -> Result<Vec<Option<BsdfSample>>> {
        self.bsdf.sample(&vec![self.wo; u.len() / self.properties.dimension.max(1)], u)
    }

    /// Whether values are deterministic.
    pub fn is_deterministic(&self) -> bool {
        self.properties.eval_dimension == 0
    }

    /// Whether what is sampled tells all of the weights of a phase function: they are values over pdfs by the check `formula`, samples follow the
    /// pdf by `sampling`, and their mean weight is that of all light by `mean-cosine`.
    pub fn has_known_weights(&self) -> Result<bool> {
        let Properties { kind, pdf, energy, .. } = &self.properties;
        let is_known = matches!((kind, pdf, energy), (Kind::Phase { .. }, PdfKind::Exact, Energy::Conserved(_)));
        let carries = |(_, sample): &(_, BsdfSample)| matches!(sample.density, Density::Pdf(_));
        Ok(is_known && self.is_deterministic() && self.samples()?.iter().all(carries))
    }

    /// The square of the index of refraction on the side of `wi` over that on the side of `wo`.
    pub fn eta2(&self, wi: Direction) -> f64 {
        let eta = self.properties.eta;
        match (same_side(self.wo, wi), self.wo[2] > 0.0) {
            (true, _) => 1.0,
            (false, true) => eta * eta,
            (false, false) => 1.0 / (eta * eta),
        }
    }

    /// The weight of a sample as power, that is times η²; NaN where its direction or its density is not finite, so that no sum
    /// of weights passes over that.
    pub fn power(&self, sample: &BsdfSample) -> Spectrum {
        let density = match sample.density {
            Density::Delta(probability) => probability,
            Density::Pdf(pdf) => pdf,
            Density::Unknown => 0.0,
        };
        let is_finite = sample.wi.iter().chain([&density]).all(|number| number.is_finite());
        let factor = if is_finite { self.eta2(sample.wi) } else { f64::NAN };
        sample.weight.map(|weight| weight * factor)
    }

    /// Random numbers and samples: at random, then at all pairs of edges, so that the first one in which something fails is an ordinary one.
    pub fn samples(&self) -> Result<Vec<(Vec<f64>, BsdfSample)>> {
        let dimension = self.properties.dimension;
        let mut rng = self.random(0, 0);
        let edges = (0..EDGES.len().pow(2)).flat_map(|i| {
            (0..dimension).map(move |d| EDGES[if d % 2 == 0 { i % EDGES.len() } else { i / EDGES.len() }])
        });
        let random = (0..SAMPLES * dimension).map(|_| rng.random::<f64>());
        let u: Vec<f64> = random.chain(edges).collect();
        let samples = self.sample_at(&u)?.into_iter().zip(u.chunks_exact(dimension.max(1)));
        Ok(samples.filter_map(|(sample, u)| Some((u.to_vec(), sample?))).collect())
    }

    /// The same, without those at the edges of a light.
    pub fn samples_inside(&self) -> Result<Vec<(Vec<f64>, BsdfSample)>> {
        if !self.is_light() {
            return self.samples();
        }
        let (dimension, mut rng) = (self.properties.dimension, self.random(0, 0));
        let u: Vec<f64> = (0..SAMPLES * dimension).map(|_| rng.random::<f64>()).collect();
        let samples = self.sample(&u)?.into_iter().zip(u.chunks_exact(dimension));
        Ok(samples.filter_map(|(sample, u)| Some((u.to_vec(), sample?))).collect())
    }

    /// Directions that do not come from the sampler: a spiral over the sphere, the poles, and directions along the surface; of a light to
    /// points of it.
    pub fn directions(&self) -> Result<Vec<Direction>> {
        let spiral = |i: usize| {
            sphere().direction_at([(i as f64 + 0.5) / DIRECTIONS as f64, (i as f64 * 0.618_033_988_749_895).fract()])
        };
        if self.is_light() {
            let to = |(point, _): &([f64; 3], _)| {
                let to = [0, 1, 2].map(|i| point[i] - self.wo[i]);
                to.map(|x| x / length(to))
            };
            return Ok((0..DIRECTIONS).map(spiral).chain(survey(self.bsdf)?.iter().map(to)).collect());
        }
        let [x, y, z] = self.wo;
        let special = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], self.wo, [-x, -y, -z], [-x, -y, z], [x, y, -z]];
        let along = [[1.0, 0.0, 0.0], [0.6, -0.8, 0.0], [0.6, 0.8, -0.0], [1.0, 0.0, 1e-20], [0.0, 1.0, -1e-20]];
        Ok((0..DIRECTIONS).map(spiral).chain(special).chain(along).collect())
    }

    /// What rounding may change of each of `f`, the values of `function` at two directions: a few last places, and the change
    /// from moving each coordinate of both directions by a few last places, which is what the roundings of a computation do at
    /// most if it is backward stable.
    pub fn rounding(
        &self,
        f: &[f64],
        pairs: &[Pair],
        function: impl FnOnce(&[Pair]) -> Result<Vec<f64>>,
    ) -> Result<Vec<f64>> {
        let step = MOVED * self.properties.precision;
        // Along each coordinate, both directions forwards and backwards.
        let moves = (0..3).flat_map(|axis| [(0, axis, step), (0, axis, -step), (1, axis, step), (1, axis, -step)]);
        let moves: Vec<(usize, usize, f64)> = moves.collect();
        let moved = |(pair, (which, axis, step)): (&Pair, &(usize, usize, f64))| {
            let mut pair = *pair;
            pair[*which][*axis] *= 1.0 + step;
            pair
        };
        let all: Vec<Pair> = pairs.iter().flat_map(|pair| moves.iter().map(move |at| moved((pair, at)))).collect();
        let values = function(&all)?;
        let of = |(&f, values): (&f64, &[f64])| {
            let change = |other: &f64| if other.is_finite() { (other - f).abs() } else { 0.0 };
            let largest = |both: &[f64]| both.iter().map(change).fold(0.0, f64::at_least);
            let along = |axis: &[f64]| largest(&axis[..2]) + largest(&axis[2..]);
            self.last_places(f) + values.chunks_exact(4).map(along).sum::<f64>()
        };
        Ok(f.iter().zip(values.chunks_exact(moves.len())).map(of).collect())
    }

    /// A few last places of `f`.
    pub fn last_places(&self, f: f64) -> f64 {
        PLACES * self.properties.precision * f.abs() + TINY
    }

    /// A message on a sample whose weight contradicts the declared bound: the mean over lobes is at least what its lobe adds.
    pub fn above_bound(&self, sample: &BsdfSample) -> Option<String> {
        let bound = self.properties.largest_weight.filter(|_| !sample.is_delta())?;
        let weight = sample.weight[..self.properties.channels].iter().copied().fold(0.0, f64::at_least);
        let found = sample.lobe_probability * weight * self.eta2(sample.wi);
        (found > bound + self.last_places(bound))
            .then(|| format!("{}: a weight of {found}, above the declared bound {bound}", self.at(sample.wi)))
    }

    /// The names of the delta lobes.
    pub fn delta_names(&self) -> Vec<String> {
        let side = |wi| if same_side(self.wo, wi) { "reflection" } else { "transmission" };
        let name = |(i, lobe): (usize, &DeltaLobe)| format!("delta lobe {i} ({})", side(lobe.wi));
        self.deltas.iter().enumerate().map(name).collect()
    }

    /// ", channel 1" in messages, where there are several.
    pub fn channel(&self, channel: usize) -> String {
        if self.properties.channels > 1 { format!(", channel {channel}") } else { String::new() }
    }

    /// The beginning of every message on two directions.
    pub fn at(&self, wi: Direction) -> String {
        format!("{}, wi {}", self.from(), place(wi))
    }

    /// For which `wo`, or from which point.
    pub fn from(&self) -> String {
        let [x, y, z] = self.wo;
        if self.is_light() { format!("from ({x:.4}, {y:.4}, {z:.4})") } else { format!("wo {}", place(self.wo)) }
    }

    /// Pairs with light that goes the other way.
    pub fn swapped(&self, pairs: &[Pair]) -> Vec<Pair> {
        let sign = if matches!(self.properties.kind, Kind::Phase { wo_points_away: false, .. }) { -1.0 } else { 1.0 };
        pairs.iter().map(|&[wo, wi]| [wi, wo].map(|w| w.map(|x| sign * x))).collect()
    }
}

/// One channel of spectra.
pub fn channel_of(values: &[Spectrum], channel: usize) -> Vec<f64> {
    values.iter().map(|value| value[channel]).collect()
}

/// The share of comparisons in which an error of the stated size would have been found.
const FOUND: f64 = 0.9;

/// Two numbers that should be equal.
#[derive(Debug)]
struct Different {
    wi: Option<Direction>,
    /// What was found and what is expected.
    numbers: [f64; 2],
    /// Where, and what they are.
    message: String,
}

impl Different {
    fn ratio(&self) -> f64 {
        self.numbers[0] / self.numbers[1]
    }
}

/// Numbers that an exact check compared.
#[derive(Debug, Default)]
pub struct Comparison {
    compared: u64,
    /// Rules that do not hold.
    failed: u64,
    /// The relative differences that were tolerated.
    tolerated: Vec<f64>,
    /// The numbers that differ by more.
    different: Vec<Different>,
    /// The first rule that does not hold, in words.
    broken: Option<String>,
    /// How many of what was compared are numbers.
    numbers: u64,
    /// The usual mistakes that explain all, each with the channels in which they do, where those were compared by themselves.
    mistakes: Vec<(NamedMistake, Vec<usize>)>,
    /// The channels whose differences no mistake explains.
    unexplained: Vec<usize>,
    /// The channels that were compared, where a mistake may be that of one.
    channels: usize,
}

impl Comparison {
    /// Compares what was found with what is expected in each entry of `numbers`, of which `quick` tells a tolerance. For the
    /// entries that differ by more, `tolerances` is asked once for others. `message` has the `wi` of an entry, if it has one, and words on it.
    /// Returns whether all are equal.
    pub fn equal(
        &mut self,
        numbers: &[[f64; 2]],
        quick: impl Fn(usize) -> f64,
        tolerances: impl FnOnce(&[usize]) -> Result<Vec<f64>>,
        message: impl Fn(usize) -> (Option<Direction>, String),
    ) -> Result<bool> {
        self.compared += numbers.len() as u64;
        self.numbers += numbers.len() as u64;
        let difference = |i: usize| (numbers[i][0] - numbers[i][1]).abs();
        let mut tolerated: Vec<f64> = (0..numbers.len()).map(quick).collect();
        let is_close = |i: &usize| difference(*i) <= tolerated[*i];
        let far: Vec<usize> = (0..numbers.len()).filter(|i| !is_close(i)).collect();
        let mut failed = false;
        if !far.is_empty() {
            for (&i, tolerance) in far.iter().zip(tolerances(&far)?) {
                tolerated[i] = tolerance.at_least(tolerated[i]);
                let difference = difference(i);
                if difference.is_nan() || difference > tolerated[i] {
                    failed = true;
                    let (wi, message) = message(i);
                    self.different.push(Different { wi, numbers: numbers[i], message });
                }
            }
        }
        for (tolerance, [found, expected]) in tolerated.into_iter().zip(numbers) {
            // Numbers near 0 have no relative error.
            let scale = found.abs().at_least(expected.abs());
            if scale > TINY.sqrt() {
                self.tolerated.push((tolerance / scale).at_most(1.0));
            }
        }
        Ok(!failed)
    }

    /// Compares as [`equal`](Self::equal), by one tolerance only.
    pub fn near(
        &mut self,
        numbers: &[[f64; 2]],
        quick: impl Fn(usize) -> f64,
        message: impl Fn(usize) -> (Option<Direction>, String),
    ) -> Result<bool> {
        self.equal(numbers, quick, |far| Ok(vec![0.0; far.len()]), message)
    }

    /// The usual mistake that explains what was just compared, if one does.
    pub fn named(&mut self, mistake: Option<impl Into<NamedMistake>>) {
        let mistake = mistake.map(Into::into);
        let is_new = |mistake: &NamedMistake| self.mistakes.iter().all(|(known, _)| known != mistake);
        self.mistakes.extend(mistake.filter(is_new).map(|mistake| (mistake, Vec::new())));
    }

    /// The usual mistake that explains what was found to differ in one of several channels.
    pub fn named_in(&mut self, [channel, channels]: [usize; 2], mistake: Option<NamedMistake>) {
        self.channels = self.channels.max(channels);
        let Some(mistake) = mistake else { return self.unexplained.push(channel) };
        for (known, channels) in &mut self.mistakes {
            if let Some(common) = known.common(&mistake) {
                *known = common;
                return channels.push(channel);
            }
        }
        self.mistakes.push((mistake, vec![channel]));
    }

    /// The mistakes, with their channels where others do not have them.
    fn told(&self) -> Option<NamedMistake> {
        let list = |channels: &[usize]| channels.iter().map(ToString::to_string).collect::<Vec<_>>().join(" and ");
        let told = |(mistake, of): &(NamedMistake, Vec<usize>)| {
            let is_of_all = of.is_empty() || of.len() >= self.channels;
            if is_of_all { mistake.clone() } else { mistake.clone().with_suffix(&format!(", in channel {}", list(of))) }
        };
        let others = (self.channels > 1 && !self.unexplained.is_empty())
            .then(|| NamedMistake::from(format!("other differences in channel {}", list(&self.unexplained))));
        let all = self.mistakes.iter().map(told).chain(others.filter(|_| !self.mistakes.is_empty()));
        NamedMistake::joined(all.collect())
    }

    /// States something that must hold for all of `compared` cases, and does not for `failed` of them.
    pub fn all_hold(&mut self, [compared, failed]: [u64; 2], message: impl FnOnce() -> String) {
        self.compared += compared;
        self.failed += failed;
        if failed > 0 {
            self.broken.get_or_insert_with(message);
        }
    }

    /// States something that must hold.
    pub fn holds(&mut self, holds: bool, message: impl FnOnce() -> String) {
        self.all_hold([1, u64::from(!holds)], message);
    }

    /// The outcome; `None` if there was nothing to compare. `law` is what the numbers should obey.
    pub fn outcome(mut self, law: &str) -> Option<Outcome> {
        self.tolerated.sort_by(f64::total_cmp);
        let detectable = self.tolerated.get((FOUND * self.tolerated.len() as f64) as usize).copied().unwrap_or(0.0);
        let mistake = self.told();
        let fails = |failed: u64, compared: u64| {
            format!("{law} fails in {failed} of {}", count(compared, "comparison", "comparisons"))
        };
        let failed = self.failed + self.different.len() as u64;
        let broken = self.broken.as_ref().map(|broken| format!("{}, as at {broken}", fails(failed, self.compared)));
        let violation = broken.or_else(|| {
            Some(format!("{}, as at {}", fails(self.different.len() as u64, self.numbers), self.ordinary()?))
        });
        let places = self.different.iter().filter_map(|different| Some((different.wi?.into(), different.numbers)));
        let compared = Some(places.collect::<Vec<_>>()).filter(|places| !places.is_empty());
        let compared = compared.map(|places| Compared { law: law.to_owned(), places });
        let all = self.compared;
        (all > 0).then_some(Outcome {
            detectable: Some(detectable),
            violation,
            mistake,
            compared,
            ..Outcome::open(all)
        })
    }

    /// The ordinary one of the numbers that differ, in words, and how far all are apart.
    fn ordinary(&self) -> Option<String> {
        let Different { numbers: [found, expected], message, .. } =
            &self.different[ordinary(self.different.iter().map(Different::ratio))?];
        let difference = |different: &Different| relative_difference(different.numbers[0], different.numbers[1]);
        let largest = self.different.iter().map(difference).fold(0.0, f64::at_least);
        let both = different(*found, *expected);
        let ratios = self.different.iter().map(Different::ratio).filter(|ratio| ratio.is_finite());
        let [least, most] =
            ratios.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], r| [least.at_most(r), most.at_least(r)]);
        let size = if largest <= SMALL {
            let hint = if largest <= SINGLE_PRECISION { AS_SINGLE } else { "" };
            let own = percent(relative_difference(*found, *expected));
            format!("a difference of {own} of the larger; the largest is {}{hint}", percent(largest))
        } else if !(found / expected).is_finite() {
            "where nothing is expected".to_owned()
        } else if most - least <= EQUAL * most.abs() {
            format!("{} times", number(found / expected))
        } else {
            format!("{} times; ratios are from {} to {}", short(found / expected), short(least), short(most))
        };
        Some(format!("{message}: {} and {}, {size}", both[0], both[1]))
    }
}

/// Larger differences are told as ratios.
const SMALL: f64 = 0.01;

/// Three digits of a number.
fn short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e4).contains(&x.abs()) {
        format!("{x:.2e}").parse().unwrap_or(x).to_string()
    } else {
        format!("{x:.2e}")
    }
}

/// The sphere of all directions, with the chart in which cells are rectangles.
pub fn sphere() -> Directions {
    Directions::sphere(Pole::Z)
}

/// Points of the sphere as directions.
pub fn directions(points: &[Point]) -> Vec<Direction> {
    points.iter().map(|point| Direction::from(*point)).collect()
}

pub fn dot(a: Direction, b: Direction) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Direction, b: Direction) -> Direction {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn length(a: Direction) -> f64 {
    dot(a, a).sqrt()
}

/// Whether both are on one side of the surface.
pub fn same_side(a: Direction, b: Direction) -> bool {
    a[2] * b[2] > 0.0
}

/// A direction by its angles in degrees, as messages name it.
pub fn place(w: Direction) -> String {
    let Some([below, turns]) = sphere().to_chart(w.into()) else { return format!("({}, {}, {})", w[0], w[1], w[2]) };
    let theta = 2.0 * below.sqrt().asin().to_degrees();
    format!("({theta:.4}°, {:.2}°)", 360.0 * turns)
}
