//! What a picture shows where: the object that the ray through each pixel's centre meets first.

use crate::render::film::{Film, PixelEstimate};
use crate::scene::{Material, Mesh, MeshBvh, Object, Ray, Rectangle, Request, Scene, Shape};
use rayon::prelude::*;

/// The kinds of things that the second report's pictures show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// What emits light.
    Lamp,
    /// Perfect mirrors.
    Mirror,
    /// Smooth dielectrics.
    Glass,
    /// Rough conductors.
    Metal,
    /// Diffuse walls and balls.
    Room,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Lamp, Self::Mirror, Self::Glass, Self::Metal, Self::Room];

    /// The name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Lamp => "lamp",
            Self::Mirror => "mirror",
            Self::Glass => "glass",
            Self::Metal => "metal",
            Self::Room => "room",
        }
    }

    fn of(object: &Object) -> Self {
        match object.material {
            _ if object.emission.is_some() => Self::Lamp,
            Material::Mirror { .. } => Self::Mirror,
            Material::Glass { .. } | Material::Refraction { .. } => Self::Glass,
            Material::Conductor(_) => Self::Metal,
            Material::Diffuse { .. } => Self::Room,
        }
    }
}

/// What each pixel shows, row by row from the top; `None` where that is nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectIdBuffer {
    /// Columns of pixels.
    pub width: usize,
    /// Row by row from the top; `None` where no object is.
    pub pixels: Vec<Option<Kind>>,
}

impl ObjectIdBuffer {
    /// Looks through the scene's camera.
    #[must_use]
    pub fn new(scene: &Scene, request: &Request) -> Self {
        let meshes = scene.objects.iter().filter_map(|o| match &o.shape {
            Shape::Mesh(mesh) => Some((&**mesh, Kind::of(o))),
            _ => None,
        });
        let (meshes, kinds): (Vec<&Mesh>, Vec<Kind>) = meshes.unzip();
        let tree = MeshBvh::build(&meshes);
        let (width, height) = (request.width, request.height);
        let look = |i: usize| {
            let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            let ray = scene.camera.ray(x / width as f64, y / height as f64);
            let (mut nearest, mut kind) = (f32::INFINITY, None);
            for object in &scene.objects {
                let distance = match &object.shape {
                    Shape::Sphere(sphere) => sphere.distance(ray.origin, ray.direction),
                    Shape::Rectangle(rectangle) => distance(rectangle, &ray),
                    Shape::Mesh(_) => f32::INFINITY,
                };
                if distance < nearest {
                    (nearest, kind) = (distance, Some(Kind::of(object)));
                }
            }
            match tree.nearest(&ray, nearest) {
                Some(hit) => Some(kinds[tree.mesh_of(hit.triangle) as usize]),
                None => kind,
            }
        };
        Self { width, pixels: (0..width * height).into_par_iter().map(look).collect() }
    }

    /// Which pixels show this kind.
    #[must_use]
    pub fn mask(&self, kind: Kind) -> Vec<bool> {
        self.pixels.iter().map(|&k| k == Some(kind)).collect()
    }

    /// For each pixel of `mask` the distance to the nearest pixel outside it, centre to centre, and for the others, negative,
    /// that to the nearest one inside; ±∞ beyond `reach` pixels.
    #[must_use]
    pub fn depth_inside(&self, mask: &[bool], reach: usize) -> Vec<f64> {
        let far = distances(mask, self.width, reach, false);
        let near = distances(mask, self.width, reach, true);
        mask.iter().enumerate().map(|(i, &inside)| if inside { far[i] } else { -near[i] }).collect()
    }
}

/// Distance of every pixel to the nearest one where `mask` is `target`: first along the rows, then across them.
fn distances(mask: &[bool], width: usize, reach: usize, target: bool) -> Vec<f64> {
    let mut along = vec![f64::INFINITY; mask.len()];
    for (row, out) in mask.chunks(width).zip(along.chunks_mut(width)) {
        for (x, value) in out.iter_mut().enumerate() {
            let (from, to) = (x.saturating_sub(reach), (x + reach + 1).min(width));
            *value =
                (from..to).filter(|&i| row[i] == target).map(|i| i.abs_diff(x) as f64).fold(f64::INFINITY, f64::min);
        }
    }
    let height = mask.len() / width;
    let at = |i: usize| {
        let (x, y) = (i % width, i / width);
        let rows = y.saturating_sub(reach)..(y + reach + 1).min(height);
        let distance = rows.map(|r| along[r * width + x].hypot(r.abs_diff(y) as f64)).fold(f64::INFINITY, f64::min);
        if distance <= reach as f64 { distance } else { f64::INFINITY }
    };
    (0..mask.len()).into_par_iter().map(at).collect()
}

/// Where along a ray a rectangle is met, from either side; infinite where it is not.
fn distance(rectangle: &Rectangle, ray: &Ray) -> f32 {
    let (from, normal) = (ray.origin - rectangle.centre(), rectangle.normal());
    let t = -from.dot(normal) / ray.direction.dot(normal);
    let point = from + t * ray.direction;
    let within = rectangle.half_sides().iter().all(|side| point.dot(*side).abs() <= side.length_squared());
    if t > 0.0 && within { t } else { f32::INFINITY }
}

/// A mean over pixels with its standard error, for each channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// Mean radiance, R, G and B.
    pub value: [f64; 3],
    /// Standard error of the mean.
    pub error: [f64; 3],
    /// How many pixels it is the mean of.
    pub pixels: usize,
}

impl Mean {
    /// The mean over the pixels of `mask`, and the root of the sum of their squared standard errors over their number.
    #[must_use]
    pub fn of(film: &Film, mask: &[bool]) -> Self {
        let (mut sum, mut square, mut pixels) = ([0.0; 3], [0.0; 3], 0);
        for (PixelEstimate { mean, error }, _) in film.estimates().zip(mask).filter(|(_, inside)| **inside) {
            for c in 0..3 {
                sum[c] += f64::from(mean[c]);
                square[c] += f64::from(error[c]).powi(2);
            }
            pixels += 1;
        }
        let n = pixels.max(1) as f64;
        Self { value: sum.map(|s| s / n), error: square.map(|s| s.sqrt() / n), pixels }
    }

    /// (R + G + B) / 3.
    #[must_use]
    pub fn intensity(&self) -> f64 {
        self.value.iter().sum::<f64>() / 3.0
    }

    /// The largest of the channels' differences in units of their standard errors, with its sign.
    #[must_use]
    pub fn z(&self, other: &Self) -> f64 {
        (0..3)
            .map(|c| (self.value[c] - other.value[c]) / self.error[c].hypot(other.error[c]))
            .fold(0.0, |worst: f64, z| if z.abs() > worst.abs() || z.is_nan() { z } else { worst })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn the_room_shows_what_is_in_it() {
        let (scene, request) = builtin::cornell_spheres();
        let objects = ObjectIdBuffer::new(&scene, &request);
        let at = |x: usize, y: usize| objects.pixels[y * request.width + x];
        assert_eq!(at(240, 44), Some(Kind::Lamp));
        assert_eq!(at(160, 270), Some(Kind::Mirror));
        assert_eq!(at(325, 280), Some(Kind::Glass));
        assert_eq!(at(240, 150), Some(Kind::Room));
        assert_eq!(at(0, 180), None, "beside the room");
        assert!(objects.pixels.iter().all(|k| *k != Some(Kind::Metal)));
        let (scene, request) = builtin::by_name("cornell-statue-fe", None).unwrap().unwrap();
        let statue = ObjectIdBuffer::new(&scene, &request).mask(Kind::Metal).iter().filter(|m| **m).count();
        assert!((10_000..25_000).contains(&statue), "{statue}");
    }

    #[test]
    fn distances_are_euclidean() {
        let objects = ObjectIdBuffer { width: 9, pixels: vec![None; 9 * 7] };
        let mut mask = vec![true; 9 * 7];
        mask[3 * 9 + 4] = false;
        let depth = objects.depth_inside(&mask, 3);
        assert_eq!(depth[3 * 9 + 4], -1.0);
        assert_eq!((depth[2 * 9 + 4], depth[9 + 3]), (1.0, 5f64.sqrt()));
        assert_eq!((depth[3 * 9 + 7], depth[8]), (3.0, f64::INFINITY));
    }

    #[test]
    fn z_is_the_worst_channels() {
        let mean = |value: [f64; 3]| Mean { value, error: [3.0, 3.0, 3.0], pixels: 1 };
        let other = Mean { error: [4.0; 3], ..mean([0.0; 3]) };
        assert_eq!(mean([5.0, -10.0, 0.0]).z(&other), -2.0);
        assert!(mean([f64::NAN, 0.0, 0.0]).z(&other).is_nan());
        assert_eq!(mean([1.0, 2.0, 3.0]).intensity(), 2.0);
    }
}
