//! The four bytes of a pixel: three mantissas and their exponent.

use crate::math::Rgb;

/// Widths that the newer run lengths can have; others are stored flat.
pub const RUN_WIDTHS: std::ops::RangeInclusive<usize> = 8..=0x7fff;

/// The linear value of a stored pixel.
pub fn linear([r, g, b, e]: [u8; 4]) -> Rgb {
    if e == 0 {
        return Rgb::ZERO;
    }
    // In f64, since the smallest values are subnormal in f32 and the factor alone would vanish.
    let unit = f64::from(i32::from(e) - 136).exp2();
    Rgb::from_array([r, g, b].map(|m| (f64::from(m) * unit) as f32))
}

/// The stored pixel nearest to `p`.
pub fn shared_exponent(p: Rgb) -> [u8; 4] {
    let [r, g, b] = p.to_array().map(|v| if v > 0.0 { f64::from(v) } else { 0.0 });
    let largest = r.max(g).max(b);
    if largest < 2.0_f64.powi(-128) {
        return [0; 4];
    }
    // The exponent that brings the largest channel to [128, 256); one more if it then rounds to 256. In f64 log2 is
    // exact enough that only powers of two matter, and those it gives exactly.
    let mut exponent = (largest.log2().floor() as i32).min(126) + 1;
    if (largest * f64::from(8 - exponent).exp2()).round() > 255.0 && exponent < 127 {
        exponent += 1;
    }
    let unit = f64::from(8 - exponent).exp2();
    // The cast saturates: beyond the range of the format the value becomes its largest.
    let [r, g, b] = [r, g, b].map(|v| (v * unit).round() as u8);
    [r, g, b, (exponent + 128) as u8]
}
