//! Light tracing: where light paths start, and with what density.
//!
//! Light tracing is a third technique beside BSDF sampling (s = 0 vertices on the path that starts at the light, in the
//! notation of Veach) and light sampling (s = 1): all vertices but the camera's are sampled from the light (t = 1), and the
//! last is connected to the camera. Its paths start at area lights and the environment, in directions towards *targets*:
//! bounding spheres of the objects that are not diffuse. These paths find caustics, for which a camera path rarely samples the right
//! direction.
//!
//! MIS needs the density of each technique for a path that any of them has found. For a path x₀ … xₖ from the camera to the
//! light, the density of light tracing over that of BSDF sampling is
//!
//! q = (n_l / n_c) Π p←(xᵢ) / p→(xᵢ), i from 1 to k,
//!
//! with p per area, for n_l light paths beside n_c camera paths. The distances cancel. What remains of a vertex is p⊥←(wo) /
//! p⊥→(wi), pdfs per projected solid angle ([`projected`]); at a delta lobe [`delta_ratio`]. At x₁, which light tracing connects to the
//! camera without sampling, p←(wo) is 1; the camera contributes the area that the image covers there
//! ([`LightTracing::q_at_camera`]), and the light its [`density`](LightTracing::density). Camera paths carry q; light paths carry the
//! densities of the other techniques over their own, from the same factors.
//!
//! The weights depend on the path alone, not on the pixel or its filter. For each path those of all techniques sum to 1, and each technique has
//! the expectation ∫ f w L over the film positions that the filter f of a pixel reaches, also outside of the image: together ∫ f L.
//!
//! The density of light tracing is 0 for a path that is not a caustic in this sense: its vertex next to the light is diffuse or is
//! the only one, the one next to the camera is a delta lobe, a BSDF on it is not reciprocal, or a shading normal on it is not
//! [sound](super::shaders::is_sound).
//!
//! Source: Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, section 10.3; Georgiev,
//! "Implementing Vertex Connection and Merging", 2012 (recursive quantities).

use super::environment::EnvironmentSampling;
use super::geometry::Geometry;
use super::light_selection::Lights;
use super::shaders::{Kind, SurfaceShader, is_sound};
use super::solids;
use etalon_core::bsdf::{Bsdf, BsdfSample, Scatter};
use etalon_core::math::Rgb;
use etalon_core::math::circular::Circular;
use etalon_core::sampling::hash::mix64;
use etalon_core::sampling::table::Table1;
use etalon_core::scene::Ray;
use etalon_core::scene::{Request, Scene, Shape, Sphere};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// No normal: light paths come from all directions of the environment.
const ANY: Vec3 = Vec3::ZERO;

/// Camera samples of a pixel for each light path.
pub const SAMPLES_PER_LIGHT_PATH: u32 = 8;

/// More targets than these are merged into one.
const MOST_TARGETS: usize = 8;

pub struct LightTracing {
    /// Chooses a light by its power; the environment comes last.
    table: Table1,
    /// Number of the lights, which the environment follows.
    lights: usize,
    /// Bounding spheres of the objects that are not diffuse.
    targets: Vec<Sphere>,
    /// Sum of the areas of their discs.
    discs: f32,
    /// A distance beyond which no object is, from any point of one.
    extent: f32,
}

/// A pdf per projected solid angle: `pdf`, per solid angle, over the cosine to the surface's normal. 0 where the shading normal
/// is not sound.
#[inline]
pub fn projected(normals: [Vec3; 2], w: Vec3, pdf: f32) -> f32 {
    if is_sound(normals, w) { pdf / normals[0].dot(w).abs() } else { 0.0 }
}

/// The density of the technique that arrives from the other side over that of this one, at a sample of a delta lobe: the probabilities
/// of the lobe from both sides, over η², as refraction conserves η² cos θ dω.
#[inline]
pub fn delta_ratio(bsdf: &Bsdf, sample: &BsdfSample) -> f32 {
    bsdf.lobe_probability(sample.wi, sample.lobe) / (sample.probability * sample.eta * sample.eta)
}

pub struct Start {
    /// On the light, or outside of the scene.
    pub origin: Vec3,
    /// Unit normal there; against the direction for the environment.
    pub normal: Vec3,
    /// Away from the light.
    pub direction: Vec3,
    /// Radiance over [`density`](Self::density).
    pub power: Rgb,
    /// `LightTracing::density` or `LightTracing::density_of_environment`.
    pub density: f32,
    /// The light; `None` for the environment.
    pub light: Option<u32>,
}

impl Start {
    /// The ray, which starts off the light.
    pub fn ray(&self, lights: &Lights) -> Ray {
        let offset = self.light.map_or(0.0, |light| lights.all[light as usize].offset(self.origin));
        let offset = offset.copysign(self.normal.dot(self.direction));
        Ray { origin: self.origin + self.normal * offset, direction: self.direction }
    }
}

impl LightTracing {
    /// Prepares light tracing; `None` where the scene has no caustics. Light paths start from the environment if it is sampled.
    pub fn new(
        scene: &Scene,
        request: &Request,
        shaders: &[SurfaceShader],
        lights: &Lights,
        environment: Option<&EnvironmentSampling>,
        geometry: &Geometry<'_>,
    ) -> Option<Self> {
        let connects = |shader: &SurfaceShader| !matches!(shader.kind, Kind::Black | Kind::Delta);
        let starts_at =
            |shader: &SurfaceShader| !matches!(shader.kind, Kind::Black | Kind::Diffuse) && shader.bsdf.is_reciprocal();
        let objects = scene.objects.iter().zip(shaders);
        let targets = targets(objects.filter(|(_, shader)| starts_at(shader)).map(|(object, _)| &object.shape));
        if request.max_depth < 2 || targets.is_empty() || !shaders.iter().any(connects) {
            return None;
        }
        let discs = targets.iter().map(|target| PI * target.radius * target.radius).sum();
        let of_environment = match (environment, &scene.environment) {
            (Some(_), Some(environment)) => {
                4.0 * PI * environment.map.mean() as f32 * environment.scale.element_sum() * discs
            }
            _ => 0.0,
        };
        let powers = lights
            .all
            .iter()
            .map(|light| light.emitted().map_or(0.0, |(radiance, area)| PI * area * radiance.element_sum()));
        let table = Table1::new(&powers.chain([of_environment]).map(f64::from).collect::<Vec<_>>());
        let (lights, extent) = (lights.all.len(), geometry.extent());
        (table.total() > 0.0).then_some(Self { table, lights, targets, discs, extent })
    }

    /// The number of the light path that is traced with a sample of a pixel, if one is. The first comes with a random one of
    /// the first [`SAMPLES_PER_LIGHT_PATH`] samples, so that the expected number of paths is right for few samples, too.
    #[inline]
    pub fn path(seed: u64, pixel: u64, sample: u32) -> Option<u32> {
        let phase = mix64(seed ^ mix64(pixel)) as u32 % SAMPLES_PER_LIGHT_PATH;
        (sample % SAMPLES_PER_LIGHT_PATH == phase).then_some(sample / SAMPLES_PER_LIGHT_PATH)
    }

    /// q of a path that has left the camera, for a first hit where the whole image covers `area`.
    #[inline]
    pub fn q_at_camera(area: f32) -> f32 {
        area / SAMPLES_PER_LIGHT_PATH as f32
    }

    /// Starts a light path: `u` chooses the light and the target, the place on the light (or on the target's disc), and the direction.
    #[inline]
    pub fn start(
        &self,
        lights: &Lights,
        environment: Option<&EnvironmentSampling>,
        [choice, place, within]: [[f64; 2]; 3],
    ) -> Option<Start> {
        let number = self.table.sample(choice[0])?.cell;
        let short = |u: [f64; 2]| u.map(|u| u as f32);
        if number == self.lights {
            let sample = environment?.sample(within, ANY, Kind::Reflecting)?;
            let wi = sample.wi.as_vec3();
            let target = self.target_by_disc(choice[1] as f32);
            let (x, y) = wi.any_orthonormal_pair();
            let (sin_phi, cos_phi) = f32::sin_cos_turns(short(place)[1]);
            let r = target.radius * short(place)[0].sqrt();
            let origin = target.centre + (x * cos_phi + y * sin_phi) * r + wi * (self.extent + target.radius);
            let density = self.density_of_environment(environment, origin, wi);
            let power = sample.radiance / density;
            let (normal, direction) = (wi, -wi);
            return (density > 0.0).then_some(Start { origin, normal, direction, power, density, light: None });
        }
        let point = lights.all[number].point(short(place))?;
        let direction = self.direction(point.position, choice[1] as f32, short(within))?;
        let cos = point.normal.dot(direction);
        let emitted_cos = if point.two_sided { cos.abs() } else { cos };
        if emitted_cos <= 0.0 {
            return None;
        }
        let density = self.density(lights, number as u32, point.position, direction, emitted_cos);
        let (radiance, _) = lights.all[number].emitted()?;
        let power = radiance / density;
        let (origin, normal, light) = (point.position, point.normal, Some(number as u32));
        (density > 0.0).then_some(Start { origin, normal, direction, power, density, light })
    }

    /// What the light contributes to q: the density with which light paths start at a point of a light (per area) in a direction (per
    /// solid angle), over the cosine there.
    #[inline]
    pub fn density(&self, lights: &Lights, light: u32, point: Vec3, direction: Vec3, cos: f32) -> f32 {
        let Some((_, area)) = lights.all[light as usize].emitted() else { return 0.0 };
        let (total, containing) = self.targets.iter().fold((0.0, 0), |(total, containing), target| {
            let (axis, one_minus_cos) = cone(target, point);
            let is_inside = 0.5 * (direction - axis).length_squared() <= one_minus_cos;
            (total + one_minus_cos, containing + u32::from(is_inside))
        });
        let pdf = containing as f32 / (TAU * total);
        self.table.probability(light as usize) as f32 / area * pdf / cos
    }

    /// The same of the environment: the density of light paths that arrive at a point from direction `wi`, per solid angle
    /// and per area perpendicular to it.
    #[inline]
    pub fn density_of_environment(&self, environment: Option<&EnvironmentSampling>, point: Vec3, wi: Vec3) -> f32 {
        let Some(environment) = environment else { return 0.0 };
        let is_inside = |target: &&Sphere| {
            let to = target.centre - point;
            (to - wi * wi.dot(to)).length_squared() <= target.radius * target.radius
        };
        let containing = self.targets.iter().filter(is_inside).count();
        if containing == 0 {
            return 0.0;
        }
        let pdf = environment.pdf(wi, ANY, Kind::Reflecting) as f32 * containing as f32 / self.discs;
        self.table.probability(self.lights) as f32 * pdf
    }

    /// Chooses a target in proportion to its disc.
    fn target_by_disc(&self, u: f32) -> &Sphere {
        let mut rest = u * self.discs;
        let is_chosen = |target: &&Sphere| {
            rest -= PI * target.radius * target.radius;
            rest < 0.0
        };
        self.targets.iter().find(is_chosen).unwrap_or(&self.targets[self.targets.len() - 1])
    }

    /// Samples a direction from a point to the targets, uniformly over the solid angle of each.
    #[inline]
    fn direction(&self, point: Vec3, choice: f32, u: [f32; 2]) -> Option<Vec3> {
        // Choose a target in proportion to its solid angle.
        let total: f32 = self.targets.iter().map(|target| cone(target, point).1).sum();
        let mut rest = choice * total;
        let mut chosen = None;
        for target in &self.targets {
            let found = cone(target, point);
            rest -= found.1;
            chosen = Some(found);
            if rest < 0.0 {
                break;
            }
        }
        // Sample the cone around it uniformly.
        let (axis, one_minus_cos) = chosen?;
        let below = u[0] * one_minus_cos;
        let (sin, cos) = ((below * (2.0 - below)).max(0.0).sqrt(), 1.0 - below);
        let (x, y) = axis.any_orthonormal_pair();
        let (sin_phi, cos_phi) = f32::sin_cos_turns(u[1]);
        Some((x * cos_phi + y * sin_phi) * sin + axis * cos)
    }
}

/// The cone around a sphere: its axis, and 1 − cos of its half angle; 2, all directions, from inside.
#[inline]
fn cone(sphere: &Sphere, point: Vec3) -> (Vec3, f32) {
    let (to, one_minus_cos) = (sphere.centre - point, solids::one_minus_cos_of_cone(sphere, point));
    (if one_minus_cos < 2.0 { to / to.length() } else { Vec3::Y }, one_minus_cos)
}

/// Bounding spheres of shapes.
fn targets<'a>(shapes: impl Iterator<Item = &'a Shape>) -> Vec<Sphere> {
    // Enlarge the spheres, so that rounding leaves nothing outside.
    let grown = |target: Sphere| Sphere { radius: target.radius * 1.000_01, ..target };
    let all: Vec<Sphere> = shapes.map(|shape| grown(shape.bounding_sphere())).collect();
    if all.len() <= MOST_TARGETS {
        return all;
    }
    let centre = all.iter().map(|target| target.centre).sum::<Vec3>() / all.len() as f32;
    let radius = all.iter().map(|target| target.centre.distance(centre) + target.radius).fold(0.0, f32::max);
    vec![Sphere { centre, radius }]
}
