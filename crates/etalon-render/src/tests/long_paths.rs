//! Paths of ten thousand bounces that lose no energy: in a closed white box that emits light, and over materials that absorb nothing.

use super::*;
use etalon_core::bsdf::Scatter;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::scene::{EmitterVisibility, ScatterModel};

const BOUNCES: u32 = 10_000;

/// A cube around the camera, of side 2.06, which is no power of 2. Its walls emit a radiance of 1.
fn closed_box(albedo: f32) -> Scene {
    const HALF: f32 = 1.03;
    let wall = |normal: Vec3, x: Vec3, y: Vec3| {
        let shape = Shape::Rectangle(Rectangle::new(normal * HALF, x * HALF, y * HALF).unwrap());
        let emission = Emission { radiance: Rgb::ONE, two_sided: true, visibility: EmitterVisibility::Sampled };
        let material = Material::Diffuse { albedo: Rgb::splat(albedo) };
        Object { emission: Some(emission), ..Object::new(shape, material) }
    };
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let walls = (0..6).map(|i| {
        let [normal, x, y] = std::array::from_fn(|k| axes[(i + k) % 3]);
        wall(if i < 3 { normal } else { -normal }, x, y)
    });
    let camera = Camera {
        position: DVec3::new(0.1, 0.2, 0.3),
        right: DVec3::X,
        up: DVec3::Y,
        forward: DVec3::NEG_Z,
        projection: Projection::Perspective { tan_half_width: 1.0, tan_half_height: 1.0 },
        filter: PixelFilter::default(),
    };
    Scene { name: "closed box".into(), camera, objects: walls.collect(), lights: Vec::new(), environment: None }
}

/// Every vertex adds a radiance of 1, and a factor of 1 and a sum of fewer than 2²⁴ ones are exact.
#[test]
fn a_closed_white_box_keeps_all_energy() {
    let is_exact = |albedo: f32| {
        let request = Request { width: 16, height: 16, spp: 1, light_samples: 1, max_depth: BOUNCES };
        let settings = Settings { sampling: Sampling::Bsdf, ..Settings::default() };
        let rendered = render(&closed_box(albedo), &request, &settings, &Silent).unwrap();
        assert_eq!(rendered.dropped, Dropped::default());
        rendered.image.pixels().iter().all(|pixel| *pixel == Rgb::splat((BOUNCES + 1) as f32))
    };
    assert!(is_exact(1.0));
    assert!(!is_exact(1f32.next_down()));
}

const ETA: f32 = 1.5;

/// The largest distance from 1 of products of weights of directions sampled from white diffuse, mirror and glass surfaces,
/// alternating, each times `factor`. Radiance scales by η² on the way into the glass, and by its inverse on the way out.
fn drift(factor: f32) -> f64 {
    let white = Rgb::ONE;
    let materials = [
        Material::Diffuse { albedo: white },
        Material::Mirror { reflectance: white },
        Material::Dielectric(Dielectric::clear(ETA)),
    ]
    .map(|material| material.bsdf(ScatterModel::default()));
    let walk = |walk: u64| {
        let (mut wo, mut inside, mut throughput) = (Vec3::new(0.6, 0.0, 0.8), false, 1f32);
        for bounce in 0..BOUNCES {
            let random = Independent::new(1, walk, bounce);
            let [u, v] = random.pair(0).map(|u| u as f32);
            let uc = random.pair(1)[0] as f32;
            let glass = bounce % 3 == 2;
            // Opaque surfaces are hit from above, glass from the side that the path is on
            wo.z = if glass && inside { -wo.z.abs() } else { wo.z.abs() };
            let Some(sample) = materials[bounce as usize % 3].sample(wo, uc, [u, v]) else { continue };
            throughput *= factor * sample.weight.x;
            inside ^= glass && sample.wi.z * wo.z < 0.0;
            wo = -sample.wi;
        }
        let scale = if inside { f64::from(ETA).powi(2) } else { 1.0 };
        (f64::from(throughput) * scale - 1.0).abs()
    };
    (0..64).map(walk).fold(0.0, f64::max)
}

/// At most one last place for each bounce: every third one is on glass, whose weight and product are rounded three times.
#[test]
fn walks_over_materials_keep_all_energy() {
    let bound = f64::from(BOUNCES) * f64::from(f32::EPSILON);
    assert!(drift(1.0) <= bound, "{}", drift(1.0));
    assert!(drift(1.0 - 2.0 * f32::EPSILON) > bound);
}
