//! 8-bit images: their PNG files, which figures embed, and images of at most 256 colours, whose PNG files are a third as large: for
//! figures that a repository keeps.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, Rgb, RgbImage};
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

/// An 8-bit RGB image (sRGB, row 0 at the top). Copies share its pixels, and its PNG file, which takes most of the time of
/// writing a figure.
#[derive(Debug, Clone)]
pub struct Rgb8 {
    own: Arc<(RgbImage, OnceLock<Vec<u8>>)>,
    /// Pure white is where nothing is: paper shows through, of whatever colour.
    is_on_paper: bool,
}

/// Pure white.
const PAPER: [u8; 3] = [255; 3];

impl Rgb8 {
    /// Wraps `data`.
    ///
    /// # Panics
    /// When `data` is shorter than `3 * width * height`: a bug of the caller, never of an input file.
    pub fn new(width: usize, height: usize, data: Vec<u8>) -> Self {
        RgbImage::from_raw(width as u32, height as u32, data).expect("three bytes a pixel").into()
    }

    pub fn from_fn(width: usize, height: usize, f: impl Fn(usize, usize) -> [u8; 3]) -> Self {
        RgbImage::from_fn(width as u32, height as u32, |x, y| Rgb(f(x as usize, y as usize))).into()
    }

    /// The image whose pure white is left out: paper shows through, of whatever colour.
    pub fn on_paper(self) -> Self {
        let (pixels, _) = Arc::unwrap_or_clone(self.own);
        Self { is_on_paper: true, ..pixels.into() }
    }

    pub fn is_on_paper(&self) -> bool {
        self.is_on_paper
    }

    /// Whether paper shows through in place of this colour.
    pub fn is_clear(&self, colour: [u8; 3]) -> bool {
        self.is_on_paper && colour == PAPER
    }

    pub fn width(&self) -> usize {
        self.pixels().width() as usize
    }

    pub fn height(&self) -> usize {
        self.pixels().height() as usize
    }

    pub fn pixels(&self) -> &RgbImage {
        &self.own.0
    }

    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        self.pixels().get_pixel(x as u32, y as u32).0
    }

    /// The image as a PNG file, encoded at the first call.
    pub fn png(&self) -> &[u8] {
        self.own.1.get_or_init(|| {
            // The best compression takes three times as long as the default one and saves less than 1 %.
            let is_large = self.width() * self.height() > LARGE;
            let file = self.encoded(if is_large { CompressionType::Fast } else { CompressionType::Default });
            let clear: Vec<u8> = PAPER.iter().flat_map(|level| [0, *level]).collect();
            if self.is_on_paper { with_chunk(&file, *b"tRNS", &clear) } else { file }
        })
    }

    /// The PNG file of a chart, whose flat areas a search for repetitions shortens.
    pub fn chart_png(&self) -> Vec<u8> {
        self.encoded(CompressionType::Default)
    }

    fn encoded(&self, effort: CompressionType) -> Vec<u8> {
        let (mut bytes, pixels) = (Vec::new(), self.pixels());
        PngEncoder::new_with_quality(&mut bytes, effort, FilterType::Adaptive)
            .write_image(pixels, pixels.width(), pixels.height(), ExtendedColorType::Rgb8)
            .expect("a sound image, written to memory");
        bytes
    }
}

impl From<RgbImage> for Rgb8 {
    fn from(pixels: RgbImage) -> Self {
        Self { own: Arc::new((pixels, OnceLock::new())), is_on_paper: false }
    }
}

impl PartialEq for Rgb8 {
    fn eq(&self, other: &Self) -> bool {
        self.pixels() == other.pixels()
    }
}

/// Length of a PNG file's signature and of its header, before which no other chunk stands.
pub const PNG_HEADER: usize = 8 + 25;

/// A PNG file with one more chunk after its header.
pub fn with_chunk(png: &[u8], name: [u8; 4], data: &[u8]) -> Vec<u8> {
    let chunk = [&name, data].concat();
    let mut crc = flate2::Crc::new();
    crc.update(&chunk);
    let (header, rest) = png.split_at(PNG_HEADER);
    [header, &(data.len() as u32).to_be_bytes(), &chunk, &crc.sum().to_be_bytes(), rest].concat()
}

/// Pixels above which an image is compressed fast: in a tenth of the time, to a little more bytes.
const LARGE: usize = 1 << 20;

/// Most colours of a PNG file with a palette.
const MOST: usize = 256;

/// A set of colours, each with its number of pixels.
struct Group {
    colours: Vec<([u8; 3], u32)>,
    mean: [f64; 3],
    /// Sum of the squared distances from the mean along each axis.
    spread: [f64; 3],
}

impl Group {
    fn new(colours: Vec<([u8; 3], u32)>) -> Self {
        let (mut count, mut sum, mut squares) = (0.0, [0.0; 3], [0.0; 3]);
        for (colour, n) in &colours {
            // By less than their number: a colour bar has few pixels of each of its colours
            let n = f64::from(*n).sqrt();
            count += n;
            for c in 0..3 {
                let value = f64::from(colour[c]);
                sum[c] += n * value;
                squares[c] += n * value * value;
            }
        }
        let mean = sum.map(|sum| sum / count);
        let spread = std::array::from_fn(|c| squares[c] - sum[c] * mean[c]);
        Self { colours, mean, spread }
    }

    /// The axis of the largest spread, and that.
    fn widest(&self) -> (usize, f64) {
        (0..3).map(|c| (c, self.spread[c])).max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
    }

    /// Both sides of the mean along the axis of the largest spread.
    fn halves(self) -> [Self; 2] {
        let (axis, _) = self.widest();
        let mean = self.mean[axis];
        let (low, high) = self.colours.into_iter().partition(|(colour, _)| f64::from(colour[axis]) <= mean);
        [Self::new(low), Self::new(high)]
    }

    /// The colour of most of its pixels if there is one, as the background or a line has, else the mean.
    fn colour(&self) -> [u8; 3] {
        let count: u32 = self.colours.iter().map(|(_, n)| n).sum();
        let most = self.colours.iter().find(|(_, n)| 2 * n > count);
        most.map_or(self.mean.map(|mean| mean.round() as u8), |(colour, _)| *colour)
    }
}

/// At most 256 colours for an image, and the number of the colour of each pixel. An image of that few colours keeps them.
///
/// A group of colours is cut at its mean along the axis of the largest variance, the group with the largest first (Wan, Wong and
/// Prusinkiewicz 1988), each colour with the square root of its number of pixels. If asked for, the error of a pixel goes to its neighbours
/// (Floyd and Steinberg 1976), without which smooth shades turn into rings; colours of the palette itself stay as they are.
pub fn palette(image: &Rgb8, is_dithered: bool) -> (Vec<[u8; 3]>, Vec<u8>) {
    let mut counts: HashMap<[u8; 3], u32> = HashMap::new();
    image.pixels().pixels().for_each(|pixel| *counts.entry(pixel.0).or_default() += 1);
    let mut colours: Vec<([u8; 3], u32)> = counts.into_iter().collect();
    // In one order, so that a picture always has the same file
    colours.sort_unstable();
    let mut groups = vec![Group::new(colours)];
    while groups.len() < MOST {
        let spreads = groups.iter().enumerate().filter(|(_, group)| group.colours.len() > 1);
        let Some((widest, _)) = spreads.max_by(|a, b| a.1.widest().1.total_cmp(&b.1.widest().1)) else { break };
        let halves = groups.swap_remove(widest).halves();
        groups.extend(halves);
    }
    let palette: Vec<[u8; 3]> = groups.iter().map(Group::colour).collect();
    if is_dithered {
        let places = dithered(image, &palette);
        return (palette, places);
    }
    let of_group =
        |(i, group): (usize, &Group)| group.colours.iter().map(|(colour, _)| (*colour, i as u8)).collect::<Vec<_>>();
    let place: HashMap<[u8; 3], u8> = groups.iter().enumerate().flat_map(of_group).collect();
    (palette, image.pixels().pixels().map(|pixel| place[&pixel.0]).collect())
}

/// The largest error of a channel that is passed on, so that errors do not add up where the palette has no colour near.
const FURTHEST: f32 = 12.0;
/// Bits of a channel that choose the nearest colour of a palette.
const BITS: usize = 6;

/// The number of the colour of each pixel, row by row from left to right, of errors that are passed on.
fn dithered(image: &Rgb8, palette: &[[u8; 3]]) -> Vec<u8> {
    let width = image.width();
    let own: HashMap<[u8; 3], u8> = palette.iter().enumerate().map(|(i, colour)| (*colour, i as u8)).collect();
    let mut known: Vec<Option<u8>> = vec![None; 1 << (3 * BITS)];
    let mut nearest = |wanted: [u8; 3]| {
        let key = wanted.iter().fold(0, |key, v| key << BITS | usize::from(*v) >> (8 - BITS));
        *known[key].get_or_insert_with(|| {
            let distance =
                |colour: &[u8; 3]| (0..3).map(|c| u32::from(colour[c].abs_diff(wanted[c])).pow(2)).sum::<u32>();
            (0..palette.len()).min_by_key(|&i| distance(&palette[i])).unwrap_or(0) as u8
        })
    };
    // Errors of this row and of the next one, with room at both ends
    let mut errors = [vec![[0.0f32; 3]; width + 2], vec![[0.0f32; 3]; width + 2]];
    let mut places = Vec::with_capacity(width * image.height());
    for y in 0..image.height() {
        for x in 0..width {
            let pixel = image.pixel(x, y);
            if let Some(own) = own.get(&pixel) {
                places.push(*own);
                continue;
            }
            let wanted: [f32; 3] = std::array::from_fn(|c| f32::from(pixel[c]) + errors[0][x + 1][c]);
            let found = nearest(wanted.map(|v| v.round().clamp(0.0, 255.0) as u8));
            for c in 0..3 {
                let error = (wanted[c] - f32::from(palette[usize::from(found)][c])).clamp(-FURTHEST, FURTHEST);
                errors[0][x + 2][c] += error * 7.0 / 16.0;
                errors[1][x][c] += error * 3.0 / 16.0;
                errors[1][x + 1][c] += error * 5.0 / 16.0;
                errors[1][x + 2][c] += error / 16.0;
            }
            places.push(found);
        }
        errors.swap(0, 1);
        errors[1].fill([0.0; 3]);
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_share_one_file_that_equality_does_not_see() {
        let image = || Rgb8::from_fn(31, 17, |x, y| [x as u8, y as u8, (x * y) as u8]);
        let (first, other) = (image(), image());
        let copy = first.clone();
        assert_eq!(&image::load_from_memory(first.png()).unwrap().into_rgb8(), first.pixels());
        assert!(std::ptr::eq(first.png(), copy.png()) && !std::ptr::eq(first.png(), other.png()));
        assert!(first.png() == other.png() && copy == image());
        assert_ne!(first, Rgb8::from_fn(31, 17, |_, _| [0; 3]));
        assert_ne!(Rgb8::new(2, 1, vec![7; 6]), Rgb8::new(1, 2, vec![7; 6]));
    }

    #[test]
    fn few_colours_are_kept_and_many_are_near() {
        let few = Rgb8::from_fn(40, 20, |x, y| [(x % 16) as u8, (y % 16) as u8, 7]);
        let (colours, places) = palette(&few, true);
        assert_eq!(colours.len(), 256);
        assert!(places.iter().zip(few.pixels().pixels()).all(|(place, pixel)| colours[usize::from(*place)] == pixel.0));
        // A ramp of 65536 colours beside a white half: the white stays white
        let many = Rgb8::from_fn(512, 256, |x, y| if x < 256 { [x as u8, y as u8, 100] } else { [255; 3] });
        let (colours, places) = palette(&many, false);
        assert_eq!(colours.len(), 256);
        for (place, pixel) in places.iter().zip(many.pixels().pixels()) {
            let near = colours[usize::from(*place)].iter().zip(pixel.0).all(|(a, b)| a.abs_diff(b) <= 16);
            assert!(near && (pixel.0 != [255; 3] || colours[usize::from(*place)] == [255; 3]), "{pixel:?}");
        }
        assert_eq!(palette(&Rgb8::new(1, 1, vec![1, 2, 3]), true), (vec![[1, 2, 3]], vec![0]));
    }

    #[test]
    fn a_dithered_shade_has_no_rings() {
        // A ramp of 65536 colours: squares of 16 pixels a side have the mean of their own
        let many = Rgb8::from_fn(512, 256, |x, y| if x < 256 { [x as u8, y as u8, 100] } else { [255; 3] });
        let mean_error = |is_dithered: bool| {
            let (colours, places) = palette(&many, is_dithered);
            let square = |i: usize| {
                let (left, top) = (16 * (i % 16), 16 * (i / 16));
                let of = |x: usize, y: usize| f64::from(colours[usize::from(places[512 * y + x])][0]) - x as f64;
                (0..256).map(|j| of(left + j % 16, top + j / 16)).sum::<f64>() / 256.0
            };
            (0..256).map(|i| square(i).abs()).sum::<f64>() / 256.0
        };
        assert!(mean_error(true) < 0.6 * mean_error(false), "{} {}", mean_error(true), mean_error(false));
        let (colours, places) = palette(&many, true);
        let is_white = |x: usize, y: usize| colours[usize::from(places[512 * y + x])] == [255; 3];
        assert!((0..256).all(|y| (256..512).all(|x| is_white(x, y))), "flat areas stay flat");
    }
}
