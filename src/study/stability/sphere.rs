//! Intersection of a ray with a sphere.

use super::directions::vector;
use super::family::{
    Bound, Family, Number, POSITIVE, Range, STABLE, Scale, Section, TEXTBOOK, Value, Variant, dot, scalar, variant,
};
use crate::scene::Sphere;
use glam::Vec3;

/// The distance of the nearest point of the sphere along a ray; none if the ray misses.
pub const FAMILY: Family = Family {
    name: "sphere",
    about: "distance to a sphere from the origin",
    figure: "stability-geometry",
    inputs: &["radius", "x", "y", "z", "dx", "dy", "dz"],
    domains: &[POSITIVE],
    sections: &[
        Section {
            title: "by its size and the distance from its silhouette",
            x: Scale::new("radius / distance of the centre", 1e-6, 1e6),
            y: Scale::new("1 − /{b} / /{b}_{max}", 1e-6, 1.0),
            at: |radius, inside| aimed(radius, 1.0, (1.0 - inside) * radius.min(1.0)),
        },
        Section {
            title: "from near its surface",
            x: Scale::new("radius", 1e-6, 1e6),
            y: Scale::new("height above it / radius", 1e-6, 1.0),
            at: |radius, height| aimed(radius, radius * (1.0 + height), 0.3 * radius),
        },
    ],
    edges: &[&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], &[1.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0]],
    reference: quadratic,
    variants: &[Variant::single(STABLE, rendered), variant!(TEXTBOOK, quadratic)],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(20.0, "5 of b, 8 of the discriminant, 5 of c, 2 of the root and the quotient")],
    coarser: 1,
};

/// A sphere at that distance, and a direction that passes its centre at the distance `aside`.
fn aimed(radius: f64, distance: f64, aside: f64) -> Vec<f64> {
    let (towards, across) = ([0.36, 0.48, 0.8], [0.8, -0.6, 0.0]);
    let sin = aside / distance;
    let cos = ((1.0 - sin) * (1.0 + sin)).sqrt();
    let centre = towards.map(|w| w * distance);
    let direction: [f64; 3] = std::array::from_fn(|c| cos * towards[c] + sin * across[c]);
    [&[radius][..], &centre, &direction].concat()
}

fn rendered(x: &[f32]) -> Value<f32> {
    let sphere = Sphere { centre: vector(x, 1).into(), radius: x[0] };
    let t = sphere.distance(Vec3::ZERO, vector(x, 4).into());
    if t.is_infinite() { None } else { scalar(t) }
}

/// The smaller root of a t² + b t + c = 0, or the larger where that lies behind: (−b ± √(b² − 4ac)) / 2a.
fn quadratic<T: Number>(x: &[T]) -> Value<T> {
    let (centre, direction) = (vector(x, 1), vector(x, 4));
    let (zero, two) = (T::of(0.0), T::of(2.0));
    // Coefficients of the quadratic equation, and its discriminant.
    let (a, b) = (dot(direction, direction), -two * dot(direction, centre));
    let discriminant = b.square() - T::of(4.0) * a * (dot(centre, centre) - x[0].square());
    if discriminant < zero {
        return None;
    }
    let root = discriminant.sqrt();
    let [near, far] = [-b - root, -b + root].map(|t| t / (two * a));
    let t = if near >= zero { near } else { far };
    if t >= zero { scalar(t) } else { None }
}
