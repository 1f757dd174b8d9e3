//! Tone mapping: the display transform with which the second report's images were made.

/// The 8-bit value of a linear one ≥ 0: clamp((√2 · L)^(1/2.2), 0, 1) · 255, truncated (the CS184 path tracer).
///
/// Right is the sRGB curve, rounded to the nearest.
#[must_use]
pub fn encode(value: f32) -> u8 {
    ((std::f32::consts::SQRT_2 * value).powf(1.0 / 2.2).min(1.0) * 255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::encode;

    #[test]
    fn values_are_truncated() {
        assert_eq!(encode(0.384), 193);
        assert_eq!(encode(0.38), 192, "192.26");
        assert_eq!((encode(0.71), encode(0.7)), (255, 253));
        assert_eq!((encode(0.0), encode(f32::INFINITY)), (0, 255));
    }
}
