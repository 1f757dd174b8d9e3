//! Densities that are hard to integrate: narrow lobes, poles, gaps, edges that no rectangle follows. Right samplers of them
//! must not be rejected, the bounds of their integrals must hold, and their twins of 2 % too much mass must be found.
//! `cargo test -p etalon-stats --test hard_densities -- --ignored --nocapture` prints the results of a hundred.

#[path = "../src/testing.rs"]
mod testing;

use etalon_stats::stream::CounterRng;
use etalon_stats::{
    Bound, Directions, Domain, Line, Outcome, Point, Pole, Protocol, Result, Sample, Square, Verdict, density, sampler,
    validate,
};
use rand::RngExt;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use std::ops::Range;
use testing::{
    Vector, beckmann, beckmann_pdf, combine, cross, dot, ggx_visible, ggx_visible_pdf, length, normalize, tangents,
};

/// At 1 % each, more than 3 false rejections of 40 have a probability of 0.07 %; a tenth of that level belongs to the
/// bounds, of which more than 1 broken have one of 0.08 %.
#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn right_samplers_of_hard_densities_pass_and_their_twins_do_not() {
    assert_decided(0..2, 3);
}

/// More than 4 false rejections of 100 have a probability of 0.3 %, more than 1 broken bound one of 0.5 %.
#[ignore = "takes a minute"]
#[test]
fn a_hundred_hard_densities() {
    assert_decided(0..5, 4);
}

/// Tests the densities of each family with the parameters of these seeds, of which at most n may be rejected.
fn assert_decided(seeds: Range<u64>, most_rejected: u32) {
    let cases: Vec<(usize, u64)> =
        (0..FAMILIES.len()).flat_map(|family| seeds.clone().map(move |seed| (family, seed))).collect();
    assert_eq!(FAMILIES.len(), 20);
    let results: Vec<_> = cases
        .par_iter()
        .map(|&(family, seed)| {
            let (name, family) = FAMILIES[family];
            let outcome = |scale| family(&mut Random::new(seed), scale, &Protocol::default()).unwrap();
            (format!("{name} {seed}"), outcome(1.0), outcome(1.02))
        })
        .collect();
    let (mut rejected, mut accepted, mut broken, mut found) = (0, 0usize, 0, 0usize);
    for (name, right, twin) in &results {
        let mass = right.mass.unwrap();
        assert_eq!(mass.bound, Bound::Statistical, "{name}");
        let holds = (mass.value - 1.0).abs() <= mass.error + 1e-12;
        println!("{name:30} {mass} {}; twin {} {}", right.verdict, twin.mass.unwrap(), twin.verdict);
        if let Some(remark) = right.reason() {
            println!("    {remark}");
        }
        rejected += u32::from(right.verdict == Verdict::Reject);
        accepted += usize::from(right.verdict == Verdict::Accept);
        broken += u32::from(!holds);
        found += usize::from(twin.verdict == Verdict::Reject);
    }
    println!("{rejected} rejected, {accepted} accepted, {broken} bounds broken, {found} twins found");
    assert!(rejected <= most_rejected && broken <= 1, "{rejected} rejected, {broken} bounds broken");
    let most = 4 * cases.len() / 5;
    assert!(accepted >= most && found >= most, "{accepted} accepted, {found} twins found");
}

/// Parameters of one density.
struct Random(CounterRng);

impl Random {
    fn new(seed: u64) -> Self {
        Self(CounterRng::new(0x1dea, seed))
    }

    fn number(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.0.random::<f64>()
    }

    /// Uniform in the logarithm.
    fn scale(&mut self, from: f64, to: f64) -> f64 {
        self.number(from.ln(), to.ln()).exp()
    }

    fn direction(&mut self) -> Vector {
        let z = self.number(-1.0, 1.0);
        direction(z, self.number(0.0, TAU))
    }
}

/// Tests the right sampler against its density times a factor.
type Family = fn(&mut Random, f64, &Protocol) -> Result<Outcome>;

const FAMILIES: [(&str, Family); 20] = [
    ("lobe on the sphere", |r, k, p| {
        let lobe = Lobe::new(r.direction(), r.scale(1e5, 1e10));
        mixed(&Directions::sphere(Pole::Z), weight(r), k, p, uniform_sphere, 1.0 / (2.0 * TAU), lobe)
    }),
    ("lobe on the hemisphere", |r, k, p| {
        let z = r.number(0.1, 1.0);
        let lobe = Lobe::new(direction(z, r.number(0.0, TAU)), r.scale(1e6, 1e9));
        let broad = |[u, v]: [f64; 2]| direction(u, TAU * v);
        mixed(&Directions::hemisphere(Pole::Z), weight(r), k, p, broad, 1.0 / TAU, lobe)
    }),
    ("sharp microfacets among rough ones", |r, k, p| {
        let (sharp, rough, w) = (r.scale(2e-4, 5e-4), r.number(0.2, 0.6), weight(r));
        let sample = move |u: &[f64]| {
            let of = if u[2] < w { sharp } else { rough };
            beckmann(of, u)
        };
        let pdf = move |m: Vector| w * beckmann_pdf(sharp, m) + (1.0 - w) * beckmann_pdf(rough, m);
        test(&Directions::hemisphere(Pole::Z), 3, sample, pdf, k, p)
    }),
    ("visible normals near grazing", |r, k, p| {
        let (sin, cos) = r.number(85.0, 89.9).to_radians().sin_cos();
        let (wo, alpha) = ([sin, 0.0, cos], r.scale(1e-3, 0.3));
        let sample = move |u: &[f64]| ggx_visible(wo, alpha, [u[0], u[1]]);
        test(&Directions::hemisphere(Pole::Z), 2, sample, move |m: Vector| ggx_visible_pdf(wo, alpha, m), k, p)
    }),
    ("thin ring on the sphere", |r, k, p| {
        let (axis, from, width, w) = (r.direction(), r.number(-0.9, 0.8), r.scale(1e-6, 1e-3), weight(r));
        let frame = frame(axis);
        let sample = move |u: &[f64]| match u[2] < w {
            true => turned(frame, direction(from + width * u[0], TAU * u[1])),
            false => uniform_sphere([u[0], u[1]]),
        };
        let pdf = move |d: Vector| {
            let ring = (from..from + width).contains(&dot(d, axis));
            (1.0 - w) / (2.0 * TAU) + if ring { w / (TAU * width) } else { 0.0 }
        };
        test(&Directions::sphere(Pole::Z), 3, sample, pdf, k, p)
    }),
    ("uniform in the polar angle", |r, k, p| {
        // Infinite at two poles that are not those of the chart.
        let axis = r.direction();
        let frame = frame(axis);
        let sample = move |u: &[f64]| {
            let (sin, cos) = (PI * (1.0 - u[0])).sin_cos();
            let (s, c) = (TAU * u[1]).sin_cos();
            turned(frame, [sin * c, sin * s, cos])
        };
        let pdf = move |d: Vector| 1.0 / (2.0 * PI * PI * length(cross(d, axis)));
        test(&Directions::sphere(Pole::Z), 2, sample, pdf, k, p)
    }),
    ("box in the square", |r, k, p| {
        let (side, w) = (r.scale(1e-6, 1e-2), weight(r));
        let corner = [r.number(0.0, 0.98), r.number(0.0, 0.98)];
        let sample = move |u: &[f64]| match u[2] < w {
            true => [corner[0] + side * u[0], corner[1] + side * u[1]],
            false => [u[0], u[1]],
        };
        let pdf = move |x: [f64; 2]| {
            let inside = (0..2).all(|i| (corner[i]..corner[i] + side).contains(&x[i]));
            1.0 - w + if inside { w / (side * side) } else { 0.0 }
        };
        test(&Square, 3, sample, pdf, k, p)
    }),
    ("many boxes in the square", |r, k, p| {
        let (side, w) = (r.scale(1e-4, 1e-3), r.scale(1e-3, 1e-1));
        let n = r.scale(10.0, 100.0) as usize;
        // One box in each of n columns of the square, so that they do not overlap.
        let low: Vec<f64> = (0..n).map(|_| r.number(0.0, 0.99)).collect();
        let below = low.clone();
        let column = move |x: f64| ((x * n as f64) as usize).min(n - 1);
        let sample = move |u: &[f64]| {
            let i = column(u[0]);
            let within = u[0] * n as f64 - i as f64;
            if u[2] < w { [(i as f64 + 0.3) / n as f64 + side * within, below[i] + side * u[1]] } else { [u[0], u[1]] }
        };
        let pdf = move |[x, y]: [f64; 2]| {
            let i = column(x);
            let from = (i as f64 + 0.3) / n as f64;
            let inside = (from..from + side).contains(&x) && (low[i]..low[i] + side).contains(&y);
            1.0 - w + if inside { w / (n as f64 * side * side) } else { 0.0 }
        };
        test(&Square, 3, sample, pdf, k, p)
    }),
    ("ridge across the square", |r, k, p| {
        let (half, w) = (r.scale(1e-5, 1e-2), weight(r));
        let sample = move |u: &[f64]| match u[2] < w {
            true => [u[0], (u[0] + half * (2.0 * u[1] - 1.0)).rem_euclid(1.0)],
            false => [u[0], u[1]],
        };
        let pdf = move |[x, y]: [f64; 2]| {
            let apart = (x - y).abs().min(1.0 - (x - y).abs());
            1.0 - w + if apart <= half { w / (2.0 * half) } else { 0.0 }
        };
        test(&Square, 3, sample, pdf, k, p)
    }),
    ("disc in the square", |r, k, p| {
        let (radius, w) = (r.number(0.1, 0.45), r.number(0.2, 1.0));
        let sample = move |u: &[f64]| {
            let (sin, cos) = (TAU * u[1]).sin_cos();
            let at = radius * u[0].sqrt();
            if u[2] < w { [0.5 + at * cos, 0.5 + at * sin] } else { [u[0], u[1]] }
        };
        let pdf = move |[x, y]: [f64; 2]| {
            let inside = (x - 0.5).hypot(y - 0.5) <= radius;
            1.0 - w + if inside { w / (PI * radius * radius) } else { 0.0 }
        };
        test(&Square, 3, sample, pdf, k, p)
    }),
    ("poles on two edges of the square", |r, k, p| {
        let (a, b) = (r.number(0.1, 0.9), r.number(0.1, 0.9));
        let sample = move |u: &[f64]| [(1.0 - u[0]).powf(1.0 / (1.0 - a)), (1.0 - u[1]).powf(1.0 / (1.0 - b))];
        let pdf = move |[x, y]: [f64; 2]| (1.0 - a) * x.powf(-a) * (1.0 - b) * y.powf(-b);
        test(&Square, 2, sample, pdf, k, p)
    }),
    ("strip of the square", |r, k, p| {
        // Too little or too much in a strip that lies between the nodes of most rules.
        let (from, width, height) = (r.number(0.0, 0.9), r.scale(1e-4, 1e-2), r.number(0.0, 2.0));
        let rest = (1.0 - width * height) / (1.0 - width);
        let sample = move |u: &[f64]| {
            let x = if u[2] < width * height {
                from + width * u[0]
            } else {
                let x = u[0] * (1.0 - width);
                if x < from { x } else { x + width }
            };
            [x, u[1]]
        };
        let pdf = move |[x, _]: [f64; 2]| if (from..from + width).contains(&x) { height } else { rest };
        test(&Square, 3, sample, pdf, k, p)
    }),
    ("undeclared steps in the square", |r, k, p| {
        let n = r.scale(3.0, 30.0) as usize;
        let weights: Vec<f64> = (0..n).map(|_| r.scale(1e-2, 1.0)).collect();
        let total: f64 = weights.iter().sum();
        let height = weights.clone();
        let sample = move |u: &[f64]| {
            let mut left = u[0] * total;
            let i = weights.iter().position(|w| {
                left -= w;
                left < 0.0
            });
            [(i.unwrap_or(n - 1) as f64 + u[2]) / n as f64, u[1]]
        };
        let pdf = move |[x, _]: [f64; 2]| height[((x * n as f64) as usize).min(n - 1)] * n as f64 / total;
        test(&Square, 3, sample, pdf, k, p)
    }),
    ("half-plane of the square", |r, k, p| {
        // Twice the density on one side of a line through the middle.
        let (sin, cos) = r.number(0.0, PI).sin_cos();
        let w = r.number(0.3, 1.0);
        let side = move |[x, y]: [f64; 2]| (x - 0.5) * cos + (y - 0.5) * sin;
        let sample = move |u: &[f64]| {
            let x = [u[0], u[1]];
            if u[2] < w && side(x) < 0.0 { [1.0 - u[0], 1.0 - u[1]] } else { x }
        };
        let pdf = move |x: [f64; 2]| 1.0 + if side(x) >= 0.0 { w } else { -w };
        test(&Square, 3, sample, pdf, k, p)
    }),
    ("pole on the line", |r, k, p| {
        let a = r.number(0.3, 0.95);
        let sample = move |u: &[f64]| (1.0 - u[0]).powf(1.0 / (1.0 - a));
        test(&Line::UNIT, 1, sample, move |x: f64| (1.0 - a) * x.powf(-a), k, p)
    }),
    ("pole inside the line", |r, k, p| {
        let (a, c) = (r.number(0.3, 0.6), r.number(0.2, 0.8));
        let sample = move |u: &[f64]| {
            let far = (1.0 - u[0]).powf(1.0 / (1.0 - a));
            if u[1] < c { c - c * far } else { c + (1.0 - c) * far }
        };
        let pdf = move |x: f64| {
            let far = if x < c { (c - x) / c } else { (x - c) / (1.0 - c) };
            (1.0 - a) * far.max(1e-17).powf(-a)
        };
        test(&Line::UNIT, 2, sample, pdf, k, p)
    }),
    ("logarithm on the line", |r, k, p| {
        let n = r.scale(1.0, 4.0) as i32;
        // The product of n + 1 uniform numbers.
        let sample = move |u: &[f64]| u.iter().map(|u| 1.0 - u).product::<f64>();
        let pdf = move |x: f64| (-x.ln()).powi(n) / (1..=n).map(f64::from).product::<f64>();
        test(&Line::UNIT, n as usize + 1, sample, pdf, k, p)
    }),
    ("narrow peak on the line", |r, k, p| {
        // Cauchy's distribution, cut off at the ends.
        let (middle, width, w) = (r.number(0.1, 0.9), r.scale(1e-8, 1e-4), weight(r));
        let (low, high) = ((-middle / width).atan(), ((1.0 - middle) / width).atan());
        let sample = move |u: &[f64]| match u[1] < w {
            true => (middle + width * (low + (high - low) * u[0]).tan()).clamp(0.0, 1.0),
            false => u[0],
        };
        let pdf = move |x: f64| {
            let apart = (x - middle) / width;
            1.0 - w + w / (width * (high - low) * (1.0 + apart * apart))
        };
        test(&Line::UNIT, 2, sample, pdf, k, p)
    }),
    ("gap in the line", |r, k, p| {
        let (from, width) = (r.number(0.0, 0.9), r.scale(1e-5, 1e-2));
        let sample = move |u: &[f64]| {
            let x = u[0] * (1.0 - width);
            if x < from { x } else { x + width }
        };
        let pdf = move |x: f64| if (from..from + width).contains(&x) { 0.0 } else { 1.0 / (1.0 - width) };
        test(&Line::UNIT, 1, sample, pdf, k, p)
    }),
    ("ripple on the line", |r, k, p| {
        let (periods, height) = (r.scale(1.0, 200.0).round(), r.number(0.1, 0.9));
        let turn = TAU * periods;
        let sample = move |u: &[f64]| {
            // The distribution x − h (cos τx − 1)/τ rises; its inverse by bisection.
            let (mut from, mut to) = (0.0, 1.0);
            while to - from > 1e-16 {
                let x: f64 = 0.5 * (from + to);
                if x <= from || x >= to {
                    break;
                }
                if x - height * ((turn * x).cos() - 1.0) / turn < u[0] { from = x } else { to = x }
            }
            to
        };
        test(&Line::UNIT, 1, sample, move |x: f64| 1.0 + height * (turn * x).sin(), k, p)
    }),
];

fn test<P: Into<Point> + From<Point>>(
    domain: &dyn Domain,
    dimension: usize,
    sample: impl Fn(&[f64]) -> P + Sync,
    pdf: impl Fn(P) -> f64 + Sync,
    factor: f64,
    protocol: &Protocol,
) -> Result<Outcome> {
    let sampler = sampler(dimension, move |u| Some(Sample::new(sample(u))));
    validate(domain, &sampler, &density(move |x| factor * pdf(x)), protocol)
}

/// The share of a narrow part.
fn weight(r: &mut Random) -> f64 {
    r.scale(3e-4, 3e-3)
}

fn direction(z: f64, phi: f64) -> Vector {
    let sin = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    [sin * phi.cos(), sin * phi.sin(), z]
}

fn uniform_sphere([u, v]: [f64; 2]) -> Vector {
    direction(1.0 - 2.0 * u, TAU * v)
}

/// Axes with the third along `axis`.
fn frame(axis: Vector) -> [Vector; 3] {
    let [t, b] = tangents(axis);
    [t, b, axis]
}

fn turned([t, b, n]: [Vector; 3], d: Vector) -> Vector {
    normalize(combine([(d[0], t), (d[1], b), (d[2], n)]))
}

/// The von Mises–Fisher distribution: density ∝ exp(κ cos θ) around an axis.
#[derive(Clone, Copy)]
struct Lobe {
    axis: Vector,
    kappa: f64,
}

impl Lobe {
    fn new(axis: Vector, kappa: f64) -> Self {
        Self { axis, kappa }
    }

    fn sample(&self, [u, v]: [f64; 2]) -> Vector {
        // 1 − cos θ is exponentially distributed except for what is beyond the opposite pole: e^(−2κ).
        let below = -(-u).ln_1p() / self.kappa;
        let sin = (below * (2.0 - below)).max(0.0).sqrt();
        let (s, c) = (TAU * v).sin_cos();
        turned(frame(self.axis), [sin * c, sin * s, 1.0 - below])
    }

    fn pdf(&self, d: Vector) -> f64 {
        self.kappa / TAU * (-0.5 * self.kappa * length([0, 1, 2].map(|i| d[i] - self.axis[i])).powi(2)).exp()
    }
}

/// A share of `w` for a lobe, the rest uniform.
fn mixed(
    domain: &Directions,
    w: f64,
    factor: f64,
    protocol: &Protocol,
    broad: impl Fn([f64; 2]) -> Vector + Sync,
    even: f64,
    lobe: Lobe,
) -> Result<Outcome> {
    let sample = move |u: &[f64]| if u[2] < w { lobe.sample([u[0], u[1]]) } else { broad([u[0], u[1]]) };
    test(domain, 3, sample, move |d| (1.0 - w) * even + w * lobe.pdf(d), factor, protocol)
}
