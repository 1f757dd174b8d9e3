//! Rectangular area lights sampled uniformly by solid angle.

use super::super::case::Case;
use super::inputs::short;
use crate::math::Real;
use crate::math::circular::Circular;
use crate::sampling::rectangle::{SphericalRectangle, solid_angle};
use etalon_stats::{Sample, Square, density, sampler};

/// Rectangles as viewed from the origin: sides in x and y, and distance of their plane.
const RECTANGLES: [(&str, [f64; 2], [f64; 2], f64); 7] = [
    ("facing", [-0.35, 0.35], [-0.25, 0.25], 1.5),
    ("aside", [0.5, 1.2], [-1.0, -0.4], 0.7),
    ("touching", [-0.35, 0.35], [-0.25, 0.25], 0.005),
    ("overhead", [-5.0, 4.0], [-3.0, 3.0], 0.01),
    ("small", [1.0, 1.01], [2.0, 2.01], 3.0),
    ("grazing", [10.0, 10.7], [0.0, 0.5], 0.1),
    ("strip", [-100.0, 100.0], [-0.01, 0.01], 1.0),
];

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, xs, ys, depth) in RECTANGLES {
        cases.push(rectangle::<f64>(format!("light/rectangle/{name}"), xs, ys, depth, |u| u));
        cases.push(rectangle::<f32>(format!("light/rectangle-f32/{name}"), xs, ys, depth, |u| f64::from(short(u))));
    }
    cases
}

/// The point on the rectangle, of pdf ∝ cos θ / r² with respect to area.
fn rectangle<T: Circular + Send + Sync + 'static>(
    name: String,
    xs: [f64; 2],
    ys: [f64; 2],
    depth: f64,
    random: fn(f64) -> f64,
) -> Case {
    Case::of(name, Square, move || {
        let [x0, x1] = xs;
        let [y0, y1] = ys;
        let viewed = SphericalRectangle::new(xs.map(T::from_f64), ys.map(T::from_f64), T::from_f64(depth));
        let draw = move |u: &[f64]| {
            let [x, y] = viewed.sample([T::from_f64(random(u[0])), T::from_f64(random(u[1]))]).map(Real::to_f64);
            // Position on the rectangle, from 0 to 1 along each side.
            let place = [(x - x0) / (x1 - x0), (y - y0) / (y1 - y0)];
            // In f32 the sides themselves are rounded.
            Some(Sample::new(place.map(|x| if (x - x.clamp(0.0, 1.0)).abs() < 1e-6 { x.clamp(0.0, 1.0) } else { x })))
        };
        // Uniform by solid angle: per area, the pdf is cos θ / r² over the solid angle.
        let scale = (x1 - x0) * (y1 - y0) * depth / solid_angle(xs, ys, depth);
        let pdf = move |[x, y]: [f64; 2]| {
            let (x, y) = (x0 + x * (x1 - x0), y0 + y * (y1 - y0));
            scale / (x * x + y * y + depth * depth).powf(1.5)
        };
        (sampler(2, draw), density(pdf))
    })
}
