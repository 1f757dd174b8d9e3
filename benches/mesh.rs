//! Triangle meshes: coherent and incoherent rays per second on the statue, and the time to build the BVH.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use etalon::sampling::stream::{Independent, Stream};
use etalon::scene::statue::statue;
use etalon::scene::{Camera, MeshBvh, Projection, Ray, Rays};
use glam::{DVec3, Vec3};
use std::hint::black_box;

/// Rays per measurement, and per call.
const SIDE: usize = 256;
const CALL: usize = 256;

/// The rays of a camera, row by row.
fn coherent() -> Vec<Ray> {
    let projection = Projection::Perspective { tan_half_width: 0.2, tan_half_height: 0.2 };
    let camera = Camera::look_at(DVec3::new(0.0, 0.75, 3.2), DVec3::new(0.0, 0.5, 0.0), DVec3::Y, projection).unwrap();
    let at = |i: usize| (i as f64 + 0.5) / SIDE as f64;
    (0..SIDE * SIDE).map(|i| camera.ray(at(i % SIDE), at(i / SIDE))).collect()
}

/// Rays that leave random points of the surface in random directions of its outer side.
fn incoherent() -> Vec<Ray> {
    let mesh = statue();
    let error = mesh.error();
    let ray = |i: usize| {
        let stream = Independent::new(1, i as u64, 0);
        let ([a, u], [z, around]) = (stream.pair(0), stream.pair(1));
        let triangle = (a * mesh.triangles.len() as f64) as u32;
        let surface = mesh.surface(triangle, 0.5 * u as f32, 0.25).unwrap();
        let (sin, cos) = (std::f64::consts::TAU * around).sin_cos();
        let z = 1.0 - 2.0 * z;
        let r = (1.0 - z * z).sqrt();
        let direction = DVec3::new(r * cos, r * sin, z).as_vec3();
        let outwards = direction * direction.dot(surface.normal).signum();
        Ray { origin: surface.point + 2.0 * error * surface.normal, direction: outwards }
    };
    (0..SIDE * SIDE).map(ray).collect()
}

fn rays(c: &mut Criterion) {
    let mesh = statue();
    let bvh = MeshBvh::build(&[&mesh]);
    let mut group = c.benchmark_group("statue");
    group.sample_size(20);
    group.throughput(Throughput::Elements((SIDE * SIDE) as u64));
    for (name, rays) in [("coherent", coherent()), ("incoherent", incoherent())] {
        let component = |f: fn(&Ray) -> Vec3, axis: usize| -> Vec<f32> { rays.iter().map(|r| f(r)[axis]).collect() };
        let origin = [0, 1, 2].map(|axis| component(|r| r.origin, axis));
        let direction = [0, 1, 2].map(|axis| component(|r| r.direction, axis));
        let t_max = vec![f32::INFINITY; CALL];
        let batch = |start: usize| Rays {
            origin: [0, 1, 2].map(|axis| &origin[axis][start..start + CALL]),
            direction: [0, 1, 2].map(|axis| &direction[axis][start..start + CALL]),
            t_max: &t_max,
        };
        group.bench_function(format!("nearest, {name}"), |b| {
            let mut hits = [None; CALL];
            b.iter(|| {
                for start in (0..rays.len()).step_by(CALL) {
                    bvh.nearest_many(batch(start), black_box(&mut hits));
                }
            });
        });
        group.bench_function(format!("occluded, {name}"), |b| {
            let mut hits = [false; CALL];
            b.iter(|| {
                for start in (0..rays.len()).step_by(CALL) {
                    bvh.occluded_many(batch(start), black_box(&mut hits));
                }
            });
        });
    }
    group.finish();
}

fn build(c: &mut Criterion) {
    let mesh = statue();
    let mut group = c.benchmark_group("statue-build");
    group.sample_size(10);
    group.bench_function("mesh", |b| b.iter(statue));
    group.bench_function("tree", |b| b.iter(|| MeshBvh::build(&[black_box(&mesh)])));
    group.finish();
}

criterion_group!(benches, rays, build);
criterion_main!(benches);
