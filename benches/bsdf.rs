//! BSDFs: sampled directions and evaluations per second; microfacet normals alone. Every family of BSDFs is measured at the default values of
//! its parameters.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use etalon::bsdf::{Bsdf, Scatter};
use etalon::optics::microfacet::{Beckmann, Ggx};
use etalon::sampling::normals::SampleNormals;
use etalon::sampling::stream::{Independent, Stream};
use etalon::sampling::warp::cosine_hemisphere;
use etalon::study::validation::families;
use etalon_stats::bsdf::Family;
use glam::Vec3;
use std::hint::black_box;
use std::time::Duration;

/// Samples per measurement.
const SAMPLES: u32 = 4096;

/// Directions of views, distributed by the cosine, and random numbers.
fn inputs() -> Vec<(Vec3, f32, [f32; 2])> {
    let pair = |i, dimension| Independent::new(1, 0, i).pair(dimension);
    (0..SAMPLES)
        .map(|i| (cosine_hemisphere(pair(i, 0)).as_vec3(), pair(i, 1)[0] as f32, pair(i, 2).map(|u| u as f32)))
        .collect()
}

/// Measures a BSDF: samples, and evaluations unless it is a delta function.
fn bsdf(group: &mut BenchmarkGroup<WallTime>, name: &str, bsdf: &Bsdf) {
    let inputs = inputs();
    group.bench_function(format!("{name}/sample"), |b| {
        b.iter(|| {
            for &(wo, uc, u) in &inputs {
                black_box(bsdf.sample(wo, uc, u));
            }
        });
    });
    if !bsdf.is_delta() {
        group.bench_function(format!("{name}/eval_pdf"), |b| {
            b.iter(|| {
                for pair in inputs.windows(2) {
                    black_box(bsdf.eval_pdf(pair[0].0, pair[1].0));
                }
            });
        });
    }
}

fn normals(group: &mut BenchmarkGroup<WallTime>, name: &str, distribution: impl SampleNormals<f32>) {
    let inputs = inputs();
    group.bench_function(format!("{name}/visible normal"), |b| {
        b.iter(|| {
            for &(wo, _, u) in &inputs {
                black_box(distribution.sample_vndf(wo.to_array(), u));
            }
        });
    });
    group.bench_function(format!("{name}/any normal"), |b| {
        b.iter(|| {
            for &(_, _, u) in &inputs {
                black_box(distribution.sample_ndf(u));
            }
        });
    });
}

fn materials(c: &mut Criterion) {
    let mut group = c.benchmark_group("bsdf");
    group.throughput(Throughput::Elements(u64::from(SAMPLES)));
    group.sample_size(10).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_millis(400));
    normals(&mut group, "beckmann", Beckmann::new(0.25));
    normals(&mut group, "ggx", Ggx::new(0.25));
    for family in families::all() {
        let values: Vec<f64> = family.parameters().iter().map(|parameter| parameter.value).collect();
        bsdf(&mut group, family.name(), &family.bsdf(&values));
    }
    group.finish();
}

criterion_group!(benches, materials);
criterion_main!(benches);
