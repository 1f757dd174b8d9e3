//! Text and numbers as HTML that is also well-formed XML.

use std::fmt::{Display, Formatter, Result};

/// Text that cannot end or begin a tag, an attribute or an entity. Characters that XML forbids become �.
pub struct Escaped<'a>(pub &'a str);

impl Display for Escaped<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        for c in self.0.chars() {
            match c {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                '\'' => f.write_str("&#39;")?,
                '\t' | '\n' | '\r' => f.write_str(" ")?,
                '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => f.write_str("\u{fffd}")?,
                c => write!(f, "{c}")?,
            }
        }
        Ok(())
    }
}

/// A number of about six digits; the CSV file has the others.
pub struct Short(pub f64);

impl Display for Short {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let plain = self.0.to_string();
        if plain.len() <= 8 || !self.0.is_finite() {
            return f.write_str(&plain);
        }
        let size = self.0.abs();
        if (1e-3..1e7).contains(&size) {
            // Digits before the point leave fewer after it.
            let decimals = (5 - size.log10().floor() as i32).clamp(0, 8) as usize;
            return write!(f, "{:.decimals$}", self.0);
        }
        let text = format!("{:.3e}", self.0);
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
        write!(f, "{mantissa}e{exponent}")
    }
}

/// A time with as many digits as are worth reading.
pub struct Seconds(pub f64);

impl Display for Seconds {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let decimals = if self.0 < 10.0 { 2 } else { 0 };
        write!(f, "{:.decimals$}\u{a0}s", self.0)
    }
}

/// "1 figure", "2 figures".
pub fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_gets_out_of_its_place() {
        let evil = "\"><script>alert('&')</script>\u{8}\n";
        let safe = Escaped(evil).to_string();
        assert!(!safe.contains(['<', '>', '"', '\'', '\u{8}']), "{safe}");
        let document = format!("<a b=\"{safe}\">{safe}</a>");
        let tree = roxmltree::Document::parse(&document).unwrap();
        let plain = "\"><script>alert('&')</script>\u{fffd} ";
        assert_eq!((tree.root_element().attribute("b"), tree.root_element().text()), (Some(plain), Some(plain)));
    }

    #[test]
    fn numbers_are_short() {
        let short = |x| Short(x).to_string();
        assert_eq!(short(64.0), "64");
        assert_eq!(short(0.033_735_943_356_934), "0.0337359");
        assert_eq!(short(55.407_711_312_490_06), "55.4077");
        assert_eq!(short(1.234_567_89e-13), "1.235e-13");
        assert_eq!(short(1e-15), "1e-15");
        assert_eq!(short(f64::NAN), "NaN");
        assert_eq!(short(-0.950_123_456), "-0.950123");
    }
}
