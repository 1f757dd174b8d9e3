//! Mistakes in what random numbers are mapped by: warps to a hemisphere, the numbers themselves (their bits, their ends, their
//! order), and tables. Counts in 200 cells hardly show those of the numbers.

use super::super::case::{DirectionSampler, direction_density, direction_sampler};
use super::fault::PlantedFault;
use etalon_core::math::circular::sin_cos_turns;
use etalon_core::sampling::warp;
use etalon_stats::stream::CounterRng;
use etalon_stats::{
    Barycentric, Circle, Density, DensityFn, Directions, Discrete, Disk, HalfLine, Indexed, Line, Mass, Plane, Point,
    Pole, RealLine, Rectangle, Sample, Sampler, Simplex, ball, chart, cuboid, density, rotations, sampler, simplex,
    space, target,
};
use glam::DVec3;
use rand::RngExt;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// The unit vector at that cosine with +z and that azimuth in turns.
pub fn polar(cos: f64, turns: f64) -> DVec3 {
    let (sin_phi, cos_phi) = sin_cos_turns(turns);
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

const N: f64 = 20.0;

/// The direction of a lobe cosⁿ around `axis`, whose tangent frame is given.
fn in_lobe(axis: DVec3, [tangent, bitangent]: [DVec3; 2], cos: f64, turns: f64) -> DVec3 {
    let w = polar(cos, turns);
    w.x * tangent + w.y * bitangent + w.z * axis
}

/// Samples from the lobe around the mirrored direction of light at 60°; where that leaves the hemisphere there is no sample.
fn lobe(power: f64) -> impl Sampler {
    let (axis, frame) = mirrored();
    direction_sampler(move |u| Some(in_lobe(axis, frame, (1.0 - u[0]).powf(power), u[1])).filter(|w| w.z > 0.0))
}

fn mirrored() -> (DVec3, [DVec3; 2]) {
    let (sin, cos) = 60f64.to_radians().sin_cos();
    (DVec3::new(sin, 0.0, cos), [DVec3::Y, DVec3::new(cos, 0.0, -sin)])
}

/// Its pdf with the given factor for (n + 1).
fn lobe_pdf(factor: f64) -> DensityFn<impl Fn(Point) -> f64 + Sync> {
    direction_density(move |w| factor / TAU * w.dot(mirrored().0).max(0.0).powf(N))
}

/// A right sampler in proportion to the cosine.
fn cosine() -> DirectionSampler<impl Fn(&[f64]) -> Option<Sample> + Sync> {
    direction_sampler(|u| Some(warp::cosine_hemisphere(u)))
}

pub fn hemispheres() -> Vec<PlantedFault> {
    let half = Directions::hemisphere(Pole::Z);
    vec![
        PlantedFault::of("warp/hemisphere/even-in-theta", half, |faulty| {
            let cos = move |u: f64| if faulty { (u * FRAC_PI_2).cos() } else { 1.0 - u };
            (direction_sampler(move |u| Some(polar(cos(u[0]), u[1]))), direction_density(|_: DVec3| 1.0 / TAU))
        })
        .mistake("θ sampled uniformly from 0 to π/2, which crowds the pole: a frequent first sampler"),
        PlantedFault::of("warp/hemisphere/disc-without-root", half, |faulty| {
            let r2 = move |u: f64| if faulty { u * u } else { u };
            let draw = move |u: [f64; 2]| Some(polar((1.0 - r2(u[0])).sqrt(), u[1]));
            (direction_sampler(draw), direction_density(|w: DVec3| w.z / PI))
        })
        .mistake("a disc sampled with radius u instead of √u, then lifted to the hemisphere"),
        PlantedFault::of("warp/hemisphere/cosine-floor", half, |faulty| {
            let least = if faulty { 0.05 } else { 0.0 };
            (cosine(), direction_density(move |w: DVec3| w.z.max(least) / PI))
        })
        .mistake("the pdf's cosine clamped to 0.05 to keep clear of divisions by zero"),
        PlantedFault::of("warp/hemisphere/sine-left-in", half, |faulty| {
            let sine = move |w: DVec3| if faulty { w.truncate().length() } else { 1.0 };
            (cosine(), direction_density(move |w: DVec3| w.z / PI * sine(w)))
        })
        .mistake("the pdf per θ and φ taken for the one per solid angle: a factor sin θ too many"),
        PlantedFault::of("warp/hemisphere/swapped-numbers", half, |faulty| {
            let inverse = move |w: [f64; 3]| {
                let [a, b] = warp::invert_cosine_hemisphere(w.into());
                if faulty { vec![b, a] } else { vec![a, b] }
            };
            (cosine().with_inverse(inverse), direction_density(|w: DVec3| w.z / PI))
        })
        .mistake(
            "the two random numbers exchanged in the inverse: directions are right, \
                stratification and replay are wrong",
        ),
        PlantedFault::of("warp/hemisphere/frame-at-the-pole", half, |faulty| {
            let axis = DVec3::Z;
            let tangent = if faulty { axis.cross(DVec3::Z).normalize() } else { DVec3::X };
            let frame = [tangent, axis.cross(tangent)];
            let draw = move |u: [f64; 2]| Some(in_lobe(axis, frame, (1.0 - u[0]).powf(1.0 / (N + 1.0)), u[1]));
            (direction_sampler(draw), direction_density(|w: DVec3| (N + 1.0) / TAU * w.z.powf(N)))
        })
        .mistake("a tangent frame from the cross product with the normal, which is 0 for the normal itself: NaN"),
        PlantedFault::of("bsdf/lobe/below-the-horizon", half, |faulty| {
            let mass = if faulty { Mass::Exactly(1.0) } else { Mass::AtMostOne };
            (lobe(1.0 / (N + 1.0)), lobe_pdf(N + 1.0).with_mass(mass))
        })
        .mistake("directions lost below the horizon forgotten: the pdf is said to integrate to 1"),
        PlantedFault::of("bsdf/lobe/exponent", half, |faulty| {
            let power = 1.0 / if faulty { N } else { N + 1.0 };
            (lobe(power), lobe_pdf(N + 1.0).with_mass(Mass::AtMostOne))
        })
        .mistake("cos α sampled as u^(1/n) instead of u^(1/(n+1)): the solid angle's own power forgotten"),
        PlantedFault::of("bsdf/lobe/factor-of-the-reflectance", half, |faulty| {
            let factor = N + if faulty { 2.0 } else { 1.0 };
            (lobe(1.0 / (N + 1.0)), lobe_pdf(factor).with_mass(Mass::AtMostOne))
        })
        .mistake("the lobe's pdf with the reflectance's factor n + 2 instead of n + 1"),
    ]
}

/// Uniform directions of the sphere whose azimuth is made of a random number that `spoil` is done to.
fn azimuth(name: &'static str, spoil: fn(f64) -> f64) -> PlantedFault {
    PlantedFault::of(name, Directions::sphere(Pole::Z), move |faulty| {
        let draw = move |u: &[f64]| {
            let turns = if faulty { spoil(u[1]) } else { u[1] };
            Some(Sample::new(polar(1.0 - 2.0 * u[0], turns).to_array()))
        };
        (sampler(2, draw), density(|_: [f64; 3]| 0.5 / TAU))
    })
}

/// Numbers of a generator of its own, which `draw` makes from a seed.
struct Own<F>(F);

impl<F: Fn(u32, &mut [f64]) + Sync> Sampler for Own<F> {
    fn dimension(&self) -> usize {
        0
    }

    fn sample(&self, _: &[f64], _: &mut Vec<Option<Sample>>) -> etalon_stats::Result<()> {
        Err(etalon_stats::Error::external("this sampler takes no random numbers"))
    }

    fn sample_seeded(&self, count: usize, seed: u32, out: &mut Vec<Option<Sample>>) -> etalon_stats::Result<()> {
        let mut numbers = vec![0.0; count];
        (self.0)(seed, &mut numbers);
        out.extend(numbers.into_iter().map(|x| Some(Sample::new(x))));
        Ok(())
    }
}

/// Independent uniform numbers.
fn independent(seed: u32, numbers: &mut [f64]) {
    let mut rng = CounterRng::new(u64::from(seed), 0);
    numbers.iter_mut().for_each(|x| *x = rng.random());
}

/// A generator of uniform numbers on a line.
fn generator(name: &'static str, wrong: fn(u32, &mut [f64])) -> PlantedFault {
    PlantedFault::of(name, Line::UNIT, move |faulty| {
        (Own(if faulty { wrong } else { independent }), density(|_: f64| 1.0))
    })
}

pub fn numbers() -> Vec<PlantedFault> {
    vec![
        azimuth("warp/numbers/twelve-bits", |u| (4096.0 * u).floor() / 4096.0)
            .mistake("a random number of 12 bits: directions in 4096 planes only"),
        azimuth("warp/numbers/clamped", |u| u.min(0.999))
            .mistake("random numbers above 0.999 set to 0.999: one in a thousand in one plane"),
        azimuth("warp/numbers/not-to-the-end", |u| 0.999 * u)
            .mistake("azimuths up to 0.999 · 2π: a gap of a third of a degree"),
        generator("warp/numbers/randu", |seed, numbers| {
            let mut x = u64::from(seed | 1);
            numbers.iter_mut().for_each(|u| {
                x = x * 65_539 % (1 << 31);
                *u = x as f64 / f64::from(1u32 << 31);
            });
        })
        .mistake("the generator RANDU, three successive numbers of which lie in 15 planes"),
        generator("warp/numbers/rejected-moves", |seed, numbers| {
            independent(seed, numbers);
            let mut rng = CounterRng::new(u64::from(seed), 1);
            for i in 1..numbers.len() {
                if rng.random::<f64>() < 0.02 {
                    numbers[i] = numbers[i - 1];
                }
            }
        })
        .mistake("a Markov chain taken for independent samples: one move in fifty is rejected and repeats the sample"),
        generator("warp/numbers/random-walk", |seed, numbers| {
            independent(seed, numbers);
            for i in 1..numbers.len() {
                let to = (numbers[i - 1] + 0.5 * (2.0 * numbers[i] - 1.0)).abs();
                numbers[i] = if to > 1.0 { 2.0 - to } else { to };
            }
        })
        .mistake("a random walk with steps of up to half the domain"),
        generator("warp/numbers/seed-ignored", |_, numbers| independent(1, numbers))
            .mistake("a generator that is started anew with the same seed for each batch"),
    ]
}

const WEIGHTS: [f64; 8] = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0];

/// The cell of a cumulative table that `u` falls into, by bisection.
fn find(cdf: &[f64], u: f64) -> usize {
    cdf.partition_point(|&end| end <= u)
}

/// Cells sampled by `cell` against probabilities in proportion to `weights`.
fn by_weight(weights: Vec<f64>, cell: impl Fn(f64) -> usize + Sync) -> (impl Sampler, impl Density) {
    let total: f64 = weights.iter().sum();
    (sampler(1, move |u| Some(Sample::new(cell(u[0])))), density(move |cell: usize| weights[cell] / total))
}

/// The ends of the cells, with sums that `round` rounds.
fn cumulative(weights: &[f64], round: impl Fn(f64) -> f64) -> Vec<f64> {
    let ends: Vec<f64> = weights
        .iter()
        .scan(0.0, |sum, weight| {
            *sum = round(*sum + weight);
            Some(*sum)
        })
        .collect();
    let total = ends[ends.len() - 1];
    ends.into_iter().map(|end| end / total).collect()
}

/// Walker's table: the share of each bucket that is its own, and the owner of the rest.
fn alias(weights: &[f64]) -> Vec<(f64, usize)> {
    let n = weights.len();
    let total: f64 = weights.iter().sum();
    let mut left: Vec<f64> = weights.iter().map(|weight| weight * n as f64 / total).collect();
    let mut table: Vec<(f64, usize)> = (0..n).map(|i| (1.0, i)).collect();
    // Fill each bucket below its share from one above it.
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| left[i] < 1.0);
    while let (Some(s), Some(&l)) = (small.pop(), large.last()) {
        table[s] = (left[s], l);
        left[l] -= 1.0 - left[s];
        if left[l] < 1.0 {
            large.pop();
            small.push(l);
        }
    }
    table
}

pub fn tables() -> Vec<PlantedFault> {
    let small = Discrete { outcomes: WEIGHTS.len() };
    vec![
        PlantedFault::of("table/search-off-by-one", small, |faulty| {
            let cdf = cumulative(&WEIGHTS, |sum| sum);
            by_weight(WEIGHTS.into(), move |u| find(&cdf, u).saturating_sub(usize::from(faulty)))
        })
        .mistake("the table's leading 0 forgotten: the search returns the cell before"),
        PlantedFault::of("table/alias-off-by-one", small, |faulty| {
            let table = alias(&WEIGHTS);
            by_weight(WEIGHTS.into(), move |u| {
                let scaled = u * table.len() as f64;
                let bucket = scaled as usize;
                if scaled.fract() < table[bucket].0 {
                    bucket
                } else {
                    table[(bucket + usize::from(faulty)) % table.len()].1
                }
            })
        })
        .mistake("an alias table that looks the owner up in the next bucket"),
        PlantedFault::of("table/rounded-index", small, |faulty| {
            by_weight(vec![1.0; 8], move |u| if faulty { (u * 7.0).round() as usize } else { (u * 8.0) as usize })
        })
        .mistake("one of n chosen as u (n − 1) rounded: the first and the last come half as often"),
        PlantedFault::of("table/f32-sums", Discrete { outcomes: SKY }, |faulty| {
            let mut weights = vec![1.0; SKY];
            weights[SKY / 4] = f64::from(1 << 24);
            let cdf = cumulative(&weights, |sum| if faulty { f64::from(sum as f32) } else { sum });
            by_weight(weights, move |u| find(&cdf, u))
        })
        .mistake(
            "running sums in f32: behind a sun of 2²⁴ times the sky nothing adds up any more, and is never sampled",
        ),
    ]
}

/// Texels of the sky behind whose sun f32 sums end.
const SKY: usize = 1 << 17;

/// Samplers of other domains than directions.
pub fn domains() -> Vec<PlantedFault> {
    let mesh = || Indexed { count: 4, domain: Arc::new(Barycentric) };
    // The area of each of four triangles
    const AREAS: [f64; 4] = [0.1, 0.2, 0.3, 0.4];
    let half_disk = || {
        chart(
            |[x, y]: [f64; 2]| [x.hypot(y), y.atan2(x) / PI],
            |[r, turn]: [f64; 2]| [r * (PI * turn).cos(), r * (PI * turn).sin()],
            |[r, _]: [f64; 2]| PI * r,
        )
    };
    // The radius of a point of the disk by a random number
    let radius = |faulty: bool, u: f64| if faulty { u } else { u.sqrt() };
    let uniform_triangle = move |faulty: bool, u: &[f64]| {
        let side = radius(faulty, u[0]);
        [1.0 - side, u[1] * side]
    };
    vec![
        PlantedFault::on(
            "warp/domain/disk-without-root",
            || Disk::UNIT,
            move |faulty| {
                let draw = move |u: &[f64]| {
                    let (r, (sin, cos)) = (radius(faulty, u[0]), (TAU * u[1]).sin_cos());
                    Some(Sample::new([r * cos, r * sin]))
                };
                (sampler(2, draw), density(|_: [f64; 2]| 1.0 / PI))
            },
        )
        .mistake("the radius of a point of the disk is u, not √u"),
        PlantedFault::on("warp/domain/chart-without-root", half_disk, move |faulty| {
            let draw = move |u: &[f64]| {
                let (r, (sin, cos)) = (radius(faulty, u[0]), (PI * u[1]).sin_cos());
                Some(Sample::new([r * cos, r * sin]))
            };
            (sampler(2, draw), density(|_: [f64; 2]| 2.0 / PI))
        })
        .mistake("the same on half a disk, by a chart of its own"),
        PlantedFault::on(
            "warp/domain/triangle-without-root",
            || Barycentric,
            move |faulty| {
                let draw = move |u: &[f64]| Some(Sample::new(uniform_triangle(faulty, u)));
                (sampler(2, draw), density(|_: [f64; 2]| 2.0))
            },
        )
        .mistake("barycentric coordinates without the root, which crowd a corner"),
        PlantedFault::on(
            "warp/domain/simplex-normalized",
            || Simplex,
            move |faulty| {
                let draw = move |u: &[f64]| {
                    let exponential = [u[0], u[1], u[2]].map(|u| if faulty { u + 1e-9 } else { -(1.0 - u).ln() });
                    let sum: f64 = exponential.iter().sum();
                    (sum > 0.0).then(|| Sample::new(exponential.map(|x| x / sum)))
                };
                (sampler(3, draw), density(|_: [f64; 3]| 2.0))
            },
        )
        .mistake("three uniform numbers divided by their sum, not three exponential ones"),
        PlantedFault::on("warp/domain/mesh-by-index", mesh, move |faulty| {
            let draw = move |u: &[f64]| {
                let ends = [0.1, 0.3, 0.6, 1.0];
                let i = if faulty { (4.0 * u[2]) as usize } else { ends.partition_point(|end| *end <= u[2]).min(3) };
                let [b0, b1] = uniform_triangle(false, u);
                Some(Sample::new([i as f64, b0, b1]))
            };
            (sampler(3, draw), density(|[i, ..]: [f64; 3]| 2.0 * AREAS[i as usize]))
        })
        .mistake("triangles of a mesh chosen with equal probabilities, not by area"),
        PlantedFault::on(
            "warp/domain/exponential-mean",
            || HalfLine::POSITIVE,
            |faulty| {
                let draw = move |u: &[f64]| Some(Sample::new(-(1.0 - u[0]).ln() * if faulty { 2.0 } else { 0.5 }));
                (sampler(1, draw), density(|x: f64| 2.0 * (-2.0 * x).exp()))
            },
        )
        .mistake("distances through a medium multiplied by the extinction, not divided"),
        PlantedFault::on(
            "warp/domain/normal-variance",
            || RealLine::UNIT,
            |faulty| {
                let draw = move |u: &[f64]| {
                    let normal = (-2.0 * (1.0 - u[0]).ln()).sqrt() * (TAU * u[1]).cos();
                    Some(Sample::new(if faulty { 0.25 * normal } else { 0.5 * normal }))
                };
                (sampler(2, draw), density(|x: f64| (-2.0 * x * x).exp() * (2.0 / PI).sqrt()))
            },
        )
        .mistake("a normal distribution scaled by its variance, not by its standard deviation"),
        PlantedFault::on(
            "warp/domain/slopes-without-alpha",
            || Plane::UNIT,
            |faulty| {
                let draw = move |u: &[f64]| {
                    let r = if faulty { 0.25 } else { 0.5 } * (u[0] / (1.0 - u[0])).sqrt();
                    let (sin, cos) = (TAU * u[1]).sin_cos();
                    Some(Sample::new([r * cos, r * sin]))
                };
                let pdf = |[x, y]: [f64; 2]| 4.0 / (PI * (1.0 + 4.0 * (x * x + y * y)).powi(2));
                (sampler(2, draw), density(pdf))
            },
        )
        .mistake("slopes of GGX with α² in place of α"),
        PlantedFault::on(
            "warp/domain/circle-degrees",
            || Circle,
            |faulty| {
                let draw = move |u: &[f64]| {
                    let turns = if faulty { 0.5 * u[0] } else { u[0] };
                    let (sin, cos) = (TAU * turns).sin_cos();
                    Some(Sample::new([cos, sin]))
                };
                (sampler(1, draw), density(|_: [f64; 2]| 1.0 / TAU))
            },
        )
        .mistake("an angle from 0 to π where it goes to 2π"),
        PlantedFault::on(
            "warp/domain/interval-ends",
            || Line { from: -1.0, to: 3.0 },
            |faulty| {
                let draw = move |u: &[f64]| {
                    let t = u[0].sqrt();
                    Some(Sample::new(if faulty { 3.0 - 4.0 * t } else { 4.0 * t - 1.0 }))
                };
                (sampler(1, draw), density(|x: f64| (x + 1.0) / 8.0))
            },
        )
        .mistake("a linear density that rises towards the other end"),
        PlantedFault::on(
            "warp/domain/box-sides",
            || Rectangle { x: Line { from: 0.0, to: 2.0 }, y: Line::UNIT },
            |faulty| {
                let draw = move |u: &[f64]| {
                    let [x, y] = [2.0 * u[0], u[1]];
                    Some(Sample::new(if faulty { [y, 0.5 * x] } else { [x, y] }))
                };
                (sampler(2, draw), density(|_: [f64; 2]| 0.5))
            },
        )
        .mistake("the sides of a rectangle exchanged, so that half of it has no samples"),
        PlantedFault::on(
            "warp/domain/ball-square-root",
            || ball(1.0),
            move |faulty| {
                let draw = move |u: &[f64]| {
                    let (r, z) = (if faulty { u[0].sqrt() } else { u[0].cbrt() }, 2.0 * u[1] - 1.0);
                    let ((sin, cos), s) = ((TAU * u[2]).sin_cos(), (1.0 - z * z).sqrt());
                    Some(Sample::new([r * s * cos, r * s * sin, r * z]))
                };
                (sampler(3, draw), density(|_: [f64; 3]| 0.75 / PI))
            },
        )
        .mistake("the radius of a point of the ball is √u, not ∛u"),
        PlantedFault::on(
            "warp/domain/space-variance",
            || space(1.0),
            |faulty| {
                let draw = move |u: &[f64]| {
                    let normal = |i: usize| (-2.0 * (1.0 - u[i]).ln()).sqrt() * (TAU * u[i + 1]).cos();
                    Some(Sample::new([normal(0), normal(2), if faulty { 0.25 } else { 0.5 } * normal(4)]))
                };
                let pdf = |[x, y, z]: [f64; 3]| 2.0 * TAU.powf(-1.5) * (-0.5 * (x * x + y * y + 4.0 * z * z)).exp();
                (sampler(6, draw), density(pdf))
            },
        )
        .mistake("a normal distribution of three numbers, one scaled by its variance"),
        PlantedFault::on("warp/domain/rotations-of-a-box", rotations, |faulty| {
            let draw = move |u: &[f64]| {
                let pair = |i: usize| match faulty {
                    true => [2.0 * u[i] - 1.0, 2.0 * u[i + 1] - 1.0],
                    false => {
                        <[f64; 2]>::from((TAU * u[i + 1]).sin_cos()).map(|x| (-2.0 * (1.0 - u[i]).ln()).sqrt() * x)
                    }
                };
                let q = [pair(0), pair(2)].concat();
                let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
                (length > 0.0).then(|| Sample::new([0, 1, 2, 3].map(|i| q[i] / length)))
            };
            (sampler(4, draw), density(|_: [f64; 4]| 1.0))
        })
        .mistake("quaternions of four uniform numbers, which prefer the corners of their box, not of four normal ones"),
        PlantedFault::on(
            "warp/domain/box-of-six",
            || cuboid(vec![Line::UNIT; 6]),
            |faulty| {
                let draw = move |u: &[f64]| {
                    Some(Sample::new([u[0], u[1], u[2], u[3], u[4], if faulty { u[5] } else { u[5].sqrt() }]))
                };
                (sampler(6, draw), density(|x: [f64; 6]| 2.0 * x[5]))
            },
        )
        .mistake("one of six numbers drawn uniformly, not in proportion to itself"),
        PlantedFault::on(
            "warp/domain/dirichlet-normalized",
            || simplex(5),
            |faulty| {
                let draw = move |u: &[f64]| {
                    let weights = [0, 1, 2, 3, 4].map(|i| if faulty { u[i] + 1e-9 } else { -(1.0 - u[i]).ln() });
                    let sum: f64 = weights.iter().sum();
                    (sum > 0.0).then(|| Sample::new(weights.map(|x| x / sum)))
                };
                (sampler(5, draw), density(|_: [f64; 5]| 24.0))
            },
        )
        .mistake("five uniform numbers divided by their sum, not five exponential ones"),
    ]
}

/// What candidates of a reservoir are chosen by.
fn importance(x: f64) -> f64 {
    0.1 + x * x
}

/// A reservoir of two candidates between `ends[0]`, merged with one of six between `ends[1]`. The weight is Σ w over the importance of the
/// sample and `count`, the number of candidates that could have been it, from where it is.
fn merged(ends: [[f64; 2]; 2], count: impl Fn(f64) -> f64 + Sync) -> impl Sampler {
    sampler(16, move |u| {
        let (mut chosen, mut sum) = (0.0, 0.0);
        for (i, u) in u.chunks_exact(2).enumerate() {
            let [from, to] = ends[usize::from(i >= 2)];
            let x = from + (to - from) * u[0];
            let weight = importance(x) * (to - from);
            sum += weight;
            if u[1] * sum < weight {
                chosen = x;
            }
        }
        Some(Sample::with_weight(chosen, sum / (count(chosen) * importance(chosen))))
    })
}

/// Weights of resampling that do not estimate 1/pdf: mistakes of reservoirs. Nobody knows the pdf of such samples.
pub fn weights() -> Vec<PlantedFault> {
    vec![
        PlantedFault::of("warp/weights/merged-without-counts", Line::UNIT, |faulty| {
            let count = if faulty { 3.0 } else { 8.0 };
            (merged([[0.0, 1.0]; 2], move |_| count), target(|_: f64| 1.0))
        })
        .mistake("a merged reservoir counts as one candidate (pbrt-v4, before commit e273b3d8)"),
        PlantedFault::of("warp/weights/normalized-by-all", Line::UNIT, |faulty| {
            let count = move |x: f64| match x {
                _ if faulty => 8.0,
                ..0.25 => 2.0,
                0.75.. => 6.0,
                _ => 8.0,
            };
            (merged([[0.0, 0.75], [0.25, 1.0]], count), target(|_: f64| 1.0))
        })
        .mistake("all candidates count, though some could not have been the sample (as in RTXDI, pull request 42)"),
        PlantedFault::of("warp/weights/importance-of-another", Line::UNIT, |faulty| {
            let moved = if faulty { 1.02 } else { 1.0 };
            let count = move |x: f64| 8.0 * importance(moved * x) / importance(x);
            (merged([[0.0, 1.0]; 2], count), target(|_: f64| 1.0))
        })
        .mistake("the importance of the sample is that of another pixel or surface"),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::run;
    use super::numbers;
    use etalon_stats::Protocol;

    #[test]
    fn mistakes_in_random_numbers_are_named() {
        const DEPEND: &str = "samples depend on those before them";
        let named = [
            "random numbers of 12",
            "where the pdf has no atom",
            "parts of",
            DEPEND,
            DEPEND,
            DEPEND,
            "with the same samples",
        ];
        let found = run(numbers(), &Protocol::default(), &|_| ()).unwrap();
        assert!(found.is_good() && found.tests.len() == named.len());
        for (finding, named) in found.tests.iter().zip(named) {
            let said = finding.outcome.to_string();
            assert!(said.contains(named), "{}: {said}", finding.name);
        }
    }
}
