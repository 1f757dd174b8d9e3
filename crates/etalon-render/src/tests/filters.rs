//! Pixel filters: renders against convolutions in closed form, light paths against camera paths, at the border, too.

use super::light_tracing::{WIDE, box_with, sphere};
use super::*;
use crate::film::Film;
use etalon_stats::estimate::Estimate;

/// The integral of exp(−t²/(2σ²)) up to x, except for a constant.
fn below(x: f64, sigma: f64) -> f64 {
    sigma * (0.5 * std::f64::consts::PI).sqrt() * libm::erf(x / sigma / 2f64.sqrt())
}

/// The share of a filter of that radius at distances from its centre up to x.
fn share(shape: FilterShape, radius: f64, x: f64) -> f64 {
    let x = x.clamp(-radius, radius);
    match shape {
        FilterShape::Box => 0.5 + 0.5 * x / radius,
        FilterShape::Triangle => 0.5 + x / radius - 0.5 * x * x.abs() / (radius * radius),
        FilterShape::Gaussian { sigma } => {
            let edge = (-0.5 * (radius / sigma).powi(2)).exp();
            let up_to = |x: f64| below(x, sigma) - x * edge;
            0.5 + 0.5 * up_to(x) / up_to(radius)
        }
    }
}

/// The share of a Gaussian that is cut off at its radius: the planted fault.
fn share_of_cut_off(radius: f64, x: f64) -> f64 {
    let FilterShape::Gaussian { sigma } = FILTER.parse::<PixelFilter>().unwrap().shape() else { unreachable!() };
    0.5 + 0.5 * below(x.clamp(-radius, radius), sigma) / below(radius, sigma)
}

/// The filter of the planted fault.
const FILTER: &str = "gaussian:1,0.5";
const SIZE: usize = 8;

/// An emitter of radiance 1 that begins at a film position and goes on beyond the right and the lower edge of the image.
fn corner(film: [f64; 2], filter: &str) -> Scene {
    let half = SIZE as f64 / 2.0;
    let projection = Projection::Orthographic { half_width: half, half_height: half };
    let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, projection).unwrap();
    // A unit of length is a pixel.
    let [x, y] = [(film[0] - half) as f32, (half - film[1]) as f32];
    let centre = Vec3::new(x + 20.0, y - 20.0, -1.0);
    let rectangle = Rectangle::new(centre, 20.0 * Vec3::X, 20.0 * Vec3::Y).unwrap();
    let black = Material::Diffuse { albedo: Rgb::ZERO };
    let emission = Some(Emission { two_sided: true, ..Emission::of_front(Rgb::ONE) });
    let object = Object { emission, ..Object::new(Shape::Rectangle(rectangle), black) };
    let camera = Camera { filter: filter.parse().unwrap(), ..camera };
    Scene { name: "corner".into(), camera, objects: vec![object], lights: Vec::new(), environment: None }
}

/// The largest error of a pixel, in standard errors of its exact distribution: a sample sees the emitter or it does not.
fn worst(scene: &Scene, film: [f64; 2], share: impl Fn(usize, f64) -> f64) -> f64 {
    const SPP: u32 = 1 << 16;
    let request = Request { width: SIZE, height: SIZE, spp: SPP, light_samples: 1, max_depth: 0 };
    let settings = Settings { stream: StreamKind::Independent, seed: 5, ..Settings::default() };
    let image = render(scene, &request, &settings, &Silent).unwrap().image;
    let z = |i: usize| {
        let centre = [i % SIZE, i / SIZE].map(|at| at as f64 + 0.5);
        let p = share(0, centre[0] - film[0]) * share(1, centre[1] - film[1]);
        let found = f64::from(image.pixels()[i].x);
        // One sample more, because counts of rare events are not normally distributed.
        let error = (p * (1.0 - p) / f64::from(SPP)).sqrt() + 1.0 / f64::from(SPP);
        (found - p).abs() / error
    };
    (0..SIZE * SIZE).map(z).fold(0.0, f64::max)
}

/// None of 1024 pixels is off by six standard errors (by chance 2·10⁻⁶); an error of 0.015 is found with 90 % probability.
#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn the_corner_of_an_emitter_is_its_convolution() {
    for film in [[3.3, 2.8], [-0.6, 7.7]] {
        let boxes_and_triangles = ["box", "box:0.3", "box:1.7x0.5", "triangle:1", "triangle:2x1"];
        for name in boxes_and_triangles.into_iter().chain([FILTER, "gaussian:1.5,0.5", "gaussian:0.5x2,0.8"]) {
            let scene = corner(film, name);
            let filter = scene.camera.filter;
            let z = worst(&scene, film, |axis, x| share(filter.shape(), filter.radius()[axis], x));
            assert!(z < 6.0, "{name} at {film:?}: {z} standard errors");
        }
        let z = worst(&corner(film, FILTER), film, |_, x| share_of_cut_off(1.0, x));
        assert!(z > 6.0, "the planted fault is found at {film:?}: {z} standard errors");
    }
}

/// A difference between means of images, in standard errors, and the smallest relative one that is found with 90 % probability.
struct Bias {
    z: f64,
    detectable: f64,
}

/// Standard errors at which a bias is found: with the 96 images of a test, by chance with a probability of 10⁻⁶.
const FOUND: f64 = 5.0;

/// The bias of `mis+lt` against `mis` in an image of 2 × 2 pixels; and the same if light paths contributed only from inside of the
/// image, to pixels that have this share of their filter there.
fn biases_at_the_border(scene: &Scene, inside: f64) -> [Bias; 2] {
    const ROUNDS: u64 = 96;
    let request = Request { width: 2, height: 2, spp: 1 << 12, light_samples: 1, max_depth: 4 };
    let film = |sampling, seed| {
        let settings = Settings { sampling, stream: StreamKind::Independent, seed, ..Settings::default() };
        render(scene, &request, &settings, &Silent).unwrap().part.film
    };
    let (mut differences, mut mean) = ([Vec::new(), Vec::new()], 0.0);
    for round in 0..ROUNDS {
        let (tested, other) = (film(Sampling::MisLt, 2 * round), film(Sampling::Mis, 2 * round + 1));
        let by_camera = |film: &Film| film.pixels().iter().map(|pixel| f64::from(pixel.mean().x)).sum::<f64>();
        let whole: f64 = tested.estimates().map(|estimate| f64::from(estimate.mean.x)).sum();
        let (part, expected) = (by_camera(&tested), by_camera(&other));
        differences[0].push(whole - expected);
        differences[1].push(part + inside * (whole - part) - expected);
        mean += expected / ROUNDS as f64;
    }
    differences.map(|differences| {
        let Estimate { value, standard_error, .. } = Estimate::mean(&differences);
        Bias { z: value / standard_error, detectable: (FOUND + 1.28) * standard_error / mean }
    })
}

/// All pixels are at the border. The planted fault leaves out what comes from outside, in proportion to the filter.
#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn light_paths_from_outside_of_the_image_contribute_to_its_border() {
    let parallel = Projection::Orthographic { half_width: 0.6, half_height: 0.6 };
    for (projection, filter) in [(WIDE, "gaussian:1.5,0.5"), (parallel, "box:1"), (parallel, "triangle:2x1")] {
        let glass = Material::Dielectric(Dielectric::clear(1.5));
        let mut scene = box_with(vec![sphere(glass)], projection);
        scene.camera.filter = filter.parse().unwrap();
        // The image begins ½ before the centre of a pixel and ends 1½ behind it, or the other way round.
        let within = |radius| {
            let up_to = |x| share(scene.camera.filter.shape(), radius, x);
            up_to(1.5) - up_to(-0.5)
        };
        let [rx, ry] = scene.camera.filter.radius();
        let [right, faulty] = biases_at_the_border(&scene, within(rx) * within(ry));
        println!("{filter}: {} and {} standard errors; {} is found", right.z, faulty.z, right.detectable);
        assert!(right.detectable < 0.05, "{filter}: {}", right.detectable);
        assert!(right.z.abs() < FOUND, "{filter}: {} standard errors", right.z);
        assert!(faulty.z.abs() > FOUND, "{filter}: the planted fault is found: {} standard errors", faulty.z);
    }
}

#[test]
fn films_of_other_filters_are_others() {
    let (mut scene, request) = builtin::cornell_spheres();
    let mut fingerprint = |filter: &str| {
        scene.camera.filter = filter.parse().unwrap();
        crate::job::fingerprint(&scene, &request, &Settings::default())
    };
    let plain = fingerprint("box");
    assert_eq!(plain, fingerprint("box:0.5"));
    for other in ["box:0.51", "triangle:0.5", "gaussian", "gaussian:1.5,0.51"] {
        assert_ne!(plain, fingerprint(other), "{other}");
    }
    assert_ne!(fingerprint("gaussian"), fingerprint("gaussian:1.5x1.4,0.5"));
}
