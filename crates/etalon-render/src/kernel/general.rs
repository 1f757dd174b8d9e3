//! Surfaces that are not diffuse: how paths continue at delta lobes, and at any other BSDF.

use super::paths::{Paths, Step, Vertex};
use super::rough::{self, Bsdfs, Scattered};
use crate::departure::{Departure, LightSamples};
use crate::geometry::Surface;
use crate::lanes::{Hits, LANES, ZERO3, at, set};
use crate::light_tracing::{delta_ratio, projected};
use crate::prepared::PreparedScene;
use crate::shaders::{Kind, SurfaceShader, is_sound};
use etalon_core::bsdf::{Bsdf, BsdfSample, Scatter};
use etalon_core::math::Rgb;
use glam::Vec3;

/// A hit on a surface that is not diffuse, if it scatters light on this side.
pub fn collect(scene: &PreparedScene, paths: &Paths, hits: &Hits, i: usize) -> Option<Vertex> {
    let object = hits.object[i];
    let shader = &scene.shaders[object as usize];
    let wo = -at(&paths.rays.direction, i);
    let surface = shader.facing(scene.geometry.surface(&paths.rays, hits, i), wo);
    if surface.normal.dot(wo) < 0.0 && shader.kind != Kind::Transmitting {
        return None;
    }
    let frame = shader.frame(&surface, wo, || scene.geometry.tangent(hits, i, surface.normal));
    // Light paths do not scatter at surfaces that are not reciprocal.
    let light_tracing = if shader.bsdf.is_reciprocal() { paths.departure[i].light_tracing } else { 0.0 };
    Some(Vertex {
        surface,
        frame,
        uv: scene.uv(hits, i, surface.position),
        wo: frame.to_local(wo),
        throughput: at(&paths.throughput, i),
        eta_scale: paths.eta_scale[i],
        light_tracing,
        slot: paths.slot[i],
        path_class: paths.path_class[i],
        object,
    })
}

/// Sorts hits by object, and returns the hits on each.
pub fn groups<V>(vertices: &mut [V], object: impl Fn(&V) -> u32 + Copy) -> impl Iterator<Item = &[V]> {
    vertices.sort_by_key(object);
    vertices.chunk_by(move |a, b| object(a) == object(b))
}

/// [`Departure::light_tracing`] of a direction `wi` of the local frame and its pdf; `reverse_pdf` is that of the direction to
/// the viewer if light comes from `wi`.
#[inline]
pub fn light_tracing_ratio(step: Step, vertex: &Vertex, wi: Vec3, pdf: f32, reverse_pdf: impl FnOnce() -> f32) -> f32 {
    if vertex.light_tracing == 0.0 {
        return 0.0;
    }
    let normals = [vertex.surface.normal, vertex.surface.shading];
    let world = |w: Vec3| vertex.frame.to_world(w);
    // Light tracing connects the first vertex to the camera without sampling.
    let reverse_pdf = if step.scatterings == 0 { 1.0 } else { reverse_pdf() };
    let reverse = vertex.light_tracing * projected(normals, world(vertex.wo), reverse_pdf);
    Departure::continued(reverse, || projected(normals, world(wi), pdf))
}

/// Extends the paths that have hit delta BSDFs.
pub fn extend_delta(step: Step, paths: &Paths, hits: &Hits, delta: &[u32], next: &mut Paths) {
    let Step { scene, numbers, scatterings } = step;
    let dimensions = scene.dimensions(scatterings);
    for &i in delta {
        let i = i as usize;
        let object = hits.object[i];
        let shader = &scene.shaders[object as usize];
        let wo = -at(&paths.rays.direction, i);
        let surface = shader.facing(scene.geometry.surface(&paths.rays, hits, i), wo);
        let bsdf = &*shader.bsdf_at(|| scene.geometry.uv(hits, i, surface.position));
        let frame = surface.frame(wo);
        let slot = paths.slot[i];
        let [uc, _] = numbers.short_pair(slot, dimensions.choice(), (0, 1));
        let Some(sample) = bsdf.sample(frame.to_local(wo), uc, [0.0; 2]) else { continue };
        let wi = frame.to_world(sample.wi);
        let departure = delta_departure(bsdf, &surface, paths.departure[i].light_tracing, [wo, wi], &sample);
        let throughput = at(&paths.throughput, i) * sample.weight;
        let (eta_scale, path_class) = (paths.eta_scale[i] * sample.eta * sample.eta, paths.path_class[i].then(true));
        next.push([surface.ray_origin(wi), wi], throughput, eta_scale, departure, slot, path_class);
    }
}

/// How a path leaves a delta lobe; `light_tracing` is that of its arrival.
fn delta_departure(
    bsdf: &Bsdf,
    surface: &Surface,
    light_tracing: f32,
    [wo, wi]: [Vec3; 2],
    sample: &BsdfSample,
) -> Departure {
    let normals = [surface.normal, surface.shading];
    let is_traced = light_tracing > 0.0 && bsdf.is_reciprocal() && is_sound(normals, wo) && is_sound(normals, wi);
    let light_tracing = if is_traced { light_tracing * delta_ratio(bsdf, sample) } else { 0.0 };
    Departure { light_samples: LightSamples::Impossible, light_tracing, is_caustic: true }
}

/// Extends the paths that have hit one object with any other BSDF.
pub fn extend(
    step: Step,
    vertices: &[Vertex],
    (shader, bsdfs): (&SurfaceShader, Bsdfs),
    scattered: &mut Scattered,
    next: &mut Paths,
) {
    let Step { scene, numbers, scatterings } = step;
    // After the last scattering, go on only to light that was not sampled. Light samples miss what delta lobes find.
    let has_delta = shader.bsdf.lobes().iter().any(|lobe| lobe.is_delta());
    let of_delta = has_delta.then_some(LightSamples::Impossible);
    let mut left = of_delta.into_iter().chain([scene.light_samples(1.0, Vec3::Z, shader.kind)]);
    if !scene.goes_on(scatterings) && !left.any(|light_samples| scene.finds_light(&light_samples)) {
        return;
    }
    let dimensions = scene.dimensions(scatterings);
    let (mut wo, mut u, mut slots) = (ZERO3, [[0.0; LANES]; 2], [0; LANES]);
    for (i, vertex) in vertices.iter().enumerate() {
        set(&mut wo, i, vertex.wo);
        slots[i] = vertex.slot;
    }
    numbers.fill(scene.arch, &slots[..vertices.len()], dimensions.bsdf(), (0, 1), &mut u);
    let mut choice = [[0.0; LANES]; 2];
    if shader.bsdf.needs_choice() {
        numbers.fill(scene.arch, &slots[..vertices.len()], dimensions.choice(), (0, 1), &mut choice);
    }
    let random = (&choice[0], &u);
    let is_sampled = rough::sample_many(scene.arch, bsdfs, &wo, random, vertices.len(), scattered);
    if is_sampled && step.needs_reverse_pdf(&shader.bsdf) {
        rough::reverse_pdf_many(scene.arch, bsdfs, &wo, vertices.len(), scattered);
    }
    for (i, vertex) in vertices.iter().enumerate() {
        let bsdf = bsdfs.at(i);
        let sample =
            if is_sampled { scattered.sample(i) } else { bsdf.sample(vertex.wo, choice[0][i], [u[0][i], u[1][i]]) };
        let Some(sample) = sample else { continue };
        let wi = vertex.frame.to_world(sample.wi);
        // The normals must agree on the side.
        if sample.weight == Rgb::ZERO || vertex.surface.normal.dot(wi) * sample.wi.z <= 0.0 {
            continue;
        }
        let departure = if sample.is_delta() {
            let directions = [vertex.frame.to_world(vertex.wo), wi];
            // Light tracing cannot connect a delta lobe to the camera.
            let light_tracing = if scatterings == 0 { 0.0 } else { vertex.light_tracing };
            delta_departure(bsdf, &vertex.surface, light_tracing, directions, &sample)
        } else {
            let reverse_pdf = || if is_sampled { scattered.reverse_pdf[i] } else { bsdf.pdf(sample.wi, vertex.wo) };
            Departure {
                light_samples: scene.light_samples(sample.pdf, vertex.frame.z, shader.kind),
                light_tracing: light_tracing_ratio(step, vertex, sample.wi, sample.pdf, reverse_pdf),
                is_caustic: scatterings > 0,
            }
        };
        let ray = [vertex.surface.ray_origin(wi), wi];
        let path_class = vertex.path_class.then(sample.is_delta());
        let eta_scale = vertex.eta_scale * sample.eta * sample.eta;
        next.push(ray, vertex.throughput * sample.weight, eta_scale, departure, vertex.slot, path_class);
    }
}
