//! Shadow rays end in front of lights, and shapes are found the same way in the tree and one by one.

use super::*;
use crate::lanes::set;
use crate::light_sample::SampleLight;
use crate::lights::SampledLight;
use crate::settings::Settings;
use crate::solids::AxisAlignedRectangle;
use etalon_core::math::Rgb;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::scene::{Camera, Emission, Material, Mesh, Projection, Rectangle, Sphere};
use glam::DVec3;

fn random(i: u64, j: u64) -> f32 {
    (2.0 * Independent::new(5, i, j as u32).pair(0)[0] - 1.0) as f32
}

fn random_vec(i: u64, j: u64) -> Vec3 {
    Vec3::new(random(i, 3 * j), random(i, 3 * j + 1), random(i, 3 * j + 2))
}

/// The shapes of a scene, outside of the tree where that is possible, and all in it.
fn both(scene: &Scene) -> [Geometry<'_>; 2] {
    [true, false].map(|alone| Geometry::prepare(scene, true, &vec![alone; scene.objects.len()]))
}

/// Shapes that emit light, and nothing else.
fn scene(shapes: impl IntoIterator<Item = Shape>) -> Scene {
    let projection = Projection::Perspective { tan_half_width: 1.0, tan_half_height: 1.0 };
    let emission = Some(Emission::of_front(Rgb::ONE));
    let object = |shape| Object { emission, ..Object::new(shape, Material::Diffuse { albedo: Rgb::ONE }) };
    Scene {
        name: String::new(),
        camera: Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, projection).unwrap(),
        objects: shapes.into_iter().map(object).collect(),
        lights: Vec::new(),
        environment: None,
    }
}

#[test]
fn lights_do_not_occlude_their_own_samples() {
    let mut traced = 0;
    for i in 0..400u64 {
        // Lights of sizes over four powers of ten, near the origin and far from it.
        let size = 10f32.powf(2.0 * random(i, 0));
        let centre = [0.0, 1.0, 100.0][i as usize % 3] * size * random_vec(i, 1);
        let (x, y) = random_vec(i, 2).normalize().any_orthonormal_pair();
        let (x, y) = (size * x, random(i, 10).abs().max(0.01) * size * y);
        let shape = match i % 3 {
            0 => Shape::Rectangle(Rectangle::new(centre, x, y).unwrap()),
            1 => Shape::Sphere(Sphere { centre, radius: size }),
            _ => {
                let corners = vec![centre - x, centre + x, centre + y];
                Mesh::new(corners, Vec::new(), vec![[0, 1, 2]]).unwrap().into()
            }
        };
        let scene = scene([shape]);
        let light = &SampledLight::all(&scene, &Settings::default(), &[])[0];
        let (mut rays, mut distance) = (Rays::default(), [0.0; LANES]);
        for k in 0..LANES {
            let j = 10 + 10 * k as u64;
            // From all around it at distances over eight powers of ten, every other one from close to the plane of the
            // rectangle, or to the tangent plane of the sphere.
            let start = light.point([0.5 + 0.5 * random(i, j), 0.5 + 0.5 * random(i, j + 1)]).unwrap();
            let aside = random_vec(i, j + 1).reject_from(start.normal) * 10f32.powf(random(i, j + 6)) * size;
            let height = size * 10f32.powf(4.0 * random(i, j + 7) - 2.0);
            let point = start.position + height * start.normal + if k % 2 == 0 { aside } else { Vec3::ZERO };
            let sample = light.sample(point, [0.5 + 0.5 * random(i, j + 8), 0.5 + 0.5 * random(i, j + 9)]);
            // The ray leaves a surface of any orientation.
            let offset = 16.0 * f32::EPSILON * point.abs().max_element();
            let origin = point + offset * random_vec(i, j + 3).normalize();
            set(&mut rays.origin, k, origin);
            set(&mut rays.direction, k, sample.wi);
            distance[k] = if sample.weight == Rgb::ZERO { 0.0 } else { sample.distance };
        }
        for geometry in both(&scene) {
            let mut t_max = distance;
            for k in 0..LANES {
                t_max[k] = light.t_max(rays.at(k), distance[k]);
            }
            let mut blocked = [0; LANES];
            geometry.occluded(&rays, LANES, &t_max, &mut blocked);
            for k in 0..LANES {
                let ray = (at(&rays.origin, k), at(&rays.direction, k), distance[k], t_max[k]);
                assert_eq!(blocked[k], 0, "{i} {k} {ray:?} {:?}", scene.objects[0].shape);
                traced += u32::from(t_max[k] > 0.99 * distance[k]);
            }
        }
    }
    assert!(traced > 100_000, "{traced}");
}

/// A few walls, spheres and a mesh.
fn mixture() -> Vec<Shape> {
    let mut shapes = vec![Shape::from(etalon_core::scene::statue::statue())];
    for i in 0..30 {
        let centre = 2.0 * random_vec(i, 0) + Vec3::new(0.0, 0.5, 0.0);
        let normal = [Vec3::X, Vec3::Y, Vec3::Z, random_vec(i, 1).normalize()][i as usize / 3 % 4];
        let (x, y) = normal.any_orthonormal_pair();
        shapes.push(if i % 3 == 0 {
            Shape::Rectangle(Rectangle::new(centre, 0.5 * x, 0.3 * y).unwrap())
        } else {
            Shape::Sphere(Sphere { centre, radius: 0.2 + 0.1 * random(i, 9) })
        });
    }
    shapes
}

#[test]
fn the_tree_finds_what_one_by_one_is_found() {
    let scene = scene(mixture());
    let [few, many] = both(&scene);
    assert!(few.solids.len() == 30 && many.solids.is_empty());
    // Upright walls of all axes and tilted ones
    let mut kinds = [0; 4];
    for object in &scene.objects {
        if let Shape::Rectangle(r) = &object.shape {
            let axes = [
                AxisAlignedRectangle::<0>::new(r).is_some(),
                AxisAlignedRectangle::<1>::new(r).is_some(),
                AxisAlignedRectangle::<2>::new(r).is_some(),
            ];
            kinds[axes.iter().position(|is_axis| *is_axis).unwrap_or(3)] += 1;
        }
    }
    assert!(!kinds.contains(&0), "{kinds:?}");
    let (mut found, mut differing) = ([0; 3], 0);
    for batch in 0..40 {
        let mut rays = Rays::default();
        for k in 0..LANES {
            let i = 1000 + batch * LANES as u64 + k as u64;
            let origin = 3.0 * random_vec(i, 0);
            set(&mut rays.origin, k, origin);
            set(&mut rays.direction, k, (random_vec(i, 1) - origin).normalize());
        }
        let (mut a, mut b) = (Hits::default(), Hits::default());
        few.nearest(&rays, LANES, &mut a);
        many.nearest(&rays, LANES, &mut b);
        let t_max = [1.0; LANES];
        let mut blocked = [[0; LANES]; 2];
        few.occluded(&rays, LANES, &t_max, &mut blocked[0]);
        many.occluded(&rays, LANES, &t_max, &mut blocked[1]);
        for k in 0..LANES {
            // At an edge rounding decides.
            if a.object[k] != b.object[k] || blocked[0][k] != blocked[1][k] {
                differing += 1;
            } else if a.object[k] != NONE {
                let (one, other) = (few.surface(&rays, &a, k), many.surface(&rays, &b, k));
                assert!(one.position.distance(other.position) < 1e-5, "{one:?} {other:?}");
                assert!(one.normal.distance(other.normal) < 1e-4);
                match &scene.objects[a.object[k] as usize].shape {
                    Shape::Sphere(_) => {
                        assert_eq!(a.t[k].to_bits(), b.t[k].to_bits());
                        found[0] += 1;
                    }
                    Shape::Rectangle(_) => found[1] += 1,
                    Shape::Mesh(mesh) => {
                        let [one, other] = [few.triangle(&a, k), many.triangle(&b, k)];
                        assert_eq!(one, other);
                        let surface = mesh.surface(one, a.u[k], a.v[k]).unwrap();
                        assert!(surface.point.distance(few.surface(&rays, &a, k).position) < 1e-6);
                        found[2] += 1;
                    }
                }
            }
        }
    }
    assert!(differing < 5 && found.iter().all(|&count| count > 100), "{differing} {found:?}");
}

/// Rays from above at a sphere whose axis is tilted, a rectangle, a triangle with texture coordinates and one without.
#[test]
fn tangents_follow_the_parametrization_of_the_shape() {
    let centre = |i: usize| Vec3::new(3.0 * i as f32, 0.0, 0.0);
    let corners = |i: usize| vec![centre(i) - Vec3::X + Vec3::Z, centre(i) + Vec3::X + Vec3::Z, centre(i) - Vec3::Z];
    let plain = |i: usize| Mesh::new(corners(i), Vec::new(), vec![[0, 1, 2]]).unwrap();
    // u grows towards −z.
    let uv = vec![[glam::Vec2::ZERO, glam::Vec2::Y, glam::Vec2::new(1.0, 0.5)]];
    let side = Vec3::new(0.6, 0.0, 0.8);
    let mut scene = scene([
        Shape::Sphere(Sphere { centre: centre(0), radius: 1.0 }),
        Shape::Rectangle(Rectangle::new(centre(1), 0.5 * side, Vec3::Y.cross(side)).unwrap()),
        Mesh { uv, ..plain(2) }.into(),
        plain(3).into(),
    ]);
    scene.objects[0].axis = Vec3::new(0.0, 0.6, 0.8);
    for geometry in both(&scene) {
        let (mut rays, mut hits) = (Rays::default(), Hits::default());
        let aside = Vec3::new(0.3, 0.0, 0.2);
        for i in 0..4 {
            set(&mut rays.origin, i, centre(i) + aside + 2.0 * Vec3::Y);
            set(&mut rays.direction, i, Vec3::NEG_Y);
        }
        geometry.nearest(&rays, 4, &mut hits);
        let tangent = |i: usize| {
            let normal = geometry.surface(&rays, &hits, i).normal;
            let tangent = geometry.tangent(&hits, i, normal);
            assert!(tangent.dot(normal).abs() < 1e-6, "{i}: {tangent}");
            tangent.normalize_or_zero()
        };
        // On the sphere, a turn by a small angle around its axis moves the point along the tangent.
        let at = geometry.surface(&rays, &hits, 0).position;
        let turned = glam::Quat::from_axis_angle(scene.objects[0].axis, 1e-2) * at;
        assert!((turned - at).normalize().distance(tangent(0)) < 1e-2);
        let (on_rectangle, on_mesh) = (tangent(1), tangent(2));
        let is_near = on_rectangle.distance(side) < 1e-6 && on_mesh.distance(Vec3::NEG_Z) < 1e-6;
        assert!(is_near, "{on_rectangle} {on_mesh}");
        assert_eq!(tangent(3), Vec3::ZERO);
    }
}

#[test]
fn surfaces_have_the_texture_coordinates_of_their_parametrization() {
    let rectangle = Rectangle::new(Vec3::new(0.0, 0.0, -3.0), 2.0 * Vec3::X, Vec3::Y).unwrap();
    let corners = vec![Vec3::new(-1.0, -1.0, -3.0), Vec3::new(3.0, -1.0, -3.0), Vec3::new(3.0, 3.0, -3.0)];
    let mesh = Mesh::new(corners, Vec::new(), vec![[0, 1, 2]]).unwrap();
    let uv = vec![[glam::Vec2::new(2.0, 0.0), glam::Vec2::new(2.0, 4.0), glam::Vec2::new(6.0, 4.0)]];
    let sphere = Shape::Sphere(Sphere { centre: Vec3::ZERO, radius: 2.0 });
    let found = |shape: Shape, origin: Vec3, direction: Vec3| {
        let mut scene = scene([shape]);
        // z of object space is y of the world, x is z, and y is x.
        (scene.objects[0].axis, scene.objects[0].meridians) = (Vec3::Y, [Vec3::Z, Vec3::X]);
        let geometry = Geometry::new(&scene, true);
        let (mut rays, mut hits) = (Rays::default(), Hits::default());
        set(&mut rays.origin, 0, origin);
        set(&mut rays.direction, 0, direction.normalize());
        geometry.nearest(&rays, 1, &mut hits);
        assert_eq!(hits.object[0], 0);
        geometry.uv(&hits, 0, geometry.surface(&rays, &hits, 0).position)
    };
    let near = |found: glam::Vec2, u: f32, v: f32| {
        assert!((found - glam::Vec2::new(u, v)).abs().max_element() < 1e-5, "{found}, not {u} {v}");
    };
    near(found(Shape::Rectangle(rectangle), Vec3::new(1.0, 0.5, 0.0), Vec3::NEG_Z), 0.75, 0.75);
    near(found(mesh.clone().into(), Vec3::new(2.0, 0.0, 0.0), Vec3::NEG_Z), 0.75, 0.25);
    near(found(Mesh { uv, ..mesh }.into(), Vec3::new(2.0, 0.0, 0.0), Vec3::NEG_Z), 3.0, 3.0);
    for (from, u, v) in [
        (Vec3::Z, 0.0, 0.5),
        (Vec3::X, 0.25, 0.5),
        (Vec3::NEG_Z, 0.5, 0.5),
        (Vec3::NEG_X, 0.75, 0.5),
        (Vec3::new(1.0, 1.0, 0.0).normalize(), 0.25, 0.75),
        (Vec3::new(0.0, -(0.75f32.sqrt()), -0.5), 0.5, 1.0 / 6.0),
    ] {
        near(found(sphere.clone(), 5.0 * from, -from), u, v);
        // The same from inside.
        near(found(sphere.clone(), Vec3::ZERO, from), u, v);
    }
}
