//! Diffuse hits in vectorized loops: rays towards a light, and the directions in which the paths continue.

use super::paths::{Paths, Points, Shadows, Step};
use crate::departure::Departure;
use crate::geometry::Surface;
use crate::lanes::{LANES, Lane, Lane3, Wide, ZERO3, at, set, wide};
use crate::light_sample::{LightSampleLanes, balance_heuristic};
use crate::light_tracing::projected;
use crate::shaders::Kind;
use etalon_core::bsdf::Bsdf;
use etalon_core::math::circular::Circular;
use etalon_core::math::{Frame, Rgb};
use glam::Vec3;
use pulp::Arch;
use std::f32::consts::FRAC_1_PI;

/// Adds a diffuse hit to the batch.
#[inline]
pub fn collect(surface: Surface, is_first: bool, paths: &Paths, i: usize, bsdf: &Bsdf, points: &mut Points) {
    let Bsdf::Diffuse(diffuse) = bsdf else { return };
    let j = points.count;
    let wo = -at(&paths.rays.direction, i);
    set(&mut points.position, j, surface.ray_origin(wo));
    set(&mut points.normal, j, surface.shading_for(wo));
    set(&mut points.geometric, j, surface.normal);
    set(&mut points.weight, j, at(&paths.throughput, i) * diffuse.albedo());
    points.eta_scale[j] = paths.eta_scale[i];
    let reverse_pdf = if is_first { 1.0 } else { surface.shading.dot(wo) * FRAC_1_PI };
    let light_tracing = paths.departure[i].light_tracing;
    points.light_tracing[j] = if light_tracing > 0.0 {
        light_tracing * projected([surface.normal, surface.shading], wo, reverse_pdf)
    } else {
        0.0
    };
    points.slot[j] = paths.slot[i];
    points.path_class[j] = paths.path_class[i].then(false);
    points.count += 1;
}

/// Sets the values of shadow rays to the light of `samples`, one of `count` for each point, that the points scatter to the viewer,
/// weight / π · cos · light; and their lengths, to 0 where that is black.
pub fn values(arch: Arch, points: &Points, samples: &LightSampleLanes, count: f32, shadows: &mut Shadows) {
    wide(arch, Values { points, samples, count, values: &mut shadows.value, limits: &mut shadows.limit });
}

struct Values<'a> {
    points: &'a Points,
    samples: &'a LightSampleLanes,
    count: f32,
    values: &'a mut Lane3,
    limits: &'a mut Lane,
}

impl Wide for Values<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { points, samples, count, values, limits } = self;
        // Local arrays: the compiler then knows that nothing overlaps, which it needs to know to vectorize.
        let (mut out, mut lengths) = (ZERO3, [0.0; LANES]);
        for i in 0..points.count.min(LANES) {
            let wi = at(&samples.wi, i);
            let cos = at(&points.normal, i).dot(wi).max(0.0);
            // What the shading normal would let through the surface is black.
            let cos = if at(&points.geometric, i).dot(wi) > 0.0 { cos } else { 0.0 };
            let by_bsdf = cos * FRAC_1_PI;
            let share = balance_heuristic(count * samples.pdf[i], [by_bsdf, 0.0]);
            let value = at(&points.weight, i) * at(&samples.weight, i) * (by_bsdf * share / count);
            set(&mut out, i, value);
            lengths[i] = if value == Rgb::ZERO { 0.0 } else { samples.limit[i] };
        }
        (*values, *limits) = (out, lengths);
    }
}

/// Appends to `next` each point's path, extended in a direction of pdf cos θ / π.
pub fn extend(step: Step, points: &Points, next: &mut Paths) {
    let Step { scene, numbers, scatterings } = step;
    let light_samples = |pdf: f32, normal: Vec3| scene.light_samples(pdf, normal, Kind::Diffuse);
    if !scene.goes_on(scatterings) && !scene.finds_light(&light_samples(1.0, Vec3::Z)) {
        return;
    }
    let mut u = [[0.0; LANES]; 2];
    let slots = &points.slot[..points.count];
    numbers.fill(scene.arch, slots, scene.dimensions(scatterings).bsdf(), (0, 1), &mut u);
    let start = next.count;
    wide(scene.arch, ExtendPaths { points, u: &u, start, next });
    let mut below = false;
    for i in 0..points.count {
        let (wi, j) = (at(&next.rays.direction, start + i), start + i);
        let (normal, geometric) = (at(&points.normal, i), at(&points.geometric, i));
        below |= geometric.dot(wi) <= 0.0;
        let pdf = normal.dot(wi) * FRAC_1_PI;
        let light_tracing = Departure::continued(points.light_tracing[i], || projected([geometric, normal], wi, pdf));
        next.departure[j] = Departure { light_samples: light_samples(pdf, normal), light_tracing, is_caustic: false };
        (next.slot[j], next.path_class[j]) = (points.slot[i], points.path_class[i]);
        next.eta_scale[j] = points.eta_scale[i];
    }
    next.count += points.count;
    // The normals must agree on the side.
    if below {
        let i = |j: usize| j.checked_sub(start);
        next.retain(|paths, j| i(j).is_none_or(|i| at(&points.geometric, i).dot(at(&paths.rays.direction, j)) > 0.0));
    }
}

/// The loop that samples the directions.
pub struct ExtendPaths<'a> {
    pub points: &'a Points,
    pub u: &'a [Lane; 2],
    /// Where the paths go.
    pub start: usize,
    pub next: &'a mut Paths,
}

impl Wide for ExtendPaths<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { points, u, start, next } = self;
        let start = start.min(LANES);
        for i in 0..points.count.min(LANES - start) {
            let (sin_phi, cos_phi) = f32::sin_cos_turns(u[1][i]);
            let (r, z) = (u[0][i].sqrt(), (1.0 - u[0][i]).sqrt());
            let normal = at(&points.normal, i);
            let Frame { x: tangent, y: bitangent, .. } = Frame::from_normal(normal);
            let j = start + i;
            set(&mut next.rays.origin, j, at(&points.position, i));
            set(&mut next.rays.direction, j, (tangent * cos_phi + bitangent * sin_phi) * r + normal * z);
            set(&mut next.throughput, j, at(&points.weight, i));
        }
    }
}
