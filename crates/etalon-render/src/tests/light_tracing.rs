//! Light tracing and camera paths give the same image.

use super::*;
use crate::light_tracing::{LightTracing, SAMPLES_PER_LIGHT_PATH};
use etalon_stats::estimate::Estimate;

/// A camera above the middle of a diffuse floor of 4 by 4 with a wall behind it, and an area light to the left.
pub(super) fn box_with(objects: Vec<Object>, projection: Projection) -> Scene {
    let camera = Camera::look_at(DVec3::new(0.0, 3.0, 2.0), DVec3::ZERO, DVec3::Y, projection).unwrap();
    let floor = Rectangle::new(Vec3::ZERO, 2.0 * Vec3::Z, 2.0 * Vec3::X).unwrap();
    let light = Rectangle::new(Vec3::new(-1.5, 2.0, 0.0), 0.3 * Vec3::X, 0.3 * Vec3::Z).unwrap();
    let black = Material::Diffuse { albedo: Rgb::ZERO };
    let mut all = vec![
        Object::new(Shape::Rectangle(floor), Material::Diffuse { albedo: Rgb::splat(0.5) }),
        Object { emission: Some(Emission::of_front(Rgb::splat(10.0))), ..Object::new(Shape::Rectangle(light), black) },
    ];
    let wall = Rectangle::new(Vec3::new(0.0, 2.0, -2.0), 2.0 * Vec3::X, 2.0 * Vec3::Y).unwrap();
    all.push(Object::new(Shape::Rectangle(wall), Material::Diffuse { albedo: Rgb::splat(0.8) }));
    all.extend(objects);
    Scene { name: "box".into(), camera, objects: all, lights: Vec::new(), environment: None }
}

pub(super) const WIDE: Projection = Projection::Perspective { tan_half_width: 0.5, tan_half_height: 0.5 };

pub(super) fn sphere(material: Material) -> Object {
    Object::new(ball(Vec3::new(0.2, 0.6, 0.0), 0.5), material)
}

fn metal(alpha: f32) -> Material {
    Material::Conductor(super::metal(alpha, Distribution::Beckmann))
}

fn two_sided(alpha: f32) -> Material {
    Material::Conductor(Conductor { two_sided: true, ..super::metal(alpha, Distribution::Beckmann) })
}

/// Few triangles, with their corners in the wrong order and normals far from theirs.
fn inside_out() -> Shape {
    let corners = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let triangle = |i: u32| {
        let (a, b, c) = (i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2));
        if (a + b + c) % 2 == 0 { [a, c, b] } else { [a, b, c] }
    };
    let at = corners.map(|c| Vec3::new(0.2, 0.6, 0.0) + 0.55 * c);
    Mesh::new(at.to_vec(), corners.to_vec(), (0..8).map(triangle).collect()).unwrap().into()
}

/// The mean difference between the images with and without light tracing, in standard errors.
fn bias(scene: &Scene, spp: u32, max_depth: u32) -> f64 {
    const ROUNDS: u32 = 16;
    let request = Request { width: 8, height: 8, spp: spp / ROUNDS, light_samples: 1, max_depth };
    let mut sum = 0.0;
    let differences: Vec<f64> = (0..ROUNDS)
        .map(|round| {
            let mut mean = |sampling, seed| {
                let settings = Settings { sampling, stream: StreamKind::Independent, seed, ..Settings::default() };
                let (mean, _) = mean(scene, &request, &settings);
                sum += mean;
                mean
            };
            mean(Sampling::MisLt, 2 * u64::from(round)) - mean(Sampling::Mis, 2 * u64::from(round) + 1)
        })
        .collect();
    let Estimate { value, standard_error, .. } = Estimate::mean(&differences);
    println!("{}: {value} ± {standard_error}, relative {}", scene.name, standard_error / (sum / 32.0));
    assert!(standard_error > 0.0, "there must be something to compare");
    value / standard_error
}

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn mis_has_the_same_mean_without_light_tracing() {
    let parallel = Projection::Orthographic { half_width: 1.5, half_height: 1.5 };
    let mirror = Material::Mirror { reflectance: Rgb::splat(0.9) };
    let upright = Rectangle::new(Vec3::new(1.0, 0.5, 0.0), 0.5 * Vec3::Y, 0.5 * Vec3::Z).unwrap();
    let upright = |material| Object::new(Shape::Rectangle(upright), material);
    for (name, object, projection, spp) in [
        ("flat mirror", upright(mirror), WIDE, 1 << 12),
        ("sharp metal, parallel rays", sphere(metal(0.05)), parallel, 1 << 14),
        // The backs face light and camera.
        ("two-sided metal", upright(two_sided(0.4)), WIDE, 1 << 12),
        ("two-sided polished metal", upright(two_sided(0.0)), WIDE, 1 << 12),
        ("two-sided metal inside out", Object::new(inside_out(), two_sided(0.4)), WIDE, 1 << 14),
    ] {
        let z = bias(&box_with(vec![object], projection), spp, 4);
        assert!(z.abs() < 5.0, "{name}: {z} standard errors");
    }
}

#[test]
fn radiance_in_glass_scales_with_the_squared_index() {
    // The camera and the floor are inside the sphere, the light is outside.
    let inside = Material::Dielectric(Dielectric::clear(1.5));
    let mut scene = box_with(vec![Object::new(ball(Vec3::Y, 3.1), inside)], WIDE);
    scene.objects[1].shape = ball(Vec3::new(0.0, 7.0, 0.0), 2.0);
    let z = bias(&scene, 1 << 13, 3);
    assert!(z.abs() < 5.0, "{z} standard errors");
}

#[test]
fn there_are_as_many_paths_as_there_should_be() {
    for samples in [1, 3, 4, 7, 64] {
        let of = |pixel| (0..samples).filter_map(move |sample| LightTracing::path(3, pixel, sample));
        let numbers: Vec<u32> = of(5).collect();
        assert_eq!(numbers, (0..numbers.len() as u32).collect::<Vec<_>>(), "each number once");
        let count = (0..4000).map(|pixel| of(pixel).count()).sum::<usize>() as f64;
        let expected = 4000.0 * f64::from(samples) / f64::from(SAMPLES_PER_LIGHT_PATH);
        assert!((count - expected).abs() < 4.0 * 4000f64.sqrt(), "{samples}: {count}, not {expected}");
    }
}
