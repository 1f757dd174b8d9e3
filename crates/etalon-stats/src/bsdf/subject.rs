//! A BSDF for one `wo` under a protocol: what every check starts from, and how exact checks compare numbers.

use super::contract::{Bsdf, BsdfSample, DeltaLobe, Direction, Properties, Spectrum};
use super::vector::{place, same_side, sphere};
use crate::domain::Domain;
use crate::examine::Protocol;
use crate::outcome::Outcome;
use crate::stream::CounterRng;
use crate::text::count;
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
    pub bsdf: &'a dyn Bsdf,
    pub properties: Properties,
    pub wo: Direction,
    pub deltas: Vec<DeltaLobe>,
    pub protocol: &'a Protocol,
    pub round: u64,
}

impl<'a> Subject<'a> {
    pub fn new(bsdf: &'a dyn Bsdf, wo: Direction, protocol: &'a Protocol, round: u64) -> Self {
        Self { bsdf, properties: bsdf.properties(), wo, deltas: bsdf.delta_lobes(wo), protocol, round }
    }

    /// A generator of random numbers of its own for each purpose of each check.
    pub fn random(&self, purpose: u64, batch: u64) -> CounterRng {
        CounterRng::new(self.protocol.seed, (batch << 16) | (purpose << 8) | 0x80 | self.round)
    }

    /// f(wo, wi) of a deterministic BSDF.
    pub fn eval(&self, wi: Direction) -> Spectrum {
        self.bsdf.eval(self.wo, wi, &[])
    }

    /// Whether values are deterministic.
    pub fn is_deterministic(&self) -> bool {
        self.properties.eval_dimension == 0
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

    /// Random numbers and samples: at all pairs of edges, then at random.
    pub fn samples(&self) -> Vec<(Vec<f64>, BsdfSample)> {
        let dimension = self.properties.dimension;
        let mut rng = self.random(0, 0);
        let edges = (0..EDGES.len().pow(2)).map(|i| {
            (0..dimension).map(|d| EDGES[if d % 2 == 0 { i % EDGES.len() } else { i / EDGES.len() }]).collect()
        });
        let random = (0..SAMPLES).map(|_| (0..dimension).map(|_| rng.random::<f64>()).collect::<Vec<f64>>());
        let all = edges.chain(random).collect::<Vec<_>>().into_iter();
        all.filter_map(|u| Some((self.bsdf.sample(self.wo, &u)?, u))).map(|(sample, u)| (u, sample)).collect()
    }

    /// Directions that do not come from the sampler: a spiral over the sphere, the poles, and directions along the surface.
    pub fn directions(&self) -> Vec<Direction> {
        let spiral = |i: usize| {
            sphere().point_at([(i as f64 + 0.5) / DIRECTIONS as f64, (i as f64 * 0.618_033_988_749_895).fract()])
        };
        let [x, y, z] = self.wo;
        let special = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], self.wo, [-x, -y, -z], [-x, -y, z], [x, y, -z]];
        let along = [[1.0, 0.0, 0.0], [0.6, -0.8, 0.0], [0.6, 0.8, -0.0], [1.0, 0.0, 1e-20], [0.0, 1.0, -1e-20]];
        (0..DIRECTIONS).map(spiral).chain(special).chain(along).collect()
    }

    /// What rounding may change of `f`, the value of `function` at two directions: a few last places, and the change from
    /// moving each coordinate of both directions by a few last places, which is what the roundings of a computation do at most
    /// if it is backward stable.
    pub fn rounding(&self, f: f64, [a, b]: [Direction; 2], function: impl Fn(Direction, Direction) -> f64) -> f64 {
        let step = MOVED * self.properties.precision;
        let moved = |w: Direction, axis: usize, step: f64| {
            let mut w = w;
            w[axis] *= 1.0 + step;
            w
        };
        let change = |other: f64| if other.is_finite() { (other - f).abs() } else { 0.0 };
        let along = |axis: usize| {
            let of_a = [step, -step].map(|step| change(function(moved(a, axis, step), b)));
            let of_b = [step, -step].map(|step| change(function(a, moved(b, axis, step))));
            of_a[0].max(of_a[1]) + of_b[0].max(of_b[1])
        };
        self.last_places(f) + (0..3).map(along).sum::<f64>()
    }

    /// A few last places of `f`.
    pub fn last_places(&self, f: f64) -> f64 {
        PLACES * self.properties.precision * f.abs() + TINY
    }

    /// The beginning of every message on two directions.
    pub fn at(&self, wi: Direction) -> String {
        format!("wo {}, wi {}", place(self.wo), place(wi))
    }
}

/// The share of comparisons in which an error of the stated size would have been found.
const FOUND: f64 = 0.9;

/// Numbers that an exact check compared.
#[derive(Debug, Default)]
pub struct Comparison {
    compared: u64,
    failed: u64,
    /// The relative differences that were tolerated.
    tolerated: Vec<f64>,
    /// By how many times the tolerance the worst failure missed, and what it is.
    worst: Option<(f64, String)>,
}

impl Comparison {
    /// Compares `found` with `expected`. `tolerance` is asked only where they differ by more than `quick`.
    pub fn equal(
        &mut self,
        [found, expected]: [f64; 2],
        quick: f64,
        tolerance: impl FnOnce() -> f64,
        message: impl FnOnce() -> String,
    ) {
        self.compared += 1;
        let (difference, scale) = ((found - expected).abs(), found.abs().max(expected.abs()));
        let tolerance = if difference <= quick { quick } else { tolerance().max(quick) };
        // Numbers near 0 have no relative error.
        if scale > TINY.sqrt() {
            self.tolerated.push((tolerance / scale).min(1.0));
        }
        if difference.is_nan() || difference > tolerance {
            self.fail(difference / tolerance, || format!("{}: {found:.6e} and {expected:.6e}", message()));
        }
    }

    /// States something that must hold.
    pub fn holds(&mut self, holds: bool, message: impl FnOnce() -> String) {
        self.compared += 1;
        if !holds {
            self.fail(f64::INFINITY, message);
        }
    }

    fn fail(&mut self, excess: f64, message: impl FnOnce() -> String) {
        self.failed += 1;
        if self.worst.as_ref().is_none_or(|(worst, _)| excess > *worst || worst.is_nan()) {
            self.worst = Some((excess, message()));
        }
    }

    /// The outcome; `None` if there was nothing to compare. `law` is what the numbers should obey.
    pub fn outcome(mut self, law: &str) -> Option<Outcome> {
        self.tolerated.sort_by(f64::total_cmp);
        let detectable = self.tolerated.get((FOUND * self.tolerated.len() as f64) as usize).copied().unwrap_or(0.0);
        let Self { compared, failed, worst, .. } = self;
        let message = |(_, worst): (f64, String)| {
            let times = count(compared, "comparison", "comparisons");
            format!("{law} fails in {failed} of {times}, most at {worst}")
        };
        let violation = worst.map(message);
        (compared > 0).then(|| Outcome { detectable: Some(detectable), violation, ..Outcome::open(compared) })
    }
}
