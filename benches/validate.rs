//! The harness: samples generated, checked and counted per second, for a wide and for a narrow lobe.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use etalon::study::validation::{select, suite};
use etalon_stats::{Protocol, SampleCount};
use std::hint::black_box;
use std::time::Duration;

fn harness(c: &mut Criterion) {
    const SAMPLES: u64 = 1 << 20;
    let mut group = c.benchmark_group("validate");
    group.throughput(Throughput::Elements(SAMPLES));
    group.sample_size(10).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_secs(2));
    let protocol = Protocol { samples: SampleCount::Fixed(SAMPLES), ..Protocol::default() };
    let names = ["warp/cosine-hemisphere", "normals/beckmann/visible/0.05/60"].map(str::to_owned);
    for case in select(suite::cases(), &names).expect("both are in the suite") {
        group.bench_function(&case.name, |b| b.iter(|| black_box(case.examine(&protocol, 0))));
    }
    group.finish();
}

criterion_group!(benches, harness);
criterion_main!(benches);
