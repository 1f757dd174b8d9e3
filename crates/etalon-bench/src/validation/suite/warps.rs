//! Test cases: what random numbers are mapped by: warps of the unit square to directions, with the circular functions that they
//! are made of; tabulated distributions in one and two dimensions with their guides; microfacet normals in f64 and in f32.

use super::super::case::{Case, direction_density, direction_sampler};
use super::{ALPHAS, DEGREES, DISTRIBUTIONS, short, towards};
use etalon_core::math::Real;
use etalon_core::math::circular::Circular;
use etalon_core::optics::microfacet::{Beckmann, Distribution, Ggx};
use etalon_core::sampling::normals::SampleNormals;
use etalon_core::sampling::table::{Table1, Table2};
use etalon_core::sampling::warp;
use etalon_stats::{Directions, Line, Pole, Sample, Square, density, sampler};
use glam::DVec3;

pub fn warps() -> Vec<Case> {
    let half = Directions::hemisphere(Pole::Z);
    vec![
        Case::of("warp/uniform-hemisphere", half, || {
            let sampler = direction_sampler(|u| Some(warp::uniform_hemisphere(u)));
            let sampler = sampler.with_inverse(|w: [f64; 3]| warp::invert_uniform_hemisphere(w.into()).to_vec());
            (sampler, direction_density(|_: DVec3| warp::UNIFORM_HEMISPHERE_PDF))
        }),
        Case::of("warp/uniform-sphere", Directions::sphere(Pole::Z), || {
            let sampler = direction_sampler(|u| Some(warp::uniform_sphere(u)));
            let sampler = sampler.with_inverse(|w: [f64; 3]| warp::invert_uniform_sphere(w.into()).to_vec());
            (sampler, direction_density(|_: DVec3| warp::UNIFORM_SPHERE_PDF))
        }),
        Case::of("warp/cosine-hemisphere", half, || {
            let sampler = direction_sampler(|u| Some(warp::cosine_hemisphere(u)));
            let sampler = sampler.with_inverse(|w: [f64; 3]| warp::invert_cosine_hemisphere(w.into()).to_vec());
            (sampler, direction_density(|w: DVec3| warp::cosine_hemisphere_pdf(w.z)))
        }),
        // Both f32 functions at once: turns to a point of the circle, and half of the circle back to an angle.
        Case::of("warp/circle-f32/sine-and-cosine", half, || {
            let draw = |u: [f64; 2]| {
                let (sin, cos) = f32::sin_cos_turns(short(u[1]));
                let r = (u[0] * (2.0 - u[0])).sqrt();
                Some(DVec3::new(r * f64::from(cos), r * f64::from(sin), 1.0 - u[0]))
            };
            (direction_sampler(draw), direction_density(|_: DVec3| warp::UNIFORM_HEMISPHERE_PDF))
        }),
        Case::of("warp/circle-f32/angle", Line { from: 0.0, to: std::f64::consts::PI }, || {
            let draw = |u: &[f64]| {
                let (sin, cos) = (0.5 * u[0] * std::f64::consts::TAU).sin_cos();
                let angle = f32::angle(sin as f32, cos as f32);
                Some(Sample::new(f64::from(angle).min(std::f64::consts::PI)))
            };
            (sampler(1, draw), density(|_: f64| std::f64::consts::FRAC_1_PI))
        }),
    ]
}

type Weights = fn(usize, usize) -> f64;

/// Shapes of weights: constant, linear, 90 % in one cell, zeros at the ends, zeros in between.
const SHAPES: [(&str, Weights); 5] = [
    ("even", |_, _| 1.0),
    ("linear", |i, _| i as f64 + 0.5),
    ("one-huge", |i, n| if i == n / 3 { 9.0 * n as f64 } else { 1.0 }),
    ("dark-ends", |i, n| f64::from(4 * i > n && 4 * i < 3 * n)),
    ("gaps", |i, _| if i % 3 == 1 { 0.0 } else { (i % 7) as f64 + 0.1 }),
];
const CELLS: [usize; 5] = [1, 2, 37, 1024, 65535];

fn weights(shape: Weights, n: usize) -> Vec<f64> {
    let mut weights: Vec<f64> = (0..n).map(|i| shape(i, n)).collect();
    if weights.iter().all(|w| *w == 0.0) {
        weights[n / 2] = 1.0;
    }
    weights
}

/// The inner edges of `n` equal steps.
fn steps(n: usize) -> Vec<f64> {
    (1..n).map(|i| i as f64 / n as f64).collect()
}

pub fn tables() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, shape) in SHAPES {
        // A single cell is uniform whatever its weight.
        for n in CELLS.into_iter().filter(|n| *n > 2 || name == "even") {
            cases.push(cumulative(format!("table/cdf/{name}/{n}"), shape, n));
        }
        for (width, height) in [(16, 8), (5, 63), (300, 200)] {
            cases.push(grid(format!("table/grid/{name}/{width}x{height}"), shape, width, height));
        }
    }
    cases
}

/// The position along the table: the cell and the position inside it, which is uniform.
fn cumulative(name: String, shape: Weights, n: usize) -> Case {
    Case::of(name, Line::UNIT, move || {
        let table = Table1::new(&weights(shape, n));
        let (cells, of) = (n as f64, table.clone());
        let pdf = move |x: f64| of.probability(((x * cells) as usize).min(n - 1)) * cells;
        let back = table.clone();
        let draw = move |u: &[f64]| {
            let draw = table.sample(u[0])?;
            Some(Sample::with_pdf((draw.cell as f64 + draw.offset) / cells, draw.probability * cells))
        };
        // Random number of a position, by its cell.
        let invert = move |x: f64| {
            let cell = ((x * cells) as usize).min(n - 1);
            vec![back.invert(cell, x * cells - cell as f64)]
        };
        (sampler(1, draw).with_inverse(invert), density(pdf).with_steps([steps(n), Vec::new()]))
    })
}

/// The place on a grid whose weights are a product of two shapes, turned against each other.
fn grid(name: String, shape: Weights, width: usize, height: usize) -> Case {
    Case::of(name, Square, move || {
        let (row, column) = (weights(shape, height), weights(shape, width));
        let table = Table2::new(width, height, |x, y| row[y] * column[(x + y) % width]);
        let (w, h, of) = (width as f64, height as f64, table.clone());
        let cell = move |[y, x]: [f64; 2]| [((x * w) as usize).min(width - 1), ((y * h) as usize).min(height - 1)];
        let pdf = move |place: [f64; 2]| {
            let [x, y] = cell(place);
            of.probability(x, y) * (w * h)
        };
        let back = table.clone();
        let draw = move |u: &[f64]| {
            let draw = table.sample([u[0], u[1]])?;
            let place = [(draw.y.cell as f64 + draw.y.offset) / h, (draw.x.cell as f64 + draw.x.offset) / w];
            Some(Sample::with_pdf(place, draw.probability() * (w * h)))
        };
        let invert = move |place: [f64; 2]| {
            let [x, y] = cell(place);
            back.invert((x, y), (place[1] * w - x as f64, place[0] * h - y as f64)).to_vec()
        };
        (sampler(2, draw).with_inverse(invert), density(pdf).with_steps([steps(height), steps(width)]))
    })
}

/// Distributions of normals in f64 and f32: every roughness meets half of the angles in each.
pub fn normals() -> Vec<Case> {
    let mut cases = Vec::new();
    for (d, (name, distribution)) in DISTRIBUTIONS.into_iter().enumerate() {
        for (a, alpha) in ALPHAS.into_iter().enumerate() {
            let both = |tail: String, wo: Option<DVec3>| {
                let [double, single] = ["normals", "normals/f32"].map(|kind| format!("{kind}/{name}/{tail}"));
                let of_24_bits = |u| f64::from(short(u));
                match distribution {
                    Distribution::Beckmann => [
                        case::<f64>(double, Beckmann::new(alpha), wo, |u| u),
                        case::<f32>(single, Beckmann::new(alpha as f32), wo, of_24_bits),
                    ],
                    Distribution::Ggx => [
                        case::<f64>(double, Ggx::new(alpha), wo, |u| u),
                        case::<f32>(single, Ggx::new(alpha as f32), wo, of_24_bits),
                    ],
                }
            };
            cases.extend(both(format!("all/{alpha}"), None));
            for (t, degrees) in DEGREES.into_iter().enumerate() {
                let visible = both(format!("visible/{alpha}/{degrees}"), Some(towards(degrees)));
                cases.extend(visible.into_iter().nth((a + t + d) % 2));
            }
        }
    }
    cases
}

/// Samples of the full distribution (NDF), or of the normals visible from `wo` (VNDF), with random numbers by `random`.
fn case<T: Real + Send + Sync + 'static>(
    name: String,
    d: impl SampleNormals<T> + Send + Sync + 'static,
    wo: Option<DVec3>,
    random: fn(f64) -> f64,
) -> Case {
    let wo = wo.map(|wo| wo.to_array().map(T::from_f64));
    Case::of(name, Directions::hemisphere(Pole::Z), move || {
        let draw = move |u: &[f64]| {
            let u = [u[0], u[1]].map(|u| T::from_f64(random(u)));
            let wm = wo.map_or_else(|| d.sample_ndf(u), |wo| d.sample_vndf(wo, u));
            Some(Sample::new(wm.map(Real::to_f64)))
        };
        let pdf = move |wm: [f64; 3]| {
            let wm = wm.map(T::from_f64);
            wo.map_or_else(|| d.pdf_ndf(wm), |wo| d.pdf_vndf(wo, wm)).to_f64()
        };
        (sampler(2, draw), density(pdf))
    })
}
