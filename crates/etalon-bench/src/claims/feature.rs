//! The image of a class, where it is bright, and how it stands out from what else is seen there.
//!
//! One half of the samples finds the place, the other half measures it: the place is not chosen by the noise that is measured.

use super::claim::Share;
use super::events::{Event, World, is_of, word};
use crate::depth::Depths;
use etalon_core::interrupt;
use etalon_core::math::{Rgb, mean_rgb};
use etalon_core::raster::Image;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::scene::{Ray, Request, Scene};
use etalon_stats::Extremes;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Half the size of a place in standard deviations of the light's distribution over the image.
const REACH: f64 = 1.5;

/// Most paths in a pixel over those asked for.
const MOST: usize = 64;

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Place {
    /// First column and row.
    pub from: [usize; 2],
    /// Column and row after the last.
    pub to: [usize; 2],
}

impl Place {
    fn holds(&self, [x, y]: [usize; 2]) -> bool {
        (self.from[0]..self.to[0]).contains(&x) && (self.from[1]..self.to[1]).contains(&y)
    }
}

/// A scene as the camera sees it, and the seed of the paths through it.
pub struct View<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its surfaces and its light.
    pub world: World<'a>,
    /// Size of the image.
    pub request: &'a Request,
    /// Of the random numbers.
    pub seed: u64,
}

impl View<'_> {
    /// The ray through a point of pixel `i`.
    pub fn ray(&self, i: usize, [u, v]: [f64; 2]) -> Ray {
        let Request { width, height, .. } = *self.request;
        let (x, y) = ((i % width) as f64 + u, (i / width) as f64 + v);
        self.scene.camera.ray(x / width as f64, y / height as f64)
    }
}

/// A place that a claim is about.
pub struct PlacePicture {
    /// What is there.
    pub title: &'static str,
    /// The class, from the light to the eye.
    pub word: String,
    /// The image at the depth at which it appears, with all light.
    pub depth: u32,
    /// The class alone.
    pub class: Image,
    /// Where it is.
    pub place: Place,
    /// Its share of the light there.
    pub share: Share,
    /// The light there minus that of the image, in standard errors.
    pub z: f64,
}

impl PlacePicture {
    /// Of a class at a depth whose image is given.
    pub fn new(
        title: &'static str,
        class: &ClassImage,
        place: Place,
        light: [[f64; 2]; 2],
        (depth, depths): (u32, &Depths),
    ) -> Self {
        let [[part, part_error], [rest, rest_error]] = light;
        let [rendered, rendered_error] = class.rendered(depths.image(depth), &depths.standard_error, &place);
        let z = (part + rest - rendered) / part_error.hypot(rest_error).hypot(rendered_error);
        let share = Share::of(light[0], light[1]);
        Self { title, word: class.word.clone(), depth, class: class.image(), place, share, z }
    }
}

/// The light of a class in every pixel.
pub struct ClassImage {
    width: usize,
    events: &'static [Event],
    /// The class, from the light to the eye.
    pub word: String,
    /// Radiance by all samples.
    pub pixels: Vec<DVec3>,
    /// Pixels in whose centre the class can be seen.
    pub mask: Vec<bool>,
    /// Mean of the channels by the first half of the samples, and by the second.
    halves: [Vec<f64>; 2],
    /// Variance of the second half, from above: the sum of the squares of what its samples add.
    variance: Vec<f64>,
}

/// Where the light paths of a class arrive at its diffuse vertex.
struct Reached {
    low: Vec3,
    high: Vec3,
}

impl Reached {
    /// For a class whose diffuse vertex is between specular ones.
    fn of(world: &World, events: &[Event], seed: u64) -> Option<Self> {
        const PATHS: u32 = 1 << 12;
        let diffuse = events.iter().position(|event| event.is_diffuse())?;
        let chain = &events[diffuse + 1..];
        if chain.is_empty() || chain.iter().any(|event| event.is_diffuse()) {
            return None;
        }
        let point =
            |n: u32| world.arrive(chain, &Independent::new(seed, u64::from(n), 1)).map(|(vertex, _)| vertex.point);
        let points = || (0..PATHS).filter_map(point);
        let (low, high) = (points().reduce(Vec3::min)?, points().reduce(Vec3::max)?);
        // The light's edge is sampled at few points.
        let margin = 0.05 * (high - low) + 0.01;
        Some(Self { low: low - margin, high: high + margin })
    }

    /// Whether a pixel shows a point of it, among a grid of its own.
    fn is_seen(&self, view: &View, events: &[Event], i: usize) -> bool {
        const GRID: u32 = 4;
        (0..GRID * GRID).any(|k| {
            let at = [k % GRID, k / GRID].map(|n| (f64::from(n) + 0.5) / f64::from(GRID));
            let point = view.world.first_diffuse(view.ray(i, at), events);
            point.is_some_and(|p| p.cmpge(self.low).all() && p.cmple(self.high).all())
        })
    }
}

/// Samples of a pixel where only some of all pixels are sampled: as many in all, within limits.
fn more(spp: u32, all: usize, some: usize) -> u32 {
    spp * (all / some.max(1)).clamp(1, MOST) as u32
}

/// What one sample adds: the pixel, and its radiance.
type Splat = (usize, DVec3);

impl ClassImage {
    /// By `spp` paths from the eye in each pixel where the first event can happen.
    pub fn from_eye(view: &View, events: &'static [Event], spp: u32) -> Self {
        let mut image = Self::empty(view, events);
        // Where light paths arrive at few points, as many paths in all go to the pixels that show these.
        let (mut near, mut spp) = (image.around(), spp);
        if let Some(reached) = Reached::of(&view.world, events, view.seed) {
            let all = near.len();
            near.retain(|&i| reached.is_seen(view, events, i));
            spp = more(spp, all, near.len());
        }
        let pixel = |i: usize| -> Vec<DVec3> {
            let sample = |s: u32| {
                let stream = Independent::new(view.seed, i as u64, s);
                view.world.along(view.ray(i, stream.pair(0)), events, &stream)
            };
            (0..spp).map(sample).collect()
        };
        let samples: Vec<Vec<DVec3>> = near.par_iter().map(|&i| pixel(i)).collect();
        for (&i, samples) in near.iter().zip(&samples) {
            for (s, value) in samples.iter().enumerate() {
                image.add(s % 2, (i, *value), f64::from(spp));
            }
        }
        image
    }

    /// By `count` paths from the light; the first event is diffuse, the others are specular.
    pub fn from_light(view: &View, events: &'static [Event], count: u32) -> Self {
        let mut image = Self::empty(view, events);
        let Request { width, height, .. } = *view.request;
        let splat = |n: u32| -> Option<Splat> {
            let (film, share) = view.world.splat(events, &Independent::new(view.seed, u64::from(n), 0))?;
            let [x, y] = [(film[0] * width as f64) as usize, (film[1] * height as f64) as usize];
            Some((y.min(height - 1) * width + x.min(width - 1), share * (width * height) as f64))
        };
        let splats: Vec<Option<Splat>> = (0..count).into_par_iter().map(splat).collect();
        for (n, splat) in splats.into_iter().enumerate() {
            if let Some(splat) = splat {
                image.add(n % 2, splat, f64::from(count));
            }
        }
        image
    }

    fn empty(view: &View, events: &'static [Event]) -> Self {
        let (width, pixels) = (view.request.width, view.request.width * view.request.height);
        let centre = |i: usize| {
            let vertex = view.world.nearest(&view.ray(i, [0.5; 2]));
            vertex.zip(events.first()).is_some_and(|(vertex, event)| vertex.allows(*event))
        };
        let mask = if interrupt::requested() {
            vec![false; pixels]
        } else {
            (0..pixels).into_par_iter().map(centre).collect()
        };
        Self {
            width,
            events,
            word: word(events),
            pixels: vec![DVec3::ZERO; pixels],
            mask,
            halves: [vec![0.0; pixels], vec![0.0; pixels]],
            variance: vec![0.0; pixels],
        }
    }

    /// The pixels of the mask and their neighbours, which may show a part of it.
    fn around(&self) -> Vec<usize> {
        let (width, height) = (self.width as isize, (self.mask.len() / self.width) as isize);
        let seen = |i: &usize| {
            let (x, y) = ((i % self.width) as isize, (i / self.width) as isize);
            let near = |(dx, dy): (isize, isize)| {
                let (x, y) = (x + dx, y + dy);
                (0..width).contains(&x) && (0..height).contains(&y) && self.mask[(y * width + x) as usize]
            };
            [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().any(near)
        };
        (0..self.mask.len()).filter(seen).collect()
    }

    /// Adds a sample of one half; `count` is the number of samples in both.
    fn add(&mut self, half: usize, (i, value): Splat, count: f64) {
        let mean = value.element_sum() / 3.0 * 2.0 / count;
        self.pixels[i] += value / count;
        self.halves[half][i] += mean;
        if half == 1 {
            self.variance[i] += mean * mean;
        }
    }

    /// Where the class is bright, by the first half of the samples; `None` where it has no light.
    pub fn place(&self) -> Option<Place> {
        let at = |i: usize| [(i % self.width) as f64 + 0.5, (i / self.width) as f64 + 0.5];
        let sum =
            |f: &dyn Fn([f64; 2]) -> f64| -> f64 { self.halves[0].iter().enumerate().map(|(i, v)| v * f(at(i))).sum() };
        let total = sum(&|_| 1.0);
        let size = [self.width, self.mask.len() / self.width];
        let mut place = Place::default();
        for axis in 0..2 {
            let mean = sum(&|at| at[axis]) / total;
            let deviation = (sum(&|at| (at[axis] - mean).powi(2)) / total).sqrt();
            place.from[axis] = (mean - REACH * deviation).floor().at_least(0.0) as usize;
            place.to[axis] = ((mean + REACH * deviation).ceil() as usize).min(size[axis]);
        }
        (total > 0.0).then_some(place)
    }

    /// Light of the class in this place, and of all other paths of at most `depth` events, with standard errors. The former is that of
    /// the second half of the samples; `spp` paths of the latter are traced in each pixel, more if the place is small.
    pub fn light_in(&self, view: &View, place: &Place, depth: u32, spp: u32) -> [[f64; 2]; 2] {
        let pixels: Vec<usize> = self.within(place).collect();
        let class: f64 = pixels.iter().map(|&i| self.halves[1][i]).sum();
        let variance: f64 = pixels.iter().map(|&i| self.variance[i]).sum();
        let spp = more(spp, self.mask.iter().filter(|m| **m).count(), pixels.len());
        let others = |&i: &usize| {
            let sample = |s: u32| {
                let stream = Independent::new(view.seed.wrapping_add(1), i as u64, s);
                let (ray, mut light) = (view.ray(i, stream.pair(0)), 0.0);
                for &first in view.world.first_events(&ray) {
                    view.world.path(ray, first, 1..=depth, &stream, |events, value| {
                        light += if is_of(events, self.events) { 0.0 } else { value.element_sum() / 3.0 };
                    });
                }
                light / f64::from(spp)
            };
            (0..spp).map(sample).fold([0.0; 2], |[sum, squares], light| [sum + light, squares + light * light])
        };
        // Summed in the order of the pixels, whatever the number of threads
        let lights: Vec<[f64; 2]> = pixels.par_iter().map(others).collect();
        let [rest, squares] = [0, 1].map(|k| lights.iter().map(|light| light[k]).sum::<f64>());
        [[class, variance.sqrt()], [rest, squares.sqrt()]]
    }

    /// All light of an image in this place, with its standard error.
    fn rendered(&self, image: &Image, standard_error: &Image, place: &Place) -> [f64; 2] {
        let light = |image: &Image, of: fn(f64) -> f64| -> f64 {
            self.within(place).map(|i| of(mean_rgb(image.pixels()[i]))).sum()
        };
        // Channels of a pixel err together.
        [light(image, |v| v), light(standard_error, |v| v * v).sqrt()]
    }

    /// The pixels of the mask in this place.
    fn within(&self, place: &Place) -> impl Iterator<Item = usize> {
        (0..self.mask.len()).filter(|i| self.mask[*i] && place.holds([i % self.width, i / self.width]))
    }

    /// The sum of the class's light over the pixels of the mask (mean of the channels), and its standard error.
    pub fn total(&self) -> [f64; 2] {
        let sum = |values: &[f64]| values.iter().zip(&self.mask).filter(|(_, m)| **m).map(|(v, _)| v).sum::<f64>();
        // Both halves have about the variance of the second.
        [(sum(&self.halves[0]) + sum(&self.halves[1])) / 2.0, (sum(&self.variance) / 2.0).sqrt()]
    }

    /// Centroid of the light of the second half, with the standard errors of its coordinates.
    pub fn centroid(&self) -> [[f64; 2]; 2] {
        let at = |i: usize| [(i % self.width) as f64 + 0.5, (i / self.width) as f64 + 0.5];
        let light = || self.halves[1].iter().enumerate();
        let total: f64 = self.halves[1].iter().sum();
        [0, 1].map(|axis| {
            let mean = light().map(|(i, v)| v * at(i)[axis]).sum::<f64>() / total;
            let variance: f64 = self.variance.iter().enumerate().map(|(i, v)| v * (at(i)[axis] - mean).powi(2)).sum();
            [mean, variance.sqrt() / total]
        })
    }

    /// The middle of the pixels of the mask.
    pub fn middle(&self) -> [f64; 2] {
        let inside = || self.mask.iter().enumerate().filter(|(_, m)| **m).map(|(i, _)| i);
        let count = inside().count() as f64;
        [0, 1].map(|axis| inside().map(|i| [i % self.width, i / self.width][axis] as f64 + 0.5).sum::<f64>() / count)
    }

    /// The class as an image.
    pub fn image(&self) -> Image {
        let pixels: Vec<Rgb> = self.pixels.iter().map(|p| p.as_vec3()).collect();
        Image::from_pixels(self.width, self.mask.len() / self.width, pixels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Event::{Diffuse, Mirror, Reflected, Refracted};
    use etalon_core::scene::builtin;
    use etalon_render::{Sampling, Settings, Silent, render};

    /// The sum of the light of a class on the objects of the mask, by the renderer.
    fn rendered(scene: &Scene, request: &Request, word: &str, mask: &[bool]) -> f64 {
        let settings = Settings { paths: Some(4), sampling: Sampling::Mis, ..Settings::default() };
        let layers = render(scene, request, &settings, &Silent).unwrap().part.film.path_layers();
        let (_, layer) = layers.iter().find(|(name, _)| name == word).unwrap();
        layer.pixels().iter().zip(mask).filter(|(_, m)| **m).map(|(p, _)| mean_rgb(*p)).sum()
    }

    #[test]
    #[ignore = "takes seconds: cargo test -- --ignored"]
    fn forced_events_have_the_light_that_is_rendered() {
        let (scene, request) = builtin::cornell_spheres();
        let request = Request { width: 80, height: 60, spp: 256, max_depth: 4, ..request };
        let view = View { scene: &scene, world: World::new(&scene).unwrap(), request: &request, seed: 5 };
        let image = |events: &'static [Event]| ClassImage::from_eye(&view, events, 32);
        for (word, parts) in [
            ("LDSE", vec![image(&[Mirror, Diffuse])]),
            ("LDSSE", vec![image(&[Reflected, Mirror, Diffuse]), image(&[Refracted, Refracted, Diffuse])]),
        ] {
            let expected = rendered(&scene, &request, word, &parts[0].mask);
            let (sum, variance) =
                parts.iter().map(ClassImage::total).fold((0.0, 0.0), |(s, v), [t, e]| (s + t, v + e * e));
            let z = (sum - expected) / (2.0 * variance).sqrt();
            assert!(z.abs() < 4.0 && variance.sqrt() < 0.05 * sum, "{word}: {sum} {expected} {z}");
        }
        // Nearly all of the light of caustics on the glass sphere is reflected by its outside. The renderer's paths rarely find it:
        // its error is 7 %.
        let caustic = image(&[Reflected, Diffuse, Refracted, Refracted]);
        let ratio = caustic.total()[0] / rendered(&scene, &request, "LSSDSE", &caustic.mask);
        assert!((0.8..1.2).contains(&ratio), "{ratio}");
        // The caustic on the floor, from the light and from the eye
        let events = &[Diffuse, Refracted, Refracted];
        let [light, eye] = [ClassImage::from_light(&view, events, 1 << 15), image(events)].map(|c| c.total());
        assert!((light[0] - eye[0]).abs() < 4.0 * light[1].hypot(eye[1]) && eye[1] < 0.1 * eye[0], "{light:?} {eye:?}");
    }
}
