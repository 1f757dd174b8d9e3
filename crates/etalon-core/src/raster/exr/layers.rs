//! All layers of an OpenEXR file, its text attributes, and channels that hold counts instead of light.

use super::choose::{Shown, choose, layers, named};
use super::decode::{check_window, read_layers};
use super::encode::is_free_name;
use super::file::Exr;
use crate::error::{Error, Result};
use crate::files::read_bounded;
use crate::raster::{Image, Metadata};
use exr::math::Vec2;
use exr::meta::attribute::SampleType;
use std::path::Path;

/// Larger files are refused unread.
const MAX_FILE_BYTES: u64 = 1 << 33;
/// Pixels whose integers are set together.
const RUN: usize = 16;

/// An OpenEXR file whose header has been read.
#[derive(Debug, Clone)]
pub struct ExrFile {
    file: Exr<'static>,
    metadata: Metadata,
}

impl ExrFile {
    /// Reads a file and looks at its header.
    ///
    /// # Errors
    /// [`Error::Input`] for a damaged file or one that is not OpenEXR, [`Error::Unsupported`] for an unknown
    /// compression, [`Error::Limit`] for more than 8 GiB or 4096 channels, and [`Error::Io`].
    pub fn open(path: &Path) -> Result<Self> {
        if path.is_dir() {
            return Err(Error::input(path, "this is a directory, not an OpenEXR file"));
        }
        let bytes = read_bounded(path, MAX_FILE_BYTES)?;
        if !bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
            return Err(Error::input(path, "this is not an OpenEXR file"));
        }
        let file = Exr::parse(path, bytes)?;
        let mut metadata = Metadata::default();
        for (name, value) in file.texts() {
            if is_free_name(&name) && metadata.get(&name).is_none() {
                metadata = metadata.with(name, value);
            }
        }
        Ok(Self { file, metadata })
    }

    /// The text attributes to which the format gives no meaning of its own, in their order: what
    /// [`write_exr`](super::write_exr) was given as metadata.
    #[must_use]
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// The layers in the part of the file that holds the image, the unnamed one first, then by name. Each is shown as
    /// [`read`](crate::raster::read()) shows the image. Layers of unsigned integers, which are no light, are left out, and
    /// so are those of several channels without a colour or Y.
    ///
    /// # Errors
    /// Those of [`read`](crate::raster::read()), and [`Error::Limit`] when the layers have more than 2^28 pixels in all.
    pub fn layers(&self) -> Result<Vec<(String, Image)>> {
        let part = choose(&self.file.path, self.file.headers())?.part;
        let is_light = |layer: &Shown| layer.rgb.iter().flatten().any(|c| c.kind != SampleType::U32);
        let layers: Vec<Shown> = layers(&self.file.headers()[part]).into_iter().filter(is_light).collect();
        let images = read_layers(&self.file, part, &layers)?;
        Ok(layers.into_iter().zip(images).map(|(layer, (image, _))| (layer.name, image)).collect())
    }

    /// The names of all layers in the part of the file that holds the image, of any channels; empty for none.
    #[must_use]
    pub fn layer_names(&self) -> Vec<String> {
        let part = choose(&self.file.path, self.file.headers()).map_or(0, |choice| choice.part);
        let names = self.file.headers()[part].channels.list.iter().map(|channel| channel.name.to_string());
        let mut layers: Vec<String> =
            names.map(|name| name.rsplit_once('.').map_or(String::new(), |(layer, _)| layer.into())).collect();
        layers.dedup();
        layers
    }

    /// The layer's channels X, Y and Z, as they stand in the file; `None` if one is missing.
    ///
    /// # Errors
    /// Those of [`ExrFile::layers`].
    pub fn tristimulus(&self, layer: &str) -> Result<Option<Image>> {
        let part = choose(&self.file.path, self.file.headers())?.part;
        let Some(shown) = named(&self.file.headers()[part], layer, ["X", "Y", "Z"]) else { return Ok(None) };
        Ok(read_layers(&self.file, part, &[shown])?.pop().map(|(image, _)| image))
    }

    /// Width and height of the first part.
    ///
    /// # Errors
    /// [`Error::Limit`] as in [`read`](crate::raster::read()); [`Error::Unsupported`] for a cropped, deep or subsampled
    /// image.
    pub fn size(&self) -> Result<(usize, usize)> {
        let header = &self.file.headers()[0];
        let (data, window) = (header.data_window(), header.shared_attributes.display_window);
        check_window(&self.file.path, data, window, self.file.bytes.len())?;
        let plain = header.channels.list.iter().all(|c| c.sampling == Vec2(1, 1)) && !header.deep;
        if data != window || !plain {
            return Err(Error::unsupported(
                &self.file.path,
                "cropped, deep or subsampled OpenEXR data are not read here",
            )
            .with_hint("take the file as it was written, not as another program saved it"));
        }
        Ok(window.size.into())
    }

    /// Whether the first part of the file has a channel of unsigned integers with this name.
    #[must_use]
    pub fn counts(&self, name: &str) -> bool {
        let mut channels = self.file.headers()[0].channels.list.iter();
        channels.any(|channel| channel.sample_type == SampleType::U32 && channel.name == *name)
    }

    /// Reads channels of unsigned integers from the first part of the file. When they are known to be there, `start`
    /// makes what `set` then fills: it gets the number of the channel in `names`, that of the pixel, and the value.
    ///
    /// # Errors
    /// [`Error::Input`] when a channel is missing or of another type, and for damaged data; those of [`ExrFile::size`].
    pub fn unsigned<T>(
        &self,
        names: &[String],
        start: impl FnOnce() -> Result<T>,
        mut set: impl FnMut(&mut T, usize, usize, u32),
    ) -> Result<T> {
        let (width, _) = self.size()?;
        let header = &self.file.headers()[0];
        // Bytes of a pixel before each channel.
        let mut before = std::collections::HashMap::new();
        let mut sum = 0;
        for channel in &header.channels.list {
            if channel.sample_type == SampleType::U32 {
                before.insert(channel.name.to_string(), sum);
            }
            sum += channel.sample_type.bytes_per_sample();
        }
        let find = |name: &String| before.get(name).copied().ok_or_else(|| self.missing(name));
        let places: Vec<usize> = names.iter().map(find).collect::<Result<_>>()?;
        let blocks = self.file.blocks(0)?;
        let mut result = start()?;
        blocks.read(
            |_, bytes| bytes,
            |block, bytes| {
                let lines = bytes.chunks_exact(block.width * header.channels.bytes_per_pixel);
                for (y, line) in (block.y..).zip(lines) {
                    // All channels of a few pixels, then the next pixels: those in `T` stay in the cache meanwhile.
                    for start in (0..block.width).step_by(RUN) {
                        let run = RUN.min(block.width - start);
                        for (channel, before) in places.iter().enumerate() {
                            let values = line[before * block.width + 4 * start..][..4 * run].chunks_exact(4);
                            for (pixel, b) in (y * width + block.x + start..).zip(values) {
                                set(&mut result, channel, pixel, u32::from_ne_bytes([b[0], b[1], b[2], b[3]]));
                            }
                        }
                    }
                }
            },
        )?;
        Ok(result)
    }

    fn missing(&self, name: &str) -> Error {
        Error::input(&self.file.path, format!("there is no channel {name:?} of unsigned integers"))
    }
}
