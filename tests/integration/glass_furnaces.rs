//! Glass in light of radiance 1 from everywhere cannot be seen from outside, and inside everything has radiance η².

use etalon::envmap::EnvMap;
use etalon::math::Rgb;
use etalon::raster::Image;
use etalon::render::{Kernel, Sampling, Settings, Silent, render};
use etalon::scene::{
    Camera, Dielectric, Environment, Material, Mesh, Object, Projection, Rectangle, Request, Scene, Shape, Sphere,
};
use glam::{DMat3, DVec3, Vec3};
use std::sync::Arc;

/// Where and how large a furnace is: points p of the drawing are at `scale` R p + `offset`.
#[derive(Debug, Clone, Copy)]
struct Placement {
    name: &'static str,
    axes: DMat3,
    scale: f64,
    offset: DVec3,
}

impl Placement {
    fn point(&self, p: DVec3) -> DVec3 {
        self.scale * (self.axes * p) + self.offset
    }
}

fn placements() -> Vec<Placement> {
    let tilted = DMat3::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 1.1);
    let mirrored = tilted * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    let far = DVec3::new(1e6, -1e6, 1e6);
    let new = |name, axes, scale, offset| Placement { name, axes, scale, offset };
    vec![
        new("upright", DMat3::IDENTITY, 1.0, DVec3::ZERO),
        new("tilted", tilted, 1.0, DVec3::ZERO),
        new("mirrored", mirrored, 1.0, DVec3::new(0.3, 0.2, -0.1)),
        new("tiny", tilted, 1e-6, DVec3::ZERO),
        new("huge", tilted, 1e6, DVec3::ZERO),
        new("moved", DMat3::IDENTITY, 1.0, far),
        new("moved and tilted", tilted, 1.0, far),
        new("huge and moved", tilted, 1e3, far),
    ]
}

/// The corners of a box of 6 × 6 × 1.
fn corner(i: usize) -> DVec3 {
    let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
    DVec3::new(3.0 * sign(0), 3.0 * sign(1), 0.5 * sign(2))
}

/// The corners of its faces, in order around them.
const FACES: [[usize; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

/// The shapes of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Body {
    Sphere,
    /// A slab of six rectangles.
    Rectangles,
    /// The same of twelve triangles.
    Triangles,
}

fn body(kind: Body, placement: &Placement, eta: f32) -> Vec<Object> {
    let shapes = match kind {
        Body::Sphere => {
            let centre = placement.point(DVec3::ZERO).as_vec3();
            vec![Shape::Sphere(Sphere { centre, radius: placement.scale as f32 })]
        }
        Body::Rectangles => FACES
            .iter()
            .map(|face| {
                let [a, b, _, d] = face.map(|i| placement.point(corner(i)));
                let (x, y) = (0.5 * (b - a), 0.5 * (d - a));
                // A mirror turns the order around a face.
                let [x, y] = if placement.axes.determinant() < 0.0 { [y, x] } else { [x, y] };
                let centre = (a + 0.5 * (b - a) + 0.5 * (d - a)).as_vec3();
                Shape::Rectangle(Rectangle::new(centre, x.as_vec3(), y.as_vec3()).unwrap())
            })
            .collect(),
        Body::Triangles => {
            let corners: Vec<Vec3> = (0..8).map(|i| placement.point(corner(i)).as_vec3()).collect();
            let triangles = FACES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
            let turned = placement.axes.determinant() < 0.0;
            let triangles = triangles.map(|[a, b, c]| if turned { [a, c, b] } else { [a, b, c] });
            let triangles = triangles.map(|t| t.map(|i| i as u32)).collect();
            vec![Shape::Mesh(Arc::new(Mesh::new(corners, Vec::new(), triangles).unwrap()))]
        }
    };
    let glass = Material::Dielectric(Dielectric::clear(eta));
    shapes.into_iter().map(|shape| Object::new(shape, glass.clone())).collect()
}

/// A camera at a place of the drawing, looking along a direction of it.
struct View {
    name: &'static str,
    from: DVec3,
    towards: DVec3,
    /// The field of view in degrees, or half the width of parallel rays.
    field: Field,
    /// Whether the camera is in the body; `None` on its surface, where rounding decides for each ray.
    inside: Option<bool>,
}

#[derive(Clone, Copy)]
enum Field {
    Degrees(f64),
    Width(f64),
}

fn camera(view: &View, placement: &Placement) -> Camera {
    let projection = match view.field {
        Field::Degrees(degrees) => {
            let tan = (0.5 * degrees).to_radians().tan();
            Projection::Perspective { tan_half_width: tan, tan_half_height: tan }
        }
        Field::Width(half) => {
            let half = half * placement.scale;
            Projection::Orthographic { half_width: half, half_height: half }
        }
    };
    let forward = placement.axes * view.towards;
    Camera::look_at(
        placement.point(view.from),
        placement.point(view.from) + forward * placement.scale,
        DVec3::new(0.1, 0.9, 0.2),
        projection,
    )
    .unwrap()
}

fn views(body: Body, eta: f64) -> Vec<View> {
    let new = |name, from, towards, field, inside| View { name, from, towards, field, inside };
    let at = DVec3::new;
    // Within the critical angle of every face that it meets.
    let oblique = at(0.3, 0.2, -eta.max(1.0)).normalize();
    let mut views = vec![
        new("centre, 1 deg", DVec3::ZERO, oblique, Field::Degrees(1.0), Some(true)),
        new("centre, 0.01 deg", DVec3::ZERO, DVec3::NEG_Z, Field::Degrees(0.01), Some(true)),
        new("inside, parallel", at(0.02, 0.01, 0.03), DVec3::NEG_Z, Field::Width(0.05), Some(true)),
        new("outside, along the normal", at(0.0, 0.0, 5.0), DVec3::NEG_Z, Field::Width(0.7), Some(false)),
        new("outside, oblique", at(0.0, 0.0, 5.0), at(0.2, 0.1, -1.0).normalize(), Field::Degrees(60.0), Some(false)),
        new("outside, 179 deg", at(0.0, 0.0, 1.5), at(0.2, 0.1, -1.0).normalize(), Field::Degrees(179.0), Some(false)),
        new("far, 0.01 deg", at(0.0, 0.0, 5e3), DVec3::NEG_Z, Field::Degrees(0.01), Some(false)),
        new("far, parallel and oblique", 1e3 * at(0.6, 0.0, 0.8), at(-0.6, 0.0, -0.8), Field::Width(4.0), Some(false)),
    ];
    let surface = if body == Body::Sphere { 1.0 } else { 0.5 };
    for (name, towards) in [("on it, inwards", DVec3::NEG_Z), ("on it, outwards", DVec3::Z)] {
        views.push(new(name, at(0.0, 0.0, surface), towards, Field::Degrees(10.0), None));
    }
    if body == Body::Sphere {
        // No light is trapped in a sphere that passes within 1/η of its centre.
        let within = 0.9 * (1.0 / eta).min(1.0);
        views.push(new("centre, 179 deg", DVec3::ZERO, DVec3::NEG_Z, Field::Degrees(179.0), Some(true)));
        views.push(new(
            "inside, 120 deg",
            at(0.0, 0.6 * within, 0.8 * within),
            at(1.0, 0.0, 0.2).normalize(),
            Field::Degrees(120.0),
            Some(true),
        ));
    }
    views
}

const SIDE: usize = 16;

/// The mean radiance and its standard error.
fn mean(scene: &Scene, settings: &Settings) -> [f64; 2] {
    let request = Request { width: SIDE, height: SIDE, spp: 16, light_samples: 1, max_depth: 10_000 };
    let film = render(scene, &request, settings, &Silent).unwrap().part.film;
    let n = (SIDE * SIDE) as f64;
    let sum: f64 = film.image().pixels().iter().map(|p| f64::from(p.x)).sum();
    let square: f64 = film.standard_error().pixels().iter().map(|p| f64::from(p.x).powi(2)).sum();
    [sum / n, square.sqrt() / n]
}

fn failures(settings: &Settings, etas: &[f32], placements: &[Placement]) -> Vec<String> {
    let map = EnvMap::new(Image::from_fn(4, 2, |_, _| Rgb::ONE));
    let environment = Environment::upright(Arc::new(map), "constant", 1.0);
    let mut failures = Vec::new();
    for &eta in etas {
        for placement in placements {
            for kind in [Body::Sphere, Body::Rectangles, Body::Triangles] {
                // Rounded to 1/16, rectangles that share no corners leave gaps.
                if kind == Body::Rectangles && placement.name == "moved and tilted" {
                    continue;
                }
                for view in views(kind, f64::from(eta)) {
                    let scene = Scene {
                        name: "furnace".into(),
                        camera: camera(&view, placement),
                        objects: body(kind, placement, eta),
                        lights: Vec::new(),
                        environment: Some(environment.clone()),
                    }
                    .near_origin();
                    let [found, error] = mean(&scene, settings);
                    let inside = f64::from(eta).powi(2);
                    let expected = match view.inside {
                        Some(true) => [inside; 2],
                        Some(false) => [1.0; 2],
                        None => [inside.min(1.0), inside.max(1.0)],
                    };
                    let off = (expected[0] - found).max(found - expected[1]);
                    let fits = off <= 2e-3 * expected[1] && off <= 4.0 * error + 1e-5 * expected[1].max(1.0);
                    if !fits {
                        failures.push(format!(
                            "{kind:?} of {eta}, {}, {}, {:?} {:?}: {found} ± {error}, not {expected:?}",
                            placement.name, view.name, settings.sampling, settings.kernel
                        ));
                    }
                }
            }
        }
    }
    failures
}

const ETAS: [f32; 9] = [0.5, 0.75, 0.999_999_94, 1.000_000_1, 1.33, 1.42, 1.5, 2.4, 4.0];

#[test]
fn glass_in_uniform_light_is_invisible_and_has_eta_squared_inside() {
    let failures = failures(&Settings::default(), &ETAS, &placements());
    assert!(failures.is_empty(), "{} furnaces:\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn all_strategies_and_the_reference_see_the_same_furnaces() {
    let few: Vec<Placement> = placements().into_iter().filter(|p| p.name == "tilted").collect();
    let mut all = Vec::new();
    for sampling in Sampling::ALL {
        all.extend(failures(&Settings { sampling, ..Settings::default() }, &[0.75, 1.5], &few));
    }
    let reference = Settings { kernel: Kernel::Reference, sampling: Sampling::Mis, ..Settings::default() };
    all.extend(failures(&reference, &[0.75, 1.5], &few));
    assert!(all.is_empty(), "{} furnaces:\n{}", all.len(), all.join("\n"));
}
