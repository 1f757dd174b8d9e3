//! What each further scattering adds to an image: one render, decomposed by path class (Heckbert 1990).
//!
//! An image of depth m has the light that was scattered at most m times. One deep render, decomposed by path class, therefore
//! holds the images of all depths; [`truncation`] compares them with renders that end at depth m.

use crate::object_ids::{Kind, ObjectIdBuffer, inside};
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::math::{Rgb, mean_rgb};
use etalon_core::raster::Image;
use etalon_core::scene::{Object, Projection, Request, Scene, Shape};
use etalon_render::film::PathClasses;
use etalon_render::{Dropped, Settings, Silent, render};
use glam::DVec3;
use serde::Serialize;

/// The second report's depths.
pub const DEPTHS: [u32; 7] = [0, 1, 2, 3, 4, 5, 100];

/// The smallest relative difference in brightness that an observer sees, 2 %: Weber's fraction.
///
/// Source: Hood & Finkelstein, "Sensitivity to Light", in *Handbook of Perception and Human Performance*, 1986.
pub const VISIBLE: f64 = 0.02;

/// Scatterings up to which path classes have layers of their own.
const CLASS_DEPTH: u32 = 5;

/// One depth on one kind of object. Field names are the CSV columns; light is the mean of R, G and B.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RadianceRow {
    /// Scatterings of the longest path.
    pub depth: u32,
    /// Kind of object, or "all".
    pub seen_on: &'static str,
    pub pixels: usize,
    pub mean_r: f64,
    pub mean_g: f64,
    pub mean_b: f64,
    /// Share of all light of the deepest image.
    pub share_of_light: f64,
}

/// The light of one path class on one kind of object ("all" for the whole image), where there is any.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ClassRow {
    /// The depth at which it appears.
    pub depth: u32,
    /// The path class, for example LDE.
    pub class: String,
    pub seen_on: &'static str,
    /// Share of all that this depth adds to the image.
    pub share_of_difference: f64,
    pub share_of_light: f64,
    /// Share of the pixels that show this kind of object in which the class has light.
    pub lit_pixels: f64,
    /// Where on the image, weighted by light.
    pub centroid_x: f64,
    /// The same, row.
    pub centroid_y: f64,
    #[serde(skip)]
    pub error: f64,
    /// Share of the light of the image of that depth where the class has the middle half of its light, by row and by column.
    #[serde(skip)]
    pub share_there: f64,
    /// The standard error of its distance from [`VISIBLE`].
    #[serde(skip)]
    pub error_there: f64,
}

/// The images of all depths, and their differences by path class.
pub struct Depths {
    /// In the order of [`DEPTHS`].
    pub images: Vec<Image>,
    /// Each image but the first, minus the one before it.
    pub differences: Vec<Image>,
    /// Light by path class and kind of object.
    pub classes: Vec<ClassRow>,
    /// The settings of the render.
    pub request: Request,
    /// The part of each difference, but the last, with at most one diffuse reflection: what has sharp outlines.
    pub sharp: Vec<Image>,
}

impl Depths {
    /// The image of one of [`DEPTHS`].
    pub fn image(&self, depth: u32) -> &Image {
        &self.images[DEPTHS.iter().position(|d| *d == depth).unwrap_or(0)]
    }

    /// What one of [`DEPTHS`], but the first, adds to the image of the one before.
    pub fn added(&self, depth: u32) -> &Image {
        &self.differences[DEPTHS.iter().skip(1).position(|d| *d == depth).unwrap_or(0)]
    }

    /// The light of a class on what is "all" or a kind of object, if there is any.
    pub fn class(&self, class: &str, seen_on: &str) -> Option<&ClassRow> {
        self.classes.iter().find(|r| r.class == class && r.seen_on == seen_on)
    }

    /// The share of all light in the path classes that `of` selects.
    pub fn share(&self, of: impl Fn(&ClassRow) -> bool) -> f64 {
        self.classes.iter().filter(|r| r.seen_on == ALL && of(r)).map(|r| r.share_of_light).sum()
    }

    /// Mean light of an image.
    pub fn mean(&self, depth: u32) -> f64 {
        mean(self.image(depth))
    }
}

/// The whole image, among the kinds of objects.
pub const ALL: &str = "all";

/// Renders the scene once, as deep as [`DEPTHS`] go, and decomposes it by path class.
pub fn depths(scene: &Scene, request: &Request, settings: &Settings) -> Result<Depths> {
    let request = Request { max_depth: DEPTHS[DEPTHS.len() - 1], ..*request };
    let by_class = Settings { paths: Some(PathClasses::up_to(CLASS_DEPTH)), ..*settings };
    let layers = render(scene, &request, &by_class, &Silent)?.part.film.path_layers();
    interrupt::check()?;
    let regions = regions(scene, &request);
    let pixels = request.width * request.height;

    // Each image is the one before it plus the layers that appear at its depth, summed in f64.
    let mut images = Vec::new();
    let mut differences = Vec::new();
    let mut sharp = Vec::new();
    let mut so_far = vec![DVec3::ZERO; pixels];
    for depth in DEPTHS {
        let mut added = vec![DVec3::ZERO; pixels];
        let mut outlined = added.clone();
        for (name, layer) in layers.iter().filter(|(name, _)| appears_at(name) == depth) {
            add(&mut added, layer.pixels());
            if name.matches('D').count() <= 1 {
                add(&mut outlined, layer.pixels());
            }
        }
        so_far.iter_mut().zip(&added).for_each(|(sum, a)| *sum += a);
        let image = |pixels: &[DVec3]| {
            let pixels: Vec<Rgb> = pixels.iter().map(|p| p.as_vec3()).collect();
            Image::from_pixels(request.width, request.height, pixels)
        };
        images.push(image(&so_far));
        if depth > 0 {
            differences.push(image(&added));
        }
        if (1..=CLASS_DEPTH).contains(&depth) {
            sharp.push(image(&outlined));
        }
    }

    let all_light = light(images[images.len() - 1].pixels(), &regions[0].1);
    // Each layer's share of the light, pixels that are not black, and centroid, by kind of object.
    let mut classes = Vec::new();
    for (name, layer) in &layers {
        let (depth, layer) = (appears_at(name), layer.pixels());
        let place = DEPTHS.iter().position(|d| *d == depth).unwrap_or(0);
        let added = if place == 0 { &images[0] } else { &differences[place - 1] };
        let difference = light(added.pixels(), &regions[0].1);
        for (seen_on, mask) in &regions {
            let here = light(layer, mask);
            if here > 0.0 {
                let [x, y] = centroid(layer, request.width, mask, here);
                let lit = inside(layer, mask).filter(|p| **p != Rgb::ZERO).count();
                let bright = bright(layer, request.width, mask, here);
                let [share_there, error_there] = share_with_error(layer, images[place].pixels(), &bright, VISIBLE);
                classes.push(ClassRow {
                    depth,
                    class: name.to_owned(),
                    seen_on,
                    share_of_difference: here / difference,
                    share_of_light: here / all_light,
                    lit_pixels: lit as f64 / mask.iter().filter(|m| **m).count() as f64,
                    centroid_x: x,
                    centroid_y: y,
                    error: error_of_sum(inside(layer, mask).map(|p| mean_rgb(*p))) / all_light,
                    share_there,
                    error_there,
                });
            }
        }
    }
    Ok(Depths { images, differences, classes, request, sharp })
}

/// The pixels of the whole image and of each kind of object that it shows.
fn regions(scene: &Scene, request: &Request) -> Vec<(&'static str, Vec<bool>)> {
    let objects = ObjectIdBuffer::new(scene, request);
    std::iter::once((ALL, vec![true; objects.pixels.len()]))
        .chain(Kind::ALL.map(|kind| (kind.name(), objects.mask(kind))))
        .filter(|(_, mask)| mask.contains(&true))
        .collect()
}

/// The images of all depths alone, which takes a fraction of the memory of their path classes.
pub struct Series {
    /// In the order of [`DEPTHS`].
    pub images: Vec<Image>,
    /// Radiance by depth and kind of object.
    pub rows: Vec<RadianceRow>,
    pub dropped: Dropped,
}

/// Renders the scene once, as deep as [`DEPTHS`] go, and sums its light by the number of scatterings.
pub fn series(scene: &Scene, request: &Request, settings: &Settings) -> Result<Series> {
    let request = Request { max_depth: DEPTHS[DEPTHS.len() - 1], ..*request };
    let by_length = Settings { paths: Some(PathClasses::by_length(CLASS_DEPTH)), ..*settings };
    let film = render(scene, &request, &by_length, &Silent)?.part.film;
    interrupt::check()?;
    let mut so_far = vec![DVec3::ZERO; request.width * request.height];
    let image = |(_, layer): (String, Image)| {
        add(&mut so_far, layer.pixels());
        Image::from_pixels(request.width, request.height, so_far.iter().map(|p| p.as_vec3()).collect())
    };
    let images: Vec<Image> = film.path_layers().into_iter().map(image).collect();
    let regions = regions(scene, &request);
    let all_light = light(images[images.len() - 1].pixels(), &regions[0].1);
    let rows = DEPTHS.iter().zip(&images).flat_map(|(&depth, image)| {
        regions.iter().map(move |(seen_on, mask)| row(depth, seen_on, mask, image, all_light))
    });
    Ok(Series { rows: rows.collect(), images, dropped: film.dropped() })
}

/// Mean light of an image.
pub fn mean(image: &Image) -> f64 {
    image.pixels().iter().map(|p| mean_rgb(*p)).sum::<f64>() / image.pixels().len() as f64
}

/// The smallest depth with this path class: the number of its scatterings.
fn appears_at(class: &str) -> u32 {
    if class == "rest" { DEPTHS[DEPTHS.len() - 1] } else { class.len() as u32 - 2 }
}

fn row(depth: u32, seen_on: &'static str, mask: &[bool], image: &Image, all_light: f64) -> RadianceRow {
    let pixels: Vec<DVec3> = inside(image.pixels(), mask).map(|p| p.as_dvec3()).collect();
    let sum: DVec3 = pixels.iter().sum();
    let mean = sum / pixels.len() as f64;
    RadianceRow {
        depth,
        seen_on,
        pixels: pixels.len(),
        mean_r: mean.x,
        mean_g: mean.y,
        mean_b: mean.z,
        share_of_light: sum.element_sum() / 3.0 / all_light,
    }
}

fn add(sum: &mut [DVec3], pixels: &[Rgb]) {
    sum.iter_mut().zip(pixels).for_each(|(sum, p)| *sum += p.as_dvec3());
}

/// The sum of (R + G + B) / 3 over the pixels of `mask`.
fn light(pixels: &[Rgb], mask: &[bool]) -> f64 {
    inside(pixels, mask).map(|p| mean_rgb(*p)).sum()
}

fn centroid(pixels: &[Rgb], width: usize, mask: &[bool], light: f64) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for (i, p) in inside(pixels.iter().enumerate(), mask) {
        let weight = mean_rgb(*p);
        let at = [i % width, i / width];
        (0..2).for_each(|c| sum[c] += weight * (at[c] as f64 + 0.5));
    }
    sum.map(|s| s / light)
}

/// Which pixels of `mask` have the middle half of a layer's light along both axes. Single bright pixels far from all others
/// do not move these quantiles.
fn bright(pixels: &[Rgb], width: usize, mask: &[bool], light: f64) -> Vec<bool> {
    let at = |i: usize| [i % width, i / width];
    let mut sums = [width, pixels.len() / width].map(|lines| vec![0.0; lines]);
    for (i, p) in inside(pixels.iter().enumerate(), mask) {
        (0..2).for_each(|c| sums[c][at(i)[c]] += mean_rgb(*p));
    }
    let middle = sums.map(|lines| {
        let mut below = 0.0;
        let is_in_middle = |line: f64| {
            let from = below;
            below += line / light;
            below > 0.25 && from < 0.75
        };
        lines.into_iter().map(is_in_middle).collect::<Vec<bool>>()
    });
    mask.iter().enumerate().map(|(i, inside)| *inside && (0..2).all(|c| middle[c][at(i)[c]])).collect()
}

/// The share of a part in the light of the pixels of `mask`, and the standard error of its distance from `bound`: that of
/// part − bound · whole, over the whole (Fieller, "Some Problems in Interval Estimation", 1954).
pub fn share_with_error(part: &[Rgb], whole: &[Rgb], mask: &[bool], bound: f64) -> [f64; 2] {
    let excess = inside(part.iter().zip(whole), mask).map(|(part, whole)| mean_rgb(*part) - bound * mean_rgb(*whole));
    let all = light(whole, mask);
    [light(part, mask) / all, error_of_sum(excess) / all]
}

/// The standard error of a sum of pixels row by row, from the differences of neighbours: their noise, and what structure adds to it.
/// Beyond the ends it is dark, so that a pixel alone is as uncertain as it is bright.
///
/// Source: von Neumann, "Distribution of the Ratio of the Mean Square Successive Difference to the Variance", 1941.
fn error_of_sum(pixels: impl Iterator<Item = f64>) -> f64 {
    let (squares, last) = pixels.fold((0.0, 0.0), |(sum, before), p| (sum + (p - before) * (p - before), p));
    ((squares + last * last) / 2.0).sqrt()
}

/// How a render that ends after `m` scatterings compares with a deep one of the same samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truncation {
    /// Light of more than m scatterings in the one that ends there.
    pub beyond: f64,
    /// Largest difference of a channel between it and the classes of at most m scatterings in the deep one.
    pub largest_difference: f64,
}

/// Renders a scene to depth `m` and deeper.
pub fn truncation(scene: &Scene, request: &Request, settings: &Settings, m: u32) -> Result<Truncation> {
    let settings = Settings { paths: Some(PathClasses::up_to(m + 1)), ..*settings };
    let to = |max_depth: u32| {
        let rendered = render(scene, &Request { max_depth, ..*request }, &settings, &Silent)?;
        Ok::<_, Error>((rendered.part.film.path_layers(), rendered.image))
    };
    let (deep, _) = to(m + 3)?;
    let (layers, image) = to(m)?;
    let everything = vec![true; image.pixels().len()];
    let within = |name: &str| name != "rest" && appears_at(name) <= m;
    let beyond =
        layers.iter().filter(|(name, _)| !within(name)).map(|(_, layer)| light(layer.pixels(), &everything)).sum();
    let mut sum = vec![DVec3::ZERO; image.pixels().len()];
    for (_, layer) in deep.iter().filter(|(name, _)| within(name)) {
        add(&mut sum, layer.pixels());
    }
    let differences = sum.iter().zip(image.pixels()).map(|(s, p)| (*s - p.as_dvec3()).abs().max_element());
    Ok(Truncation { beyond, largest_difference: differences.fold(0.0, f64::max) })
}

/// The mean radiance of an image that shows the area lights alone, exact where nothing hides them: radiance times the
/// projected area of each, over the area of the image.
pub fn visible_area_lights(scene: &Scene) -> f64 {
    let camera = &scene.camera;
    let Projection::Perspective { tan_half_width, tan_half_height } = camera.projection else { return f64::NAN };
    let film = |p: DVec3| {
        let d = p - camera.position;
        let depth = d.dot(camera.forward);
        [d.dot(camera.right) / (depth * tan_half_width), d.dot(camera.up) / (depth * tan_half_height)]
    };
    let light = |object: &Object| {
        let (Shape::Rectangle(rectangle), Some(emission)) = (&object.shape, object.emission) else { return 0.0 };
        let corners = rectangle.corners().map(|c| film(c.as_dvec3()));
        // Twice the area of the projected quadrilateral (shoelace formula).
        let twice: f64 = (0..4)
            .map(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % 4]);
                a[0] * b[1] - a[1] * b[0]
            })
            .sum();
        let towards = (camera.position - rectangle.centre().as_dvec3()).dot(rectangle.normal().as_dvec3()) > 0.0;
        let radiance = if towards || emission.two_sided { emission.radiance.as_dvec3() } else { DVec3::ZERO };
        // The film's area is 4.
        radiance.element_sum() / 3.0 * twice.abs() / 8.0
    };
    scene.objects.iter().map(light).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::sampling::stream::{Independent, Stream};
    use etalon_core::scene::builtin;

    fn small() -> (Scene, Request) {
        let (scene, request) = builtin::cornell_spheres();
        (scene, Request { width: 60, height: 45, spp: 8, ..request })
    }

    #[test]
    fn a_shallow_render_is_the_beginning_of_a_deep_one() {
        let (scene, request) = small();
        for m in 0..4 {
            let t = truncation(&scene, &request, &Settings::default(), m).unwrap();
            assert_eq!(t.beyond, 0.0, "{m}");
            assert!(t.largest_difference < 1e-5, "{m}: {t:?}");
        }
    }

    #[test]
    fn depths_add_up_and_nothing_is_counted_twice() {
        let (scene, request) = small();
        let d = depths(&scene, &request, &Settings::default()).unwrap();
        assert!(DEPTHS.windows(2).all(|pair| d.mean(pair[0]) < d.mean(pair[1])));
        let total: f64 = d.classes.iter().filter(|r| r.seen_on == ALL).map(|r| r.share_of_light).sum();
        let by_kind: f64 = d.classes.iter().filter(|r| r.seen_on != ALL).map(|r| r.share_of_light).sum();
        // The image is rounded to f32.
        assert!((total - 1.0).abs() < f64::from(f32::EPSILON), "{total}");
        assert!(by_kind < 1.0 && by_kind > 0.95, "pixels that show nothing at their centre: {by_kind}");
        for depth in DEPTHS {
            let shares = d.classes.iter().filter(|r| r.seen_on == ALL && r.depth == depth);
            let sum: f64 = shares.map(|r| r.share_of_difference).sum();
            assert!((sum - 1.0).abs() < 1e-6, "{depth}: {sum}");
        }
        let light = |on: &str| d.class("LDSSE", on).map_or(0.0, |r| r.share_of_light);
        assert!(light("glass") > 30.0 * light("room"), "only rims show on walls what is visible through glass");
    }

    #[test]
    fn a_far_bright_pixel_does_not_move_the_place_of_a_class() {
        const SIZE: [usize; 2] = [40, 30];
        let is_spot = |i: usize| (5..9).contains(&(i % SIZE[0])) && (10..13).contains(&(i / SIZE[0]));
        let pixels = SIZE[0] * SIZE[1];
        let mut layer: Vec<Rgb> = (0..pixels).map(|i| if is_spot(i) { Rgb::ONE } else { Rgb::ZERO }).collect();
        layer[pixels - 1] = Rgb::splat(1.2);
        let mask = vec![true; pixels];
        let place = bright(&layer, SIZE[0], &mask, light(&layer, &mask));
        let (inside, outside): (Vec<_>, Vec<_>) = (0..pixels).filter(|&i| place[i]).partition(|&i| is_spot(i));
        assert!(inside.len() >= 6 && outside.is_empty(), "{inside:?} {outside:?}");
    }

    /// Pixels with noise on a slope, many times: the squares of the errors over the standard errors are 1 in the mean.
    #[test]
    fn the_error_of_a_share_is_that_of_the_noise() {
        const PIXELS: u32 = 1000;
        const TIMES: u64 = 400;
        let (mask, bound) = (vec![true; PIXELS as usize], 0.25);
        let z = |seed: u64| {
            let pixel = |i: u32| {
                let [u, v] = Independent::new(seed, u64::from(i), 0).pair(0);
                let slope = 0.5 + f64::from(i) / f64::from(PIXELS);
                let part = slope * (0.5 + u);
                [part, part + 3.0 * slope * (0.5 + v)].map(|light| Rgb::splat(light as f32))
            };
            let [part, whole] = [0, 1].map(|k| (0..PIXELS).map(|i| pixel(i)[k]).collect::<Vec<_>>());
            let [share, error] = share_with_error(&part, &whole, &mask, bound);
            (share - bound) / error
        };
        let square = (0..TIMES).map(|seed| z(seed).powi(2)).sum::<f64>() / TIMES as f64;
        assert!((square - 1.0).abs() < 4.0 * (2.0 / TIMES as f64).sqrt(), "{square}");
        let alone = share_with_error(&[Rgb::ONE], &[Rgb::ONE], &[true], 0.0);
        assert_eq!(alone, [1.0, 1.0], "a pixel alone may be chance");
    }

    #[test]
    fn the_area_light_covers_its_projection() {
        let (scene, request) = small();
        let request = Request { spp: 64, max_depth: 0, ..request };
        let image = render(&scene, &request, &Settings::default(), &Silent).unwrap().image;
        let mean = light(image.pixels(), &vec![true; image.pixels().len()]) / image.pixels().len() as f64;
        assert!((mean / visible_area_lights(&scene) - 1.0).abs() < 5e-3, "{mean} {}", visible_area_lights(&scene));
    }
}
