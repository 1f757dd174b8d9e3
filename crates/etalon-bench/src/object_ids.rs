//! The object-id buffer of a scene: the kind of object that the ray through each pixel's centre hits first; and the mean radiance
//! of an image over some of its pixels, with its standard error.

use etalon_core::scene::{FirstHit, Material, Object, Request, Scene};
use etalon_render::film::PixelEstimate;
use rayon::prelude::*;

/// The kinds of objects in the second report's scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    AreaLight,
    Mirror,
    Glass,
    Metal,
    /// Diffuse walls and spheres.
    Diffuse,
}

impl Kind {
    pub const ALL: [Self; 5] = [Self::AreaLight, Self::Mirror, Self::Glass, Self::Metal, Self::Diffuse];

    pub fn name(self) -> &'static str {
        match self {
            Self::AreaLight => "area light",
            Self::Mirror => "mirror",
            Self::Glass => "glass",
            Self::Metal => "metal",
            Self::Diffuse => "room",
        }
    }

    fn of(object: &Object) -> Self {
        if object.emission.is_some() { Self::AreaLight } else { Self::of_material(&object.material) }
    }

    fn of_material(material: &Material) -> Self {
        match material {
            Material::Mirror { .. } => Self::Mirror,
            Material::Dielectric(_) | Material::Refraction { .. } => Self::Glass,
            Material::Conductor(_) => Self::Metal,
            Material::Bsdf(_) if material.is_transmitting() => Self::Glass,
            Material::Diffuse { .. } | Material::Bsdf(_) | Material::Mixture(_) => Self::Diffuse,
            Material::Textured(textured) => Self::of_material(&textured.base),
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct ObjectIdBuffer {
    /// Pixels of a row.
    pub width: usize,
    /// Row by row from the top; `None` where no object is hit.
    pub pixels: Vec<Option<Kind>>,
}

impl ObjectIdBuffer {
    /// The buffer of the scene's camera.
    pub fn new(scene: &Scene, request: &Request) -> Self {
        let objects = FirstHit::new(scene);
        let (width, height) = (request.width, request.height);
        let kind = |i: usize| {
            let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            let ray = scene.camera.ray(x / width as f64, y / height as f64);
            objects.along(&ray).map(Kind::of)
        };
        Self { width, pixels: (0..width * height).into_par_iter().map(kind).collect() }
    }

    /// Which pixels show this kind.
    pub fn mask(&self, kind: Kind) -> Vec<bool> {
        self.pixels.iter().map(|&k| k == Some(kind)).collect()
    }

    /// For each pixel of `mask` the distance to the nearest pixel outside it, centre to centre, and for the others, negative,
    /// that to the nearest one inside; ±∞ beyond `reach` pixels.
    pub fn depth_inside(&self, mask: &[bool], reach: usize) -> Vec<f64> {
        let far = distances(mask, self.width, reach, false);
        let near = distances(mask, self.width, reach, true);
        mask.iter().enumerate().map(|(i, &inside)| if inside { far[i] } else { -near[i] }).collect()
    }
}

/// Distance of every pixel to the nearest one where `mask` is `target`: first along the rows, then across them.
fn distances(mask: &[bool], width: usize, reach: usize, target: bool) -> Vec<f64> {
    // Distances along each row.
    let mut along = vec![f64::INFINITY; mask.len()];
    for (row, out) in mask.chunks(width).zip(along.chunks_mut(width)) {
        for (x, value) in out.iter_mut().enumerate() {
            let (from, to) = (x.saturating_sub(reach), (x + reach + 1).min(width));
            *value =
                (from..to).filter(|&i| row[i] == target).map(|i| i.abs_diff(x) as f64).fold(f64::INFINITY, f64::min);
        }
    }
    let height = mask.len() / width;
    // Combine the rows within reach by Pythagoras's theorem.
    let at = |i: usize| {
        let (x, y) = (i % width, i / width);
        let rows = y.saturating_sub(reach)..(y + reach + 1).min(height);
        let distance = rows.map(|r| along[r * width + x].hypot(r.abs_diff(y) as f64)).fold(f64::INFINITY, f64::min);
        if distance <= reach as f64 { distance } else { f64::INFINITY }
    };
    (0..mask.len()).into_par_iter().map(at).collect()
}

/// A mean over pixels with its standard error, for each channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelMean {
    pub value: [f64; 3],
    pub error: [f64; 3],
    pub pixels: usize,
}

/// The values at the pixels of `mask`.
pub fn inside<T>(values: impl IntoIterator<Item = T>, mask: &[bool]) -> impl Iterator<Item = T> {
    values.into_iter().zip(mask).filter(|(_, inside)| **inside).map(|(value, _)| value)
}

impl PixelMean {
    /// The mean over the pixels of `mask`, and the root of the sum of their squared standard errors over their number.
    pub fn of(estimates: impl IntoIterator<Item = PixelEstimate>, mask: &[bool]) -> Self {
        let (mut sum, mut square, mut pixels) = ([0.0; 3], [0.0; 3], 0);
        for PixelEstimate { mean, error } in inside(estimates, mask) {
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
    pub fn mean_rgb(&self) -> f64 {
        self.value.iter().sum::<f64>() / 3.0
    }

    /// The largest of the channels' differences in units of their standard errors, with its sign.
    pub fn z(&self, other: &Self) -> f64 {
        (0..3)
            .map(|c| (self.value[c] - other.value[c]) / self.error[c].hypot(other.error[c]))
            .fold(0.0, |worst: f64, z| if z.abs() > worst.abs() || z.is_nan() { z } else { worst })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::scene::builtin;

    #[test]
    fn the_box_shows_its_objects() {
        let (scene, request) = builtin::cornell_spheres();
        let ids = ObjectIdBuffer::new(&scene, &request);
        let at = |x: usize, y: usize| ids.pixels[y * request.width + x];
        assert_eq!(at(240, 44), Some(Kind::AreaLight));
        assert_eq!(at(160, 270), Some(Kind::Mirror));
        assert_eq!(at(325, 280), Some(Kind::Glass));
        assert_eq!(at(240, 150), Some(Kind::Diffuse));
        assert_eq!(at(0, 180), None, "beside the box");
        assert!(ids.pixels.iter().all(|k| *k != Some(Kind::Metal)));
        let (scene, request) = builtin::find("cornell-statue-fe").unwrap().make(None, None).unwrap();
        let statue = ObjectIdBuffer::new(&scene, &request).mask(Kind::Metal).iter().filter(|m| **m).count();
        assert!((10_000..25_000).contains(&statue), "{statue}");
    }

    #[test]
    fn distances_are_euclidean() {
        let ids = ObjectIdBuffer { width: 9, pixels: vec![None; 9 * 7] };
        let mut mask = vec![true; 9 * 7];
        mask[3 * 9 + 4] = false;
        let depth = ids.depth_inside(&mask, 3);
        assert_eq!(depth[3 * 9 + 4], -1.0);
        assert_eq!((depth[2 * 9 + 4], depth[9 + 3]), (1.0, 5f64.sqrt()));
        assert_eq!((depth[3 * 9 + 7], depth[8]), (3.0, f64::INFINITY));
    }

    #[test]
    fn z_is_the_worst_channels() {
        let mean = |value: [f64; 3]| PixelMean { value, error: [3.0, 3.0, 3.0], pixels: 1 };
        let other = PixelMean { error: [4.0; 3], ..mean([0.0; 3]) };
        assert_eq!(mean([5.0, -10.0, 0.0]).z(&other), -2.0);
        assert!(mean([f64::NAN, 0.0, 0.0]).z(&other).is_nan());
        assert_eq!(mean([1.0, 2.0, 3.0]).mean_rgb(), 2.0);
    }
}
