//! Whole renders of the built-in scenes, in camera samples per second, and directions towards a rectangular area light.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use etalon::envmap::EnvMap;
use etalon::envmap::samplers::MapSampling;
use etalon::envmap::synthetic::Synthetic;
use etalon::render::{Sampling, Settings, Silent, render};
use etalon::sampling::rectangle::SphericalRectangle;
use etalon::sampling::stream::{Sobol, Stream};
use etalon::scene::{Environment, Request, builtin};
use std::hint::black_box;
use std::sync::Arc;

fn sphere_env(c: &mut Criterion) {
    let map = Arc::new(EnvMap::new(Synthetic::Nave.make()));
    let (scene, request) = builtin::sphere_env(Environment::upright(map, "nave", builtin::SPHERE_ENV_SCALE));
    let request = Request { width: 256, height: 256, spp: 8, ..request };
    let mut group = c.benchmark_group("sphere-env-256x256-8spp-4light");
    group.throughput(Throughput::Elements((request.width * request.height) as u64 * u64::from(request.spp)));
    group.sample_size(10);
    for (name, sampling, density, general) in [
        ("radiance x cosine", Sampling::Mis, MapSampling::COSINE, false),
        ("radiance x cosine, general kernel", Sampling::Mis, MapSampling::COSINE, true),
        ("map", Sampling::Light, MapSampling::MAP, false),
        ("map, general kernel", Sampling::Light, MapSampling::MAP, true),
        ("MIS, compensated map x cosine", Sampling::Mis, MapSampling::COSINE_COMPENSATED, false),
        ("BSDF", Sampling::Bsdf, MapSampling::MAP, false),
    ] {
        let settings = Settings { sampling, density: Some(density), general, ..Settings::default() };
        group.bench_function(name, |b| b.iter(|| black_box(render(&scene, &request, &settings, &Silent))));
    }
    group.finish();
}

fn boxes(c: &mut Criterion) {
    let mut group = c.benchmark_group("room-160x120-16spp-1light");
    group.sample_size(10);
    // All scenes without a map; statues differ in their metal alone, so that one of them is enough.
    let statue = |name: &str| name.starts_with("cornell-statue") && name != "cornell-statue-au";
    for entry in builtin::scenes().iter().filter(|entry| entry.map_scale().is_none() && !statue(&entry.name)) {
        let name = &entry.name;
        let (scene, request) = entry.make(None, None).unwrap();
        let request = Request { width: 160, height: 120, spp: 16, light_samples: 1, ..request };
        group.throughput(Throughput::Elements((request.width * request.height) as u64 * u64::from(request.spp)));
        for general in [false, true] {
            let name = if general { format!("{name}, nothing left out") } else { name.clone() };
            let settings = Settings { general, ..Settings::default() };
            group.bench_function(name, |b| b.iter(|| black_box(render(&scene, &request, &settings, &Silent))));
        }
    }
    group.finish();
}

fn rectangle(c: &mut Criterion) {
    let mut group = c.benchmark_group("rectangle");
    let stream = |i: u32| Sobol::new(1, 0, i);
    let random: Vec<[f32; 2]> = (0..1024).map(|i| stream(i).short_pair_of(0, 0, 1)).collect();
    let depths: Vec<f32> = random.iter().map(|u| 0.1 + u[0]).collect();
    group.throughput(Throughput::Elements(random.len() as u64));
    group.bench_function("solid angle and a direction, one by one", |b| {
        b.iter(|| {
            for (&u, &depth) in random.iter().zip(&depths) {
                let rectangle = SphericalRectangle::new([-0.4, 0.3], [0.1, 0.7], depth);
                black_box((rectangle.solid_angle(), rectangle.sample(u)));
            }
        });
    });
    group.finish();
}

criterion_group!(benches, sphere_env, boxes, rectangle);
criterion_main!(benches);
