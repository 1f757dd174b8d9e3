//! Writing a Radiance image in the newer run lengths.

use super::decode::{RUN_WIDTHS, shared_exponent};
use crate::raster::metadata::SOFTWARE;
use crate::raster::{Image, Metadata};
use std::io::{self, Write};

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
    use super::*;

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
