//! Straight lines through points, and curves between them on logarithmic scales.

use etalon_stats::estimate::Estimate;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// The slope of the least-squares line through (x, y); NaN with fewer than two different x.
pub fn slope(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / n;
    let (mx, my) = (mean(0), mean(1));
    // Sums of squares and products about the means.
    let (mut xx, mut xy) = (0.0, 0.0);
    for [x, y] in points {
        xx += (x - mx) * (x - mx);
        xy += (x - mx) * (y - my);
    }
    xy / xx
}

/// The slope of the line through (ln x, ln y), the exponent p of y ∝ xᵖ; points without logarithms are left out.
pub fn log_log_slope(points: &[[f64; 2]]) -> f64 {
    let usable = points.iter().filter(|p| p.iter().all(|v| *v > 0.0 && v.is_finite()));
    slope(&usable.map(|p| p.map(f64::ln)).collect::<Vec<_>>())
}

/// y at `x` by the straight line between neighbours of (ln x, ln y), x rising; `None` beyond the ends.
pub fn log_log_at(points: &[[f64; 2]], x: f64) -> Option<f64> {
    let pair = points.windows(2).find(|pair| (pair[0][0]..=pair[1][0]).contains(&x))?;
    let [[x0, y0], [x1, y1]] = [pair[0], pair[1]].map(|p| p.map(f64::ln));
    let y = if x1 > x0 { y0 + (y1 - y0) * (x.ln() - x0) / (x1 - x0) } else { y1 };
    Some(y.exp()).filter(|y| y.is_finite())
}

/// a and b of y = a + b x by least squares with weights 1/y², for errors in proportion to y; at least three points with y > 0.
///
/// The errors come from the residuals: s² = Σ w (y − a − b x)² / (n − 2), Var b = s² / Σ w (x − x̄)², Var a = s² / Σ w + x̄² Var b,
/// with x̄ the weighted mean; intervals by Student's t of n − 2 degrees of freedom.
pub fn relative_line(points: &[[f64; 2]]) -> Option<[Estimate; 2]> {
    let freedom = points.len().checked_sub(2).filter(|freedom| *freedom > 0)? as f64;
    if !points.iter().all(|[x, y]| x.is_finite() && *y > 0.0 && y.is_finite()) {
        return None;
    }
    let sum = |f: &dyn Fn(f64, f64) -> f64| points.iter().map(|[x, y]| f(*x, *y) / (y * y)).sum::<f64>();
    let all = sum(&|_, _| 1.0);
    let (mx, my) = (sum(&|x, _| x) / all, sum(&|_, y| y) / all);
    let xx = sum(&|x, _| (x - mx) * (x - mx));
    let b = sum(&|x, y| (x - mx) * (y - my)) / xx;
    let a = my - b * mx;
    let variance = sum(&|x, y| (y - a - b * x).powi(2)) / freedom;
    let t = StudentsT::new(0.0, 1.0, freedom).ok()?.inverse_cdf(0.975);
    let estimate = |value: f64, variance: f64| {
        let standard_error = variance.sqrt();
        Estimate { value, half_width: t * standard_error, standard_error }
    };
    let of_b = variance / xx;
    b.is_finite().then(|| [estimate(a, variance / all + mx * mx * of_b), estimate(b, of_b)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_by_hand() {
        assert!((slope(&[[0.0, 1.0], [1.0, 1.0], [2.0, 4.0]]) - 1.5).abs() < 1e-15);
        assert!(slope(&[[1.0, 1.0]]).is_nan() && slope(&[]).is_nan());
        let power: Vec<[f64; 2]> = (1..9).map(|i| f64::from(i).exp2()).map(|x| [x, 3.0 * x.powf(-0.75)]).collect();
        assert!((log_log_slope(&power) + 0.75).abs() < 1e-12);
        let with_holes = [power.clone(), vec![[1e9, -1.0], [1e9, f64::NAN]]].concat();
        assert!((log_log_slope(&with_holes) + 0.75).abs() < 1e-12, "what has no logarithm is left out");
    }

    #[test]
    fn between_points_a_power_law_is_a_straight_line() {
        let points = [[1.0, 10.0], [4.0, 5.0], [16.0, 2.5]];
        assert!((log_log_at(&points, 2.0).unwrap() - 10.0 / 2.0_f64.sqrt()).abs() < 1e-12);
        assert!((log_log_at(&points, 16.0).unwrap() - 2.5).abs() < 1e-12);
        assert!(log_log_at(&points, 17.0).is_none() && log_log_at(&points, 0.5).is_none());
    }

    #[test]
    fn a_line_is_found_with_its_errors() {
        let exact: Vec<[f64; 2]> = [1.0, 4.0, 16.0].map(|x| [x, 1.5 + 0.25 * x]).into();
        let [a, b] = relative_line(&exact).unwrap();
        assert!((a.value - 1.5).abs() < 1e-12 && (b.value - 0.25).abs() < 1e-12 && a.half_width < 1e-6);
        assert!(relative_line(&exact[..2]).is_none() && relative_line(&[[1.0, 1.0]; 4]).is_none());
        // About 95 % of the intervals of many noisy lines hold the truth.
        let mut held = [0; 2];
        for trial in 0..400_u32 {
            let noise = |i: u32| {
                let uniform =
                    |k: u32| f64::from((trial * 97 + i * 13 + k).wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24);
                (0..12).map(uniform).sum::<f64>() - 6.0
            };
            let point = |i: u32| {
                let x = f64::from(4_u32.pow(i % 4));
                [x, (1.5 + 0.25 * x) * (1.0 + 0.03 * noise(i))]
            };
            let [a, b] = relative_line(&(0..16).map(point).collect::<Vec<_>>()).unwrap();
            held[0] += u32::from((a.value - 1.5).abs() < a.half_width);
            held[1] += u32::from((b.value - 0.25).abs() < b.half_width);
        }
        assert!(held.iter().all(|held| (360..=396).contains(held)), "{held:?} of 400");
    }
}
