//! From radiance along a direction to an image: adaptive supersampling, flames as soft spots, the glow of the lens.

use glam::DVec3;
use rayon::prelude::*;

pub const WIDTH: usize = 1024;
pub const HEIGHT: usize = 512;
/// Sub-pixel positions per side; the samples of a divided pixel sit on some of them.
const GRID: usize = 8;
/// A pixel is divided in 2 × 2 or 4 × 4 when its corners differ by more than these parts of their sum.
const CONTRAST: f64 = 0.09;
const STRONG_CONTRAST: f64 = 0.4;

/// Radiance along a direction, and a number for what was met: pixels where it changes are divided.
pub type Seen = (DVec3, u32);

/// Directions of the sub-pixel grid of the lat-long map.
pub struct Lens {
    columns: Vec<(f64, f64)>,
    rows: Vec<(f64, f64)>,
}

impl Lens {
    pub fn new() -> Self {
        let circle = |count: usize, turn: f64| -> Vec<(f64, f64)> {
            (0..=count).map(|i| libm::sincos(turn * i as f64 / count as f64)).collect()
        };
        Self {
            columns: circle(WIDTH * GRID, std::f64::consts::TAU),
            rows: circle(HEIGHT * GRID, std::f64::consts::PI),
        }
    }

    /// Direction of sub-pixel column `x` and row `y` (both times `GRID`).
    fn direction(&self, x: usize, y: usize) -> DVec3 {
        let ((sx, cx), (sy, cy)) = (self.columns[x], self.rows[y]);
        DVec3::new(cx * sy, cy, sx * sy)
    }

    /// Direction of the centre of a pixel.
    pub fn centre(&self, x: usize, y: usize) -> DVec3 {
        self.direction(x * GRID + GRID / 2, y * GRID + GRID / 2)
    }

    /// Samples the scene at the corners of all pixels, and again inside those whose corners disagree.
    pub fn expose(&self, see: impl Fn(DVec3) -> Seen + Sync) -> Vec<DVec3> {
        let corners: Vec<Seen> = (0..(HEIGHT + 1) * WIDTH)
            .into_par_iter()
            .with_min_len(WIDTH)
            .map(|i| see(self.direction(i % WIDTH * GRID, i / WIDTH * GRID)))
            .collect();
        (0..HEIGHT * WIDTH)
            .into_par_iter()
            .with_min_len(WIDTH)
            .map(|i| {
                let (x, y) = (i % WIDTH, i / WIDTH);
                let next = (x + 1) % WIDTH;
                let four = [(x, y), (next, y), (x, y + 1), (next, y + 1)].map(|(x, y)| corners[y * WIDTH + x]);
                match contrast(&four) {
                    c if c < CONTRAST => four.iter().map(|s| s.0).sum::<DVec3>() * 0.25,
                    c if c < STRONG_CONTRAST => self.divide(x, y, 2, &see),
                    _ => self.divide(x, y, 4, &see),
                }
            })
            .collect()
    }

    /// The mean of `side`² samples in the pixel.
    fn divide(&self, x: usize, y: usize, side: usize, see: impl Fn(DVec3) -> Seen) -> DVec3 {
        let step = GRID / side;
        let mut sum = DVec3::ZERO;
        for j in 0..side {
            for i in 0..side {
                sum += see(self.direction(x * GRID + i * step + step / 2, y * GRID + j * step + step / 2)).0;
            }
        }
        sum / (side * side) as f64
    }

    /// Adds a spot with a Gaussian profile: `peak` in the middle, falling by e at the angle `radius`.
    pub fn spot(&self, image: &mut [DVec3], d: DVec3, peak: DVec3, radius: f64) {
        const REACH: f64 = 3.0;
        let per_row = HEIGHT as f64 / std::f64::consts::PI;
        let middle = libm::acos(d.y) * per_row;
        let reach = REACH * radius * per_row;
        for y in (middle - reach).max(0.0) as usize..((middle + reach) as usize + 1).min(HEIGHT) {
            for x in 0..WIDTH {
                let off = (self.centre(x, y) - d).length_squared() / (radius * radius);
                if off < REACH * REACH {
                    image[y * WIDTH + x] += peak * libm::exp(-off);
                }
            }
        }
    }
}

/// How different the corners are, from 0 to 1; different surfaces differ enough to be divided.
fn contrast(corners: &[Seen; 4]) -> f64 {
    let values = corners.map(|(c, _)| c.element_sum());
    let (low, high) = values.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), &v| (l.min(v), h.max(v)));
    let one_surface = corners.iter().all(|c| c.1 == corners[0].1);
    ((high - low) / (high + low)).max(if one_surface { 0.0 } else { CONTRAST })
}

/// What a real lens does to very bright spots: a small part of all light is spread over some degrees.
pub fn glow(image: &mut [DVec3]) {
    const NARROW: f64 = 0.10;
    const WIDE: f64 = 0.05;
    const DOWN: usize = 4;
    let narrow = blur(image, WIDTH, HEIGHT, 2.5);
    let (w, h) = (WIDTH / DOWN, HEIGHT / DOWN);
    let small: Vec<DVec3> = (0..w * h)
        .map(|i| {
            let (x, y) = (i % w * DOWN, i / w * DOWN);
            let block = (0..DOWN * DOWN).map(|k| image[(y + k / DOWN) * WIDTH + x + k % DOWN]);
            block.sum::<DVec3>() / (DOWN * DOWN) as f64
        })
        .collect();
    let wide = blur(&small, w, h, 4.5);
    image.par_iter_mut().enumerate().for_each(|(i, value)| {
        // The small image is read with linear interpolation, around the seam and up to the poles.
        let at = |p: usize| (p as f64 + 0.5) / DOWN as f64 - 0.5;
        let (x, y) = (at(i % WIDTH), at(i / WIDTH).clamp(0.0, h as f64 - 1.0));
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let columns = [(x0 as isize).rem_euclid(w as isize) as usize, (x0 as isize + 1).rem_euclid(w as isize) as usize];
        let rows = [y0 as usize, (y0 as usize + 1).min(h - 1)];
        let row = |r: usize| wide[r * w + columns[0]].lerp(wide[r * w + columns[1]], fx);
        *value = *value * (1.0 - NARROW - WIDE) + narrow[i] * NARROW + row(rows[0]).lerp(row(rows[1]), fy) * WIDE;
    });
}

/// Gaussian blur on the sphere: `sigma` rows up and down, as far in angle to the sides.
fn blur(image: &[DVec3], width: usize, height: usize, sigma: f64) -> Vec<DVec3> {
    let columns: Vec<DVec3> = (0..width * height)
        .into_par_iter()
        .with_min_len(width)
        .map(|i| {
            let (x, y) = (i % width, i / width);
            let sine = libm::sin(std::f64::consts::PI * (y as f64 + 0.5) / height as f64);
            let sigma = (sigma / sine).min(width as f64 / 8.0);
            weighted(sigma, |k| image[y * width + (x as isize + k).rem_euclid(width as isize) as usize])
        })
        .collect();
    (0..width * height)
        .into_par_iter()
        .with_min_len(width)
        .map(|i| {
            let (x, y) = (i % width, i / width);
            weighted(sigma, |k| columns[(y as isize + k).clamp(0, height as isize - 1) as usize * width + x])
        })
        .collect()
}

/// Mean of `value(k)` under a bell of width `sigma`: the square of a parabola, which needs no exponential.
fn weighted(sigma: f64, value: impl Fn(isize) -> DVec3) -> DVec3 {
    let reach = 2.6 * sigma;
    let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
    let last = reach as isize;
    for k in -last..=last {
        let x = k as f64 / reach;
        let w = (1.0 - x * x) * (1.0 - x * x);
        sum += value(k) * w;
        weight += w;
    }
    sum / weight
}
