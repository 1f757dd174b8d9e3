//! Where paths go on from a diffuse hit when there are mirrors, glass or metal in the scene.
//!
//! Through these a lamp shines as a small bright image, which directions sampled by the cosine alone seldom find: most of
//! the noise of such scenes. So a share of the directions is sampled from cones: one around each ball, and one around the
//! place where a ball reflects a lamp to the point. A cone of solid angle Ωⱼ is sampled from in proportion to a weight wⱼ,
//! the cosine to 1, and the density of the mixture at a direction is
//!
//! (cos θ / π + Σ wⱼ/Ωⱼ over the cones that hold it) / (1 + Σ wⱼ).
//!
//! Whatever the cones, the estimate is right; where they are good, it is quiet. Points to which paths from the lamps bring
//! these images (see [`super::light_tracing`]) have no use for cones.

use super::diffuse;
use super::lanes::{LANES, Lane, Lane3, Paths, Points, ZERO3, at, caustic, set};
use super::solids;
use super::wide::{Wide, wide};
use crate::math::circular::Circular;
use crate::math::{Frame, Rgb};
use crate::scene::{EmitterVisibility, Light, Material, Rectangle, Scene, Shape};
use glam::Vec3;
use pulp::Arch;
use std::f32::consts::{PI, TAU};

/// The weight of a ball per steradian that it fills, where the cosine has 1: a large one is more likely to matter. In the
/// reports' scenes the noise has a flat minimum here.
const BALL_WEIGHT: f32 = 0.83;

/// The weight of the image of a lamp in a mirror.
const IMAGE_WEIGHT: f32 = 0.17;

/// Metal of a larger alpha shows no image worth aiming at.
const BLURRED: f32 = 0.15;

/// Images are aimed at from the first diffuse hits of a path, of which there are the most; later ones have less light
/// to lose than time.
pub const IMAGES_UP_TO: u32 = 2;

/// Of more spheres than these only the largest get a cone.
const MOST_BALLS: usize = 8;

/// With more pairs of ball and lamp than these none gets a cone.
const MOST_IMAGES: usize = 16;

/// The spheres and images of a scene.
#[derive(Debug, Clone, Default)]
pub struct CausticCones {
    spheres: Vec<Ball>,
    images: Vec<Image>,
}

#[derive(Debug, Clone, Copy)]
struct Ball {
    centre: Vec3,
    radius: f32,
}

/// A lamp as a ball reflects it.
#[derive(Debug, Clone, Copy)]
struct Image {
    ball: Ball,
    lamp: Vec3,
    /// Of the lamp's front.
    normal: Vec3,
    lamp_radius: f32,
}

/// For each point a cone: its axis, 1 − cos of its half angle, and its weight; 0 where it is no help.
#[derive(Clone)]
pub struct Cone {
    axis: Lane3,
    one_minus_cos_half_angle: Lane,
    weight: Lane,
}

impl CausticCones {
    /// Looks at a scene once. Meshes get no ball: they fill too little of it, and the directions that miss cost more time
    /// than the others save noise.
    pub fn new(scene: &Scene) -> Self {
        let shiny = scene.objects.iter().filter_map(|object| match (&object.shape, object.material) {
            (_, Material::Diffuse { .. }) => None,
            (Shape::Sphere(s), material) => Some((Ball { centre: s.centre, radius: s.radius }, material)),
            _ => None,
        });
        let mut spheres: Vec<(Ball, Material)> = shiny.collect();
        spheres.sort_by(|(a, _), (b, _)| b.radius.total_cmp(&a.radius));
        spheres.truncate(MOST_BALLS);
        let lamps = lamps(scene);
        let mut caustic_cones = Self { spheres: spheres.iter().map(|(ball, _)| *ball).collect(), ..Self::default() };
        if spheres.len() * lamps.len() > MOST_IMAGES {
            return caustic_cones;
        }
        for ((ball, material), lamp) in spheres.iter().flat_map(|ball| lamps.iter().map(move |lamp| (ball, lamp))) {
            let reflects = match *material {
                Material::Mirror { .. } => true,
                Material::Conductor(metal) => metal.alpha < BLURRED,
                // A few hundredths of the light are not worth the time; through the ball it shines from all over it.
                Material::Glass { .. } | Material::Refraction { .. } | Material::Diffuse { .. } => false,
            };
            if reflects {
                caustic_cones.images.push(Image {
                    ball: *ball,
                    lamp: lamp.centre(),
                    normal: lamp.normal(),
                    lamp_radius: (lamp.corners()[0] - lamp.centre()).length(),
                });
            }
        }
        caustic_cones
    }

    pub fn is_empty(&self) -> bool {
        self.spheres.is_empty()
    }

    /// Room for the cones.
    pub fn cones(&self) -> Vec<Cone> {
        let count = self.spheres.len() + self.images.len();
        vec![Cone { axis: ZERO3, one_minus_cos_half_angle: [0.0; LANES], weight: [0.0; LANES] }; count]
    }

    /// Appends to `next` each point's path, carried on in a direction sampled by the mixture; `images` says whether with
    /// images.
    pub fn extend_paths(
        &self,
        arch: Arch,
        cones: &mut [Cone],
        images: bool,
        points: &Points,
        u: &[Lane; 2],
        next: &mut Paths,
    ) {
        let mut used = 0;
        for target in &self.spheres {
            wide(arch, Aim { target, points, cone: &mut cones[used] });
            used += 1;
        }
        if images {
            for target in &self.images {
                wide(arch, Aim { target, points, cone: &mut cones[used] });
                used += 1;
            }
        }
        let cones = &cones[..used];
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
        let mut direction = ZERO3;
        wide(arch, Direct { choice: &choice, v: &u[1], count: points.count, direction: &mut direction });
        let mut density = [0.0; LANES];
        for cone in cones {
            wide(arch, AddDensity { cone, direction: &direction, count: points.count, density: &mut density });
        }
        let mut weight = ZERO3;
        wide(arch, Weigh { points, direction: &direction, total: &total, density: &density, weight: &mut weight });
        for i in 0..points.count {
            let throughput = at(&weight, i);
            if throughput.max_element() > 0.0 {
                diffuse::follow(next, points, i, at(&direction, i), throughput);
            }
        }
    }
}

/// The glowing rectangles of a scene.
fn lamps(scene: &Scene) -> Vec<Rectangle> {
    let glowing = scene.objects.iter().filter_map(|object| match (&object.shape, &object.emission) {
        (Shape::Rectangle(r), Some(emission)) if emission.visibility == EmitterVisibility::Sampled => Some(*r),
        _ => None,
    });
    let unseen = scene.lights.iter().filter_map(|light| match light {
        Light::Rectangle { rectangle, .. } => Some(*rectangle),
        _ => None,
    });
    glowing.chain(unseen).collect()
}

/// Something to aim at.
trait Target {
    /// The axis of a cone around it, 1 − cos of the half angle, and the weight.
    fn cone(&self, point: Vec3) -> (Vec3, f32, f32);
}

impl Target for Ball {
    #[inline(always)]
    fn cone(&self, point: Vec3) -> (Vec3, f32, f32) {
        let to = self.centre - point;
        let d2 = to.length_squared();
        let sin2 = self.radius * self.radius / d2;
        let one_minus_cos_half_angle = solids::one_minus_cos_half_angle(sin2);
        (to * (1.0 / d2.sqrt()), one_minus_cos_half_angle, if sin2 < 1.0 { BALL_WEIGHT * TAU * one_minus_cos_half_angle } else { 0.0 })
    }
}

impl Image {
    /// The normal that halves the angle at the place of `normal`: a better estimate.
    #[inline(always)]
    fn closer(&self, point: Vec3, normal: Vec3) -> Vec3 {
        let place = self.ball.centre + self.ball.radius * normal;
        unit(unit(point - place) + unit(self.lamp - place))
    }
}

#[inline(always)]
fn unit(v: Vec3) -> Vec3 {
    v * (1.0 / v.length())
}

/// 1 − cos of the angle of that tangent.
#[inline(always)]
fn one_minus_cos_half_angle(tan: f32) -> f32 {
    let root = (1.0 + tan * tan).sqrt();
    tan * tan / (root * (1.0 + root))
}

impl Target for Image {
    /// The normal at the point of reflection halves the angle between the ways to `point` and to the lamp. Starting from
    /// the far-away solution it is found by repetition, exactly enough after two rounds. How large the image is follows
    /// from the mirror equation for rays beside the plane of reflection: a ray that is off by h there meets the plane of the
    /// lamp off by h (1 + l/d + 2 l cos/r).
    #[inline(always)]
    fn cone(&self, point: Vec3) -> (Vec3, f32, f32) {
        let Image { ball: Ball { centre, radius }, lamp, normal: front, lamp_radius } = *self;
        let start = unit(unit(point - centre) + unit(lamp - centre));
        let normal = self.closer(point, self.closer(point, start));
        let place = centre + radius * normal;
        let (to_point, to_lamp) = (point - place, lamp - place);
        let (d, l) = (to_point.length(), to_lamp.length());
        let cos = normal.dot(to_point) / d;
        let tan = lamp_radius / (d + l + 2.0 * l * d * cos / radius);
        let outside = (point - centre).length_squared() > radius * radius;
        let lit = (cos > 0.0) & (front.dot(to_lamp) < 0.0) & outside;
        (to_point * (-1.0 / d), one_minus_cos_half_angle(tan), if lit { IMAGE_WEIGHT } else { 0.0 })
    }
}

struct Aim<'a, T> {
    target: &'a T,
    points: &'a Points,
    cone: &'a mut Cone,
}

impl<T: Target> Wide for Aim<'_, T> {
    #[inline(always)]
    fn run(self) {
        let position = self.points.position;
        let (mut axis, mut one_minus_cos_half_angle, mut weight) = (ZERO3, [0.0; LANES], [0.0; LANES]);
        for i in 0..self.points.count.min(LANES) {
            let (a, o, w) = self.target.cone(at(&position, i));
            set(&mut axis, i, a);
            (one_minus_cos_half_angle[i], weight[i]) = (o, if self.points.caustic[i] == caustic::NONE { w } else { 0.0 });
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

/// Which part of the mixture each point draws from: the cosine about the normal, or a cone.
struct Choice {
    axis: Lane3,
    /// 1 − cos to the cone's axis, sampled by where in its share the number fell.
    one_minus_cos_half_angle: Lane,
    /// The number, stretched to the shares still to be dealt out; negative once a cone is chosen.
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
            choice.one_minus_cos_half_angle[i] = if here { rest / weight * cone.one_minus_cos_half_angle[i] } else { choice.one_minus_cos_half_angle[i] };
            let left = if rest >= 0.0 { rest - weight } else { rest };
            choice.rest[i] = if here { -1.0 } else { left };
        }
    }
}

struct Direct<'a> {
    choice: &'a Choice,
    v: &'a Lane,
    count: usize,
    direction: &'a mut Lane3,
}

impl Wide for Direct<'_> {
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

struct AddDensity<'a> {
    cone: &'a Cone,
    direction: &'a Lane3,
    count: usize,
    density: &'a mut Lane,
}

impl Wide for AddDensity<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { cone, direction, count, density } = self;
        for i in 0..count.min(LANES) {
            // |w − a|² / 2 = 1 − cos, which keeps its digits for narrow cones.
            let off = 0.5 * (at(direction, i) - at(&cone.axis, i)).length_squared();
            let inside = (off <= cone.one_minus_cos_half_angle[i]) & (cone.weight[i] > 0.0);
            density[i] += if inside { cone.weight[i] / (TAU * cone.one_minus_cos_half_angle[i]) } else { 0.0 };
        }
    }
}

struct Weigh<'a> {
    points: &'a Points,
    direction: &'a Lane3,
    total: &'a Lane,
    density: &'a Lane,
    weight: &'a mut Lane3,
}

impl Wide for Weigh<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { points, direction, total, density, weight } = self;
        for i in 0..points.count.min(LANES) {
            let cos = at(&points.normal, i).dot(at(direction, i)).max(0.0);
            let scale: Rgb = Rgb::splat(cos * total[i] / (cos + PI * density[i]).max(f32::MIN_POSITIVE));
            set(weight, i, at(&points.weight, i) * scale);
        }
    }
}
