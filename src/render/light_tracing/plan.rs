//! Where paths from the lamps start, what they aim at, and where they are worth it.

use crate::bsdf::Scatter;
use crate::math::Rgb;
use crate::math::circular::Circular;
use crate::render::shaders::{SurfaceShader, Kind};
use crate::render::geometry::Geometry;
use crate::render::lights::Sampled;
use crate::render::settings::{Sampling, Settings};
use crate::render::solids;
use crate::sampling::hash::mix64;
use crate::scene::{Request, Scene, Shape};
use glam::Vec3;
use std::f32::consts::TAU;

/// Paths from the lamps reach what is so far from the camera that the whole picture shows this much of it, as a share
/// of the square of the scene's extent. Nearer to the camera few of them come to any one pixel, and each is a speck.
const NEAREST: f32 = 0.05;

/// Of so many samples of a pixel one comes with a path from a lamp.
pub const SAMPLES_PER_LIGHT_PATH: u32 = 5;

/// Of more targets than these all are taken as one.
const MOST_TARGETS: usize = 8;

/// What paths from the lamps need.
pub struct LightTracing {
    lamps: Vec<Lamp>,
    targets: Vec<Target>,
    /// Per object, whether these paths scatter there.
    casts: Vec<bool>,
    /// [`Lens::area_at`](crate::render::lens::Lens::area_at) from which on these paths bring the light.
    nearest: f32,
}

/// A lamp that paths start from.
pub struct Lamp {
    /// Number of the light.
    pub light: usize,
    /// Radiance times area over the probability of this lamp.
    pub power: Rgb,
    /// The probability of this lamp and those before it.
    up_to: f32,
}

/// A ball around an object that is not diffuse.
#[derive(Clone, Copy)]
struct Target {
    centre: Vec3,
    radius: f32,
}

impl LightTracing {
    /// Looks at a scene once; `None` where there are no such paths, or the settings ask for the light to be found in other
    /// ways.
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
        let casts: Vec<bool> = shaders.iter().zip(&scene.objects).map(|(shader, o)| casts(shader, &o.shape)).collect();
        let targets = targets(scene.objects.iter().zip(&casts).filter(|(_, casts)| **casts).map(|(o, _)| &o.shape));
        let seen = shaders.iter().any(|shader| matches!(shader.kind, Kind::Diffuse { .. }));
        let lamps = lamps(lights);
        let nearest = NEAREST * geometry.extent().powi(2);
        (seen && !targets.is_empty() && !lamps.is_empty()).then_some(Self { lamps, targets, casts, nearest })
    }

    /// Whether these paths bring the light of light number `light`.
    #[inline]
    pub fn starts_at(&self, light: usize) -> bool {
        self.lamps.iter().any(|lamp| lamp.light == light)
    }

    /// Whether these paths scatter at an object.
    #[inline]
    pub fn scatters_at(&self, object: u32) -> bool {
        self.casts[object as usize]
    }

    /// Whether these paths bring light to a diffuse surface that the camera sees, where the picture shows this much
    /// ([`Lens::area_at`](crate::render::lens::Lens::area_at)).
    #[inline]
    pub fn reaches(&self, area: f32) -> bool {
        area > self.nearest
    }

    /// The number of the path from a lamp that comes with a sample of a pixel, if one does. The first of a pixel comes with
    /// any of [`SAMPLES_PER_LIGHT_PATH`] samples, so that there are as many paths as there should be, however few samples.
    #[inline]
    pub fn path(seed: u64, pixel: u64, sample: u32) -> Option<u32> {
        let phase = mix64(seed ^ mix64(pixel)) as u32 % SAMPLES_PER_LIGHT_PATH;
        (sample % SAMPLES_PER_LIGHT_PATH == phase).then_some(sample / SAMPLES_PER_LIGHT_PATH)
    }

    /// A lamp at random.
    #[inline]
    pub fn lamp(&self, u: f32) -> &Lamp {
        let number = self.lamps.partition_point(|lamp| lamp.up_to <= u);
        &self.lamps[number.min(self.lamps.len() - 1)]
    }

    /// A direction from a point to one of the targets, evenly over the solid angle of each, and 1 over its density.
    #[inline]
    pub fn direction(&self, point: Vec3, choice: f32, u: [f32; 2]) -> (Vec3, f32) {
        let total: f32 = self.targets.iter().map(|target| target.cone(point).1).sum();
        let mut rest = choice * total;
        let (mut axis, mut one_minus_cos_half_angle) = (Vec3::Y, 2.0);
        for target in &self.targets {
            (axis, one_minus_cos_half_angle) = target.cone(point);
            if rest < one_minus_cos_half_angle {
                break;
            }
            rest -= one_minus_cos_half_angle;
        }
        let below = u[0] * one_minus_cos_half_angle;
        let (sin, cos) = ((below * (2.0 - below)).max(0.0).sqrt(), 1.0 - below);
        let (x, y) = axis.any_orthonormal_pair();
        let (sin_phi, cos_phi) = f32::sin_cos_turns(u[1]);
        let direction = (x * cos_phi + y * sin_phi) * sin + axis * cos;
        let holding = self.targets.iter().filter(|target| target.holds(point, direction)).count();
        // Rounding at the rim may leave out the one that it was sampled for.
        (direction, TAU * total / holding.max(1) as f32)
    }
}

impl Target {
    /// The cone around the ball: its axis, and 1 − cos of half its angle; 2, all directions, from inside.
    #[inline]
    fn cone(&self, point: Vec3) -> (Vec3, f32) {
        let to = self.centre - point;
        let d2 = to.length_squared();
        let sin2 = self.radius * self.radius / d2;
        if sin2 < 1.0 { (to / d2.sqrt(), solids::one_minus_cos_half_angle(sin2)) } else { (Vec3::Y, 2.0) }
    }

    #[inline]
    fn holds(&self, point: Vec3, direction: Vec3) -> bool {
        let (axis, one_minus_cos_half_angle) = self.cone(point);
        0.5 * (direction - axis).length_squared() <= one_minus_cos_half_angle
    }
}

/// Whether paths from the lamps scatter at a shader: at rough metal of any shape; in mirrors and glass only where the normal
/// for shading is that of the surface, which is the same from either end of a path. Materials that are not reciprocal must be
/// met by camera paths.
fn casts(shader: &SurfaceShader, shape: &Shape) -> bool {
    match shader.kind {
        Kind::Black | Kind::Diffuse { .. } => false,
        Kind::Rough(bsdf) => bsdf.is_reciprocal(),
        Kind::Delta(bsdf) => bsdf.is_reciprocal() && !matches!(shape, Shape::Mesh(_)),
    }
}

fn targets<'a>(shapes: impl Iterator<Item = &'a Shape>) -> Vec<Target> {
    let ball = |shape: &Shape| match shape {
        Shape::Sphere(s) => Target { centre: s.centre, radius: s.radius },
        Shape::Rectangle(r) => Target { centre: r.centre(), radius: (r.corners()[0] - r.centre()).length() },
        Shape::Mesh(mesh) => {
            let [low, high] = mesh.bounds().unwrap_or_default();
            let centre = 0.5 * (low + high);
            let radius2 = mesh.positions.iter().map(|p| p.distance_squared(centre)).fold(0.0, f32::max);
            Target { centre, radius: radius2.sqrt() }
        }
    };
    // A hair larger, so that rounding leaves nothing outside.
    let grown = |target: Target| Target { radius: target.radius * 1.000_01, ..target };
    let all: Vec<Target> = shapes.map(|shape| grown(ball(shape))).collect();
    if all.len() <= MOST_TARGETS {
        return all;
    }
    let centre = all.iter().map(|target| target.centre).sum::<Vec3>() / all.len() as f32;
    let radius = all.iter().map(|target| target.centre.distance(centre) + target.radius).fold(0.0, f32::max);
    vec![Target { centre, radius }]
}

/// The lamps, chosen in proportion to their power.
fn lamps(lights: &[Sampled]) -> Vec<Lamp> {
    let powers = || lights.iter().enumerate().filter_map(|(i, light)| light.emitted().map(|(r, area)| (i, r * area)));
    let total: f32 = powers().map(|(_, power)| power.element_sum()).sum();
    let mut up_to = 0.0;
    powers()
        .map(|(light, power)| {
            let probability = power.element_sum() / total;
            up_to += probability;
            Lamp { light, power: power / probability, up_to }
        })
        .collect()
}
