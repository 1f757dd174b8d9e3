//! The words of a line that a program writes, and numbers that read back to the last bit.

pub use crate::import::number::number;
use std::fmt::Write;

/// The words of a line.
#[derive(Debug, Clone)]
pub struct Words<'a> {
    rest: &'a str,
}

impl<'a> Words<'a> {
    /// The words of `line`, separated by white space.
    pub fn new(line: &'a str) -> Self {
        Self { rest: line }
    }

    /// The next word as a number, infinite ones included; `None` for NaN and for what is no number.
    pub fn number(&mut self) -> Option<f64> {
        number(self.next()?).filter(|x| !x.is_nan())
    }

    /// Whether the next word is `word`, which is then taken.
    pub fn accept(&mut self, word: &str) -> bool {
        let mut after = self.clone();
        let found = after.next() == Some(word);
        if found {
            *self = after;
        }
        found
    }

    /// Whether no word is left.
    pub fn is_empty(&self) -> bool {
        self.rest.trim_ascii().is_empty()
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        let rest = self.rest.trim_ascii_start();
        let end = rest.bytes().position(|byte| byte.is_ascii_whitespace()).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }
}

/// Appends a number that reads back to the last bit.
pub fn write_number(x: f64, out: &mut String) {
    // Writing to a string cannot fail.
    let _ = write!(out, "{x:e}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_round_trip_to_the_last_bit() {
        let mut line = String::new();
        for x in [0.1, 1.0 / 3.0, f64::MIN_POSITIVE, -1e300, -0.0, f64::INFINITY] {
            line.clear();
            write_number(x, &mut line);
            let mut words = Words::new(&line);
            assert_eq!(words.number().unwrap().to_bits(), x.to_bits(), "{line}");
            assert!(words.is_empty());
        }
        line.clear();
        write_number(f64::NAN, &mut line);
        assert_eq!(Words::new(&line).number(), None);
    }

    #[test]
    fn words_are_taken_one_by_one() {
        let mut words = Words::new(" 1 -0x1p+1\tnone\r\n");
        assert_eq!((words.number(), words.number()), (Some(1.0), Some(-2.0)));
        assert!(!words.accept("some") && words.accept("none") && words.is_empty());
    }
}
