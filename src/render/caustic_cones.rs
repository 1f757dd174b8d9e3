//! Cones towards specular spheres and reflected lights, mixed with the cosine: directions of paths from diffuse hits.
//!
//! Mirrors, glass and metal show an area light as a small bright image, which cosine sampling seldom finds: most of the noise of such scenes.
//! So some of the directions are sampled in cones: one around each sphere, and one around the place where a sphere
//! reflects an area light to the point. A cone of solid angle Ωⱼ is chosen with weight wⱼ, the cosine with weight 1, and
//! the pdf of the mixture is
//!
//! (cos θ / π + Σ wⱼ/Ωⱼ over the cones that contain the direction) / (1 + Σ wⱼ).
//!
//! The estimate is unbiased for any cones; good cones reduce its variance. Points where light tracing adds the caustics
//! (see [`super::light_tracing`]) do without cones.

use super::diffuse;
use super::lanes::{LANES, Lane, Lane3, Paths, Points, ZERO3, at, caustic, set};
use super::solids;
use super::wide::{Wide, wide};
use crate::math::circular::Circular;
use crate::math::{Frame, Rgb};
use crate::scene::{EmitterVisibility, Light, Material, Rectangle, Scene, Shape, Sphere};
use glam::Vec3;
use pulp::Arch;
use std::f32::consts::{PI, TAU};

/// The weight of a sphere's cone per steradian. In the reports' scenes the variance has a flat minimum here.
const SPHERE_WEIGHT: f32 = 0.83;

/// The weight of the cone around a reflected light.
const REFLECTION_WEIGHT: f32 = 0.17;

/// Metal of a larger alpha blurs the reflected light too much for a cone.
const LARGEST_ALPHA: f32 = 0.15;

/// Scatterings after which cones around reflected lights cost more time than they save variance.
pub const REFLECTIONS_UP_TO: u32 = 2;

/// The most spheres with a cone: the largest ones.
const MOST_SPHERES: usize = 8;

/// With more pairs of sphere and area light, no reflected light has a cone.
const MOST_REFLECTIONS: usize = 16;

/// The spheres and the reflected lights of a scene.
#[derive(Debug, Clone, Default)]
pub struct CausticCones {
    spheres: Vec<Sphere>,
    reflections: Vec<ReflectedLight>,
}

/// An area light and a sphere that reflects it.
#[derive(Debug, Clone, Copy)]
struct ReflectedLight {
    sphere: Sphere,
    /// Centre of the light.
    light: Vec3,
    /// Normal of the light's front.
    normal: Vec3,
    /// Distance from the light's centre to its corners.
    light_radius: f32,
}

/// One cone per point: its axis, 1 − cos of its half angle, and its weight, 0 where it is not used.
#[derive(Clone)]
pub struct Cone {
    axis: Lane3,
    one_minus_cos_half_angle: Lane,
    weight: Lane,
}

impl CausticCones {
    /// Finds the spheres and reflected lights. Meshes have no cone: they fill too little of their bounding sphere.
    pub fn new(scene: &Scene) -> Self {
        // The largest spheres that are not diffuse.
        let specular = scene.objects.iter().filter_map(|object| match (&object.shape, object.material) {
            (_, Material::Diffuse { .. }) => None,
            (Shape::Sphere(s), material) => Some((*s, material)),
            _ => None,
        });
        let mut spheres: Vec<(Sphere, Material)> = specular.collect();
        spheres.sort_by(|(a, _), (b, _)| b.radius.total_cmp(&a.radius));
        spheres.truncate(MOST_SPHERES);
        let lights = area_lights(scene);
        let mut cones = Self { spheres: spheres.iter().map(|(sphere, _)| *sphere).collect(), ..Self::default() };
        if spheres.len() * lights.len() > MOST_REFLECTIONS {
            return cones;
        }
        for ((sphere, material), light) in spheres.iter().flat_map(|s| lights.iter().map(move |light| (s, light))) {
            let reflects = match *material {
                Material::Mirror { .. } => true,
                Material::Conductor(metal) => metal.alpha < LARGEST_ALPHA,
                // Glass reflects too little, and refracts light from all directions.
                Material::Glass { .. } | Material::Refraction { .. } | Material::Diffuse { .. } => false,
            };
            if reflects {
                cones.reflections.push(ReflectedLight {
                    sphere: *sphere,
                    light: light.centre(),
                    normal: light.normal(),
                    light_radius: (light.corners()[0] - light.centre()).length(),
                });
            }
        }
        cones
    }

    /// Whether the scene has no such sphere.
    pub fn is_empty(&self) -> bool {
        self.spheres.is_empty()
    }

    /// Buffers for the cones of one batch of points.
    pub fn cones(&self) -> Vec<Cone> {
        let count = self.spheres.len() + self.reflections.len();
        vec![Cone { axis: ZERO3, one_minus_cos_half_angle: [0.0; LANES], weight: [0.0; LANES] }; count]
    }

    /// Appends to `next` each point's path with a direction sampled from the mixture, with cones around reflected lights if
    /// `reflections`.
    pub fn extend_paths(
        &self,
        arch: Arch,
        cones: &mut [Cone],
        reflections: bool,
        points: &Points,
        u: &[Lane; 2],
        next: &mut Paths,
    ) {
        // Compute the cones of all points, one target after the other.
        let mut used = 0;
        for target in &self.spheres {
            wide(arch, FindCone { target, points, cone: &mut cones[used] });
            used += 1;
        }
        if reflections {
            for target in &self.reflections {
                wide(arch, FindCone { target, points, cone: &mut cones[used] });
                used += 1;
            }
        }
        let cones = &cones[..used];
        // Choose a part of the mixture by its weight.
        let mut choice = Choice { axis: points.normal, one_minus_cos_half_angle: [0.0; LANES], rest: [0.0; LANES] };
        let mut total = [1.0; LANES];
        for cone in cones {
            wide(arch, AddTo { sum: &mut total, cone, count: points.count });
        }
        for i in 0..points.count {
            choice.rest[i] = u[0][i] * total[i];
        }
        for cone in cones {
            wide(arch, Choose { cone, count: points.count, choice: &mut choice });
        }
        // Sample the direction, then evaluate the pdf of the whole mixture.
        let mut direction = ZERO3;
        wide(arch, SampleDirections { choice: &choice, v: &u[1], count: points.count, direction: &mut direction });
        let mut pdf = [0.0; LANES];
        for cone in cones {
            wide(arch, AddPdf { cone, direction: &direction, count: points.count, pdf: &mut pdf });
        }
        let mut weight = ZERO3;
        wide(arch, Weigh { points, direction: &direction, total: &total, pdf: &pdf, weight: &mut weight });
        for i in 0..points.count {
            let throughput = at(&weight, i);
            if throughput.max_element() > 0.0 {
                diffuse::follow(next, points, i, at(&direction, i), throughput);
            }
        }
    }
}

/// The rectangular area lights of a scene.
fn area_lights(scene: &Scene) -> Vec<Rectangle> {
    let visible = scene.objects.iter().filter_map(|object| match (&object.shape, &object.emission) {
        (Shape::Rectangle(r), Some(emission)) if emission.visibility == EmitterVisibility::Sampled => Some(*r),
        _ => None,
    });
    let invisible = scene.lights.iter().filter_map(|light| match light {
        Light::Rectangle { rectangle, .. } => Some(*rectangle),
        _ => None,
    });
    visible.chain(invisible).collect()
}

/// What a cone is around.
trait Target {
    /// The axis of a cone around it, 1 − cos of the half angle, and the weight.
    fn cone(&self, point: Vec3) -> (Vec3, f32, f32);
}

impl Target for Sphere {
    #[inline(always)]
    fn cone(&self, point: Vec3) -> (Vec3, f32, f32) {
        let to = self.centre - point;
        let d2 = to.length_squared();
        let sin2 = self.radius * self.radius / d2;
        let one_minus_cos = solids::one_minus_cos_half_angle(sin2);
        (to * (1.0 / d2.sqrt()), one_minus_cos, if sin2 < 1.0 { SPHERE_WEIGHT * TAU * one_minus_cos } else { 0.0 })
    }
}

impl ReflectedLight {
    /// One step of a fixed-point iteration for the normal at the point of reflection: the bisector of the directions to
    /// `point` and to the light where the sphere's normal is `normal`.
    #[inline(always)]
    fn refined_normal(&self, point: Vec3, normal: Vec3) -> Vec3 {
        let place = self.sphere.centre + self.sphere.radius * normal;
        unit(unit(point - place) + unit(self.light - place))
    }
}

#[inline(always)]
fn unit(v: Vec3) -> Vec3 {
    v * (1.0 / v.length())
}

/// 1 − cos of the angle whose tangent is `tan`.
#[inline(always)]
fn one_minus_cos(tan: f32) -> f32 {
    let root = (1.0 + tan * tan).sqrt();
    tan * tan / (root * (1.0 + root))
}

impl Target for ReflectedLight {
    /// The normal at the point of reflection bisects the directions to `point` and to the light. Starting from the solution
    /// for far points, two iterations are accurate enough. The size of the image follows from the mirror equation for
    /// sagittal rays: a ray displaced by h at the sphere meets the light's plane displaced by h (1 + l/d + 2 l cos/r), where d and l are
    /// the distances from the point of reflection to `point` and to the light, r is the radius and cos that of incidence.
    #[inline(always)]
    fn cone(&self, point: Vec3) -> (Vec3, f32, f32) {
        let Self { sphere: Sphere { centre, radius }, light, normal: front, light_radius } = *self;
        // Find the point of reflection.
        let start = unit(unit(point - centre) + unit(light - centre));
        let normal = self.refined_normal(point, self.refined_normal(point, start));
        let place = centre + radius * normal;
        let (to_point, to_light) = (point - place, light - place);
        // Compute the angular size of the reflected light.
        let (d, l) = (to_point.length(), to_light.length());
        let cos = normal.dot(to_point) / d;
        let tan = light_radius / (d + l + 2.0 * l * d * cos / radius);
        let outside = (point - centre).length_squared() > radius * radius;
        let is_reflected = (cos > 0.0) & (front.dot(to_light) < 0.0) & outside;
        (to_point * (-1.0 / d), one_minus_cos(tan), if is_reflected { REFLECTION_WEIGHT } else { 0.0 })
    }
}

struct FindCone<'a, T> {
    target: &'a T,
    points: &'a Points,
    cone: &'a mut Cone,
}

impl<T: Target> Wide for FindCone<'_, T> {
    #[inline(always)]
    fn run(self) {
        let position = self.points.position;
        let (mut axis, mut one_minus_cos_half_angle, mut weight) = (ZERO3, [0.0; LANES], [0.0; LANES]);
        for i in 0..self.points.count.min(LANES) {
            let (a, o, w) = self.target.cone(at(&position, i));
            set(&mut axis, i, a);
            (one_minus_cos_half_angle[i], weight[i]) =
                (o, if self.points.caustic[i] == caustic::NONE { w } else { 0.0 });
        }
        *self.cone = Cone { axis, one_minus_cos_half_angle, weight };
    }
}

struct AddTo<'a> {
    sum: &'a mut Lane,
    cone: &'a Cone,
    count: usize,
}

impl Wide for AddTo<'_> {
    #[inline(always)]
    fn run(self) {
        for i in 0..self.count.min(LANES) {
            self.sum[i] += self.cone.weight[i];
        }
    }
}

/// The part of the mixture that each point samples: the cosine about the normal, or a cone.
struct Choice {
    axis: Lane3,
    /// 1 − cos of the angle to the cone's axis, from the random number that chose the cone.
    one_minus_cos_half_angle: Lane,
    /// The random number minus the weights of the cones passed over; negative once a cone is chosen.
    rest: Lane,
}

struct Choose<'a> {
    cone: &'a Cone,
    count: usize,
    choice: &'a mut Choice,
}

impl Wide for Choose<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { cone, count, choice } = self;
        for i in 0..count.min(LANES) {
            let (weight, rest) = (cone.weight[i], choice.rest[i]);
            let here = (rest >= 0.0) & (rest < weight);
            let (new, old) = (at(&cone.axis, i), at(&choice.axis, i));
            set(&mut choice.axis, i, if here { new } else { old });
            choice.one_minus_cos_half_angle[i] = if here {
                rest / weight * cone.one_minus_cos_half_angle[i]
            } else {
                choice.one_minus_cos_half_angle[i]
            };
            let left = if rest >= 0.0 { rest - weight } else { rest };
            choice.rest[i] = if here { -1.0 } else { left };
        }
    }
}

struct SampleDirections<'a> {
    choice: &'a Choice,
    v: &'a Lane,
    count: usize,
    direction: &'a mut Lane3,
}

impl Wide for SampleDirections<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { choice, v, count, direction } = self;
        for i in 0..count.min(LANES) {
            let rest = choice.rest[i];
            // 1 − cos, uniform in the cone, or sin² = u for the cosine.
            let below = choice.one_minus_cos_half_angle[i];
            let u = rest.clamp(0.0, 1.0 - f32::EPSILON / 2.0);
            let in_cone = rest < 0.0;
            let sin = if in_cone { below * (2.0 - below) } else { u }.sqrt();
            let cos = if in_cone { 1.0 - below } else { (1.0 - u).sqrt() };
            let (sin_phi, cos_phi) = f32::sin_cos_turns(v[i]);
            let axis = at(&choice.axis, i);
            let Frame { x: tangent, y: bitangent, .. } = Frame::from_normal(axis);
            set(direction, i, (tangent * cos_phi + bitangent * sin_phi) * sin + axis * cos);
        }
    }
}

struct AddPdf<'a> {
    cone: &'a Cone,
    direction: &'a Lane3,
    count: usize,
    pdf: &'a mut Lane,
}

impl Wide for AddPdf<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { cone, direction, count, pdf } = self;
        for i in 0..count.min(LANES) {
            // |w − a|² / 2 = 1 − cos, which keeps its digits for narrow cones.
            let one_minus_cos = 0.5 * (at(direction, i) - at(&cone.axis, i)).length_squared();
            let inside = (one_minus_cos <= cone.one_minus_cos_half_angle[i]) & (cone.weight[i] > 0.0);
            pdf[i] += if inside { cone.weight[i] / (TAU * cone.one_minus_cos_half_angle[i]) } else { 0.0 };
        }
    }
}

struct Weigh<'a> {
    points: &'a Points,
    direction: &'a Lane3,
    total: &'a Lane,
    pdf: &'a Lane,
    weight: &'a mut Lane3,
}

impl Wide for Weigh<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { points, direction, total, pdf, weight } = self;
        for i in 0..points.count.min(LANES) {
            let cos = at(&points.normal, i).dot(at(direction, i)).max(0.0);
            let scale: Rgb = Rgb::splat(cos * total[i] / (cos + PI * pdf[i]).max(f32::MIN_POSITIVE));
            set(weight, i, at(&points.weight, i) * scale);
        }
    }
}
