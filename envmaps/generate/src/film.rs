//! From radiance along a direction to an image: adaptive supersampling, flames as soft spots, the glow of the lens.

use glam::{DVec3, Vec3A};
use rayon::prelude::*;

pub const WIDTH: usize = 1024;
pub const HEIGHT: usize = 512;
/// Sub-pixel positions per side; the samples of a divided pixel sit on some of them.
const GRID: usize = 8;
/// A pixel is divided in 2 × 2 or 4 × 4 when its corners differ by more than these parts of their sum.
const CONTRAST: f64 = 0.12;
const STRONG_CONTRAST: f64 = 0.5;

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
        Self { columns: circle(WIDTH * GRID, std::f64::consts::TAU), rows: circle(HEIGHT * GRID, std::f64::consts::PI) }
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
pub fn glow(image: &[DVec3]) -> Vec<Vec3A> {
    const NARROW: f32 = 0.10;
    const WIDE: f32 = 0.05;
    const DOWN: usize = 4;
    let image: Vec<Vec3A> = image.iter().map(|c| c.as_vec3a()).collect();
    let narrow = blur(&image, WIDTH, 2.5);
    let (w, h) = (WIDTH / DOWN, HEIGHT / DOWN);
    let small: Vec<Vec3A> = (0..w * h)
        .map(|i| {
            let (x, y) = (i % w * DOWN, i / w * DOWN);
            let block = (0..DOWN * DOWN).map(|k| image[(y + k / DOWN) * WIDTH + x + k % DOWN]);
            block.sum::<Vec3A>() / (DOWN * DOWN) as f32
        })
        .collect();
    let wide = blur(&small, w, 4.5);
    // The small image is read with linear interpolation, around the seam and up to the poles.
    let place = |pixel: usize| (pixel as f32 + 0.5) / DOWN as f32 - 0.5;
    let far = |x: usize, y: usize| {
        let (x, y) = (place(x) + w as f32, place(y).clamp(0.0, h as f32 - 1.0));
        let (x0, y0) = (x as usize, y as usize);
        let row = |y: usize| wide[y * w + x0 % w].lerp(wide[y * w + (x0 + 1) % w], x - x0 as f32);
        row(y0).lerp(row((y0 + 1).min(h - 1)), y - y0 as f32)
    };
    let keep = 1.0 - NARROW - WIDE;
    let mix = |i: usize| image[i] * keep + narrow[i] * NARROW + far(i % WIDTH, i / WIDTH) * WIDE;
    (0..image.len()).into_par_iter().with_min_len(WIDTH).map(mix).collect()
}

/// Gaussian blur on the sphere: `sigma` rows up and down, as far in angle to the sides. `width` is a power of two.
fn blur(image: &[Vec3A], width: usize, sigma: f32) -> Vec<Vec3A> {
    let height = image.len() / width;
    let sideways: Vec<Vec3A> = image
        .par_chunks(width)
        .enumerate()
        .flat_map_iter(|(y, row)| {
            let sine = libm::sin(std::f64::consts::PI * (y as f64 + 0.5) / height as f64) as f32;
            let bell = bell((sigma / sine).min(width as f32 / 8.0));
            let start = width - bell.len() / 2;
            (0..width).map(move |x| {
                bell.iter().enumerate().map(|(k, &weight)| row[(start + x + k) & (width - 1)] * weight).sum::<Vec3A>()
            })
        })
        .collect();
    let bell = bell(sigma);
    let half = bell.len() / 2;
    (0..height)
        .into_par_iter()
        .flat_map_iter(|y| {
            let mut sum = vec![Vec3A::ZERO; width];
            for (k, &weight) in bell.iter().enumerate() {
                let from = (y + k).saturating_sub(half).min(height - 1) * width;
                sum.iter_mut().zip(&sideways[from..from + width]).for_each(|(sum, &value)| *sum += value * weight);
            }
            sum
        })
        .collect()
}

/// Weights of a bell of width `sigma`, odd in number: a power of a parabola, near enough to a Gaussian to look round.
fn bell(sigma: f32) -> Vec<f32> {
    // The fourth power has the variance of a Gaussian when it ends at √11 of its widths.
    let reach = 3.316_625 * sigma;
    let last = reach as i32;
    let weight = |k: i32| {
        let parabola = 1.0 - (k as f32 / reach) * (k as f32 / reach);
        let square = parabola * parabola;
        square * square
    };
    let weights: Vec<f32> = (-last..=last).map(weight).collect();
    let total: f32 = weights.iter().sum();
    weights.iter().map(|w| w / total).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_scene_stays_even() {
        let image = glow(&Lens::new().expose(|_| (DVec3::new(1.0, 2.0, 3.0), 0)));
        assert!(image.iter().all(|c| (*c - Vec3A::new(1.0, 2.0, 3.0)).length() < 1e-4));
    }

    #[test]
    fn an_edge_is_covered_by_parts_and_the_glow_keeps_the_energy() {
        // A bright cap around +x, whose rim passes through pixels at all angles.
        let cap = |d: DVec3| (DVec3::splat(if d.x > 0.9 { 1.0 } else { 0.0 }), u32::from(d.x > 0.9));
        let image = Lens::new().expose(cap);
        assert!(image.iter().any(|c| c.x > 0.3 && c.x < 0.7));
        let energy = |value: &dyn Fn(usize) -> f64| -> f64 {
            let sine = |i: usize| libm::sin(std::f64::consts::PI * ((i / WIDTH) as f64 + 0.5) / HEIGHT as f64);
            (0..WIDTH * HEIGHT).map(|i| value(i) * sine(i)).sum::<f64>() / (0..WIDTH * HEIGHT).map(sine).sum::<f64>()
        };
        let before = energy(&|i| image[i].x);
        assert!((before - 0.05).abs() < 1e-5, "{before}");
        let glowing = glow(&image);
        let after = energy(&|i| f64::from(glowing[i].x));
        assert!((after / before - 1.0).abs() < 0.01, "{after}");
    }
}
