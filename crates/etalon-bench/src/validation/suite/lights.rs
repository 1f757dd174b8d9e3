//! Test cases: lights. Rectangles sampled uniformly by solid angle; rectangles, triangles, spheres and the constant
//! sky as the kernel samples directions towards them, in lanes; and which of many lights the light tree chooses.

use super::super::case::Case;
use super::super::whole;
use super::{in_lanes, short};
use etalon_core::error::Error;
use etalon_core::math::circular::Circular;
use etalon_core::math::{Real, Rgb};
use etalon_core::sampling::rectangle::{SphericalRectangle, solid_angle};
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::scene::{
    Bvh, Emission, EmitterVisibility, Falloff, Light, Material, Mesh, Object, Ray, Rectangle, Scene, Shape, Sphere,
    builtin,
};
use etalon_render::Settings;
use etalon_render::probe::{
    BLOCK, LANES, Lane, LightSample, LightSampleLanes, LightTree, LightTreeAt, Lights, NONE, SampleLight, SampledLight,
};
use etalon_render::probe::{sample_one_light, sample_own_lights};
use etalon_stats::bsdf::{
    Bsdf, BsdfSample, DeltaLobe, Density, Direction, Hit, Kind, Properties, Spectrum, is_edge_on, places,
};
use etalon_stats::{
    Directions, Discrete, Domain, Mass, Pole, Protocol, Sample, SampleCount, Sampler, Square, density, sampler,
};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;
use std::slice::from_ref;
use std::sync::Arc;

const POINT: Vec3 = Vec3::new(0.3, -0.2, 0.5);

/// Spheres: distance of the centre and radius. From inside all directions lead to them.
const SPHERES: [(&str, f32, f32); 5] =
    [("touching", 1.001, 1.0), ("near", 1.5, 1.0), ("middle", 4.0, 1.0), ("far", 300.0, 1.0), ("inside", 0.5, 1.0)];

/// Rectangles: centre relative to the point, and half sides.
const RECTANGLES: [(&str, Vec3, Vec3, Vec3); 3] = [
    ("ceiling", Vec3::new(0.1, 1.5, -0.2), Vec3::new(0.35, 0.0, 0.0), Vec3::new(0.0, 0.0, 0.25)),
    ("tilted", Vec3::new(1.0, 0.5, 0.8), Vec3::new(0.3, -0.3, 0.0), Vec3::new(0.2, 0.2, 0.1)),
    ("edge-on", Vec3::new(2.0, 0.02, 0.0), Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.0, 0.0, 0.5)),
];

/// Triangles: corners relative to the point.
pub const TRIANGLES: [(&str, [Vec3; 3]); 5] = [
    ("near", [Vec3::new(-0.5, 0.02, -0.25), Vec3::new(0.5, 0.02, -0.5), Vec3::new(0.25, 0.02, 0.75)]),
    ("middle", [Vec3::new(-0.5, 1.0, -0.25), Vec3::new(0.5, 1.25, -0.5), Vec3::new(0.25, 1.0, 0.75)]),
    ("far", [Vec3::new(100.0, 0.0, 0.0), Vec3::new(100.0, 1.0, 0.0), Vec3::new(99.5, 0.0, 1.0)]),
    ("grazing", [Vec3::new(2.0, 0.02, -0.5), Vec3::new(3.0, 0.02, 0.5), Vec3::new(2.0, 0.02, 0.5)]),
    ("sliver", [Vec3::new(-0.5, 1.0, 0.0), Vec3::new(0.5, 1.0, 0.0), Vec3::new(0.5, 1.0, 0.01)]),
];

/// Rectangles as viewed from the origin: sides in x and y, and distance of their plane.
const VIEWED: [(&str, [f64; 2], [f64; 2], f64); 7] = [
    ("facing", [-0.35, 0.35], [-0.25, 0.25], 1.5),
    ("aside", [0.5, 1.2], [-1.0, -0.4], 0.7),
    ("touching", [-0.35, 0.35], [-0.25, 0.25], 0.005),
    ("overhead", [-5.0, 4.0], [-3.0, 3.0], 0.01),
    ("small", [1.0, 1.01], [2.0, 2.01], 3.0),
    ("grazing", [10.0, 10.7], [0.0, 0.5], 0.1),
    ("strip", [-100.0, 100.0], [-0.01, 0.01], 1.0),
];

/// The cases of directions towards one light.
pub fn directions() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, xs, ys, depth) in VIEWED {
        cases.push(viewed::<f64>(format!("light/rectangle/{name}"), xs, ys, depth, |u| u));
        cases.push(viewed::<f32>(format!("light/rectangle-f32/{name}"), xs, ys, depth, |u| f64::from(short(u))));
    }
    cases.extend(SPHERES.map(|(name, distance, radius)| sphere(name, distance, radius)));
    cases.extend(RECTANGLES.map(|(name, centre, x, y)| rectangle(name, centre, x, y)));
    let by_solid_angle = |pdf, _area| pdf;
    cases.extend(TRIANGLES.map(|(name, corners)| triangle(format!("light/triangle/{name}"), corners, by_solid_angle)));
    cases.push(sky());
    cases.extend(whole_lights());
    cases
}

/// A light of the renderer as its users call it: samples of it, their pdfs, and rays that meet it.
struct Emitter {
    light: SampledLight,
    shape: Option<(Shape, Bvh)>,
    two_sided: bool,
}

impl Emitter {
    fn of(object: Option<(Shape, bool)>, light: Option<Light>) -> Option<Self> {
        let two_sided = object.as_ref().is_none_or(|(_, two_sided)| *two_sided);
        let sampled = match object.clone() {
            Some((shape, two_sided)) => emitting(shape, two_sided),
            None => light_of(None, light),
        };
        let shape = object.map(|(shape, _)| (shape.clone(), Bvh::build(&[&shape])));
        Some(Self { light: sampled?, shape, two_sided })
    }

    fn emits(&self, Hit { normal, .. }: &Hit, wi: Direction) -> bool {
        self.two_sided || DVec3::from_array(*normal).dot(DVec3::from_array(wi)) < 0.0
    }
}

impl Bsdf for Emitter {
    fn properties(&self) -> Properties {
        let kind = Kind::Light { hits: self.shape.is_some(), one_sided: !self.two_sided, points: Vec::new() };
        let delta = !self.light.has_extent();
        Properties { kind, delta, precision: f64::from(f32::EPSILON), ..Properties::light() }
    }

    fn eval(&self, from: Direction, wi: Direction, _: &[f64]) -> Spectrum {
        let is_lit = match &self.shape {
            Some(_) => Bsdf::hit(self, from, wi).is_some_and(|hit| self.emits(&hit, wi)),
            None => self.light.has_extent() && wi[1] > 0.0,
        };
        [f64::from(is_lit); 3]
    }

    fn pdf(&self, from: Direction, wi: Direction) -> f64 {
        let point = DVec3::from_array(from).as_vec3();
        f64::from(match &self.shape {
            Some(_) if Bsdf::hit(self, from, wi).is_some() => self.light.pdf(point),
            // No ray meets the sky, so that the renderer asks for no pdf: samples have it.
            None if self.eval(from, wi, &[])[0] > 0.0 => self.light.sample(point, [0.5; 2]).pdf,
            _ => 0.0,
        })
    }

    fn sample(&self, from: Direction, u: &[f64]) -> Option<BsdfSample> {
        let from = DVec3::from_array(from).as_vec3();
        let LightSample { wi, distance, weight, pdf } = self.light.sample(from, [u[0], u[1]].map(short));
        let density = if self.light.has_extent() { Density::Pdf(f64::from(pdf)) } else { Density::Delta(1.0) };
        let point = (from + distance * wi).is_finite().then(|| (from + distance * wi).as_dvec3().to_array());
        let sample = BsdfSample::new(wi.as_dvec3().to_array(), [f64::from(weight.x); 3], density);
        Some(BsdfSample { point, ..sample })
    }

    fn delta_lobes(&self, from: Direction) -> Vec<DeltaLobe> {
        let lobe = |s: BsdfSample| DeltaLobe { wi: s.wi, probability: 1.0, throughput: s.weight };
        let sample = Bsdf::sample(self, from, &[0.5; 2]).filter(BsdfSample::is_delta);
        sample.map(lobe).into_iter().collect()
    }

    fn hit(&self, from: Direction, wi: Direction) -> Option<Hit> {
        let [origin, direction] = [from, wi].map(|v| DVec3::from_array(v).as_vec3());
        let (shape, tree) = self.shape.as_ref()?;
        let hit = tree.nearest(&Ray { origin, direction }, f32::INFINITY)?;
        let normal = match shape {
            Shape::Sphere(sphere) => (origin + hit.t * direction - sphere.centre).normalize(),
            _ => tree.plane(hit.place).0.normal,
        };
        Some(Hit { distance: f64::from(hit.t), normal: normal.as_dvec3().to_array(), pdf_area: None })
    }
}

/// Lights as their users call them: every number of each against the others.
fn whole_lights() -> Vec<Case> {
    let rectangle = || Rectangle::new(POINT, Vec3::new(0.3, -0.3, 0.0), Vec3::new(0.2, 0.2, 0.1)).map(Shape::Rectangle);
    let mesh = || Mesh::new(TRIANGLES[1].1.into(), Vec::new(), vec![[0, 1, 2]]).ok();
    let triangle = move || mesh().map(|mesh| Shape::Mesh(Arc::new(mesh)));
    let sphere = || Some(Shape::Sphere(Sphere { centre: POINT, radius: 0.7 }));
    let point = Light::Point { position: POINT, intensity: Rgb::ONE, falloff: Falloff::InverseSquare };
    let sun = Light::Directional { direction: Vec3::new(0.48, 0.6, -0.64), irradiance: Rgb::ONE };
    let of = |name: &str, make: Box<dyn Fn() -> Option<Emitter> + Send + Sync>| {
        Case::new(format!("whole/light/{name}"), move |protocol, round| {
            let emitter = make().ok_or_else(|| Error::parameter("names", "a case of a light that emits nothing"))?;
            let all = places(&emitter)?.into_iter().filter(|(name, _)| !is_edge_on(name));
            let samples = match protocol.samples {
                SampleCount::Detect(error) => {
                    SampleCount::Detect(error.max(emitter.properties().kind.detectable_error()))
                }
                fixed @ SampleCount::Fixed(_) => fixed,
            };
            let all: Vec<Direction> = all.map(|(_, place)| place).collect();
            whole::examine(&emitter, &all, &Protocol { samples, ..*protocol }, round)
        })
    };
    vec![
        of("rectangle", Box::new(move || Emitter::of(Some((rectangle()?, false)), None))),
        of("triangle", Box::new(move || Emitter::of(Some((triangle()?, true)), None))),
        of("ball", Box::new(move || Emitter::of(Some((sphere()?, false)), None))),
        of("ball-of-two-sides", Box::new(move || Emitter::of(Some((sphere()?, true)), None))),
        of("point", Box::new(move || Emitter::of(None, Some(point.clone())))),
        of("sun", Box::new(move || Emitter::of(None, Some(sun.clone())))),
        of("sky", Box::new(|| Emitter::of(None, Some(Light::Hemisphere { radiance: Rgb::ONE })))),
    ]
}

/// A position along a side, from 0 to 1: in f32 the sides themselves are rounded.
fn onto_side(x: f64) -> f64 {
    if (x - x.clamp(0.0, 1.0)).abs() < 1e-6 { x.clamp(0.0, 1.0) } else { x }
}

/// The point on the rectangle, of pdf ∝ cos θ / r² with respect to area.
fn viewed<T: Circular + Send + Sync + 'static>(
    name: String,
    xs: [f64; 2],
    ys: [f64; 2],
    depth: f64,
    random: fn(f64) -> f64,
) -> Case {
    Case::of(name, Square, move || {
        let [x0, x1] = xs;
        let [y0, y1] = ys;
        let rectangle = SphericalRectangle::new(xs.map(T::from_f64), ys.map(T::from_f64), T::from_f64(depth));
        let draw = move |u: &[f64]| {
            let [x, y] = rectangle.sample([T::from_f64(random(u[0])), T::from_f64(random(u[1]))]).map(Real::to_f64);
            // Position on the rectangle, from 0 to 1 along each side.
            let place = [(x - x0) / (x1 - x0), (y - y0) / (y1 - y0)];
            Some(Sample::new(place.map(onto_side)))
        };
        // Uniform by solid angle: per area, the pdf is cos θ / r² over the solid angle.
        let scale = (x1 - x0) * (y1 - y0) * depth / solid_angle(xs, ys, depth);
        let pdf = move |[x, y]: [f64; 2]| {
            let (x, y) = (x0 + x * (x1 - x0), y0 + y * (y1 - y0));
            scale / (x * x + y * y + depth * depth).powf(1.5)
        };
        (sampler(2, draw), density(pdf))
    })
}

/// The only light of a scene, as the renderer has it.
fn light_of(object: Option<Object>, light: Option<Light>) -> Option<SampledLight> {
    let (scene, _) = builtin::furnace();
    let lights = light.into_iter().collect();
    let scene = Scene { objects: object.into_iter().collect(), lights, environment: None, ..scene };
    SampledLight::all(&scene, &Settings::default(), &[]).pop()
}

fn emitting(shape: Shape, two_sided: bool) -> Option<SampledLight> {
    let emission = Emission { radiance: Rgb::ONE, two_sided, visibility: EmitterVisibility::Sampled };
    light_of(
        Some(Object { emission: Some(emission), ..Object::new(shape, Material::Diffuse { albedo: Rgb::ZERO }) }),
        None,
    )
}

/// Samples towards a light, as the kernel takes them of one light and of lights chosen for each hit, mapped to points of a
/// domain by `place`. A sample that the two loops do not agree on, or with another weight than radiance 1 over the pdf, is
/// missing.
fn samples_towards(light: Option<SampledLight>, place: impl Fn(LightSample) -> Sample + Sync) -> impl Sampler {
    let positions = POINT.to_array().map(|x| [x; LANES]);
    in_lanes(move |[u], count| {
        let [mut out, mut each] = [LightSampleLanes::default(), LightSampleLanes::default()];
        if let Some(light) = &light {
            sample_one_light(light, &positions, count, u, &mut out);
            sample_own_lights(from_ref(light), &[0; LANES][..count], &positions, u, &mut each);
        }
        let of_lane = |i| {
            let sample = out.at(i);
            let is_radiance_one = (sample.pdf * sample.weight - Rgb::ONE).abs().max_element() < 1e-6;
            (is_radiance_one && sample == each.at(i)).then(|| place(sample))
        };
        (0..count).map(of_lane).collect()
    })
}

/// Directions in the frame of the sphere, whose cone is a rectangle of the chart: the pdf is constant inside it.
fn sphere(name: &str, distance: f32, radius: f32) -> Case {
    let directions = Directions::sphere(Pole::Z);
    Case::of(format!("light/ball/{name}"), directions, move || {
        let centre = POINT + distance * Vec3::new(0.36, 0.48, 0.8);
        let light = emitting(Shape::Sphere(Sphere { centre, radius }), distance < radius);
        let to = (centre - POINT).as_dvec3();
        // Sine of half the angle of the cone, squared.
        let sin2 = f64::from(radius).powi(2) / to.length_squared();
        // (1 − cos)/2 of the cone, all of the sphere from inside, and what rounding of directions adds to it.
        let edge = if sin2 < 1.0 { 0.5 * sin2 / (1.0 + (1.0 - sin2).sqrt()) } else { 1.0 };
        let rim = edge * (1.0 + 1e-6 / sin2.sqrt());
        let axis = to.normalize();
        // Frame of the sphere: directions in it are tested.
        let (x, y) = axis.any_orthonormal_pair();
        let pdf = light.as_ref().map_or(f64::NAN, |light| f64::from(light.pdf(POINT)));
        let place = move |sample: LightSample| {
            let wi = sample.wi.as_dvec3();
            let local = DVec3::new(wi.dot(x), wi.dot(y), wi.dot(axis));
            let local = local.to_array();
            // Directions that rounding moves across the edge of the cone count as inside.
            let beyond = directions.to_chart(local.into()).filter(|chart| (edge..rim).contains(&chart[0]));
            let point = beyond.map_or(local, |chart| directions.direction_at([edge.next_down(), chart[1]]));
            Sample::with_pdf(point, f64::from(sample.pdf))
        };
        let inside = move |w: [f64; 3]| directions.to_chart(w.into()).is_some_and(|chart| chart[0] <= edge);
        let uniform = density(move |w| if inside(w) { pdf } else { 0.0 });
        let steps = if edge < 1.0 { vec![edge] } else { Vec::new() };
        (samples_towards(light, place), uniform.with_steps([steps, Vec::new()]))
    })
}

/// Points on the rectangle: the pdf per solid angle is constant, that per area is cos θ / r² times it.
fn rectangle(name: &str, centre: Vec3, x: Vec3, y: Vec3) -> Case {
    Case::of(format!("light/panel/{name}"), Square, move || {
        // The side that faces the point emits.
        let (x, y) = if x.cross(y).dot(centre) < 0.0 { (x, y) } else { (y, x) };
        let rectangle = Rectangle::new(POINT + centre, x, y);
        let light = rectangle.and_then(|rectangle| emitting(Shape::Rectangle(rectangle), false));
        let [centre, x, y] = [centre, x, y].map(|v| v.as_dvec3());
        let pdf = light.as_ref().map_or(f64::NAN, |light| f64::from(light.pdf(POINT)));
        let place = move |sample: LightSample| {
            let offset = sample.wi.as_dvec3() * f64::from(sample.distance) - centre;
            // Position on the rectangle, from 0 to 1 along each side.
            let chart = [x, y].map(|side| 0.5 + 0.5 * offset.dot(side) / side.length_squared());
            Sample::new(chart.map(onto_side))
        };
        // cos θ / r² of the point of the chart, times the area.
        let front = 4.0 * x.cross(y);
        let at = move |[u, v]: [f64; 2]| {
            let to = centre + (2.0 * u - 1.0) * x + (2.0 * v - 1.0) * y;
            pdf * front.dot(to).abs() / to.length().powi(3)
        };
        (samples_towards(light, place), density(at))
    })
}

/// Points on a triangle, which two random numbers u and v would be mapped to uniformly by area. `claim` makes of the
/// pdf per solid angle, and of the area, the pdf that is tested.
pub fn triangle(name: String, [a, b, c]: [Vec3; 3], claim: fn(f64, f64) -> f64) -> Case {
    Case::of(name, Square, move || {
        // The front faces the point.
        let corners = if (b - a).cross(c - a).dot(a) < 0.0 { [a, b, c] } else { [a, c, b] };
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        let mesh = Mesh::new(corners.map(|corner| POINT + corner).into(), Vec::new(), vec![[0, 1, 2]]);
        let light = mesh.ok().and_then(|mesh| emitting(Shape::Mesh(Arc::new(mesh)), false));
        let normal = (b - a).cross(c - a);
        let area = 0.5 * normal.length();
        let pdf = light.as_ref().map_or(f64::NAN, |light| claim(f64::from(light.pdf(POINT)), area));
        let place = move |sample: LightSample| {
            let offset = sample.wi.as_dvec3() * f64::from(sample.distance) - a;
            // Barycentric coordinates of b and c, then the random numbers. Rounding moves a point across an edge.
            let weight = |side: DVec3, other: DVec3| {
                let across = other.cross(normal);
                (offset.dot(across) / side.dot(across)).max(0.0)
            };
            let [b, c] = [weight(b - a, c - a), weight(c - a, b - a)];
            let r = b + c;
            Sample::new([(r * r).min(1.0), if r > 0.0 { c / r } else { 0.0 }])
        };
        // cos θ / r² of the point, times the area.
        let at = move |[u, v]: [f64; 2]| {
            let r = u.sqrt();
            let to = a + r * (1.0 - v) * (b - a) + r * v * (c - a);
            pdf * 0.5 * normal.dot(to).abs() / to.length().powi(3)
        };
        (samples_towards(light, place), density(at))
    })
}

fn sky() -> Case {
    Case::of("light/sky", Directions::hemisphere(Pole::Y), || {
        let light = light_of(None, Some(Light::Hemisphere { radiance: Rgb::ONE }));
        let place = |sample: LightSample| Sample::new(sample.wi.as_dvec3().to_array());
        (samples_towards(light, place), density(|_: [f64; 3]| 1.0 / TAU))
    })
}

/// The probability of a light by a tree, at a point with a normal or without.
pub type Pmf = fn(&LightTree, Vec3, Option<Vec3>, u32) -> f32;

/// As the renderer has it.
pub fn pmf(tree: &LightTree, point: Vec3, normal: Option<Vec3>, light: u32) -> f32 {
    tree.at(point, normal).pmf(light)
}

/// Numbers of lights.
const COUNTS: [usize; 3] = [10, 200, 10_000];

/// The lights are in the unit cube.
const POINTS: [(&str, Vec3); 2] = [("inside", Vec3::new(0.4, 0.6, 0.3)), ("outside", Vec3::new(3.0, -1.0, 0.5))];
const NORMALS: [(&str, Option<Vec3>); 2] = [("sphere", None), ("normal", Some(Vec3::new(-0.6, 0.8, 0.0)))];

/// The cases of the choice among many lights.
pub fn selections() -> Vec<Case> {
    let mut cases = Vec::new();
    for count in COUNTS {
        for (place, point) in POINTS {
            for (side, normal) in NORMALS {
                let name = format!("light/selection/{count}/{place}/{side}");
                cases.push(selection(name, count, point, normal, pmf));
            }
        }
    }
    cases
}

/// The light that is chosen at a point, against its probability.
pub fn selection(name: String, count: usize, point: Vec3, normal: Option<Vec3>, pmf: Pmf) -> Case {
    Case::of(name, Discrete { outcomes: count }, move || {
        let lights = Lights::new(lights(count), 1);
        let tree = LightTree::new(&lights.all.iter().filter_map(SampledLight::bounds).collect::<Vec<_>>());
        let choose = move |[u]: &[[Lane; 2]; 1], count: usize| {
            let mut chosen = [NONE; LANES];
            let mut probability = u[0];
            if let Some(selection) = lights.selection(point, normal) {
                for start in (0..count).step_by(BLOCK) {
                    let block = start..count.min(start + BLOCK);
                    let (light, p) = (&mut chosen[block.clone()], &mut probability[block]);
                    LightTreeAt::sample_each(&[selection; BLOCK], light, p);
                }
            }
            let of_lane = |i: usize| {
                let sample = Sample::with_pdf(chosen[i] as usize, f64::from(probability[i]));
                (chosen[i] != NONE).then_some(sample)
            };
            (0..count).map(of_lane).collect()
        };
        let pmf = move |light: usize| f64::from(pmf(&tree, point, normal, light as u32));
        (in_lanes(choose), density(pmf).with_mass(Mass::AtMostOne))
    })
}

/// `count` lights of all shapes in the unit cube, with sizes and powers over two orders of magnitude.
fn lights(count: usize) -> Vec<SampledLight> {
    let random = |i: usize, dimension| Independent::new(1, 0, i as u32).pair(dimension).map(|u| u as f32);
    let (scene, _) = builtin::furnace();
    let mut scene = Scene { objects: Vec::new(), lights: Vec::new(), environment: None, ..scene };
    for i in 0..count {
        let ([x, y], [z, size], [power, turn]) = (random(i, 0), random(i, 1), random(i, 2));
        let (centre, size) = (Vec3::new(x, y, z), 0.1 * 0.01f32.powf(size));
        let radiance = Rgb::splat(0.01f32.powf(power));
        let side = size * Vec3::new(turn.cos(), turn.sin(), 0.0);
        let shape = match i % 4 {
            0 => Some(Shape::Sphere(Sphere { centre, radius: size })),
            1 => Rectangle::new(centre, side, size * Vec3::Z).map(Shape::Rectangle),
            2 => {
                let corners = vec![centre, centre + side, centre + size * Vec3::Z];
                Mesh::new(corners, Vec::new(), vec![[0, 1, 2]]).ok().map(|mesh| Shape::Mesh(Arc::new(mesh)))
            }
            _ => None,
        };
        let visibility = EmitterVisibility::Sampled;
        let emission = Some(Emission { radiance, two_sided: i % 8 < 4, visibility });
        let falloff = Falloff::InverseSquare;
        match shape {
            Some(shape) => {
                scene.objects.push(Object { emission, ..Object::new(shape, Material::Diffuse { albedo: Rgb::ZERO }) });
            }
            None => scene.lights.push(Light::Point { position: centre, intensity: radiance * size * size, falloff }),
        }
    }
    SampledLight::all(&scene, &Settings::default(), &[])
}
