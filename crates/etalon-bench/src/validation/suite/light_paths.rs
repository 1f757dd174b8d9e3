//! Test cases: where light paths start, and light samples of the environment, as the kernel takes them.
//!
//! The density of a start is that of a place on the light (per area) and a direction (per solid angle); of the
//! environment that of a direction and a place on the plane perpendicular to it. Both are functions of four variables.
//! Tested are the places alone, and the directions from one place (of the environment the directions alone, and the
//! places for one direction).

use crate::validation::case::{Case, direction_density};
use etalon_core::envmap::EnvMap;
use etalon_core::envmap::samplers::{self, MapSampling, Method};
use etalon_core::error::Result;
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_core::scene::{
    Dielectric, Emission, EmitterVisibility, Environment, Material, Mesh, Object, Rectangle, Request, Scene, Shape,
    Sphere, builtin,
};
use etalon_render::Settings;
use etalon_render::probe::{Kind, NONE, PreparedScene, Start};
use etalon_stats::{Directions, Mass, Outcome, Pole, Protocol, Sample, Square, density, examine, sampler};
use glam::{DMat3, DVec3, Vec3};
use std::sync::Arc;

/// Spheres that light paths are traced to, seen from above: apart, overlapping, and one around the light.
pub const TARGETS: [(&str, [(Vec3, f32); 2]); 3] = [
    ("apart", [(Vec3::new(-1.0, -2.0, 0.0), 0.5), (Vec3::new(1.5, -2.5, 0.5), 0.8)]),
    ("overlapping", [(Vec3::new(-0.3, -2.0, 0.0), 0.6), (Vec3::new(0.4, -3.0, 0.0), 0.9)]),
    ("around", [(Vec3::new(0.0, 0.5, 0.0), 2.0), (Vec3::new(1.5, -2.5, 0.5), 0.8)]),
];

/// The place on the light that directions are tested for.
const PLACE: [f64; 2] = [0.3, 0.6];

/// Shapes of lights, with their fronts down. On the sphere, `PLACE` faces both targets.
pub fn shapes() -> [(&'static str, Shape); 3] {
    let (x, z) = (Vec3::new(0.4, 0.1, 0.0), Vec3::new(0.0, 0.0, 0.3));
    let mesh = Mesh { positions: vec![x - z, -x - z, x + 2.0 * z], triangles: vec![[0, 2, 1]], ..Mesh::default() };
    let rectangle = Rectangle::new(Vec3::ZERO, x, z).expect("the sides are perpendicular");
    [
        ("rectangle", Shape::Rectangle(rectangle)),
        ("triangle", Shape::Mesh(Arc::new(mesh))),
        ("sphere", Shape::Sphere(Sphere { centre: Vec3::ZERO, radius: 0.3 })),
    ]
}

/// A light of each shape beside a second light, glass spheres as targets, and a floor.
fn scene(shape: Option<(Shape, bool)>, targets: [(Vec3, f32); 2], environment: Option<Environment>) -> Scene {
    let emitter = |shape, two_sided, radiance| {
        let visibility = EmitterVisibility::Sampled;
        let emission = Some(Emission { radiance: Rgb::splat(radiance), two_sided, visibility });
        Object { emission, ..Object::new(shape, Material::Diffuse { albedo: Rgb::ZERO }) }
    };
    let glass = Material::Dielectric(Dielectric::clear(1.5));
    let floor = Rectangle::new(-4.0 * Vec3::Y, 9.0 * Vec3::Z, 9.0 * Vec3::X).expect("the sides are perpendicular");
    let mut objects = vec![Object::new(Shape::Rectangle(floor), Material::Diffuse { albedo: Rgb::ONE })];
    objects
        .extend(targets.map(|(centre, radius)| Object::new(Shape::Sphere(Sphere { centre, radius }), glass.clone())));
    if let Some((shape, two_sided)) = shape {
        let second = Shape::Sphere(Sphere { centre: Vec3::new(3.0, 0.0, 0.0), radius: 0.2 });
        objects.extend([emitter(shape, two_sided, 1.0), emitter(second, false, 2.0)]);
    }
    let (furnace, _) = builtin::furnace();
    Scene { objects, lights: Vec::new(), environment, ..furnace }
}

/// A test of a scene made ready.
fn case(
    name: String,
    scene: Scene,
    settings: Settings,
    test: impl Fn(&PreparedScene, &Protocol, u64) -> Result<Outcome> + Send + Sync + 'static,
) -> Case {
    Case::new(name, move |protocol, round| {
        let request = Request { width: 1, height: 1, spp: 1, light_samples: 1, max_depth: 4 };
        test(&PreparedScene::new(&scene, &request, &settings)?, protocol, round)
    })
}

/// A light path from the first light, or from the environment.
fn start(scene: &PreparedScene, u: [[f64; 2]; 3]) -> Option<Start> {
    let start = scene.light_tracing.as_ref()?.start(&scene.lights, scene.environment.as_deref(), u)?;
    start.light.is_none_or(|light| light == 0).then_some(start)
}

/// Area of the first light, and the probability that paths start there: power is π times radiance times area.
fn area_and_probability(scene: &PreparedScene) -> (f64, f64) {
    let emitted = scene.lights.all.iter().filter_map(|light| light.emitted());
    let of_lights: Vec<_> = emitted.map(|(radiance, area)| (f64::from(radiance.x), f64::from(area))).collect();
    let power = |&(radiance, area): &(f64, f64)| radiance * area;
    of_lights.first().map_or((0.0, 0.0), |first| (first.1, power(first) / of_lights.iter().map(power).sum::<f64>()))
}

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, shape) in shapes() {
        // All targets for one shape, overlapping ones for the others.
        let is_tested = |(targets, _): &(&str, _)| name == "rectangle" || *targets == "overlapping";
        for (targets, spheres) in TARGETS.into_iter().filter(is_tested) {
            let name = format!("light-path/direction/{name}/{targets}");
            cases.push(direction(name, shape.clone(), spheres, |pdf, _| pdf));
        }
        cases.push(place(format!("light-path/place/{name}"), shape));
    }
    for (targets, spheres) in &TARGETS[..2] {
        cases.push(environment_place(format!("light-path/environment/place/{targets}"), *spheres));
    }
    cases.push(environment_direction());
    cases.extend(environment_samples());
    cases
}

/// Directions from one place. `claim` makes of the pdf, and of the number of targets that contain a direction, the pdf
/// that is tested.
pub fn direction(name: String, shape: Shape, targets: [(Vec3, f32); 2], claim: fn(f64, usize) -> f64) -> Case {
    let two_sided = matches!(shape, Shape::Mesh(_));
    case(name, scene(Some((shape, two_sided)), targets, None), Settings::default(), move |scene, protocol, round| {
        let (area, _) = area_and_probability(scene);
        let (Some(tracing), Some(place)) = (&scene.light_tracing, scene.lights.all[0].point(PLACE.map(|u| u as f32)))
        else {
            return Ok(Outcome::open(0));
        };
        let containing = |w: Vec3| {
            let is_inside = |(centre, radius): &(Vec3, f32)| {
                let to = (*centre - place.position).as_dvec3();
                let [d2, r2] = [to.length_squared(), f64::from(*radius).powi(2)];
                d2 <= r2 || to.dot(w.as_dvec3()) >= (d2 - r2).sqrt()
            };
            targets.iter().filter(|target| is_inside(target)).count()
        };
        // Per solid angle, of directions from this place of the first light.
        let pdf = |w: Vec3| {
            let cos = place.normal.dot(w);
            let cos = if two_sided { cos.abs() } else { cos };
            if cos <= 0.0 {
                return 0.0;
            }
            let density = tracing.density(&scene.lights, 0, place.position, w, cos);
            claim(f64::from(density) * f64::from(cos) * area, containing(w))
        };
        let draw = |u: &[f64]| {
            let start = start(scene, [[u[0], u[1]], PLACE, [u[2], u[3]]])?;
            Some(Sample::with_pdf(start.direction.as_dvec3().to_array(), pdf(start.direction)))
        };
        let density = direction_density(|w: DVec3| pdf(w.as_vec3())).with_mass(Mass::AtMostOne);
        Ok(examine(&Directions::sphere(Pole::Y), &sampler(4, draw), &density, protocol, round)?)
    })
}

/// Places on a light that emits on both sides, which are uniform, whatever the direction.
fn place(name: String, shape: Shape) -> Case {
    let scene = scene(Some((shape.clone(), true)), TARGETS[0].1, None);
    case(name, scene, Settings::default(), move |scene, protocol, round| {
        let (_, probability) = area_and_probability(scene);
        let uniform = density(|_: [f64; 2]| probability).with_mass(Mass::Exactly(probability));
        let draw = |u: &[f64]| {
            let at = start(scene, [[u[0], u[1]], [u[2], u[3]], [u[4], u[5]]])?.origin.as_dvec3();
            // The random numbers that uniform sampling by area would map to the place.
            let chart = match &shape {
                Shape::Rectangle(r) => r.half_sides().map(|side| {
                    let side = side.as_dvec3();
                    0.5 + 0.5 * at.dot(side) / side.length_squared()
                }),
                Shape::Sphere(sphere) => {
                    let n = at / f64::from(sphere.radius);
                    [0.5 - 0.5 * n.z, n.y.atan2(n.x) / std::f64::consts::TAU + 0.5]
                }
                Shape::Mesh(mesh) => {
                    let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[i].as_dvec3());
                    let normal = (b - a).cross(c - a);
                    let weight = |side: DVec3, other: DVec3| {
                        let across = other.cross(normal);
                        ((at - a).dot(across) / side.dot(across)).max(0.0)
                    };
                    let [b, c] = [weight(b - a, c - a), weight(c - a, b - a)];
                    [(b + c).powi(2), c / (b + c).max(f64::MIN_POSITIVE)]
                }
            };
            Some(Sample::new(chart.map(|x| x.clamp(0.0, 1.0))))
        };
        Ok(examine(&Square, &sampler(6, draw), &uniform, protocol, round)?)
    })
}

/// A map with dark and bright texels, turned and scaled.
fn environment() -> Environment {
    let texel = |x: usize, y: usize| Rgb::splat(if (x, y) == (5, 2) { 40.0 } else { ((x * 7 + y * 3) % 5) as f32 });
    let map = Arc::new(EnvMap::new(Image::from_fn(16, 8, texel)));
    let to_world = DMat3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.0);
    Environment { scale: Rgb::new(0.5, 2.0, 1.0), to_world, ..Environment::upright(map, "test", 1.0) }
}

/// Directions of light paths from the environment.
fn environment_direction() -> Case {
    let scene = scene(None, TARGETS[1].1, Some(environment()));
    case("light-path/environment/direction".into(), scene, Settings::default(), |scene, protocol, round| {
        let environment = environment();
        let map = Settings::default().map_sampling().sampler(environment.map.clone())?;
        let draw = |u: &[f64]| {
            let start = start(scene, [[u[0], u[1]], [u[2], u[3]], [u[4], u[5]]])?;
            Some(Sample::new(environment.to_map(-start.direction.as_dvec3()).to_array()))
        };
        let density = direction_density(|w| map.pdf_for(w, DVec3::ZERO)).with_steps(environment.map.geometry().edges());
        Ok(examine(&Directions::sphere(Pole::Y), &sampler(6, draw), &density, protocol, round)?)
    })
}

/// Places of light paths from the environment in one direction, on a plane perpendicular to it.
fn environment_place(name: String, targets: [(Vec3, f32); 2]) -> Case {
    case(name, scene(None, targets, Some(environment())), Settings::default(), move |scene, protocol, round| {
        let environment = environment();
        let map = Settings::default().map_sampling().sampler(environment.map.clone())?;
        let within = PLACE;
        let (true, Some(first)) = (scene.light_tracing.is_some(), start(scene, [[0.0; 2], [0.5; 2], within])) else {
            return Ok(Outcome::open(0));
        };
        let (wi, axes) = (-first.direction, first.direction.any_orthonormal_pair());
        // A square around both discs.
        const HALF: f32 = 5.0;
        let centre = targets[0].0;
        let draw = |u: &[f64]| {
            let origin = start(scene, [[u[0], u[1]], [u[2], u[3]], within])?.origin;
            // Rounding moves places across the edge of a disc: move those that are close to it inside.
            let across = |w: Vec3| w - wi * wi.dot(w);
            let at_edge =
                |(centre, radius): &&(Vec3, f32)| (across(origin - *centre).length() / radius - 1.0).abs() < 2e-5;
            let inside = targets
                .iter()
                .find(at_edge)
                .map_or(origin, |(centre, _)| *centre + (1.0 - 4e-5) * across(origin - *centre));
            let to = inside - centre;
            Some(Sample::new([axes.0, axes.1].map(|axis| f64::from(0.5 + 0.5 * to.dot(axis) / HALF))))
        };
        // The pdf of the direction is a factor of the density.
        let of_direction = map.pdf_for(environment.to_map(wi.as_dvec3()), DVec3::ZERO);
        let pdf = |place: [f64; 2]| {
            let [x, y] = place.map(|x| (2.0 * x - 1.0) as f32 * HALF);
            let point = centre + x * axes.0 + y * axes.1;
            f64::from(scene.light_path_density(NONE, point, wi, 1.0)) / of_direction * f64::from(4.0 * HALF * HALF)
        };
        Ok(examine(&Square, &sampler(4, draw), &density(pdf), protocol, round)?)
    })
}

/// Light samples of the environment at a surface, by every sampler that has a pdf: on the side of the normal, and on both
/// sides of a surface that transmits.
fn environment_samples() -> impl Iterator<Item = Case> {
    let entries = samplers::ALL.iter().filter(|entry| !entry.has_fixed_lights());
    entries.flat_map(|entry| {
        let depends = matches!(entry.method, Method::ForNormal(_));
        let both_sides = depends.then_some(("/both-sides", Kind::Transmitting));
        [("", Kind::Reflecting)].into_iter().chain(both_sides).map(|(suffix, surface)| {
            let settings = Settings { density: Some(MapSampling::new(entry)), ..Settings::default() };
            let name = format!("light/environment/{}{suffix}", entry.name);
            let scene = scene(None, TARGETS[0].1, Some(environment()));
            case(name, scene, settings, move |scene, protocol, round| {
                let (environment, normal) = (environment(), Vec3::new(0.48, 0.6, -0.64));
                let sampling = scene.environment.as_ref();
                let draw = |u: &[f64]| {
                    let wi = sampling?.sample([u[0], u[1]], normal, surface)?.wi.as_vec3();
                    Some(Sample::new(environment.to_map(wi.as_dvec3()).to_array()))
                };
                let pdf = |w: DVec3| {
                    let wi = (environment.to_world * w).as_vec3();
                    sampling.map_or(f64::NAN, |sampling| sampling.pdf(wi, normal, surface))
                };
                let density = direction_density(pdf).with_mass(Mass::AtMostOne);
                let density = density.with_steps(environment.map.geometry().edges());
                Ok(examine(&Directions::sphere(Pole::Y), &sampler(2, draw), &density, protocol, round)?)
            })
        })
    })
}
