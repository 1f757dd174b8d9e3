//! What `etalon compare` finds of biases that are planted in renders: rows of the table of `docs/src/is-my-renderer-right.md`, and others.
//!
//! ```text
//! cargo run --release --example planted_biases -- FOLDER [REPETITIONS]
//! ```
//!
//! Prints a table for each scene and writes `FOLDER/planted-biases.csv` with a row for each comparison; the images of the
//! first repetition at 64 samples per pixel go to `FOLDER/SCENE/FAULT/a-*.exr` and `FOLDER/SCENE/b-*.exr`, for
//! `etalon compare`.

use etalon::envmap::EnvMap;
use etalon::envmap::synthetic::Synthetic;
use etalon::math::Rgb;
use etalon::raster::{self, Image, Metadata, srgb_from_linear};
use etalon::render::film::{Film, Part};
use etalon::render::{Job, Sampling, Settings, Silent};
use etalon::sampling::stream::StreamKind;
use etalon::scene::{Environment, Request, Scene, builtin};
use etalon::study::compare::{Answer, Compared, Plan, Side, compare};
use rayon::prelude::*;
use serde::Serialize;
use std::error::Error;
use std::fmt;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Images on each side.
const REPLICATES: usize = 16;
/// Other numbers of images of A and B, with the largest uniform bias.
const FEW: [[usize; 2]; 5] = [[2, 2], [2, 16], [3, 64], [4, 4], [4, 16]];
/// Images of B, of which the comparisons take the first.
const MOST: u64 = 64;
/// Samples per pixel.
const SPP: [u32; 3] = [16, 64, 256];
/// Relative changes of the image's mean.
const SIZES: [f64; 3] = [0.003, 0.01, 0.03];
const PLAN: Plan = Plan { level: 0.01, detect: 0.01 };
/// Repetitions of every comparison, with seeds of their own.
const REPETITIONS: u64 = 10;
/// Samples per pixel from which the sizes of faults are measured, by seeds that no comparison has.
const PILOT: u32 = 1024;

/// What is wrong in A; B is the same renderer without fault. The number is an index into [`SIZES`].
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    /// Nothing: what is found is a false alarm.
    None,
    /// The light is too bright.
    Scaled(usize),
    /// Some paths end early, so that the mean falls.
    Short(usize),
    /// Scattered light is clamped, sample by sample, at the level that lets the mean fall.
    Clamped(usize),
    /// The image is half a pixel too far to the left.
    Shifted,
    /// Values are encoded by the sRGB curve.
    Encoded,
    /// The light is too bright by the largest size; the numbers of images are [`FEW`].
    Few(usize),
    /// No bias: replicate k has the samples k, k + 1, …, as if the number of a sample were added to the seed.
    Overlapping,
    /// The light is too bright, and A has the seeds of B.
    SameSeeds(usize),
    /// All replicates of A have one seed.
    OneSeed,
    /// No bias, and A has the seeds of B.
    Identical,
}

impl Fault {
    fn all() -> Vec<Self> {
        let sized = [Self::Scaled, Self::Short, Self::Clamped, Self::SameSeeds as fn(usize) -> Self];
        let sized = sized.into_iter().flat_map(|fault| (0..SIZES.len()).map(fault));
        let few = (0..FEW.len()).map(Self::Few);
        let others = [Self::Shifted, Self::Encoded, Self::Overlapping, Self::OneSeed, Self::Identical];
        [Self::None].into_iter().chain(sized).chain(few).chain(others).collect()
    }

    /// Its size in percent of the mean, where it has one.
    fn size(self) -> Option<f64> {
        match self {
            Self::Scaled(i) | Self::Short(i) | Self::Clamped(i) | Self::SameSeeds(i) => Some(100.0 * SIZES[i]),
            Self::Few(_) => Some(100.0 * SIZES[SIZES.len() - 1]),
            _ => None,
        }
    }

    /// Images of A and B that are compared.
    fn numbers(self) -> [usize; 2] {
        match self {
            Self::Few(i) => FEW[i],
            _ => [REPLICATES; 2],
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self {
            Self::None => "none",
            Self::Scaled(_) | Self::Few(_) | Self::SameSeeds(_) => "light too bright",
            Self::Short(_) => "missing bounce",
            Self::Clamped(_) => "samples clamped",
            Self::Shifted => "half a pixel of shift",
            Self::Encoded => "sRGB written as linear",
            Self::Overlapping => "overlapping seeds, no bias",
            Self::OneSeed => "one seed for all of A",
            Self::Identical => "A has the seeds of B, no bias",
        };
        let size = self.size().map_or(String::new(), |size| format!(" by {size} %"));
        let addition = match self {
            Self::Few(_) => format!(", {} images of A, {} of B", self.numbers()[0], self.numbers()[1]),
            Self::SameSeeds(_) => ", A has the seeds of B".into(),
            _ => String::new(),
        };
        write!(f, "{name}{size}{addition}")
    }
}

/// A scene, and how large its faults must be.
struct Setup {
    scene: Scene,
    request: Request,
    /// A limit of the path length, and the share of the mean that is lost by it.
    short: (u32, f64),
    /// Values at which samples are clamped.
    clamped: [f32; SIZES.len()],
}

/// One replicate of A in all variants that a fault needs.
struct Replicate {
    plain: Image,
    short: Image,
    clamped: [Image; SIZES.len()],
    shifted: Image,
    overlapping: Image,
}

/// The mean of some samples.
fn render(scene: &Scene, request: &Request, seed: u64, samples: Range<u32>) -> etalon::Result<Image> {
    let request = Request { spp: samples.end, ..*request };
    let job = Job::new(scene, &request, &settings(seed))?;
    let mut part = job.part(Metadata::default())?;
    job.run(&mut part, samples, &Silent);
    Ok(part.film.image())
}

fn settings(seed: u64) -> Settings {
    Settings { sampling: Sampling::Mis, seed, stream: StreamKind::Independent, ..Settings::default() }
}

/// Gives `each` the samples of all pixels, one image after the other: what the camera sees directly, and what was scattered.
fn for_samples(
    scene: &Scene,
    request: &Request,
    seed: u64,
    mut each: impl FnMut(&Image, &Image),
) -> etalon::Result<()> {
    let job = |max_depth| Job::new(scene, &Request { max_depth, ..*request }, &settings(seed));
    let jobs = [job(0)?, job(request.max_depth)?];
    for sample in 0..request.spp {
        let image = |job: &Job<'_>| {
            // Not `job.part`, which reads the whole scene for a fingerprint.
            let film = Film::new(request.width, request.height, None)?;
            let mut part = Part::new(film, request.spp, "", Metadata::default());
            job.run(&mut part, sample..sample + 1, &Silent);
            etalon::Result::Ok(part.film.image())
        };
        let (direct, all) = (image(&jobs[0])?, image(&jobs[1])?);
        each(&direct, &Image::from_fn(request.width, request.height, |x, y| all.get(x, y) - direct.get(x, y)));
    }
    Ok(())
}

fn mean(image: &Image) -> f64 {
    image.pixels().iter().map(|p| p.as_dvec3().element_sum()).sum::<f64>() / (3 * image.pixels().len()) as f64
}

impl Setup {
    /// Finds the longest paths without which the mean falls by the largest size, and the values at which to clamp.
    fn new((scene, request): (Scene, Request), [width, height]: [usize; 2]) -> etalon::Result<Self> {
        let request = Request { width, height, light_samples: 1, spp: PILOT, ..request };
        let whole = mean(&render(&scene, &request, 1, 0..PILOT)?);
        let mut short = (request.max_depth, 0.0);
        while short.1 < SIZES[SIZES.len() - 1] && short.0 > 0 {
            let max_depth = short.0 - 1;
            let left = mean(&render(&scene, &Request { max_depth, ..request }, 1, 0..PILOT)?);
            short = (max_depth, 1.0 - left / whole);
        }
        let mut values: Vec<f32> = Vec::new();
        let each = |_: &Image, image: &Image| values.extend(image.pixels().iter().flat_map(|p| p.to_array()));
        for_samples(&scene, &request, 1, each)?;
        values.sort_unstable_by(|a, b| b.total_cmp(a));
        let total = whole * values.len() as f64;
        // Clamped at c, the n values above it lose their sum less n c.
        let clamped = SIZES.map(|size| {
            let mut sum = 0.0;
            for (n, value) in values.iter().map(|v| f64::from(*v)).enumerate() {
                if sum - n as f64 * value >= size * total {
                    return ((sum - size * total) / n as f64) as f32;
                }
                sum += value;
            }
            0.0
        });
        Ok(Self { scene, request, short, clamped })
    }

    /// A replicate of A in all variants.
    fn replicate(&self, spp: u32, seed: u64, first: u32, shared: u64) -> etalon::Result<Replicate> {
        let request = Request { spp, ..self.request };
        let size = [request.width, request.height];
        let mut sums = [(); 1 + SIZES.len()].map(|()| Image::new(size[0], size[1]));
        for_samples(&self.scene, &request, seed, |direct, scattered| {
            let levels = [f32::INFINITY].into_iter().chain(self.clamped).map(Rgb::splat);
            for (sum, level) in sums.iter_mut().zip(levels) {
                let added = |x, y| sum.get(x, y) + direct.get(x, y) + scattered.get(x, y).min(level);
                *sum = Image::from_fn(size[0], size[1], added);
            }
        })?;
        let [plain, a, b, c] = sums.map(|sum| sum.map(|p| p / spp as f32));
        let short = render(&self.scene, &Request { max_depth: self.short.0, ..request }, seed, 0..spp)?;
        // Half a pixel is a column of an image of twice the width, which has half the samples.
        let wide = render(&self.scene, &Request { width: 2 * size[0], ..request }, seed, 0..spp / 2)?;
        let shifted = Image::from_fn(size[0], size[1], |x, y| {
            0.5 * (wide.get(2 * x + 1, y) + wide.get((2 * x + 2).min(2 * size[0] - 1), y))
        });
        let overlapping = render(&self.scene, &request, shared, first..first + spp)?;
        Ok(Replicate { plain, short, clamped: [a, b, c], shifted, overlapping })
    }

    /// A with a fault; `b` are the images of B.
    fn plant(&self, fault: Fault, a: &[Replicate], b: &[Image]) -> Vec<Image> {
        let scaled = |image: &Image, i: usize| image.map(|p| p * (1.0 + SIZES[i]) as f32);
        let (width, height) = (self.request.width, self.request.height);
        let of = |a: &Replicate| match fault {
            Fault::Scaled(i) => scaled(&a.plain, i),
            Fault::Few(_) => scaled(&a.plain, SIZES.len() - 1),
            Fault::Short(i) => {
                let share = (SIZES[i] / self.short.1) as f32;
                Image::from_fn(width, height, |x, y| a.plain.get(x, y).lerp(a.short.get(x, y), share))
            }
            Fault::Clamped(i) => a.clamped[i].clone(),
            Fault::Shifted => a.shifted.clone(),
            Fault::Encoded => a.plain.map(|p| Rgb::from_array(p.to_array().map(srgb_from_linear))),
            Fault::Overlapping => a.overlapping.clone(),
            _ => a.plain.clone(),
        };
        match fault {
            Fault::SameSeeds(i) => b.iter().map(|image| scaled(image, i)).collect(),
            Fault::Identical => b.to_vec(),
            Fault::OneSeed => a.iter().map(|_| a[0].plain.clone()).collect(),
            _ => a[..fault.numbers()[0]].iter().map(of).collect(),
        }
    }
}

/// A comparison as a row of the CSV file.
#[derive(Serialize)]
struct Row {
    scene: String,
    fault: String,
    spp: u32,
    repetition: u64,
    /// `refused` if the images are no replicates.
    answer: String,
    /// Corrected p-values: below the level, the images differ.
    p_mean: Option<f64>,
    p_low_frequency: Option<f64>,
    p_tiles: Option<f64>,
    /// Smallest biases that would have been found with 90 % probability, relative to the image's mean.
    uniform_bias: Option<f64>,
    tile_bias: Option<f64>,
}

impl Row {
    fn new(setup: &Setup, fault: Fault, spp: u32, repetition: u64, compared: Option<&Compared>) -> Self {
        let p = |family: usize| compared.and_then(|c| c.families[family].adjusted_p);
        let answer = match compared.map(|c| c.answer) {
            None => "refused",
            Some(Answer::Different) => "different",
            Some(Answer::NoDifferenceFound) => "no difference found",
            Some(Answer::CannotTell) => "cannot tell",
            Some(Answer::NotIndependent) => "not independent",
            Some(Answer::NotFinite) => "not finite",
        };
        Self {
            scene: setup.scene.name.clone(),
            fault: fault.to_string(),
            spp,
            repetition,
            answer: answer.into(),
            p_mean: p(0),
            p_low_frequency: p(1),
            p_tiles: p(2),
            uniform_bias: compared.and_then(|c| c.uniform_bias),
            tile_bias: compared.and_then(|c| c.tile_bias),
        }
    }
}

/// All faults of one repetition at `spp` samples per pixel.
fn repetition(setup: &Setup, spp: u32, repetition: u64, keep: Option<&Path>) -> Result<Vec<Row>, Box<dyn Error>> {
    let first = 1_000_000 * u64::from(spp) + 100 * repetition;
    let replicates = REPLICATES as u64;
    let replicate = |k: u64| setup.replicate(spp, first + k, k as u32, first + replicates + MOST);
    let a: Vec<Replicate> = (0..replicates).into_par_iter().map(replicate).collect::<Result<_, _>>()?;
    let other = |k: u64| render(&setup.scene, &setup.request, first + replicates + k, 0..spp);
    let all: Vec<Image> = (0..MOST).into_par_iter().map(other).collect::<Result<_, _>>()?;
    let b = &all[..REPLICATES];
    if let Some(folder) = keep {
        write(folder, "b", b)?;
    }
    let mut rows = Vec::new();
    for fault in Fault::all() {
        let images = setup.plant(fault, &a, b);
        if let Some(folder) = keep {
            let name = fault.to_string().replace(" %", "").replace(", ", "-").replace(' ', "-");
            write(&folder.join(name), "a", &images)?;
        }
        // Images of a seed that is used twice are refused.
        let others = all[..fault.numbers()[1]].to_vec();
        let compared = compare(Side::replicates(images), Side::replicates(others), PLAN).ok();
        rows.push(Row::new(setup, fault, spp, repetition, compared.as_ref()));
    }
    Ok(rows)
}

fn write(folder: &Path, side: &str, images: &[Image]) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    for (k, image) in images.iter().enumerate() {
        raster::write(&folder.join(format!("{side}-{k:02}.exr")), image, &Metadata::default())?;
    }
    Ok(())
}

/// A cell of the table: how often the images were called different, and by which families in at least half of these cases; or
/// how often they were refused.
fn cell(rows: &[&Row]) -> String {
    let count = |answer: &str| rows.iter().filter(|row| row.answer == answer).count();
    for answer in ["refused", "not independent"] {
        if count(answer) == rows.len() {
            return answer.into();
        }
    }
    let found = count("different");
    let by = |name: &str, p: fn(&Row) -> Option<f64>| {
        let tests = rows.iter().filter(|row| p(row).is_some_and(|p| p < PLAN.level)).count();
        if tests > 0 && 2 * tests >= found { name.to_owned() } else { String::new() }
    };
    let families = by("M", |row| row.p_mean) + &by("L", |row| row.p_low_frequency) + &by("T", |row| row.p_tiles);
    format!("{found} {families}").trim().to_owned()
}

/// The median of what would have been found, in percent; where it is unknown in most repetitions, a dash.
fn median(rows: &[&Row], value: fn(&Row) -> Option<f64>) -> String {
    let mut values: Vec<f64> = rows.iter().map(|row| value(row).unwrap_or(f64::INFINITY)).collect();
    values.sort_unstable_by(f64::total_cmp);
    let median = values.get(values.len() / 2).copied().unwrap_or(f64::NAN);
    if median.is_finite() { format!("{:.2} %", 100.0 * median) } else { "–".into() }
}

/// The table of a scene, in Markdown.
fn table(rows: &[Row]) -> String {
    let line = |name: &str, cell: &dyn Fn(&[&Row]) -> String, fault: &str| {
        let of = |spp: u32| {
            let rows: Vec<&Row> = rows.iter().filter(|row| row.fault == fault && row.spp == spp).collect();
            format!(" {} |", cell(&rows))
        };
        format!("| {name} |{}\n", SPP.map(of).concat())
    };
    let mut text =
        format!("| fault in A |{}\n|---|{}\n", SPP.map(|n| format!(" {n} spp |")).concat(), "---|".repeat(3));
    for fault in Fault::all() {
        text += &line(&fault.to_string(), &cell, &fault.to_string());
    }
    let plain = Fault::None.to_string();
    text += &line("*uniform bias found with 90 % probability*", &|rows| median(rows, |row| row.uniform_bias), &plain);
    text + &line("*bias of one tile found with 90 % probability*", &|rows| median(rows, |row| row.tile_bias), &plain)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("usage: planted_biases FOLDER [REPETITIONS]")?);
    let repetitions = arguments.next().map_or(Ok(REPETITIONS), |n| n.parse())?;
    fs::create_dir_all(&folder)?;
    let mut file = csv::Writer::from_path(folder.join("planted-biases.csv"))?;
    let map = Arc::new(EnvMap::new(Synthetic::Nave.make()));
    let environment = Environment::upright(map, "nave", builtin::SPHERE_ENV_SCALE);
    for (scene, size) in [(builtin::cornell_spheres(), [48, 36]), (builtin::sphere_env(environment), [36, 36])] {
        let setup = Setup::new(scene, size)?;
        let name = &setup.scene.name;
        let (depth, lost) = (setup.short.0, 100.0 * setup.short.1);
        println!("{name}: max. depth {depth} loses {lost:.2} %; samples clamped at {:?}\n", setup.clamped);
        let mut rows = Vec::new();
        for spp in SPP {
            for k in 0..repetitions {
                let keep = (spp == 64 && k == 0).then(|| folder.join(name));
                rows.extend(repetition(&setup, spp, k, keep.as_deref())?);
            }
            eprintln!("{name}: {spp} samples per pixel done");
        }
        rows.iter().try_for_each(|row| file.serialize(row))?;
        println!("{}", table(&rows));
    }
    file.flush()?;
    Ok(())
}
