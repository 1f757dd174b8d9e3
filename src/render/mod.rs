//! Rendering: the integrator, what of it a scene needs, and the film.

mod diffuse;
pub mod exposure;
mod film;
mod geometry;
mod integrator;
mod lanes;
mod lens;
mod lights;
mod needs;
mod numbers;
mod strategies;
mod wide;

pub use film::Dropped;

use crate::error::{Error, Result};
use crate::raster::Image;
use crate::sampling::stream::StreamKind;
use crate::scene::{Request, Scene};
use integrator::{Integrator, Workspace};
use lens::Lens;
use needs::Needs;
use std::time::Instant;
use strategies::Strategies;

/// How directions towards the light are chosen at a hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// By the light's own density.
    Light,
    /// By the material's density.
    Bsdf,
    /// By both, combined by the balance heuristic.
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

/// How to render, besides what the [`Request`] says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Settings {
    pub sampling: Sampling,
    pub stream: StreamKind,
    pub seed: u64,
    pub density: LightDensity,
    /// Run the kernel with nothing left out, for comparison.
    pub general: bool,
}

/// A finished picture and how it came about.
#[derive(Debug, Clone)]
pub struct Rendered {
    pub image: Image,
    pub request: Request,
    /// Wall-clock time of preparation and rendering, without reading or writing files.
    pub seconds: f64,
    pub dropped: Dropped,
    /// What the scene did not need and the kernel hence does not have.
    pub left_out: Vec<&'static str>,
}

/// Renders a scene on rayon's current thread pool; `row_done` is called once per finished image row.
///
/// The picture depends on the scene, the request and the settings alone, to the last bit: not on the number of
/// threads, and not on what was left out.
pub fn render(scene: &Scene, request: &Request, settings: &Settings, row_done: &(dyn Fn() + Sync)) -> Result<Rendered> {
    check(request)?;
    let start = Instant::now();
    let needs = if settings.general { Needs::EVERYTHING } else { Needs::of(scene, request, settings) };
    let strategies = Strategies::new(scene, settings, &needs)?;
    let integrator = Integrator::new(scene, request, settings, strategies);
    let run = Run { integrator, settings: *settings, row_done };
    let (image, dropped) = match needs.kernel() {
        Needs::ALL => run.film::<{ Needs::ALL }>(),
        _ => run.film::<{ Needs::OCCLUSION }>(),
    };
    let left_out = needs.left_out(scene);
    Ok(Rendered { image, request: *request, seconds: start.elapsed().as_secs_f64(), dropped, left_out })
}

/// Everything that a kernel runs on, before it is known which kernel.
struct Run<'a> {
    integrator: Integrator<'a>,
    settings: Settings,
    row_done: &'a (dyn Fn() + Sync),
}

impl Run<'_> {
    fn film<const NEEDS: u32>(&self) -> (Image, Dropped) {
        let Request { width, height, spp, .. } = self.integrator.request;
        let camera = &self.integrator.scene.camera;
        let lens = Lens::new(camera, width, height);
        let workspace = || Workspace::new(&self.settings);
        film::expose(width, height, spp, self.row_done, workspace, |work, y, first, count, radiance| {
            for slot in 0..count {
                let at = first + slot as u64;
                let (x, sample) = ((at / u64::from(spp)) as usize, (at % u64::from(spp)) as u32);
                work.numbers.assign(slot, (y * width + x) as u64, sample);
                work.pixel[slot] = x as u32;
            }
            self.integrator.start(work, count, &lens, y as u32);
            self.integrator.trace::<NEEDS>(work);
            for slot in 0..count {
                radiance(work.pixel[slot] as usize, geometry::at(&work.radiance, slot));
            }
        })
    }
}

/// Largest number of pixels that a render may ask for.
const MAX_PIXELS: usize = 1 << 26;

fn check(request: &Request) -> Result<()> {
    let Request { width, height, spp, light_samples, .. } = *request;
    if width == 0 || height == 0 || width.saturating_mul(height) > MAX_PIXELS {
        return Err(Error::parameter("-r", format!("cannot render {width}x{height} pixels"))
            .with_hint("ask for at least 1x1 and at most 2^26 pixels"));
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
                    pool.install(|| render(&scene, &request, &settings, &|| ()).unwrap().image)
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
                let image = render(&scene, &request, &settings, &|| ()).unwrap().image;
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
            let rendered = render(&scene, &request, &settings, &|| ()).unwrap();
            assert!(rendered.image.pixels().iter().all(|p| *p == Rgb::ZERO));
            assert_eq!(rendered.dropped, Dropped::default());
        }
        scene.environment = None;
        let rendered = render(&scene, &request, &Settings::default(), &|| ()).unwrap();
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
            assert!(render(&scene, &bad, &Settings::default(), &|| ()).is_err(), "{bad:?}");
        }
        let alone = Settings { density: LightDensity::Compensated, sampling: Sampling::Light, ..Settings::default() };
        assert!(render(&scene, &request, &alone, &|| ()).is_err());
    }
}
