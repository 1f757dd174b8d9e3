//! BSDFs: sampled directions and evaluations per second; microfacet normals alone. Every entry of the registry is measured.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use etalon::bsdf::{self, NormalSampling, Scatter};
use etalon::math::Rgb;
use etalon::optics::metals::SILVER;
use etalon::optics::microfacet::{Beckmann, Distribution, Ggx};
use etalon::sampling::normals::SampleNormals;
use etalon::sampling::stream::{Independent, Stream};
use etalon::sampling::warp::cosine_hemisphere;
use etalon::scene::{Conductor, Dielectric, Material, ScatterModel};
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

/// Measures the BSDF of a material and returns its name in the registry.
fn material(group: &mut BenchmarkGroup<WallTime>, name: &str, material: Material, model: ScatterModel) -> &'static str {
    let inputs = inputs();
    let bsdf = material.bsdf(model);
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
    bsdf.name()
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
    let exact = ScatterModel::default();
    let report = ScatterModel::SECOND_REPORT;
    let (reflectance, transmittance, eta) = (Rgb::ONE, Rgb::ONE, 1.45);
    let glass = Material::Dielectric(Dielectric::clear(eta));
    let mut measured = vec![
        material(&mut group, "diffuse", Material::Diffuse { albedo: Rgb::ONE }, exact),
        material(&mut group, "mirror", Material::Mirror { reflectance }, exact),
        material(&mut group, "refraction", Material::Refraction { transmittance, eta }, exact),
        material(&mut group, "glass", glass.clone(), exact),
        material(&mut group, "report glass", glass, report),
        material(&mut group, "coated diffuse", Material::CoatedDiffuse { albedo: Rgb::splat(0.5), eta }, exact),
    ];
    for distribution in [Distribution::Beckmann, Distribution::Ggx] {
        let (eta, k) = (SILVER.eta_rgb(), SILVER.k_rgb());
        let metal = Material::Conductor(Conductor::new(eta, k, 0.25, distribution));
        for normals in NormalSampling::ALL {
            let model = ScatterModel { normals, ..exact };
            measured.push(material(&mut group, &format!("{distribution:?} {normals:?}"), metal.clone(), model));
        }
        let smooth = Material::Conductor(Conductor::new(eta, k, 0.0, distribution));
        measured.push(material(&mut group, "smooth metal", smooth, exact));
        let brushed = Material::Conductor(Conductor { alpha: [0.1, 0.4], ..Conductor::new(eta, k, 0.0, distribution) });
        measured.push(material(&mut group, &format!("{distribution:?} anisotropic"), brushed, exact));
        let both = Conductor { multiple_scattering: true, ..Conductor::new(eta, k, 0.25, distribution) };
        measured.push(material(&mut group, &format!("{distribution:?} multiple"), Material::Conductor(both), exact));
        let rough = Material::Dielectric(Dielectric::rough(1.45, 0.25, distribution));
        measured.push(material(&mut group, &format!("{distribution:?} glass"), rough, exact));
        let parts = [(0.5, Material::Diffuse { albedo: Rgb::ONE }), (0.5, metal.clone())];
        let mixture = Material::Mixture(parts.into_iter().collect());
        measured.push(material(&mut group, &format!("{distribution:?} mixture"), mixture, exact));
        if distribution == Distribution::Beckmann {
            measured.push(material(&mut group, "report metal", metal.clone(), report));
        }
    }
    for (name, _) in bsdf::ALL {
        assert!(measured.contains(name), "{name} is not measured");
    }
    group.finish();
}

criterion_group!(benches, materials);
criterion_main!(benches);
