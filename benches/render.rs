//! Whole renders, in camera samples per second, and directions towards a rectangular lamp.

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
        ("MIS, compensated map", Sampling::Mis, MapSampling::COMPENSATED, false),
        ("BSDF", Sampling::Bsdf, MapSampling::MAP, false),
    ] {
        let settings = Settings { sampling, density, general, ..Settings::default() };
        group.bench_function(name, |b| b.iter(|| black_box(render(&scene, &request, &settings, &Silent))));
    }
    group.finish();
}

fn rooms(c: &mut Criterion) {
    let mut group = c.benchmark_group("room-160x120-16spp-1light");
    group.sample_size(10);
    for name in ["cornell-lambert", "cornell-spheres", "cornell-statue-au"] {
        let (scene, request) = builtin::find(name).unwrap().make(None, None).unwrap();
        let request = Request { width: 160, height: 120, spp: 16, light_samples: 1, ..request };
        group.throughput(Throughput::Elements((request.width * request.height) as u64 * u64::from(request.spp)));
        for general in [false, true] {
            let name = if general { format!("{name}, nothing left out") } else { name.into() };
            let settings = Settings { general, ..Settings::default() };
            group.bench_function(name, |b| b.iter(|| black_box(render(&scene, &request, &settings, &Silent))));
        }
    }
    group.finish();
}

fn lamp(c: &mut Criterion) {
    let mut group = c.benchmark_group("rectangle");
    let stream = |i: u32| Sobol::new(1, 0, i);
    let numbers: Vec<[f32; 2]> = (0..1024).map(|i| stream(i).short_pair_of(0, 0, 1)).collect();
    let depths: Vec<f32> = numbers.iter().map(|u| 0.1 + u[0]).collect();
    group.throughput(Throughput::Elements(numbers.len() as u64));
    group.bench_function("solid angle and a direction, one by one", |b| {
        b.iter(|| {
            for (&u, &depth) in numbers.iter().zip(&depths) {
                let seen = SphericalRectangle::new([-0.4, 0.3], [0.1, 0.7], depth);
                black_box((seen.solid_angle(), seen.sample(u)));
            }
        });
    });
    group.finish();
}

criterion_group!(benches, sphere_env, rooms, lamp);
criterion_main!(benches);
