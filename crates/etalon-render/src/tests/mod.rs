//! Renders against exact answers, and against each other.

mod choice;
mod filters;
mod light_tracing;
mod long_paths;
mod near;
mod reference;
mod strategies;
mod textures;

use super::*;
use etalon_core::envmap::EnvMap;
use etalon_core::envmap::samplers::MapSampling;
use etalon_core::envmap::samplers::cut_lights::MEDIAN_CUT;
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_core::sampling::stream::StreamKind;
use etalon_core::scene::{
    Camera, Conductor, Dielectric, Distribution, Emission, Environment, Falloff, FilterShape, Light, Material, Mesh,
    Object, PixelFilter, Projection, Rectangle, Request, Scene, Shape, Sphere, builtin,
};
use glam::{DVec3, Vec3};
use std::sync::Arc;

pub fn sphere(image: Image) -> (Scene, Request) {
    let (scene, request) = builtin::sphere_env(Environment::upright(Arc::new(EnvMap::new(image)), "test", 1.0));
    (scene, Request { width: 24, height: 24, spp: 4, ..request })
}

fn busy() -> Image {
    Image::from_fn(16, 8, |x, y| Rgb::new((x % 3) as f32, (y % 2) as f32, if (x, y) == (5, 2) { 50.0 } else { 0.0 }))
}

const ALL: [Sampling; 5] = Sampling::ALL;

/// What `work` makes on n threads.
pub fn on_threads<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap().install(work)
}

#[test]
fn threads_and_specialised_kernels_change_no_bit() {
    let small = Request { width: 24, height: 18, spp: 8, light_samples: 1, max_depth: 4 };
    for (scene, request) in [sphere(busy()), (textures::many_textures(), small)] {
        for sampling in ALL {
            for stream in [StreamKind::Sobol, StreamKind::Independent] {
                let settings = Settings { sampling, stream, seed: 3, ..Settings::default() };
                let on = |threads, settings: Settings| {
                    on_threads(threads, || render(&scene, &request, &settings, &Silent).unwrap().image)
                };
                let one = on(1, settings);
                assert_eq!(one, on(3, settings));
                assert_eq!(one, on(2, Settings { general: true, ..settings }), "{sampling:?}");
                assert_ne!(one, on(1, Settings { seed: 4, ..settings }));
            }
        }
    }
}

/// A sphere that reflects all light, also half of it as a mirror, in a white furnace, after one scattering.
#[test]
fn a_white_sphere_in_a_white_furnace_is_invisible() {
    let (mut scene, request) = sphere(Image::from_fn(8, 4, |_, _| Rgb::ONE));
    let request = Request { spp: 64, max_depth: 1, ..request };
    let (diffuse, mirror) = (Material::Diffuse { albedo: Rgb::ONE }, Material::Mirror { reflectance: Rgb::ONE });
    let mixture = Material::Mixture([(0.5, diffuse.clone()), (0.5, mirror)].into_iter().collect());
    for material in [diffuse, mixture] {
        scene.objects[0].material = material;
        for sampling in ALL {
            let (mean, error) = mean(&scene, &request, &Settings { sampling, ..Settings::default() });
            // BSDF sampling is exact sample by sample; MIS only on average.
            assert!((mean - 1.0).abs() < 4.0 * error + 1e-5, "{sampling:?}: {mean} ± {error}");
        }
    }
}

#[test]
fn a_scene_without_light_is_black() {
    let (mut scene, request) = sphere(Image::new(4, 2));
    for sampling in ALL {
        let settings = Settings { sampling, ..Settings::default() };
        let rendered = render(&scene, &request, &settings, &Silent).unwrap();
        assert!(rendered.image.pixels().iter().all(|p| *p == Rgb::ZERO));
        assert_eq!(rendered.dropped, Dropped::default());
    }
    scene.environment = None;
    let rendered = render(&scene, &request, &Settings::default(), &Silent).unwrap();
    assert!(rendered.image.pixels().iter().all(|p| *p == Rgb::ZERO));
}

#[test]
fn impossible_requests_are_refused() {
    let (scene, request) = sphere(busy());
    for bad in [
        Request { width: 0, ..request },
        Request { height: usize::MAX, ..request },
        Request { spp: 0, ..request },
        Request { light_samples: 0, ..request },
        Request { spp: u32::MAX, light_samples: 2, ..request },
        Request { light_samples: (1 << 16) + 1, ..request },
        Request { max_depth: (1 << 16) + 1, ..request },
    ] {
        assert!(render(&scene, &bad, &Settings::default(), &Silent).is_err(), "{bad:?}");
    }
    let density = Some(MapSampling::COSINE_COMPENSATED);
    let alone = Settings { density, sampling: Sampling::Light, ..Settings::default() };
    assert!(render(&scene, &request, &alone, &Silent).is_err());
    // Fixed lights hold all of the map's light: BSDF samples would find it a second time.
    for (sampling, regions) in
        [(Sampling::Mis, 16), (Sampling::Bsdf, 16), (Sampling::Light, 0), (Sampling::Light, u32::MAX)]
    {
        let density = Some(MapSampling::with_regions(MEDIAN_CUT, regions));
        let fixed = Settings { sampling, density, ..Settings::default() };
        assert!(render(&scene, &request, &fixed, &Silent).is_err(), "{sampling:?} {regions}");
    }
}

/// A camera of parallel rays that looks down at (x, 0, z), as one pixel of a side of 10⁻³.
fn above(x: f64, z: f64) -> Camera {
    Camera {
        position: DVec3::new(x, 0.5, z),
        right: DVec3::X,
        up: DVec3::NEG_Z,
        forward: DVec3::NEG_Y,
        projection: Projection::Orthographic { half_width: 5e-4, half_height: 5e-4 },
        filter: PixelFilter::default(),
    }
}

/// A floor of albedo ½ under some light, with the camera above it.
fn floor(objects: Vec<Object>, lights: Vec<Light>) -> Scene {
    let ground = Rectangle::new(Vec3::ZERO, 10.0 * Vec3::Z, 10.0 * Vec3::X).unwrap();
    let material = Material::Diffuse { albedo: Rgb::splat(0.5) };
    let mut all = vec![Object::new(Shape::Rectangle(ground), material)];
    all.extend(objects);
    Scene { name: "floor".into(), camera: above(0.3, 0.2), objects: all, lights, environment: None }
}

fn emitter(shape: Shape) -> Object {
    let emission = Some(Emission::of_front(Rgb::splat(2.0)));
    Object { emission, ..Object::new(shape, Material::Diffuse { albedo: Rgb::ZERO }) }
}

fn ball(centre: Vec3, radius: f32) -> Shape {
    Shape::Sphere(Sphere { centre, radius })
}

fn metal(alpha: f32, distribution: Distribution) -> Conductor {
    Conductor::new(Rgb::splat(0.2), Rgb::splat(3.0), alpha, distribution)
}

/// A rectangle as two triangles.
fn triangles(rectangle: &Rectangle) -> Shape {
    Mesh::new(rectangle.corners().to_vec(), Vec::new(), vec![[0, 1, 2], [0, 2, 3]]).unwrap().into()
}

/// Spheres of these materials, in rows.
fn balls(materials: impl IntoIterator<Item = Material>) -> impl Iterator<Item = Object> {
    materials.into_iter().enumerate().map(|(i, material)| {
        let centre = Vec3::new(0.5 * (i % 4) as f32 - 0.75, 0.3, 0.6 * (i / 4) as f32 - 0.4);
        Object::new(ball(centre, 0.24), material)
    })
}

/// A light of that radiance around everything.
fn around(radiance: f32) -> Object {
    let emission = Some(Emission { two_sided: true, ..Emission::of_front(Rgb::splat(radiance)) });
    Object { emission, ..emitter(ball(Vec3::ZERO, 6.0)) }
}

/// More lights than are sampled one by one, of every shape: spheres, triangles and points in a light tree, a rectangle and a
/// two-sided sphere around everything; on a floor, with glass and metal.
fn many_lights() -> Scene {
    let bulb = |x: f32, z: f32| emitter(ball(Vec3::new(x, 1.2, z), 0.1));
    let mut objects: Vec<Object> = (0..9).map(|i| bulb((i % 3) as f32 - 1.0, (i / 3) as f32 - 1.0)).collect();
    let corners = vec![
        Vec3::new(-1.0, 0.8, 0.3),
        Vec3::new(-0.5, 0.8, 0.3),
        Vec3::new(-0.7, 0.9, 0.8),
        Vec3::new(-1.2, 0.7, 0.5),
    ];
    let mesh = Mesh::new(corners, Vec::new(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    objects.push(emitter(Shape::Mesh(Arc::new(mesh))));
    objects.push(around(0.02));
    let sphere = |x, material| Object::new(ball(Vec3::new(x, 0.4, 0.0), 0.3), material);
    objects.push(sphere(0.4, Material::Dielectric(Dielectric::clear(1.5))));
    objects.push(sphere(-0.4, Material::Conductor(metal(0.2, Distribution::Ggx))));
    let point =
        Light::Point { position: Vec3::new(0.5, 1.0, 1.5), intensity: Rgb::ONE, falloff: Falloff::InverseSquare };
    let mut scene = floor(objects, vec![point]);
    let projection = Projection::Perspective { tan_half_width: 0.5, tan_half_height: 0.5 };
    scene.camera = Camera::look_at(DVec3::new(0.0, 2.0, 2.5), DVec3::ZERO, DVec3::Y, projection).unwrap();
    scene.name = "many lights".into();
    scene
}

/// Radiance that the floor sends up, by direct light alone, and its standard error.
fn rendered_mean(scene: &Scene, settings: &Settings) -> (f64, f64) {
    let request = Request { width: 1, height: 1, spp: 4096, light_samples: 1, max_depth: 1 };
    mean(scene, &request, settings)
}

/// Holds that radiance, by every strategy, to its exact value.
fn assert_radiance(scene: &Scene, expected: f64) {
    for sampling in ALL {
        for stream in [StreamKind::Independent, StreamKind::Sobol] {
            let (found, error) = rendered_mean(scene, &Settings { sampling, stream, ..Settings::default() });
            let bound = 4.0 * error + 2e-5 * expected;
            assert!((found - expected).abs() < bound, "{sampling:?} {stream:?}: {found} ± {error}, not {expected}");
        }
    }
}

/// Irradiance from a polygon of radiance 1 at the origin, whose normal is +y: Lambert's formula, ½ Σ of the angles of the
/// edges times the y of their planes' normals. Source: Arvo, "The Irradiance Jacobian for Partially Occluded Polyhedral
/// Sources", SIGGRAPH 1994.
fn irradiance(corners: [DVec3; 4]) -> f64 {
    let edge = |i: usize| {
        let (a, b) = (corners[i].normalize(), corners[(i + 1) % 4].normalize());
        a.angle_between(b) * a.cross(b).normalize().y
    };
    (0.5 * (0..4).map(edge).sum::<f64>()).abs()
}

#[test]
fn rectangular_lights_give_lamberts_irradiance() {
    let ceiling = Rectangle::new(Vec3::new(0.0, 1.0, 0.0), 0.4 * Vec3::X, 0.3 * Vec3::Z).unwrap();
    let tilted = Rectangle::new(Vec3::new(-0.5, 0.8, 0.0), Vec3::new(0.3, 0.3, 0.0), Vec3::new(0.0, 0.0, 0.2));
    for panel in [ceiling, tilted.unwrap()] {
        // The front must face the floor.
        let [x, y] = panel.half_sides();
        let panel = if panel.normal().y > 0.0 { Rectangle::new(panel.centre(), y, x).unwrap() } else { panel };
        let corners = panel.corners().map(|c| c.as_dvec3() - DVec3::new(0.3, 0.0, 0.2));
        let expected = 2.0 * irradiance(corners) * 0.5 / std::f64::consts::PI;
        for shape in [Shape::Rectangle(panel), triangles(&panel)] {
            assert_radiance(&floor(vec![emitter(shape)], Vec::new()), expected);
        }
        let invisible = Light::Rectangle { rectangle: panel, radiance: Rgb::splat(2.0) };
        assert_radiance(&floor(Vec::new(), vec![invisible]), expected);
    }
}

#[test]
fn spheres_light_and_hide_by_their_discs() {
    // The share of cos θ / π of a sphere above the horizon is (r/d)² cos θ, of one right above (r/d)².
    let centre = Vec3::new(0.0, 1.0, 0.0);
    let to = centre.as_dvec3() - DVec3::new(0.3, 0.0, 0.2);
    let light = floor(vec![emitter(ball(centre, 0.3))], Vec::new());
    assert_radiance(&light, 0.5 * 2.0 * 0.09 / to.length_squared() * to.y / to.length());
    // In a light around the scene, with the camera below the sphere.
    let black = Object::new(ball(Vec3::new(0.3, 1.2, 0.2), 0.6), Material::Diffuse { albedo: Rgb::ZERO });
    assert_radiance(&floor(vec![around(2.0), black], Vec::new()), 0.5 * 2.0 * (1.0 - 0.25));
}

#[test]
fn delta_lights_and_the_hemisphere_have_their_closed_forms() {
    let position = Vec3::new(0.0, 1.0, 0.0);
    let to = DVec3::new(0.0, 1.0, 0.0) - DVec3::new(0.3, 0.0, 0.2);
    let cos = to.y / to.length();
    let point = |falloff| Light::Point { position, intensity: Rgb::ONE, falloff };
    let slanted = Vec3::new(1.0, -2.0, 0.5).normalize();
    for (light, expected) in [
        (point(Falloff::InverseSquare), cos / to.length_squared()),
        (point(Falloff::None), cos),
        (Light::Directional { direction: slanted, irradiance: Rgb::ONE }, f64::from(-slanted.y)),
    ] {
        let (found, _) = rendered_mean(&floor(Vec::new(), vec![light.clone()]), &Settings::default());
        let expected = expected * 0.5 / std::f64::consts::PI;
        assert!((found / expected - 1.0).abs() < 2e-3, "{light:?}: {found} {expected}");
    }
    let sky = Light::Hemisphere { radiance: Rgb::splat(3.0) };
    assert_radiance(&floor(Vec::new(), vec![sky]), 1.5);
}

/// The mean of all pixels in red, and its standard error.
fn mean(scene: &Scene, request: &Request, settings: &Settings) -> (f64, f64) {
    let film = render(scene, request, settings, &Silent).unwrap().part.film;
    let (image, errors) = (film.image(), film.standard_error());
    let count = image.pixels().len() as f64;
    let sum: f64 = image.pixels().iter().map(|p| f64::from(p.x)).sum();
    let square: f64 = errors.pixels().iter().map(|p| f64::from(p.x).powi(2)).sum();
    (sum / count, square.sqrt() / count)
}

/// The difference of two renders' means in standard errors, for the mean of all channels.
fn z(scene: &Scene, request: &Request, a: &Settings, b: &Settings) -> f64 {
    let mean = |settings: &Settings| {
        let film = render(scene, request, settings, &Silent).unwrap().part.film;
        let (image, errors) = (film.image(), film.standard_error());
        let sum: f64 = image.pixels().iter().map(|p| f64::from(p.element_sum())).sum();
        // Channels of a pixel rise and fall together.
        let square: f64 = errors.pixels().iter().map(|p| f64::from(p.element_sum()).powi(2)).sum();
        (sum, square)
    };
    let ((a, va), (b, vb)) = (mean(a), mean(b));
    (a - b) / (va + vb).sqrt()
}

/// A conductor of 2 by 2 in the plane z = 0, in orthographic projection from above under a map: a rectangle or a mesh, whose normal
/// is +z or, turned over, −z.
fn conductor(alpha: f32, two_sided: bool, mesh: bool, turned: bool) -> (Scene, Request) {
    let (mut scene, request) = sphere(busy());
    let (x, y) = if turned { (Vec3::Y, Vec3::X) } else { (Vec3::X, Vec3::Y) };
    let rectangle = Rectangle::new(Vec3::ZERO, x, y).unwrap();
    scene.objects[0].shape = if mesh { triangles(&rectangle) } else { Shape::Rectangle(rectangle) };
    scene.objects[0].material = Material::Conductor(Conductor { two_sided, ..metal(alpha, Distribution::Ggx) });
    (scene, request)
}

#[test]
fn only_a_two_sided_conductor_reflects_at_its_back() {
    for (alpha, mesh) in [(0.0, false), (0.0, true), (0.1, false), (0.1, true), (0.5, false), (0.5, true)] {
        for sampling in ALL {
            let settings = Settings { sampling, ..Settings::default() };
            let image = |two_sided, turned| {
                let (scene, request) = conductor(alpha, two_sided, mesh, turned);
                render(&scene, &request, &settings, &Silent).unwrap().image
            };
            let (front, back) = (image(true, false), image(true, true));
            let off = etalon_core::raster::compare(&front, &back).unwrap();
            let level = off.mean_a;
            assert!(level > 0.1 && off.rmse < 1e-4 * level, "{alpha} {sampling:?} {mesh}: {off:?}");
            assert_eq!(front, image(false, false), "{alpha} {sampling:?} {mesh}");
            assert!(image(false, true).pixels().iter().all(|p| *p == Rgb::ZERO), "{alpha} {sampling:?} {mesh}");
        }
    }
}

#[test]
fn the_furnace_shows_what_its_description_says() {
    let (scene, request) = builtin::furnace();
    let request = Request { width: 240, height: 60, spp: 64, ..request };
    let image = render(&scene, &request, &Settings::default(), &Silent).unwrap().image;
    for (object, expected) in scene.objects.iter().zip([1.0, 0.996, 1.0, 0.891]) {
        let Shape::Sphere(sphere) = object.shape else { panic!("{object:?}") };
        // 25 pixels to the unit, the origin in the middle.
        let inside = |x: usize, y: usize| {
            let (x, y) = ((x as f32 - 119.5) / 25.0, (29.5 - y as f32) / 25.0);
            (x - sphere.centre.x).hypot(y - sphere.centre.y) < sphere.radius - 0.04
        };
        let places = (0..60).flat_map(|y| (0..240).map(move |x| (x, y))).filter(|&(x, y)| inside(x, y));
        let light: Vec<f32> = places.map(|(x, y)| image.get(x, y).x).collect();
        let mean = light.iter().sum::<f32>() / light.len() as f32;
        assert!((mean - expected).abs() < 3e-3, "{:?}: {mean}, not {expected}", object.material);
    }
}
