//! The built-in scenes.

use super::statue::statue;
use super::{
    Camera, Conductor, Dielectric, Distribution, Emission, Environment, Material, Mesh, Object, PixelFilter,
    Projection, Rectangle, Request, Scene, Shape, Sphere,
};
use crate::envmap::EnvMap;
use crate::error::{Error, Result};
use crate::math::Rgb;
use crate::optics::metals::{self, Metal};
use crate::raster::Image;
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::TAU;
use std::sync::Arc;

/// A camera that looks along −z, +y upwards.
fn along_minus_z(position: DVec3, projection: Projection) -> Camera {
    let filter = PixelFilter::default();
    Camera { position, right: DVec3::X, up: DVec3::Y, forward: DVec3::NEG_Z, projection, filter }
}

/// The first report's scene: a white diffuse unit sphere in an environment scaled by 8, in orthographic projection along −z
/// from the plane z = 1 that touches it.
pub fn sphere_env(environment: Environment) -> (Scene, Request) {
    let camera = along_minus_z(DVec3::Z, Projection::Orthographic { half_width: 1.0, half_height: 1.0 });
    let sphere = Shape::Sphere(Sphere { centre: Vec3::ZERO, radius: 1.0 });
    let objects = vec![Object::new(sphere, Material::Diffuse { albedo: Rgb::ONE })];
    let scene =
        Scene { name: "sphere-env".into(), camera, objects, lights: Vec::new(), environment: Some(environment) };
    (scene, Request { width: 511, height: 511, spp: 16, light_samples: 4, max_depth: 1 })
}

/// How much the first report's scene brightens its map.
pub const SPHERE_ENV_SCALE: f32 = 8.0;

/// The second report's Cornell box, open to the camera: 2 wide, 1.5 high, 2 deep, with an area light under the ceiling.
fn cornell(name: &str, contents: Vec<Object>) -> (Scene, Request) {
    const WHITE: Rgb = Rgb::splat(0.6);
    const RED: Rgb = Rgb::new(0.6, 0.2, 0.2);
    const BLUE: Rgb = Rgb::new(0.2, 0.2, 0.6);
    let wall = |centre: [f32; 3], x: Vec3, y: Vec3, albedo: Rgb| {
        let rectangle = Rectangle::new(Vec3::from(centre), x, y).expect("the sides are perpendicular");
        Object::new(Shape::Rectangle(rectangle), Material::Diffuse { albedo })
    };
    let (x, y, z) = (Vec3::X, 0.75 * Vec3::Y, Vec3::Z);
    let mut objects = vec![
        wall([0.0, 0.0, 0.0], z, x, WHITE),
        wall([0.0, 1.5, 0.0], x, z, WHITE),
        wall([0.0, 0.75, -1.0], x, y, WHITE),
        wall([-1.0, 0.75, 0.0], y, z, RED),
        wall([1.0, 0.75, 0.0], z, y, BLUE),
        Object {
            emission: Some(Emission::of_front(Rgb::splat(10.0))),
            ..wall([0.0, 1.49, 0.0], 0.4 * x, 0.3 * z, Rgb::ZERO)
        },
    ];
    objects.extend(contents);
    // The reference renderer keeps the distance of the film, so that the image's size sets the field of view.
    let (width, height, film_distance) = (480, 360, 875.0);
    let [tan_half_width, tan_half_height] = [width, height].map(|side| 0.5 * side as f64 / film_distance);
    let projection = Projection::Perspective { tan_half_width, tan_half_height };
    let camera = along_minus_z(DVec3::new(0.0, 0.75, 4.802_343_57), projection);
    let scene = Scene { name: name.into(), camera, objects, lights: Vec::new(), environment: None };
    (scene, Request { width, height, spp: 64, light_samples: 4, max_depth: 5 })
}

/// The two spheres of the second report in its box: the left one behind, the right one in front.
fn spheres(left: Material, right: Material) -> Vec<Object> {
    let sphere = |x: f32, z: f32, material| {
        Object::new(Shape::Sphere(Sphere { centre: Vec3::new(x, 0.3, z), radius: 0.3 }), material)
    };
    vec![sphere(-0.4, -0.3, left), sphere(0.4, 0.3, right)]
}

/// The second report's first scene: a mirror sphere and a glass sphere.
pub fn cornell_spheres() -> (Scene, Request) {
    let mirror = Material::Mirror { reflectance: Rgb::ONE };
    let glass = Material::Dielectric(Dielectric::clear(1.45));
    cornell("cornell-spheres", spheres(mirror, glass))
}

/// The same with diffuse spheres.
pub fn cornell_lambert() -> (Scene, Request) {
    let white = Material::Diffuse { albedo: Rgb::splat(0.6) };
    cornell("cornell-lambert", spheres(white.clone(), white))
}

/// A statue of metal in the same box: the built-in one, or another mesh in its place.
///
/// # Errors
/// That of [`Mesh::fitted`].
pub fn cornell_statue(metal: &Metal, alpha: f32, mesh: Option<Mesh>) -> Result<(Scene, Request)> {
    // A mesh of the user may have the corners of its triangles in either order.
    let two_sided = mesh.is_some();
    let mesh = match mesh {
        Some(mesh) => mesh.fitted(Vec3::ZERO, STATUE_BOX)?,
        None => statue(),
    };
    let conductor = Conductor::new(metal.eta_rgb(), metal.k_rgb(), alpha, Distribution::Beckmann);
    let material = Material::Conductor(Conductor { two_sided, ..conductor });
    Ok(cornell(&statue_name(metal), vec![Object::new(Shape::Mesh(Arc::new(mesh)), material)]))
}

/// Where a statue stands, on the middle of the floor: width, height and depth.
const STATUE_BOX: Vec3 = Vec3::new(1.1, 1.0, 1.1);

/// A white furnace: light of radiance 1 from everywhere on a white diffuse sphere, a mirror, glass, and a rough metal
/// that reflects everything. Diffuse and glass sphere must vanish before the background. The metal is darker (0.891): a
/// model of single scattering loses the light that meets a second facet. The mirror (0.996) would vanish if it did not
/// show the metal.
pub fn furnace() -> (Scene, Request) {
    let map = EnvMap::new(Image::from_fn(4, 2, |_, _| Rgb::ONE));
    let environment = Environment::upright(Arc::new(map), "constant", 1.0);
    let perfect = Conductor::new(Rgb::ZERO, Rgb::ONE, 0.5, Distribution::Beckmann);
    let materials = [
        Material::Diffuse { albedo: Rgb::ONE },
        Material::Mirror { reflectance: Rgb::ONE },
        Material::Dielectric(Dielectric::clear(1.45)),
        Material::Conductor(perfect),
    ];
    let sphere = |(i, material): (usize, Material)| {
        let sphere = Sphere { centre: Vec3::new(2.25 * i as f32 - 3.375, 0.0, 0.0), radius: 1.0 };
        Object::new(Shape::Sphere(sphere), material)
    };
    let projection = Projection::Orthographic { half_width: 4.8, half_height: 1.2 };
    let camera = along_minus_z(DVec3::new(0.0, 0.0, 20.0), projection);
    let objects = materials.into_iter().enumerate().map(sphere).collect();
    let scene = Scene { name: "furnace".into(), camera, objects, lights: Vec::new(), environment: Some(environment) };
    (scene, Request { width: 480, height: 120, spp: 64, light_samples: 1, max_depth: 100 })
}

/// Brushed copper under a map and two small area lights: a disc with circular grooves, like the bottom of a pan, and a sphere
/// whose grooves run around its vertical axis. Along the grooves the microfacets' normals vary less than across.
pub fn brushed_metal(environment: Environment) -> (Scene, Request) {
    let copper = Conductor::new(metals::COPPER.eta_rgb(), metals::COPPER.k_rgb(), 0.0, Distribution::Ggx);
    let metal = Material::Conductor(Conductor { alpha: [0.05, 0.4], ..copper });
    let rectangle = |centre: Vec3, x: Vec3, y: Vec3| {
        Shape::Rectangle(Rectangle::new(centre, x, y).expect("the sides are perpendicular"))
    };
    let light = |x: f32| Object {
        emission: Some(Emission::of_front(Rgb::splat(60.0))),
        ..Object::new(
            rectangle(Vec3::new(x, 3.0, 3.0), 0.15 * Vec3::X, 0.15 * Vec3::Z),
            Material::Diffuse { albedo: Rgb::ZERO },
        )
    };
    let sphere = Shape::Sphere(Sphere { centre: Vec3::new(1.1, 1.0, 0.0), radius: 1.0 });
    let floor = rectangle(Vec3::ZERO, 4.0 * Vec3::Z, 4.0 * Vec3::X);
    let objects = vec![
        Object::new(floor, Material::Diffuse { albedo: Rgb::splat(0.3) }),
        Object::new(disc(Vec3::new(-1.1, 1.0, 0.0), Vec3::new(0.0, 0.28, 0.96)).into(), metal.clone()),
        Object { axis: Vec3::Y, ..Object::new(sphere, metal) },
        light(-1.5),
        light(1.5),
    ];
    let projection = Projection::Perspective { tan_half_width: 0.4, tan_half_height: 0.2 };
    let camera = along_minus_z(DVec3::new(0.0, 1.1, 6.0), projection);
    let (name, lights) = ("brushed-metal".into(), Vec::new());
    let scene = Scene { name, camera, objects, lights, environment: Some(environment) };
    (scene, Request { width: 480, height: 240, spp: 64, light_samples: 1, max_depth: 5 })
}

/// How much that scene brightens its map.
pub const BRUSHED_METAL_SCALE: f32 = 4.0;

/// A disc of radius 1 about a unit normal, whose texture coordinate u is the angle around the centre.
fn disc(centre: Vec3, normal: Vec3) -> Mesh {
    const SIDES: u32 = 720;
    let (x, y) = normal.any_orthonormal_pair();
    let on_rim = |i: u32| {
        let (sin, cos) = (i as f32 / SIDES as f32 * TAU).sin_cos();
        centre + x * cos + y * sin
    };
    let positions = std::iter::once(centre).chain((0..SIDES).map(on_rim)).collect();
    let triangles = (0..SIDES).map(|i| [0, 1 + i, 1 + (i + 1) % SIDES]).collect();
    let uv = vec![[Vec2::new(0.5, 0.0), Vec2::new(0.0, 1.0), Vec2::ONE]; SIDES as usize];
    Mesh { positions, normals: Vec::new(), triangles, uv }
}

/// What makes a built-in scene.
#[derive(Debug, Clone, Copy)]
enum Maker {
    /// It needs an environment map, which it brightens by this factor.
    UnderMap(fn(Environment) -> (Scene, Request), f32),
    Complete(fn() -> (Scene, Request)),
    /// A statue of that metal, in the Cornell box.
    Statue(&'static Metal),
}

#[derive(Debug, Clone)]
pub struct BuiltIn {
    /// How the command line calls it.
    pub name: String,
    /// What it shows, in one line.
    pub doc: String,
    maker: Maker,
}

/// The registry of built-in scenes: one entry each, and a statue of every metal.
pub fn scenes() -> Vec<BuiltIn> {
    let scene = |name: &str, doc: &str, maker| BuiltIn { name: name.into(), doc: doc.into(), maker };
    let mut scenes = vec![
        scene(
            "sphere-env",
            "white diffuse sphere under an environment map (the first report)",
            Maker::UnderMap(sphere_env, SPHERE_ENV_SCALE),
        ),
        scene(
            "cornell-spheres",
            "mirror and glass sphere in a Cornell box with an area light (the second report)",
            Maker::Complete(cornell_spheres),
        ),
        scene("cornell-lambert", "the same with diffuse spheres", Maker::Complete(cornell_lambert)),
    ];
    scenes.extend(metals::METALS.iter().map(|metal| BuiltIn {
        name: statue_name(metal),
        doc: format!("statue of {} in the same box, 98,976 triangles, alpha {}", metal.name, statue_alpha(metal)),
        maker: Maker::Statue(metal),
    }));
    scenes.push(scene(
        "furnace",
        "diffuse, mirror, glass and metal spheres in light of radiance 1 from everywhere: diffuse and glass must vanish \
         (1); metal is darker (0.891), as single scattering loses energy; the mirror shows the metal (0.996)",
        Maker::Complete(furnace),
    ));
    scenes.push(scene(
        "brushed-metal",
        "disc and sphere of brushed copper (alpha 0.05 along the grooves, 0.4 across) under an environment map and two area \
         lights",
        Maker::UnderMap(brushed_metal, BRUSHED_METAL_SCALE),
    ));
    scenes
}

fn statue_name(metal: &Metal) -> String {
    format!("cornell-statue-{}", metal.symbol.to_lowercase())
}

/// The roughness of a metal's statue: copper and iron as in the second report's images, all others as its gold.
fn statue_alpha(metal: &Metal) -> f32 {
    match metal.symbol {
        "Cu" => 0.05,
        "Fe" => 0.5,
        _ => 0.25,
    }
}

pub fn find(name: &str) -> Option<BuiltIn> {
    scenes().into_iter().find(|scene| scene.name == name)
}

/// The scenes under an environment map, each with what it multiplies the map's radiance by: "sphere-env by 8, …".
pub fn map_scales() -> String {
    let of = |scene: &BuiltIn| Some(format!("{} by {}", scene.name, scene.map_scale()?));
    scenes().iter().filter_map(of).collect::<Vec<_>>().join(", ")
}

impl BuiltIn {
    /// How much the scene brightens the environment map that [`BuiltIn::make`] needs; `None`: it needs none.
    pub fn map_scale(&self) -> Option<f32> {
        match self.maker {
            Maker::UnderMap(_, scale) => Some(scale),
            Maker::Complete(_) | Maker::Statue(_) => None,
        }
    }

    /// Whether a mesh can take the place of something in it.
    pub fn takes_mesh(&self) -> bool {
        matches!(self.maker, Maker::Statue(_))
    }

    /// Makes the scene under the environment, if it needs one, and with the mesh in place of its statue.
    ///
    /// # Errors
    /// [`Error::Parameter`] when a map is missing, and when a mesh is given that the scene has no place for or that cannot
    /// be fitted.
    pub fn make(&self, environment: Option<Environment>, mesh: Option<Mesh>) -> Result<(Scene, Request)> {
        if mesh.is_some() && !self.takes_mesh() {
            return Err(Error::parameter("mesh", format!("the scene {} has no statue to replace", self.name))
                .with_hint("it takes the place of the statue in the cornell-statue scenes"));
        }
        match (self.maker, environment) {
            (Maker::UnderMap(make, _), Some(environment)) => Ok(make(environment)),
            (Maker::UnderMap(..), None) => {
                Err(Error::parameter("envmap", format!("the scene {} needs an environment map", self.name)))
            }
            (Maker::Complete(make), _) => Ok(make()),
            (Maker::Statue(metal), _) => cornell_statue(metal, statue_alpha(metal), mesh),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_documented_and_can_be_made() {
        for entry in scenes() {
            assert!(entry.doc.len() > 10, "{}", entry.name);
            let map = Arc::new(EnvMap::new(Image::from_fn(4, 2, |_, _| Rgb::ONE)));
            let environment = entry.map_scale().map(|scale| Environment::upright(map, "constant", scale));
            let (scene, request) = entry.make(environment, None).unwrap();
            assert_eq!((scene.name.as_str(), find(&entry.name).unwrap().name), (&*entry.name, entry.name.clone()));
            assert!(request.width * request.height > 0);
        }
        assert!(find("cornell-box").is_none());
        let make = |name: &str, mesh| find(name).unwrap().make(None, mesh);
        assert!(make("furnace", Some(Mesh::default())).is_err() && make("sphere-env", None).is_err());
    }
}
