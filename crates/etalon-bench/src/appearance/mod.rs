//! What a BSDF of another program looks like: the spheres of a scene with it; with its values alone, for directions that are uniform on the
//! hemisphere or the sphere, which shows what a fault of its samples, pdf or weights does to the image; and with the model of this program
//! that is closest to it, which shows what a fault of its values does.
//!
//! A path tracer of its own renders all, by light sampling and BSDF sampling combined by multiple importance sampling. It follows one
//! path of every pixel at a time, so that a program gets its requests by the thousand. It shares BSDFs, shapes and the sampler of the
//! map with the renderer, and no more: foreign code has no place in its lanes.
//!
//! Source: Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, section 13.4.

mod closest;

pub use closest::{Model, closest};

use etalon_core::envmap::samplers::{MapSampling, SurfaceSampler};
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::math::Frame;
use etalon_core::raster::Image;
use etalon_core::sampling::stream::CounterRng;
use etalon_core::sampling::warp::{
    self, UNIFORM_HEMISPHERE_PDF, UNIFORM_SPHERE_PDF, uniform_hemisphere, uniform_sphere,
};
use etalon_core::scene::{Emission, Environment, Material, Object, Ray, Rectangle, Request, Scene, Shape};
use etalon_stats::bsdf::{
    BatchBsdf, BsdfSample, DeltaLobe, Density, Direction, Family as _, Pair, PdfKind, Properties, Spectrum,
};
use etalon_stats::estimate;
use glam::{DVec3, Vec3};
use rand::RngExt;
use serde::Serialize;
use std::f64::consts::PI;
use std::path::Path;

/// Rays start so far from a surface, which the shapes of the scene are large against.
const OFFSET: f32 = 1e-4;
/// Random numbers of a vertex besides those of the BSDF: which light, and where on it.
const OF_LIGHT: usize = 3;

/// The images and what they say. Field names are JSON keys.
#[derive(Serialize)]
pub struct Appearance {
    pub scene: String,
    pub bsdf: String,
    pub model: Model,
    pub width: usize,
    pub height: usize,
    pub spp: u32,
    /// From the image of the closest model.
    #[serde(flatten)]
    pub of_model: Difference,
    /// From the image by values alone.
    pub sampling: Difference,
    /// Paths whose light was not finite or negative, which count as black.
    pub dropped: u64,
    pub seconds: f64,
    /// With the BSDF, by its values alone, and with the model.
    #[serde(skip)]
    pub images: [Rendered; 3],
}

/// An image and the standard errors of its pixels.
pub struct Rendered {
    pub image: Image,
    pub error: Image,
}

/// How the image with the BSDF differs from another over the pixels that show it, in percent of the other's mean there. Field names are JSON keys.
#[derive(Serialize)]
pub struct Difference {
    pub mean_difference_percent: f64,
    pub standard_error_percent: f64,
    /// The smallest mean difference that is found with 90 % probability, at [`LEVEL`].
    pub detectable_percent: f64,
    /// Mean absolute difference of the pixels.
    pub pixel_difference_percent: f64,
    /// What noise alone makes of that.
    pub pixel_noise_percent: f64,
    /// The difference of each pixel and those around it, [`AROUND`] to each side; NaN where the other is black.
    #[serde(skip)]
    pub percent: Vec<f64>,
    /// P-value of the mean difference, if there is none in truth.
    #[serde(skip)]
    p: f64,
}

/// Level of the test of a mean difference.
pub const LEVEL: f64 = 1e-3;

/// Pixels to each side over which differences of pixels are averaged: noise would hide them.
pub const AROUND: usize = 2;

impl Difference {
    /// Whether the mean difference is more than noise.
    pub fn is_seen_in_mean(&self) -> bool {
        self.p < LEVEL
    }

    /// Whether it is more than noise, in the mean or in the pixels.
    pub fn is_seen(&self) -> bool {
        const OVER_NOISE: f64 = 1.5;
        self.is_seen_in_mean() || self.pixel_difference_percent > OVER_NOISE * self.pixel_noise_percent
    }
}

/// The samples of the pixels of an image.
struct Sums {
    sums: Vec<DVec3>,
    squares: Vec<DVec3>,
}

impl Sums {
    fn add(&mut self, light: &[DVec3]) {
        for ((sum, square), light) in self.sums.iter_mut().zip(&mut self.squares).zip(light) {
            *sum += light;
            *square += light * light;
        }
    }

    fn rendered(&self, request: &Request) -> Rendered {
        let n = f64::from(request.spp);
        let image = |pixels: Vec<Vec3>| Image::from_pixels(request.width, request.height, pixels);
        let error = |(sum, square): (&DVec3, &DVec3)| {
            let variance = (square - sum * sum / n).max(DVec3::ZERO) / (n * (n - 1.0));
            variance.map(f64::sqrt).as_vec3()
        };
        Rendered {
            image: image(self.sums.iter().map(|sum| (sum / n).as_vec3()).collect()),
            error: image(self.sums.iter().zip(&self.squares).map(error).collect()),
        }
    }
}

/// The differences of samples between two images, in grey.
struct Differences {
    /// The difference of each pixel, over even and over odd samples.
    halves: [Vec<f64>; 2],
    /// The mean over the pixels that show the BSDF, of each sample.
    means: Vec<f64>,
}

impl Differences {
    fn add(&mut self, [a, b]: [&[DVec3]; 2], shows: &[usize]) {
        let half = &mut self.halves[self.means.len() % 2];
        let differences: Vec<f64> = shows.iter().map(|&i| grey(a[i]) - grey(b[i])).collect();
        shows.iter().zip(&differences).for_each(|(&i, difference)| half[i] += difference);
        self.means.push(differences.iter().sum::<f64>() / shows.len() as f64);
    }

    fn difference(&self, [a, b]: [&Sums; 2], shows: &[usize], width: usize) -> Difference {
        let n = self.means.len() as f64;
        let reference = shows.iter().map(|&i| grey(b.sums[i])).sum::<f64>() / (n * shows.len() as f64);
        let percent_of = |x: f64| 100.0 * x / reference;
        let mean = self.means.iter().sum::<f64>() / n;
        let variance = self.means.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let over_pixels = |sign: f64| {
            let of = |i: &usize| (self.halves[0][*i] + sign * self.halves[1][*i]).abs() / n;
            percent_of(shows.iter().map(of).sum::<f64>() / shows.len() as f64)
        };
        let height = a.sums.len() / width;
        let around = |of: &Sums, i: usize| -> f64 {
            let near = |at: usize, end: usize| at.saturating_sub(AROUND)..(at + AROUND + 1).min(end);
            near(i / width, height)
                .flat_map(|y| near(i % width, width).map(move |x| grey(of.sums[y * width + x])))
                .sum()
        };
        let percent = |i: usize| 100.0 * (around(a, i) - around(b, i)) / around(b, i);
        let of_mean = estimate::Difference {
            value: percent_of(mean),
            standard_error: percent_of((variance / n).sqrt()),
            dof: n - 1.0,
            allowance: 0.0,
        };
        Difference {
            mean_difference_percent: of_mean.value,
            standard_error_percent: of_mean.standard_error,
            detectable_percent: of_mean.detectable(LEVEL),
            p: of_mean.p(),
            pixel_difference_percent: over_pixels(1.0),
            pixel_noise_percent: over_pixels(-1.0),
            percent: (0..a.sums.len()).map(percent).collect(),
        }
    }
}

/// Renders the spheres of a scene with `bsdf`, by its values alone, and with the model closest to it; `step` is called after each sample of all
/// pixels of an image.
///
/// # Errors
/// [`Error::Unsupported`] for a scene that has more than spheres, diffuse rectangles and a map; those of [`closest`]; those of the program.
pub fn appearance(
    (name, bsdf): (&str, &dyn BatchBsdf),
    scene: &Scene,
    request: &Request,
    seed: u64,
    step: &dyn Fn(),
) -> Result<Appearance> {
    let started = std::time::Instant::now();
    let tracer = Tracer::new(scene, request, bsdf.properties().transmission, seed)?;
    let (model, family) = closest(name, bsdf)?;
    let values: Vec<f64> = model.parameters.iter().map(|(_, value)| *value).collect();
    let own = family.with(&values)?;
    let by_value = ByValue::new(bsdf);
    let (pixels, shows) = (request.width * request.height, tracer.shows());
    let zeros = || vec![DVec3::ZERO; pixels];
    let mut sums = [(); 3].map(|()| Sums { sums: zeros(), squares: zeros() });
    let none = || Differences { halves: [vec![0.0; pixels], vec![0.0; pixels]], means: Vec::new() };
    let ([mut sampling, mut of_model], mut dropped) = ([none(), none()], 0);
    for sample in 0..request.spp {
        let mut light = Vec::new();
        for (bsdf, sums) in [bsdf, &by_value, &*own].into_iter().zip(&mut sums) {
            let (found, lost) = tracer.sample(bsdf, sample)?;
            sums.add(&found);
            dropped += lost;
            light.push(found);
            step();
        }
        sampling.add([&light[0], &light[1]], &shows);
        of_model.add([&light[0], &light[2]], &shows);
    }
    let [with_bsdf, with_values, with_model] = &sums;
    Ok(Appearance {
        scene: scene.name.clone(),
        bsdf: name.to_owned(),
        width: request.width,
        height: request.height,
        spp: request.spp,
        sampling: sampling.difference([with_bsdf, with_values], &shows, request.width),
        of_model: of_model.difference([with_bsdf, with_model], &shows, request.width),
        dropped,
        seconds: started.elapsed().as_secs_f64(),
        images: sums.each_ref().map(|sums| sums.rendered(request)),
        model,
    })
}

fn grey(rgb: DVec3) -> f64 {
    rgb.element_sum() / 3.0
}

/// A light that is sampled.
enum Source<'a> {
    Environment(&'a Environment, Box<dyn SurfaceSampler>),
    Rectangle(&'a Rectangle, Emission, usize),
}

struct Tracer<'a> {
    scene: &'a Scene,
    request: &'a Request,
    seed: u64,
    lights: Vec<Source<'a>>,
}

/// A path on its way.
struct Way {
    pixel: usize,
    ray: Ray,
    throughput: DVec3,
    /// The pdf of the ray's direction and the normal where it starts, where light samples could have found what it hits.
    sampled: Option<(f64, DVec3)>,
}

/// Where a path meets a surface.
struct Vertex {
    way: Way,
    point: Vec3,
    frame: Frame,
    wo: Direction,
    /// Albedo of a diffuse surface; `None` of the BSDF under test.
    albedo: Option<DVec3>,
}

impl Vertex {
    fn ray(&self, wi: Vec3) -> Ray {
        let side = OFFSET.copysign(self.frame.z.dot(wi));
        Ray { origin: self.point + side * self.frame.z, direction: wi }
    }

    fn local(&self, wi: Vec3) -> Direction {
        // In double precision, so that it has unit length for the program.
        self.frame.to_local(wi).as_dvec3().normalize().to_array()
    }
}

impl<'a> Tracer<'a> {
    /// Prepares a scene for BSDFs that transmit light, or that do not.
    fn new(scene: &'a Scene, request: &'a Request, transmits: bool, seed: u64) -> Result<Self> {
        let unsupported = |what: &str| {
            let message = format!("{what}; a BSDF of another program is shown on spheres among diffuse rectangles");
            Err(Error::unsupported(Path::new(&scene.name), message)
                .with_hint("such scenes are sphere-env, cornell-spheres and furnace"))
        };
        let is_sphere = |object: &&Object| matches!(object.shape, Shape::Sphere(_));
        if !scene.objects.iter().any(|object| is_sphere(&object)) {
            return unsupported("the scene has no sphere");
        }
        let of_rest = |object: &Object| match (&object.shape, &object.material) {
            (Shape::Sphere(_), _) => object.emission.is_none(),
            (Shape::Rectangle(_), Material::Diffuse { .. }) => true,
            _ => false,
        };
        if !scene.objects.iter().all(of_rest) || !scene.lights.is_empty() {
            return unsupported("the scene has other shapes, materials or lights");
        }
        let mut lights = Vec::new();
        if let Some(environment) = &scene.environment {
            let sampling = if transmits { MapSampling::MAP } else { MapSampling::COSINE };
            lights.push(Source::Environment(environment, sampling.sampler(environment.map.clone())?));
        }
        for (i, object) in scene.objects.iter().enumerate() {
            if let (Shape::Rectangle(rectangle), Some(emission)) = (&object.shape, object.emission) {
                lights.push(Source::Rectangle(rectangle, emission, i));
            }
        }
        Ok(Self { scene, request, seed, lights })
    }

    /// The first object along a ray and the distance to it.
    fn nearest(&self, ray: &Ray) -> Option<(usize, f32)> {
        let distance = |object: &Object| match &object.shape {
            Shape::Sphere(sphere) => sphere.distance(ray.origin, ray.direction),
            Shape::Rectangle(rectangle) => rectangle.distance(ray.origin, ray.direction),
            Shape::Mesh(_) => f32::INFINITY,
        };
        let all = self.scene.objects.iter().map(distance).enumerate();
        all.filter(|(_, t)| t.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn camera_ray(&self, pixel: usize, [u, v]: [f64; 2]) -> Ray {
        let (x, y) = (pixel % self.request.width, pixel / self.request.width);
        self.scene.camera.ray((x as f64 + u) / self.request.width as f64, (y as f64 + v) / self.request.height as f64)
    }

    /// The pixels whose centres show a sphere.
    fn shows(&self) -> Vec<usize> {
        let is_sphere = |i: usize| matches!(self.scene.objects[i].shape, Shape::Sphere(_));
        let shows = |pixel: &usize| self.nearest(&self.camera_ray(*pixel, [0.5; 2])).is_some_and(|(i, _)| is_sphere(i));
        (0..self.request.width * self.request.height).filter(shows).collect()
    }

    /// Random numbers of a path after n scatterings; those of its film position are of the number `u32::MAX`.
    fn random(&self, sample: u32, scatterings: u32, pixel: usize) -> CounterRng {
        CounterRng::new(self.seed ^ (u64::from(sample) << 32), (u64::from(scatterings) << 32) | pixel as u64)
    }

    /// The light of a path through each pixel, and how many were dropped.
    fn sample(&self, bsdf: &dyn BatchBsdf, sample: u32) -> Result<(Vec<DVec3>, u64)> {
        if interrupt::requested() {
            return Err(Error::Interrupted);
        }
        let mut light = vec![DVec3::ZERO; self.request.width * self.request.height];
        let properties = bsdf.properties();
        let camera = |pixel| {
            let mut rng = self.random(sample, u32::MAX, pixel);
            let ray = self.camera_ray(pixel, [rng.random(), rng.random()]);
            Way { pixel, ray, throughput: DVec3::ONE, sampled: None }
        };
        let mut ways: Vec<Way> = (0..light.len()).map(camera).collect();
        for scatterings in 0..=self.request.max_depth {
            let mut vertices = Vec::new();
            for way in ways {
                let hit = self.nearest(&way.ray);
                light[way.pixel] += way.throughput * self.emission(&way, hit);
                vertices.extend(hit.and_then(|hit| self.vertex(way, hit)));
            }
            if scatterings == self.request.max_depth {
                break;
            }
            let dimension = OF_LIGHT + properties.dimension.max(3) + properties.eval_dimension;
            let numbers = |vertex: &Vertex| {
                let mut rng = self.random(sample, scatterings, vertex.way.pixel);
                (0..dimension).map(|_| rng.random()).collect::<Vec<f64>>()
            };
            let u: Vec<Vec<f64>> = vertices.iter().map(numbers).collect();
            self.add_direct_light(bsdf, &properties, &vertices, &u, &mut light)?;
            ways = Self::scatter(bsdf, &properties, vertices, &u)?;
        }
        let mut dropped = 0;
        for light in &mut light {
            if !(light.is_finite() && light.min_element() >= 0.0) {
                (*light, dropped) = (DVec3::ZERO, dropped + 1);
            }
        }
        Ok((light, dropped))
    }

    fn vertex(&self, way: Way, (i, t): (usize, f32)) -> Option<Vertex> {
        let object = &self.scene.objects[i];
        let point = way.ray.origin + t * way.ray.direction;
        let (normal, albedo) = match (&object.shape, &object.material) {
            (Shape::Sphere(sphere), _) => ((point - sphere.centre).normalize(), None),
            (Shape::Rectangle(rectangle), Material::Diffuse { albedo }) => {
                let normal = rectangle.normal();
                let facing = if normal.dot(way.ray.direction) > 0.0 { -normal } else { normal };
                (facing, Some(albedo.as_dvec3()))
            }
            _ => return None,
        };
        if albedo == Some(DVec3::ZERO) {
            return None;
        }
        let vertex = Vertex { way, point, frame: Frame::from_normal(normal), wo: [0.0; 3], albedo };
        let wo = vertex.local(-vertex.way.ray.direction);
        Some(Vertex { wo, ..vertex })
    }

    /// The light that a ray finds, by the balance heuristic where light samples could have found it.
    fn emission(&self, way: &Way, hit: Option<(usize, f32)>) -> DVec3 {
        let direction = way.ray.direction;
        let radiance = match hit {
            None => self.scene.environment.as_ref().map(|environment| environment.radiance(direction.as_dvec3())),
            Some((i, _)) => match (&self.scene.objects[i].shape, self.scene.objects[i].emission) {
                (Shape::Rectangle(rectangle), Some(emission)) if emission.is_emitted(rectangle.normal(), direction) => {
                    Some(emission.radiance)
                }
                _ => None,
            },
        };
        let Some(radiance) = radiance.map(|radiance| radiance.as_dvec3()) else { return DVec3::ZERO };
        let Some((pdf, normal)) = way.sampled else { return radiance };
        let of_light = |source: &Source| match (source, hit) {
            (Source::Environment(environment, sampler), None) => {
                sampler.pdf_for(environment.to_map(direction.as_dvec3()), environment.to_map(normal))
            }
            (Source::Rectangle(rectangle, _, number), Some((i, t))) if i == *number => {
                area_pdf(rectangle, direction, t)
            }
            _ => 0.0,
        };
        let by_light = self.lights.iter().map(of_light).sum::<f64>() / self.lights.len().max(1) as f64;
        radiance * if by_light > 0.0 { pdf / (pdf + by_light) } else { 1.0 }
    }

    /// Adds a sample of a light, chosen uniformly, at each vertex.
    fn add_direct_light(
        &self,
        bsdf: &dyn BatchBsdf,
        properties: &Properties,
        vertices: &[Vertex],
        u: &[Vec<f64>],
        light: &mut [DVec3],
    ) -> Result<()> {
        // Directions that are not occluded, with the radiance over the pdf
        let mut samples = Vec::new();
        for (i, (vertex, u)) in vertices.iter().zip(u).enumerate() {
            let count = self.lights.len();
            let Some(source) = self.lights.get((u[0] * count as f64) as usize) else { continue };
            let found = match source {
                Source::Environment(environment, sampler) => {
                    let normal = environment.to_map(vertex.frame.z.as_dvec3());
                    sampler.sample_for([u[1], u[2]], normal).map(|sample| {
                        let wi = (environment.to_world * sample.wi).as_vec3();
                        let radiance = (sample.radiance * environment.scale).as_dvec3();
                        (wi, radiance, sample.pdf, None)
                    })
                }
                Source::Rectangle(rectangle, emission, number) => {
                    let [x, y] = rectangle.half_sides();
                    let [s, t] = [u[1], u[2]].map(|u| (2.0 * u - 1.0) as f32);
                    let towards = rectangle.centre() + s * x + t * y - vertex.point;
                    let (wi, distance) = (towards.normalize(), towards.length());
                    let emitted = emission.is_emitted(rectangle.normal(), wi);
                    let pdf = area_pdf(rectangle, wi, distance);
                    emitted.then_some((wi, emission.radiance.as_dvec3(), pdf, Some(*number)))
                }
            };
            let Some((wi, radiance, pdf, number)) = found else { continue };
            let pdf = pdf / count as f64;
            if pdf > 0.0 && self.nearest(&vertex.ray(wi)).map(|(i, _)| i) == number {
                samples.push((i, wi, radiance, pdf));
            }
        }
        // The BSDF is asked for all at once
        let of_bsdf = || samples.iter().filter(|(i, ..)| vertices[*i].albedo.is_none());
        let pairs: Vec<Pair> = of_bsdf().map(|(i, wi, ..)| [vertices[*i].wo, vertices[*i].local(*wi)]).collect();
        let random: Vec<f64> =
            of_bsdf().flat_map(|(i, ..)| u[*i].iter().rev().take(properties.eval_dimension)).copied().collect();
        let (f, pdf) = (bsdf.eval(&pairs, &random)?, bsdf.pdf(&pairs)?);
        let mut evaluated = f.into_iter().zip(pdf);
        for (i, wi, radiance, by_light) in &samples {
            let vertex = &vertices[*i];
            let cos = vertex.local(*wi)[2];
            let (f, pdf) = match vertex.albedo {
                Some(albedo) if cos > 0.0 => (albedo / PI, cos / PI),
                Some(_) => continue,
                None => evaluated.next().map_or((DVec3::ZERO, 0.0), |(f, pdf)| (rgb(f), pdf)),
            };
            light[vertex.way.pixel] += vertex.way.throughput * f * *radiance * (cos.abs() / (by_light + pdf));
        }
        Ok(())
    }

    /// The paths that go on, by samples of the BSDFs.
    fn scatter(
        bsdf: &dyn BatchBsdf,
        properties: &Properties,
        vertices: Vec<Vertex>,
        u: &[Vec<f64>],
    ) -> Result<Vec<Way>> {
        let of_bsdf = || vertices.iter().zip(u).filter(|(vertex, _)| vertex.albedo.is_none());
        let wos: Vec<Direction> = of_bsdf().map(|(vertex, _)| vertex.wo).collect();
        let random: Vec<f64> =
            of_bsdf().flat_map(|(_, u)| &u[OF_LIGHT..OF_LIGHT + properties.dimension]).copied().collect();
        let mut sampled = bsdf.sample(&wos, &random)?.into_iter();
        let mut ways = Vec::new();
        for (vertex, u) in vertices.into_iter().zip(u) {
            let (wi, weight, pdf) = match vertex.albedo {
                Some(albedo) => {
                    let wi = warp::cosine_hemisphere([u[OF_LIGHT], u[OF_LIGHT + 1]]);
                    (wi.to_array(), albedo, Some(warp::cosine_hemisphere_pdf(wi.z)))
                }
                None => match sampled.next().flatten() {
                    None => continue,
                    Some(sample) => {
                        let pdf = match sample.density {
                            Density::Pdf(pdf) => Some(pdf),
                            // Light samples found all of it
                            Density::Unknown => Some(0.0),
                            Density::Delta(_) => None,
                        };
                        (sample.wi, rgb(sample.weight), pdf)
                    }
                },
            };
            let wi = vertex.frame.to_world(DVec3::from_array(wi).as_vec3()).normalize();
            if weight != DVec3::ZERO && wi.is_finite() {
                let ray = vertex.ray(wi);
                let sampled = pdf.map(|pdf| (pdf, vertex.frame.z.as_dvec3()));
                ways.push(Way { ray, throughput: vertex.way.throughput * weight, sampled, ..vertex.way });
            }
        }
        Ok(ways)
    }
}

fn rgb(spectrum: Spectrum) -> DVec3 {
    DVec3::from_array(spectrum)
}

/// The pdf per solid angle of a point that is uniform on a rectangle, seen in this direction at this distance.
fn area_pdf(rectangle: &Rectangle, wi: Vec3, distance: f32) -> f64 {
    let cos = rectangle.normal().dot(wi).abs();
    f64::from(distance * distance) / f64::from(cos * rectangle.area())
}

/// A BSDF of which only the values are asked: its directions are uniform on the hemisphere, or on the sphere if it transmits. Delta lobes, which
/// have no values, are sampled as they are declared, one of all with probability ½.
struct ByValue<'a> {
    bsdf: &'a dyn BatchBsdf,
    properties: Properties,
}

/// Random numbers of a direction: two, and one that chooses a delta lobe.
const OF_DIRECTION: usize = 3;

impl<'a> ByValue<'a> {
    fn new(bsdf: &'a dyn BatchBsdf) -> Self {
        let of_bsdf = bsdf.properties();
        let dimension = OF_DIRECTION + of_bsdf.eval_dimension;
        Self { bsdf, properties: Properties { dimension, pdf: PdfKind::Exact, ..of_bsdf } }
    }

    /// The probability of a direction that is not that of a delta lobe.
    fn spread(&self) -> f64 {
        if self.properties.delta { 0.5 } else { 1.0 }
    }

    fn uniform_pdf(&self) -> f64 {
        self.spread() * if self.properties.transmission { UNIFORM_SPHERE_PDF } else { UNIFORM_HEMISPHERE_PDF }
    }

    fn is_met(&self, [wo, wi]: &Pair) -> bool {
        self.properties.transmission || wo[2] * wi[2] > 0.0
    }
}

impl BatchBsdf for ByValue<'_> {
    fn properties(&self) -> Properties {
        self.properties.clone()
    }

    fn eval(&self, pairs: &[Pair], u: &[f64]) -> etalon_stats::Result<Vec<Spectrum>> {
        self.bsdf.eval(pairs, u)
    }

    fn pdf(&self, pairs: &[Pair]) -> etalon_stats::Result<Vec<f64>> {
        Ok(pairs.iter().map(|pair| if self.is_met(pair) { self.uniform_pdf() } else { 0.0 }).collect())
    }

    fn sample(&self, wos: &[Direction], u: &[f64]) -> etalon_stats::Result<Vec<Option<BsdfSample>>> {
        let numbers = || u.chunks_exact(self.properties.dimension);
        let direction = |(wo, u): (&Direction, &[f64])| {
            let u = [u[0], u[1]];
            let [x, y, z] =
                if self.properties.transmission { uniform_sphere(u) } else { uniform_hemisphere(u) }.to_array();
            [*wo, [x, y, if wo[2] < 0.0 { -z } else { z }]]
        };
        let pairs: Vec<Pair> = wos.iter().zip(numbers()).map(direction).collect();
        let rest: Vec<f64> = numbers().flat_map(|u| &u[OF_DIRECTION..]).copied().collect();
        let (values, lobes) = (self.bsdf.eval(&pairs, &rest)?, self.bsdf.delta_lobes(wos)?);
        let sample = |(i, u): (usize, &[f64])| {
            let ([_, wi], f, lobes) = (&pairs[i], values[i], &lobes[i]);
            let pdf = self.uniform_pdf();
            if u[2] < self.spread() {
                return Some(BsdfSample::new(*wi, f.map(|f| f * wi[2].abs() / pdf), Density::Pdf(pdf)));
            }
            let probability = (1.0 - self.spread()) / lobes.len() as f64;
            let lobe = lobes.get(((u[2] - self.spread()) / probability) as usize)?;
            let weight = lobe.throughput.map(|throughput| throughput / probability);
            Some(BsdfSample::new(lobe.wi, weight, Density::Delta(probability)))
        };
        Ok(numbers().enumerate().map(sample).collect())
    }

    fn delta_lobes(&self, wos: &[Direction]) -> etalon_stats::Result<Vec<Vec<DeltaLobe>>> {
        self.bsdf.delta_lobes(wos)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::validation::families;
    use etalon_core::scene::builtin;
    use etalon_render::{Settings, Silent, render};
    use etalon_stats::bsdf::Parameter;

    fn mean(light: &[DVec3]) -> f64 {
        light.iter().copied().map(grey).sum::<f64>() / light.len() as f64
    }

    /// The mean of the image of a scene of white spheres, its standard error, and the mean of the renderer's image.
    fn means((scene, request): (Scene, Request), albedo: f64) -> [f64; 3] {
        let (scene, request) = scene.resized(request, [24, 18]);
        let request = Request { spp: 256, ..request };
        let rendered = render(&scene, &request, &Settings::usual(), &Silent).unwrap();
        let rendered: Vec<DVec3> = rendered.image.pixels().iter().map(|p| p.as_dvec3()).collect();
        let all = families::all();
        let diffuse = all.iter().find(|family| family.name() == "diffuse").unwrap().with(&[albedo]).unwrap();
        let tracer = Tracer::new(&scene, &request, false, 1).unwrap();
        let samples: Vec<f64> = (0..request.spp).map(|i| mean(&tracer.sample(&*diffuse, i).unwrap().0)).collect();
        let n = samples.len() as f64;
        let found = samples.iter().sum::<f64>() / n;
        let variance = samples.iter().map(|x| (x - found).powi(2)).sum::<f64>() / (n - 1.0);
        [found, (variance / n).sqrt(), mean(&rendered)]
    }

    #[test]
    fn images_have_the_mean_of_the_renderer() {
        // A map with a bright texel, that light samples and BSDF samples find
        let bright = |x, y| Vec3::splat(if (x, y) == (5, 1) { 20.0 } else { 0.5 });
        let map = etalon_core::envmap::EnvMap::new(Image::from_fn(8, 4, bright));
        let environment = Environment::upright(map.into(), "bright", 1.0);
        for (scene, albedo) in [(builtin::cornell_lambert(), 0.6), (builtin::sphere_env(environment), 1.0)] {
            let [found, error, expected] = means(scene, albedo);
            assert!(error < 0.01 * expected && (found - expected).abs() < 5.0 * error, "{found} ± {error}, {expected}");
        }
    }

    /// A BSDF of the program looks the same by its values alone: with a diffuse and a glossy lobe, with glass and its delta lobes.
    #[test]
    fn values_alone_make_the_same_image() {
        let map = etalon_core::envmap::EnvMap::new(Image::from_fn(8, 4, |x, _| Vec3::splat(1.0 + x as f32)));
        let environment = Environment::upright(map.into(), "smooth", 1.0);
        let (scene, request) = builtin::sphere_env(environment);
        let (scene, request) = scene.resized(request, [24, 18]);
        let request = Request { spp: 256, max_depth: 3, ..request };
        for name in ["ggx", "ggx-dielectric", "dielectric"] {
            let all = families::all();
            let family = all.iter().find(|family| family.name() == name).unwrap();
            // Wide lobes, which uniform directions meet
            let wide = |parameter: &Parameter| if parameter.name.starts_with("alpha") { 0.7 } else { parameter.value };
            let bsdf = family.with(&family.parameters().iter().map(wide).collect::<Vec<f64>>()).unwrap();
            let tracer = Tracer::new(&scene, &request, bsdf.properties().transmission, 1).unwrap();
            let of = |bsdf: &dyn BatchBsdf, i: u32| mean(&tracer.sample(bsdf, i).unwrap().0);
            let by_value = ByValue::new(&*bsdf);
            let differences: Vec<f64> = (0..request.spp).map(|i| of(&*bsdf, i) - of(&by_value, i)).collect();
            let n = differences.len() as f64;
            let found = differences.iter().sum::<f64>() / n;
            let error = (differences.iter().map(|x| (x - found).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt();
            assert!(found.abs() < 4.0 * error && error < 0.2, "{name}: {found} ± {error}");
        }
    }

    #[test]
    fn other_scenes_are_refused() {
        let statue = builtin::find("cornell-statue-au").unwrap().make(None, None).unwrap();
        let error =
            Tracer::new(&statue.0, &statue.1, false, 1).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains("no sphere"), "{error}");
    }
}
