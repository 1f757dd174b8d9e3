//! Colour scales of equal steps to the eye: one from dark to light, one with a neutral middle.
//!
//! Both are straight lines of lightness in Oklab (Björn Ottosson, 2020), with hue and chroma as plain functions of the
//! position, chosen to stay inside sRGB.

use super::shapes::Colour;

/// Sequential scale: `t` from 0 (dark purple) over teal to 1 (light yellow). Outside values take the nearest end, NaN
/// takes the dark one.
pub fn sequential(t: f64) -> Colour {
    let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
    let chroma = 0.085 + 0.04 * (1.0 - t).powi(3) + 0.09 * t.powi(4);
    oklch(0.25 + 0.67 * t, chroma, 310.0 - 205.0 * t)
}

/// Diverging scale: `t` from −1 (blue) over 0 (nearly white) to 1 (red), equally dark at both ends. Outside values take
/// the nearest end, NaN takes the middle.
pub fn diverging(t: f64) -> Colour {
    let t = if t.is_nan() { 0.0 } else { t.clamp(-1.0, 1.0) };
    oklch(0.96 - 0.5 * t.abs(), 0.15 * t.abs(), if t < 0.0 { 255.0 } else { 30.0 })
}

/// Oklab in polar form to sRGB; hue in degrees.
fn oklch(lightness: f64, chroma: f64, hue: f64) -> Colour {
    let byte = |v: f64| (encode(v) * 255.0).round() as u8;
    let [r, g, b] = linear_rgb(lightness, chroma, hue);
    Colour::rgb(byte(r), byte(g), byte(b))
}

fn linear_rgb(lightness: f64, chroma: f64, hue: f64) -> [f64; 3] {
    let (sin, cos) = hue.to_radians().sin_cos();
    let (a, b) = (chroma * cos, chroma * sin);
    // Oklab to cone responses, their cubes to linear sRGB
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

/// The sRGB transfer curve.
fn encode(linear: f64) -> f64 {
    let v = linear.clamp(0.0, 1.0);
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE lightness, 0 to 100.
    fn lightness(c: Colour) -> f64 {
        let linear = |v: u8| {
            let v = f64::from(v) / 255.0;
            if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
        };
        let y = 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
        116.0 * y.cbrt() - 16.0
    }

    #[test]
    fn lightness_follows_the_scale() {
        let steps: Vec<f64> = (0..=10).map(|i| f64::from(i) / 10.0).collect();
        for pair in steps.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|t| lightness(sequential(t)));
            assert!((5.0..11.0).contains(&(to - from)), "{pair:?}: {from} to {to}");
        }
        for t in steps {
            assert!((lightness(diverging(t)) - lightness(diverging(-t))).abs() < 5.0, "{t}");
        }
        assert!(lightness(diverging(0.0)) > 94.0);
    }

    #[test]
    fn both_scales_stay_inside_srgb() {
        for t in (0..=200).map(|i| f64::from(i) / 200.0) {
            let chroma = 0.085 + 0.04 * (1.0 - t).powi(3) + 0.09 * t.powi(4);
            let [dark, light] = [(0.25 + 0.67 * t, chroma, 310.0 - 205.0 * t), (0.96 - 0.5 * t, 0.15 * t, 255.0)];
            for (lightness, chroma, hue) in [dark, light, (light.0, light.1, 30.0)] {
                let colour = linear_rgb(lightness, chroma, hue);
                assert!(colour.iter().all(|v| (-1e-3..=1.001).contains(v)), "{t}: {colour:?}");
            }
        }
    }

    #[test]
    fn values_that_are_off_the_scale_take_an_end() {
        assert_eq!([-3.0, f64::NAN].map(sequential), [sequential(0.0); 2]);
        assert_eq!(sequential(f64::INFINITY), sequential(1.0));
        assert_eq!(diverging(f64::NEG_INFINITY), diverging(-1.0));
    }
}
