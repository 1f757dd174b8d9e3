//! Paths from the eye, traced one by one and filtered by path class: Heckbert's notation, with the kind of each specular event.

use super::Share;
use etalon_core::bsdf::{Bsdf, Scatter};
use etalon_core::interrupt;
use etalon_core::math::Frame;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::scene::{Bvh, Light, Material, Object, Ray, Rectangle, Request, ScatterModel, Scene, Shape};
use etalon_stats::Extremes;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// What happens at a vertex of a path, or in a class any of several such events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// Diffuse reflection; in a class by any surface.
    Diffuse,
    /// Diffuse reflection by the ceiling.
    Ceiling,
    /// Diffuse reflection by the wall on the right.
    RightWall,
    /// Any specular event, in a class alone.
    Specular,
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
    /// Whether it is diffuse reflection.
    pub fn is_diffuse(self) -> bool {
        matches!(self, Self::Diffuse | Self::Ceiling | Self::RightWall)
    }

    /// Whether an event of a path is this one of a class.
    pub fn covers(self, event: Self) -> bool {
        match self {
            Self::Diffuse => event.is_diffuse(),
            Self::Specular => !event.is_diffuse(),
            single => single == event,
        }
    }
}

/// A class from the light to the eye, "LDSₜSₜE": S has the initial of mirror, reflection, transmission, internal reflection.
pub fn word(events: &[Event]) -> String {
    let symbol = |event: &Event| match event {
        Event::Diffuse | Event::Ceiling | Event::RightWall => "D",
        Event::Specular => "S",
        Event::Mirror => "Sₘ",
        Event::Reflected => "Sᵣ",
        Event::Refracted => "Sₜ",
        Event::Internal => "Sᵢ",
    };
    format!("L{}E", events.iter().rev().map(symbol).collect::<String>())
}

/// Whether a path begins with the first events of a class, or has all of them and more.
pub fn begins(events: &[Event], class: &[Event]) -> bool {
    class.iter().zip(events).all(|(class, event)| class.covers(*event))
}

/// The object without emission all of whose points lie far in a direction: the ceiling upwards, a wall to its side.
pub fn farthest(scene: &Scene, direction: DVec3) -> Option<usize> {
    let nearest_corner = |object: &Object| {
        let [low, high] = object.shape.bounds()?.map(|corner| corner.as_dvec3() * direction);
        object.emission.is_none().then(|| low.min(high).element_sum())
    };
    let objects = scene.objects.iter().enumerate().filter_map(|(i, object)| Some((i, nearest_corner(object)?)));
    objects.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
}

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Place {
    /// First column and row.
    pub from: [usize; 2],
    /// Column and row after the last.
    pub to: [usize; 2],
}

/// A path from the eye.
pub struct Path {
    /// What happened at its vertices, the first of them nearest to the eye.
    pub events: Vec<Event>,
    /// Cosine of the angle at which it meets its first vertex.
    pub first_cos: f32,
}

/// Which paths are traced, and what their light is counted as.
pub struct Filter<'f, const N: usize> {
    /// Events of the paths whose light counts.
    pub lengths: RangeInclusive<usize>,
    /// Whether paths that begin with these events are traced further.
    pub follow: &'f (dyn Fn(&[Event]) -> bool + Sync),
    /// The kinds that a path is of.
    pub kinds: &'f (dyn Fn(&Path) -> [bool; N] + Sync),
    /// Events up to which both reflection and refraction by glass are followed; beyond, the BSDF chooses.
    pub split: usize,
}

/// The light of a pixel.
pub struct PixelLight {
    /// Its number.
    pub index: usize,
    /// Radiance of the first kind of paths.
    pub radiance: DVec3,
    /// Variance of the mean of its channels.
    pub variance: f64,
}

/// The light of N kinds of paths, summed over pixels: means of the channels.
pub struct Tally<const N: usize> {
    /// Paths through each pixel.
    pub spp: u32,
    /// Sums of each kind.
    pub sum: [f64; N],
    /// Covariance of these sums.
    pub covariance: [[f64; N]; N],
    /// Light of the first kind, pixel by pixel.
    pub pixels: Vec<PixelLight>,
}

/// Events up to which glass is split: those of the longest class.
pub const SPLIT: usize = 5;

impl<const N: usize> Tally<N> {
    /// The light of a kind and its standard error.
    pub fn of(&self, kind: usize) -> [f64; 2] {
        [self.sum[kind], self.covariance[kind][kind].sqrt()]
    }

    /// The share of the first kind in the first two.
    pub fn share(&self) -> Share {
        let covariance = [0, 1].map(|k| [self.covariance[k][0], self.covariance[k][1]]);
        Share::of([self.sum[0], self.sum[1]], covariance)
    }
}

/// Distance of a new ray from the surface where it starts, in the scene's unit (the box is 2 wide).
const OFFSET: f32 = 1e-4;

/// A scene with one area light as the camera sees it.
pub struct View<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Size of the image.
    pub request: &'a Request,
    /// The object in the centre of each pixel.
    shown: Vec<Option<usize>>,
    bvh: Bvh,
    bsdfs: Vec<Bsdf>,
    light: Rectangle,
    radiance: DVec3,
    ceiling: Option<usize>,
    right_wall: Option<usize>,
}

/// A point of a surface.
struct Vertex {
    object: usize,
    point: Vec3,
    /// Normal of the shape; on two-sided surfaces `normal` is turned towards the viewer.
    outside: Vec3,
    normal: Vec3,
}

impl Vertex {
    fn ray(&self, direction: Vec3) -> Ray {
        let side = OFFSET.copysign(direction.dot(self.normal));
        Ray { origin: self.point + side * self.normal, direction }
    }
}

impl<'a> View<'a> {
    /// `None` unless a rectangle lights the scene.
    pub fn new(scene: &'a Scene, request: &'a Request) -> Option<Self> {
        let emitter = |object: &Object| match (&object.shape, object.emission) {
            (Shape::Rectangle(rectangle), Some(emission)) => Some((*rectangle, emission.radiance)),
            _ => None,
        };
        let light = |light: &Light| match *light {
            Light::Rectangle { rectangle, radiance } => Some((rectangle, radiance)),
            _ => None,
        };
        // Where a light is not an object, the object in its place is what mirrors and glass show of it.
        let mut lights = scene.lights.iter().filter_map(light).chain(scene.objects.iter().filter_map(emitter));
        let (light, radiance) = lights.next()?;
        let bvh = Bvh::build(&scene.objects.iter().map(|object| &object.shape).collect::<Vec<_>>());
        let bsdfs = scene.objects.iter().map(|object| object.material.bsdf(ScatterModel::default())).collect();
        let [ceiling, right_wall] = [scene.camera.up, scene.camera.right].map(|way| farthest(scene, way));
        let radiance = radiance.as_dvec3();
        let view = Self { scene, request, shown: Vec::new(), bvh, bsdfs, light, radiance, ceiling, right_wall };
        let centres = (0..request.width * request.height).into_par_iter();
        let shown = centres.map(|i| view.nearest(&view.ray(i, [0.5; 2])).map(|vertex| vertex.object)).collect();
        Some(Self { shown, ..view })
    }

    /// The pixels that show in their centre an object where this can happen first.
    pub fn pixels(&self, first: Event) -> Vec<usize> {
        let is_possible = |object: usize| {
            let events = [false, true].map(|is_transmitted| self.event(object, Vec3::Z, is_transmitted));
            self.scene.objects[object].emission.is_none() && events.into_iter().flatten().any(|e| first.covers(e))
        };
        (0..self.shown.len()).filter(|&i| self.shown[i].is_some_and(is_possible)).collect()
    }

    /// Those of the pixels that lie in a place.
    pub fn within(&self, pixels: &[usize], place: &Place) -> Vec<usize> {
        let is_inside = |i: usize| {
            let at = [i % self.request.width, i / self.request.width];
            (0..2).all(|axis| (place.from[axis]..place.to[axis]).contains(&at[axis]))
        };
        pixels.iter().copied().filter(|&i| is_inside(i)).collect()
    }

    /// The ray through a point of a pixel.
    fn ray(&self, pixel: usize, [u, v]: [f64; 2]) -> Ray {
        let Request { width, height, .. } = *self.request;
        let (x, y) = ((pixel % width) as f64 + u, (pixel / width) as f64 + v);
        self.scene.camera.ray(x / width as f64, y / height as f64)
    }

    /// What light that comes from `wo` meets at an object.
    fn event(&self, object: usize, wo: Vec3, is_transmitted: bool) -> Option<Event> {
        Some(match &self.scene.objects[object].material {
            Material::Diffuse { .. } if self.ceiling == Some(object) => Event::Ceiling,
            Material::Diffuse { .. } if self.right_wall == Some(object) => Event::RightWall,
            Material::Diffuse { .. } => Event::Diffuse,
            Material::Mirror { .. } => Event::Mirror,
            Material::Dielectric(_) if is_transmitted => Event::Refracted,
            Material::Dielectric(_) if wo.z > 0.0 => Event::Reflected,
            Material::Dielectric(_) => Event::Internal,
            _ => return None,
        })
    }

    /// The first surface along a ray.
    fn nearest(&self, ray: &Ray) -> Option<Vertex> {
        let hit = self.bvh.nearest(ray, f32::INFINITY)?;
        let object = &self.scene.objects[hit.shape as usize];
        let point = ray.origin + hit.t * ray.direction;
        let outside = match &object.shape {
            Shape::Sphere(sphere) => (point - sphere.centre) / sphere.radius,
            Shape::Rectangle(_) | Shape::Mesh(_) => self.bvh.surface(hit.place, hit.u, hit.v).normal,
        };
        let is_turned = object.material.is_two_sided() && outside.dot(ray.direction) > 0.0;
        Some(Vertex { object: hit.shape as usize, point, outside, normal: if is_turned { -outside } else { outside } })
    }

    /// The light that a diffuse vertex reflects, by one sample of the area light.
    fn direct(&self, vertex: &Vertex, u: [f64; 2]) -> DVec3 {
        let Material::Diffuse { albedo } = self.scene.objects[vertex.object].material else { return DVec3::ZERO };
        let [x, y] = self.light.half_sides();
        let way = self.light.centre() + (2.0 * u[0] as f32 - 1.0) * x + (2.0 * u[1] as f32 - 1.0) * y - vertex.point;
        let (distance, wi) = (way.length(), way.normalize());
        let (cos, cos_light) = (vertex.normal.dot(wi), -self.light.normal().dot(wi));
        if cos <= 0.0 || cos_light <= 0.0 || self.bvh.occluded(&vertex.ray(wi), distance - 3.0 * OFFSET) {
            return DVec3::ZERO;
        }
        let geometry = cos * cos_light * self.light.area() / (distance * distance);
        self.radiance * albedo.as_dvec3() * (f64::from(geometry) / PI)
    }

    /// Traces about `paths` paths, the same number through each pixel.
    pub fn trace<const N: usize>(&self, pixels: &[usize], paths: usize, seed: u64, filter: &Filter<N>) -> Tally<N> {
        let spp = if interrupt::requested() { 2 } else { paths.div_ceil(pixels.len().max(1)).max(2) as u32 };
        let n = f64::from(spp);
        let of_pixel = |&index: &usize| {
            let (mut mean, mut covariance, mut radiance) = ([0.0; N], [[0.0; N]; N], DVec3::ZERO);
            for sample in 0..spp {
                let stream = Independent::new(seed, index as u64, sample);
                let path = Path { events: Vec::new(), first_cos: 1.0 };
                let mut walk = Walk { view: self, stream, filter, path, light: [DVec3::ZERO; N] };
                walk.extend(&self.ray(index, stream.pair(0)), DVec3::ONE);
                radiance += walk.light[0] / n;
                let light = walk.light.map(|light| light.element_sum() / 3.0);
                for k in 0..N {
                    mean[k] += light[k] / n;
                    (0..N).for_each(|l| covariance[k][l] += light[k] * light[l] / n);
                }
            }
            // The covariance of the mean of the samples
            for k in 0..N {
                (0..N).for_each(|l| covariance[k][l] = (covariance[k][l] - mean[k] * mean[l]) / (n - 1.0));
            }
            (mean, covariance, PixelLight { index, radiance, variance: covariance[0][0] })
        };
        // Summed in the order of the pixels, whatever the number of threads
        let traced: Vec<_> = pixels.par_iter().map(of_pixel).collect();
        let mut tally = Tally { spp, sum: [0.0; N], covariance: [[0.0; N]; N], pixels: Vec::new() };
        for (mean, covariance, pixel) in traced {
            for k in 0..N {
                tally.sum[k] += mean[k];
                (0..N).for_each(|l| tally.covariance[k][l] += covariance[k][l]);
            }
            tally.pixels.push(pixel);
        }
        tally
    }
}

/// A path that is being traced, and the light of each kind that it has found.
struct Walk<'w, const N: usize> {
    view: &'w View<'w>,
    stream: Independent,
    filter: &'w Filter<'w, N>,
    path: Path,
    light: [DVec3; N],
}

impl<const N: usize> Walk<'_, N> {
    fn add(&mut self, value: DVec3) {
        if self.filter.lengths.contains(&self.path.events.len()) {
            let kinds = (self.filter.kinds)(&self.path);
            (0..N).filter(|&k| kinds[k]).for_each(|k| self.light[k] += value);
        }
    }

    /// Follows the path along a ray; `weight` is the factor of the light that comes along it.
    fn extend(&mut self, ray: &Ray, weight: DVec3) {
        /// Events before Russian roulette.
        const SAFE: usize = 5;
        let Some(vertex) = self.view.nearest(ray) else { return };
        let (object, bsdf) = (&self.view.scene.objects[vertex.object], &self.view.bsdfs[vertex.object]);
        let (depth, longest) = (self.path.events.len(), *self.filter.lengths.end());
        if let Some(emission) = object.emission {
            // Diffuse vertices have the light by samples of it.
            let is_sampled = self.path.events.last().is_some_and(|event| event.is_diffuse());
            if !is_sampled && emission.is_emitted(vertex.outside, ray.direction) {
                self.add(weight * emission.radiance.as_dvec3());
            }
            return;
        }
        let frame = Frame::from_normal(vertex.normal);
        let wo = frame.to_local(-ray.direction);
        if depth == 0 {
            self.path.first_cos = wo.z.abs();
        }
        let [[uc, roulette], u, of_light] = [1, 2, 3].map(|pair| self.stream.pair(3 * depth as u32 + pair));
        let is_split = depth < self.filter.split && matches!(object.material, Material::Dielectric(_));
        // Dielectrics reflect where the first number is small.
        let choices = if is_split { &[0.0, 1.0 - f32::EPSILON][..] } else { &[uc as f32] };
        for (i, choice) in choices.iter().enumerate().filter(|_| depth < longest) {
            let Some(sample) = bsdf.sample(wo, *choice, u.map(|u| u as f32)) else { continue };
            let Some(event) = self.view.event(vertex.object, wo, sample.lobe.is_transmission()) else { return };
            // Total reflection has no second event.
            if i == 1 && event != Event::Refracted {
                continue;
            }
            self.path.events.push(event);
            if (self.filter.follow)(&self.path.events) {
                if event.is_diffuse() {
                    self.add(weight * self.view.direct(&vertex, of_light));
                }
                let probability = if is_split { f64::from(sample.probability) } else { 1.0 };
                let next = weight * sample.weight.as_dvec3() * probability;
                let survival = if depth < SAFE { 1.0 } else { next.max_element().at_most(0.95) };
                if roulette < survival && !(event.is_diffuse() && depth + 1 == longest) {
                    self.extend(&vertex.ray(frame.to_world(sample.wi)), next / survival);
                }
            }
            self.path.events.pop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::scene::builtin;

    #[test]
    fn the_blue_wall_is_on_the_right_and_the_ceiling_above() {
        let (scene, _) = builtin::cornell_lambert();
        let object = |way: DVec3| &scene.objects[farthest(&scene, way).unwrap()];
        let Material::Diffuse { albedo } = object(scene.camera.right).material else { panic!() };
        assert!(albedo.z > albedo.x);
        assert_eq!(object(scene.camera.up).shape.bounds().unwrap().map(|corner| corner.y), [1.5; 2]);
    }
}
