//! The built-in scenes.

use super::{
    Camera, Emission, Environment, Material, Object, Projection, Rectangle, Request, Role, Scene, Shape, Sphere,
};
use crate::raster::Rgb;
use glam::{DVec3, Vec3};

/// The first report's scene: a white diffuse unit sphere in an environment scaled by 8, seen in parallel along −z
/// from the plane z = 1 that touches it.
#[must_use]
pub fn sphere_env(environment: Environment) -> (Scene, Request) {
    let camera = Camera {
        position: DVec3::Z,
        right: DVec3::X,
        up: DVec3::Y,
        forward: DVec3::NEG_Z,
        projection: Projection::Orthographic { half_width: 1.0, half_height: 1.0 },
    };
    let sphere = Shape::Sphere(Sphere { centre: Vec3::ZERO, radius: 1.0 });
    let objects = vec![Object::new(sphere, Material::Diffuse { albedo: Rgb::ONE })];
    let scene =
        Scene { name: "sphere-env".into(), camera, objects, lights: Vec::new(), environment: Some(environment) };
    (scene, Request { width: 511, height: 511, spp: 16, light_samples: 4, max_depth: 1 })
}

/// How much the first report's scene brightens its map.
pub const SPHERE_ENV_SCALE: f32 = 8.0;

/// The second report's room, seen through its open front: 2 wide, 1.5 high, 2 deep, with a lamp under the ceiling.
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
            emission: Some(Emission { radiance: Rgb::splat(10.0), two_sided: false, role: Role::Lamp }),
            ..wall([0.0, 1.49, 0.0], 0.4 * x, 0.3 * z, Rgb::ZERO)
        },
    ];
    objects.extend(contents);
    // The reference renderer keeps the distance of the film, so that the picture's size sets the field of view.
    let (width, height, film_distance) = (480, 360, 875.0);
    let camera = Camera {
        position: DVec3::new(0.0, 0.75, 4.802_343_57),
        right: DVec3::X,
        up: DVec3::Y,
        forward: DVec3::NEG_Z,
        projection: Projection::Perspective {
            tan_half_width: 0.5 * width as f64 / film_distance,
            tan_half_height: 0.5 * height as f64 / film_distance,
        },
    };
    let scene = Scene { name: name.into(), camera, objects, lights: Vec::new(), environment: None };
    (scene, Request { width, height, spp: 64, light_samples: 4, max_depth: 5 })
}

/// The two balls of the second report in its room: the left one behind, the right one in front.
fn balls(left: Material, right: Material) -> Vec<Object> {
    let ball = |x: f32, z: f32, material| {
        Object::new(Shape::Sphere(Sphere { centre: Vec3::new(x, 0.3, z), radius: 0.3 }), material)
    };
    vec![ball(-0.4, -0.3, left), ball(0.4, 0.3, right)]
}

/// The second report's first scene: a mirror ball and a glass ball.
#[must_use]
pub fn cornell_spheres() -> (Scene, Request) {
    let mirror = Material::Mirror { reflectance: Rgb::ONE };
    let glass = Material::Glass { reflectance: Rgb::ONE, transmittance: Rgb::ONE, eta: 1.45 };
    cornell("cornell-spheres", balls(mirror, glass))
}

/// The same with diffuse balls.
#[must_use]
pub fn cornell_lambert() -> (Scene, Request) {
    let white = Material::Diffuse { albedo: Rgb::splat(0.6) };
    cornell("cornell-lambert", balls(white, white))
}
