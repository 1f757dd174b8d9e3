//! Where paths go on from a diffuse hit when there are mirrors, glass or metal in the scene.
//!
//! Through these a lamp shines as a small bright image, which directions drawn by the cosine alone seldom find: most of
//! the noise of such scenes. So a share of the directions is drawn towards the balls around them. With the cosine given
//! the weight Ω₀ and each ball its own solid angle Ωⱼ, the density of the mixture is simply
//!
//! (Ω₀ cos θ / π + number of balls in that direction) / (Ω₀ + Σ Ωⱼ).

use super::diffuse::frame;
use super::geometry::{at, set};
use super::lanes::{LANES, Lane, Paths, Points, ZERO3};
use super::wide::{Wide, wide};
use crate::sampling::elementary::Elementary;
use crate::scene::{Material, Scene, Shape};
use glam::Vec3;
use pulp::Arch;
use std::f32::consts::{PI, TAU};

/// The weight of the cosine, in steradians. The variance has a flat minimum here: half and twice as much cost less than
/// a tenth in the reports' scenes.
const COSINE_WEIGHT: f32 = 0.5;

/// A ball around an object that may cast a caustic.
#[derive(Debug, Clone, Copy)]
pub struct Caster {
    centre: Vec3,
    radius2: f32,
}

impl Caster {
    /// The balls that are not diffuse. Not those around meshes, which fill too little of them: the directions that
    /// miss cost more time than the others save noise.
    pub fn all(scene: &Scene) -> Vec<Self> {
        let casters = scene.objects.iter().filter_map(|object| match (&object.shape, &object.material) {
            (_, Material::Diffuse { .. }) => None,
            (Shape::Sphere(s), _) => Some(Self { centre: s.centre, radius2: s.radius * s.radius }),
            _ => None,
        });
        casters.collect()
    }

    /// Unit vector to the centre, and 1 − cos of half the angle that the ball fills; 0 from inside, where it is no help.
    #[inline(always)]
    fn seen_from(&self, point: Vec3) -> (Vec3, f32) {
        let to = self.centre - point;
        let d2 = to.length_squared();
        let sin2 = self.radius2 / d2;
        // 1 − √(1 − s²) without the cancellation.
        let opening = sin2 / (1.0 + (1.0 - sin2).max(0.0).sqrt());
        (to * (1.0 / d2.sqrt()), if sin2 < 1.0 { opening } else { 0.0 })
    }
}

/// Appends to `next` each point's path, carried on in a direction drawn by the mixture.
pub fn carry_on(arch: Arch, casters: &[Caster], points: &Points, u: &[Lane; 2], next: &mut Paths) {
    let count = points.count;
    // What is left of the first number once the share of each ball is taken off, in steradians.
    let mut total = [COSINE_WEIGHT; LANES];
    for caster in casters {
        wide(arch, AddSolidAngle { caster, points, total: &mut total });
    }
    let mut choice = Choice { axis: points.normal, opening: [0.0; LANES], rest: [0.0; LANES] };
    for i in 0..count {
        choice.rest[i] = u[0][i] * total[i];
    }
    for caster in casters {
        wide(arch, Choose { caster, points, choice: &mut choice });
    }
    let start = next.count;
    super::diffuse::carry_on(arch, points, u, next);
    wide(arch, Direct { choice: &choice, points, v: &u[1], start, next });
    let mut balls = [0.0; LANES];
    for caster in casters {
        wide(arch, CountBall { caster, points, start, next, balls: &mut balls });
    }
    wide(arch, Weigh { points, total: &total, balls: &balls, start, next });
    next.retain(start, |next, i| next.throughput[0][i] + next.throughput[1][i] + next.throughput[2][i] > 0.0);
}

struct AddSolidAngle<'a> {
    caster: &'a Caster,
    points: &'a Points,
    total: &'a mut Lane,
}

impl Wide for AddSolidAngle<'_> {
    #[inline(always)]
    fn run(self) {
        for i in 0..self.points.count.min(LANES) {
            let (_, opening) = self.caster.seen_from(at(&self.points.position, i));
            self.total[i] += TAU * opening;
        }
    }
}

/// Which part of the mixture each point draws from: the cosine about the normal (opening 0), or a ball.
struct Choice {
    axis: [Lane; 3],
    opening: Lane,
    /// The first number, stretched to the shares still to be dealt out; negative once a ball is chosen.
    rest: Lane,
}

struct Choose<'a> {
    caster: &'a Caster,
    points: &'a Points,
    choice: &'a mut Choice,
}

impl Wide for Choose<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { caster, points, choice } = self;
        let position = points.position;
        for i in 0..points.count.min(LANES) {
            let (axis, opening) = caster.seen_from(at(&position, i));
            let share = TAU * opening;
            let rest = choice.rest[i];
            let here = (rest >= 0.0) & (rest < share);
            let old = at(&choice.axis, i);
            // Where in its share the number fell is kept in the opening's place, which draws the cone.
            set(&mut choice.axis, i, if here { axis } else { old });
            choice.opening[i] = if here { rest * (1.0 / TAU) } else { choice.opening[i] };
            choice.rest[i] = if here {
                -1.0
            } else if rest >= 0.0 {
                rest - share
            } else {
                rest
            };
        }
    }
}

struct Direct<'a> {
    choice: &'a Choice,
    points: &'a Points,
    v: &'a Lane,
    start: usize,
    next: &'a mut Paths,
}

impl Wide for Direct<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { choice, points, v, start, next } = self;
        let (axes, v) = (choice.axis, *v);
        let mut direction = ZERO3;
        for i in 0..points.count.min(LANES) {
            let rest = choice.rest[i];
            // 1 − cos, uniform in the cone, or sin² = u for the cosine.
            let below = choice.opening[i];
            let u = (rest * (1.0 / COSINE_WEIGHT)).min(1.0 - f32::EPSILON / 2.0);
            let from_ball = rest < 0.0;
            let sin = if from_ball { (below * (2.0 - below)).sqrt() } else { u.max(0.0).sqrt() };
            let cos = if from_ball { 1.0 - below } else { (1.0 - u).sqrt() };
            let (sin_phi, cos_phi) = f32::sin_cos_turns(v[i]);
            let axis = at(&axes, i);
            let (tangent, bitangent) = frame(axis);
            set(&mut direction, i, (tangent * cos_phi + bitangent * sin_phi) * sin + axis * cos);
        }
        for c in 0..3 {
            let part = start..start + points.count;
            next.rays.direction[c][part].copy_from_slice(&direction[c][..points.count]);
        }
    }
}

struct CountBall<'a> {
    caster: &'a Caster,
    points: &'a Points,
    start: usize,
    next: &'a Paths,
    balls: &'a mut Lane,
}

impl Wide for CountBall<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { caster, points, start, next, balls } = self;
        for i in 0..points.count.min(LANES - start.min(LANES)) {
            let (axis, opening) = caster.seen_from(at(&points.position, i));
            let inside = axis.dot(at(&next.rays.direction, start + i)) >= 1.0 - opening;
            balls[i] += if inside & (opening > 0.0) { 1.0 } else { 0.0 };
        }
    }
}

struct Weigh<'a> {
    points: &'a Points,
    total: &'a Lane,
    balls: &'a Lane,
    start: usize,
    next: &'a mut Paths,
}

impl Wide for Weigh<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { points, total, balls, start, next } = self;
        for i in 0..points.count.min(LANES - start.min(LANES)) {
            let j = start + i;
            let cos = at(&points.normal, i).dot(at(&next.rays.direction, j)).max(0.0);
            let scale = cos * total[i] / (COSINE_WEIGHT * cos + PI * balls[i]).max(f32::MIN_POSITIVE);
            let weight = at(&points.weight, i) * scale;
            set(&mut next.throughput, j, weight);
        }
    }
}
