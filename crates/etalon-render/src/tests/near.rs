//! Rays leave surfaces of any size, place and tilt, and find what is close to them.

use super::*;
use glam::{DQuat, Quat};

/// A scene turned about z by an angle, and then moved.
fn moved(mut scene: Scene, angle: f32, by: Vec3) -> Scene {
    let turn = Quat::from_rotation_z(angle);
    let place = |p: Vec3| turn * p + by;
    for object in &mut scene.objects {
        object.shape = match &object.shape {
            Shape::Sphere(sphere) => Shape::Sphere(Sphere { centre: place(sphere.centre), ..*sphere }),
            Shape::Rectangle(rectangle) => {
                let [x, y] = rectangle.half_sides().map(|side| turn * side);
                Shape::Rectangle(Rectangle::new(place(rectangle.centre()), x, y).unwrap())
            }
            Shape::Mesh(mesh) => {
                let positions = mesh.positions.iter().map(|&p| place(p)).collect();
                Shape::Mesh(Arc::new(Mesh::new(positions, Vec::new(), mesh.triangles.clone()).unwrap()))
            }
        };
    }
    let turn = DQuat::from_rotation_z(f64::from(angle));
    let camera = &mut scene.camera;
    camera.position = turn * camera.position + by.as_dvec3();
    for axis in [&mut camera.right, &mut camera.up, &mut camera.forward] {
        *axis = turn * *axis;
    }
    scene
}

/// The mean of a small image, and its standard error.
fn of_small(scene: &Scene, settings: &Settings, max_depth: u32) -> (f64, f64) {
    mean(scene, &Request { width: 16, height: 16, spp: 64, light_samples: 1, max_depth }, settings)
}

/// Holds all strategies of both kernels to a mean that has a standard error itself; rounding adds `slack`.
fn assert_mean(case: &str, scene: &Scene, max_depth: u32, (expected, of_expected): (f64, f64), slack: f64) {
    for sampling in ALL {
        for kernel in [Kernel::Lanes, Kernel::Reference] {
            // The reference does not trace light.
            if sampling == Sampling::MisLt && kernel == Kernel::Reference {
                continue;
            }
            let settings = Settings { sampling, kernel, stream: StreamKind::Independent, ..Settings::default() };
            let (found, error) = of_small(scene, &settings, max_depth);
            let (bound, case) = (4.0 * error.hypot(of_expected) + slack, format!("{case} {sampling:?} {kernel:?}"));
            assert!((found - expected).abs() < bound, "{case}: {found} ± {error}, not {expected}");
        }
    }
}

/// The mean by BSDF samples of the reference, and its standard error.
fn by_bsdf(scene: &Scene, max_depth: u32) -> (f64, f64) {
    let (stream, kernel) = (StreamKind::Independent, Kernel::Reference);
    of_small(scene, &Settings { sampling: Sampling::Bsdf, kernel, stream, ..Settings::default() }, max_depth)
}

/// Light that a ground of albedo ½ under a white sky sends up beside a black sphere, which takes the share r² h/d³ of it.
#[test]
fn a_ground_of_any_size_is_in_the_shadow_of_what_stands_on_it() {
    let (mut scene, _) = sphere(Image::from_fn(8, 4, |_, _| Rgb::ONE));
    scene.camera = above(0.3, 0.2);
    let (radius, height) = (0.2, 0.3);
    let occluder = ball(Vec3::new(0.0, height as f32, 0.0), radius as f32);
    let distance = (0.3f64 * 0.3 + 0.2 * 0.2 + height * height).sqrt();
    let expected = 0.5 * (1.0 - radius * radius * height / distance.powi(3));
    for size in [1.0, 5e3, 5e4, 1e6] {
        let ground = Rectangle::new(Vec3::ZERO, size * Vec3::Z, size * Vec3::X).unwrap();
        for shape in [Shape::Rectangle(ground), triangles(&ground)] {
            let aside = Vec3::new(7.0, 0.0, -20.0);
            // Also as tilted as rounding leaves what was turned, and a little more.
            for (angle, by) in [(0.0, Vec3::ZERO), (0.0, aside), (0.4, Vec3::ZERO), (1.5e-7, aside), (1e-4, aside)] {
                // Rounding moves the corners of a larger tilted ground, and points of a larger triangle, by more than 0.01.
                let is_mesh = matches!(shape, Shape::Mesh(_));
                if angle != 0.0 && size > 1e4 || is_mesh && size > 1e5 {
                    continue;
                }
                scene.objects = vec![
                    Object::new(shape.clone(), Material::Diffuse { albedo: Rgb::splat(0.5) }),
                    Object::new(occluder.clone(), Material::Diffuse { albedo: Rgb::ZERO }),
                ];
                let scene = moved(scene.clone(), angle, by);
                let case = format!("{size} {angle} {by} {:?}", shape.bounds());
                assert_mean(&case, &scene, 1, (expected, 0.0), 5e-4);
            }
        }
    }
}

/// A light close behind a pane of rough glass lights it from there.
#[test]
fn rough_glass_passes_the_light_of_what_is_close_behind_it() {
    for distance in [1e-3, 0.1, 3.0] {
        let pane = Rectangle::new(Vec3::ZERO, 5.0 * Vec3::Z, 5.0 * Vec3::X).unwrap();
        let light = Rectangle::new(Vec3::new(0.3, -distance, 0.2), 0.5 * Vec3::Z, 0.5 * Vec3::X).unwrap();
        let glass = Material::Dielectric(Dielectric::rough(1.5, 0.4, Distribution::Ggx));
        let mut scene = floor(vec![emitter(Shape::Rectangle(light))], Vec::new());
        scene.objects[0] = Object::new(Shape::Rectangle(pane), glass);
        for (angle, x) in [(0.0, 0.0), (0.0, 100.0), (0.5, 0.0), (0.5, 5.0), (0.5, 100.0)] {
            // Rays start farther from the pane than the light is, for rounding.
            if angle != 0.0 && x / distance > 1e4 {
                continue;
            }
            let scene = moved(scene.clone(), angle, Vec3::new(x, 0.0, 0.0));
            let expected = by_bsdf(&scene, 1);
            assert!(expected.0 > 0.1, "{distance} {angle} {x}: {expected:?}");
            assert_mean(&format!("{distance} {angle} {x}"), &scene, 1, expected, 1e-3 * expected.0);
        }
    }
}

/// A flat emitter of glass sees no light of its own; through a sphere of glass that emits on both sides, the far side is seen.
#[test]
fn emitters_of_rough_glass_light_only_what_they_face() {
    let glass = Material::Dielectric(Dielectric::rough(1.5, 0.3, Distribution::Ggx));
    let emit = |shape, two_sided| {
        let emission = Some(Emission { two_sided, ..Emission::of_front(Rgb::splat(2.0)) });
        Object { emission, ..Object::new(shape, glass.clone()) }
    };
    let flat = Rectangle::new(Vec3::ZERO, Vec3::Z, Vec3::X).unwrap();
    let ball = ball(Vec3::new(0.3, -1.0, 0.2), 1.0);
    for (shape, two_sided) in [
        (Shape::Rectangle(flat), false),
        (Shape::Rectangle(flat), true),
        (triangles(&flat), false),
        (ball.clone(), false),
        (ball, true),
    ] {
        let is_alone = !two_sided || !matches!(shape, Shape::Sphere(_));
        let mut scene = floor(Vec::new(), Vec::new());
        scene.objects = vec![emit(shape.clone(), two_sided)];
        for (angle, x) in [(0.0, 0.0), (0.7, 3.0)] {
            let scene = moved(scene.clone(), angle, Vec3::new(x, 0.0, 0.0));
            let expected = if is_alone { (2.0, 0.0) } else { by_bsdf(&scene, 2) };
            assert_mean(&format!("{:?} {two_sided} {angle}", shape.bounds()), &scene, 2, expected, 1e-5);
        }
    }
}

/// A cover close below a light leaves nothing of it.
#[test]
fn a_cover_close_to_a_light_hides_it() {
    let black = Material::Diffuse { albedo: Rgb::ZERO };
    let level =
        |height: f32, size: f32| Rectangle::new(Vec3::new(0.3, height, 0.2), size * Vec3::X, size * Vec3::Z).unwrap();
    for (gap, angle) in [(1e-4, 0.0), (1e-5, 0.0), (1e-5, 0.4)] {
        let cover = level(0.5 - gap, 0.6);
        let panel = level(0.5, 0.5);
        let point =
            Light::Point { position: Vec3::new(0.3, 0.5, 0.2), intensity: Rgb::ONE, falloff: Falloff::InverseSquare };
        for cover in [Shape::Rectangle(cover), triangles(&cover)] {
            let cover = Object::new(cover, black.clone());
            for (objects, lights) in [
                (vec![emitter(Shape::Rectangle(panel)), cover.clone()], Vec::new()),
                (vec![emitter(triangles(&panel)), cover.clone()], Vec::new()),
                (vec![cover.clone()], vec![point.clone()]),
                (vec![cover.clone()], vec![Light::Rectangle { rectangle: panel, radiance: Rgb::ONE }]),
            ] {
                let mut scene = floor(objects, Vec::new());
                scene.camera.position.y = 0.4;
                // Lights without a surface are not turned.
                scene.lights = if angle == 0.0 { lights } else { Vec::new() };
                let scene = moved(scene, angle, Vec3::ZERO);
                for sampling in ALL {
                    let (found, _) = of_small(&scene, &Settings { sampling, ..Settings::default() }, 1);
                    assert_eq!(found, 0.0, "{gap} {angle} {sampling:?}");
                }
            }
        }
    }
}

/// The triangles of a large tilted ground do not shadow each other where they meet.
#[test]
fn a_large_tilted_ground_under_a_white_sky_is_not_in_its_own_shadow() {
    let (mut scene, _) = sphere(Image::from_fn(8, 4, |_, _| Rgb::ONE));
    for half_width in [1.0, 0.01] {
        scene.camera =
            Camera { projection: Projection::Orthographic { half_width, half_height: half_width }, ..above(0.0, 0.0) };
        // Many triangles meet in the middle.
        let around = |i: u32| 5e3 * Vec3::new((0.3 * i as f32).cos(), 0.0, (0.3 * i as f32).sin());
        let corners = std::iter::once(Vec3::ZERO).chain((0..=21).map(around)).collect();
        let mesh = Mesh::new(corners, Vec::new(), (1..=21).map(|i| [0, i, i + 1]).collect()).unwrap();
        let white = Material::Diffuse { albedo: Rgb::splat(0.5) };
        scene.objects = vec![Object::new(Shape::Mesh(Arc::new(mesh)), white)];
        for angle in [0.0, 0.3, 1.1] {
            let scene = moved(scene.clone(), angle, Vec3::ZERO);
            let settings = Settings { sampling: Sampling::Bsdf, ..Settings::default() };
            let (found, _) = of_small(&scene, &settings, 1);
            assert!((found - 0.5).abs() < 1e-6, "{half_width} {angle}: {found}");
        }
    }
}
