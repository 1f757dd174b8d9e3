//! Portable float maps: `PF` (RGB) and `Pf` (grey), 32-bit floats, rows stored from the bottom up.

use super::Image;
use super::decoded::{check_size, cut_off, reserve_pixels};
use crate::error::{Error, Place, Result};
use crate::math::Rgb;
use std::io::{self, Write};
use std::path::Path;

/// Whether these bytes begin as a PFM file does: a magic, then white space.
pub(super) fn recognise(bytes: &[u8]) -> bool {
    matches!(bytes, [b'P', b'F' | b'f', space, ..] if space.is_ascii_whitespace())
}

/// Reads a file that [`recognise`] has accepted.
///
/// The header is three tokens after the magic: width, height, scale. A negative scale means little-endian data, a
/// positive one big-endian; its absolute value multiplies the samples (it is 1 in nearly all files). One byte of white
/// space ends the header, or several that end with a line feed; the length of the file tells which, since a sample may
/// look like white space.
pub(super) fn decode(path: &Path, mut bytes: Vec<u8>) -> Result<Image> {
    let channels = if bytes[1] == b'F' { 3 } else { 1 };
    let mut header = Header { path, bytes: &bytes, at: 2 };
    let width: u64 = header.number("width")?;
    let height: u64 = header.number("height")?;
    let scale: f32 = header.number("scale")?;
    if !scale.is_finite() || scale == 0.0 {
        return Err(header.error(format!("the scale is {scale}")));
    }
    let (end, needed) = (header.at, width.saturating_mul(height).saturating_mul(4 * channels as u64));
    let present = bytes.len().saturating_sub(end + 1) as u64;
    if width > 0 && height > 0 && present < needed {
        return Err(cut_off(path, needed.saturating_add(end as u64 + 1), bytes.len()));
    }
    check_size(path, width, height, bytes.len(), 1)?;
    let space = &bytes[end..bytes.len() - needed as usize];
    if space.iter().any(|b| !b.is_ascii_whitespace()) || (space.len() > 1 && !space.ends_with(b"\n")) {
        let surplus = present - needed;
        return Err(header
            .error(format!("the file is {surplus} bytes longer than its header, which ends here, and its pixels")));
    }

    // The last line of the file is the top row. The memory of lines that are done is given back, so that a large file and
    // its image are not held at once.
    const GIVEN_BACK: usize = 1 << 26;
    let (width, height, length) = (width as usize, height as usize, 4 * channels * width as usize);
    let sample = |b: &[u8]| {
        let b = [b[0], b[1], b[2], b[3]];
        scale.abs() * if scale < 0.0 { f32::from_le_bytes(b) } else { f32::from_be_bytes(b) }
    };
    let mut pixels = reserve_pixels(path, width, height)?;
    for _ in 0..height {
        let line = bytes.len() - length;
        pixels.extend(bytes[line..].chunks_exact(4 * channels).map(|s| match channels {
            3 => Rgb::new(sample(s), sample(&s[4..]), sample(&s[8..])),
            _ => Rgb::splat(sample(s)),
        }));
        bytes.truncate(line);
        if bytes.capacity() - line > GIVEN_BACK {
            bytes.shrink_to_fit();
        }
    }
    Ok(Image::from_pixels(width, height, pixels))
}

/// Writes a little-endian `PF` file; exact for every value.
pub(super) fn encode(image: &Image, out: &mut dyn Write) -> io::Result<()> {
    write!(out, "PF\n{} {}\n-1.0\n", image.width(), image.height())?;
    for y in (0..image.height()).rev() {
        let line: Vec<u8> = image.row(y).iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
        out.write_all(&line)?;
    }
    Ok(())
}

/// The text header while it is being read.
struct Header<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    at: usize,
}

impl Header<'_> {
    /// The next number, after any white space.
    fn number<T: std::str::FromStr>(&mut self, what: &str) -> Result<T> {
        let rest = &self.bytes[self.at..];
        let begin = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        let length = rest[begin..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - begin);
        self.at += begin;
        let token = std::str::from_utf8(&rest[begin..begin + length]).ok().and_then(|t| t.parse().ok());
        let number = token.ok_or_else(|| self.error(format!("the header has no proper {what}")))?;
        self.at += length;
        Ok(number)
    }

    fn error(&self, message: String) -> Error {
        Error::input(self.path, message)
            .at(Place::Byte(self.at as u64))
            .with_hint("a PFM file begins with PF or Pf, width, height and scale")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(bytes: &[u8]) -> Result<Image> {
        decode(Path::new("a.pfm"), bytes.to_vec())
    }

    fn file(header: &str, values: &[f32], bytes: fn(f32) -> [u8; 4]) -> Vec<u8> {
        header.bytes().chain(values.iter().flat_map(|&v| bytes(v))).collect()
    }

    #[test]
    fn rows_are_bottom_up_and_both_byte_orders_read_the_same() {
        let little = parse(&file("Pf\n2 2\n-1.0\n", &[1.0, 2.0, 3.0, 4.0], f32::to_le_bytes)).unwrap();
        let big = parse(&file("Pf 2 2 1 ", &[1.0, 2.0, 3.0, 4.0], f32::to_be_bytes)).unwrap();
        assert_eq!(little.row(0), [Rgb::splat(3.0), Rgb::splat(4.0)]);
        assert_eq!(little, big);
    }

    #[test]
    fn the_scale_multiplies() {
        let image = parse(&file("PF\n1 1\n-2.5\n", &[1.0, -2.0, 4.0], f32::to_le_bytes)).unwrap();
        assert_eq!(image.get(0, 0), Rgb::new(2.5, -5.0, 10.0));
    }

    #[test]
    fn a_line_end_of_two_bytes_is_taken() {
        let image = parse(&file("PF\r\n1 1\r\n-1\r\n", &[1.0, 2.0, 3.0], f32::to_le_bytes)).unwrap();
        assert_eq!(image.get(0, 0), Rgb::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn round_trip_keeps_every_bit() {
        let odd = [f32::INFINITY, -0.0, f32::MIN_POSITIVE / 2.0, -1e38, 0.1, 1.0];
        let image = Image::from_fn(2, 3, |x, y| Rgb::new(odd[x + 2 * y], odd[5 - x - 2 * y], x as f32));
        let mut bytes = Vec::new();
        encode(&image, &mut bytes).unwrap();
        assert_eq!(parse(&bytes).unwrap(), image);
        let nan = Image::from_pixels(1, 1, vec![Rgb::splat(f32::NAN)]);
        bytes.clear();
        encode(&nan, &mut bytes).unwrap();
        assert!(parse(&bytes).unwrap().get(0, 0).x.is_nan());
    }

    #[test]
    fn blanks_before_the_line_feed_belong_to_the_header() {
        // The first sample looks like white space: its bytes are LF, LF, LF, space.
        let samples = [f32::from_le_bytes(*b"\n\n\n "), 2.0, 3.0];
        for end in ["\n", " ", "\r\n", " \n", " \t \r\n"] {
            let image = parse(&file(&format!("PF\n 1  1 \n -1{end}"), &samples, f32::to_le_bytes)).unwrap();
            assert_eq!(image.get(0, 0), Rgb::from_array(samples), "{end:?}");
        }
    }

    #[test]
    fn a_length_that_contradicts_the_header_is_refused() {
        for (end, values) in [("\n", 4), ("\n", 6), (" \r", 3), ("\nx", 3)] {
            let error = parse(&file(&format!("PF 1 1 -1{end}"), &vec![1.0; values], f32::to_le_bytes)).unwrap_err();
            assert!(error.to_string().contains("byte 9: the file is"), "{end:?}: {error}");
        }
    }

    #[test]
    fn damaged_headers_are_errors() {
        for bytes in [
            &b"PF"[..],
            b"PF\n1 1\n",
            b"PF\n1 1\n0.0\n000000000000",
            b"PF\n1 1\nnan\n000000000000",
            b"PF\n-1 1\n-1.0\n",
            b"PF\n0 5\n-1.0\n",
            b"PF\n1 1\n-1.0\n00000000000",
            b"PF\n1 1\n-1.0",
            b"PF\n99999999999999999999 1\n-1.0\n",
            b"PF\n18446744073709551615 18446744073709551615\n-1.0\n0000",
        ] {
            assert!(parse(bytes).is_err(), "{}", String::from_utf8_lossy(bytes));
        }
    }
}
