//! A figure's image inside the page: the SVG of small plots, else the PNG, reduced or as JPEG.

use crate::error::{Error, Result};
use crate::figure::base64;
use crate::files;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::FilterType;
use std::path::Path;

/// Larger plots take fewer bytes as an image.
const LARGEST_SVG: usize = 150_000;
/// Larger PNG files are noisy; as JPEG they take fewer bytes.
const LARGEST_PNG: usize = 60_000;
/// Wider images are reduced to this width in pixels.
const WIDEST: u32 = 1200;
/// Of JPEG: differs from the PNG by less than the noise of the images.
const QUALITY: u8 = 82;
const LIMIT: u64 = 256 << 20;

pub struct EmbeddedImage {
    /// A `data:` address.
    pub source: String,
    pub width: u32,
    pub height: u32,
    /// Whether it stays sharp at any size.
    pub vector: bool,
}

impl EmbeddedImage {
    /// The image of the figure `id` in `folder`.
    ///
    /// # Errors
    /// When a file of it is missing or damaged.
    pub fn read(folder: &Path, id: &str) -> Result<Self> {
        let path = folder.join(format!("{id}.svg"));
        let svg = files::read_bounded(&path, LIMIT)?;
        let embedded = |kind: &str, bytes: &[u8], [width, height]: [u32; 2], vector| {
            Ok(Self { source: format!("data:image/{kind};base64,{}", base64(bytes)), width, height, vector })
        };
        // Plots: the SVG itself, unless it is large or has an image inside
        if svg.len() <= LARGEST_SVG && !svg.windows(6).any(|w| w == b"<image") {
            let size = size(&svg).ok_or_else(|| Error::input(&path, "no drawing with a size"))?;
            return embedded("svg+xml", &svg, size, true);
        }
        // Images: the PNG if it is small, else a JPEG of limited width
        let path = folder.join(format!("{id}.png"));
        let png = files::read_bounded(&path, LIMIT)?;
        let damaged = |e: image::ImageError| Error::input(&path, e.to_string());
        let mut full = image::load_from_memory_with_format(&png, image::ImageFormat::Png).map_err(damaged)?;
        if png.len() <= LARGEST_PNG {
            return embedded("png", &png, [full.width(), full.height()], false);
        }
        if full.width() > WIDEST {
            full = full.resize(WIDEST, u32::MAX, FilterType::CatmullRom);
        }
        let size = [full.width(), full.height()];
        let mut jpeg = Vec::new();
        JpegEncoder::new_with_quality(&mut jpeg, QUALITY).encode_image(&full.into_rgb8()).map_err(damaged)?;
        embedded("jpeg", &jpeg, size, false)
    }
}

/// Width and height that a drawing's first tag gives, rounded up.
fn size(svg: &[u8]) -> Option<[u32; 2]> {
    let start = String::from_utf8_lossy(&svg[..svg.len().min(1000)]).into_owned();
    let tag = start.split_once("<svg")?.1.split_once('>')?.0;
    let attribute = |name: &str| {
        let value: f64 = tag.split_once(&format!(" {name}=\""))?.1.split_once('"')?.0.parse().ok()?;
        (value > 0.0 && value < 1e6).then(|| value.ceil() as u32)
    };
    Some([attribute("width")?, attribute("height")?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Drawing, Rect, Rgb8};

    #[test]
    fn small_drawings_stay_vectors_and_noise_becomes_small() {
        let dir = tempfile::tempdir().unwrap();
        let mut drawing = Drawing::new(300.5, 200.0, 1.0);
        drawing.write(&dir.path().join("a")).unwrap();
        let small = EmbeddedImage::read(dir.path(), "a").unwrap();
        assert!(small.vector && small.source.starts_with("data:image/svg+xml;base64,"));
        assert_eq!([small.width, small.height], [301, 200]);
        let noise = Rgb8::from_fn(300, 200, |x, y| {
            let mut n = (300 * y + x + 1) as u64;
            for _ in 0..3 {
                n = (n ^ (n >> 29)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            }
            [(n >> 40) as u8, (n >> 48) as u8, (n >> 56) as u8]
        });
        drawing.image(Rect::new(0.0, 0.0, 300.0, 200.0), noise);
        drawing.write(&dir.path().join("b")).unwrap();
        let large = EmbeddedImage::read(dir.path(), "b").unwrap();
        assert!(!large.vector && large.source.starts_with("data:image/jpeg;base64,"));
        std::fs::write(dir.path().join("b.png"), vec![7; LARGEST_PNG + 1]).unwrap();
        assert!(matches!(EmbeddedImage::read(dir.path(), "b"), Err(Error::Input { .. })));
    }
}
