//! The object-id buffer of a scene: the kind of object that the ray through each pixel's centre hits first.

use etalon_core::scene::{FirstHit, Material, Object, Request, Scene};
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
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::AreaLight, Self::Mirror, Self::Glass, Self::Metal, Self::Diffuse];

    /// The name in tables.
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

/// A kind of object for each pixel.
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
}
