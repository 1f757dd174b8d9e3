//! Places and numbers in scene files: positions in a file or in one that it includes, and messages with them; floating-point
//! numbers in text, decimal or hexadecimal, and the numbers that a place may have.

use crate::error::{Error, Place};
use std::fmt;
use std::path::Path;
use std::rc::Rc;

/// A place in one of the files of a scene.
#[derive(Debug, Clone)]
pub struct At {
    path: Rc<Path>,
    place: Place,
}

impl At {
    /// A line and a column, both counted from 1.
    pub fn new(path: Rc<Path>, line: usize, column: usize) -> Self {
        Self { path, place: Place::Text { line, column } }
    }

    pub fn file(path: Rc<Path>) -> Self {
        Self { path, place: Place::File }
    }

    pub fn input(&self, message: impl Into<String>) -> Error {
        Error::input(&self.path, message).at(self.place)
    }

    pub fn unsupported(&self, message: impl Into<String>) -> Error {
        Error::unsupported(&self.path, message).at(self.place)
    }

    pub fn limit(&self, message: impl Into<String>) -> Error {
        Error::limit(&self.path, message).at(self.place)
    }

    /// The error for another file, named here, that cannot be opened; other errors are passed on.
    pub fn cannot_read(&self, error: Error) -> Error {
        match error {
            Error::Io { path, source } => self.input(format!("cannot read {}: {source}", path.display())),
            other => other,
        }
    }

    /// A warning in the same format.
    pub fn warning(&self, message: &str) -> String {
        format!("{self}: {message}")
    }
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.path.display(), self.place)
    }
}

/// Text of the user for a message: quoted, control characters escaped, and cut when long.
pub fn quote(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{:?}…", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// The number that `word` stands for, decimal or hexadecimal as C's `%a` and Python's `float.hex` write it; NaN included.
pub fn number(word: &str) -> Option<f64> {
    word.parse().ok().or_else(|| hexadecimal(word))
}

/// [`number`] without NaN; infinite ones are included.
pub fn real(word: &str) -> Option<f64> {
    number(word).filter(|x| !x.is_nan())
}

/// A finite decimal number.
///
/// # Errors
/// A message that says that `word` is none.
pub fn finite(word: &str) -> Result<f64, String> {
    let number = word.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| format!("{} is not a finite number", quote(word)))
}

/// At most 16 hexadecimal digits. The check also refuses the sign that `from_str_radix` would take.
fn digits(word: &str) -> Option<u64> {
    let fits = word.len() <= 16 && word.bytes().all(|byte| byte.is_ascii_hexdigit());
    u64::from_str_radix(word, 16).ok().filter(|_| fits)
}

/// `[-+]0x1.8p-3`, exact for up to 13 digits after the point.
fn hexadecimal(word: &str) -> Option<f64> {
    let (sign, rest) = match word.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, word.strip_prefix('+').unwrap_or(word)),
    };
    let rest = rest.strip_prefix("0x").or_else(|| rest.strip_prefix("0X"))?;
    let (mantissa, exponent) = rest.split_once(['p', 'P']).unwrap_or((rest, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let mantissa = digits(&[whole, fraction].concat())?;
    let exponent: i32 = exponent.parse().ok()?;
    Some(sign * libm::scalbn(mantissa as f64, exponent.checked_sub(4 * fraction.len() as i32)?))
}

/// A condition on numbers, and its words for a message.
pub struct Rule(pub fn(f64) -> bool, pub &'static str);

/// Any number.
pub const ANY: Rule = Rule(|_| true, "a number");
/// Lengths and ratios.
pub const POSITIVE: Rule = Rule(|x| x > 0.0, "positive");
/// Reflectances and roughnesses.
pub const FRACTION: Rule = Rule(|x| (0.0..=1.0).contains(&x), "from 0 to 1");
/// Light of any unit.
pub const LIGHT: Rule = Rule(|x| (0.0..=1e30).contains(&x), "from 0 to 1e30");
/// Fields of view.
pub const ANGLE: Rule = Rule(|x| x > 0.0 && x < 180.0, "between 0 and 180 degrees");
/// Index of refraction of a dielectric: beyond this there is no matter, and squares might leave single precision.
pub const DIELECTRIC_INDEX: Rule = Rule(|x| (1e-3..=1e3).contains(&x), "from 0.001 to 1000");

impl Rule {
    /// `numbers`, if they are `N` that keep the rule.
    ///
    /// # Errors
    /// What is wrong, as the predicate of a sentence.
    pub fn check<const N: usize>(&self, numbers: &[f64]) -> Result<[f64; N], String> {
        let wrong = |_| format!("needs {N} number{}, not {}", if N == 1 { "" } else { "s" }, numbers.len());
        let numbers = <[f64; N]>::try_from(numbers).map_err(wrong)?;
        match numbers.iter().find(|&&number| !(self.0)(number)) {
            Some(bad) => Err(format!("must be {}, not {bad}", self.1)),
            None => Ok(numbers),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_and_hexadecimal() {
        assert_eq!(number("-2.5e-1"), Some(-0.25));
        assert_eq!(number("inf"), Some(f64::INFINITY));
        assert_eq!(number("0x1.8p+1"), Some(3.0));
        assert_eq!(number("-0x1.999999999999ap-4"), Some(-0.1));
        assert_eq!(number("0x0.0000000000001p-1022"), Some(f64::from_bits(1)));
        assert_eq!(number("0X10"), Some(16.0));
        for bad in ["", "1,5", "0x", "0x.p1", "0x+1", "0x1p", "0x1p9999999999", "0x12345678901234567", "x1"] {
            assert_eq!(number(bad), None, "{bad}");
        }
    }
}
