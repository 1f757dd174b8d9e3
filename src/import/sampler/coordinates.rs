//! Points as words: one per coordinate.

use super::number::{Words, write_number};
use std::fmt::{Debug, Write};

/// A point that can be written as words and read back, to the last bit.
pub trait Coordinates: Copy + Send + Sync + Debug + 'static {
    /// What the words are, for messages.
    const WORDS: &'static str;

    /// Appends the words, with spaces between them.
    fn write(&self, out: &mut String);

    /// Takes the words from a line.
    fn read(words: &mut Words<'_>) -> Option<Self>;
}

/// Appends numbers with spaces between them.
pub fn write_numbers(numbers: &[f64], out: &mut String) {
    for (i, &x) in numbers.iter().enumerate() {
        out.push_str(if i == 0 { "" } else { " " });
        write_number(x, out);
    }
}

impl Coordinates for [f64; 3] {
    const WORDS: &'static str = "x y z";

    fn write(&self, out: &mut String) {
        write_numbers(self, out);
    }

    fn read(words: &mut Words<'_>) -> Option<Self> {
        Some([words.number()?, words.number()?, words.number()?])
    }
}

impl Coordinates for [f64; 2] {
    const WORDS: &'static str = "x y";

    fn write(&self, out: &mut String) {
        write_numbers(self, out);
    }

    fn read(words: &mut Words<'_>) -> Option<Self> {
        Some([words.number()?, words.number()?])
    }
}

impl Coordinates for f64 {
    const WORDS: &'static str = "x";

    fn write(&self, out: &mut String) {
        write_number(*self, out);
    }

    fn read(words: &mut Words<'_>) -> Option<Self> {
        words.number()
    }
}

impl Coordinates for usize {
    const WORDS: &'static str = "i";

    fn write(&self, out: &mut String) {
        // Writing to a string cannot fail.
        let _ = write!(out, "{self}");
    }

    fn read(words: &mut Words<'_>) -> Option<Self> {
        words.next()?.parse().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_round_trip() {
        fn returns<P: Coordinates + PartialEq>(point: P) {
            let mut line = String::new();
            point.write(&mut line);
            let mut words = Words::new(&line);
            assert_eq!(P::read(&mut words), Some(point), "{line}");
            assert!(words.is_empty());
        }
        returns([0.1, -1e-300, 1.0 / 3.0]);
        returns([0.1, 2.0]);
        returns(0.1);
        returns(1_000_000usize);
        let read = |line| <[f64; 2]>::read(&mut Words::new(line));
        assert_eq!((read("1 nan"), read("1"), read("1 x")), (None, None, None));
    }
}
