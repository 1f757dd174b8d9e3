//! The two vectorized stages of a diffuse hit: rays towards a light, and the directions in which the paths go on.

use super::lanes::{LANES, Lane, Lane3, Paths, Points, Shadows, ZERO3, at, set};
use super::lights::{self, LightSamples, Sampled};
use super::wide::{Wide, wide};
use crate::math::Frame;
use crate::math::circular::Circular;
use glam::Vec3;
use pulp::Arch;
use std::f32::consts::FRAC_1_PI;

/// Fills `shadows` with one ray per point towards a light, valued by `scale` · weight / π · cos · light.
pub fn towards_light(arch: Arch, points: &Points, light: &Sampled, u: &[Lane; 2], scale: f32, shadows: &mut Shadows) {
    shadows.count = points.count;
    shadows.slot = points.slot;
    shadows.path_class = points.path_class;
    let mut sampled = LightSamples::default();
    lights::sample_many(arch, light, &points.position, points.count, u, &mut sampled);
    wide(arch, Value { points, sampled: &sampled, scale, value: &mut shadows.value });
    (shadows.rays.origin, shadows.rays.direction, shadows.limit) = (points.position, sampled.wi, sampled.distance);
}

struct Value<'a> {
    points: &'a Points,
    sampled: &'a LightSamples,
    scale: f32,
    value: &'a mut Lane3,
}

impl Wide for Value<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { points, sampled, scale, value } = self;
        // A local array: the compiler then knows that nothing overlaps, which it needs to know to vectorize.
        let mut values = ZERO3;
        for i in 0..points.count.min(LANES) {
            let cos = at(&points.normal, i).dot(at(&sampled.wi, i)).max(0.0);
            set(&mut values, i, at(&points.weight, i) * at(&sampled.weight, i) * (cos * scale * FRAC_1_PI));
        }
        *value = values;
    }
}

/// Appends to `next` each point's path, extended in a direction of pdf cos θ / π.
pub fn extend_paths(arch: Arch, points: &Points, u: &[Lane; 2], next: &mut Paths) {
    assert!(next.count + points.count <= LANES);
    wide(arch, ExtendPaths { points, u, next });
    let part = next.count..next.count + points.count;
    next.pdf[part.clone()].fill(0.0);
    next.environment_share[part.clone()].fill(0.0);
    next.slot[part.clone()].copy_from_slice(&points.slot[..points.count]);
    next.path_class[part.clone()].copy_from_slice(&points.path_class[..points.count]);
    next.caustic[part].copy_from_slice(&points.caustic[..points.count]);
    next.count += points.count;
}

struct ExtendPaths<'a> {
    points: &'a Points,
    u: &'a [Lane; 2],
    next: &'a mut Paths,
}

impl Wide for ExtendPaths<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { points, u, next } = self;
        let start = next.count.min(LANES);
        for i in 0..points.count.min(LANES - start) {
            let (sin_phi, cos_phi) = f32::sin_cos_turns(u[1][i]);
            let r = u[0][i].sqrt();
            let z = (1.0 - u[0][i]).sqrt();
            let normal = at(&points.normal, i);
            let Frame { x: tangent, y: bitangent, .. } = Frame::from_normal(normal);
            let j = start + i;
            set(&mut next.rays.origin, j, at(&points.position, i));
            // To the last bit as the cosine's part of a mixture with cones has it.
            set(&mut next.rays.direction, j, (tangent * cos_phi + bitangent * sin_phi) * r + normal * z);
            set(&mut next.throughput, j, at(&points.weight, i));
        }
    }
}

/// Appends to `next` the path of point `i`, extended in a given direction. Emission that it hits does not count: light samples
/// have found it.
#[inline(always)]
pub fn follow(next: &mut Paths, points: &Points, i: usize, direction: Vec3, throughput: Vec3) {
    let j = next.count;
    next.push(at(&points.position, i), direction, throughput, points.slot[i], points.path_class[i]);
    (next.pdf[j], next.environment_share[j]) = (0.0, 0.0);
    next.caustic[j] = points.caustic[i];
}
