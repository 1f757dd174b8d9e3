//! Images of the path tracer against exact ones: furnaces, the sphere under an environment map, and each sampling strategy
//! against the others; faults that are put into images.
//!
//! Scenes are grey, so that one channel is enough. Every image is rendered in independent parts, whose differences
//! tell the error of each tile: light paths contribute to many pixels at once, so that the errors of pixels are not enough.

use super::super::case::{Case, Shared, direction_density};
use etalon_core::envmap::EnvMap;
use etalon_core::envmap::irradiance::IrradianceTree;
use etalon_core::envmap::samplers::MapSampling;
use etalon_core::envmap::synthetic::Synthetic;
use etalon_core::error::Result;
use etalon_core::math::Rgb;
use etalon_core::optics::microfacet::{Beckmann, Microfacet};
use etalon_core::raster::Image;
use etalon_core::sampling::hash;
use etalon_core::sampling::stream::StreamKind;
use etalon_core::scene::{
    Camera, Conductor, Dielectric, Distribution, Emission, EmitterVisibility, Environment, Material, Object,
    PixelFilter, Projection, Rectangle, Request, Scene, Shape, builtin,
};
use etalon_render::film::{Film, Pixel, PixelEstimate};
use etalon_render::{Dropped, Sampling, Settings, Silent, render};
use etalon_stats::cubature::integrate;
use etalon_stats::welch::{self, ImageComparison, Mean};
use etalon_stats::{Directions, Extremes, Grid, Outcome, Pole, Protocol, SampleCount};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;
use std::time::Instant;

/// The exact image of a test.
#[derive(Clone)]
pub enum Truth {
    /// This radiance in every pixel.
    Uniform(f64),
    /// The exact image of [`lit_sphere`]; pixels near the silhouette are left out.
    Sphere,
    /// The albedo of a rough metal with reflectance 1, in a furnace of radiance 1; see [`metal`].
    Metal,
    /// The same as with other settings.
    SameAs(Settings),
}

#[derive(Clone)]
pub struct RenderTest {
    pub scene: Scene,
    /// Resolution and depth; the samples per pixel follow from the protocol.
    pub request: Request,
    /// Settings of the renderer; seed and random numbers follow from the protocol.
    pub settings: Settings,
    pub truth: Truth,
    /// A fault in how the image is put together.
    pub plant: Option<Plant>,
}

/// Side of a tile in pixels.
const TILE: usize = 4;
/// Independent parts of a render.
const REPLICATES: u32 = 32;
/// Samples per pixel of the pilot render, whose noise decides the number of samples.
const PILOT: u32 = 32;
/// Fewest and most samples per pixel.
const RANGE: [u32; 2] = [32, 4096];
/// Fewest samples per pixel in each part of an image by adaptive sampling, which differs from uniform sampling only beyond 8.
const ADAPTED: u32 = 32;
/// How far the truth may be from the exact value, relatively: the quadratures behind it, and f32 in the renderer.
const PRECISION: f64 = 2e-5;
/// A test that cannot detect a bias of this size is inconclusive.
const COARSEST: f64 = 0.1;
/// Kurtosis of the tiles' deviations from which they do not count as normally distributed: for 16 tiles six standard
/// deviations from 3.
const HEAVY: f64 = 10.0;

impl RenderTest {
    pub fn case(self, name: impl Into<String>) -> Case {
        let is_sphere = matches!(self.truth, Truth::Sphere);
        let case = Case::new(name, move |protocol, round| self.examine(protocol, round, |_| ()));
        if is_sphere { Case { preparation: Some(Box::new(|| drop(lit_sphere_truth()))), ..case } } else { case }
    }

    /// One round of the test, as [`etalon_stats::examine`]. `spoil` changes the rendered tiles, to plant faults.
    pub fn examine(&self, protocol: &Protocol, round: u64, spoil: fn(&mut [[Mean; 2]])) -> Result<Outcome> {
        protocol.check()?;
        let start = Instant::now();
        let level = protocol.own_level();
        let uniform = |value: f64| vec![Some(value); self.request.width * self.request.height];
        let truth = match &self.truth {
            Truth::Sphere => lit_sphere_truth().to_vec(),
            Truth::Uniform(value) => uniform(*value),
            Truth::Metal => uniform(albedo()?),
            Truth::SameAs(_) => Vec::new(),
        };
        let compare = |spp: u32, pass: u64| -> Result<Found> {
            let seed = hash::key([protocol.seed, round, pass]);
            let (mut tiles, dropped) = self.tiles(spp, seed, &truth)?;
            spoil(&mut tiles);
            let mean = tiles.iter().map(|[_, b]| b.value).sum::<f64>() / tiles.len() as f64;
            let allowance = PRECISION * mean;
            Ok(Found { comparison: welch::compare(&tiles, allowance), allowance, dropped })
        };
        let pixels = self.request.width * self.request.height;
        // The detectable error falls with the root of the number of samples.
        let spp = match protocol.samples {
            SampleCount::Fixed(n) => (n / pixels as u64).min(u64::from(RANGE[1])) as u32,
            SampleCount::Detect(w) => compare(PILOT, 0)?
                .comparison
                .detectable(level)
                .map_or(PILOT, |found| (f64::from(PILOT) * (found / w).powi(2)).ceil().min(f64::from(RANGE[1])) as u32),
        };
        let fewest = if self.settings.adaptive { ADAPTED * REPLICATES } else { RANGE[0] };
        let spp = spp.max(fewest).next_multiple_of(REPLICATES);
        let found = compare(spp, 1)?;
        Ok(self.outcome(&found, spp, level, start))
    }

    fn outcome(&self, found: &Found, spp: u32, level: f64, start: Instant) -> Outcome {
        let Found { comparison: found, allowance, dropped } = found;
        let images = if matches!(self.truth, Truth::SameAs(_)) { 2 } else { 1 };
        let pixels = (self.request.width * self.request.height) as u64;
        let detectable = found.detectable(level).unwrap_or(PRECISION);
        let violation = match dropped.total() {
            0 => found
                .exact_difference
                .may_exceed(*allowance)
                .then(|| format!("tiles without noise have an error of {:.1e}", found.exact_difference)),
            n => Some(format!("{n} samples were not finite, or negative")),
        };
        let percent = 100.0 * detectable;
        // Too little power, or tails for which Welch's t is not valid.
        let inconclusive_reason = if detectable > COARSEST {
            Some(format!("too few samples: a bias of the image below {percent:.0} % would go unnoticed"))
        } else if found.kurtosis > HEAVY {
            Some(format!("tails too heavy for this test: the tiles' kurtosis is {:.1} instead of 3", found.kurtosis))
        } else {
            None
        };
        Outcome {
            statistic: found.statistic,
            dof: found.dof,
            p: Some(found.p),
            detectable: Some(detectable),
            seconds: start.elapsed().as_secs_f64(),
            cells: self.request.width.div_ceil(TILE) * self.request.height.div_ceil(TILE),
            pooled: found.dof,
            violation,
            inconclusive_reason,
            ..Outcome::open(u64::from(spp) * pixels * images)
        }
    }

    /// Tiles of the render beside those of the truth, and the samples that were dropped.
    fn tiles(&self, spp: u32, seed: u64, truth: &[Option<f64>]) -> Result<(Vec<[Mean; 2]>, Dropped)> {
        let request = Request { spp: spp / REPLICATES, ..self.request };
        let mut dropped = Dropped::default();
        let mut film = |settings: &Settings, seed: u64| -> Result<Film> {
            let settings = Settings { seed, stream: StreamKind::Independent, ..*settings };
            let film = render(&self.scene, &request, &settings, &Silent)?.part.film;
            dropped = dropped.merge(film.dropped());
            Ok(film)
        };
        // The tiles of each replicate: those of the render, and those of the render by other settings or of the exact image.
        let mut replicates = Vec::new();
        for replicate in 0..u64::from(REPLICATES) {
            let seed = hash::mix64(seed ^ replicate);
            let whole = film(&self.settings, seed)?;
            let tested = match self.plant {
                None => first_channel(&whole),
                Some(plant) => plant.image(&whole, &self.scene, &request, hash::mix64(!seed))?,
            };
            let other = match &self.truth {
                Truth::SameAs(settings) => {
                    first_channel(&film(settings, hash::mix64(seed))?).into_iter().map(Some).collect()
                }
                _ => truth.to_vec(),
            };
            let size = [self.request.width, self.request.height];
            let pair = |i: usize| other[i].map(|other| [tested[i], other].map(Mean::exact));
            replicates.push(welch::tiles(size, TILE, pair));
        }
        let tile = |i: usize| {
            [0, 1].map(|side| {
                let values: Vec<f64> = replicates.iter().map(|tiles| tiles[i][side].value).collect();
                Mean::of_replicates(&values).unwrap_or(replicates[0][i][side])
            })
        };
        Ok(((0..replicates[0].len()).map(tile).collect(), dropped))
    }
}

struct Found {
    comparison: ImageComparison,
    /// Differences up to this do not count.
    allowance: f64,
    dropped: Dropped,
}

/// The first channel of a film.
fn first_channel(film: &Film) -> Vec<f64> {
    film.image().pixels().iter().map(|pixel| f64::from(pixel.x)).collect()
}

/// The protocol for images with little noise: a share of the error is detected.
pub fn finer(protocol: &Protocol, share: f64) -> Protocol {
    let samples = match protocol.samples {
        SampleCount::Detect(w) => SampleCount::Detect(share * w),
        count @ SampleCount::Fixed(_) => count,
    };
    Protocol { samples, ..*protocol }
}

/// A small square image to that depth.
fn request(side: usize, max_depth: u32) -> Request {
    Request { width: side, height: side, spp: PILOT, light_samples: 1, max_depth }
}

/// Light of radiance 1 from everywhere.
fn furnace() -> Environment {
    Environment::upright(Arc::new(EnvMap::new(Image::from_fn(4, 2, |_, _| Rgb::ONE))), "constant", 1.0)
}

/// A sphere in the furnace.
fn sphere_in_furnace(material: Material, settings: Settings, max_depth: u32) -> RenderTest {
    let (mut scene, _) = builtin::sphere_env(furnace());
    scene.objects[0].material = material;
    RenderTest { scene, request: request(16, max_depth), settings, truth: Truth::Uniform(1.0), plant: None }
}

/// The view from inside an emitting sphere of albedo ½: radiance 1 + ½ + ¼ … up to the depth.
pub fn inside(max_depth: u32, settings: Settings) -> RenderTest {
    let (mut scene, _) = builtin::sphere_env(furnace());
    scene.environment = None;
    scene.camera.position = DVec3::ZERO;
    scene.camera.projection = Projection::Perspective { tan_half_width: 0.5, tan_half_height: 0.5 };
    scene.objects[0].material = Material::Diffuse { albedo: Rgb::splat(0.5) };
    scene.objects[0].emission =
        Some(Emission { radiance: Rgb::ONE, two_sided: true, visibility: EmitterVisibility::Sampled });
    let truth = Truth::Uniform(2.0 - 0.5f64.powi(max_depth.min(1000) as i32));
    RenderTest { scene, request: request(16, max_depth), settings, truth, plant: None }
}

const ALPHA: f64 = 0.5;
/// Angle between its normal and the view, in degrees.
const SEEN_AT: f64 = 60.0;

/// Rough metal of reflectance 1 in the furnace, viewed at 60°.
pub fn metal(settings: Settings) -> RenderTest {
    let (sin, cos) = SEEN_AT.to_radians().sin_cos();
    let wo = DVec3::new(sin, cos, 0.0);
    let camera = Camera {
        position: 3.0 * wo,
        right: DVec3::NEG_Z,
        up: DVec3::new(-cos, sin, 0.0),
        forward: -wo,
        projection: Projection::Orthographic { half_width: 0.1, half_height: 0.1 },
        filter: PixelFilter::default(),
    };
    let sheet = Rectangle::new(Vec3::ZERO, Vec3::Z, Vec3::X).expect("the sides are perpendicular");
    let distribution = Distribution::Beckmann;
    let conductor = Conductor::new(Rgb::ZERO, Rgb::ONE, ALPHA as f32, distribution);
    let scene = Scene {
        name: "sheet".into(),
        camera,
        objects: vec![Object::new(Shape::Rectangle(sheet), Material::Conductor(conductor))],
        lights: Vec::new(),
        environment: Some(furnace()),
    };
    RenderTest { scene, request: request(16, 2), settings, truth: Truth::Metal, plant: None }
}

/// Its albedo ∫ D G₂/(4 cos θₒ) dωᵢ: single scattering loses the rest.
fn albedo() -> Result<f64> {
    let (sin, cos) = SEEN_AT.to_radians().sin_cos();
    let (facets, wo) = (Beckmann::new(ALPHA), DVec3::new(sin, 0.0, cos));
    let reflected = direction_density(move |wi: DVec3| {
        let wm = (wo + wi).normalize();
        0.25 * facets.d(wm.to_array()) * facets.g2_over_cosines(wo.to_array(), wi.to_array()) * wi.z
    });
    let half = Directions::hemisphere(Pole::Z);
    Ok(integrate(&half, &reflected, &Grid::equal([8, 8], None))?.values.iter().sum())
}

/// The white sphere under a grey map with a sun.
pub fn lit_sphere(settings: Settings) -> RenderTest {
    let sun = Synthetic::Sun.make();
    let grey = Image::from_fn(sun.width(), sun.height(), |x, y| Rgb::splat(sun.get(x, y).element_sum() / 3.0));
    let (scene, _) = builtin::sphere_env(Environment::upright(Arc::new(EnvMap::new(grey)), "sun", 1.0));
    RenderTest { scene, request: request(24, 1), settings, truth: Truth::Sphere, plant: None }
}

/// Its exact image, which takes longer than a render and is the same for all.
fn lit_sphere_truth() -> Arc<Vec<Option<f64>>> {
    static TRUTH: Shared<Vec<Option<f64>>> = Shared::new();
    TRUTH.get(|| {
        let RenderTest { scene, request, .. } = lit_sphere(Settings::default());
        lit_sphere_image(&scene, &request)
    })
}

/// The second report's Cornell box in grey, by one strategy and by another.
fn cornell_box(settings: Settings, other: Settings) -> RenderTest {
    let (mut scene, _) = builtin::cornell_spheres();
    for object in &mut scene.objects {
        if let Material::Diffuse { albedo } = &mut object.material {
            *albedo = Rgb::splat(albedo.element_sum() / 3.0);
        }
    }
    RenderTest {
        scene,
        request: Request { width: 32, ..request(24, 4) },
        settings,
        truth: Truth::SameAs(other),
        plant: None,
    }
}

pub fn cases() -> Vec<Case> {
    let by = |sampling, density| Settings { sampling, density: Some(density), ..Settings::default() };
    let bsdf = by(Sampling::Bsdf, MapSampling::COSINE);
    let white = Material::Diffuse { albedo: Rgb::ONE };
    let glass = Material::Dielectric(Dielectric::clear(1.45));
    let mut tests = vec![
        (
            "furnace/diffuse/light".to_owned(),
            sphere_in_furnace(white.clone(), by(Sampling::Light, MapSampling::MAP), 1),
        ),
        ("furnace/diffuse/mis".into(), sphere_in_furnace(white.clone(), by(Sampling::Mis, MapSampling::MAP), 1)),
        ("furnace/diffuse/hemisphere".into(), sphere_in_furnace(white, by(Sampling::Hemisphere, MapSampling::MAP), 1)),
        ("furnace/glass".into(), sphere_in_furnace(glass, bsdf, 1000)),
        ("furnace/metal/bsdf".into(), metal(bsdf)),
        ("furnace/metal/mis".into(), metal(by(Sampling::Mis, MapSampling::MAP))),
    ];
    for depth in [1, 3, 100] {
        let settings = by(Sampling::Hemisphere, MapSampling::COSINE);
        tests.push((format!("furnace/inside/{depth}"), inside(depth, settings)));
    }
    for (name, sampling, density) in [
        ("cosine", Sampling::Light, MapSampling::COSINE),
        ("map", Sampling::Light, MapSampling::MAP),
        ("mis", Sampling::Mis, MapSampling::MAP),
        ("cosine-compensated", Sampling::Mis, MapSampling::COSINE_COMPENSATED),
    ] {
        tests.push((format!("sphere/{name}"), lit_sphere(by(sampling, density))));
    }
    for (name, sampling) in [("light", Sampling::Light), ("bsdf", Sampling::Bsdf), ("hemisphere", Sampling::Hemisphere)]
    {
        let other = Settings { sampling, ..Settings::default() };
        tests.push((format!("room/mis+lt-{name}"), cornell_box(Settings::default(), other)));
    }
    tests.into_iter().map(|(name, test)| test.case(format!("render/{name}"))).collect()
}

/// (1/π) E(n) of the sphere's map, averaged over each pixel by Gauss's rule of three points an axis.
fn lit_sphere_image(scene: &Scene, request: &Request) -> Vec<Option<f64>> {
    const NODES: [(f64, f64); 3] =
        [(-0.774_596_669_241_483_4, 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.774_596_669_241_483_4, 5.0 / 18.0)];
    // Closer to the silhouette, three points an axis are not exact enough.
    const INSIDE: f64 = 0.9;
    let Some(environment) = &scene.environment else { return Vec::new() };
    let tree = IrradianceTree::new(&environment.map);
    let scale = f64::from(environment.scale.x) / PI;
    let size = request.width as f64;
    let radiance = |x: f64, y: f64| {
        let z2 = 1.0 - x * x - y * y;
        (z2 > 1.0 - INSIDE * INSIDE).then(|| tree.irradiance(DVec3::new(x, -y, z2.sqrt())).value.x * scale)
    };
    // Nodes of the quadrature in each pixel, in units of the radius.
    let at = |i: usize, node: f64| (2.0 * i as f64 + 1.0 + node) / size - 1.0;
    let pixel = |i: usize| {
        let (x, y) = (i % request.width, i / request.width);
        NODES.iter().try_fold(0.0, |sum, (u, wu)| {
            NODES.iter().try_fold(sum, |sum, (v, wv)| Some(sum + wu * wv * radiance(at(x, *u), at(y, *v))?))
        })
    };
    (0..request.width * request.height).map(pixel).collect()
}

/// A fault in how an image is put together.
#[derive(Debug, Clone, Copy)]
pub enum Plant {
    /// Camera paths and light paths are weighted against others than these.
    Split(Split),
    /// The sum of a pixel's paths is divided by the mean number of paths, not by its own.
    MeanNumber,
}

impl Plant {
    /// The first channel of the image of `film` with the fault.
    pub fn image(&self, film: &Film, scene: &Scene, request: &Request, seed: u64) -> Result<Vec<f64>> {
        match self {
            Self::Split(split) => split.with_light_paths_of(film, scene, request, seed),
            Self::MeanNumber => {
                let paths: Vec<f64> = film.pixels().iter().map(|pixel| f64::from(pixel.camera_paths())).collect();
                let mean = paths.iter().sum::<f64>() / paths.len() as f64;
                let sum = |(pixel, paths): (&Rgb, f64)| f64::from(pixel.x) * paths / mean;
                Ok(film.image().pixels().iter().zip(paths).map(sum).collect())
            }
        }
    }
}

/// Camera paths from another render than light paths: each render alone weights both consistently.
#[derive(Debug, Clone, Copy)]
pub struct Split {
    /// Settings of the camera paths.
    pub settings: Settings,
    /// Light samples of the camera paths.
    pub light_samples: u32,
    /// Width of their film over that of the image, which is in its middle.
    pub widths: usize,
    /// Factor on the contributions of light paths.
    pub factor: f64,
}

impl Split {
    /// The first channel of another render of the scene, with the light paths of `film`.
    fn with_light_paths_of(&self, film: &Film, scene: &Scene, request: &Request, seed: u64) -> Result<Vec<f64>> {
        let (width, wide) = (request.width, request.width * self.widths);
        let mut scene = scene.clone();
        if let Projection::Perspective { tan_half_width, .. } = &mut scene.camera.projection {
            *tan_half_width *= self.widths as f64;
        }
        let settings = Settings { seed, stream: StreamKind::Independent, ..self.settings };
        let request = Request { width: wide, light_samples: self.light_samples, ..*request };
        let camera = render(&scene, &request, &settings, &Silent)?.part.film;
        let sum = |(i, (pixel, estimate)): (usize, (&Pixel, PixelEstimate))| {
            let seen = &camera.pixels()[i / width * wide + (wide - width) / 2 + i % width];
            f64::from(seen.mean().x) + self.factor * f64::from(estimate.mean.x - pixel.mean().x)
        };
        Ok(film.pixels().iter().zip(film.estimates()).enumerate().map(sum).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::run;
    use super::*;
    use etalon_stats::multiple::uniformity;

    #[test]
    #[ignore = "takes seconds: cargo test -- --ignored"]
    fn all_are_accepted() {
        let cases = cases();
        let validation = run(&cases, &Protocol::default(), &|_| ()).unwrap();
        assert_eq!(validation.accepted, cases.len(), "{validation:?}");
    }

    #[test]
    #[ignore = "takes seconds: cargo test -- --ignored"]
    fn p_values_of_right_images_are_uniform() {
        let mis = Settings { density: Some(MapSampling::MAP), ..Settings::default() };
        let hemisphere = Settings { sampling: Sampling::Hemisphere, ..Settings::default() };
        let white = Material::Diffuse { albedo: Rgb::ONE };
        for (name, test) in [
            ("sphere in a furnace", sphere_in_furnace(white, hemisphere, 1)),
            ("inside", inside(3, hemisphere)),
            ("sphere", lit_sphere(mis)),
        ] {
            let samples = SampleCount::Fixed(32 * test.request.width.pow(2) as u64);
            let case = test.case(name);
            let p = |seed| case.examine(&Protocol { seed, samples, ..Protocol::default() }, 0).unwrap().p.unwrap();
            let p: Vec<f64> = (0..60).map(p).collect();
            assert!(uniformity(&p).p > 1e-3, "{name}: {:?} {p:?}", uniformity(&p));
        }
    }
}
