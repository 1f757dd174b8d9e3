//! The light tree: time to build it, to select a light at a point, and to evaluate the probability of one.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use etalon::render::light_tree::{LightBounds, LightTree};
use etalon::sampling::stream::{Independent, Stream};
use glam::Vec3;
use std::hint::black_box;
use std::time::Duration;

/// Points per measurement.
const POINTS: u32 = 4096;

/// Random numbers from 0 to 1.
fn place(i: u32, stream: u64) -> Vec3 {
    let ([x, y], [z, _]) = (Independent::new(1, stream, i).pair(0), Independent::new(1, stream, i).pair(1));
    Vec3::new(x as f32, y as f32, z as f32)
}

/// A unit vector.
fn direction(i: u32, stream: u64) -> Vec3 {
    (place(i, stream) - 0.5).normalize_or(Vec3::Z)
}

/// Plane lights in a cube, in all orientations, smaller the more there are.
fn lights(count: u32) -> Vec<LightBounds> {
    let half = 0.1 / (count as f32).cbrt();
    (0..count)
        .map(|i| {
            let (centre, axis) = (place(i, 0), direction(i, 1));
            let (min, max) = (centre - half, centre + half);
            LightBounds { min, max, intensity: 1.0, axis, cos_o: 1.0, cos_e: 0.0, two_sided: false }
        })
        .collect()
}

fn light_tree(c: &mut Criterion) {
    let mut group = c.benchmark_group("light-tree");
    group.sample_size(10).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_millis(400));
    let points: Vec<_> = (0..POINTS).map(|i| (place(i, 2), direction(i, 3), place(i, 4).x)).collect();
    for count in [10, 100, 1000, 10_000, 100_000, 1_000_000] {
        let lights = lights(count);
        group.throughput(Throughput::Elements(u64::from(count)));
        group.bench_function(format!("{count}/build"), |b| b.iter(|| LightTree::new(black_box(&lights))));
        let tree = LightTree::new(&lights);
        group.throughput(Throughput::Elements(u64::from(POINTS)));
        group.bench_function(format!("{count}/sample"), |b| {
            b.iter(|| {
                for &(point, normal, u) in &points {
                    black_box(tree.at(point, Some(normal)).sample(u));
                }
            });
        });
        group.bench_function(format!("{count}/pmf"), |b| {
            b.iter(|| {
                for &(point, normal, u) in &points {
                    black_box(tree.at(point, Some(normal)).pmf((u * count as f32) as u32));
                }
            });
        });
    }
    group.finish();
}

criterion_group!(benches, light_tree);
criterion_main!(benches);
