//! A render as a job: prepared once, run over any range of samples, stopped and taken up again.

use super::adaptive::{MOST_PATHS, PathCounts, UNIFORM, variance};
use super::camera::PreparedCamera;
use super::film::{Dropped, Film, Part, PathClasses, Pixel, Row, Splat};
use super::kernel::{Buffers, Pixels, trace, trace_light_paths};
use super::lanes::{LANES, at};
use super::light_tracing::LightTracing;
use super::prepared::PreparedScene;
use super::radiance::Radiance;
use super::ray_samples::Streams;
use super::reference::Reference;
use super::settings::{Kernel, Sampling, Settings, check};
use etalon_core::build::Build;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::math::{Rgb, hash_words};
use etalon_core::memory;
use etalon_core::raster::{Image, Metadata};
use etalon_core::scene::{Request, Scene, Shape};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::OnceLock;
use std::time::Instant;

/// Follows a render and may stop it.
pub trait Control: Sync {
    /// Called now and then, from any thread, with the number of camera samples done since the last call.
    fn done(&self, samples: u64);

    /// Whether the render should end as soon as possible; the samples so far are kept. Once true, it stays so until the render
    /// has ended.
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
    pub(super) scene: PreparedScene<'a>,
    pub(super) settings: Settings,
    /// Whether it chose the techniques.
    pub(super) chooses: bool,
    pub(super) camera: PreparedCamera,
    /// How many paths the samples of each pixel have, after the first samples.
    counts: OnceLock<PathCounts>,
    start: Instant,
}

/// Samples per pixel in each pass over the image, so that a stopped render leaves a whole image.
const ROUND: u32 = 64;

impl<'a> Job<'a> {
    /// Prepares a render: builds what the scene needs.
    ///
    /// # Errors
    /// [`etalon_core::Error::Parameter`] for an impossible request and for settings that exclude each other.
    pub fn new(scene: &'a Scene, request: &Request, settings: &Settings) -> Result<Self> {
        check(request)?;
        Film::check(request.width, request.height)?;
        // The random sequences repeat after 2^32 numbers.
        let draws = u64::from(request.spp) * u64::from(request.light_samples) * u64::from(MOST_PATHS);
        if settings.adaptive && draws > 1 << 32 {
            let message = format!("{} samples with up to {MOST_PATHS} paths each are too many", request.spp);
            return Err(Error::parameter("spp", message).with_hint("render with `uniform`"));
        }
        let start = Instant::now();
        let chooses = settings.choose;
        let (settings, candidates) = settings.with_first_candidate(scene);
        if settings.kernel == Kernel::Reference && settings.sampling == Sampling::MisLt {
            return Err(Error::parameter("kernel", "the reference has no light tracing")
                .with_hint("use `sampling` mis, light, bsdf or hemisphere"));
        }
        let prepared = PreparedScene::new(scene, request, &settings)?;
        let camera = PreparedCamera::new(&scene.camera, request.width, request.height);
        let mut job = Self { scene: prepared, settings, chooses, camera, counts: OnceLock::new(), start };
        job.choose(candidates)?;
        Ok(job)
    }

    /// The settings of the render, with what was chosen for this scene.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// An empty film for this render.
    ///
    /// # Errors
    /// As [`Film::new`].
    pub fn part(&self, metadata: Metadata) -> Result<Part> {
        let Request { width, height, spp, .. } = self.scene.request;
        let classes = self.settings.paths;
        let film = Film::new(width, height, classes)?;
        let film = if self.scene.light_tracing.is_some() { film.with_splats()? } else { film };
        // Ask now for the memory of the files, so that the result is not lost: images, and sums of about half the film's size.
        let classes = classes.map_or(0, PathClasses::count);
        let sums =
            (1 + usize::from(self.scene.light_tracing.is_some())) * (Film::BYTES + classes * Film::BYTES_PER_CLASS) / 2;
        let counts = if self.settings.adaptive { PathCounts::BYTES } else { 0 };
        memory::request(width * height * (counts + sums + (2 + classes) * size_of::<Rgb>()), || {
            format!("the numbers of paths and the files of a film of {width}x{height} pixels")
        })?;
        Ok(Part::new(film, spp, self.fingerprint(), metadata))
    }

    /// Equal for renders whose samples are the same; the number of samples is no part of it.
    pub fn fingerprint(&self) -> String {
        fingerprint(self.scene.scene, &self.scene.request, &self.settings)
    }

    /// Wall-clock time since the preparation began.
    pub fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Renders the samples of the range that `part` does not have yet, until `control` stops it. The part must be one of
    /// [`Job::part`].
    pub fn run(&self, part: &mut Part, samples: Range<u32>, control: &dyn Control) {
        let mut start = samples.start;
        while start < samples.end && !control.stop() {
            // The first samples say how many paths the others have.
            let end = if self.settings.adaptive && start < UNIFORM { UNIFORM } else { start.saturating_add(ROUND) };
            let round = start..end.min(samples.end);
            start = round.end;
            while let Some(task) = part.next(round.clone()) {
                let counts = if self.settings.adaptive && task.range().end > UNIFORM {
                    let Some(counts) = self.path_counts(part, control) else { return };
                    Some(counts)
                } else {
                    None
                };
                part.film
                    .accumulate(|row| control.done(self.row(row, &|_, n| task.left(n), Pass::Image(counts), control)));
                if control.stop() {
                    return;
                }
            }
        }
    }

    /// How many paths the samples of each pixel have, from the first samples: those of `part` if it has no others, or else rendered for
    /// this alone, which `control` may stop.
    fn path_counts(&self, part: &Part, control: &dyn Control) -> Option<&PathCounts> {
        if self.counts.get().is_none() {
            let Request { width, height, .. } = self.scene.request;
            let pixels = part.film.pixels();
            let has_range = matches!(part.ranges().done(), [range] if *range == (0..UNIFORM));
            let has_first = has_range && pixels.iter().all(|pixel| pixel.samples() == UNIFORM);
            let variances: Vec<f32> = if has_first {
                pixels.par_iter().map(variance).collect()
            } else {
                let row = |y: usize| self.variances(y, control);
                (0..height).into_par_iter().with_max_len(1).flat_map_iter(row).collect()
            };
            if control.stop() {
                return None;
            }
            self.counts.get_or_init(|| PathCounts::new(&variances, width));
        }
        self.counts.get()
    }

    /// The variances of the pixels of row `y`, from the first samples again.
    fn variances(&self, y: usize, control: &dyn Control) -> Vec<f32> {
        let mut pixels = vec![Pixel::default(); self.scene.request.width];
        self.row(&mut Row::new(y, &mut pixels, &mut []), &|_, n| n..UNIFORM, Pass::Variance, control);
        pixels.iter().map(variance).collect()
    }

    /// Renders the samples that the pixels of a row still need, and returns their number; 0 where `control` stops it.
    fn row(&self, row: &mut Row, left: Left, pass: Pass, control: &dyn Control) -> u64 {
        let mut batch = Batch::new(self, pass);
        let mut done = 0;
        for x in 0..self.scene.request.width {
            let pixel = self.pixel(row, x);
            for sample in left(x, row.samples(x)) {
                let (count, first) = pass.paths(pixel as usize, sample);
                if batch.count + count as usize > LANES {
                    if control.stop() {
                        batch.trace_light_paths(self, row, 1);
                        return 0;
                    }
                    done += batch.trace(self, row);
                }
                batch.assign(pixel, x, sample, first..first + count);
            }
        }
        done += batch.trace(self, row);
        batch.trace_light_paths(self, row, 1);
        done
    }

    fn pixel(&self, row: &Row, x: usize) -> u64 {
        (row.y() * self.scene.request.width + x) as u64
    }
}

/// The samples that a pixel still needs, by its column and how many it has had.
type Left<'a> = &'a dyn Fn(usize, u32) -> Range<u32>;

/// What samples are for.
#[derive(Clone, Copy)]
enum Pass<'a> {
    /// Path counts of the pixels of the final image, or one each.
    Image(Option<&'a PathCounts>),
    /// For the variance of pixels, the first samples again: without light paths.
    Variance,
}

impl Pass<'_> {
    /// How many paths a sample of a pixel has, and the number of the first of them.
    fn paths(self, pixel: usize, sample: u32) -> (u32, u32) {
        match self {
            Self::Image(Some(counts)) => counts.of(pixel, sample),
            Self::Image(None) | Self::Variance => (1, sample),
        }
    }
}

/// Camera samples that are traced together, and the light paths that come with them.
struct Batch<'a> {
    samples: Vec<Sample>,
    /// The random numbers of the camera paths.
    streams: Streams,
    /// How many camera paths are assigned.
    count: usize,
    column: [u32; LANES],
    radiance: Radiance,
    buffers: Box<Buffers>,
    /// What traces the camera paths if the lanes do not.
    reference: Option<Reference<'a>>,
    light_tracing: bool,
    /// The random numbers of the light paths.
    light_streams: Streams,
    /// Pixel and number of light paths still to be traced.
    waiting: Vec<(u64, u32)>,
    splats: Vec<Splat>,
}

/// A camera sample: one or more camera paths.
struct Sample {
    column: usize,
    /// Its number in its pixel.
    number: u32,
    slots: Range<usize>,
}

impl<'a> Batch<'a> {
    fn new(job: &'a Job<'a>, pass: Pass) -> Self {
        let Settings { stream, seed, .. } = job.settings;
        let light_tracing = matches!(pass, Pass::Image(_)) && job.scene.light_tracing.is_some();
        Self {
            samples: Vec::with_capacity(LANES),
            streams: Streams::new(stream, seed),
            count: 0,
            column: [0; LANES],
            radiance: Radiance::new(job.scene.classes),
            buffers: Box::default(),
            reference: (job.settings.kernel == Kernel::Reference).then(|| Reference::new(&job.scene, &job.camera)),
            light_tracing,
            light_streams: Streams::new(stream, seed),
            waiting: Vec::new(),
            splats: Vec::new(),
        }
    }

    /// Adds a camera sample: the paths of these numbers.
    fn assign(&mut self, pixel: u64, column: usize, number: u32, paths: Range<u32>) {
        let start = self.count;
        for path in paths {
            self.streams.assign(self.count, pixel, path);
            self.column[self.count] = column as u32;
            self.count += 1;
        }
        self.samples.push(Sample { column, number, slots: start..self.count });
    }

    /// Traces the camera samples, adds them to the film, and returns their number.
    fn trace(&mut self, job: &Job, row: &mut Row) -> u64 {
        let count = std::mem::take(&mut self.count);
        let y = row.y() as u32;
        if let Some(reference) = &mut self.reference {
            self.radiance.clear(count);
            for slot in 0..count {
                let add = |class, value| self.radiance.add(slot as u32, class, value);
                reference.trace(&self.streams, slot as u32, [self.column[slot], y], add);
            }
        } else {
            let pixels = Pixels { columns: &self.column, row: y, count };
            trace(&job.scene, &job.camera, pixels, &self.streams, &mut self.buffers, &mut self.radiance);
        }
        for sample in &self.samples {
            let paths = sample.slots.clone().map(|slot| (at(&self.radiance.sum, slot), self.radiance.by_class(slot)));
            row.add_paths(sample.column, paths);
        }
        if self.light_tracing {
            for sample in &self.samples {
                let pixel = job.pixel(row, sample.column);
                let path = LightTracing::path(job.settings.seed, pixel, sample.number);
                self.waiting.extend(path.map(|number| (pixel, number)));
            }
            self.trace_light_paths(job, row, LANES);
        }
        let samples = self.samples.len() as u64;
        self.samples.clear();
        samples
    }

    /// Traces the light paths of the samples so far, in batches, while at least n are waiting.
    fn trace_light_paths(&mut self, job: &Job, row: &mut Row, at_least: usize) {
        while self.waiting.len() >= at_least {
            let count = self.waiting.len().min(LANES);
            for (slot, (pixel, number)) in self.waiting.drain(..count).enumerate() {
                self.light_streams.assign(slot, pixel, number);
            }
            let (streams, buffers) = (&self.light_streams, &mut self.buffers);
            trace_light_paths(&job.scene, &job.camera, streams, count, buffers, &mut self.splats);
            row.splat(&self.splats);
            self.splats.clear();
        }
    }
}

/// A finished image and how it was rendered.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// The mean of all samples of each pixel.
    pub image: Image,
    /// The film: every pixel's samples, their standard error, and the light by path class.
    pub part: Part,
    pub request: Request,
    /// Wall-clock time of preparation and rendering, without reading or writing files.
    pub seconds: f64,
    /// Samples dropped because they were negative, infinite or NaN.
    pub dropped: Dropped,
    /// The settings, with what was chosen for the scene.
    pub settings: Settings,
    /// The parts that the scene did not need and that were therefore skipped.
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
        settings: job.settings,
    })
}

/// A hash of all that a sample depends on: this build, the scene to the last bit, the settings, and the request except the number of
/// samples. Only renders of equal fingerprints are merged.
pub(super) fn fingerprint(scene: &Scene, request: &Request, settings: &Settings) -> String {
    let mut hash = Hash(0);
    hash.text(&Build::current().id());
    // What was left out changes no sample.
    let settings = Settings { general: false, ..*settings };
    let request = Request { spp: 0, ..*request };
    hash.text(&format!("{settings:?} {request:?} {:?} {:?}", scene.camera, scene.lights));
    for object in &scene.objects {
        // Texels print a hash of themselves.
        hash.text(&format!("{:?} {:?} {:?}", object.material, object.emission, object.axis));
        if object.material.is_textured() {
            hash.text(&format!("{:?}", object.meridians));
        }
        match &object.shape {
            Shape::Mesh(mesh) => {
                hash.words(mesh.positions.iter().chain(&mesh.normals).flat_map(|v| v.to_array().map(f32::to_bits)));
                hash.words(mesh.triangles.iter().flatten().copied());
                hash.words(mesh.uv.iter().flatten().flat_map(|uv| uv.to_array().map(f32::to_bits)));
            }
            other => hash.text(&format!("{other:?}")),
        }
    }
    if let Some(environment) = &scene.environment {
        hash.text(&format!("{:?} {:?} {:?}", environment.scale, environment.to_world, environment.map.hash()));
    }
    format!("{:016x}", hash.0)
}

struct Hash(u64);

impl Hash {
    fn words(&mut self, words: impl IntoIterator<Item = u32>) {
        self.0 = hash_words(self.0, words);
    }

    fn text(&mut self, text: &str) {
        self.words(text.bytes().map(u32::from));
    }
}
