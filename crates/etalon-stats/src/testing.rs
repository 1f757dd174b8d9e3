//! Vectors and samplers for the crate's own tests.
#![allow(dead_code, reason = "no test uses all of it")]

use std::f64::consts::{PI, TAU};

pub type Vector = [f64; 3];

/// The linear combination Σ cᵢ vᵢ.
pub fn combine(terms: [(f64, Vector); 3]) -> Vector {
    [0, 1, 2].map(|i| terms.iter().map(|(c, v)| c * v[i]).sum())
}

pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn length(v: Vector) -> f64 {
    dot(v, v).sqrt()
}

pub fn normalize(v: Vector) -> Vector {
    let length = length(v);
    v.map(|x| x / length)
}

pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Two unit vectors perpendicular to `axis` and to each other.
pub fn tangents(axis: Vector) -> [Vector; 2] {
    let t = normalize(cross(axis, if axis[2].abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] }));
    [t, cross(axis, t)]
}

/// Uniform over the hemisphere around +z; pdf 1/2π.
pub fn uniform_hemisphere(u: &[f64]) -> Vector {
    let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
    let sin = (u[0] * (2.0 - u[0])).sqrt();
    [sin * cos_phi, sin * sin_phi, 1.0 - u[0]]
}

/// A normal of Beckmann's distribution: tan² θ/α² is exponentially distributed.
pub fn beckmann(alpha: f64, u: &[f64]) -> Vector {
    let tan = alpha * (-(1.0 - u[0]).ln()).sqrt();
    let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
    normalize([tan * cos_phi, tan * sin_phi, 1.0])
}

/// The pdf of [`beckmann`]: D(m) cos θ.
pub fn beckmann_pdf(alpha: f64, m: Vector) -> f64 {
    let tan2 = (m[0] * m[0] + m[1] * m[1]) / (m[2] * m[2]);
    if m[2] > 0.0 { (-tan2 / (alpha * alpha)).exp() / (PI * alpha * alpha * m[2].powi(3)) } else { 0.0 }
}

/// A visible normal of GGX seen from `wo`. Source: Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018.
pub fn ggx_visible(wo: Vector, alpha: f64, u: [f64; 2]) -> Vector {
    // Stretch to the hemisphere of alpha = 1, sample its projected area, unstretch.
    let v = normalize([alpha * wo[0], alpha * wo[1], wo[2]]);
    let t1 = if v[0] == 0.0 && v[1] == 0.0 { [1.0, 0.0, 0.0] } else { normalize([-v[1], v[0], 0.0]) };
    let t2 = cross(v, t1);
    let (r, phi) = (u[0].sqrt(), TAU * u[1]);
    let p1 = r * phi.cos();
    let s = 0.5 * (1.0 + v[2]);
    let p2 = (1.0 - s) * (1.0 - p1 * p1).sqrt() + s * r * phi.sin();
    let n = combine([(p1, t1), (p2, t2), ((1.0 - p1 * p1 - p2 * p2).max(0.0).sqrt(), v)]);
    normalize([alpha * n[0], alpha * n[1], n[2].max(0.0)])
}

/// The pdf of [`ggx_visible`]: G₁(wo) max(0, wo·wm) D(wm) / cos θₒ.
pub fn ggx_visible_pdf(wo: Vector, alpha: f64, wm: Vector) -> f64 {
    let a2 = alpha * alpha;
    let e = (wm[0] * wm[0] + wm[1] * wm[1]) / a2 + wm[2] * wm[2];
    let d = 1.0 / (PI * a2 * e * e);
    let tan2 = (wo[0] * wo[0] + wo[1] * wo[1]) / (wo[2] * wo[2]);
    let g1 = 2.0 / (1.0 + (1.0 + a2 * tan2).sqrt());
    g1 * dot(wo, wm).max(0.0) * d / wo[2]
}
