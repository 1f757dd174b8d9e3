//! Intersection of a ray with a triangle, slivers included.

use super::directions::vector;
use super::family::{
    Bound, Family, Number, Range, STABLE, Scale, Section, TEXTBOOK, Value, Variant, cross, dot, minus, scalar, variant,
};
use crate::scene::{Mesh, MeshBvh, Ray};
use glam::Vec3;

/// The distance of the triangle along a ray; none if the ray misses.
pub const FAMILY: Family = Family {
    name: "triangle",
    about: "distance to a triangle from the origin",
    figure: "stability-geometry",
    inputs: &["ax", "ay", "az", "bx", "by", "bz", "cx", "cy", "cz", "dx", "dy", "dz"],
    domains: &[],
    sections: &[
        Section {
            title: "from plump to slivers",
            x: Scale::new("height / base", 1e-6, 1.0),
            y: Scale::new("base / distance", 1e-3, 1e3),
            at: |thin, size| aimed(thin, size, 0.8),
        },
        Section {
            title: "from ahead to edge-on",
            x: Scale::new("height / base", 1e-6, 1.0),
            y: Scale::new("cosine with the normal", 1e-6, 1.0),
            at: |thin, cos| aimed(thin, 1.0, cos),
        },
    ],
    edges: &[],
    reference: crossing,
    variants: &[Variant::single(STABLE, rendered), variant!(TEXTBOOK, crossing)],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(
        24.0,
        "3 of a sheared corner, 3 of each edge function, 9 of the sums, 9 of the distance",
    )],
    coarser: 1,
};

/// A triangle of base `size` at distance 1, and a direction that meets a point inside it at that angle.
fn aimed(thin: f64, size: f64, cos: f64) -> Vec<f64> {
    let direction = [0.36, 0.48, 0.8];
    let across = [0.8, -0.6, 0.0];
    let third: [f64; 3] = cross(direction, across);
    // In the plane: `across`, and a direction that is tilted against the ray.
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    let tilted: [f64; 3] = std::array::from_fn(|c| cos * third[c] + sin * direction[c]);
    let corner = |u: f64, v: f64| -> [f64; 3] {
        std::array::from_fn(|c| direction[c] + size * (u * across[c] + v * thin * tilted[c]))
    };
    [corner(-0.45, -0.4), corner(0.55, -0.3), corner(0.1, 0.6), direction].concat()
}

/// The corners, and the direction of the ray.
fn split<T: Number>(x: &[T]) -> [[T; 3]; 4] {
    std::array::from_fn(|i| vector(x, 3 * i))
}

fn rendered(x: &[f32]) -> Value<f32> {
    let [a, b, c, direction] = split(x).map(Vec3::from_array);
    let mesh = Mesh::new(vec![a, b, c], Vec::new(), vec![[0, 1, 2]]).ok()?;
    let ray = Ray { origin: Vec3::ZERO, direction };
    MeshBvh::build(&[&mesh]).nearest(&ray, f32::INFINITY).and_then(|hit| scalar(hit.t))
}

/// By Cramer's rule. Source: Möller & Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997.
fn crossing<T: Number>(x: &[T]) -> Value<T> {
    let [a, b, c, direction] = split(x);
    let (zero, one) = (T::of(0.0), T::of(1.0));
    // Edges and determinant; 0 for a ray parallel to the plane.
    let (e1, e2) = (minus(b, a), minus(c, a));
    let p = cross(direction, e2);
    let determinant = dot(e1, p);
    if determinant == zero {
        return None;
    }
    // Barycentric coordinates u and v, and the distance t.
    let from_a = a.map(|x| -x);
    let q = cross(from_a, e1);
    let (u, v) = (dot(from_a, p) / determinant, dot(direction, q) / determinant);
    let t = dot(e2, q) / determinant;
    if u >= zero && v >= zero && u + v <= one && t > zero { scalar(t) } else { None }
}
