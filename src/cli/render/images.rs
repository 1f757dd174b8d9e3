//! The files of a render: images, and the state from which it can be continued.

use etalon_core::error::{Error, Result};
use etalon_core::files::{self, is_same_file};
use etalon_core::raster::{self, Image, Metadata, ToneMap, WriteOptions};
use etalon_figures::output::{self, Target, Written};
use etalon_render::film::Part;
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
    /// Tone mapping; by default, that of the format.
    pub tone: Option<ToneMap>,
    /// Exposure in stops, before tone mapping.
    pub exposure: f32,
    /// Side of the square of PNG pixels that show a pixel.
    pub scale: u32,
}

impl Look {
    fn write(&self, path: &Path, format: &str, image: &Image, metadata: &Metadata) -> Result<()> {
        let usual = if format == "ppm" { ToneMap::LinearMax } else { ToneMap::default() };
        let options = WriteOptions { tone: self.tone.unwrap_or(usual), ..WriteOptions::default() };
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
