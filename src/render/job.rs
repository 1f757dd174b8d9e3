//! A render as a job: prepared once, run over any range of samples, stopped and taken up again.

use super::film::{Dropped, Film, Part, PathClasses, Row};
use super::fingerprint;
use super::geometry::Geometry;
use super::integrator::Integrator;
use super::lanes::{LANES, at};
use super::lens::Lens;
use super::light_tracing::LightTracing;
use super::needs::Needs;
use super::settings::{Settings, check};
use super::strategies::Strategies;
use super::workspace::Workspace;
use crate::error::{Error, Result};
use crate::interrupt;
use crate::math::Rgb;
use crate::memory;
use crate::raster::{Image, Metadata};
use crate::scene::bvh::MeshBvh;
use crate::scene::{Object, Request, Scene, Shape};
use std::ops::Range;
use std::time::Instant;

/// Follows a render and may stop it.
pub trait Control: Sync {
    /// Called now and then, from any thread, with the number of camera samples done since the last call.
    fn done(&self, samples: u64);

    /// Whether the render should end as soon as possible; the samples so far are kept.
    fn stop(&self) -> bool {
        false
    }
}

/// Reports nothing, and stops the render only when the process is asked to stop.
pub struct Silent;

impl Control for Silent {
    fn done(&self, _samples: u64) {}

    fn stop(&self) -> bool {
        interrupt::requested()
    }
}

/// A scene made ready to be rendered.
pub struct Job<'a> {
    pub(super) integrator: Integrator<'a>,
    pub(super) settings: Settings,
    needs: Needs,
    pub(super) lens: Lens,
    start: Instant,
}

/// Samples per pixel in each pass over the image, so that a stopped render leaves a whole image.
const ROUND: u32 = 64;

impl<'a> Job<'a> {
    /// Prepares a render: builds what the scene needs.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for an impossible request and for settings that exclude each other.
    pub fn new(scene: &'a Scene, request: &Request, settings: &Settings) -> Result<Self> {
        check(request)?;
        let start = Instant::now();
        let needs = if settings.general { Needs::everything(scene) } else { Needs::of(scene, request, settings) };
        let strategies = Strategies::new(scene, settings, &needs)?;
        let of_mesh = |object: &Object| if let Shape::Mesh(mesh) = &object.shape { mesh.triangles.len() } else { 0 };
        let triangles: usize = scene.objects.iter().map(of_mesh).sum();
        memory::request(triangles * MeshBvh::BYTES_PER_TRIANGLE, || format!("the tree of {triangles} triangles"))?;
        let geometry = Geometry::new(scene, needs.meshes);
        let integrator = Integrator::new(scene, request, settings, strategies, geometry)?;
        let lens = Lens::new(&scene.camera, request.width, request.height);
        Ok(Self { integrator, settings: *settings, needs, lens, start })
    }

    /// An empty film for this render.
    ///
    /// # Errors
    /// As [`Film::new`].
    pub fn part(&self, metadata: Metadata) -> Result<Part> {
        let Request { width, height, spp, .. } = self.integrator.request;
        let classes = self.settings.paths.map(PathClasses::up_to);
        let film = Film::new(width, height, classes)?;
        let film = if self.integrator.light_tracing.is_some() { film.with_splats()? } else { film };
        // Writing the file takes memory, too: images of the mean, of its error and of every path class, and the compressed
        // sums, about half as large as the film. Make sure of it now, so that the result is not lost at the end.
        let (classes, splats) =
            (classes.map_or(0, PathClasses::count), usize::from(self.integrator.light_tracing.is_some()));
        let sums = (1 + splats) * (Film::BYTES + classes * Film::BYTES_PER_CLASS) / 2;
        memory::request(width * height * (sums + (2 + classes) * size_of::<Rgb>()), || {
            format!("the files of a film of {width}x{height} pixels")
        })?;
        Ok(Part::new(film, spp, self.fingerprint(), metadata))
    }

    /// Equal for renders whose samples are the same; the number of samples is no part of it.
    #[must_use]
    pub fn fingerprint(&self) -> String {
        fingerprint::of(self.integrator.scene, &self.integrator.request, &self.settings)
    }

    /// Wall-clock time since the preparation began.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// What the scene does not need and the kernel hence does not have.
    #[must_use]
    pub fn left_out(&self) -> Vec<&'static str> {
        let mut list = self.needs.left_out(self.integrator.scene);
        if self.integrator.light_tracing.is_none() && !self.settings.general {
            list.push("light tracing");
        }
        list
    }

    /// Renders the samples of the range that `part` does not have yet, until `control` stops it. The part must be one of
    /// [`Job::part`], or the settings [`camera_paths_only`](Settings::camera_paths_only).
    pub fn run(&self, part: &mut Part, samples: Range<u32>, control: &dyn Control) {
        let kernels: [Kernel<'a>; Needs::LEAN.len()] = [
            Self::accumulate::<{ Needs::LEAN[0] }>,
            Self::accumulate::<{ Needs::LEAN[1] }>,
            Self::accumulate::<{ Needs::LEAN[2] }>,
            Self::accumulate::<{ Needs::LEAN[3] }>,
            Self::accumulate::<{ Needs::LEAN[4] }>,
        ];
        let kernel = kernels[self.needs.kernel()];
        let mut start = samples.start;
        while start < samples.end && !control.stop() {
            let round = start..(start + ROUND.min(samples.end - start));
            start = round.end;
            while let Some(task) = part.next(round.clone()) {
                part.film.accumulate(|row| self.row(row, &|n| task.left(n), kernel, control));
                if control.stop() {
                    return;
                }
            }
        }
    }

    /// Renders the samples that the pixels of a row still need.
    fn row(&self, row: &mut Row, left: &dyn Fn(u32) -> Range<u32>, kernel: Kernel<'a>, control: &dyn Control) {
        let mut work = self.integrator.workspace(&self.settings);
        let (mut filled, mut done) = (0, 0);
        let width = self.integrator.request.width;
        for x in 0..width {
            for sample in left(row.samples(x)) {
                work.numbers.assign(filled, self.pixel(row, x), sample);
                (work.pixel[filled], work.sample[filled]) = (x as u32, sample);
                filled += 1;
                if filled == LANES {
                    if control.stop() {
                        return self.light_paths(&mut work, row, 1);
                    }
                    kernel(self, &mut work, row, filled);
                    done += filled as u64;
                    filled = 0;
                }
            }
        }
        kernel(self, &mut work, row, filled);
        self.light_paths(&mut work, row, 1);
        control.done(done + filled as u64);
    }

    /// Traces the camera samples in the first `count` slots and adds them to the film.
    fn accumulate<const NEEDS: u32>(&self, work: &mut Workspace, row: &mut Row, count: usize) {
        self.integrator.start(work, count, &self.lens, row.y() as u32);
        self.integrator.trace::<NEEDS>(work, &self.lens);
        let classes = work.layers.len() / LANES;
        for slot in 0..count {
            let layers = &work.layers[slot * classes..][..classes];
            row.add(work.pixel[slot] as usize, at(&work.radiance, slot), layers);
        }
        if self.integrator.light_tracing.is_some() {
            for slot in 0..count {
                let pixel = self.pixel(row, work.pixel[slot] as usize);
                let path = LightTracing::path(self.settings.seed, pixel, work.sample[slot]);
                work.waiting.extend(path.map(|number| (pixel, number)));
            }
            self.light_paths(work, row, LANES);
        }
    }

    /// Traces the light paths of the samples so far, in batches, while at least so many are waiting.
    fn light_paths(&self, work: &mut Workspace, row: &mut Row, at_least: usize) {
        while work.waiting.len() >= at_least {
            let count = work.waiting.len().min(LANES);
            for slot in 0..count {
                let (pixel, number) = work.waiting[slot];
                work.numbers.assign(slot, pixel, number);
            }
            work.waiting.drain(..count);
            self.integrator.trace_light_paths(work, count, &self.lens);
            work.splats.drain(..).for_each(|splat| row.splat(splat));
        }
    }

    /// The number of a pixel, row by row.
    fn pixel(&self, row: &Row, x: usize) -> u64 {
        (row.y() * self.integrator.request.width + x) as u64
    }
}

/// [`Job::accumulate`] for some set of needs.
type Kernel<'a> = fn(&Job<'a>, &mut Workspace, &mut Row, usize);

/// A finished image and how it was rendered.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// The mean of all samples of each pixel.
    pub image: Image,
    /// The film: every pixel's samples, their standard error, and the light by path class.
    pub part: Part,
    /// What was rendered.
    pub request: Request,
    /// Wall-clock time of preparation and rendering, without reading or writing files.
    pub seconds: f64,
    /// Samples that were not finite or negative.
    pub dropped: Dropped,
    /// What the scene did not need and the kernel hence does not have.
    pub left_out: Vec<&'static str>,
}

/// Renders a scene on rayon's current thread pool.
///
/// The image depends on the scene, the request and the settings alone, to the last bit: not on the number of threads, and
/// not on the parts that were left out.
///
/// # Errors
/// [`Error::Parameter`] for an impossible request and for settings that exclude each other, [`Error::Interrupted`] if
/// `control` stopped it.
pub fn render(scene: &Scene, request: &Request, settings: &Settings, control: &dyn Control) -> Result<Rendered> {
    let job = Job::new(scene, request, settings)?;
    let mut part = job.part(Metadata::default())?;
    job.run(&mut part, 0..request.spp, control);
    if !part.is_complete() {
        return Err(Error::Interrupted);
    }
    Ok(Rendered {
        image: part.film.image(),
        dropped: part.film.dropped(),
        part,
        request: *request,
        seconds: job.seconds(),
        left_out: job.left_out(),
    })
}
