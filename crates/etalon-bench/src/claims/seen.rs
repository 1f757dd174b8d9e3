//! What a pixel of a scene shows, by reflection too.

use etalon_core::scene::{Bvh, Material, Object, Ray, Request, Scene, Shape};
use glam::DVec3;

/// What the ray through the centre of a pixel meets, reflected by metals and mirrors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sight {
    pub reflections: u32,
    /// The number of the object; `None` if there is none.
    pub object: Option<usize>,
}

/// What each pixel shows. After four reflections it shows the metal or the mirror itself.
pub fn sights(scene: &Scene, request: &Request) -> Vec<Sight> {
    const REFLECTIONS: u32 = 4;
    let Request { width, height, .. } = *request;
    let bvh = Bvh::build(&scene.objects.iter().map(|object| &object.shape).collect::<Vec<&Shape>>());
    let of_pixel = |i: usize| {
        let at = [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5];
        let mut ray = scene.camera.ray(at[0] / width as f64, at[1] / height as f64);
        let mut reflections = 0;
        loop {
            let Some(hit) = bvh.nearest(&ray, f32::INFINITY) else { return Sight { reflections, object: None } };
            let object = hit.shape as usize;
            let Object { shape, material, .. } = &scene.objects[object];
            let is_reflecting = matches!(material, Material::Mirror { .. } | Material::Conductor(_));
            if !is_reflecting || reflections == REFLECTIONS {
                return Sight { reflections, object: Some(object) };
            }
            let (point, normal, shading) = match shape {
                Shape::Sphere(sphere) => {
                    let point = ray.origin + hit.t * ray.direction;
                    let normal = (point - sphere.centre) / sphere.radius;
                    (point, normal, normal)
                }
                Shape::Rectangle(_) | Shape::Mesh(_) => {
                    let surface = bvh.surface(hit.place, hit.u, hit.v);
                    (surface.point, surface.normal, surface.shading)
                }
            };
            let direction = ray.direction - 2.0 * ray.direction.dot(shading) * shading;
            let offset = 1e-4f32.copysign(direction.dot(normal));
            ray = Ray { origin: point + offset * normal, direction: direction.normalize() };
            reflections += 1;
        }
    };
    (0..width * height).map(of_pixel).collect()
}

/// The object without emission all of whose points lie far in a direction: the ceiling upwards, a wall to its side.
pub fn farthest(scene: &Scene, direction: DVec3) -> Option<usize> {
    let nearest_corner = |object: &Object| {
        let [low, high] = object.shape.bounds()?.map(|corner| corner.as_dvec3() * direction);
        object.emission.is_none().then(|| low.min(high).element_sum())
    };
    let objects = scene.objects.iter().enumerate().filter_map(|(i, object)| Some((i, nearest_corner(object)?)));
    objects.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::scene::builtin;

    #[test]
    fn the_blue_wall_is_on_the_right_and_the_ceiling_above() {
        let (scene, _) = builtin::cornell_lambert();
        let object = |way: DVec3| &scene.objects[farthest(&scene, way).unwrap()];
        let Material::Diffuse { albedo } = object(scene.camera.right).material else { panic!() };
        assert!(albedo.z > albedo.x);
        assert_eq!(object(scene.camera.up).shape.bounds().unwrap().map(|corner| corner.y), [1.5; 2]);
    }

    #[test]
    fn the_mirror_shows_both_walls_on_their_sides() {
        let (scene, request) = builtin::cornell_spheres();
        let request = Request { width: 120, height: 90, ..request };
        let sights = sights(&scene, &request);
        let mean_column = |way: DVec3| {
            let wall = Sight { reflections: 1, object: farthest(&scene, way) };
            let columns: Vec<f64> =
                (0..sights.len()).filter(|&i| sights[i] == wall).map(|i| (i % 120) as f64).collect();
            columns.iter().sum::<f64>() / columns.len() as f64
        };
        assert!(mean_column(-scene.camera.right) < mean_column(scene.camera.right));
    }
}
