//! References of errors: the exact image where there is one, else two independent long renders.

use super::contender::{Contender, Replicate, Step};
use super::doubling::Deadline;
use etalon_core::envmap::irradiance::IrradianceTree;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::math::Rgb;
use etalon_core::raster::{Comparison, Image, compare, compare_with_halves};
use etalon_core::scene::{Environment, Material, Object, PixelFilter, Projection, Request, Scene, Shape};
use etalon_render::Settings;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::PI;

/// A reference. Pixels that are not finite do not count.
#[derive(Debug, Clone)]
pub struct Reference {
    /// Two independent estimates; twice the same image where it is exact.
    halves: [Image; 2],
    pub facts: Facts,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Facts {
    /// Whether it is known in closed form or by quadrature.
    pub exact: bool,
    /// Samples per pixel of both halves together; 0 where it is exact.
    pub spp: u32,
    /// Root mean square error of the mean of the halves, by how they differ: √(mean((b₁ − b₂)²)/4).
    pub rmse: f64,
    /// Mean of the channel values.
    pub mean: f64,
    pub pixels: usize,
    /// Where it comes from, in words.
    pub source: String,
}

/// Steps of light samples in the long renders.
const LIGHT_SAMPLES: u32 = 4;
/// Offset of the seed of the long renders, whose random numbers must be independent of the others'.
const SEED_OFFSET: u64 = 0x5eed_0000_0000;
/// The same for other programs, whose seeds may have 31 bits.
const SHORT_SEED_OFFSET: u64 = 1_000_003;
/// Inner and outer radius of the pixels of the sphere that count, in units of its radius: in the middle the report's
/// camera touches it, and at the silhouette radiance changes too fast for four points in a pixel.
const RING: [f64; 2] = [0.05, 0.95];

impl Reference {
    /// The exact image where there is one; `None` for other scenes, and after an interruption.
    pub fn exact(scene: &Scene, request: &Request) -> Option<Self> {
        let image = match lone_sphere(scene, request) {
            Some((environment, albedo)) => lit_sphere(environment, albedo, request.width)?,
            None => white_furnace(scene, request)?,
        };
        let Comparison { mean_a, pixels, .. } = compare(&image, &image).ok()?;
        let facts = Facts { exact: true, spp: 0, rmse: 0.0, mean: mean_a, pixels, source: "the exact image".into() };
        Some(Self { halves: [image.clone(), image], facts })
    }

    /// An image of unknown noise, which counts as error of what is compared with it. `source` says where it comes from.
    ///
    /// # Errors
    /// [`Error::Parameter`] for another size than the request's, or an image without a finite pixel.
    pub fn given(image: Image, request: &Request, source: String) -> Result<Self> {
        let Comparison { mean_a, pixels, .. } = compare(&image, &image)?;
        if [image.width(), image.height()] != [request.width, request.height] || pixels == 0 {
            let [[w, h], [rw, rh]] = [[image.width(), image.height()], [request.width, request.height]];
            let message =
                format!("{source} has {pixels} finite pixels of {w}x{h}, and images of {rw}x{rh} are compared");
            return Err(Error::parameter("reference", message).with_hint("`resolution` sets the size of the images"));
        }
        let facts = Facts { exact: false, spp: 0, rmse: 0.0, mean: mean_a, pixels, source };
        Ok(Self { halves: [image.clone(), image], facts })
    }

    /// Renders two halves by our default strategy with several light samples, alternating; `None` if the deadline forbids the first step.
    pub fn rendered(
        scene: &Scene,
        request: &Request,
        seed: u64,
        max_spp: u32,
        deadline: &Deadline,
    ) -> Result<Option<Self>> {
        if deadline.is_over() {
            return Ok(None);
        }
        let request = Request { spp: max_spp, light_samples: LIGHT_SAMPLES, ..*request };
        let half = |i: u64| {
            let settings = Settings { seed: seed.wrapping_add(SEED_OFFSET + i), ..Settings::usual() };
            Replicate::ours(scene, &request, &settings)
        };
        Self::grown([half(0)?, half(1)?], max_spp, "our default strategy", deadline)
    }

    /// Renders two halves by a contender, alternating; `None` if the deadline forbids the first step.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it fails.
    pub fn by(
        contender: &Contender,
        scene: &Scene,
        request: &Request,
        seed: u64,
        max_spp: u32,
        deadline: &Deadline,
    ) -> Result<Option<Self>> {
        let half = |i: u32| {
            let seed = seed.wrapping_add(SHORT_SEED_OFFSET + u64::from(i));
            contender.start(scene, &Request { spp: max_spp, ..*request }, seed, i)
        };
        let (Some(first), Some(second)) = (half(0)?, half(1)?) else { return Ok(None) };
        Self::grown([first, second], max_spp, contender.name(), deadline)
    }

    /// Renders two halves, alternating, each longer than before until the deadline or `max_spp` forbids another step;
    /// `None` if it forbids the first one.
    fn grown(mut halves: [Replicate<'_>; 2], max_spp: u32, source: &str, deadline: &Deadline) -> Result<Option<Self>> {
        let mut reached = None;
        while halves[0].next_spp().is_some_and(|next| next <= max_spp)
            && halves.iter().map(Replicate::next_step).sum::<f64>() < deadline.left()
        {
            let mut grown = Vec::new();
            for half in &mut halves {
                match half.advance(deadline) {
                    Step::Done(image, _) => grown.push(image),
                    Step::Failed(failure) => {
                        return Err(Error::parameter("reference", format!("{source}: {}", failure.message)));
                    }
                    Step::Stopped | Step::End => {}
                }
            }
            // A step that the deadline stopped leaves the images of the one before.
            let Ok(whole) = <[Image; 2]>::try_from(grown) else { break };
            reached = Some((whole, halves[0].spp));
        }
        let Some((images, spp)) = reached else { return Ok(None) };
        // The difference of the halves gives the error of their mean.
        let difference = compare(&images[0], &images[1])?;
        let facts = Facts {
            exact: false,
            spp: 2 * spp,
            rmse: 0.5 * difference.rmse,
            mean: 0.5 * (difference.mean_a + difference.mean_b),
            pixels: difference.pixels,
            source: source.into(),
        };
        Ok(Some(Self { halves: images, facts }))
    }

    pub fn is_of_unknown_noise(&self) -> bool {
        !self.facts.exact && self.facts.spp == 0
    }

    /// The standard error of the mean over the image, as far as the pixels' errors are independent.
    pub fn mean_error(&self) -> f64 {
        self.facts.rmse / (self.facts.pixels as f64).sqrt()
    }

    /// The errors of an image, unbiased by the noise of the reference.
    pub fn compare(&self, image: &Image) -> Result<Comparison> {
        compare_with_halves(image, [&self.halves[0], &self.halves[1]])
    }

    /// The standard deviation that the reference's noise gives to a mean squared error near 0: the mean product of the
    /// halves' errors over all channel values.
    pub fn mse_resolution(&self) -> f64 {
        2.0 * self.facts.rmse.powi(2) / (3.0 * self.facts.pixels as f64).sqrt()
    }

    /// The mean of the halves.
    pub fn image(&self) -> Image {
        let pairs = self.halves[0].pixels().iter().zip(self.halves[1].pixels());
        let pixels = pairs.map(|(a, b)| 0.5 * (a + b)).collect();
        Image::from_pixels(self.halves[0].width(), self.halves[0].height(), pixels)
    }
}

/// The mean radiance over each pixel of a diffuse sphere alone in an environment, in orthographic projection so that it
/// fills a square image; `None` after an interruption.
fn lit_sphere(environment: &Environment, albedo: Rgb, size: usize) -> Option<Image> {
    let tree = IrradianceTree::new(&environment.map);
    // Radiance at a point of the image, in pixels; none outside the ring.
    let radiance = |x: f64, y: f64| {
        let (nx, ny) = (2.0 * x / size as f64 - 1.0, 1.0 - 2.0 * y / size as f64);
        let r2 = nx * nx + ny * ny;
        let inside = (RING[0] * RING[0]..RING[1] * RING[1]).contains(&r2);
        let n = inside.then(|| DVec3::new(nx, ny, (1.0 - r2).sqrt()))?;
        Some(tree.irradiance(environment.to_map(n)).value)
    };
    let scale = (albedo * environment.scale).as_dvec3() / PI;
    // Gauss quadrature with two points per axis.
    let at = 0.5 / 3.0_f64.sqrt();
    let pixel = |i: usize| {
        let centre = [(i % size) as f64 + 0.5, (i / size) as f64 + 0.5];
        let mut sum = DVec3::ZERO;
        for [dx, dy] in [[-at, -at], [at, -at], [-at, at], [at, at]] {
            // A pixel counts if all of its corners do.
            radiance(centre[0] + dx.signum() * 0.5, centre[1] + dy.signum() * 0.5)
                .filter(|_| !interrupt::requested())?;
            sum += radiance(centre[0] + dx, centre[1] + dy)?;
        }
        Some((sum * 0.25 * scale).as_vec3())
    };
    let pixels = (0..size * size).into_par_iter().map(|i| pixel(i).unwrap_or(Rgb::NAN)).collect();
    (!interrupt::requested()).then(|| Image::from_pixels(size, size, pixels))
}

/// The image of lossless white spheres under a uniform environment: its radiance everywhere.
fn white_furnace(scene: &Scene, request: &Request) -> Option<Image> {
    let environment = scene.environment.as_ref()?;
    let texels = environment.map.image().pixels();
    let lossless = |object: &Object| {
        let white = match object.material {
            Material::Diffuse { albedo } => albedo == Rgb::ONE,
            Material::Mirror { reflectance } => reflectance == Rgb::ONE,
            Material::Dielectric(glass) => {
                glass.alpha == [0.0; 2] && (glass.reflectance, glass.transmittance) == (Rgb::ONE, Rgb::ONE)
            }
            _ => false,
        };
        white && matches!(object.shape, Shape::Sphere(_)) && object.emission.is_none()
    };
    let uniform = texels.iter().all(|texel| *texel == texels[0]);
    let whole = request.max_depth >= DEEP && scene.lights.is_empty() && scene.objects.iter().all(lossless);
    (uniform && whole).then(|| Image::from_fn(request.width, request.height, |_, _| texels[0] * environment.scale))
}

/// Number of path segments after which practically all paths have left the spheres.
const DEEP: u32 = 50;

/// The environment and albedo of a scene whose image is known exactly.
fn lone_sphere<'a>(scene: &'a Scene, request: &Request) -> Option<(&'a Environment, Rgb)> {
    let [object] = scene.objects.as_slice() else { return None };
    let (Shape::Sphere(sphere), Material::Diffuse { albedo }) = (&object.shape, &object.material) else { return None };
    let camera = &scene.camera;
    let Projection::Orthographic { half_width, half_height } = camera.projection else { return None };
    let radius = f64::from(sphere.radius);
    // The camera looks along −z, and the sphere fills its image.
    let fills = half_width == radius && half_height == radius && request.width == request.height;
    let along_z = (camera.right, camera.up, camera.forward) == (DVec3::X, DVec3::Y, DVec3::NEG_Z);
    let offset = camera.position - sphere.centre.as_dvec3();
    let in_front = offset.truncate().length() == 0.0 && offset.z >= radius;
    // Its quadrature is that of plain means.
    let is_plain = camera.filter == PixelFilter::default();
    let alone = scene.lights.is_empty() && object.emission.is_none() && request.max_depth > 0;
    (fills && along_z && in_front && is_plain && alone).then_some((scene.environment.as_ref()?, *albedo))
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::envmap::EnvMap;
    use etalon_core::envmap::synthetic::Synthetic;
    use etalon_core::scene::builtin;
    use std::sync::Arc;

    #[test]
    fn the_exact_image_is_what_the_default_strategy_converges_to() {
        let map = Arc::new(EnvMap::new(Synthetic::Sun.make()));
        let (scene, request) = builtin::sphere_env(Environment::upright(map, "sun", 8.0));
        let request = Request { width: 40, height: 40, ..request };
        let deadline = Deadline::after(60.0);
        let exact = Reference::exact(&scene, &request).unwrap();
        let rendered = Reference::rendered(&scene, &request, 1, 256, &deadline).unwrap().unwrap();
        let off = exact.compare(&rendered.image()).unwrap();
        assert!((off.mean_a / off.mean_b - 1.0).abs() < 1e-4, "{off:?}");
        // All the difference is the noise of the render, as far as that is known.
        assert!(off.rmse < 1.2 * rendered.facts.rmse, "{off:?} {:?}", rendered.facts);
        assert!((700..1257).contains(&exact.facts.pixels) && off.non_finite == 1600 - exact.facts.pixels);
        let mut filtered = scene.clone();
        filtered.camera.filter = "gaussian".parse().unwrap();
        assert!(Reference::exact(&filtered, &request).is_none(), "pixels are not plain means");
        let (box_scene, request) = builtin::cornell_lambert();
        assert!(Reference::exact(&box_scene, &request).is_none());
    }

    #[test]
    fn a_furnace_is_uniform_if_nothing_in_it_absorbs() {
        let (mut scene, request) = builtin::furnace();
        let request = Request { width: 48, height: 12, light_samples: 1, ..request };
        let deadline = Deadline::after(60.0);
        assert!(Reference::exact(&scene, &request).is_none(), "its metal absorbs");
        scene.objects.retain(|object| !matches!(object.material, Material::Conductor(_)));
        let exact = Reference::exact(&scene, &request).unwrap();
        let rendered = Reference::rendered(&scene, &request, 1, 64, &deadline).unwrap().unwrap();
        let off = exact.compare(&rendered.image()).unwrap();
        assert!((off.mean_a - 1.0).abs() < 2e-3 && off.pixels == 48 * 12, "{off:?}");
        assert!(Reference::exact(&scene, &Request { max_depth: 2, ..request }).is_none());
    }

    #[test]
    fn its_own_error_is_what_more_samples_show() {
        let (scene, request) = builtin::cornell_lambert();
        let request = Request { width: 40, height: 30, ..request };
        let deadline = Deadline::after(60.0);
        let rendered = |seed, spp| Reference::rendered(&scene, &request, seed, spp, &deadline).unwrap().unwrap();
        let (short, long) = (rendered(1, 4), rendered(7, 128));
        assert_eq!((short.facts.spp, long.facts.spp), (8, 256));
        let off = compare(&short.image(), &long.image()).unwrap().rmse;
        assert!((short.facts.rmse / off - 1.0).abs() < 0.1, "{} {off}", short.facts.rmse);
    }
}
