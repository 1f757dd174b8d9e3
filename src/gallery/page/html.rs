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

/// A time with as many digits as are worth reading.
pub struct Seconds(pub f64);

impl Display for Seconds {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let decimals = if self.0 < 10.0 { 2 } else { 0 };
        write!(f, "{:.decimals$}\u{a0}s", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escaped_text_stays_inside_its_attribute_or_element() {
        let evil = "\"><script>alert('&')</script>\u{8}\n";
        let safe = Escaped(evil).to_string();
        assert!(!safe.contains(['<', '>', '"', '\'', '\u{8}']), "{safe}");
        let document = format!("<a b=\"{safe}\">{safe}</a>");
        let tree = roxmltree::Document::parse(&document).unwrap();
        let plain = "\"><script>alert('&')</script>\u{fffd} ";
        assert_eq!((tree.root_element().attribute("b"), tree.root_element().text()), (Some(plain), Some(plain)));
    }
}
