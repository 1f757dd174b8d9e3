//! Light tracing and camera paths give the same image.

use super::*;
use crate::render::light_tracing::{LightTracing, SAMPLES_PER_LIGHT_PATH};
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

fn brushed() -> Material {
    Material::Conductor(Conductor { alpha: [0.1, 0.5], ..super::metal(0.0, Distribution::Ggx) })
}

fn two_sided(alpha: f32) -> Material {
    Material::Conductor(Conductor { two_sided: true, ..super::metal(alpha, Distribution::Beckmann) })
}

/// [`rounded`] with its corners in the other order.
fn inside_out(x: f32) -> Shape {
    let Shape::Mesh(mesh) = rounded(x) else { unreachable!() };
    let triangles = mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    Shape::Mesh(Arc::new(Mesh { triangles, ..(*mesh).clone() }))
}

/// Few triangles and normals far from theirs.
fn rounded(x: f32) -> Shape {
    let corners = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let mut shaders = Vec::new();
    for (a, b, c) in (0..8).map(|i| (i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2))) {
        let upright = (a + b + c) % 2 == 0;
        shaders.push(if upright { [a, b, c] } else { [a, c, b] });
    }
    let at = corners.map(|c| Vec3::new(x, 0.6, 0.0) + 0.55 * c);
    Shape::Mesh(Arc::new(Mesh::new(at.to_vec(), corners.to_vec(), shaders).unwrap()))
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
    let glass = Material::Dielectric(Dielectric::clear(1.5));
    let rough_glass = Material::Dielectric(Dielectric::rough(1.5, 0.3, Distribution::Ggx));
    let mirror = Material::Mirror { reflectance: Rgb::splat(0.9) };
    let upright = Rectangle::new(Vec3::new(1.0, 0.5, 0.0), 0.5 * Vec3::Y, 0.5 * Vec3::Z).unwrap();
    let white = Material::Diffuse { albedo: Rgb::splat(0.8) };
    let rough = Material::Dielectric(Dielectric::rough(1.5, 0.2, Distribution::Ggx));
    let coated = Material::CoatedDiffuse { albedo: Rgb::splat(0.5), eta: 1.5 };
    let multiple = Conductor { multiple_scattering: true, ..super::metal(0.8, Distribution::Ggx) };
    let parts = [(0.5, glass.clone()), (0.4, white.clone())];
    let [_, textured_mirror, textured_coat, textured_metal, textured_glass, ..] = &textures::materials()[..] else {
        unreachable!()
    };
    for (name, objects, projection, spp) in [
        ("rough glass", vec![sphere(rough)], WIDE, 1 << 14),
        ("coated", vec![sphere(coated)], WIDE, 1 << 13),
        ("multiple scattering", vec![sphere(Material::Conductor(multiple))], WIDE, 1 << 12),
        ("mixture", vec![sphere(Material::Mixture(parts.into_iter().collect()))], WIDE, 1 << 14),
        ("glass", vec![sphere(glass)], WIDE, 1 << 14),
        ("textured mirror", vec![sphere(textured_mirror.clone())], WIDE, 1 << 13),
        ("textured coat", vec![sphere(textured_coat.clone())], WIDE, 1 << 13),
        ("textured metal", vec![sphere(textured_metal.clone())], WIDE, 1 << 13),
        ("textured rough glass", vec![sphere(textured_glass.clone())], WIDE, 1 << 14),
        ("mirror", vec![sphere(mirror.clone())], WIDE, 1 << 14),
        ("flat mirror", vec![Object::new(Shape::Rectangle(upright), mirror)], WIDE, 1 << 12),
        ("broad metal", vec![sphere(metal(0.4))], WIDE, 1 << 12),
        ("sharp metal, parallel rays", vec![sphere(metal(0.05))], parallel, 1 << 14),
        // The backs face light and camera.
        ("two-sided metal", vec![Object::new(Shape::Rectangle(upright), two_sided(0.4))], WIDE, 1 << 12),
        ("two-sided polished metal", vec![Object::new(Shape::Rectangle(upright), two_sided(0.0))], WIDE, 1 << 12),
        ("two-sided metal inside out", vec![Object::new(inside_out(0.2), two_sided(0.4))], WIDE, 1 << 14),
        ("metal with normals of its own", vec![Object::new(rounded(0.2), metal(0.4))], WIDE, 1 << 14),
        ("brushed metal", vec![Object { axis: Vec3::new(0.6, 0.0, 0.8), ..sphere(brushed()) }], WIDE, 1 << 13),
        ("rough glass", vec![sphere(rough_glass)], WIDE, 1 << 14),
        ("plaster with normals of its own", vec![Object::new(rounded(-0.8), white), sphere(metal(0.4))], WIDE, 1 << 14),
    ] {
        let z = bias(&box_with(objects, projection), spp, 4);
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
fn many_lights_and_targets_share_the_paths() {
    let small = |i: i32| Object::new(ball(Vec3::new(-1.5 + 0.3 * i as f32, 0.3, -0.5), 0.12), metal(0.3));
    for spheres in [3, 11] {
        let mut scene = box_with((0..spheres).map(small).collect(), WIDE);
        let (bulb, emission) = (ball(Vec3::new(1.0, 1.5, -1.0), 0.2), Some(Emission::of_front(Rgb::splat(30.0))));
        scene.objects.push(Object { emission, ..Object::new(bulb, metal(0.5)) });
        let z = bias(&scene, 1 << 12, 3);
        assert!(z.abs() < 5.0, "{spheres} spheres: {z} standard errors");
    }
}

#[test]
fn light_of_the_environment_is_traced_through_glass_and_metal() {
    let glass = Material::Dielectric(Dielectric::clear(1.5));
    for objects in [vec![sphere(glass.clone())], vec![sphere(metal(0.3)), Object::new(rounded(-0.8), glass)]] {
        let mut scene = box_with(objects, WIDE);
        // A sun of a few texels beside the area light.
        scene.environment = Some(Environment::upright(Arc::new(EnvMap::new(busy())), "test", 1.0));
        let z = bias(&scene, 1 << 13, 4);
        assert!(z.abs() < 5.0, "{z} standard errors");
    }
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
