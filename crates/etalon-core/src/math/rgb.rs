//! Colours: three channels of linear light.

/// Linear RGB: radiance, reflectance or power, by context.
pub type Rgb = glam::Vec3;

/// (R + G + B) / 3, in f64: the scalar that importance sampling weighs a colour by. It keeps more of saturated light than
/// luminance does.
#[inline]
#[must_use]
pub fn mean_rgb(rgb: Rgb) -> f64 {
    let rgb = rgb.as_dvec3();
    (rgb.x + rgb.y + rgb.z) / 3.0
}
