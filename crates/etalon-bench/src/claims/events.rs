//! Paths by what happens at each vertex, for classes that Heckbert's notation does not distinguish: S of a mirror, of the outside of
//! glass, of its inside, and of a refraction.
//!
//! A class is a word of [`Event`]s from the eye to the light. Its light is estimated by paths that are forced to have these events.

use etalon_core::bsdf::Scatter;
use etalon_core::math::{Frame, Rgb};
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::scene::bvh::Bvh;
use etalon_core::scene::{Material, Object, Projection, Ray, Rectangle, ScatterModel, Scene, Shape, Sphere};
use etalon_stats::Extremes;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// What happens at a vertex of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Event {
    /// Diffuse reflection by any surface.
    Diffuse,
    /// Diffuse reflection by the ceiling.
    Ceiling,
    /// Diffuse reflection by the wall that is blue.
    BlueWall,
    /// Reflection by a mirror.
    Mirror,
    /// Reflection by glass from outside.
    Reflected,
    /// Refraction by glass, either way.
    Refracted,
    /// Reflection by glass from inside.
    Internal,
}

impl Event {
    /// Heckbert's letter, with the initial of what is specular: mirror, reflection by glass, transmission, internal reflection.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Diffuse | Self::Ceiling | Self::BlueWall => "D",
            Self::Mirror => "Sₘ",
            Self::Reflected => "Sᵣ",
            Self::Refracted => "Sₜ",
            Self::Internal => "Sᵢ",
        }
    }

    /// Whether it is diffuse reflection.
    pub fn is_diffuse(self) -> bool {
        matches!(self, Self::Diffuse | Self::Ceiling | Self::BlueWall)
    }

    /// Whether `other` is this event, or diffuse reflection by a certain surface where this is any diffuse reflection.
    fn covers(self, other: Self) -> bool {
        self == other || self == Self::Diffuse && other.is_diffuse()
    }
}

/// A class from the light to the eye, "LDSₜSₜE".
pub fn word(events: &[Event]) -> String {
    let symbols: String = events.iter().rev().map(|event| event.symbol()).collect();
    format!("L{symbols}E")
}

/// Whether a path with these events, from the eye, is of the class.
pub fn is_of(events: &[Event], class: &[Event]) -> bool {
    events.len() == class.len() && class.iter().zip(events).all(|(class, event)| class.covers(*event))
}

/// Distance of a new ray from the surface where it starts, in the scene's unit (the box is 2 wide).
const OFFSET: f32 = 1e-4;

/// A scene with one area light.
pub struct World<'a> {
    scene: &'a Scene,
    bvh: Bvh,
    light: Rectangle,
    radiance: DVec3,
}

/// A point of a surface.
pub struct Vertex<'a> {
    object: &'a Object,
    /// In the world.
    pub point: Vec3,
    /// Outwards of spheres, against the ray otherwise.
    normal: Vec3,
}

impl Vertex<'_> {
    /// Whether this can happen here.
    pub fn allows(&self, event: Event) -> bool {
        match (&self.object.material, event) {
            _ if self.object.emission.is_some() => false,
            (Material::Diffuse { .. }, Event::Diffuse) => true,
            (Material::Diffuse { .. }, Event::Ceiling) => self.normal.y < -0.9,
            (Material::Diffuse { albedo }, Event::BlueWall) => albedo.z > 1.5 * albedo.x,
            (Material::Mirror { .. }, Event::Mirror) => true,
            (Material::Dielectric(_), Event::Reflected | Event::Refracted | Event::Internal) => true,
            _ => false,
        }
    }

    /// Cosine of the angle at which a ray meets it.
    pub fn cos(&self, ray: &Ray) -> f32 {
        self.normal.dot(ray.direction).abs()
    }

    fn ray(&self, direction: Vec3) -> Ray {
        let side = OFFSET.copysign(direction.dot(self.normal));
        Ray { origin: self.point + side * self.normal, direction }
    }

    /// Diffuse reflection of light from a sphere: the ray to it, and the factor of the light that comes along it.
    fn towards(&self, sphere: &Sphere, u: [f64; 2]) -> Option<(Ray, DVec3)> {
        let Material::Diffuse { albedo } = self.object.material else { return None };
        let (direction, solid_angle) = in_cone(self.point, sphere, u);
        let cos = f64::from(self.normal.dot(direction));
        (cos > 0.0).then(|| (self.ray(direction), albedo.as_dvec3() * (cos * solid_angle / PI)))
    }

    /// The ray after this event, and the factor of the light that comes along it.
    fn scatter(&self, from: &Ray, event: Event, u: [f64; 2]) -> Option<(Ray, DVec3)> {
        if !self.allows(event) {
            return None;
        }
        let frame = Frame::from_normal(self.normal);
        let wo = frame.to_local(-from.direction);
        if event == Event::Reflected && wo.z < 0.0 || event == Event::Internal && wo.z > 0.0 {
            return None;
        }
        // Dielectrics choose reflection where the first number is small.
        let choice = if event == Event::Refracted { 1.0 - f32::EPSILON } else { 0.0 };
        let sample = self.object.material.bsdf(ScatterModel::default()).sample(wo, choice, u.map(|u| u as f32))?;
        let as_wanted = sample.lobe.is_transmission() == (event == Event::Refracted);
        let weight = sample.weight.as_dvec3() * f64::from(sample.probability);
        as_wanted.then(|| (self.ray(frame.to_world(sample.wi)), weight))
    }
}

/// A direction towards a sphere, uniform over the solid angle that it covers, and that solid angle.
fn in_cone(from: Vec3, sphere: &Sphere, u: [f64; 2]) -> (Vec3, f64) {
    let axis = sphere.centre - from;
    let sin2 = (sphere.radius / axis.length()).powi(2).min(1.0);
    let one_minus_cos = 1.0 - (1.0 - f64::from(sin2)).sqrt();
    let cos = 1.0 - u[0] * one_minus_cos;
    let (sin, phi) = ((1.0 - cos * cos).sqrt(), 2.0 * PI * u[1]);
    let local = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos).as_vec3();
    (Frame::from_normal(axis.normalize()).to_world(local), 2.0 * PI * one_minus_cos)
}

impl<'a> World<'a> {
    /// `None` unless a rectangle of the scene emits light.
    pub fn new(scene: &'a Scene) -> Option<Self> {
        let (light, radiance) = scene.objects.iter().find_map(|object| match (&object.shape, object.emission) {
            (Shape::Rectangle(rectangle), Some(emission)) => Some((*rectangle, emission.radiance.as_dvec3())),
            _ => None,
        })?;
        let shapes: Vec<&Shape> = scene.objects.iter().map(|object| &object.shape).collect();
        Some(Self { scene, bvh: Bvh::build(&shapes), light, radiance })
    }

    /// The first surface along a ray.
    pub fn nearest(&self, ray: &Ray) -> Option<Vertex<'a>> {
        let hit = self.bvh.nearest(ray, f32::INFINITY)?;
        let object = &self.scene.objects[hit.shape as usize];
        let point = ray.origin + hit.t * ray.direction;
        let normal = match &object.shape {
            Shape::Sphere(sphere) => (point - sphere.centre) / sphere.radius,
            Shape::Rectangle(_) | Shape::Mesh(_) => {
                let normal = self.bvh.surface(hit.place, hit.u, hit.v).normal;
                if normal.dot(ray.direction) > 0.0 { -normal } else { normal }
            }
        };
        Some(Vertex { object, point, normal })
    }

    /// The light that a ray meets directly.
    pub fn emitted(&self, ray: &Ray) -> DVec3 {
        let lit = self.nearest(ray).is_some_and(|vertex| {
            vertex
                .object
                .emission
                .is_some_and(|emission| emission.two_sided || self.light.normal().dot(ray.direction) < 0.0)
        });
        if lit { self.radiance } else { DVec3::ZERO }
    }

    /// The light of a diffuse vertex by one sample of the area light.
    pub fn direct(&self, vertex: &Vertex, u: [f64; 2]) -> DVec3 {
        let Material::Diffuse { albedo } = vertex.object.material else { return DVec3::ZERO };
        let [x, y] = self.light.half_sides();
        let at = self.light.centre() + (2.0 * u[0] as f32 - 1.0) * x + (2.0 * u[1] as f32 - 1.0) * y;
        let way = at - vertex.point;
        let (distance, wi) = (way.length(), way.normalize());
        let (cos, cos_light) = (vertex.normal.dot(wi), -self.light.normal().dot(wi));
        if cos <= 0.0 || cos_light <= 0.0 || self.bvh.occluded(&vertex.ray(wi), distance - 3.0 * OFFSET) {
            return DVec3::ZERO;
        }
        let geometry = cos * cos_light * self.light.area() / (distance * distance);
        self.radiance * albedo.as_dvec3() * (f64::from(geometry) / PI)
    }

    /// The light of the class of these events along a ray from the eye, by one path.
    pub fn along(&self, mut ray: Ray, events: &[Event], stream: &Independent) -> DVec3 {
        let mut weight = DVec3::ONE;
        for (i, &event) in events.iter().enumerate() {
            let Some(vertex) = self.nearest(&ray) else { return DVec3::ZERO };
            let u = stream.pair(i as u32 + 1);
            if event.is_diffuse() && i + 1 == events.len() {
                return if vertex.allows(event) { weight * self.direct(&vertex, u) } else { DVec3::ZERO };
            }
            let target = events.get(i + 1).filter(|_| event.is_diffuse()).and_then(|next| self.target(*next));
            let scattered = match target {
                Some(sphere) if vertex.allows(event) => vertex.towards(&sphere, u),
                _ => vertex.scatter(&ray, event, u),
            };
            let Some((next, factor)) = scattered else { return DVec3::ZERO };
            (ray, weight) = (next, weight * factor);
        }
        weight * self.emitted(&ray)
    }

    /// The point of the first diffuse vertex of the class along a ray from the eye, if only specular ones are before it.
    pub fn first_diffuse(&self, mut ray: Ray, events: &[Event]) -> Option<Vec3> {
        for &event in events {
            let vertex = self.nearest(&ray)?;
            if event.is_diffuse() {
                return vertex.allows(event).then_some(vertex.point);
            }
            (ray, _) = vertex.scatter(&ray, event, [0.5; 2])?;
        }
        None
    }

    /// The vertex to which specular events, the last of them first, take a path from the light, and the power that arrives there.
    pub fn arrive(&self, chain: &[Event], stream: &Independent) -> Option<(Vertex<'a>, DVec3)> {
        let target = self.target(*chain.last()?)?;
        // A point of the light and a direction towards the first object
        let [x, y] = self.light.half_sides();
        let u = stream.pair(0);
        let from = self.light.centre() + (2.0 * u[0] as f32 - 1.0) * x + (2.0 * u[1] as f32 - 1.0) * y;
        let (direction, solid_angle) = in_cone(from, &target, stream.pair(1));
        let cos_light = self.light.normal().dot(direction);
        if cos_light <= 0.0 {
            return None;
        }
        let mut weight = self.radiance * f64::from(cos_light * self.light.area()) * solid_angle;
        let mut ray = Ray { origin: from + OFFSET * self.light.normal(), direction };
        for &event in chain.iter().rev() {
            let vertex = self.nearest(&ray)?;
            let (next, factor) = vertex.scatter(&ray, event, [0.5; 2])?;
            (ray, weight) = (next, weight * factor);
        }
        Some((self.nearest(&ray)?, weight))
    }

    /// The light of a class whose first event is diffuse and whose others are specular, by one path from the light: where it
    /// arrives on the film, from (0, 0) to (1, 1), and its share of the film's mean radiance.
    pub fn splat(&self, events: &[Event], stream: &Independent) -> Option<([f64; 2], DVec3)> {
        let (&last, chain) = events.split_first()?;
        let (vertex, weight) = self.arrive(chain, stream).filter(|(vertex, _)| vertex.allows(last))?;
        let (film, importance) = self.seen(&vertex)?;
        Some((film, weight * importance))
    }

    /// The sphere at which this can happen.
    fn target(&self, event: Event) -> Option<Sphere> {
        self.scene.objects.iter().find_map(|object| match (&object.shape, &object.material, event) {
            (Shape::Sphere(sphere), Material::Mirror { .. }, Event::Mirror) => Some(*sphere),
            (Shape::Sphere(sphere), Material::Dielectric(_), Event::Reflected | Event::Refracted) => Some(*sphere),
            _ => None,
        })
    }

    /// Where the camera sees a diffuse vertex, and the share of the film's mean radiance for a unit of power that arrives there.
    fn seen(&self, vertex: &Vertex) -> Option<([f64; 2], DVec3)> {
        let (camera, Material::Diffuse { albedo }) = (&self.scene.camera, &vertex.object.material) else { return None };
        let Projection::Perspective { tan_half_width, tan_half_height } = camera.projection else { return None };
        let way = vertex.point.as_dvec3() - camera.position;
        let depth = way.dot(camera.forward);
        let film = [way.dot(camera.right) / (depth * tan_half_width), way.dot(camera.up) / (depth * tan_half_height)];
        let (distance, to_eye) = (way.length(), -way.normalize());
        let cos = f64::from(vertex.normal.dot(to_eye.as_vec3()));
        let inside = depth > 0.0 && cos > 0.0 && film.iter().all(|x| x.abs() < 1.0);
        if !inside || self.bvh.occluded(&vertex.ray(to_eye.as_vec3()), distance as f32 - 3.0 * OFFSET) {
            return None;
        }
        // Importance of a pinhole, 1/(A cos⁴), times the cosine there (Pharr, Jakob and Humphreys, section 16.1 of the 3rd edition)
        let cos_camera = depth / distance;
        let importance = cos / (4.0 * tan_half_width * tan_half_height * cos_camera.powi(3) * distance * distance);
        let brdf: Rgb = *albedo;
        Some(([0.5 + 0.5 * film[0], 0.5 - 0.5 * film[1]], brdf.as_dvec3() * (importance / PI)))
    }

    /// What can happen first along a ray from the eye. Glass has two events, so that both are sampled.
    pub fn first_events(&self, ray: &Ray) -> &'static [Event] {
        match self.nearest(ray).map(|vertex| &vertex.object.material) {
            Some(Material::Diffuse { .. }) => &[Event::Diffuse],
            Some(Material::Mirror { .. }) => &[Event::Mirror],
            Some(Material::Dielectric(_)) => &[Event::Reflected, Event::Refracted],
            _ => &[],
        }
    }

    /// A path whose first event is given and the others chosen by the BSDFs; calls `add` with the events and the light of each of
    /// its beginnings that has so many of them.
    pub fn path(
        &self,
        mut ray: Ray,
        first: Event,
        lengths: RangeInclusive<u32>,
        stream: &Independent,
        mut add: impl FnMut(&[Event], DVec3),
    ) {
        /// Events before Russian roulette.
        const SAFE: u32 = 5;
        let (mut weight, mut events) = (DVec3::ONE, Vec::new());
        for depth in 1..=*lengths.end() {
            let Some(vertex) = self.nearest(&ray) else { return };
            let [choice, roulette] = stream.pair(3 * depth);
            let event = match vertex.object.material {
                _ if depth == 1 => first,
                Material::Diffuse { .. } => Event::Diffuse,
                Material::Mirror { .. } => Event::Mirror,
                Material::Dielectric(_) => {
                    let outside = vertex.normal.dot(ray.direction) < 0.0;
                    if outside { Event::Reflected } else { Event::Internal }
                }
                _ => return,
            };
            // Glass: reflection with the probability that it has, refraction otherwise
            let u = stream.pair(3 * depth + 1);
            let is_glass = depth > 1 && matches!(event, Event::Reflected | Event::Internal);
            let reflection = vertex.scatter(&ray, event, u);
            let share = reflection.map_or(0.0, |(_, factor)| factor.max_element());
            let (event, scattered) = if is_glass && choice >= share {
                let refracted = vertex.scatter(&ray, Event::Refracted, u);
                (Event::Refracted, refracted.map(|(ray, factor)| (ray, factor / (1.0 - share))))
            } else if is_glass {
                (event, reflection.map(|(ray, factor)| (ray, factor / share)))
            } else {
                (event, reflection)
            };
            let Some((next, factor)) = scattered else { return };
            let places = [Event::Ceiling, Event::BlueWall].into_iter().find(|place| vertex.allows(*place));
            events.push(places.filter(|_| event.is_diffuse()).unwrap_or(event));
            if lengths.contains(&depth) {
                let light = if event.is_diffuse() {
                    weight * self.direct(&vertex, stream.pair(3 * depth + 2))
                } else {
                    weight * factor * self.emitted(&next)
                };
                add(&events, light);
            }
            (ray, weight) = (next, weight * factor);
            if depth > SAFE {
                let survival = weight.max_element().at_most(0.95);
                if roulette >= survival {
                    return;
                }
                weight /= survival;
            }
        }
    }
}
