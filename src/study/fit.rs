//! Straight lines through points, and curves between them on logarithmic scales.

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
}
