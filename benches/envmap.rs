//! Environment maps: throughput of every sampler with its densities, radiance and random numbers; median cut; irradiance.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use etalon::envmap::EnvMap;
use etalon::envmap::cut::{MedianCut, SideRule, Split};
use etalon::envmap::irradiance::IrradianceTree;
use etalon::envmap::samplers::{self, EnvSample, MapSampling, SurfaceSampler, TexelSampler};
use etalon::math::Rgb;
use etalon::math::circular::sin_cos_turns;
use etalon::raster::Image;
use etalon::sampling::stream::{Independent, Stream};
use glam::DVec3;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

/// A dim gradient with bright windows and a sun: a map that needs importance sampling.
fn map(width: usize, height: usize) -> Arc<EnvMap> {
    Arc::new(EnvMap::new(Image::from_fn(width, height, |x, y| {
        let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
        let window = (u * 16.0).fract() < 0.2 && (0.3..0.4).contains(&v);
        let sun = (u - 0.25).abs() < 0.0015 && (v - 0.2).abs() < 0.003;
        let level = if sun {
            12_000.0
        } else if window {
            20.0
        } else {
            0.1 + 0.2 * (1.0 - v)
        };
        Rgb::new(level, 0.9 * level, 0.7 * level)
    })))
}

/// Samples per measurement.
const SAMPLES: u32 = 1 << 17;

/// The random numbers of sample `i`. The index is hidden from the compiler, which would otherwise vectorize the 64-bit
/// multiplications without an instruction for them, at twice the cost.
fn random(i: u32) -> [f64; 2] {
    Independent::new(1, 0, 0).pair_of(0, black_box(i), 1)
}

fn direction(i: u32) -> DVec3 {
    let [u, v] = Independent::new(2, 0, 0).pair_of(0, i, 1);
    let z = 1.0 - 2.0 * u;
    let (sin, cos) = sin_cos_turns(v);
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z)
}

fn single(group: &mut BenchmarkGroup<WallTime>, name: &str, sample: impl Fn(u32) -> Option<EnvSample>) {
    group.bench_function(name, |b| {
        b.iter(|| {
            for i in 0..SAMPLES {
                black_box(sample(i));
            }
        });
    });
}

/// Every sampler of directions in the registry, by inversion first.
fn sampled() -> impl Iterator<Item = MapSampling> {
    let all = samplers::ALL.iter().map(|entry| MapSampling::new(entry));
    all.filter(|sampling| !sampling.has_fixed_lights())
}

fn sampling(c: &mut Criterion) {
    for (width, height) in [(1024, 512), (8192, 4096)] {
        let map = map(width, height);
        let normals: Vec<DVec3> = (0..1024).map(direction).collect();
        let mut group = c.benchmark_group(format!("envmap-sample-{width}x{height}"));
        group.throughput(Throughput::Elements(u64::from(SAMPLES))).sample_size(20);
        group.warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(3));
        let cdf = TexelSampler::new(map.clone());
        single(&mut group, "cdf", |i| cdf.sample_for(random(i), DVec3::Y));
        let directions: Vec<DVec3> =
            (0..SAMPLES).filter_map(|i| cdf.sample_for(random(i), DVec3::Y)).map(|s| s.wi).collect();
        group.bench_function("pdf of its own samples", |b| {
            b.iter(|| directions.iter().map(|&wi| cdf.pdf_for(wi, DVec3::Y)).sum::<f64>());
        });
        drop(cdf);
        for sampling in sampled().skip(1) {
            let sampler = sampling.sampler(map.clone()).unwrap();
            let normal = |i: u32| normals[i as usize % normals.len()];
            single(&mut group, sampling.entry().name, |i| sampler.sample_for(random(i), normal(i)));
        }
        group.finish();
    }
}

fn building(c: &mut Criterion) {
    let (small, large) = (map(1024, 512), map(8192, 4096));
    let mut group = c.benchmark_group("envmap-build");
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    for sampling in sampled() {
        let name = format!("{} 1024x512", sampling.entry().name);
        group.bench_function(name, |b| b.iter(|| sampling.sampler(small.clone()).unwrap()));
    }
    group.bench_function("cdf 8192x4096", |b| b.iter(|| TexelSampler::new(large.clone())));
    group.finish();
}

fn median_cut(c: &mut Criterion) {
    let map = map(1024, 512);
    let mut group = c.benchmark_group("median-cut-1024x512");
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    for n in [64, 1024] {
        for (name, split) in Split::ALL.map(|split| (split.name(), split)) {
            group.bench_with_input(BenchmarkId::new(name, n), &n, |b, &n| {
                b.iter(|| MedianCut::new(&map, split, SideRule::default()).regions(n));
            });
        }
    }
    group.finish();
}

fn irradiance(c: &mut Criterion) {
    let tree = IrradianceTree::new(&map(1024, 512));
    let mut group = c.benchmark_group("irradiance-1024x512");
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    let mut i = 0;
    group.bench_function("one normal", |b| {
        b.iter(|| {
            i += 1;
            tree.irradiance(direction(i)).value
        });
    });
    group.finish();
}

criterion_group!(benches, sampling, building, median_cut, irradiance);
criterion_main!(benches);
