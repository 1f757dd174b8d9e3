//! Images: the first report's rows of environment maps, and its course's texels; the display transform with which the second
//! report's images were made.

use std::f64::consts::PI;

/// The first report's weight of row h of H, sin(hπ/(H−1)), with the exact zero at both ends that the formula means.
///
/// Right is the row's solid angle, cos(hπ/H) − cos((h+1)π/H). The first and the last row are never sampled, however
/// bright they are, and every other weight has an error of up to 1/(2h+1).
pub fn row_weight(row: usize, rows: usize) -> f64 {
    if row == 0 || row + 1 == rows { 0.0 } else { (row as f64 * PI / (rows - 1) as f64).sin() }
}

/// The pdf per solid angle that goes with [`row_weight`]: the texel's probability over its solid angle as the weight has
/// it, 2π² w/(width · height); 0 where the weight is.
pub fn texel_pdf(probability: f64, weight: f64, [width, height]: [usize; 2]) -> f64 {
    if weight == 0.0 { 0.0 } else { probability * width as f64 * height as f64 / (2.0 * PI * PI * weight) }
}

/// Where in a texel the course's renderer takes the direction, in texels from the upper left corner: the corner itself, half
/// a texel from the centre, and one of finitely many directions.
pub const PLACE_IN_TEXEL: [f64; 2] = [0.0, 0.0];

/// The median pixel as the first report's formula prints it: the first at which the running sum of the energies is their total,
/// which is the last that has any; its text says half of the total.
pub fn median_without_half(energies: &[f64]) -> usize {
    energies.iter().rposition(|e| *e > 0.0).unwrap_or(0)
}

/// The row that the first report's text selects: the first whose value is at least `u`, of values that it calls a cumulative
/// distribution function and that are the rows' probabilities, not summed up.
///
/// Right is the first whose sum with all rows before is at least `u`. Most numbers select no row.
pub fn row_without_sums(probabilities: &[f64], u: f64) -> Option<usize> {
    probabilities.iter().position(|p| *p >= u)
}

/// The 8-bit value of a linear one ≥ 0: clamp((√2 · L)^(1/2.2), 0, 1) · 255, truncated (the CS184 path tracer).
///
/// Right is the sRGB curve, rounded to the nearest.
pub fn display_value(value: f32) -> u8 {
    ((std::f32::consts::SQRT_2 * value).powf(1.0 / 2.2).min(1.0) * 255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_sums_only_rows_above_all_before_are_selected() {
        let rows = |u: f64| row_without_sums(&[0.2, 0.1, 0.5, 0.2], u);
        assert_eq!([rows(0.1), rows(0.2), rows(0.3), rows(0.6)], [Some(0), Some(0), Some(2), None]);
    }

    #[test]
    fn without_the_half_all_energy_is_on_one_side() {
        assert_eq!(median_without_half(&[1.0, 2.0, 3.0, 0.0]), 2);
        assert_eq!(median_without_half(&[0.0; 3]), 0);
    }

    #[test]
    fn the_poles_have_no_weight_and_the_others_nearly_theirs() {
        assert_eq!([row_weight(0, 8), row_weight(7, 8)], [0.0, 0.0]);
        assert_eq!(texel_pdf(0.1, 0.0, [16, 8]), 0.0);
        // A uniform map of many rows: nearly 1/4π away from the poles.
        let (width, height) = (16, 2000);
        let total: f64 = (0..height).map(|y| row_weight(y, height)).sum::<f64>() * width as f64;
        let weight = row_weight(700, height);
        let pdf = texel_pdf(weight / total, weight, [width, height]);
        assert!((pdf * 4.0 * PI - 1.0).abs() < 1e-3, "{pdf}");
    }

    #[test]
    fn values_are_truncated() {
        assert_eq!(display_value(0.384), 193);
        assert_eq!(display_value(0.38), 192, "192.26");
        assert_eq!((display_value(0.71), display_value(0.7)), (255, 253));
        assert_eq!((display_value(0.0), display_value(f32::INFINITY)), (0, 255));
    }
}
