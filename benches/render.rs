//! Whole renders of the lit sphere: samples per second by strategy, and what leaving out saves.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use etalon::envmap::EnvMap;
use etalon::envmap::synthetic::Synthetic;
use etalon::render::{LightDensity, Sampling, Settings, render};
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
        ("radiance x cosine", Sampling::Mis, LightDensity::Cosine, false),
        ("radiance x cosine, general kernel", Sampling::Mis, LightDensity::Cosine, true),
        ("map", Sampling::Light, LightDensity::Map, false),
        ("map, general kernel", Sampling::Light, LightDensity::Map, true),
        ("MIS, compensated map", Sampling::Mis, LightDensity::Compensated, false),
        ("BSDF", Sampling::Bsdf, LightDensity::Map, false),
    ] {
        let settings = Settings { sampling, density, general, ..Settings::default() };
        group.bench_function(name, |b| b.iter(|| black_box(render(&scene, &request, &settings, &Silent))));
    }
    group.finish();
}

criterion_group!(benches, sphere_env);
criterion_main!(benches);
