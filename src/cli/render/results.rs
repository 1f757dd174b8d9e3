//! The results of a render: its files, which are images, and the state from which it can be continued; its summary as JSON and as
//! text: mean, standard error, time, memory, path classes.

use etalon_core::error::{Error, Result};
use etalon_core::files::{self, is_same_file};
use etalon_core::memory;
use etalon_core::raster::{self, Image, Metadata, ToneMap, WriteOptions};
use etalon_core::scene::Request;
use etalon_figures::output::{self, Target, Written};
use etalon_figures::view::text::{LINE, counted, wrapped};
use etalon_render::Dropped;
use etalon_render::film::Part;
use glam::DVec3;
use serde::Serialize;
use std::path::{Path, PathBuf};

pub struct Images {
    target: Target,
    formats: Vec<&'static str>,
    look: Look,
    /// The suffix of a shard's default name; its file has the sums.
    shard: Option<String>,
}

/// How 8-bit images show the radiance.
#[derive(Clone, Copy)]
pub struct Look {
    pub tone: ToneMap,
    /// Exposure in stops, before tone mapping.
    pub exposure: f32,
    /// Side of the square of PNG pixels that show a pixel.
    pub scale: u32,
}

impl Look {
    fn write(&self, path: &Path, format: &str, image: &Image, metadata: &Metadata) -> Result<()> {
        let options = WriteOptions { tone: self.tone, ..WriteOptions::default() };
        let (is_png, factor) = (format == "png", self.exposure.exp2());
        if !(is_png || format == "ppm") || (factor == 1.0 && self.scale == 1) {
            return raster::write_with(path, image, metadata, options);
        }
        let shown = image.map(|p| p * factor);
        let shown = if is_png { shown.enlarged(self.scale as usize) } else { shown };
        raster::write_with(path, &shown, metadata, options)
    }
}

impl Images {
    /// Files at `target`, by `out`; an error if they cannot have its format.
    pub fn new(out: Option<&Path>, target: Target, look: Look, shard: Option<String>) -> Result<Self> {
        let formats = match output::image_format(out)? {
            None | Some("exr") if shard.is_some() => vec!["exr"],
            Some(_) if shard.is_some() => {
                return Err(Error::parameter("out", "a shard must be an OpenEXR file")
                    .with_hint("name a file with the extension .exr, or a folder"));
            }
            Some("png") => vec!["png"],
            Some(format) => vec![format, "png"],
            None => vec!["exr", "pfm", "ppm", "png"],
        };
        Ok(Self { target, formats, look, shard })
    }

    /// Writes the images of a render called `name`, and first `state`, from which a later run can continue. Of an
    /// interrupted render (`cut`) there is one such file in any case, and a preview.
    pub fn write(&self, part: &Part, name: &str, state: Option<&Path>, cut: bool) -> Result<Written> {
        state.map_or(Ok(()), |state| part.save(state))?;
        let mut images = Vec::new();
        let formats = match &self.shard {
            None if cut => &["exr", "png"],
            _ => self.formats.as_slice(),
        };
        let stem = self.stem(name)?;
        let image = part.film.image();
        for format in formats {
            let path = output::with_extension(&stem, format);
            if *format != "exr" {
                self.look.write(&path, format, &image, &part.metadata)?;
            } else if state.is_some_and(|state| cut || is_same_file(state, &path)) {
                continue;
            } else if self.shard.is_some() {
                part.save(&path)?;
            } else {
                part.write(&path)?;
            }
            images.push(path);
        }
        let mut written = self.target.written(images);
        written.files.splice(..0, state.map(Path::to_owned));
        Ok(written)
    }

    /// An error if the images of a render called `name` or its state could not be written.
    pub fn check(&self, name: &str, state: Option<&Path>) -> Result<()> {
        let stem = self.stem(name)?;
        let images = self.formats.iter().map(|format| output::with_extension(&stem, format));
        state.map(Path::to_owned).into_iter().chain(images).try_for_each(|path| files::check_writable(&path))
    }

    fn stem(&self, name: &str) -> Result<PathBuf> {
        let shard = self.shard.as_deref().filter(|_| !self.target.is_named()).unwrap_or("");
        // An interrupted render is saved in an EXR file, for any formats.
        self.target.stem(&output::file_name(name), shard, &[&self.formats[..], &["exr", "png"]].concat())
    }
}

/// The summary of a render. Field names are JSON keys.
#[derive(Serialize)]
pub struct Summary<'a> {
    pub scene: &'a str,
    width: usize,
    height: usize,
    spp: u32,
    /// Samples that every pixel has.
    samples: u32,
    /// Mean number of camera paths per sample; null without samples.
    camera_paths_per_sample: Option<f64>,
    light_samples: u32,
    max_depth: u32,
    /// Wall-clock time.
    pub seconds: f64,
    samples_per_second: f64,
    /// Peak of the whole process; null where the system does not say.
    peak_memory_bytes: Option<u64>,
    mean_rgb: [f64; 3],
    /// Standard error of the mean, if the errors of pixels are independent; null where a pixel has fewer than two samples.
    standard_error_mean_rgb: [f64; 3],
    /// Root of the mean over all pixels of the squared standard error.
    standard_error_pixel_rgb: [f64; 3],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    paths: Vec<PathClass>,
    /// Samples that count as black.
    pub dropped: Dropped,
    /// Features that the kernel leaves out.
    pub left_out: Vec<&'static str>,
    pub interrupted: bool,
    #[serde(flatten)]
    pub written: Written,
}

/// The light of one class of paths.
#[derive(Serialize)]
struct PathClass {
    class: String,
    mean_rgb: [f64; 3],
    /// Share of the image's luminance.
    share: f64,
}

impl<'a> Summary<'a> {
    /// The summary of a part to which `done` samples (of single pixels) were added in `seconds`.
    pub fn new(scene: &'a str, request: &Request, part: &Part, done: u64, seconds: f64) -> Self {
        let film = &part.film;
        let mean = mean(&film.image(), |v| v);
        let square = self::mean(&film.standard_error(), |v| v * v);
        let classes = film.path_layers().into_iter().map(|(class, layer)| {
            let light = self::mean(&layer, |v| v);
            PathClass { class, mean_rgb: light.to_array(), share: luminance(light) / luminance(mean) }
        });
        Self {
            scene,
            width: film.width(),
            height: film.height(),
            spp: request.spp,
            samples: film.pixels().iter().map(|pixel| pixel.samples()).min().unwrap_or(0),
            camera_paths_per_sample: part.camera_paths_per_sample(),
            light_samples: request.light_samples,
            max_depth: request.max_depth,
            seconds,
            samples_per_second: done as f64 / seconds,
            peak_memory_bytes: memory::of_process("VmHWM:"),
            mean_rgb: mean.to_array(),
            standard_error_mean_rgb: square.to_array().map(|v| (v / film.pixels().len() as f64).sqrt()),
            standard_error_pixel_rgb: square.to_array().map(f64::sqrt),
            paths: classes.collect(),
            dropped: film.dropped(),
            left_out: Vec::new(),
            interrupted: false,
            written: Written::default(),
        }
    }

    pub fn text(&self) -> String {
        let rgb = |v: [f64; 3]| {
            if v.iter().all(|v| v.is_finite()) { v.map(|v| format!("{v:.5}")).join(" ") } else { "unknown".into() }
        };
        let samples = if self.samples == self.spp { String::new() } else { format!("{} of ", self.samples) };
        let paths = match self.camera_paths_per_sample {
            None | Some(1.0) => String::new(),
            Some(mean) => format!(" ({mean:.2} camera paths each)"),
        };
        let told = format!(
            "{} {}x{}, {samples}{} per pixel{paths}, {}, depth {}: {:.2} s, {:.2} million samples/s",
            self.scene,
            self.width,
            self.height,
            counted(self.spp as usize, "sample"),
            counted(self.light_samples as usize, "light sample"),
            self.max_depth,
            self.seconds,
            self.samples_per_second * 1e-6
        );
        let mut text = wrapped(&told, "", LINE);
        let [of_mean, of_pixel] = [self.standard_error_mean_rgb, self.standard_error_pixel_rgb].map(rgb);
        text += &format!("mean {}, standard error {of_mean}\n", rgb(self.mean_rgb));
        text += &format!("standard error of a pixel {of_pixel}\n");
        if !self.left_out.is_empty() {
            text += &wrapped(&format!("left out for this scene: {}", self.left_out.join(", ")), "", LINE);
        }
        for path in self.paths.iter().filter(|path| path.share > 0.0) {
            text += &format!("{:<7} {:>5.1} %  mean {}\n", path.class, 100.0 * path.share, rgb(path.mean_rgb));
        }
        text + &self.written.text()
    }
}

fn mean(image: &Image, value: impl Fn(DVec3) -> DVec3) -> DVec3 {
    let pixels = image.pixels();
    pixels.iter().map(|p| value(p.as_dvec3())).sum::<DVec3>() / pixels.len() as f64
}

fn luminance(rgb: DVec3) -> f64 {
    rgb.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}
