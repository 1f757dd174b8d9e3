//! Caustics, brought by paths from the lamps.
//!
//! Light that comes from a lamp by way of mirrors, glass or metal to a diffuse surface is hard to find from there: few
//! directions lead to where the lamp is seen. From the lamp it is easy: paths start towards the objects that are not
//! diffuse, and what arrives at a surface that the camera sees is added to the pixel where it is seen. Camera paths leave
//! this light out ([`Paths::caustic`](super::lanes::Paths::caustic)), so that it counts once.
//!
//! Source: Arvo, "Backward ray tracing", SIGGRAPH 1986 course notes; Veach, "Robust Monte Carlo Methods for Light
//! Transport Simulation", 1997, sections 5.3 (shading normals) and 10.3.4 (light tracing).

use super::exposure::{Splat, Word};
use super::faces::{Face, Kind};
use super::geometry::{Geometry, Surface, at, set};
use super::integrator::{Integrator, SHORT_OF_LIGHT, roulette};
use super::lanes::{LANES, NOTHING};
use super::lens::Lens;
use super::lights::Sampled;
use super::solids;
use super::workspace::{Dimensions, Workspace};
use super::{Sampling, Settings};
use crate::bsdf::Bsdf;
use crate::raster::Rgb;
use crate::sampling::circular::Circular;
use crate::sampling::hash::mix64;
use crate::scene::{Request, Scene, Shape};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};

/// Paths from the lamps reach what is so far from the camera that the whole picture shows this much of it, as a share
/// of the square of the scene's extent. Nearer to the camera few of them come to any one pixel, and each is a speck.
const NEAREST: f32 = 0.05;

/// Of so many samples of a pixel one comes with a path from a lamp.
const EVERY: u32 = 5;

/// Of more targets than these all are taken as one.
const MOST_TARGETS: usize = 8;

/// What paths from the lamps need.
pub struct LightTracing {
    lamps: Vec<Lamp>,
    targets: Vec<Target>,
    /// Per object, whether these paths scatter there.
    casts: Vec<bool>,
    /// [`Lens::area_at`] from which on these paths bring the light.
    nearest: f32,
}

/// A lamp that paths start from.
struct Lamp {
    /// Number of the light.
    light: usize,
    /// Radiance times area over the probability of this lamp.
    power: Rgb,
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
        faces: &[Face],
        lights: &[Sampled],
        geometry: &Geometry<'_>,
    ) -> Option<Self> {
        if settings.sampling != Sampling::Mis || settings.camera_paths_only || request.max_depth < 2 {
            return None;
        }
        let casts: Vec<bool> = faces.iter().zip(&scene.objects).map(|(face, o)| casts(face, &o.shape)).collect();
        let targets = targets(scene.objects.iter().zip(&casts).filter(|(_, casts)| **casts).map(|(o, _)| &o.shape));
        let seen = faces.iter().any(|face| matches!(face.kind, Kind::Diffuse { .. }));
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
    /// ([`Lens::area_at`]).
    #[inline]
    pub fn reaches(&self, area: f32) -> bool {
        area > self.nearest
    }

    /// The number of the path from a lamp that comes with a sample of a pixel, if one does. The first of a pixel comes with
    /// any of [`EVERY`] samples, so that there are as many paths as there should be, however few samples.
    #[inline]
    pub fn path(seed: u64, pixel: u64, sample: u32) -> Option<u32> {
        let phase = mix64(seed ^ mix64(pixel)) as u32 % EVERY;
        (sample % EVERY == phase).then_some(sample / EVERY)
    }

    /// A lamp at random.
    #[inline]
    fn lamp(&self, u: f32) -> &Lamp {
        let number = self.lamps.partition_point(|lamp| lamp.up_to <= u);
        &self.lamps[number.min(self.lamps.len() - 1)]
    }

    /// A direction from a point to one of the targets, evenly over the solid angle of each, and 1 over its density.
    #[inline]
    fn direction(&self, point: Vec3, choice: f32, u: [f32; 2]) -> (Vec3, f32) {
        let total: f32 = self.targets.iter().map(|target| target.cone(point).1).sum();
        let mut rest = choice * total;
        let (mut axis, mut opening) = (Vec3::Y, 2.0);
        for target in &self.targets {
            (axis, opening) = target.cone(point);
            if rest < opening {
                break;
            }
            rest -= opening;
        }
        let below = u[0] * opening;
        let (sin, cos) = ((below * (2.0 - below)).max(0.0).sqrt(), 1.0 - below);
        let (x, y) = axis.any_orthonormal_pair();
        let (sin_phi, cos_phi) = f32::sin_cos_turns(u[1]);
        let direction = (x * cos_phi + y * sin_phi) * sin + axis * cos;
        let holding = self.targets.iter().filter(|target| target.holds(point, direction)).count();
        // Rounding at the rim may leave out the one that it was drawn for.
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
        if sin2 < 1.0 { (to / d2.sqrt(), solids::opening(sin2)) } else { (Vec3::Y, 2.0) }
    }

    #[inline]
    fn holds(&self, point: Vec3, direction: Vec3) -> bool {
        let (axis, opening) = self.cone(point);
        0.5 * (direction - axis).length_squared() <= opening
    }
}

/// Whether paths from the lamps scatter at a face: at rough metal of any shape; in mirrors and glass only where the normal
/// for shading is that of the surface, which is the same from either end of a path. The reports' materials are not the same
/// from both ends.
fn casts(face: &Face, shape: &Shape) -> bool {
    match face.kind {
        Kind::Rough(Bsdf::ReportConductor(_)) | Kind::Delta(Bsdf::ReportGlass(_)) => false,
        Kind::Black | Kind::Diffuse { .. } => false,
        Kind::Rough(_) => true,
        Kind::Delta(_) => !matches!(shape, Shape::Mesh(_)),
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
    let glowing = || lights.iter().enumerate().filter_map(|(i, light)| light.glowing().map(|(r, area)| (i, r * area)));
    let total: f32 = glowing().map(|(_, power)| power.element_sum()).sum();
    let mut up_to = 0.0;
    glowing()
        .map(|(light, power)| {
            let probability = power.element_sum() / total;
            up_to += probability;
            Lamp { light, power: power / probability, up_to }
        })
        .collect()
}

impl Integrator<'_> {
    /// Follows one path from the lamps for each of the first `count` slots and puts the light that it brings to pixels
    /// into `work.splats`: for [`EVERY`] samples of a pixel.
    pub fn trace_from_lamps(&self, work: &mut Workspace, count: usize, lens: &Lens) {
        let Some(tracing) = &self.light_tracing else { return };
        self.start_at_lamps(work, tracing, count);
        // The scattering at the diffuse surface counts as well.
        for scatterings in 1..=self.request.max_depth {
            let count = work.paths.count;
            if count == 0 {
                return;
            }
            let last = scatterings == self.request.max_depth;
            self.geometry.nearest(&work.paths.rays, count, &mut work.hits);
            work.delta.clear();
            work.rough.clear();
            work.arrived.clear();
            for i in 0..count {
                let object = work.hits.object[i];
                if object == NOTHING {
                    continue;
                }
                match self.faces[object as usize].kind {
                    // What comes straight from a lamp, light samples find.
                    Kind::Diffuse { .. } if scatterings > 1 => work.arrived.push(i as u32),
                    _ if last || !tracing.scatters_at(object) => {}
                    Kind::Delta(_) => work.delta.push(i as u32),
                    Kind::Rough(_) => self.collect_rough(work, i),
                    Kind::Black | Kind::Diffuse { .. } => {}
                }
            }
            self.splat(work, tracing, lens);
            work.next.count = 0;
            let dimensions = Dimensions::from_lamps(scatterings);
            self.pass_on_delta(work, dimensions);
            self.pass_on_rough(work, dimensions);
            roulette(&mut work.next, &work.numbers, dimensions.choice(), scatterings);
            std::mem::swap(&mut work.paths, &mut work.next);
        }
        work.paths.count = 0;
    }

    /// Rays from the lamps to the targets.
    fn start_at_lamps(&self, work: &mut Workspace, tracing: &LightTracing, count: usize) {
        work.paths.count = 0;
        let dimensions = Dimensions::from_lamps(0);
        let slots: [u32; LANES] = std::array::from_fn(|slot| slot as u32);
        let mut u = [[[0.0; LANES]; 2]; 3];
        for (u, dimension) in u.iter_mut().zip([dimensions.choice(), dimensions.gather(), dimensions.bsdf()]) {
            work.numbers.fill(self.arch, &slots[..count], dimension, (0, 1), u);
        }
        for slot in 0..count {
            let [[of_lamp, of_target], place, within] = u.each_ref().map(|[a, b]| [a[slot], b[slot]]);
            let lamp = tracing.lamp(of_lamp);
            let light = &self.lights[lamp.light];
            let Some(start) = light.start(place) else { continue };
            let (direction, solid_angle) = tracing.direction(start.position, of_target, within);
            let cos = start.normal.dot(direction);
            let glow = if start.two_sided { cos.abs() } else { cos.max(0.0) };
            if glow == 0.0 {
                continue;
            }
            set(&mut work.power, slot, lamp.power * (glow * solid_angle * EVERY as f32));
            let origin = start.position + start.normal * self.geometry.offset(light.object).copysign(cos);
            work.paths.push(origin, direction, Rgb::ONE, slot as u32, Word::DIRECT);
        }
    }

    /// Adds what has arrived at diffuse surfaces to the pixels where the camera sees them.
    fn splat(&self, work: &mut Workspace, tracing: &LightTracing, lens: &Lens) {
        let mut pixel = [[0; 2]; LANES];
        work.shadows.count = 0;
        for k in 0..work.arrived.len() {
            let i = work.arrived[k] as usize;
            let Kind::Diffuse { albedo } = self.faces[work.hits.object[i] as usize].kind else { continue };
            let surface = self.geometry.surface(&work.paths.rays, &work.hits, i);
            let wi = -at(&work.paths.rays.direction, i);
            let Some(view) = lens.see(surface.position) else { continue };
            let side = if surface.normal.dot(view.direction) > 0.0 { 1.0 } else { -1.0 };
            let (normal, shading) = (surface.normal * side, surface.shading * side);
            let (cos_geometric, cos) = (normal.dot(wi), shading.dot(wi));
            let origin = surface.position + normal * surface.offset;
            let area = lens.area_at(origin);
            // Camera paths go on above both normals.
            if cos_geometric <= 0.0 || cos <= 0.0 || !tracing.reaches(area) {
                continue;
            }
            let slot = work.paths.slot[i];
            let power = at(&work.power, slot as usize) * at(&work.paths.throughput, i);
            let seen = normal.dot(view.direction) / area;
            let value = power * albedo * (FRAC_1_PI * cos / cos_geometric * seen);
            let word = work.paths.word[i].then(false).reversed();
            pixel[work.shadows.count] = view.pixel;
            let limit = view.distance * SHORT_OF_LIGHT;
            work.shadows.push(origin, view.direction, limit, value, slot, word);
        }
        let shadows = &work.shadows;
        self.geometry.occluded(&shadows.rays, shadows.count, &shadows.limit, NOTHING, &mut work.blocked);
        for k in 0..work.shadows.count {
            if work.blocked[k] == 0 {
                let class = self.classes.map_or(0, |classes| classes.index(work.shadows.word[k]));
                work.splats.push(Splat { pixel: pixel[k], class, value: at(&work.shadows.value, k) });
            }
        }
    }

    /// Scatters the paths that have hit mirrors and glass.
    fn pass_on_delta(&self, work: &mut Workspace, dimensions: Dimensions) {
        for k in 0..work.delta.len() {
            let i = work.delta[k] as usize;
            let Kind::Delta(bsdf) = &self.faces[work.hits.object[i] as usize].kind else { continue };
            let surface = self.geometry.surface(&work.paths.rays, &work.hits, i);
            let wo = -at(&work.paths.rays.direction, i);
            let (frame, slot) = (surface.frame(wo), work.paths.slot[i]);
            let [uc, _] = work.numbers.short_pair(slot, dimensions.choice(), (0, 1));
            let Some(sample) = bsdf.sample_adjoint(frame.local(wo), uc, [0.0; 2]) else { continue };
            let wi = frame.world(sample.wi);
            let throughput = at(&work.paths.throughput, i) * sample.weight;
            work.next.push(surface.leave(wi), wi, throughput, slot, work.paths.word[i].then(true));
        }
    }

    /// Scatters the paths that have hit rough metal, one object after the other.
    fn pass_on_rough(&self, work: &mut Workspace, dimensions: Dimensions) {
        for group in work.rough_groups() {
            let Kind::Rough(bsdf) = &self.faces[work.rough[group.start].object as usize].kind else { continue };
            self.draw_rough(work, group.clone(), bsdf, dimensions);
            for (i, hit) in work.rough[group].iter().enumerate() {
                let weight = at(&work.scattered.weight, i);
                let wi = hit.frame.world(at(&work.scattered.wi, i));
                if weight == Rgb::ZERO || hit.surface.normal.dot(wi) <= 0.0 {
                    continue;
                }
                let Some(factor) = adjoint_of_shading(&hit.surface, hit.frame.world(hit.wo), wi) else { continue };
                work.next.push(hit.surface.leave(wi), wi, hit.throughput * weight * factor, hit.slot, hit.word);
            }
        }
    }
}

/// What a path from a lamp is multiplied by where the normal for shading is not that of the surface, so that it brings the
/// light that a camera path finds; `None` where that finds none. `wo` points to the lamp, `wi` to the camera.
#[inline]
fn adjoint_of_shading(surface: &Surface, wo: Vec3, wi: Vec3) -> Option<f32> {
    if surface.shading == surface.normal {
        return Some(1.0);
    }
    let [normal, shading] = [surface.normal, surface.shading].map(|n| [n.dot(wo), n.dot(wi)]);
    let sound = [normal, shading].into_iter().flatten().all(|cos| cos > 0.0);
    sound.then(|| shading[0] * normal[1] / (normal[0] * shading[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Silent, render};
    use crate::sampling::stream::StreamKind;
    use crate::scene::{
        Camera, Conductor, Distribution, Emission, Material, Mesh, Object, Projection, Rectangle, Role, Sphere,
    };
    use crate::stats::estimate::Estimate;
    use glam::DVec3;
    use std::sync::Arc;

    /// A camera above the middle of a diffuse floor of 4 by 4, and a lamp to the left of it.
    fn room(objects: Vec<Object>, projection: Projection) -> Scene {
        let camera = Camera::look_at(DVec3::new(0.0, 3.0, 2.0), DVec3::ZERO, DVec3::Y, projection).unwrap();
        let floor = Rectangle::new(Vec3::ZERO, 2.0 * Vec3::Z, 2.0 * Vec3::X).unwrap();
        let lamp = Rectangle::new(Vec3::new(-1.5, 2.0, 0.0), 0.3 * Vec3::X, 0.3 * Vec3::Z).unwrap();
        let black = Material::Diffuse { albedo: Rgb::ZERO };
        let mut all = vec![
            Object::new(Shape::Rectangle(floor), Material::Diffuse { albedo: Rgb::splat(0.5) }),
            Object { emission: Some(glow(10.0)), ..Object::new(Shape::Rectangle(lamp), black) },
        ];
        all.extend(objects);
        Scene { name: "room".into(), camera, objects: all, lights: Vec::new(), environment: None }
    }

    fn glow(radiance: f32) -> Emission {
        Emission { radiance: Rgb::splat(radiance), two_sided: false, role: Role::Lamp }
    }

    const WIDE: Projection = Projection::Perspective { tan_half_width: 0.5, tan_half_height: 0.5 };

    fn ball(material: Material) -> Object {
        Object::new(Shape::Sphere(Sphere { centre: Vec3::new(0.2, 0.6, 0.0), radius: 0.5 }), material)
    }

    fn metal(alpha: f32) -> Material {
        let (eta, k) = (Rgb::splat(0.2), Rgb::splat(3.0));
        Material::Conductor(Conductor { eta, k, alpha, distribution: Distribution::Beckmann })
    }

    /// Few triangles and normals far from theirs.
    fn rounded() -> Shape {
        let corners = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        let mut faces = Vec::new();
        for (x, y, z) in (0..8).map(|i| (i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2))) {
            let upright = (x + y + z) % 2 == 0;
            faces.push(if upright { [x, y, z] } else { [x, z, y] });
        }
        let at = corners.map(|c| Vec3::new(0.2, 0.6, 0.0) + 0.55 * c);
        Shape::Mesh(Arc::new(Mesh::new(at.to_vec(), corners.to_vec(), faces).unwrap()))
    }

    /// The mean difference between the pictures by both kinds of paths and by camera paths alone, in standard errors.
    ///
    /// Light that is found by camera paths anyway has the same noise in both and drops out.
    fn bias(scene: &Scene, spp: u32, max_depth: u32) -> f64 {
        const ROUNDS: u32 = 16;
        let request = Request { width: 8, height: 8, spp: spp / ROUNDS, light_samples: 1, max_depth };
        let differences: Vec<f64> = (0..ROUNDS)
            .map(|seed| {
                let mean = |camera_paths_only: bool| {
                    let stream = StreamKind::Independent;
                    let settings = Settings { camera_paths_only, stream, seed: seed.into(), ..Settings::default() };
                    let image = render(scene, &request, &settings, &Silent).unwrap().image;
                    image.pixels().iter().map(|p| f64::from(p.x)).sum::<f64>()
                };
                mean(false) - mean(true)
            })
            .collect();
        let Estimate { value, standard_error, .. } = Estimate::mean(&differences);
        assert!(standard_error > 0.0, "there must be something to compare");
        value / standard_error
    }

    #[test]
    fn camera_paths_alone_have_the_same_mean() {
        let parallel = Projection::Orthographic { half_width: 1.5, half_height: 1.5 };
        let glass = Material::Glass { reflectance: Rgb::ONE, transmittance: Rgb::ONE, eta: 1.5 };
        let mirror = Material::Mirror { reflectance: Rgb::splat(0.9) };
        let upright = Rectangle::new(Vec3::new(1.0, 0.5, 0.0), 0.5 * Vec3::Y, 0.5 * Vec3::Z).unwrap();
        for (name, object, projection, spp) in [
            ("glass", ball(glass), WIDE, 1 << 14),
            ("mirror", ball(mirror), WIDE, 1 << 14),
            ("flat mirror", Object::new(Shape::Rectangle(upright), mirror), WIDE, 1 << 12),
            ("broad metal", ball(metal(0.4)), WIDE, 1 << 12),
            ("sharp metal, parallel rays", ball(metal(0.05)), parallel, 1 << 14),
            ("metal with normals of its own", Object::new(rounded(), metal(0.4)), WIDE, 1 << 14),
        ] {
            let z = bias(&room(vec![object], projection), spp, 4);
            assert!(z.abs() < 5.0, "{name}: {z} standard errors");
        }
    }

    #[test]
    fn light_that_comes_into_glass_is_squeezed() {
        // The camera and the floor are in the ball, the lamp is not.
        let inside = Material::Glass { reflectance: Rgb::ONE, transmittance: Rgb::ONE, eta: 1.5 };
        let around = Object::new(Shape::Sphere(Sphere { centre: Vec3::Y, radius: 3.1 }), inside);
        let mut scene = room(vec![around], WIDE);
        let lamp = Sphere { centre: Vec3::new(0.0, 7.0, 0.0), radius: 2.0 };
        scene.objects[1].shape = Shape::Sphere(lamp);
        let z = bias(&scene, 1 << 13, 3);
        assert!(z.abs() < 5.0, "{z} standard errors");
    }

    #[test]
    fn many_lamps_and_targets_share_the_paths() {
        let small = |i: i32| {
            let centre = Vec3::new(-1.5 + 0.3 * i as f32, 0.3, -0.5);
            Object::new(Shape::Sphere(Sphere { centre, radius: 0.12 }), metal(0.3))
        };
        for balls in [3, 11] {
            let mut scene = room((0..balls).map(small).collect(), WIDE);
            let bulb = Shape::Sphere(Sphere { centre: Vec3::new(1.0, 1.5, -1.0), radius: 0.2 });
            scene.objects.push(Object { emission: Some(glow(30.0)), ..Object::new(bulb, metal(0.5)) });
            let z = bias(&scene, 1 << 12, 3);
            assert!(z.abs() < 5.0, "{balls} balls: {z} standard errors");
        }
    }

    #[test]
    fn there_are_as_many_paths_as_there_should_be() {
        for samples in [1, 3, 4, 7, 64] {
            let of = |pixel| (0..samples).filter_map(move |sample| LightTracing::path(3, pixel, sample));
            let numbers: Vec<u32> = of(5).collect();
            assert_eq!(numbers, (0..numbers.len() as u32).collect::<Vec<_>>(), "each number once");
            let count = (0..4000).map(|pixel| of(pixel).count()).sum::<usize>() as f64;
            let expected = 4000.0 * f64::from(samples) / f64::from(EVERY);
            assert!((count - expected).abs() < 4.0 * 4000f64.sqrt(), "{samples}: {count}, not {expected}");
        }
    }
}
