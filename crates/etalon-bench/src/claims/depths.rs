//! What the second report sees appear at each maximum depth: where each path class is bright, and its share of the light there.
//!
//! One set of paths finds the place, another measures it: the place is not chosen by the noise that is measured.

use super::paths::{Event, Filter, Path, PixelLight, Place, SPLIT, Tally, View, begins, word};
use super::{Bound, Claim, Finding, SIGMAS, Share, Text, VISIBLE, percent, texts};
use crate::depth::{DEPTHS, Depths};
use crate::object_ids::{Kind, ObjectIdBuffer};
use crate::sampling_strategies::quotient;
use Event::{Ceiling, Diffuse, Internal, Mirror, Reflected, Refracted, RightWall, Specular};
use etalon_core::error::Result;
use etalon_core::interrupt;
use etalon_core::math::{Rgb, mean_rgb};
use etalon_core::raster::Image;
use etalon_core::scene::{Request, Scene};
use etalon_stats::Extremes;
use glam::DVec3;

/// A path class that the report sees appear at a depth.
struct Feature {
    text: Text,
    depth: u32,
    /// From the eye.
    events: &'static [Event],
    /// What else is claimed.
    also: fn(&Measured) -> Vec<Finding>,
    /// Title of its picture, if the claim is about a place.
    picture: Option<&'static str>,
}

impl Feature {
    const fn new(depth: u32, text: Text, events: &'static [Event]) -> Self {
        Self { text, depth, events, also: |_| Vec::new(), picture: None }
    }

    const fn at(self, picture: &'static str) -> Self {
        Self { picture: Some(picture), ..self }
    }

    const fn and(self, also: fn(&Measured) -> Vec<Finding>) -> Self {
        Self { also, ..self }
    }
}

/// Walls on the outside of the glass, and through it.
const REFLECTION: &[Event] = &[Reflected, Diffuse];
const REFRACTION: &[Event] = &[Refracted, Refracted, Diffuse];

/// The features in the order of the report.
const FEATURES: [Feature; 15] = [
    Feature::new(1, texts::WALLS, &[Diffuse]),
    Feature::new(1, texts::LIGHT_IN_MIRROR, &[Mirror]),
    Feature::new(1, texts::LIGHT_ON_GLASS, &[Reflected]),
    Feature::new(2, texts::CEILING, &[Ceiling, Diffuse]),
    Feature::new(2, texts::WALLS_IN_MIRROR, &[Mirror, Diffuse]),
    Feature::new(2, texts::GLASS_IN_MIRROR, &[Mirror, Reflected]),
    Feature::new(2, texts::WALLS_ON_GLASS, REFLECTION),
    Feature::new(2, texts::WHITE_SPOT, &[Reflected, Mirror])
        .at("white spot on the left of the glass sphere")
        .and(white_and_left),
    Feature::new(3, texts::CEILING_IN_MIRROR, &[Mirror, Ceiling, Diffuse]),
    Feature::new(3, texts::WALLS_THROUGH_GLASS, REFRACTION),
    Feature::new(3, texts::CAUSTIC, &[Diffuse, Refracted, Refracted]),
    Feature::new(4, texts::GLASS_IN_MIRROR_WALLS, &[Mirror, Refracted, Refracted, Diffuse]),
    Feature::new(4, texts::CAUSTIC_IN_MIRROR, &[Mirror, Diffuse, Refracted, Refracted]).at("caustic in the mirror"),
    Feature::new(4, texts::BLUE_WALL, &[RightWall, Refracted, Refracted, Mirror]).at("spot on the blue wall").and(low),
    Feature::new(4, texts::CAUSTIC_ON_GLASS, &[Reflected, Diffuse, Refracted, Refracted])
        .at("caustic on the outside of the glass"),
];

/// A place that a claim is about.
pub struct PlacePicture {
    /// What is there.
    pub title: &'static str,
    /// The class, from the light to the eye.
    pub word: String,
    /// The depth of the image in which it appears.
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

/// Light measured by paths and by the renderer.
pub struct Agreement {
    /// What it is.
    pub name: String,
    /// Difference in standard errors.
    pub z: f64,
}

/// The claims on depths, what is seen of them, and how well the study agrees with the renderer.
#[derive(Default)]
pub struct DepthClaims {
    /// In the order of the report.
    pub claims: Vec<Claim>,
    /// Pictures of the claims that are about a place.
    pub pictures: Vec<PlacePicture>,
    /// Places of which there is no picture: no light of their class was found.
    pub unseen: Vec<&'static str>,
    /// Agreement in the classes that both measure.
    pub agreement: Vec<Agreement>,
}

/// Tests the claims on the scene of which `depths` are the images, by about `paths` paths for each class
/// and a quarter of them for each place, where all paths are followed.
///
/// # Errors
/// [`Error::Interrupted`](etalon_core::error::Error::Interrupted).
pub fn depth_claims(scene: &Scene, depths: &Depths, paths: usize, seed: u64) -> Result<DepthClaims> {
    let Some(view) = View::new(scene, &depths.request) else {
        let remark = "The scene has no rectangle that emits light.";
        let claim = |feature: &Feature| Text { remark, ..feature.text }.with([]);
        let unseen = FEATURES.iter().filter_map(|feature| feature.picture).collect();
        return Ok(DepthClaims { claims: FEATURES.iter().map(claim).collect(), unseen, ..DepthClaims::default() });
    };
    let tracer = Tracer { view, depths, paths, seed };
    let mut measured = Vec::new();
    for feature in &FEATURES {
        interrupt::check()?;
        measured.push(tracer.measure(feature.events, feature.depth));
    }
    let light: f64 = depths.mean(DEPTHS[DEPTHS.len() - 1]) * (depths.request.width * depths.request.height) as f64;
    let claim = |(feature, measured): (&Feature, &Measured)| {
        let of_all = percent(measured.whole.sum[0] / light);
        let what = format!("share of {} in the light there ({of_all} of all light)", word(feature.events));
        let share = measured.here.share().finding(what, Bound::AtLeast(VISIBLE));
        feature.text.with([vec![share], (feature.also)(measured)].concat())
    };
    let mut claims: Vec<Claim> = FEATURES.iter().zip(&measured).map(claim).collect();
    let fourth = claims.iter().position(|claim| claim.text == texts::GLASS_IN_MIRROR_WALLS).unwrap_or(0);
    claims.splice(fourth..fourth, [tracer.gone(), outshone(&measured)]);
    claims.insert(0, alone(scene, depths));
    claims.push(nothing_else(depths));
    let mut done = DepthClaims { claims, agreement: tracer.agreement(light), ..DepthClaims::default() };
    let gone = tracer.measure(REFLECTION, 3);
    if gone.whole.sum[0] > 0.0 {
        done.pictures.push(tracer.picture("the reflection that the report calls gone", &gone));
    }
    for (feature, measured) in FEATURES.iter().zip(&measured) {
        match feature.picture {
            Some(title) if measured.whole.sum[0] > 0.0 => done.pictures.push(tracer.picture(title, measured)),
            unseen => done.unseen.extend(unseen),
        }
    }
    tracer.glazing(&mut done);
    done.claims.push(brighter(depths));
    Ok(done)
}

/// The light of a class: all of it, and that in the place where it is bright.
struct Measured {
    events: &'static [Event],
    depth: u32,
    width: usize,
    /// Pixels that show in their centre what the class is seen on.
    pixels: Vec<usize>,
    /// All of its light.
    whole: Tally<1>,
    place: Place,
    /// The class and all other paths of at most this depth in the place, by other paths.
    here: Tally<2>,
}

impl Measured {
    /// Centroid of the class in its place minus the middle of the object that shows it, along an axis, with its standard error.
    fn offset(&self, axis: usize) -> [f64; 2] {
        let Spread { mean, error, .. } = Spread::of(&self.here.pixels, self.width, axis);
        let middle = self.pixels.iter().map(|i| [i % self.width, i / self.width][axis] as f64 + 0.5).sum::<f64>();
        [mean - middle / self.pixels.len() as f64, error]
    }
}

/// Where light is along an axis of the image.
struct Spread {
    mean: f64,
    /// Standard error of the mean.
    error: f64,
    deviation: f64,
}

impl Spread {
    fn of(light: &[PixelLight], width: usize, axis: usize) -> Self {
        let at = |p: &PixelLight| [p.index % width, p.index / width][axis] as f64 + 0.5;
        let sum = |f: &dyn Fn(&PixelLight) -> f64| light.iter().map(f).sum::<f64>();
        let total = sum(&|p| p.radiance.element_sum());
        let mean = sum(&|p| p.radiance.element_sum() * at(p)) / total;
        let variance = sum(&|p| p.radiance.element_sum() * (at(p) - mean).powi(2)) / total;
        let error = sum(&|p| p.variance * (at(p) - mean).powi(2)).sqrt() * 3.0 / total;
        Self { mean, error, deviation: variance.sqrt() }
    }
}

/// What traces paths, and the images of the renderer.
struct Tracer<'a> {
    view: View<'a>,
    depths: &'a Depths,
    paths: usize,
    seed: u64,
}

impl Tracer<'_> {
    /// Light of a class and of all other paths of at most this depth.
    fn class_and_rest(&self, pixels: &[usize], class: &[Event], depth: u32) -> Tally<2> {
        let kinds = |path: &Path| {
            let is_of_class = path.events.len() == class.len() && begins(&path.events, class);
            [is_of_class, !is_of_class]
        };
        let filter = Filter { lengths: 1..=depth as usize, follow: &|_| true, kinds: &kinds, split: SPLIT };
        self.view.trace(pixels, self.paths / 4, self.seed.wrapping_add(1), &filter)
    }

    /// Light of a class alone.
    fn class(&self, pixels: &[usize], class: &[Event], paths: usize, split: usize) -> Tally<1> {
        let follow = |events: &[Event]| begins(events, class);
        let filter = Filter { lengths: class.len()..=class.len(), follow: &follow, kinds: &|_| [true], split };
        self.view.trace(pixels, paths, self.seed, &filter)
    }

    fn measure(&self, events: &'static [Event], depth: u32) -> Measured {
        let pixels = self.view.pixels(events[0]);
        let whole = self.class(&pixels, events, self.paths, SPLIT);
        // Within 1.5 standard deviations of the centroid; an empty place where there is no light
        let (mut place, Request { width, height, .. }) = (Place::default(), self.depths.request);
        for (axis, size) in [width, height].into_iter().enumerate() {
            let Spread { mean, deviation, .. } = Spread::of(&whole.pixels, width, axis);
            place.from[axis] = (mean - 1.5 * deviation).floor().at_least(0.0) as usize;
            place.to[axis] = ((mean + 1.5 * deviation).ceil() as usize).min(size);
        }
        let here = self.class_and_rest(&self.view.within(&pixels, &place), events, depth);
        Measured { events, depth, width, pixels, whole, place, here }
    }

    fn picture(&self, title: &'static str, measured: &Measured) -> PlacePicture {
        let Measured { events, depth, place, whole, here, .. } = measured;
        let pixels = whole.pixels.iter().chain(&here.pixels);
        let (word, class) = (word(events), self.image(pixels));
        PlacePicture { title, word, depth: *depth, class, place: *place, share: here.share(), z: self.z(*depth, here) }
    }

    /// The light of the first two kinds, which are all light of the image of a depth, minus that image, in standard errors.
    fn z<const N: usize>(&self, depth: u32, light: &Tally<N>) -> f64 {
        let (image, errors) = (self.depths.image(depth).pixels(), self.depths.standard_error.pixels());
        let sum = |of: &dyn Fn(usize) -> f64| light.pixels.iter().map(|pixel| of(pixel.index)).sum::<f64>();
        // Channels of a pixel err together.
        let [rendered, rendered_variance] = [sum(&|i| mean_rgb(image[i])), sum(&|i| mean_rgb(errors[i]).powi(2))];
        let variance = light.covariance[0][0] + 2.0 * light.covariance[0][1] + light.covariance[1][1];
        // Few samples may miss what is bright: their variance is at least that of as many paths here.
        let least = variance * f64::from(light.spp) / f64::from(self.depths.request.spp);
        (light.sum[0] + light.sum[1] - rendered) / (variance + rendered_variance.at_least(least)).sqrt()
    }

    /// An image of these pixels; of one that is there twice the latter counts.
    fn image<'l>(&self, pixels: impl Iterator<Item = &'l PixelLight>) -> Image {
        let Request { width, height, .. } = self.depths.request;
        let mut image = vec![Rgb::ZERO; width * height];
        pixels.for_each(|pixel| image[pixel.index] = pixel.radiance.as_vec3());
        Image::from_pixels(width, height, image)
    }

    fn gone(&self) -> Claim {
        let pixels = self.view.pixels(Reflected);
        let [before, share] = [2, 3].map(|depth| self.class_and_rest(&pixels, REFLECTION, depth).share());
        let (word, before) = (word(REFLECTION), percent(before.value));
        let what = format!("share of {word} in the light of the glass sphere at depth 3 (at depth 2: {before})");
        texts::REFLECTION_GONE.with([share.finding(what, Bound::AtMost(VISIBLE))])
    }

    /// Classes that the renderer measures, too, which does not distinguish what is specular.
    fn agreement(&self, light: f64) -> Vec<Agreement> {
        let compared: [(_, &[Event]); 4] = [
            (Mirror, &[Specular, Diffuse]),
            (Reflected, &[Specular, Diffuse]),
            (Reflected, &[Specular, Specular, Diffuse]),
            (Reflected, &[Specular, Specular]),
        ];
        let agreement = |(first, class): (Event, &[Event])| {
            let (pixels, word) = (self.view.pixels(first), word(class));
            let seen_on = if first == Mirror { Kind::Mirror } else { Kind::Glass }.name();
            let rendered = self.depths.class(&word, seen_on).map_or(f64::NAN, |row| row.share_of_light * light);
            // As many paths as the renderer's, which has more light samples: its variance is no larger.
            let [sum, error] = self.class(&pixels, class, pixels.len() * self.depths.request.spp as usize, 0).of(0);
            let z = (sum - rendered) / (2.0 * error * error).sqrt();
            Agreement { name: format!("{word} on the {seen_on} sphere"), z }
        };
        compared.map(agreement).into()
    }

    /// Tests whether longer paths brighten the top of the glass sphere, and whether its outside reflects them.
    fn glazing(&self, done: &mut DepthClaims) {
        /// Events of the longest path of a class of its own, and of the longest of all.
        const BEYOND: u32 = 5;
        const LONGEST: u32 = DEPTHS[DEPTHS.len() - 1];
        /// Brewster's angle of the glass, beyond which reflection rises: from there on incidence is called grazing.
        const GRAZING_DEG: f64 = 55.4;
        let (glass, width) = (self.view.pixels(Reflected), self.depths.request.width);
        let [Some(first), Some(last)] = [glass.first(), glass.last()].map(|i| i.map(|i| i / width)) else { return };
        let below = first + (last - first) / 3;
        let top = self.view.within(&glass, &Place { from: [0, first], to: [width, below] });
        let columns = || top.iter().map(|i| i % width);
        let [left, right] = [columns().min().unwrap_or(0), columns().max().map_or(0, |x| x + 1)];
        let limit = GRAZING_DEG.to_radians().cos() as f32;
        let kinds = |path: &Path| {
            let is_long = path.events.len() > BEYOND as usize;
            let is_reflected = is_long && path.events[0] == Reflected;
            let is_internal = path.events.iter().take_while(|e| !e.is_diffuse()).any(|e| *e == Internal);
            [is_long, !is_long, is_reflected, is_reflected && path.first_cos < limit, is_long && is_internal]
        };
        let filter = Filter { lengths: 1..=LONGEST as usize, follow: &|_| true, kinds: &kinds, split: SPLIT };
        let light = self.view.trace(&top, self.paths / 8, self.seed, &filter);
        let everywhere = 1.0 - self.depths.mean(BEYOND) / self.depths.mean(LONGEST);
        let [of_image, internal] = [everywhere, light.sum[4] / light.sum[0]].map(percent);
        let visible =
            format!("share of longer paths in the light of the sphere's upper third (of the image: {of_image})");
        let part = |what: &str, kind: usize| {
            Finding::estimated(what, light.of(kind).map(|v| v / light.sum[0]), Bound::AtLeast(0.5)).in_percent()
        };
        let outside = "share of it that the outside reflects";
        let grazing = format!("{outside} beyond {GRAZING_DEG}° (reflected inside: {internal})");
        done.claims.extend([
            texts::GLAZING.with([light.share().finding(visible, Bound::AtLeast(everywhere + VISIBLE))]),
            texts::GLAZING_OUTSIDE.with([part(outside, 2), part(&grazing, 3)]),
        ]);
        done.pictures.push(PlacePicture {
            title: "the glazing on the glass sphere",
            word: format!("paths of more than {BEYOND} events"),
            depth: LONGEST,
            class: self.image(light.pixels.iter()),
            place: Place { from: [left, first], to: [right, below] },
            share: light.share(),
            z: self.z(LONGEST, &light),
        });
    }
}

/// The class is white and left of the middle of the sphere.
fn white_and_left(measured: &Measured) -> Vec<Finding> {
    let colour: DVec3 = measured.here.pixels.iter().map(|pixel| pixel.radiance).sum();
    let from_white = (colour / (colour.element_sum() / 3.0) - 1.0).abs().max_element();
    let left = "its column minus the sphere's middle (pixels)";
    vec![
        Finding::estimated(left, measured.offset(0), Bound::AtMost(0.0)),
        Finding::exact("largest difference of a channel from white", from_white, Bound::AtMost(VISIBLE)).in_percent(),
    ]
}

/// The class is below the middle of the wall.
fn low(measured: &Measured) -> Vec<Finding> {
    vec![Finding::estimated("its row minus the wall's middle (pixels)", measured.offset(1), Bound::AtLeast(0.0))]
}

/// "Much larger" is a factor of 10.
fn outshone(measured: &[Measured]) -> Claim {
    let light = |class: &[Event]| measured.iter().find(|m| m.events == class).map_or([f64::NAN; 2], |m| m.whole.of(0));
    let what = format!("light of {} over that of {}", word(REFRACTION), word(REFLECTION));
    let ratio = quotient(light(REFRACTION), light(REFLECTION));
    texts::REFRACTION.with([Finding::estimated(what, ratio, Bound::AtLeast(10.0))])
}

fn alone(scene: &Scene, depths: &Depths) -> Claim {
    let objects = ObjectIdBuffer::new(scene, &depths.request);
    // Pixels beside the light show a part of it.
    let distance = objects.depth_inside(&objects.mask(Kind::AreaLight), 2);
    let lit =
        depths.images[0].pixels().iter().zip(&distance).filter(|(p, d)| mean_rgb(**p) > 0.0 && **d < -1.5).count();
    texts::LIGHT_ALONE.with([Finding::exact("other pixels with light", lit as f64, Bound::AtMost(0.0))])
}

/// "Feature" is not defined: light with sharp outlines, and any light that brightens some blocks of pixels more than others.
fn nothing_else(depths: &Depths) -> Claim {
    const BLOCK: usize = 16;
    let place = DEPTHS.iter().position(|d| *d == 5).unwrap_or(0);
    let image = &depths.images[place];
    let (width, height) = (image.width(), image.height());
    let corners = (0..height).step_by(BLOCK).flat_map(|y| (0..width).step_by(BLOCK).map(move |x| [x, y]));
    let pixels = corners.map(|[left, top]| -> Vec<usize> {
        let row = |y: usize| (left..width.min(left + BLOCK)).map(move |x| y * width + x);
        (top..height.min(top + BLOCK)).flat_map(row).collect()
    });
    let light =
        |image: &Image, block: &[usize]| -> Vec<f64> { block.iter().map(|&i| mean_rgb(image.pixels()[i])).collect() };
    let blocks: Vec<Vec<usize>> = pixels.filter(|block| light(image, block).iter().sum::<f64>() > 0.0).collect();
    let finding = |what: &str, added: &Image, everywhere: f64| {
        let is_visible = |block: &&Vec<usize>| {
            let (n, gains) = (block.len() as f64, light(added, block));
            let [gain, all] = [&gains, &light(image, block)].map(|values| values.iter().sum::<f64>() / n);
            let variance = gains.iter().map(|v| (v - gain).powi(2)).sum::<f64>() / (n * (n - 1.0));
            (gain - SIGMAS * variance.sqrt()) / all > everywhere + VISIBLE
        };
        let n = blocks.len() as f64;
        // As many exceed three standard errors by chance, at most, with three standard errors of their number.
        let chance = 1.35e-3;
        let limit = Bound::AtMost(chance + SIGMAS * f64::sqrt(chance * (1.0 - chance) / n));
        let what = format!("blocks of {BLOCK}×{BLOCK} pixels that gain {what}");
        Finding::exact(what, blocks.iter().filter(is_visible).count() as f64 / n, limit).in_percent()
    };
    let sharp = "2 % by light reflected diffusely at most once, with sharp outlines";
    let overall = 1.0 - depths.mean(4) / depths.mean(5);
    texts::NOTHING_ELSE.with([
        finding(sharp, &depths.sharp[place - 1], 0.0),
        finding("2 % more than the image", &depths.differences[place - 1], overall),
    ])
}

fn brighter(depths: &Depths) -> Claim {
    let steps: Vec<f64> = DEPTHS.windows(2).map(|pair| depths.mean(pair[1]) / depths.mean(pair[0]) - 1.0).collect();
    let list: Vec<String> = steps.iter().map(|step| percent(*step)).collect();
    let smallest = steps.iter().copied().fold(f64::INFINITY, f64::at_most);
    let what = format!("smallest increase of {}", list.join(", "));
    texts::INCREASES.with([Finding::exact(what, smallest, Bound::AtLeast(0.0)).in_percent()])
}

#[cfg(test)]
mod tests {
    use super::super::Verdict;
    use super::*;
    use crate::depth::depths;
    use etalon_core::scene::builtin;
    use etalon_render::Settings;

    fn tested((scene, request): (Scene, Request)) -> DepthClaims {
        let request = Request { width: 120, height: 90, spp: 32, ..request };
        let depths = depths(&scene, &request, &Settings::default()).unwrap();
        depth_claims(&scene, &depths, 1 << 15, 1).unwrap()
    }

    #[test]
    fn what_appears_at_each_depth_is_what_the_renderer_has() {
        let tested = tested(builtin::cornell_spheres());
        assert!(tested.agreement.len() == 4 && tested.agreement.iter().all(|a| a.z.abs() < 4.0));
        let z: Vec<f64> = tested.pictures.iter().map(|picture| picture.z).collect();
        assert!(z.len() == 6 && z.iter().all(|z| z.abs() < 4.0), "{z:?}");
        let verdict = |text| tested.claims.iter().find(|claim| claim.text == text).unwrap().verdict();
        assert_eq!(verdict(texts::WALLS_IN_MIRROR), Verdict::Holds);
        assert_eq!(verdict(texts::CAUSTIC), Verdict::Holds);
        assert_eq!(verdict(texts::GLAZING_OUTSIDE), Verdict::DoesNotHold);
    }

    #[test]
    fn claims_on_mirror_and_glass_do_not_hold_without_them() {
        let tested = tested(builtin::cornell_lambert());
        let (spheres, walls): (Vec<_>, Vec<_>) =
            tested.claims.iter().partition(|c| c.text.claim.contains("sphere") || c.text.claim.contains("glass"));
        assert!(spheres.len() > 8);
        for claim in spheres {
            assert!(![Verdict::Holds, Verdict::HoldsPartly].contains(&claim.verdict()), "{}", claim.text.claim);
        }
        assert!(walls.iter().any(|claim| claim.verdict() == Verdict::Holds), "the walls are there");
    }
}
