//! The path integrator: what light arrives along a camera ray.
//!
//! At each hit, `light_samples` directions are drawn by each strategy in use and the environment seen along them is
//! added up; with both strategies they are weighted by the balance heuristic. The first direction drawn by the
//! material also carries the path on. `OCCLUSION` says whether rays that leave a surface can meet another one at all;
//! where they cannot, neither shadow rays nor further bounces exist in the compiled loop.

use super::strategies::Strategies;
use crate::bsdf::diffuse;
use crate::raster::Rgb;
use crate::sampling::stream::Stream;
use crate::scene::{Environment, Hit, Material, Ray, Request, Scene, Shape};
use glam::{DVec3, Vec3};

/// A scene made ready for rendering.
pub struct Integrator<'a> {
    pub scene: &'a Scene,
    pub strategies: &'a Strategies,
    pub request: &'a Request,
}

/// Pairs of random numbers that each hit of a path draws from, after the one for the film position.
#[derive(Clone, Copy)]
struct Dimensions {
    light: u32,
    bsdf: u32,
}

impl Dimensions {
    fn of_hit(depth: u32) -> Self {
        Self { light: 2 * depth - 1, bsdf: 2 * depth }
    }
}

/// A hit with its local frame, the normal on the side of the viewer.
struct Surface {
    hit: Hit,
    tangent: DVec3,
    bitangent: DVec3,
    normal: DVec3,
    albedo: Rgb,
}

impl Surface {
    #[inline]
    fn new(hit: Hit, material: &Material, wo: Vec3) -> Self {
        let normal = hit.normal.as_dvec3() * if hit.normal.dot(wo) < 0.0 { -1.0 } else { 1.0 };
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let Material::Diffuse { albedo } = *material else {
            return Self { hit, tangent, bitangent, normal, albedo: Rgb::ZERO };
        };
        Self { hit, tangent, bitangent, normal, albedo }
    }

    #[inline]
    fn to_world(&self, local: DVec3) -> DVec3 {
        self.tangent * local.x + self.bitangent * local.y + self.normal * local.z
    }
}

impl Integrator<'_> {
    /// Radiance that arrives along a camera ray.
    #[inline]
    pub fn radiance<S: Stream, const OCCLUSION: bool>(&self, mut ray: Ray, stream: S) -> Rgb {
        let mut sum = Rgb::ZERO;
        let mut throughput = Rgb::ONE;
        let Some(environment) = &self.scene.environment else { return sum };
        let mut depth = 0;
        loop {
            let Some((hit, material)) = intersect(self.scene, &ray) else {
                if depth == 0 {
                    sum += environment.radiance(ray.direction.as_dvec3());
                }
                return sum;
            };
            if depth == self.request.max_depth {
                return sum;
            }
            depth += 1;
            let surface = Surface::new(hit, material, -ray.direction);
            let dimensions = Dimensions::of_hit(depth);
            sum += throughput * self.direct::<S, OCCLUSION>(&surface, environment, stream, dimensions);
            if !OCCLUSION || depth == self.request.max_depth {
                return sum;
            }
            // The direction drawn by the material carries the path on; f cos / pdf is the albedo.
            let wi = surface.to_world(diffuse::sample(stream.pair_of(dimensions.bsdf, 0, self.request.light_samples)));
            throughput *= surface.albedo;
            ray = surface.hit.ray_towards(wi.as_vec3());
        }
    }

    /// Light that comes straight from the environment and is scattered towards the viewer.
    #[inline]
    fn direct<S: Stream, const OCCLUSION: bool>(
        &self,
        surface: &Surface,
        environment: &Environment,
        stream: S,
        dimensions: Dimensions,
    ) -> Rgb {
        let n = self.request.light_samples;
        let visible = |wi: DVec3| !OCCLUSION || intersect(self.scene, &surface.hit.ray_towards(wi.as_vec3())).is_none();
        let map_normal = environment.to_map(surface.normal);
        let mut sum = Rgb::ZERO;
        if let Some(sampler) = self.strategies.light() {
            for i in 0..n {
                let u = stream.pair_of(dimensions.light, i, n);
                let Some(light) = sampler.sample_for(u, map_normal) else { continue };
                let wi = environment.to_world * light.wi;
                let cos = surface.normal.dot(wi);
                if cos > 0.0 && visible(wi) {
                    let other = self.strategies.scatter().map_or(0.0, |scatter| scatter.pdf(cos));
                    sum += light.radiance * (cos * balance_heuristic(light.pdf, other)) as f32;
                }
            }
        }
        if let Some(scatter) = self.strategies.scatter() {
            for i in 0..n {
                let local = scatter.sample(stream.pair_of(dimensions.bsdf, i, n));
                let (wi, pdf) = (surface.to_world(local), scatter.pdf(local.z));
                if pdf > 0.0 && visible(wi) {
                    let map_wi = environment.to_map(wi);
                    let other = self.strategies.light().map_or(0.0, |light| light.pdf_for(map_wi, map_normal));
                    sum += environment.map.radiance(map_wi) * (local.z * balance_heuristic(pdf, other)) as f32;
                }
            }
        }
        diffuse::eval(surface.albedo) * environment.scale * sum / n as f32
    }
}

/// The weight of a sample over its density `p` when another strategy, of density `other` there, draws as many:
/// (p / (p + q)) / p. Source: Veach & Guibas, "Optimally Combining Sampling Techniques", 1995, section 3.
#[inline]
fn balance_heuristic(p: f64, other: f64) -> f64 {
    1.0 / (p + other)
}

/// The nearest hit of a ray, beyond its origin.
fn intersect<'a>(scene: &'a Scene, ray: &Ray) -> Option<(Hit, &'a Material)> {
    let mut nearest: Option<(Hit, &Material)> = None;
    for object in &scene.objects {
        let limit = nearest.as_ref().map_or(f32::INFINITY, |(hit, _)| hit.t);
        let Shape::Sphere(sphere) = &object.shape else { continue };
        if let Some(hit) = sphere.intersect(ray, limit) {
            nearest = Some((hit, &object.material));
        }
    }
    nearest
}
