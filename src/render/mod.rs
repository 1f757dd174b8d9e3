//! Rendering: the integrator, what of it a scene needs, and the film.

mod casters;
mod diffuse;
mod direct;
pub mod exposure;
mod faces;
mod fingerprint;
mod geometry;
mod integrator;
mod job;
mod lanes;
mod lens;
mod lights;
mod needs;
mod numbers;
mod rough;
mod strategies;
mod wide;

pub use exposure::Dropped;
pub use job::{Control, Job, Silent};

use crate::error::{Error, Result};
use crate::raster::{Image, Metadata};
use crate::sampling::stream::StreamKind;
use crate::scene::scattering::ScatterModel;
use crate::scene::{Request, Scene};
use exposure::Part;

/// How directions towards the light are chosen at a hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// By the light's own density.
    Light,
    /// By the material's density.
    Bsdf,
    /// By both, combined by multiple importance sampling, as far as both are of use: at a diffuse surface a lamp's
    /// solid angle, or the environment's radiance × cosine, leaves nothing to the material's directions but noise.
    #[default]
    Mis,
    /// Uniformly over the hemisphere.
    Hemisphere,
}

/// What the directions towards the environment are drawn in proportion to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LightDensity {
    /// The map's radiance times the cosine at the surface.
    #[default]
    Cosine,
    /// The map's radiance.
    Map,
    /// The map's radiance less its mean; only [`Sampling::Mis`] can use it.
    Compensated,
}

/// What light does at surfaces and on its way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Model {
    pub scattering: ScatterModel,
    /// The light of rectangles falls off with the distance, not its square: the course's renderer divides by the
    /// length of a vector that it takes for a unit vector. In the report's room that is 0.9 to 1.8 times the light.
    pub inverse_distance: bool,
}

/// How to render, besides what the [`Request`] says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Settings {
    pub sampling: Sampling,
    pub stream: StreamKind,
    pub seed: u64,
    pub density: LightDensity,
    pub model: Model,
    /// Keep the light apart by the class of its path, up to this many scatterings.
    pub paths: Option<u32>,
    /// Run the kernel with nothing left out, for comparison.
    pub general: bool,
}

/// A finished picture and how it came about.
#[derive(Debug, Clone)]
pub struct Rendered {
    pub image: Image,
    /// The film: every pixel's samples, their standard error, and the light by path class.
    pub part: Part,
    pub request: Request,
    /// Wall-clock time of preparation and rendering, without reading or writing files.
    pub seconds: f64,
    pub dropped: Dropped,
    /// What the scene did not need and the kernel hence does not have.
    pub left_out: Vec<&'static str>,
}

/// Renders a scene on rayon's current thread pool.
///
/// The picture depends on the scene, the request and the settings alone, to the last bit: not on the number of
/// threads, and not on what was left out.
///
/// # Errors
/// [`Error::Parameter`] for an impossible request and for settings that exclude each other.
pub fn render(scene: &Scene, request: &Request, settings: &Settings, control: &dyn Control) -> Result<Rendered> {
    let job = Job::new(scene, request, settings)?;
    let mut part = job.part(Metadata::default())?;
    job.run(&mut part, 0..request.spp, control);
    Ok(Rendered {
        image: part.exposure.image(),
        dropped: part.exposure.dropped(),
        part,
        request: *request,
        seconds: job.seconds(),
        left_out: job.left_out(),
    })
}

fn check(request: &Request) -> Result<()> {
    let Request { width, height, spp, light_samples, .. } = *request;
    if width == 0 || height == 0 {
        return Err(
            Error::parameter("-r", format!("cannot render {width}x{height} pixels")).with_hint("at least 1x1 pixels")
        );
    }
    if spp == 0 || light_samples == 0 {
        return Err(Error::parameter(if spp == 0 { "-s" } else { "-l" }, "must be at least 1"));
    }
    if u64::from(spp) * u64::from(light_samples) > 1 << 32 {
        return Err(Error::parameter(
            "-s",
            format!("{spp} samples with {light_samples} light samples each are too many"),
        )
        .with_hint("the random sequences repeat after 2^32 draws per pixel"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envmap::EnvMap;
    use crate::raster::Rgb;
    use crate::scene::{Environment, builtin};
    use std::sync::Arc;

    fn sphere(image: Image) -> (Scene, Request) {
        let (scene, request) = builtin::sphere_env(Environment::upright(Arc::new(EnvMap::new(image)), "test", 1.0));
        (scene, Request { width: 24, height: 24, spp: 4, ..request })
    }

    fn busy() -> Image {
        Image::from_fn(16, 8, |x, y| {
            Rgb::new((x % 3) as f32, (y % 2) as f32, if (x, y) == (5, 2) { 50.0 } else { 0.0 })
        })
    }

    const ALL: [Sampling; 4] = [Sampling::Light, Sampling::Bsdf, Sampling::Mis, Sampling::Hemisphere];

    #[test]
    fn threads_and_leaving_out_change_no_bit() {
        let (scene, request) = sphere(busy());
        for sampling in ALL {
            for stream in [StreamKind::Sobol, StreamKind::Independent] {
                let settings = Settings { sampling, stream, seed: 3, ..Settings::default() };
                let on = |threads: usize, settings: Settings| {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                    pool.install(|| render(&scene, &request, &settings, &Silent).unwrap().image)
                };
                let one = on(1, settings);
                assert_eq!(one, on(3, settings));
                assert_eq!(one, on(2, Settings { general: true, ..settings }), "{sampling:?}");
                assert_ne!(one, on(1, Settings { seed: 4, ..settings }));
            }
        }
    }

    #[test]
    fn a_white_sphere_in_a_white_furnace_is_invisible() {
        let (scene, request) = sphere(Image::from_fn(8, 4, |_, _| Rgb::ONE));
        for sampling in [Sampling::Bsdf, Sampling::Mis] {
            for density in [LightDensity::Cosine, LightDensity::Map, LightDensity::Compensated] {
                let settings = Settings { sampling, density, ..Settings::default() };
                let image = render(&scene, &request, &settings, &Silent).unwrap().image;
                let mean: f32 = image.pixels().iter().map(|p| p.x).sum::<f32>() / image.pixels().len() as f32;
                // BSDF sampling is exact sample by sample; MIS only on average.
                let tolerance = if sampling == Sampling::Bsdf { 1e-6 } else { 5e-3 };
                assert!((mean - 1.0).abs() < tolerance, "{sampling:?}: {mean}");
            }
        }
    }

    #[test]
    fn nothing_lights_nothing() {
        let (mut scene, request) = sphere(Image::new(4, 2));
        for sampling in ALL {
            let settings = Settings { sampling, ..Settings::default() };
            let rendered = render(&scene, &request, &settings, &Silent).unwrap();
            assert!(rendered.image.pixels().iter().all(|p| *p == Rgb::ZERO));
            assert_eq!(rendered.dropped, Dropped::default());
        }
        scene.environment = None;
        let rendered = render(&scene, &request, &Settings::default(), &Silent).unwrap();
        assert!(rendered.image.pixels().iter().all(|p| *p == Rgb::ZERO));
    }

    #[test]
    fn impossible_requests_are_refused() {
        let (scene, request) = sphere(busy());
        for bad in [
            Request { width: 0, ..request },
            Request { height: usize::MAX, ..request },
            Request { spp: 0, ..request },
            Request { light_samples: 0, ..request },
            Request { spp: u32::MAX, light_samples: 2, ..request },
        ] {
            assert!(render(&scene, &bad, &Settings::default(), &Silent).is_err(), "{bad:?}");
        }
        let alone = Settings { density: LightDensity::Compensated, sampling: Sampling::Light, ..Settings::default() };
        assert!(render(&scene, &request, &alone, &Silent).is_err());
    }
}
