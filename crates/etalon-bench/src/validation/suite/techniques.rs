//! Images by light tracing, light and BSDF sampling combined against those without light tracing, images by adaptive
//! sampling against those with as many paths in all pixels, and images by the kernel in lanes against those of the reference.
//!
//! A wrong MIS weight in one place changes no pdf, but the image. The lights are broad, so that the images have little
//! noise: the tests with light tracing detect biases of a quarter of what the others detect, by default 0.5 % of the
//! image.

use super::super::case::Case;
use super::renders::{RenderTest, Truth, finer};
use etalon_core::envmap::EnvMap;
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_core::scene::{
    Camera, Conductor, Dielectric, Distribution, Emission, EmitterVisibility, Environment, Material, Mesh, Object,
    Projection, Rectangle, Request, Scene, Shape, Sphere,
};
use etalon_render::{Kernel, Sampling, Settings};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Share of the detectable error of other tests that these detect.
pub const FINE: f64 = 0.25;

fn rectangle(centre: Vec3, half: [Vec3; 2], material: Material) -> Object {
    let rectangle = Rectangle::new(centre, half[0], half[1]).expect("the sides are perpendicular");
    Object::new(Shape::Rectangle(rectangle), material)
}

fn sphere(x: f32, radius: f32, material: Material) -> Object {
    Object::new(Shape::Sphere(Sphere { centre: Vec3::new(x, radius + 0.05, 0.0), radius }), material)
}

fn diffuse(albedo: f32) -> Material {
    Material::Diffuse { albedo: Rgb::splat(albedo) }
}

fn metal(alpha: f32, distribution: Distribution) -> Material {
    let (eta, k) = (Rgb::splat(0.2), Rgb::splat(3.0));
    Material::Conductor(Conductor { two_sided: true, ..Conductor::new(eta, k, alpha, distribution) })
}

const GLASS: Material = Material::Dielectric(Dielectric::clear(1.5));
const MIRROR: Material = Material::Mirror { reflectance: Rgb::ONE };

/// A surface that emits.
fn emitting(object: Object, radiance: f32) -> Object {
    let visibility = EmitterVisibility::Sampled;
    Object { emission: Some(Emission { radiance: Rgb::splat(radiance), two_sided: false, visibility }), ..object }
}

/// A light of 2 by 2 above the floor.
fn ceiling() -> Object {
    emitting(rectangle(Vec3::new(-0.5, 2.0, 0.0), [Vec3::X, Vec3::Z], diffuse(0.0)), 1.0)
}

fn bulb(x: f32, z: f32, radius: f32, radiance: f32) -> Object {
    // Above what the camera sees.
    let centre = Vec3::new(x, 2.4, z);
    emitting(Object::new(Shape::Sphere(Sphere { centre, radius }), diffuse(0.0)), radiance)
}

/// An octahedron of a material with the normals of a sphere, which are far from those of its triangles.
fn rounded(x: f32, material: Material) -> Object {
    let corners = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let facet = |i: u32| {
        let (a, b, c) = (i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2));
        if (a + b + c) % 2 == 0 { [a, b, c] } else { [a, c, b] }
    };
    let positions = corners.map(|corner| Vec3::new(x, 0.65, 0.0) + 0.6 * corner).to_vec();
    let mesh = Mesh { positions, normals: corners.to_vec(), triangles: (0..8).map(facet).collect(), ..Mesh::default() };
    Object::new(Shape::Mesh(Arc::new(mesh)), material)
}

/// A camera above the middle of a diffuse floor with a wall behind it.
fn room(objects: impl IntoIterator<Item = Object>, environment: Option<Environment>) -> Scene {
    let projection = Projection::Perspective { tan_half_width: 0.4, tan_half_height: 0.4 };
    let camera = Camera::look_at(DVec3::new(0.0, 2.5, 2.5), DVec3::new(0.0, 0.2, 0.0), DVec3::Y, projection);
    let camera = camera.expect("the camera does not look up");
    let floor = rectangle(Vec3::ZERO, [2.0 * Vec3::Z, 2.0 * Vec3::X], diffuse(0.5));
    let wall = rectangle(Vec3::new(0.0, 2.0, -2.0), [2.0 * Vec3::X, 2.0 * Vec3::Y], diffuse(0.8));
    let objects = [floor, wall].into_iter().chain(objects).collect();
    Scene { name: "room".into(), camera, objects, lights: Vec::new(), environment }
}

/// Glass and a mirror under a large area light: most of the caustics are found by light tracing.
pub fn glass_and_mirror() -> Scene {
    room([ceiling(), sphere(0.5, 0.45, GLASS), sphere(-0.5, 0.45, MIRROR)], None)
}

/// Rough metals under a large area light: all techniques find part of the caustics.
pub fn rough_metal() -> Scene {
    let (beckmann, ggx) = (metal(0.3, Distribution::Beckmann), metal(0.2, Distribution::Ggx));
    room([ceiling(), sphere(0.5, 0.45, beckmann), sphere(-0.5, 0.45, ggx)], None)
}

/// Twelve spheres of light over glass and rough metal.
pub fn many_lights() -> Scene {
    let many = (0..12u8).map(|i| bulb(f32::from(i % 4) - 1.5, f32::from(i / 4) - 1.0, 0.3, 1.0));
    room(many.chain([sphere(0.5, 0.45, GLASS), sphere(-0.5, 0.45, metal(0.2, Distribution::Ggx))]), None)
}

/// The scenes, with their names in the names of tests.
fn scenes() -> Vec<(&'static str, Scene)> {
    let texel = |x: usize, y: usize| Rgb::splat(if (x, y) == (5, 2) { 40.0 } else { 1.0 });
    let sky = Environment::upright(Arc::new(EnvMap::new(Image::from_fn(16, 8, texel))), "sun", 1.0);
    let (beckmann, ggx) = (metal(0.3, Distribution::Beckmann), metal(0.2, Distribution::Ggx));
    vec![
        ("glass-and-mirror", glass_and_mirror()),
        ("rough-metal", rough_metal()),
        ("shading-normals", room([ceiling(), rounded(0.7, ggx.clone()), rounded(-0.6, diffuse(0.8))], None)),
        ("sphere-lights", room([bulb(-0.6, 0.3, 0.5, 2.0), bulb(1.0, 0.0, 0.4, 1.0), sphere(0.0, 0.5, GLASS)], None)),
        ("sun", room([sphere(0.5, 0.45, GLASS), sphere(-0.5, 0.45, beckmann)], Some(sky))),
        ("many-lights", many_lights()),
    ]
}

/// The image of a scene by these settings, compared with that by others. Every hit takes two light samples.
pub fn image(scene: Scene, settings: Settings, other: Settings) -> RenderTest {
    let request = Request { width: 20, height: 20, spp: 1, light_samples: 2, max_depth: 4 };
    RenderTest { scene, request, settings, truth: Truth::SameAs(other), plant: None }
}

/// The image of a scene by adaptive sampling, compared with that by as many paths in all pixels.
pub fn adaptive_image(scene: Scene) -> RenderTest {
    let uniform = Settings { sampling: Sampling::MisLt, ..Settings::default() };
    image(scene, Settings { adaptive: true, ..uniform }, uniform)
}

pub fn cases() -> Vec<Case> {
    let by = |sampling| Settings { sampling, ..Settings::default() };
    let reference = Settings { kernel: Kernel::Reference, ..by(Sampling::Mis) };
    let mut tests = Vec::new();
    for (name, scene) in scenes() {
        if matches!(name, "glass-and-mirror" | "many-lights") {
            // Unit tests compare the two sample by sample.
            let test = image(scene.clone(), by(Sampling::Mis), reference);
            tests.push((format!("render/reference/{name}"), test, 1.0));
            tests.push((format!("render/adaptive/{name}"), adaptive_image(scene.clone()), 1.0));
        }
        tests.push((format!("render/mis+lt/{name}"), image(scene, by(Sampling::MisLt), by(Sampling::Mis)), FINE));
    }
    let case = |(name, test, share): (String, RenderTest, f64)| {
        Case::new(name, move |protocol, round| test.examine(&finer(protocol, share), round, |_| ()))
    };
    tests.into_iter().map(case).collect()
}
