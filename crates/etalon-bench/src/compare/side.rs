//! One side of a comparison: replicates, or one image whose noise is known by its pixels, read from files.

use etalon_core::error::{Error, Result};
use etalon_core::math::Rgb;
use etalon_core::raster::{ExrFile, Image, ReadOptions, read_with_notes};
use etalon_render::film::ERRORS_OF_SUMS;
use etalon_stats::Extremes;
use serde::Serialize;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Differences up to this fraction of what is measured do not count: half floats, in which many images are stored, are no
/// more precise.
pub const PRECISION: f64 = 1.0 / 2048.0;

/// Replicates of a side from which each functional has its own variance, and tiles are tested: their test is far out in the tail
/// of Student's t, where a handful of replicates says nothing.
const ENOUGH_REPLICATES: usize = 16;

/// What is known of the noise of a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// It shows in how independent images differ.
    Replicates,
    /// Each pixel has a standard error, and pixels are independent (or as if: the errors bound those of sums of pixels).
    PerPixel,
    None,
}

/// One renderer's images.
#[derive(Debug, Clone)]
pub struct Side {
    /// The replicates; one image where the noise is known otherwise.
    pub images: Vec<Image>,
    pub noise: Noise,
    /// What users should know of the files.
    pub notes: Vec<String>,
    error: Option<Image>,
    /// Whether the channels are X, Y and Z of CIE 1931.
    xyz: bool,
    /// The seed that a file names.
    seeds: Vec<String>,
    /// Where the images come from; empty for images that are no files.
    pub(super) files: Vec<PathBuf>,
}

/// Reads an image; one of 8 bits has no expectation to test.
fn read_linear(path: &Path) -> Result<(Image, Vec<String>)> {
    read_with_notes(path, ReadOptions::default()).map_err(|error| match error {
        Error::Unsupported { .. } => {
            error.with_hint("give an OpenEXR, Radiance HDR or PFM file: 8 bits are rounded and clipped at 1")
        }
        other => other,
    })
}

impl Side {
    /// Independent images, at least two.
    pub fn replicates(images: Vec<Image>) -> Self {
        Self {
            images,
            noise: Noise::Replicates,
            notes: Vec::new(),
            error: None,
            xyz: false,
            seeds: Vec::new(),
            files: Vec::new(),
        }
    }

    /// An image whose independent pixels have these standard errors.
    pub fn with_error(image: Image, error: Image) -> Self {
        Self { noise: Noise::PerPixel, error: Some(error), ..Self::replicates(vec![image]) }
    }

    /// An image without noise.
    pub fn exact(image: Image) -> Self {
        Self { noise: Noise::None, ..Self::replicates(vec![image]) }
    }

    /// Reads a side: several files are replicates; one file must be OpenEXR with the layer `error` (standard errors) or with
    /// second moments `m2_L` of a layer `L` in RGB or XYZ, as Mitsuba's integrator `moment` writes them, from `spp` samples
    /// per pixel (or as many as the attribute `spp` says).
    ///
    /// # Errors
    /// Those of [`read`](etalon_core::raster::read()), and [`Error::Input`] for one file that says nothing of its noise.
    pub fn read(paths: &[PathBuf], spp: Option<u32>) -> Result<Self> {
        if let [path] = paths {
            return Self::read_one(path, spp);
        }
        let mut side = Self { files: paths.to_vec(), ..Self::replicates(Vec::new()) };
        for path in paths {
            let (image, notes) = read_linear(path)?;
            side.images.push(image);
            side.notes.extend(notes);
            // Files that are no OpenEXR have no attributes that could name a seed.
            if let Some(seed) = ExrFile::open(path).ok().and_then(|file| file.metadata().get("seed").map(str::to_owned))
            {
                side.seeds.push(seed);
            }
        }
        Ok(side)
    }

    /// Reads an image without noise.
    ///
    /// # Errors
    /// Those of [`read`](etalon_core::raster::read()).
    pub fn read_exact(path: &Path) -> Result<Self> {
        let (image, notes) = read_linear(path)?;
        Ok(Self { notes, files: vec![path.to_path_buf()], ..Self::exact(image) })
    }

    fn read_one(path: &Path, spp: Option<u32>) -> Result<Self> {
        let (image, notes) = read_linear(path)?;
        let unknown = || {
            Error::input(path, "one image that says nothing of its noise")
                .with_hint("give several of different seeds, an OpenEXR file with a layer of standard errors or of second moments, or say that it has no noise")
        };
        let file = ExrFile::open(path).map_err(|_| unknown())?;
        let layers = file.layers()?;
        let layer = |name: &str| layers.iter().find(|(known, _)| known == name).map(|(_, image)| image.clone());
        let attributes = file.metadata();
        let mut side = if let Some(error) = layer("error") {
            Self::with_error(image, error)
        } else {
            let moments = file.layer_names().into_iter().find(|name| name.starts_with(MOMENT)).ok_or_else(unknown)?;
            let base = &moments[MOMENT.len()..];
            let (mean, square, xyz) = match (layer(base), layer(&moments)) {
                (Some(mean), Some(square)) => (mean, square, false),
                _ => match (file.tristimulus(base)?, file.tristimulus(&moments)?) {
                    (Some(mean), Some(square)) => (mean, square, true),
                    _ => return Err(unknown()),
                },
            };
            let spp = spp.or_else(|| attributes.get("spp")?.parse().ok()).ok_or_else(|| {
                Error::parameter("spp", format!("{} has second moments, but not the number of samples", path.display()))
                    .with_hint("say how many samples each pixel has")
            })?;
            Self { xyz, ..Self::with_error(mean.clone(), error_of_moments(&mean, &square, spp)) }
        };
        side.notes = notes;
        side.files = vec![path.to_path_buf()];
        let [name, value] = ERRORS_OF_SUMS;
        if attributes.get(name) != Some(value) {
            side.notes.push(format!(
                "{}: errors by pixel: right for independent samples that belong to one pixel each, conservative for stratified \
                 ones; renderers that add a sample to several pixels need replicates",
                path.display()
            ));
        }
        side.seeds.extend(attributes.get("seed").map(str::to_owned));
        Ok(side)
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        self.images.first().map_or([0, 0], |image| [image.width(), image.height()])
    }

    pub fn shares_seeds(&self, other: &Self) -> bool {
        self.seeds.iter().any(|seed| other.seeds.contains(seed))
    }

    pub(super) fn error(&self) -> Option<&Image> {
        self.error.as_ref()
    }

    pub(super) fn has_few_replicates(&self) -> bool {
        self.noise == Noise::Replicates && self.images.len() < ENOUGH_REPLICATES
    }

    /// Degrees of freedom of the image's mean if there were `n` replicates, from those that it has.
    pub(super) fn dof_of(&self, n: usize, dof: f64) -> f64 {
        let own = n as f64 - 1.0;
        if n < ENOUGH_REPLICATES { dof * own / (self.images.len() as f64 - 1.0) } else { own }
    }
}

/// Before the name of a layer: its second moments.
const MOMENT: &str = "m2_";

/// √((mean of squares − square of the mean)/(n − 1)).
fn error_of_moments(mean: &Image, square: &Image, spp: u32) -> Image {
    Image::from_fn(mean.width(), mean.height(), |x, y| {
        let (m, s) = (mean.get(x, y), square.get(x, y));
        Rgb::from_array(std::array::from_fn(|c| {
            let variance = (f64::from(s[c]) - f64::from(m[c]).powi(2)).at_least(0.0);
            (variance / (f64::from(spp) - 1.0)).sqrt() as f32
        }))
    })
}

/// X, Y and Z of R, G and B with the primaries of Rec. 709 and white D65. Source: Rec. ITU-R BT.709-6; SMPTE RP 177.
const XYZ_FROM_RGB: [[f64; 3]; 3] =
    [[0.412_391, 0.357_584, 0.180_481], [0.212_639, 0.715_169, 0.072_192], [0.019_331, 0.119_195, 0.950_532]];

/// Brings both sides to XYZ if one of them has it; returns the names of the channels.
///
/// The error of a sum of correlated channels is at most the sum of their errors: sides with errors by pixel get that.
pub(super) fn in_common_colours(sides: &mut [Side; 2]) -> [&'static str; 3] {
    if sides.iter().all(|side| !side.xyz) {
        return ["R", "G", "B"];
    }
    let convert = |image: &mut Image| {
        let xyz = |p: Rgb| XYZ_FROM_RGB.map(|row| (0..3).map(|c| row[c] * f64::from(p[c])).sum::<f64>() as f32);
        *image = image.map(|p| Rgb::from_array(xyz(p)));
    };
    for side in sides.iter_mut().filter(|side| !side.xyz) {
        side.images.iter_mut().chain(side.error.as_mut()).for_each(convert);
        side.xyz = true;
    }
    ["X", "Y", "Z"]
}

/// An image with pixels that are NaN or infinite.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NotFinite {
    /// Its file, or its number and side.
    pub image: String,
    /// The first such pixel, counted from 0.
    pub column: usize,
    pub row: usize,
    /// All of its own.
    pub pixels: usize,
    /// Images with such pixels, of both sides.
    pub images: usize,
}

/// The first image with pixels that are not finite. Those of all images of a side, if it has several, are masked.
pub(super) fn not_finite(sides: &[Side; 2]) -> Option<NotFinite> {
    let width = sides[0].size()[0];
    let of = |[side, i]: [usize; 2]| {
        let images = &sides[side].images;
        let is_masked = |k: usize| images.len() > 1 && images.iter().all(|image| !image.pixels()[k].is_finite());
        let pixels = images[i].pixels();
        let is_wrong = |k: &usize| !pixels[*k].is_finite() && !is_masked(*k);
        let first = (0..pixels.len()).find(is_wrong)?;
        let count = (0..pixels.len()).filter(is_wrong).count();
        let (image, column, row) = (name(sides, [side, i]), first % width, first / width);
        Some(NotFinite { image, column, row, pixels: count, images: 1 })
    };
    let mut all = (0..2).flat_map(|side| (0..sides[side].images.len()).map(move |i| [side, i])).filter_map(of);
    let first = all.next()?;
    Some(NotFinite { images: 1 + all.count(), ..first })
}

/// What an image is called: its file, or its number.
fn name(sides: &[Side; 2], [side, i]: [usize; 2]) -> String {
    match sides[side].files.get(i) {
        Some(path) => path.display().to_string(),
        None => format!("image {} of {}", i + 1, ["A", "B"][side]),
    }
}

/// Which pixels are finite in all images, errors included.
pub(super) fn finite(sides: &[Side; 2]) -> Vec<bool> {
    let [width, height] = sides[0].size();
    let mut valid = vec![true; width * height];
    for image in sides.iter().flat_map(|side| side.images.iter().chain(&side.error)) {
        valid.iter_mut().zip(image.pixels()).for_each(|(valid, p)| *valid &= p.is_finite());
    }
    valid
}

/// Refuses an image that occurs twice, on one side or on both: it is no independent replicate.
pub(super) fn check_distinct(sides: &[Side; 2]) -> Result<()> {
    let mut seen: HashMap<Vec<u32>, Vec<[usize; 2]>> = HashMap::new();
    for place in (0..2).flat_map(|side| (0..sides[side].images.len()).map(move |i| [side, i])) {
        let image = |[side, i]: [usize; 2]| &sides[side].images[i];
        let pixels = image(place).pixels();
        // What has no numbers is no image, and is refused for that.
        if !pixels.iter().any(|pixel| pixel.is_finite()) {
            continue;
        }
        // A few pixels tell most images apart.
        let key = pixels.iter().step_by(pixels.len().div_ceil(64).max(1));
        let same = seen.entry(key.flat_map(|p| p.to_array().map(f32::to_bits)).collect()).or_default();
        if let Some(other) = same.iter().find(|other| bits(image(**other)).eq(bits(image(place)))) {
            let message = format!(
                "{} and {} are the same image to the last bit: no independent replicates",
                name(sides, *other),
                name(sides, place)
            );
            return Err(Error::parameter(["a", "against"][place[0]], message)
                .with_hint("render each image with a seed of its own; seeds that make no difference are a bug"));
        }
        same.push(place);
    }
    Ok(())
}

fn bits(image: &Image) -> impl Iterator<Item = u32> + '_ {
    image.pixels().iter().flat_map(|p| p.to_array().map(f32::to_bits))
}

pub(super) fn mean_image(side: &Side) -> Image {
    let [width, height] = side.size();
    let mut sums = vec![glam::DVec3::ZERO; width * height];
    for image in &side.images {
        sums.iter_mut().zip(image.pixels()).for_each(|(sum, p)| *sum += p.as_dvec3());
    }
    let n = side.images.len() as f64;
    Image::from_pixels(width, height, sums.into_iter().map(|sum| (sum / n).as_vec3()).collect())
}
