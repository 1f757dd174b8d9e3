//! A figure's image inside the page: charts as SVG, pictures as PNG or JPEG, and a thumbnail of either.

use crate::figure::with_dark_colours;
use base64::prelude::{BASE64_STANDARD, Engine};
use etalon_core::error::{Error, Result};
use etalon_core::files;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::FilterType;
use image::{DynamicImage, Rgb, RgbImage};
use std::path::Path;

/// Larger PNG files may be noisy; as JPEG these take fewer bytes.
const LARGEST_PNG: usize = 30_000;
/// Wider images are reduced to this width in pixels, and inside charts to this many pixels for each unit of the drawing.
const WIDEST: u32 = 1200;
const SHARP: f64 = 1.5;
/// Quality of JPEG images: differs from the PNG by less than the noise of the images.
const QUALITY: u8 = 66;
/// Width and height of a thumbnail in pixels.
const THUMBNAIL: [u32; 2] = [200, 150];
const LIMIT: u64 = 256 << 20;
/// How the drawings' own images start.
const PNG: &str = "href=\"data:image/png;base64,";

pub struct EmbeddedImage {
    /// A `data:` address.
    pub source: String,
    pub width: u32,
    pub height: u32,
    /// Whether it is a chart: it has text, stays sharp at any size, and follows a dark page.
    pub chart: bool,
    /// Whether one image takes most of the chart, which may be reduced then.
    pub map: bool,
    /// A small one, as a `data:` address, and whether a dark page exchanges its black and white.
    pub thumbnail: String,
    pub inverts: bool,
}

impl EmbeddedImage {
    /// The image of the figure `id` in `folder`.
    ///
    /// # Errors
    /// When a file of it is missing or damaged.
    pub fn read(folder: &Path, id: &str) -> Result<Self> {
        let [path, png_path] = ["svg", "png"].map(|extension| folder.join(format!("{id}.{extension}")));
        let svg = String::from_utf8(files::read_own(&path, LIMIT)?)
            .map_err(|_| Error::input(&path, "no drawing: it is not UTF-8"))?;
        let png = files::read_own(&png_path, LIMIT)?;
        let full = decoded(&png, &png_path)?;
        let small = |image| -> Result<String> { Ok(address("jpeg", &jpeg(image, &png_path)?)) };
        if svg.contains("<text") {
            let tag = svg.split_once("<svg").and_then(|(_, rest)| rest.split_once('>'));
            let [width, height] =
                tag.and_then(|(tag, _)| size(tag)).ok_or_else(|| Error::input(&path, "no drawing with a size"))?;
            let (svg, largest) = with_small_images(&svg, &path)?;
            let source = vector_address(&with_dark_colours(&svg));
            let (inverts, area) = (largest.is_none(), f64::from(width) * f64::from(height));
            let map = largest.is_some_and(|[_, _, w, h]| f64::from(w) * f64::from(h) > 0.5 * area);
            // What is drawn on a picture belongs to it
            let scale = f64::from(full.width()) / f64::from(width);
            let pictured = |[x, y, w, h]: [u32; 4]| {
                let [x, y, w, h] = [x, y, w, h].map(|v| (f64::from(v) * scale) as u32);
                middle(&full.crop_imm(x, y, w, h))
            };
            let thumbnail = small(largest.map_or_else(|| whole(&full), pictured))?;
            return Ok(Self { source, width, height, chart: true, map, thumbnail, inverts });
        }
        let thumbnail = small(middle(&full))?;
        let (source, [width, height]) = picture(&png, full, WIDEST, &png_path)?;
        Ok(Self { source, width, height, chart: false, map: false, thumbnail, inverts: false })
    }
}

/// The thumbnail of a picture, and of a chart with pictures that of the largest: what is in its middle.
fn middle(full: &DynamicImage) -> DynamicImage {
    let filter = if full.width() < THUMBNAIL[0] { FilterType::Nearest } else { FilterType::CatmullRom };
    full.resize_to_fill(THUMBNAIL[0], THUMBNAIL[1], filter)
}

/// The thumbnail of a chart, half of it the darkest of the pixels that become one: thin lines would fade.
fn whole(full: &DynamicImage) -> DynamicImage {
    let mean = full.resize(THUMBNAIL[0], THUMBNAIL[1], FilterType::CatmullRom).into_rgb8();
    let full = full.to_rgb8();
    let part = |at: u32, of: u32, size: u32| at * size / of..((at + 1) * size).div_ceil(of);
    let small = RgbImage::from_fn(mean.width(), mean.height(), |x, y| {
        let columns = part(x, mean.width(), full.width());
        let pixels = part(y, mean.height(), full.height()).flat_map(|y| columns.clone().map(move |x| (x, y)));
        let darkness = |pixel: &Rgb<u8>| pixel.0.map(u32::from).iter().sum::<u32>();
        let darkest = pixels.map(|(x, y)| *full.get_pixel(x, y)).min_by_key(darkness).unwrap_or(Rgb([255; 3]));
        Rgb([0, 1, 2].map(|c| darkest[c].midpoint(mean.get_pixel(x, y)[c])))
    });
    small.into()
}

/// A PNG as it is, or if that takes fewer bytes, as a JPEG of limited width; and its size.
fn picture(png: &[u8], mut full: DynamicImage, widest: u32, path: &Path) -> Result<(String, [u32; 2])> {
    if png.len() <= LARGEST_PNG {
        return Ok((address("png", png), [full.width(), full.height()]));
    }
    if full.width() > widest {
        full = full.resize(widest, u32::MAX, FilterType::CatmullRom);
    }
    let (size, jpeg) = ([full.width(), full.height()], jpeg(full, path)?);
    Ok((if jpeg.len() < png.len() { address("jpeg", &jpeg) } else { address("png", png) }, size))
}

/// A drawing whose large images are reduced, and the place of the largest of them: left, top, width and height.
fn with_small_images(svg: &str, path: &Path) -> Result<(String, Option<[u32; 4]>)> {
    let mut largest: Option<[u32; 4]> = None;
    let mut parts = svg.split(PNG);
    let mut small = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (data, rest) = part.split_once('"').ok_or_else(|| Error::input(path, "an image without an end"))?;
        let png = BASE64_STANDARD.decode(data).map_err(|e| Error::input(path, format!("an image: {e}")))?;
        let image = decoded(&png, path)?;
        let tag = small.rfind("<image").map_or("", |start| &small[start..]);
        let [width, height] = size(tag).ok_or_else(|| Error::input(path, "an image without a size"))?;
        let at = |name: &str| attribute(tag, name).and_then(|v| v.parse().ok()).unwrap_or(0.0_f64) as u32;
        let place = [at("x"), at("y"), width, height];
        let widest = WIDEST.min((SHARP * f64::from(width)) as u32);
        let (source, _) = picture(&png, image, widest, path)?;
        small += &format!("href=\"{source}\"{rest}");
        let area = |[_, _, width, height]: [u32; 4]| width.saturating_mul(height);
        largest = largest.filter(|largest| area(*largest) >= area(place)).or(Some(place));
    }
    Ok((small, largest))
}

fn decoded(png: &[u8], path: &Path) -> Result<DynamicImage> {
    image::load_from_memory_with_format(png, image::ImageFormat::Png).map_err(|e| Error::input(path, e.to_string()))
}

fn jpeg(image: DynamicImage, path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let encoded = JpegEncoder::new_with_quality(&mut bytes, QUALITY).encode_image(&image.into_rgb8());
    encoded.map_err(|e| Error::input(path, e.to_string()))?;
    Ok(bytes)
}

fn address(kind: &str, bytes: &[u8]) -> String {
    format!("data:image/{kind};base64,{}", BASE64_STANDARD.encode(bytes))
}

/// A drawing as an address. Its images are base64 already: what has a meaning in addresses or in HTML is escaped, and the rest
/// is left as it is. Quotes of attributes, whose values have none, become those that need no escape.
fn vector_address(svg: &str) -> String {
    let mut address = "data:image/svg+xml;charset=utf-8,".to_owned();
    let mut in_tag = false;
    for c in svg.chars() {
        match c {
            '"' if in_tag => address.push('\''),
            '%' | '#' | '"' | '<' | '&' | '\n' | '\r' | '\t' => address += &format!("%{:02X}", u32::from(c)),
            c => address.push(c),
        }
        in_tag = c == '<' || in_tag && c != '>';
    }
    address
}

fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    Some(tag.split_once(&format!(" {name}=\""))?.1.split_once('"')?.0)
}

/// Width and height in drawing units, rounded up, that a tag gives: of a drawing by its view.
fn size(tag: &str) -> Option<[u32; 2]> {
    let (width, height) = match attribute(tag, "viewBox") {
        Some(view) => view.strip_prefix("0 0 ")?.split_once(' ')?,
        None => (attribute(tag, "width")?, attribute(tag, "height")?),
    };
    let side = |text: &str| text.parse().ok().filter(|v: &f64| *v > 0.0 && *v < 1e6).map(|v| v.ceil() as u32);
    Some([side(width)?, side(height)?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{FORMATS, Page, Rect, Rgb8, Text};

    /// Noise, which compresses badly as PNG.
    fn noise() -> Rgb8 {
        Rgb8::from_fn(300, 200, |x, y| {
            let mut n = (300 * y + x + 1) as u64;
            for _ in 0..3 {
                n = (n ^ (n >> 29)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            }
            [(n >> 40) as u8, (n >> 48) as u8, (n >> 56) as u8]
        })
    }

    fn written(name: &str, change: impl Fn(&mut Page)) -> (tempfile::TempDir, Result<EmbeddedImage>) {
        let dir = tempfile::tempdir().unwrap();
        let mut drawing = Page::new(300.5, 200.0, 1.0);
        change(&mut drawing);
        drawing.write(&dir.path().join(name), &FORMATS).unwrap();
        let image = EmbeddedImage::read(dir.path(), name);
        (dir, image)
    }

    #[test]
    fn charts_stay_vectors_and_noise_becomes_small() {
        let place = Rect::new(0.0, 0.0, 300.0, 200.0);
        let label = || Text::new([10.0, 10.0], 12.0, "η");
        let (_dir, chart) = written("a", |drawing| drawing.text(label()));
        let chart = chart.unwrap();
        assert!(chart.chart && chart.source.starts_with("data:image/svg+xml;charset=utf-8,%3Csvg "));
        assert!(!chart.source.contains(['"', '<', '\n', '#']) && chart.source.contains("η"));
        assert_eq!([chart.width, chart.height], [301, 200]);
        let (_dir, mixed) = written("b", |drawing| {
            drawing.text(label());
            drawing.image(place, noise());
        });
        let mixed = mixed.unwrap();
        assert!(mixed.chart && mixed.source.contains("image/jpeg") && !mixed.source.contains("image/png"));
        let (dir, picture) = written("c", |drawing| drawing.image(place, noise()));
        let picture = picture.unwrap();
        assert!(!picture.chart && picture.source.starts_with("data:image/jpeg;base64,"));
        for name in ["c.png", "c.svg"] {
            std::fs::write(dir.path().join(name), vec![200; LARGEST_PNG + 1]).unwrap();
            assert!(matches!(EmbeddedImage::read(dir.path(), "c"), Err(Error::Input { .. })), "{name}");
        }
    }

    #[test]
    fn damaged_images_of_a_drawing_name_the_file() {
        let (dir, _) = written("a", |_| ());
        let svg = dir.path().join("a.svg");
        for damage in ["\"/><text/></svg>", "!!\"/><text/></svg>", "<text/>"] {
            std::fs::write(&svg, format!("<svg width=\"1\" height=\"1\"><image {PNG}{damage}")).unwrap();
            let error = EmbeddedImage::read(dir.path(), "a").err().unwrap().to_string();
            assert!(error.contains("a.svg"), "{error}");
        }
    }
}
