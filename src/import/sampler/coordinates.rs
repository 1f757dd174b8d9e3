//! Points as text: one word per coordinate.

use super::number::number;
use glam::DVec3;
use std::fmt::{Debug, Write};
use std::str::SplitAsciiWhitespace;

/// A point that can be written as words and read back, to the last bit.
pub trait Coordinates: Copy + Send + Sync + Debug + 'static {
    /// What the words are, for messages.
    const WORDS: &'static str;

    /// Appends the words, with spaces between them.
    fn write(&self, out: &mut String);

    /// Takes the words from a line.
    fn read(words: &mut SplitAsciiWhitespace<'_>) -> Option<Self>;
}

/// Appends as many digits as it takes to read back the same number.
pub fn write_number(x: f64, out: &mut String) {
    // Writing to a string cannot fail.
    let _ = write!(out, "{x:e}");
}

fn read_numbers<const N: usize>(words: &mut SplitAsciiWhitespace<'_>) -> Option<[f64; N]> {
    let mut numbers = [0.0; N];
    for x in &mut numbers {
        *x = number(words.next()?)?;
    }
    Some(numbers)
}

impl Coordinates for DVec3 {
    const WORDS: &'static str = "x y z";

    fn write(&self, out: &mut String) {
        write_number(self.x, out);
        out.push(' ');
        write_number(self.y, out);
        out.push(' ');
        write_number(self.z, out);
    }

    fn read(words: &mut SplitAsciiWhitespace<'_>) -> Option<Self> {
        read_numbers(words).map(Self::from_array)
    }
}

impl Coordinates for [f64; 2] {
    const WORDS: &'static str = "x y";

    fn write(&self, out: &mut String) {
        write_number(self[0], out);
        out.push(' ');
        write_number(self[1], out);
    }

    fn read(words: &mut SplitAsciiWhitespace<'_>) -> Option<Self> {
        read_numbers(words)
    }
}

impl Coordinates for f64 {
    const WORDS: &'static str = "x";

    fn write(&self, out: &mut String) {
        write_number(*self, out);
    }

    fn read(words: &mut SplitAsciiWhitespace<'_>) -> Option<Self> {
        number(words.next()?)
    }
}

impl Coordinates for usize {
    const WORDS: &'static str = "i";

    fn write(&self, out: &mut String) {
        let _ = write!(out, "{self}");
    }

    fn read(words: &mut SplitAsciiWhitespace<'_>) -> Option<Self> {
        words.next()?.parse().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_back_to_the_last_bit() {
        for x in [0.1, 1.0 / 3.0, f64::MIN_POSITIVE, -1e300, 0.0] {
            let point = DVec3::new(x, -x, 2.0 * x);
            let mut text = String::new();
            point.write(&mut text);
            let mut words = text.split_ascii_whitespace();
            assert_eq!(DVec3::read(&mut words), Some(point), "{text}");
            assert!(words.next().is_none());
        }
        assert_eq!(<[f64; 2]>::read(&mut "1 nan".split_ascii_whitespace()), None);
        assert_eq!(<[f64; 2]>::read(&mut "1".split_ascii_whitespace()), None);
        assert_eq!(usize::read(&mut "-1".split_ascii_whitespace()), None);
    }
}
