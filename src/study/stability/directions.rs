//! Inputs that several families share: directions, their scales, and sin² θ by two formulas.

use super::family::Scale;
use super::number::Number;

/// Cosines from grazing to normal incidence.
pub const COSINE: Scale = Scale::new("cos /{θ}", 1e-12, 1.0);

/// Widths of microfacet distributions, from almost smooth to rougher than any material.
pub const ALPHA: Scale = Scale::new("/{α}", 1e-5, 10.0);

/// The unit vector of that cos θ, off all symmetries in azimuth.
pub fn of_cosine(cos: f64) -> [f64; 3] {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    [0.6 * sin, 0.8 * sin, cos]
}

/// The unit vector of that tan θ.
pub fn of_slope(tan: f64) -> [f64; 3] {
    let cos = (1.0 + tan * tan).sqrt().recip();
    [0.6 * tan * cos, 0.8 * tan * cos, cos]
}

/// A number and the components of a vector, as inputs of a family.
pub fn with(number: f64, [x, y, z]: [f64; 3]) -> Vec<f64> {
    vec![number, x, y, z]
}

/// The vector whose components start at input `first`.
pub fn vector<T: Number>(inputs: &[T], first: usize) -> [T; 3] {
    std::array::from_fn(|c| inputs[first + c])
}

/// sin² θ = x² + y², without cancellation.
pub fn sin2_from_xy<T: Number>(w: [T; 3]) -> T {
    w[0].square() + w[1].square()
}

/// sin² θ = 1 − cos² θ, as books and most renderers have it.
pub fn sin2_from_z<T: Number>(w: [T; 3]) -> T {
    T::of(1.0) - w[2].square()
}
