//! Environment-map sampling and median cut: throughput of every sampler, its density included.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use etalon::envmap::EnvMap;
use etalon::envmap::cut::{MedianCut, SideRule, Split};
use etalon::envmap::irradiance::IrradianceTree;
use etalon::envmap::sampler::{AliasSampler, CdfSampler, CompensatedSampler, DirectionSampler};
use etalon::raster::{Image, Rgb};
use etalon::sampling::stream::{Independent, Stream};
use glam::DVec3;
use std::hint::black_box;
use std::sync::Arc;

/// A dim gradient with bright windows and a sun: the kind of map that makes importance sampling worth it.
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

const DRAWS: u32 = 100_000;

/// Draws with fresh independent numbers and adds everything up, so that nothing can be left out.
fn draw_all(sampler: &impl DirectionSampler) -> f64 {
    let mut sum = DVec3::ZERO;
    let mut rest = 0.0;
    for i in 0..DRAWS {
        let u = Independent::new(1, 0, i).pair(0);
        if let Some(s) = sampler.sample(u) {
            sum += s.wi;
            rest += s.pdf + f64::from(s.radiance.x + s.radiance.y + s.radiance.z);
        }
    }
    sum.element_sum() + rest
}

fn sampling(c: &mut Criterion) {
    for (width, height) in [(1024, 512), (8192, 4096)] {
        let map = map(width, height);
        let mut group = c.benchmark_group(format!("envmap-sample-{width}x{height}"));
        group.throughput(Throughput::Elements(u64::from(DRAWS))).sample_size(20);
        let cdf = CdfSampler::new(map.clone());
        group.bench_function("cdf", |b| b.iter(|| black_box(draw_all(&cdf))));
        let alias = AliasSampler::new(map.clone());
        group.bench_function("alias", |b| b.iter(|| black_box(draw_all(&alias))));
        let compensated = CompensatedSampler::new(map.clone());
        group.bench_function("compensated", |b| b.iter(|| black_box(draw_all(&compensated))));
        group.finish();
        c.bench_function(&format!("envmap-build-{width}x{height}"), |b| {
            b.iter(|| CdfSampler::new(black_box(map.clone())))
        });
    }
}

fn median_cut(c: &mut Criterion) {
    let map = map(1024, 512);
    let mut group = c.benchmark_group("median-cut-1024x512");
    group.sample_size(20);
    for n in [64, 1024] {
        for (name, split) in [("energy", Split::Energy), ("variance", Split::Variance)] {
            group.bench_with_input(BenchmarkId::new(name, n), &n, |b, &n| {
                b.iter(|| MedianCut::new(&map, split, SideRule::Sphere).regions(n));
            });
        }
    }
    group.finish();
}

fn irradiance(c: &mut Criterion) {
    let tree = IrradianceTree::new(&map(1024, 512));
    c.bench_function("irradiance-1024x512", |b| {
        let mut i = 0;
        b.iter(|| {
            i += 1;
            let [u, v] = Independent::new(2, 0, i).pair(0);
            let z = 1.0 - 2.0 * u;
            let (sin, cos) = etalon::sampling::warp::sin_cos_turns(v);
            let r = (1.0 - z * z).sqrt();
            tree.irradiance(DVec3::new(r * cos, r * sin, z)).value
        });
    });
}

criterion_group!(benches, sampling, median_cut, irradiance);
criterion_main!(benches);
