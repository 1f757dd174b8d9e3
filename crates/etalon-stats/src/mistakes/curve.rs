//! Samples on a curve: one of two coordinates is a function of the other, as where one random number is used for both.
//!
//! Let samples be sorted by one coordinate, and let V be the sum of the differences of their neighbours' ranks in the other, over their
//! number n. Chatterjee's coefficient is ξ = 1 − 3V/n. Of independent coordinates V is n/3; of a function it is the sum of its rises and
//! falls, by any n; and noise adds in proportion to n. Source: Chatterjee, "A New Coefficient of Correlation", Journal of the American
//! Statistical Association 116(536), 2021.

/// Fewer samples are not looked at.
const FEWEST: usize = 256;
/// The share of samples that V is compared with, and how much larger it may be of all: noise would make it four times as large.
const SHARE: usize = 4;
const MOST: f64 = 1.5;
/// The least V of a function that takes many values.
const LEAST: f64 = 0.9;

/// V of the coordinate other than `axis`, by samples that are sorted by `axis`.
fn variation(charts: &[[f64; 2]], axis: usize) -> f64 {
    let mut sorted = charts.to_vec();
    sorted.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
    let mut values: Vec<f64> = charts.iter().map(|at| at[1 - axis]).collect();
    values.sort_by(f64::total_cmp);
    let rank = |at: &[f64; 2]| values.partition_point(|value| *value < at[1 - axis]);
    let differences = sorted.windows(2).map(|both| rank(&both[0]).abs_diff(rank(&both[1])));
    differences.sum::<usize>() as f64 / charts.len() as f64
}

/// The number of a coordinate that is a function of the other one, beyond doubt, of independent samples at these chart coordinates.
pub fn of(charts: &[[f64; 2]]) -> Option<usize> {
    let few = &charts[..charts.len() / SHARE];
    let is_function = |axis: &usize| {
        let (of_all, of_few) = (variation(charts, 1 - axis), variation(few, 1 - axis));
        of_all >= LEAST && of_all <= MOST * of_few
    };
    [1, 0].into_iter().filter(|_| charts.len() >= FEWEST).find(is_function)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::mix64;

    /// Chart coordinates by pairs of random numbers.
    fn charts(n: u64, of: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<[f64; 2]> {
        let random = |i: u64| (mix64(i) >> 11) as f64 / (1u64 << 53) as f64;
        (0..n).map(|i| of([random(2 * i), random(2 * i + 1)])).collect()
    }

    #[test]
    fn functions_are_told_and_correlations_are_not() {
        for n in [256, 1000, 1 << 14] {
            assert_eq!(of(&charts(n, |[u, _]| [u, u])), Some(1));
            assert_eq!(of(&charts(n, |[u, _]| [1.0 - u, (3.0 * u).fract()])), Some(1), "three turns");
            assert_eq!(of(&charts(n, |[u, _]| [4.0 * u * (1.0 - u), u])), Some(0), "two values of u for each x");
            assert_eq!(of(&charts(n, |[u, v]| [u, v])), None);
            // A constant, few values, noise of 1 %, one in ten off the curve, and a curve of two values for both
            assert_eq!(of(&charts(n, |[u, _]| [u, 0.5])), None);
            assert_eq!(of(&charts(n, |[u, v]| [u, (4.0 * v).floor()])), None);
            assert_eq!(of(&charts(n, |[u, v]| [u, 0.99 * u + 0.01 * v])), None, "{n}");
            assert_eq!(of(&charts(n, |[u, v]| [u, if v < 0.1 { 10.0 * v } else { u }])), None);
            let circle = |u: f64| (std::f64::consts::TAU * u).sin_cos();
            assert_eq!(of(&charts(n, |[u, _]| [circle(u).0, circle(u).1])), None);
        }
    }

    #[test]
    fn independent_coordinates_are_never_on_a_curve() {
        for seed in 0..2000 {
            assert_eq!(of(&charts(256, |[u, v]| [(u + f64::from(seed) * 0.618).fract(), v * (1.0 + u)])), None);
        }
    }
}
