//! Radiance HDR images: three 8-bit mantissas that share an exponent, run-length encoded. Reading takes the text header, then scan
//! lines in one of three packings; writing packs in the newer run lengths.

use super::decoded::{self, Decoded, blank, check_size, cut_off};
use super::image::SOFTWARE;
use super::{Image, Metadata};
use crate::error::{Error, Place, Result};
use crate::interrupt;
use crate::math::Rgb;
use std::io::{self, Write};
use std::path::Path;

/// Reads a Radiance image. Channel value = mantissa/256 · 2^(exponent-128), exponent 0 meaning black, divided by the
/// product of all `EXPOSURE` lines and, channel by channel, of all `COLORCORR` lines: the radiance of the scene
/// before adjustments. `PRIMARIES` other than those of Rec. 709 are noted; `GAMMA`, `PIXASPECT` and other lines have no
/// effect.
pub fn decode(path: &Path, bytes: &[u8]) -> Result<Decoded> {
    let header = Header::parse(path, bytes)?;
    let (outer, inner) = (header.outer.length, header.inner.length);
    let (width, height) = if header.outer.vertical { (inner, outer) } else { (outer, inner) };
    // The old run lengths are the densest: 16384 pixels that are all alike take 12 bytes.
    check_size(path, width as u64, height as u64, bytes.len() - header.end, 1 << 11)?;

    let mut image = blank(path, width, height)?;
    let mut input = Input { path, bytes, at: header.end };
    let mut line = vec![[0; 4]; inner];
    for i in 0..outer {
        interrupt::check()?;
        input.scan_line(&mut line)?;
        let slow = if header.outer.reversed { outer - 1 - i } else { i };
        for (j, &pixel) in line.iter().enumerate() {
            let fast = if header.inner.reversed { inner - 1 - j } else { j };
            let (x, y) = if header.outer.vertical { (fast, slow) } else { (slow, fast) };
            image.set(x, y, linear(pixel) * header.factor);
        }
    }
    Ok(Decoded { notes: header.note.into_iter().collect(), ..Decoded::from(image) })
}

/// One axis of the image, in file order.
struct Axis {
    vertical: bool,
    /// Whether the file goes against increasing column or (top-down) row numbers.
    reversed: bool,
    length: usize,
}

struct Header {
    /// What every pixel is multiplied by.
    factor: Rgb,
    outer: Axis,
    inner: Axis,
    /// A note on its primaries.
    note: Option<String>,
    /// Where the scan lines begin.
    end: usize,
}

impl Header {
    fn parse(path: &Path, bytes: &[u8]) -> Result<Self> {
        let mut factor = glam::DVec3::ONE;
        let (mut at, mut in_size_line, mut note) = (0, false, None);
        loop {
            let error = |message: String| Error::input(path, message).at(Place::Byte(at as u64));
            let Some(length) = bytes[at..].iter().position(|&b| b == b'\n') else {
                return Err(error("the header has no end".into()).with_hint("the file is cut off; fetch it again"));
            };
            let line = String::from_utf8_lossy(&bytes[at..at + length]);
            let line = line.trim();
            let end = at + length + 1;
            if in_size_line {
                let words: Vec<&str> = line.split_whitespace().collect();
                let axes = match words[..] {
                    [a, m, b, n] => axis(a, m).zip(axis(b, n)).filter(|(a, b)| a.vertical != b.vertical),
                    _ => None,
                };
                let (outer, inner) = axes.ok_or_else(|| error(format!("no proper size line: {line:?}")))?;
                return Ok(Self { factor: (1.0 / factor).as_vec3(), outer, inner, note, end });
            }
            let numbers = |text: &str| {
                let read: std::result::Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
                read.ok().filter(|v| v.iter().all(|v| v.is_finite()))
            };
            let factors = |text: &str| numbers(text).filter(|v| v.iter().all(|v| *v > 0.0));
            match line.split_once('=').map(|(name, value)| (name.trim(), value.trim())) {
                None => in_size_line = line.is_empty(),
                Some(("FORMAT", "32-bit_rle_rgbe")) => {}
                Some(("FORMAT", other)) => {
                    return Err(Error::unsupported(path, format!("the pixels are {other}"))
                        .with_hint("convert the file to 32-bit_rle_rgbe (Radiance: ra_xyze -r)"));
                }
                Some((name @ ("EXPOSURE" | "COLORCORR"), value)) => match factors(value).as_deref() {
                    Some(&[e]) if name == "EXPOSURE" => factor *= e,
                    Some(&[r, g, b]) if name == "COLORCORR" => factor *= glam::DVec3::new(r, g, b),
                    _ => return Err(error(format!("no proper {name}: {value:?}"))),
                },
                Some((name @ "PRIMARIES", value)) => {
                    let found = numbers(value).and_then(|v| <[f64; 8]>::try_from(v).ok());
                    let found = found.ok_or_else(|| error(format!("no proper {name}: {value:?}")))?;
                    note = decoded::primaries_note(name, found.map(|v| v as f32));
                }
                Some(_) => {}
            }
            at = end;
        }
    }
}

/// Reads, for example, `-Y 512`.
fn axis(name: &str, length: &str) -> Option<Axis> {
    let (vertical, reversed) = match name {
        "-Y" => (true, false),
        "+Y" => (true, true),
        "+X" => (false, false),
        "-X" => (false, true),
        _ => return None,
    };
    Some(Axis { vertical, reversed, length: length.parse::<u32>().ok()? as usize })
}

struct Input<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Input<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let end = self.at + count;
        let taken = self.bytes.get(self.at..end);
        let taken = taken.ok_or_else(|| cut_off(self.path, end as u64, self.bytes.len()))?;
        self.at = end;
        Ok(taken)
    }

    fn scan_line(&mut self, line: &mut [[u8; 4]]) -> Result<()> {
        match self.bytes[self.at..] {
            [2, 2, high, low, ..] if high < 128 && RUN_WIDTHS.contains(&line.len()) => {
                let length = usize::from(high) << 8 | usize::from(low);
                if length != line.len() {
                    return Err(self.error(format!("a scan line of {length} pixels instead of {}", line.len())));
                }
                self.at += 4;
                (0..4).try_for_each(|channel| self.channel_runs(line, channel))
            }
            _ => self.pixel_runs(line),
        }
    }

    /// The newer run lengths: one channel of the whole line after the other.
    fn channel_runs(&mut self, line: &mut [[u8; 4]], channel: usize) -> Result<()> {
        let mut x = 0;
        while x < line.len() {
            let code = usize::from(self.take(1)?[0]);
            let (count, is_run) = if code > 128 { (code - 128, true) } else { (code, false) };
            let Some(target) = line.get_mut(x..x + count).filter(|t| !t.is_empty()) else {
                return Err(self.error(format!("a run of {count} at column {x} of {}", line.len())));
            };
            let values = self.take(if is_run { 1 } else { count })?;
            for (i, pixel) in target.iter_mut().enumerate() {
                pixel[channel] = values[if is_run { 0 } else { i }];
            }
            x += count;
        }
        Ok(())
    }

    /// Flat pixels, and the older run lengths in them: 1, 1, 1, n repeats the last pixel n times; a second such mark in
    /// a row counts 256 n times, and so on.
    fn pixel_runs(&mut self, line: &mut [[u8; 4]]) -> Result<()> {
        let (mut x, mut shift) = (0, 0);
        while x < line.len() {
            let pixel = self.take(4)?;
            if let [1, 1, 1, n] = *pixel {
                let count = usize::from(n) << shift;
                if x == 0 || count > line.len() - x || shift > 16 {
                    return Err(self.error(format!("a repeat of {count} at column {x} of {}", line.len())));
                }
                let last = line[x - 1];
                line[x..x + count].fill(last);
                x += count;
                shift += 8;
            } else {
                line[x] = [pixel[0], pixel[1], pixel[2], pixel[3]];
                x += 1;
                shift = 0;
            }
        }
        Ok(())
    }

    fn error(&self, message: String) -> Error {
        Error::input(self.path, message).at(Place::Byte(self.at as u64)).with_hint("the file is damaged")
    }
}

/// Widths that the newer run lengths can have; others are stored flat.
pub const RUN_WIDTHS: std::ops::RangeInclusive<usize> = 8..=0x7fff;

/// The linear value of a stored pixel.
pub fn linear([r, g, b, e]: [u8; 4]) -> Rgb {
    if e == 0 {
        return Rgb::ZERO;
    }
    // In f64, since the smallest values are subnormal in f32 and the factor alone would vanish.
    let unit = f64::from(i32::from(e) - 136).exp2();
    Rgb::from_array([r, g, b].map(|m| (f64::from(m) * unit) as f32))
}

/// The stored pixel nearest to `p`.
pub fn shared_exponent(p: Rgb) -> [u8; 4] {
    let [r, g, b] = p.to_array().map(|v| if v > 0.0 { f64::from(v) } else { 0.0 });
    let largest = r.max(g).max(b);
    if largest < 2.0_f64.powi(-128) {
        return [0; 4];
    }
    // The exponent that brings the largest channel to [128, 256); one more if it then rounds to 256. In f64 log2 is
    // exact enough that only powers of two matter, and those it gives exactly.
    let mut exponent = (largest.log2().floor() as i32).min(126) + 1;
    if (largest * f64::from(8 - exponent).exp2()).round() > 255.0 && exponent < 127 {
        exponent += 1;
    }
    let unit = f64::from(8 - exponent).exp2();
    // The cast saturates: beyond the range of the format the value becomes its largest.
    let [r, g, b] = [r, g, b].map(|v| (v * unit).round() as u8);
    [r, g, b, (exponent + 128) as u8]
}

/// Writes a Radiance image, rounding each mantissa to nearest: the error of a channel is at most 1/256 of the
/// largest channel of its pixel (and mostly half of that). Negative values and NaN become 0; values above the format's
/// range, 255/256 · 2^127, and +∞ become the largest that it has; all three below 2^-128 become 0. The metadata become
/// comment lines.
pub fn encode(image: &Image, metadata: &Metadata, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "#?RADIANCE\n# {}", SOFTWARE)?;
    for (name, value) in metadata.entries() {
        writeln!(out, "# {}", format!("{name}: {value}").replace(['\n', '\r'], " "))?;
    }
    write!(out, "FORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", image.height(), image.width())?;
    let mut bytes = Vec::new();
    for y in 0..image.height() {
        bytes.clear();
        let line: Vec<[u8; 4]> = image.row(y).iter().map(|&p| shared_exponent(p)).collect();
        if RUN_WIDTHS.contains(&line.len()) {
            bytes.extend([2, 2, (line.len() >> 8) as u8, line.len() as u8]);
            for channel in 0..4 {
                run_lengths(&line.iter().map(|p| p[channel]).collect::<Vec<_>>(), &mut bytes);
            }
        } else {
            bytes.extend(line.as_flattened());
        }
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// Appends `bytes` as runs (128 + length, value) of at least 4 and literals (length, values) of at most 128.
fn run_lengths(bytes: &[u8], out: &mut Vec<u8>) {
    let mut rest = bytes;
    let mut literal = 0;
    let run_at = |at: usize, rest: &[u8]| rest[at..].iter().take(127).take_while(|&&b| b == rest[at]).count();
    while literal < rest.len() {
        let run = run_at(literal, rest);
        if run < 4 && literal + run <= 128 {
            literal += run;
            continue;
        }
        if literal > 0 {
            out.push(literal as u8);
            out.extend(&rest[..literal]);
        }
        rest = &rest[literal..];
        literal = 0;
        if run >= 4 {
            out.extend([128 + run as u8, rest[0]]);
            rest = &rest[run..];
        }
    }
    if literal > 0 {
        out.push(literal as u8);
        out.extend(rest);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Image, Metadata};
    use super::*;
    use crate::math::Rgb;
    use std::path::Path;

    fn round_trip(image: &Image) -> Image {
        let mut bytes = Vec::new();
        encode(image, &Metadata::default().with("note", "two\nlines"), &mut bytes).unwrap();
        decode(Path::new("a.hdr"), &bytes).unwrap().image
    }

    #[test]
    fn mantissas_are_rounded() {
        // Widths on both sides of the run length limits, with runs, literals and values of every size.
        for width in [1, 7, 8, 200, 40_000] {
            let image = Image::from_fn(width, 2, |x, y| {
                let v = (1.0 + (x * x % 997) as f32 / 100.0) * ((x / 50 % 60) as f32 - 30.0).exp2();
                Rgb::new(v, v * 0.37, if y == 0 { 0.0 } else { 0.011 * v })
            });
            for (a, b) in image.pixels().iter().zip(round_trip(&image).pixels()) {
                let bound = a.max_element() / 256.0;
                assert!((*a - *b).abs().max_element() <= bound * 1.000_001, "{a} {b}");
            }
        }
    }

    #[test]
    fn rounding_is_unbiased() {
        let image = Image::from_fn(1000, 10, |x, y| {
            let i = (1000 * y + x) as f32;
            Rgb::new(1.0 + i / 10_000.0, 0.2 + i / 70_000.0, 0.1)
        });
        let c = crate::raster::compare(&round_trip(&image), &image).unwrap();
        assert!((c.mean_a / c.mean_b - 1.0).abs() < 1e-3, "{} {}", c.mean_a, c.mean_b);
    }

    #[test]
    fn the_ends_of_the_range() {
        let largest = (255.0 / 256.0 * 127.0_f64.exp2()) as f32;
        for (value, expected) in [
            (1.0, 1.0),
            (255.6, 256.0),
            (-1.0, 0.0),
            (f32::NAN, 0.0),
            (f32::INFINITY, largest),
            (f32::MAX, largest),
            (1e-45, 0.0),
            (2.0_f32.powi(-128), 2.0_f32.powi(-128)),
        ] {
            let image = Image::new(1, 1).map(|_| Rgb::splat(value));
            assert_eq!(round_trip(&image).get(0, 0), Rgb::splat(expected), "{value}");
        }
    }

    fn parse(bytes: &[u8]) -> Result<Image> {
        decode(Path::new("a.hdr"), bytes).map(|decoded| decoded.image)
    }

    fn file(header: &str, data: &[u8]) -> Vec<u8> {
        [b"#?RADIANCE\n", header.as_bytes(), data].concat()
    }

    #[test]
    fn flat_pixels_and_header_lines() {
        let data = [128, 64, 0, 129, 255, 1, 0, 136];
        let image = parse(&file("# a comment\nGAMMA=1\n\n-Y 1 +X 2\n", &data)).unwrap();
        assert_eq!(image.pixels(), [Rgb::new(1.0, 0.5, 0.0), Rgb::new(255.0, 1.0, 0.0)]);
        let halved = parse(&file("EXPOSURE=4\nEXPOSURE= 0.5\nCOLORCORR=1 2 4\n\n-Y 1 +X 2\n", &data)).unwrap();
        assert_eq!(halved.get(0, 0), Rgb::new(0.5, 0.125, 0.0));
        let other_magic = [b"#?RGBE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 1 +X 2\n".as_slice(), &data].concat();
        assert_eq!(parse(&other_magic).unwrap(), image);
    }

    #[test]
    fn other_primaries_are_noted() {
        let notes =
            |line: &str| decode(Path::new("a.hdr"), &file(&format!("{line}\n\n-Y 1 +X 1\n"), &[0; 4])).map(|d| d.notes);
        assert!(notes("PRIMARIES= .64 .33 .3 .6 .15 .06 .3127 .329").unwrap().is_empty());
        assert!(notes("PRIMARIES=.708 .292 .17 .797 .131 .046 .3127 .329").unwrap()[0].contains("Rec. 709"));
        assert!(notes("PRIMARIES=.708 .292").is_err() && notes("PRIMARIES=XYZ").is_err());
    }

    #[test]
    fn old_run_lengths() {
        let pixel = |m: u8| [m, m, m, 136];
        let data = [pixel(7), [1, 1, 1, 3], [1, 1, 1, 1], pixel(9), [1, 1, 1, 2]].concat();
        let image = parse(&file("\n-Y 1 +X 263\n", &data)).unwrap();
        assert!(image.pixels()[..260].iter().all(|p| p.x == 7.0));
        assert!(image.pixels()[260..].iter().all(|p| p.x == 9.0));
        assert!(parse(&file("\n-Y 1 +X 3\n", &[[1, 1, 1, 3], pixel(7)].concat())).is_err(), "nothing to repeat");
        assert!(parse(&file("\n-Y 1 +X 3\n", &[pixel(7), [1, 1, 1, 3]].concat())).is_err(), "beyond the line");
    }

    #[test]
    fn every_orientation_is_read_upright() {
        // The image, top-down, is 0 1 2 / 3 4 5.
        for (size, order) in [
            ("-Y 2 +X 3", [0, 1, 2, 3, 4, 5]),
            ("-Y 2 -X 3", [2, 1, 0, 5, 4, 3]),
            ("+Y 2 +X 3", [3, 4, 5, 0, 1, 2]),
            ("+Y 2 -X 3", [5, 4, 3, 2, 1, 0]),
            ("+X 3 -Y 2", [0, 3, 1, 4, 2, 5]),
            ("+X 3 +Y 2", [3, 0, 4, 1, 5, 2]),
            ("-X 3 -Y 2", [2, 5, 1, 4, 0, 3]),
            ("-X 3 +Y 2", [5, 2, 4, 1, 3, 0]),
        ] {
            let data: Vec<u8> = order.iter().flat_map(|&m| [m, 0, 0, 136]).collect();
            let image = parse(&file(&format!("\n{size}\n"), &data)).unwrap();
            assert_eq!((image.width(), image.height()), (3, 2));
            let found: Vec<f32> = image.pixels().iter().map(|p| p.x).collect();
            assert_eq!(found, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], "{size}");
        }
    }

    #[test]
    fn unreadable_files_are_errors_with_a_reason() {
        for (header, data, expected) in [
            ("FORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", &[0; 4][..], "32-bit_rle_xyze"),
            ("EXPOSURE=0\n\n-Y 1 +X 1\n", &[0; 4], "EXPOSURE"),
            ("\n-Y 1 -Y 1\n", &[0; 4], "size line"),
            ("\n-Y 1 +X\n", &[0; 4], "size line"),
            ("\n-Y 1 +X 1", &[], "no end"),
            ("\n-Y 1 +X 1\n", &[0; 3], "ends early"),
            ("\n-Y 0 +X 1\n", &[0; 4], "0"),
            ("\n-Y 60000 +X 4000\n", &[0; 4], "cannot hold"),
            ("\n-Y 1 +X 8\n", &[2, 2, 0, 9, 0, 0], "9 pixels instead of 8"),
            ("\n-Y 1 +X 8\n", &[2, 2, 0, 8, 128 + 9, 1], "run of 9"),
            ("\n-Y 1 +X 8\n", &[2, 2, 0, 8, 0, 0], "run of 0"),
        ] {
            let error = parse(&file(header, data)).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }

    #[test]
    fn runs_of_four_and_more_are_packed() {
        let packed = |bytes: &[u8]| {
            let mut out = Vec::new();
            run_lengths(bytes, &mut out);
            out
        };
        assert_eq!(packed(&[5; 4]), [132, 5]);
        assert_eq!(packed(&[5, 5, 5, 6]), [4, 5, 5, 5, 6]);
        assert_eq!(packed(&[1, 2, 7, 7, 7, 7, 7, 3]), [2, 1, 2, 133, 7, 1, 3]);
        assert_eq!(packed(&[9; 130]), [255, 9, 3, 9, 9, 9], "a run holds 127 at most");
        let ramp: Vec<u8> = (0..200).collect();
        assert_eq!(packed(&ramp), [&[128], &ramp[..128], &[72], &ramp[128..]].concat(), "a literal holds 128 at most");
    }
}
