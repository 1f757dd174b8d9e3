//! Lamps as the renderer draws directions towards them: panels, balls, and the even sky.

use super::{Case, short};
use crate::math::Rgb;
use crate::render::Settings;
use crate::render::lights::{LightSample, SampleLight, Sampled};
use crate::scene::{Emission, EmitterVisibility, Light, Material, Object, Rectangle, Scene, Shape, Sphere, builtin};
use crate::stats::{Directions, Domain, Draw, Pole, Square, density, sampler};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Where light is drawn for.
const POINT: Vec3 = Vec3::new(0.3, -0.2, 0.5);

/// Balls: distance of the centre and radius. From inside all directions lead to them.
const BALLS: [(&str, f32, f32); 5] =
    [("touching", 1.001, 1.0), ("near", 1.5, 1.0), ("middle", 4.0, 1.0), ("far", 300.0, 1.0), ("inside", 0.5, 1.0)];

/// Panels: centre as seen from the point, and half sides.
const PANELS: [(&str, Vec3, Vec3, Vec3); 3] = [
    ("ceiling", Vec3::new(0.1, 1.5, -0.2), Vec3::new(0.35, 0.0, 0.0), Vec3::new(0.0, 0.0, 0.25)),
    ("tilted", Vec3::new(1.0, 0.5, 0.8), Vec3::new(0.3, -0.3, 0.0), Vec3::new(0.2, 0.2, 0.1)),
    ("edge-on", Vec3::new(2.0, 0.02, 0.0), Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.0, 0.0, 0.5)),
];

pub fn cases() -> Vec<Case> {
    let balls = BALLS.map(|(name, distance, radius)| ball(name, distance, radius));
    let panels = PANELS.map(|(name, centre, x, y)| panel(name, centre, x, y));
    balls.into_iter().chain(panels).chain([sky()]).collect()
}

/// The only light of a scene, as the renderer has it.
fn light_of(object: Option<Object>, light: Option<Light>) -> Option<Sampled> {
    let (scene, _) = builtin::furnace();
    let lights = light.into_iter().collect();
    let scene = Scene { objects: object.into_iter().collect(), lights, environment: None, ..scene };
    Sampled::all(&scene, &Settings::default()).ok()?.pop()
}

fn glowing(shape: Shape) -> Option<Sampled> {
    let emission = Emission { radiance: Rgb::ONE, two_sided: false, visibility: EmitterVisibility::Sampled };
    light_of(Some(Object { shape, material: Material::Diffuse { albedo: Rgb::ZERO }, emission: Some(emission) }), None)
}

fn draw(light: Option<&Sampled>, u: &[f64]) -> Option<LightSample> {
    light.map(|light| light.sample(POINT, [short(u[0]), short(u[1])]))
}

/// Directions in the frame of the ball, whose cone is a rectangle of the chart: even inside, none outside.
fn ball(name: &str, distance: f32, radius: f32) -> Case {
    let sphere = Directions::sphere(Pole::Z);
    Case::of(format!("light/ball/{name}"), sphere, move || {
        let centre = POINT + distance * Vec3::new(0.36, 0.48, 0.8);
        let light = glowing(Shape::Sphere(Sphere { centre, radius }));
        let to = (centre - POINT).as_dvec3();
        let sin2 = f64::from(radius).powi(2) / to.length_squared();
        // (1 − cos)/2 of the cone, all of the sphere from inside, and what rounding of directions adds to it.
        let edge = if sin2 < 1.0 { 0.5 * sin2 / (1.0 + (1.0 - sin2).sqrt()) } else { 1.0 };
        let rim = edge * (1.0 + 1e-6 / sin2.sqrt());
        let axis = to.normalize();
        let (x, y) = axis.any_orthonormal_pair();
        let pdf = light.as_ref().map_or(f64::NAN, |light| f64::from(light.pdf(POINT)));
        let draw = move |u: &[f64]| {
            let sample = draw(light.as_ref(), u)?;
            let wi = sample.wi.as_dvec3();
            let local = DVec3::new(wi.dot(x), wi.dot(y), wi.dot(axis));
            let place = sphere.place(local).filter(|place| (edge..rim).contains(&place[0]));
            let point = place.map_or(local, |place| sphere.point([edge.next_down(), place[1]]));
            Some(Draw::with_pdf(point, f64::from(sample.pdf)))
        };
        let inside = move |w: DVec3| sphere.place(w).is_some_and(|place| place[0] <= edge);
        let even = density(move |w: DVec3| if inside(w) { pdf } else { 0.0 });
        let steps = if edge < 1.0 { vec![edge] } else { Vec::new() };
        (sampler(2, draw), even.with_steps([steps, Vec::new()]))
    })
}

/// Places on the panel: the density per solid angle is even, that per area is cos θ / r² of it.
fn panel(name: &str, centre: Vec3, x: Vec3, y: Vec3) -> Case {
    Case::of(format!("light/panel/{name}"), Square, move || {
        // The side that faces the point glows.
        let (x, y) = if x.cross(y).dot(centre) < 0.0 { (x, y) } else { (y, x) };
        let rectangle = Rectangle::new(POINT + centre, x, y);
        let light = rectangle.and_then(|rectangle| glowing(Shape::Rectangle(rectangle)));
        let [centre, x, y] = [centre, x, y].map(|v| v.as_dvec3());
        let pdf = light.as_ref().map_or(f64::NAN, |light| f64::from(light.pdf(POINT)));
        let draw = move |u: &[f64]| {
            let sample = draw(light.as_ref(), u)?;
            let off = sample.wi.as_dvec3() * f64::from(sample.distance) - centre;
            let place = [x, y].map(|side| 0.5 + 0.5 * off.dot(side) / side.length_squared());
            // In f32 the sides themselves are rounded.
            Some(Draw::new(place.map(|x| if (x - x.clamp(0.0, 1.0)).abs() < 1e-6 { x.clamp(0.0, 1.0) } else { x })))
        };
        let front = 4.0 * x.cross(y);
        let at = move |[u, v]: [f64; 2]| {
            let to = centre + (2.0 * u - 1.0) * x + (2.0 * v - 1.0) * y;
            pdf * front.dot(to).abs() / to.length().powi(3)
        };
        (sampler(2, draw), density(at))
    })
}

fn sky() -> Case {
    Case::of("light/sky", Directions::hemisphere(Pole::Y), || {
        let light = light_of(None, Some(Light::Hemisphere { radiance: Rgb::ONE }));
        let draw = move |u: &[f64]| Some(Draw::new(draw(light.as_ref(), u)?.wi.as_dvec3()));
        (sampler(2, draw), density(|_: DVec3| 1.0 / TAU))
    })
}
