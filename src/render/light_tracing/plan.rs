//! Where light paths start, the targets of their first directions, and where their contributions are used.

use crate::bsdf::Scatter;
use crate::math::Rgb;
use crate::math::circular::Circular;
use crate::render::geometry::Geometry;
use crate::render::lights::Sampled;
use crate::render::settings::{Sampling, Settings};
use crate::render::shaders::{Kind, SurfaceShader};
use crate::render::solids;
use crate::sampling::hash::mix64;
use crate::scene::{Request, Scene, Shape, Sphere};
use glam::Vec3;
use std::f32::consts::TAU;

/// Light tracing is used where the whole image covers at least this area, in squares of the scene's extent. Nearer to the
/// camera few light paths reach any one pixel, and each is a firefly.
const NEAREST: f32 = 0.05;

/// Camera samples of a pixel for each light path.
pub const SAMPLES_PER_LIGHT_PATH: u32 = 5;

/// More targets than these are merged into one.
const MOST_TARGETS: usize = 8;

/// The lights and targets of light paths.
pub struct LightTracing {
    lights: Vec<Emitter>,
    /// Bounding spheres of the objects that are not diffuse.
    targets: Vec<Sphere>,
    /// Per object, whether light paths scatter there.
    scatters: Vec<bool>,
    /// [`Lens::area_at`](crate::render::lens::Lens::area_at) from which on light paths are used.
    nearest: f32,
}

/// An area light that paths start from.
pub struct Emitter {
    /// Number of the light.
    pub light: usize,
    /// Radiance times area over the probability of this light.
    pub power: Rgb,
    /// The probability of this light and those before it.
    cdf: f32,
}

impl LightTracing {
    /// Prepares light tracing; `None` where the scene has no caustics, or the settings ask for another strategy.
    pub fn new(
        scene: &Scene,
        request: &Request,
        settings: &Settings,
        shaders: &[SurfaceShader],
        lights: &[Sampled],
        geometry: &Geometry<'_>,
    ) -> Option<Self> {
        if settings.sampling != Sampling::Mis || settings.camera_paths_only || request.max_depth < 2 {
            return None;
        }
        let scatters: Vec<bool> =
            shaders.iter().zip(&scene.objects).map(|(shader, o)| scatters(shader, &o.shape)).collect();
        let targets =
            targets(scene.objects.iter().zip(&scatters).filter(|(_, scatters)| **scatters).map(|(o, _)| &o.shape));
        let has_diffuse = shaders.iter().any(|shader| matches!(shader.kind, Kind::Diffuse { .. }));
        let lights = emitters(lights);
        let nearest = NEAREST * geometry.extent().powi(2);
        (has_diffuse && !targets.is_empty() && !lights.is_empty()).then_some(Self {
            lights,
            targets,
            scatters,
            nearest,
        })
    }

    /// Whether light paths start at light number `light`.
    #[inline]
    pub fn starts_at(&self, light: usize) -> bool {
        self.lights.iter().any(|emitter| emitter.light == light)
    }

    /// Whether light paths scatter at an object.
    #[inline]
    pub fn scatters_at(&self, object: u32) -> bool {
        self.scatters[object as usize]
    }

    /// Whether light paths are connected to the camera where the whole image covers this area
    /// ([`Lens::area_at`](crate::render::lens::Lens::area_at)).
    #[inline]
    pub fn reaches(&self, area: f32) -> bool {
        area > self.nearest
    }

    /// The number of the light path that is traced with a sample of a pixel, if one is. The first comes with a random one of
    /// the first [`SAMPLES_PER_LIGHT_PATH`] samples, so that the expected number of paths is right for few samples, too.
    #[inline]
    pub fn path(seed: u64, pixel: u64, sample: u32) -> Option<u32> {
        let phase = mix64(seed ^ mix64(pixel)) as u32 % SAMPLES_PER_LIGHT_PATH;
        (sample % SAMPLES_PER_LIGHT_PATH == phase).then_some(sample / SAMPLES_PER_LIGHT_PATH)
    }

    /// Samples a light in proportion to its power.
    #[inline]
    pub fn light(&self, u: f32) -> &Emitter {
        let number = self.lights.partition_point(|emitter| emitter.cdf <= u);
        &self.lights[number.min(self.lights.len() - 1)]
    }

    /// Samples a direction from a point to the targets, uniformly over the solid angle of each; returns it and 1/pdf.
    #[inline]
    pub fn direction(&self, point: Vec3, choice: f32, u: [f32; 2]) -> (Vec3, f32) {
        // Choose a target in proportion to its solid angle.
        let total: f32 = self.targets.iter().map(|target| cone(target, point).1).sum();
        let mut rest = choice * total;
        let (mut axis, mut one_minus_cos_half_angle) = (Vec3::Y, 2.0);
        for target in &self.targets {
            (axis, one_minus_cos_half_angle) = cone(target, point);
            if rest < one_minus_cos_half_angle {
                break;
            }
            rest -= one_minus_cos_half_angle;
        }
        // Sample the cone around it uniformly.
        let below = u[0] * one_minus_cos_half_angle;
        let (sin, cos) = ((below * (2.0 - below)).max(0.0).sqrt(), 1.0 - below);
        let (x, y) = axis.any_orthonormal_pair();
        let (sin_phi, cos_phi) = f32::sin_cos_turns(u[1]);
        let direction = (x * cos_phi + y * sin_phi) * sin + axis * cos;
        // Divide by the number of targets in this direction: their cones may overlap.
        let contains = |target: &&Sphere| {
            let (axis, one_minus_cos_half_angle) = cone(target, point);
            0.5 * (direction - axis).length_squared() <= one_minus_cos_half_angle
        };
        let containing = self.targets.iter().filter(contains).count();
        // Rounding at the rim may exclude the chosen target itself.
        (direction, TAU * total / containing.max(1) as f32)
    }
}

/// The cone around a sphere: its axis, and 1 − cos of its half angle; 2, all directions, from inside.
#[inline]
fn cone(sphere: &Sphere, point: Vec3) -> (Vec3, f32) {
    let to = sphere.centre - point;
    let d2 = to.length_squared();
    let sin2 = sphere.radius * sphere.radius / d2;
    if sin2 < 1.0 { (to / d2.sqrt(), solids::one_minus_cos_half_angle(sin2)) } else { (Vec3::Y, 2.0) }
}

/// Whether light paths scatter at a surface: at rough metal of any shape; at mirrors and glass only without interpolated
/// normals, which differ between the ends of a path. Materials that are not reciprocal are left to camera paths.
fn scatters(shader: &SurfaceShader, shape: &Shape) -> bool {
    match shader.kind {
        Kind::Black | Kind::Diffuse { .. } => false,
        Kind::Rough(bsdf) => bsdf.is_reciprocal(),
        Kind::Delta(bsdf) => bsdf.is_reciprocal() && !matches!(shape, Shape::Mesh(_)),
    }
}

fn targets<'a>(shapes: impl Iterator<Item = &'a Shape>) -> Vec<Sphere> {
    let bounding_sphere = |shape: &Shape| match shape {
        Shape::Sphere(sphere) => *sphere,
        Shape::Rectangle(r) => Sphere { centre: r.centre(), radius: (r.corners()[0] - r.centre()).length() },
        Shape::Mesh(mesh) => {
            let [low, high] = mesh.bounds().unwrap_or_default();
            let centre = 0.5 * (low + high);
            let radius2 = mesh.positions.iter().map(|p| p.distance_squared(centre)).fold(0.0, f32::max);
            Sphere { centre, radius: radius2.sqrt() }
        }
    };
    // Enlarge the spheres, so that rounding leaves nothing outside.
    let grown = |target: Sphere| Sphere { radius: target.radius * 1.000_01, ..target };
    let all: Vec<Sphere> = shapes.map(|shape| grown(bounding_sphere(shape))).collect();
    if all.len() <= MOST_TARGETS {
        return all;
    }
    let centre = all.iter().map(|target| target.centre).sum::<Vec3>() / all.len() as f32;
    let radius = all.iter().map(|target| target.centre.distance(centre) + target.radius).fold(0.0, f32::max);
    vec![Sphere { centre, radius }]
}

/// The area lights with their power and the cumulative probability of choosing them.
fn emitters(lights: &[Sampled]) -> Vec<Emitter> {
    let powers = || lights.iter().enumerate().filter_map(|(i, light)| light.emitted().map(|(r, area)| (i, r * area)));
    let total: f32 = powers().map(|(_, power)| power.element_sum()).sum();
    let mut cdf = 0.0;
    powers()
        .map(|(light, power)| {
            let probability = power.element_sum() / total;
            cdf += probability;
            Emitter { light, power: power / probability, cdf }
        })
        .collect()
}
