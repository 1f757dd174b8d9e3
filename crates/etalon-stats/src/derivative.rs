//! Derivatives of a sampler's map from random numbers to points, by finite differences.

use crate::extremes::Extremes;

/// Steps at which differences are taken: 2^-3, 2^-4, … Each is also the half of the one before.
pub const STEPS: usize = 12;
const LARGEST: i32 = 3;
/// Random numbers are multiples of this, so that steps from them are exact in single precision.
const RASTER: f64 = (1u64 << 16) as f64;
/// Rounding of a derivative times its step: three times that of a sampled direction, in units of the last place of 1.
const ROUNDING: f64 = 12.0;

/// A derivative and the bound of its error.
#[derive(Clone, Copy)]
pub struct Derivative<const N: usize> {
    pub value: [f64; N],
    pub error: f64,
}

/// A random number from which steps are exact.
pub fn on_raster(u: f64) -> f64 {
    (u * RASTER).floor() / RASTER
}

fn step(i: usize) -> f64 {
    0.5f64.powi(LARGEST + i as i32)
}

/// Whether both ends of a step from `u` are random numbers.
fn is_inside(u: f64, step: f64) -> bool {
    u >= step && u + step < 1.0
}

/// The random numbers `u` with the one of `axis` moved backwards and forwards by each step; where that leaves 0 to 1, not moved.
pub fn moved(u: &[f64], axis: usize) -> Vec<f64> {
    let steps = (0..STEPS).map(|i| if is_inside(u[axis], step(i)) { step(i) } else { 0.0 });
    let moves = steps.flat_map(|step| [-step, step]);
    moves.flat_map(|by| u.iter().enumerate().map(move |(i, &u)| if i == axis { u + by } else { u })).collect()
}

/// The derivative at `u` from the places before and after each step: see [`moved`].
///
/// Central differences at several steps are extrapolated to step 0 (Richardson); of these the one with the smallest error counts, where the
/// error is the change by extrapolation, rounding over the step, and the distance from the values of the next steps.
pub fn derivative<const N: usize>(u: f64, places: &[Option<[f64; N]>], precision: f64) -> Option<Derivative<N>> {
    let central = |(i, both): (usize, &[Option<[f64; N]>])| {
        let (before, after) = (both[0]?, both[1].filter(|_| is_inside(u, step(i)))?);
        Some(std::array::from_fn(|axis| (after[axis] - before[axis]) / (2.0 * step(i))))
    };
    let slopes: Vec<Option<[f64; N]>> = places.chunks_exact(2).enumerate().map(central).collect();
    let of_step = |(i, slopes): (usize, &[Option<[f64; N]>])| {
        let (coarse, fine) = (slopes[0]?, slopes[1]?);
        let value: [f64; N] = std::array::from_fn(|axis| fine[axis] + (fine[axis] - coarse[axis]) / 3.0);
        Some(Derivative { value, error: distance(value, fine) + ROUNDING * precision / step(i) })
    };
    let all: Vec<Derivative<N>> = slopes.windows(2).enumerate().filter_map(of_step).collect();
    let (best, &Derivative { value, error }) = all.iter().enumerate().min_by(|a, b| a.1.error.total_cmp(&b.1.error))?;
    // Rounding that is larger than expected shows in the next steps.
    let next = [best.checked_sub(1), best.checked_add(1)].into_iter().flatten().filter_map(|i| all.get(i));
    let spread = next.map(|other| distance(value, other.value)).fold(0.0, f64::at_least);
    Some(Derivative { value, error: error + spread })
}

fn distance<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}
