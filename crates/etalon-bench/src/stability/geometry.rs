//! Families of formulas of geometry: the facet that reflects one direction into another, and rays that meet a sphere or a triangle.

use super::family::*;
use etalon_core::bsdf::Facet;
use etalon_core::scene::{Bvh, Mesh, Ray, Shape, Sphere};
use glam::Vec3;

pub const HALF_VECTOR: Family = Family {
    name: "half-vector",
    about: "normal of the facet between nearly opposite directions",
    figure: "stability-geometry",
    inputs: &["wo_x", "wo_y", "wo_z", "wi_x", "wi_y", "wi_z"],
    domains: &[],
    sections: &[Section {
        title: "opposite azimuths, both near the horizon",
        x: Scale::new("cos /{θ}_{o}", 1e-10, 1.0),
        y: Scale::new("cos /{θ}_{i}", 1e-10, 1.0),
        at: |o, i| {
            let sin = |cos: f64| ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
            // Azimuths that are not exactly opposite: rounding errors would otherwise cancel alike in x and y.
            vec![0.6 * sin(o), 0.8 * sin(o), o, -0.600_000_8 * sin(i), -0.799_999_4 * sin(i), i]
        },
    }],
    edges: &[&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0], &[0.6, 0.0, 0.8, -0.6, 0.0, 0.8]],
    reference: |x| above_surface(x).then(|| half_vector(x)).flatten(),
    variants: &[Variant::single(STABLE, |x| facet(x).map(|facet| facet.wm)), variant!(TEXTBOOK, half_vector)],
    range: Range::Unit,
    bounds: &[Bound::roundings(8.0, "3 of the sum, 4 of its length, 1 of the quotient")],
    coarser: 1,
};

pub const HALF_COSINE: Family = Family {
    name: "half-cosine",
    about: "cosine of nearly opposite directions with the facet between them",
    reference: |x| above_surface(x).then(|| scalar(dot(sum(x), sum(x)).sqrt() / Number::of(2.0))).flatten(),
    variants: &[
        Variant::single(STABLE, |x| facet(x).and_then(|facet| scalar(facet.cos))),
        variant!(TEXTBOOK, |x| scalar(dot(vector(x, 0), normalized(sum(x))))),
    ],
    range: Range::UpTo(1.0),
    bounds: &[Bound::roundings(8.0, "3 of the sum, 4 of its length, 1 of the half")],
    ..HALF_VECTOR
};

/// Whether both directions are above the surface: else no facet is between them.
fn above_surface<T: Number>(x: &[T]) -> bool {
    x[2] > T::of(0.0) && x[5] > T::of(0.0)
}

fn sum<T: Number>(x: &[T]) -> [T; 3] {
    let [wo, wi] = [vector(x, 0), vector(x, 3)];
    std::array::from_fn(|c| wo[c] + wi[c])
}

fn facet(x: &[f32]) -> Option<Facet> {
    Facet::between(vector(x, 0).into(), vector(x, 3).into())
}

fn half_vector<T: Number>(x: &[T]) -> Value<T> {
    Some(normalized(sum(x)))
}

/// The distance of the nearest point of the sphere along a ray; none if the ray misses.
pub const SPHERE: Family = Family {
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
            at: |radius, inside| at_sphere(radius, 1.0, (1.0 - inside) * radius.min(1.0)),
        },
        Section {
            title: "from near its surface",
            x: Scale::new("radius", 1e-6, 1e6),
            y: Scale::new("height above it / radius", 1e-6, 1.0),
            at: |radius, height| at_sphere(radius, radius * (1.0 + height), 0.3 * radius),
        },
    ],
    edges: &[&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], &[1.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0]],
    reference: quadratic,
    variants: &[Variant::single(STABLE, to_sphere), variant!(TEXTBOOK, quadratic)],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(20.0, "5 of b, 8 of the discriminant, 5 of c, 2 of the root and the quotient")],
    coarser: 1,
};

/// A sphere at that distance, and a direction that passes its centre at the distance `aside`.
fn at_sphere(radius: f64, distance: f64, aside: f64) -> Vec<f64> {
    let (towards, across) = ([0.36, 0.48, 0.8], [0.8, -0.6, 0.0]);
    let sin = aside / distance;
    let cos = ((1.0 - sin) * (1.0 + sin)).sqrt();
    let centre = towards.map(|w| w * distance);
    let direction: [f64; 3] = std::array::from_fn(|c| cos * towards[c] + sin * across[c]);
    [&[radius][..], &centre, &direction].concat()
}

fn to_sphere(x: &[f32]) -> Value<f32> {
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

/// The distance of the triangle along a ray; none if the ray misses.
pub const TRIANGLE: Family = Family {
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
            at: |thin, size| at_triangle(thin, size, 0.8),
        },
        Section {
            title: "from ahead to edge-on",
            x: Scale::new("height / base", 1e-6, 1.0),
            y: Scale::new("cosine with the normal", 1e-6, 1.0),
            at: |thin, cos| at_triangle(thin, 1.0, cos),
        },
    ],
    edges: &[],
    reference: crossing,
    variants: &[Variant::single(STABLE, to_triangle), variant!(TEXTBOOK, crossing)],
    range: Range::UpTo(f64::MAX),
    bounds: &[Bound::roundings(
        24.0,
        "3 of a sheared corner, 3 of each edge function, 9 of the sums, 9 of the distance",
    )],
    coarser: 1,
};

/// A triangle of base `size` at distance 1, and a direction that meets a point inside it at that angle.
fn at_triangle(thin: f64, size: f64, cos: f64) -> Vec<f64> {
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

fn to_triangle(x: &[f32]) -> Value<f32> {
    let [a, b, c, direction] = split(x).map(Vec3::from_array);
    let mesh = Mesh::new(vec![a, b, c], Vec::new(), vec![[0, 1, 2]]).ok()?;
    let ray = Ray { origin: Vec3::ZERO, direction };
    Bvh::build(&[&Shape::from(mesh)]).nearest(&ray, f32::INFINITY).and_then(|hit| scalar(hit.t))
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
